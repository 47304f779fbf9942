/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef COUPLING_DRAG_DI_FELICE_H
#define COUPLING_DRAG_DI_FELICE_H

#include <math.h>

/* Di Felice, Int. J. Multiphase Flow 20 (1994) 153-159, with the coefficient of Dallavalle (1948),
 * as in Markauskas et al. 2017:
 *   F   = 1/8 C_d rho pi d^2 |u - v| (u - v) eps^(2 - chi)             (19)
 *   C_d = (0.63 + 4.8/sqrt(Re))^2,  Re = eps |u - v| d rho/mu          (21)
 *   chi = 3.7 - 0.65 exp(-(1.5 - log10 Re)^2/2)                        (22)
 * F is the drag beside the pressure gradient force. The slip is taken into the square of (21),
 *   C_d |u - v| = (0.63 sqrt|u - v| + 4.8 sqrt(mu/(rho eps d)))^2,
 * so that beta = F/|u - v| is finite and continuous at rest. */
static inline double cpl_drag_di_felice(double slip, double d, double eps, double rho, double mu,
                                        double mean_d) {
  const double pi = 3.14159265358979323846;
  const double re = eps * slip * d * rho / mu;
  const double root = 0.63 * sqrt(slip) + 4.8 * sqrt(mu / (rho * eps * d));
  (void)mean_d;
  double chi = 3.7;
  if (re > 1e-12) { /* below, the exponential is 0 in double; log10(0) would raise a trap */
    const double a = 1.5 - log10(re);
    chi -= 0.65 * exp(-0.5 * a * a);
  }
  return 0.125 * pi * rho * d * d * root * root * exp((2.0 - chi) * log(eps));
}

#endif
