/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Quintic B-spline (Morris, Fox and Zhu 1997): (3-q)+^5 - 6 (2-q)+^5 + 15 (1-q)+^5. */
#ifndef SPH_QUINTIC_SPLINE_H
#define SPH_QUINTIC_SPLINE_H

#include "particle/lanes.h"

PART_LANES vec sph_shape_quintic_spline(vec q) {
  const vec a = vec_max(3.0 - q, vec_all(0.0)), b = vec_max(2.0 - q, vec_all(0.0)),
            c = vec_max(1.0 - q, vec_all(0.0));
  const vec a2 = a * a, b2 = b * b, c2 = c * c;
  return a2 * a2 * a - 6.0 * (b2 * b2 * b) + 15.0 * (c2 * c2 * c);
}
/* For q < 1 the polynomial -120 + 120 q^2 - 50 q^3, reached continuously from the outer branches
 * taken at max(q, 1), where they give -5 (2^4 - 6) = -50: without cancellation, without 1/0. */
PART_LANES vec sph_slope_quintic_spline(vec q) {
  const vec far = vec_max(q, vec_all(1.0)), in = vec_min(q, vec_all(1.0));
  const vec a = vec_max(3.0 - far, vec_all(0.0)), b = vec_max(2.0 - far, vec_all(0.0));
  const vec a2 = a * a, b2 = b * b, in2 = in * in;
  return -5.0 * (a2 * a2 - 6.0 * (b2 * b2)) / far - 70.0 + in2 * (120.0 - 50.0 * in);
}
static inline double sph_norm_quintic_spline(int dim) {
  const double pi = 3.14159265358979323846;
  return dim == 2 ? 7.0 / (478.0 * pi) : 1.0 / (120.0 * pi);
}

#endif
