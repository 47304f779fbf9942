/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Kernels one value at a time, and what follows from their moments. */
#include "internal.h"
#include "kernels.h"

double sph_kernel_support(int kernel) {
  static const double support[] = {
#define SPH_KERNEL(name, key, support, meaning) support,
#include "sph/kernels.def"
#undef SPH_KERNEL
  };
  return kernel >= 0 && kernel < SPH_KERNEL_COUNT ? support[kernel] : NAN;
}

double sph_kernel_norm(int kernel, int dim) {
  switch (kernel) {
#define SPH_KERNEL(name, key, support, meaning)                                                    \
  case SPH_KERNEL_##name:                                                                          \
    return sph_norm_##name(dim);
#include "sph/kernels.def"
#undef SPH_KERNEL
  default:
    return NAN;
  }
}

double sph_shape(int kernel, double q) {
  switch (kernel) {
#define SPH_KERNEL(name, key, support, meaning)                                                    \
  case SPH_KERNEL_##name:                                                                          \
    return sph_shape_##name(q);
#include "sph/kernels.def"
#undef SPH_KERNEL
  default:
    return NAN;
  }
}

double sph_slope(int kernel, double q) {
  switch (kernel) {
#define SPH_KERNEL(name, key, support, meaning)                                                    \
  case SPH_KERNEL_##name:                                                                          \
    return sph_slope_##name(q);
#include "sph/kernels.def"
#undef SPH_KERNEL
  default:
    return NAN;
  }
}

double sph_kernel_value(int kernel, int dimensions, double h, double r) {
  return sph_kernel_norm(kernel, dimensions) / pow(h, dimensions) * sph_shape(kernel, r / h);
}

double sph_kernel_slope(int kernel, int dimensions, double h, double r) {
  return sph_kernel_norm(kernel, dimensions) / pow(h, dimensions + 2) * sph_slope(kernel, r / h);
}

/* Part of a sphere's or circle's circumference of radius q that is behind a plane at distance y. */
static double behind(int dim, double q, double y) {
  const double pi = 3.14159265358979323846;
  return dim == 3 ? 2.0 * pi * q * (q - y) : 2.0 * q * acos(y / q);
}

/* 1 less the integral over the part behind the plane; Simpson. In two dimensions the circumference
 * grows as a root at q = psi: steps in the square root of q - psi. */
double sph_kernel_gamma(int kernel, int dimensions, double psi) {
  enum { STEPS = 400 };
  const double support = sph_kernel_support(kernel), y = fabs(psi);
  double sum = 0.0;
  if (y >= support)
    return psi > 0.0 ? 1.0 : 0.0;
  const double step = sqrt(support - y) / STEPS;
  for (int k = 0; k <= STEPS; k++) {
    const double s = k * step, q = y + s * s,
                 weight = k == 0 || k == STEPS ? 1.0
                          : k % 2              ? 4.0
                                               : 2.0;
    if (q > 0.0)
      sum += weight * 2.0 * s * behind(dimensions, q, y) * sph_shape(kernel, q);
  }
  const double outside = sph_kernel_norm(kernel, dimensions) * sum * step / 3.0;
  return psi >= 0.0 ? 1.0 - outside : outside;
}

/* S of S.9: nu = alpha c h/S with S = 2 d (d+2)/((d+1) <q>), <q> the mean of q with weight W. */
double sph_kernel_monaghan(int kernel, int dimensions) {
  enum { STEPS = 400 };
  const double pi = 3.14159265358979323846, support = sph_kernel_support(kernel);
  const double step = support / STEPS, around = dimensions == 2 ? 2.0 * pi : 4.0 * pi;
  const int d = dimensions;
  double sum = 0.0;
  for (int k = 0; k <= STEPS; k++) {
    const double q = k * step, weight = k == 0 || k == STEPS ? 1.0 : k % 2 ? 4.0 : 2.0;
    sum += weight * pow(q, d) * sph_shape(kernel, q);
  }
  const double mean = sph_kernel_norm(kernel, d) * around * sum * step / 3.0;
  return 2.0 * d * (d + 2) / ((d + 1) * mean);
}
