/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Wendland C2 (Wendland 1995): with s = q/2, (1-s)^4 (1 + 4 s). */
#ifndef SPH_WENDLAND_C2_H
#define SPH_WENDLAND_C2_H

#include "particle/lanes.h"

PART_LANES vec sph_shape_wendland_c2(vec q) {
  const vec a = vec_max(1.0 - 0.5 * q, vec_all(0.0)), a2 = a * a;
  return a2 * a2 * (1.0 + 2.0 * q);
}
PART_LANES vec sph_slope_wendland_c2(vec q) {
  const vec a = vec_max(1.0 - 0.5 * q, vec_all(0.0));
  return -5.0 * (a * a * a);
}
static inline double sph_norm_wendland_c2(int dim) {
  const double pi = 3.14159265358979323846;
  return dim == 2 ? 7.0 / (4.0 * pi) : 21.0 / (16.0 * pi);
}

#endif
