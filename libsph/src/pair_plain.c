/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pair loops in plain C, one partner at a time. */
#include "pair_kernel.h"

const sph_loops *sph_loops_plain(void) {
  return &loops;
}
