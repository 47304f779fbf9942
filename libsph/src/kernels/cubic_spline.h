/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cubic B-spline (Markauskas et al. 2017, eq. 10), as one expression: with a = (2-q)+, b = (1-q)+
 *   shape = a^3/4 - b^3 */
#ifndef SPH_CUBIC_SPLINE_H
#define SPH_CUBIC_SPLINE_H

#include "particle/lanes.h"

PART_LANES vec sph_shape_cubic_spline(vec q) {
  const vec a = vec_max(2.0 - q, vec_all(0.0)), b = vec_max(1.0 - q, vec_all(0.0));
  return 0.25 * a * a * a - b * b * b;
}
/* (9/4 q - 3) for q < 1, which needs no 1/q: the outer branch taken at max(q, 1), where it is -3/4,
 * and the rest. */
PART_LANES vec sph_slope_cubic_spline(vec q) {
  const vec near = vec_max(1.0 - q, vec_all(0.0)), far = vec_max(q, vec_all(1.0));
  const vec s = vec_max(2.0 - far, vec_all(0.0));
  return -0.75 * s * s / far - 2.25 * near;
}
static inline double sph_norm_cubic_spline(int dim) {
  const double pi = 3.14159265358979323846;
  return dim == 2 ? 10.0 / (7.0 * pi) : 1.0 / pi;
}

#endif
