/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef COUPLING_DRAG_KOCH_HILL_H
#define COUPLING_DRAG_KOCH_HILL_H

#include "normalised.h"

/* Hill, Koch and Ladd, J. Fluid Mech. 448 (2001) 213-278, joined for all Re as is usual (Koch and
 * Hill, Annu. Rev. Fluid Mech. 33 (2001) 619-647); phi = 1 - eps:
 *   F  = eps (F0 + F3 Re/2)
 *   F0 = (1 + 3 sqrt(phi/2) + 135/64 phi ln phi + 16.14 phi)/(1 + 0.681 phi - 8.48 phi^2 + 8.16
 * phi^3) for phi < 0.4, 10 phi/(1 - phi)^3 above F3 = 0.0673 + 0.212 phi + 0.0232/(1 - phi)^5 Their
 * force is the whole one, hence the eps (normalised.h); their Re has the radius, hence the 2. */
static inline double cpl_drag_koch_hill(double slip, double d, double eps, double rho, double mu,
                                        double mean_d) {
  const double phi = 1.0 - eps;
  const double re = cpl_drag_reynolds(slip, d, eps, rho, mu);
  double f0 = 10.0 * phi / (eps * eps * eps);
  if (phi < 0.4) {
    const double log_part = phi > 0.0 ? 135.0 / 64.0 * phi * log(phi) : 0.0;
    f0 = (1.0 + 3.0 * sqrt(0.5 * fmax(phi, 0.0)) + log_part + 16.14 * phi) /
         (1.0 + phi * (0.681 + phi * (-8.48 + phi * 8.16)));
  }
  const double eps2 = eps * eps;
  const double f3 = 0.0673 + 0.212 * phi + 0.0232 / (eps2 * eps2 * eps);
  (void)mean_d;
  return cpl_drag_beta(d, eps, mu, eps * (f0 + 0.5 * f3 * re));
}

#endif
