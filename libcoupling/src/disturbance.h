/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The velocity that a particle's own drag has given to the fluid where it is sampled, so that drag
 * can be taken on the undisturbed velocity (Balachandar, Liu and Lakhote 2019; Evrard, Denner and
 * van Wachem 2020, here with memory and for the kernel of the exchange). A force f(t) spread with a
 * Gaussian of variance v per axis and sampled with the same one gives, in a fluid that passes with
 * U (Oseen), with s^2 = 2 v + 2 nu t:
 *
 *   w(t) = int_0^inf f(t - a)/rho M(U a/s)/(2 pi (U a)^3) da,
 *   M(x) = erf(x/sqrt 2) - sqrt(2/pi) x exp(-x^2/2).
 *
 * In units of s0 = sqrt(2 v) and T = s0^2/(2 nu) it depends on Re = U s0/(2 nu) only:
 *   w = 1/(4 pi rho nu s0) int f k(a/T; Re) da/T,  k(t) = (1 + t)^(-3/2) M(x)/x^3,
 *   x = Re t/sqrt(1 + t).
 * The integral over the past is held in CPL_MEMORY_VECTORS running means y_k of f over the times
 * t_k T, t_k in geometric progression: w = sum_k A_k(Re) y_k, A_k fitted to the step response of k.
 * Steady forces are exact to 1e-3, transients to 3 % of the steady value up to Re = 1, 7 % at 50.
 */
#ifndef COUPLING_DISTURBANCE_H
#define COUPLING_DISTURBANCE_H

#include "coupling/coupling.h"

enum { CPL_DISTURBANCE_TABLE = 85 };

typedef struct cpl_disturbance {
  double share[CPL_DISTURBANCE_TABLE][CPL_MEMORY_VECTORS]; /* A_k by log Re */
} cpl_disturbance;

/* T of memory k over T. */
double cpl_memory_time(int k);
/* k(t) of above. */
double cpl_disturbance_kernel(double t, double re);
void cpl_disturbance_make(cpl_disturbance *table);
/* A_k, dimensionless; re >= 0. */
void cpl_disturbance_shares(const cpl_disturbance *table, double re,
                            double share[CPL_MEMORY_VECTORS]);

#endif
