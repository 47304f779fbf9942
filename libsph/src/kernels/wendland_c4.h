/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Wendland C4 (Wendland 1995): with s = q/2, (1-s)^6 (1 + 6 s + 35/3 s^2). */
#ifndef SPH_WENDLAND_C4_H
#define SPH_WENDLAND_C4_H

#include "particle/lanes.h"

PART_LANES vec sph_shape_wendland_c4(vec q) {
  const vec s = 0.5 * q, a = vec_max(1.0 - s, vec_all(0.0)), a2 = a * a;
  return a2 * a2 * a2 * (1.0 + s * (6.0 + 35.0 / 3.0 * s));
}
PART_LANES vec sph_slope_wendland_c4(vec q) {
  const vec s = 0.5 * q, a = vec_max(1.0 - s, vec_all(0.0)), a2 = a * a;
  return -14.0 / 3.0 * (a2 * a2 * a) * (1.0 + 5.0 * s);
}
static inline double sph_norm_wendland_c4(int dim) {
  const double pi = 3.14159265358979323846;
  return dim == 2 ? 9.0 / (4.0 * pi) : 495.0 / (256.0 * pi);
}

#endif
