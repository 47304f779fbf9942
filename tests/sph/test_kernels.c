/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every kernel, in two and three dimensions: integral, slope, support, sums over lattices, the
 * factor of walls. */
#include "common.h"

static const double h = 0.7;

static double volume_of(int dim, double r) {
  return dim == 2 ? 2.0 * PI * r : 4.0 * PI * r * r;
}

/* Simpson with steps that end at the knots of splines: 1e-9 is far above its error. */
static void integral_is_1(void **state) {
  (void)state;
  enum { STEPS = 6000 };
  for (int k = 0; k < SPH_KERNEL_COUNT; k++)
    for (int dim = 2; dim <= 3; dim++) {
      const double step = sph_kernel_support(k) * h / STEPS;
      double sum = 0.0;
      for (int s = 0; s <= STEPS; s++)
        sum += (s == 0 || s == STEPS ? 1.0
                : s % 2              ? 4.0
                                     : 2.0) *
               volume_of(dim, s * step) * sph_kernel_value(k, dim, h, s * step);
      CLOSE(sum * step / 3.0, 1.0, 1e-9);
    }
}

/* Central difference: error O(d^2 W''') + round-off/d, below 1e-7 of W(0)/h. */
static void slope_is_the_derivative(void **state) {
  (void)state;
  const double d = 1e-5 * h;
  for (int k = 0; k < SPH_KERNEL_COUNT; k++)
    for (int dim = 2; dim <= 3; dim++) {
      const double top = sph_kernel_value(k, dim, h, 0.0);
      assert_true(isfinite(sph_kernel_slope(k, dim, h, 0.0)));
      for (double r = 0.013 * h; r < 1.05 * sph_kernel_support(k) * h; r += 0.0371 * h) {
        const double slope =
            (sph_kernel_value(k, dim, h, r + d) - sph_kernel_value(k, dim, h, r - d)) / (2.0 * d);
        CLOSE(r * sph_kernel_slope(k, dim, h, r), slope, 1e-7 * top / h);
        assert_true(slope <= 1e-9 * top / h);
      }
    }
}

static void support_ends(void **state) {
  (void)state;
  for (int k = 0; k < SPH_KERNEL_COUNT; k++) {
    const double end = sph_kernel_support(k) * h;
    assert_true(sph_kernel_value(k, 3, h, 0.98 * end) > 0.0);
    assert_true(sph_kernel_value(k, 3, h, end * (1.0 + 1e-12)) == 0.0);
    assert_true(sph_kernel_slope(k, 3, h, 1.3 * end) == 0.0);
    assert_true(sph_kernel_value(k, 3, h, 1.3 * end) == 0.0);
  }
  assert_true(isnan(sph_kernel_support(SPH_KERNEL_COUNT)));
}

typedef struct sums {
  double value, gradient[3], second[3];
} sums;

/* Sums over a lattice of spacing 1, about a point beside a node. */
static sums lattice(int k, int dim, double length, const double at[3]) {
  sums s;
  memset(&s, 0, sizeof s);
  const int n = (int)ceil(sph_kernel_support(k) * length) + 1;
  for (int a = -n; a <= n; a++)
    for (int b = -n; b <= n; b++)
      for (int c = dim == 2 ? 0 : -n; c <= (dim == 2 ? 0 : n); c++) {
        const double d[3] = {at[0] - a, at[1] - b, dim == 2 ? 0.0 : at[2] - c};
        const double r = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        const double slope = sph_kernel_slope(k, dim, length, r);
        s.value += sph_kernel_value(k, dim, length, r);
        for (int m = 0; m < 3; m++) {
          s.gradient[m] += slope * d[m];
          s.second[m] -= slope * d[m] * d[m];
        }
      }
  return s;
}

/* On a node and in the middle of a cell the gradient vanishes. Bars: what these kernels have at h
 * = 1.5 spacings (Wendland C4: 1.9), rounded up; a wrong norm or slope is far outside. */
static void sums_over_a_lattice(void **state) {
  (void)state;
  const double value_bar[SPH_KERNEL_COUNT] = {4e-3, 2e-4, 6e-3, 7e-4};
  const double second_bar[SPH_KERNEL_COUNT] = {1.6e-2, 5e-4, 3e-3, 2e-3};
  for (int k = 0; k < SPH_KERNEL_COUNT; k++)
    for (int dim = 2; dim <= 3; dim++)
      for (int middle = 0; middle < 2; middle++) {
        const double length = k == SPH_KERNEL_wendland_c4 ? 1.9 : 1.5;
        const double at[3] = {0.5 * middle, 0.5 * middle, 0.5 * middle};
        const sums s = lattice(k, dim, length, at);
        CLOSE(s.value, 1.0, value_bar[k]);
        for (int m = 0; m < dim; m++) {
          CLOSE(s.gradient[m], 0.0, 1e-14);
          CLOSE(s.second[m], 1.0, second_bar[k]);
        }
      }
}

/* Markauskas et al. 2017, eq. 17. */
static double gamma_of_the_paper(double y) {
  const double y2 = y * y, y3 = y2 * y;
  if (y > 2.0)
    return 1.0;
  if (y <= 1.0)
    return -(3.0 * y3 * y3 - 9.0 * y3 * y2 + 20.0 * y3 - 42.0 * y - 30.0) / 60.0;
  return (y3 * y3 - 9.0 * y3 * y2 + 30.0 * y2 * y2 - 40.0 * y3 + 48.0 * y + 28.0) / 60.0;
}

static void gamma_of_walls(void **state) {
  (void)state;
  for (double y = 0.0; y < 2.3; y += 0.05)
    CLOSE(sph_kernel_gamma(SPH_KERNEL_cubic_spline, 3, y), gamma_of_the_paper(y), 1e-9);
  for (int k = 0; k < SPH_KERNEL_COUNT; k++)
    for (int dim = 2; dim <= 3; dim++) {
      double before = 0.5;
      CLOSE(sph_kernel_gamma(k, dim, 0.0), 0.5, 1e-9);
      for (double y = 0.1; y < 3.2; y += 0.1) {
        const double gamma = sph_kernel_gamma(k, dim, y);
        assert_true(gamma >= before && gamma <= 1.0 + 1e-12);
        CLOSE(gamma + sph_kernel_gamma(k, dim, -y), 1.0, 1e-12);
        before = gamma;
      }
      CLOSE(before, 1.0, 0.0);
    }
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(integral_is_1),  cmocka_unit_test(slope_is_the_derivative),
      cmocka_unit_test(support_ends),   cmocka_unit_test(sums_over_a_lattice),
      cmocka_unit_test(gamma_of_walls),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
