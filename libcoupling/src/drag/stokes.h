/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef COUPLING_DRAG_STOKES_H
#define COUPLING_DRAG_STOKES_H

/* F = 3 pi mu d eps (u - v): creeping flow around one sphere, on the superficial slip eps (u - v)
 * (Robinson, Ramaioli and Luding 2014, eq. 28, 29). Valid for Re << 1 and eps near 1. */
static inline double cpl_drag_stokes(double slip, double d, double eps, double rho, double mu,
                                     double mean_d) {
  const double pi = 3.14159265358979323846;
  (void)slip;
  (void)rho;
  (void)mean_d;
  return 3.0 * pi * mu * d * eps;
}

#endif
