/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef COUPLING_DRAG_WEN_YU_H
#define COUPLING_DRAG_WEN_YU_H

#include "normalised.h"

/* Wen and Yu, Chem. Eng. Prog. Symp. Ser. 62 (1966) 100-111, with the coefficient of Schiller and
 * Naumann (1933):
 *   force = 1/8 C_d rho pi d^2 |u - v| (u - v) eps^-1.65,   F = (1 + 0.15 Re^0.687) eps^-3.65 */
static inline double cpl_drag_wen_yu(double slip, double d, double eps, double rho, double mu,
                                     double mean_d) {
  const double f = cpl_drag_single_sphere(cpl_drag_reynolds(slip, d, eps, rho, mu));
  (void)mean_d;
  return cpl_drag_beta(d, eps, mu, f * exp(-3.65 * log(eps)));
}

#endif
