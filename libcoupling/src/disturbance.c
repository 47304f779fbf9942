/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "disturbance.h"
#include <math.h>

/* Times of the memories over T, and Re of the table: beyond it the end values hold (below, k no
 * longer depends on Re; above, w is below 1e-4 f/(rho nu s0)). */
static const double FIRST_TIME = 0.002, TIME_RATIO = 7.0;
static const double LOWEST_RE = 1e-3, HIGHEST_RE = 1e4;
static const double SQRT_2_PI = 0.79788456080286535588; /* sqrt(2/pi) */

double cpl_memory_time(int k) {
  return FIRST_TIME * pow(TIME_RATIO, k);
}

double cpl_disturbance_kernel(double t, double re) {
  const double x = re * t / sqrt(1.0 + t), grown = pow(1.0 + t, -1.5);
  if (x < 1e-2) /* M/x^3 = sqrt(2/pi) (1/3 - x^2/10 + ...): the difference below loses all digits */
    return grown * SQRT_2_PI * (1.0 / 3.0 - x * x / 10.0);
  const double m = erf(x * 0.70710678118654752440) - SQRT_2_PI * x * exp(-0.5 * x * x);
  return grown * m / (x * x * x);
}

/* int_a^b k dt by Simpson in log t; a > 0. */
static double integral(double a, double b, double re) {
  enum { INTERVALS = 16 };
  const double low = log(a), step = (log(b) - low) / INTERVALS;
  double sum = 0.0;
  for (int i = 0; i <= INTERVALS; i++) {
    const double t = exp(low + step * i), weight = i == 0 || i == INTERVALS ? 1.0
                                                   : i % 2                  ? 4.0
                                                                            : 2.0;
    sum += weight * t * cpl_disturbance_kernel(t, re);
  }
  return sum * step / 3.0;
}

/* From the last bound on: to 1e6 numerically, beyond as the last power law of k, t^(-3/2). */
static double tail(double a, double re) {
  double sum = 0.0;
  for (; a < 1e6; a *= 10.0)
    sum += integral(a, 10.0 * a, re);
  return sum + 2.0 * a * cpl_disturbance_kernel(a, re);
}

/* Solve A x = b, A symmetric and positive definite (n x n), by Cholesky; b becomes x. */
static void solve(double a[CPL_MEMORY_VECTORS][CPL_MEMORY_VECTORS], double *b) {
  const int n = CPL_MEMORY_VECTORS;
  for (int i = 0; i < n; i++)
    for (int j = 0; j <= i; j++) {
      double sum = a[i][j];
      for (int k = 0; k < j; k++)
        sum -= a[i][k] * a[j][k];
      a[i][j] = i == j ? sqrt(sum) : sum / a[j][j];
    }
  for (int i = 0; i < n; i++) {
    for (int k = 0; k < i; k++)
      b[i] -= a[i][k] * b[k];
    b[i] /= a[i][i];
  }
  for (int i = n - 1; i >= 0; i--) {
    for (int k = i + 1; k < n; k++)
      b[i] -= a[k][i] * b[k];
    b[i] /= a[i][i];
  }
}

/* A_k by least squares of the step response over log t, the steady end with nearly all weight. */
static void fit(double re, double share[CPL_MEMORY_VECTORS]) {
  const double first = 1e-5, last = 1e5, growth = 1.15;
  double matrix[CPL_MEMORY_VECTORS][CPL_MEMORY_VECTORS] = {{0.0}};
  double response = first * cpl_disturbance_kernel(first, re), basis[CPL_MEMORY_VECTORS];
  for (int k = 0; k < CPL_MEMORY_VECTORS; k++)
    share[k] = 0.0;
  for (double t = first; t <= last * growth; t *= growth) {
    const int end = t > last;
    if (end)
      response += tail(t / growth, re);
    else if (t > first)
      response += integral(t / growth, t, re);
    for (int k = 0; k < CPL_MEMORY_VECTORS; k++)
      basis[k] = end ? 1.0 : -expm1(-t / cpl_memory_time(k));
    const double weight = end ? 1e6 : 1.0;
    for (int i = 0; i < CPL_MEMORY_VECTORS; i++) {
      share[i] += weight * basis[i] * response;
      for (int j = 0; j < CPL_MEMORY_VECTORS; j++)
        matrix[i][j] += weight * basis[i] * basis[j];
    }
  }
  solve(matrix, share);
}

void cpl_disturbance_make(cpl_disturbance *table) {
  const double growth = pow(HIGHEST_RE / LOWEST_RE, 1.0 / (CPL_DISTURBANCE_TABLE - 1));
  double re = LOWEST_RE;
  for (int i = 0; i < CPL_DISTURBANCE_TABLE; i++, re *= growth)
    fit(re, table->share[i]);
}

void cpl_disturbance_shares(const cpl_disturbance *table, double re,
                            double share[CPL_MEMORY_VECTORS]) {
  const double place = log(fmin(fmax(re, LOWEST_RE), HIGHEST_RE) / LOWEST_RE) /
                       log(HIGHEST_RE / LOWEST_RE) * (CPL_DISTURBANCE_TABLE - 1);
  const int i = (int)fmin(place, CPL_DISTURBANCE_TABLE - 2);
  const double part = place - i;
  for (int k = 0; k < CPL_MEMORY_VECTORS; k++)
    share[k] = (1.0 - part) * table->share[i][k] + part * table->share[i + 1][k];
}
