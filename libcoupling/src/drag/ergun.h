/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef COUPLING_DRAG_ERGUN_H
#define COUPLING_DRAG_ERGUN_H

#include "normalised.h"

/* Ergun, Chem. Eng. Prog. 48 (1952) 89-94:
 *   F = 150/18 (1 - eps)/eps^2 + 1.75/18 Re/eps^2,
 * which makes the pressure drop of a homogeneous bed
 *   150 mu U (1 - eps)^2/(eps^3 d^2) + 1.75 rho U^2 (1 - eps)/(eps^3 d). */
static inline double cpl_drag_ergun(double slip, double d, double eps, double rho, double mu,
                                    double mean_d) {
  const double re = cpl_drag_reynolds(slip, d, eps, rho, mu);
  (void)mean_d;
  return cpl_drag_beta(d, eps, mu, (150.0 * (1.0 - eps) + 1.75 * re) / (18.0 * eps * eps));
}

#endif
