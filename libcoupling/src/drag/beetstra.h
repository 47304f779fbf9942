/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef COUPLING_DRAG_BEETSTRA_H
#define COUPLING_DRAG_BEETSTRA_H

#include "normalised.h"

/* Beetstra, van der Hoef and Kuipers, AIChE J. 53 (2007) 489-501; phi = 1 - eps:
 *   F = 10 phi/eps^2 + eps^2 (1 + 1.5 sqrt(phi))
 *     + 0.413 Re/(24 eps^2) (1/eps + 3 phi eps + 8.4 Re^-0.343)/(1 + 10^(3 phi) Re^(-(1 + 4
 * phi)/2)) */
static inline double cpl_drag_beetstra_f(double re, double eps) {
  const double phi = fmax(1.0 - eps, 0.0), eps2 = eps * eps;
  double f = 10.0 * phi / eps2 + eps2 * (1.0 + 1.5 * sqrt(phi));
  if (re > 1e-12) { /* below, the last part is less than 1e-12 */
    const double log_re = log(re);
    const double above = 1.0 / eps + 3.0 * phi * eps + 8.4 * exp(-0.343 * log_re);
    const double below =
        1.0 + exp(3.0 * phi * 2.302585092994045684 - 0.5 * (1.0 + 4.0 * phi) * log_re);
    f += 0.413 * re / (24.0 * eps2) * above / below;
  }
  return f;
}

static inline double cpl_drag_beetstra(double slip, double d, double eps, double rho, double mu,
                                       double mean_d) {
  (void)mean_d;
  return cpl_drag_beta(d, eps, mu,
                       cpl_drag_beetstra_f(cpl_drag_reynolds(slip, d, eps, rho, mu), eps));
}

/* Spheres of several sizes: with y = d/<d>, <d> the Sauter mean diameter of the spheres around,
 *   F_i = (eps y + phi y^2 + 0.064 eps y^3) F(eps, <Re>),   <Re> with <d>
 * (the same paper; van der Hoef, Beetstra and Kuipers, J. Fluid Mech. 528 (2005) 233-254). For one
 * size it is F (1 + 0.064 eps): a fit, not the monodisperse law. */
static inline double cpl_drag_beetstra_polydisperse(double slip, double d, double eps, double rho,
                                                    double mu, double mean_d) {
  const double y = d / mean_d, phi = 1.0 - eps;
  const double f = cpl_drag_beetstra_f(cpl_drag_reynolds(slip, mean_d, eps, rho, mu), eps);
  return cpl_drag_beta(d, eps, mu, y * (eps + y * (phi + 0.064 * eps * y)) * f);
}

#endif
