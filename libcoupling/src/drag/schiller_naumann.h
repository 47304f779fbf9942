/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef COUPLING_DRAG_SCHILLER_NAUMANN_H
#define COUPLING_DRAG_SCHILLER_NAUMANN_H

#include "normalised.h"

/* Schiller and Naumann, Z. Ver. Deutsch. Ing. 77 (1933) 318-320, one sphere, on the superficial
 * slip as the row stokes: F = 1 + 0.15 Re^0.687, and C_d = 0.44 for Re > 1000 */
static inline double cpl_drag_schiller_naumann(double slip, double d, double eps, double rho,
                                               double mu, double mean_d) {
  (void)mean_d;
  return cpl_drag_beta(d, eps, mu,
                       cpl_drag_single_sphere(cpl_drag_reynolds(slip, d, eps, rho, mu)));
}

#endif
