/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Forces and torque on one sphere that come from shear and spin. u_rel = u - v, curl = curl u of
 * the fluid, Omega = curl/2 - omega. Re = rho |u_rel| d/mu, Re_s = rho d^2 |curl|/mu, Re_r = rho
 * d^2 |Omega|/mu. SI units. */
#ifndef COUPLING_SPIN_FORCES_H
#define COUPLING_SPIN_FORCES_H

#include <math.h>

static inline double cpl_norm3(const double *a) {
  return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

/* to += scale a x b */
static inline void cpl_add_cross(double scale, const double *a, const double *b, double *to) {
  to[0] += scale * (a[1] * b[2] - a[2] * b[1]);
  to[1] += scale * (a[2] * b[0] - a[0] * b[2]);
  to[2] += scale * (a[0] * b[1] - a[1] * b[0]);
}

/* Lift of Saffman (1965) with the factor of Mei (1992) beyond small Re, N: force += scale u_rel x
 * curl, scale = 1.615 d^2 sqrt(rho mu/|curl|) f. */
static inline double cpl_saffman_scale(double slip, double curl, double d, double rho, double mu) {
  if (!(curl > 0.0))
    return 0.0;
  const double re = rho * slip * d / mu, re_s = rho * d * d * curl / mu;
  const double beta_re = 0.5 * re_s; /* beta Re of Mei */
  double f;
  if (re > 40.0) {
    f = 0.0524 * sqrt(beta_re);
  } else {
    const double root = re > 0.0 ? 0.3314 * sqrt(fmin(beta_re / re, 1.0)) : 0.3314;
    f = (1.0 - root) * exp(-0.1 * re) + root;
  }
  return 1.615 * d * d * sqrt(rho * mu / curl) * f;
}

/* Lift of a turning sphere, N: force += scale Omega x u_rel; Rubinow and Keller (1961) at small Re,
 * C_L of Oesterle and Bui Dinh (1998) up to Re = 140. */
static inline double cpl_magnus_scale(double slip, double turn, double d, double rho, double mu) {
  const double small = 0.39269908169872415481 * rho * d * d * d; /* pi/8 */
  if (!(slip > 0.0 && turn > 0.0))
    return small;
  const double re = rho * slip * d / mu, re_r = rho * d * d * turn / mu, ratio = re_r / re;
  const double c = 0.45 + (ratio - 0.45) * exp(-0.05684 * pow(re_r, 0.4) * pow(re, 0.3));
  return small * c / ratio;
}

/* Torque k Omega of the fluid, k in N m s: pi mu d^3 in creeping flow, beyond Re_r = 32 as Dennis,
 * Singh and Ingham (1980). */
static inline double cpl_turning_drag(double turn, double d, double rho, double mu) {
  const double creeping = 3.14159265358979323846 * mu * d * d * d;
  const double re_r = rho * d * d * turn / mu;
  if (re_r <= 32.0)
    return creeping;
  return creeping * (12.9 * sqrt(re_r) + 128.4) / (64.0 * 3.14159265358979323846);
}

#endif
