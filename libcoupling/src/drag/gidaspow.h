/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef COUPLING_DRAG_GIDASPOW_H
#define COUPLING_DRAG_GIDASPOW_H

#include "ergun.h"
#include "wen_yu.h"

/* Gidaspow, Multiphase Flow and Fluidization (1994): Ergun below eps = 0.8, Wen and Yu above. */
static inline double cpl_drag_gidaspow(double slip, double d, double eps, double rho, double mu,
                                       double mean_d) {
  return eps < 0.8 ? cpl_drag_ergun(slip, d, eps, rho, mu, mean_d)
                   : cpl_drag_wen_yu(slip, d, eps, rho, mu, mean_d);
}

/* The same with the switch of Huilin and Gidaspow, Chem. Eng. Sci. 58 (2003) 3777-3792:
 *   beta = (1 - psi) beta_Ergun + psi beta_WenYu,
 *   psi  = 1/2 + arctan(150 * 1.75 (0.2 - (1 - eps)))/pi */
static inline double cpl_drag_gidaspow_smooth(double slip, double d, double eps, double rho,
                                              double mu, double mean_d) {
  const double pi = 3.14159265358979323846;
  const double psi = 0.5 + atan(150.0 * 1.75 * (eps - 0.8)) / pi;
  return (1.0 - psi) * cpl_drag_ergun(slip, d, eps, rho, mu, mean_d) +
         psi * cpl_drag_wen_yu(slip, d, eps, rho, mu, mean_d);
}

#endif
