/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef COUPLING_DRAG_NORMALISED_H
#define COUPLING_DRAG_NORMALISED_H

#include <math.h>

/* Most laws give F of
 *   force = 3 pi mu d eps |u - v| F(eps, Re),   Re = eps |u - v| d rho/mu,
 * the drag beside the pressure gradient force over Stokes' with the superficial slip. Then
 * beta = 3 pi mu d eps F. A law whose F is published for the whole force of the fluid, the mean
 * pressure gradient included, has to be multiplied by eps (force balance of a homogeneous bed). */
static inline double cpl_drag_reynolds(double slip, double d, double eps, double rho, double mu) {
  return eps * slip * d * rho / mu;
}
static inline double cpl_drag_beta(double d, double eps, double mu, double f) {
  const double pi = 3.14159265358979323846;
  return 3.0 * pi * mu * d * eps * f;
}

/* C_d Re/24 of Schiller and Naumann (1933) for one sphere: (1 + 0.15 Re^0.687), and Newton's
 * C_d = 0.44 for Re > 1000. */
static inline double cpl_drag_single_sphere(double re) {
  return re > 1000.0 ? 0.44 / 24.0 * re : 1.0 + 0.15 * pow(re, 0.687);
}

#endif
