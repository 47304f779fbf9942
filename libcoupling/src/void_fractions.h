/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef COUPLING_VOID_FRACTIONS_H
#define COUPLING_VOID_FRACTIONS_H

enum {
#define CPL_VOID_FRACTION(name, meaning) CPL_VOID_FRACTION_##name,
#include "coupling/void_fractions.def"
#undef CPL_VOID_FRACTION
  CPL_VOID_FRACTION_COUNT
};

#endif
