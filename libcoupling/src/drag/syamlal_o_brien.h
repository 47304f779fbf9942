/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef COUPLING_DRAG_SYAMLAL_O_BRIEN_H
#define COUPLING_DRAG_SYAMLAL_O_BRIEN_H

#include "normalised.h"

/* Syamlal, Rogers and O'Brien, MFIX documentation: theory guide (1993), as in Gao and Sun 2011,
 * eq. 17-22; Re_i = |u - v| d rho/mu with the interstitial slip:
 *   beta per volume = 3/4 C_d/V_r^2 rho |u - v|/d eps (1 - eps),   C_d = (0.63 + 4.8
 * sqrt(V_r/Re_i))^2 F   = (0.63 sqrt(Re_i) + 4.8 sqrt(V_r))^2/(24 V_r^2) V_r = 1/2 (A - 0.06 Re_i +
 * sqrt((0.06 Re_i)^2 + 0.12 Re_i (2 B - A) + A^2)) A   = eps^4.14,   B = 0.8 eps^1.28 up to eps =
 * 0.85, eps^2.65 above */
static inline double cpl_drag_syamlal_o_brien(double slip, double d, double eps, double rho,
                                              double mu, double mean_d) {
  const double re = slip * d * rho / mu, log_eps = log(eps), s = 0.06 * re;
  const double a = exp(4.14 * log_eps);
  const double b = eps > 0.85 ? exp(2.65 * log_eps) : 0.8 * exp(1.28 * log_eps);
  /* a - s + sqrt(...) loses digits for fast slip: with q = sqrt(s^2 + 2 s (2 b - a) + a^2),
   * q - s = (2 s (2 b - a) + a^2)/(q + s) */
  const double rest = 2.0 * s * (2.0 * b - a) + a * a;
  const double v_r = 0.5 * (a + rest / (sqrt(s * s + rest) + s));
  const double root = 0.63 * sqrt(re) + 4.8 * sqrt(v_r);
  (void)mean_d;
  return cpl_drag_beta(d, eps, mu, root * root / (24.0 * v_r * v_r));
}

#endif
