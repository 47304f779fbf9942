/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef COUPLING_DRAG_COULSON_RICHARDSON_H
#define COUPLING_DRAG_COULSON_RICHARDSON_H

#include "normalised.h"

/* Coulson and Richardson, Chemical Engineering vol. 2 (1993), as in Robinson et al. 2014, eq. 30
 * (where the force lacks a factor u_s), one sphere:
 *   force = pi/4 d^2 rho |u_s| u_s (1.84 Re^-0.31 + 0.293 Re^0.06)^3.45
 *   F     = Re/12 (1.84 Re^-0.31 + 0.293 Re^0.06)^3.45
 * Below Re = 0.1, where F = 1.006, the formula leaves Stokes' law again (F goes as Re^-0.07 and has
 * no limit at rest): F stays at that value. */
static inline double cpl_drag_coulson_richardson(double slip, double d, double eps, double rho,
                                                 double mu, double mean_d) {
  const double re = fmax(cpl_drag_reynolds(slip, d, eps, rho, mu), 0.1), log_re = log(re);
  const double sum = 1.84 * exp(-0.31 * log_re) + 0.293 * exp(0.06 * log_re);
  (void)mean_d;
  return cpl_drag_beta(d, eps, mu, re / 12.0 * pow(sum, 3.45));
}

#endif
