/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The fluid velocity that a force makes where it acts (libcoupling/src/disturbance.h). */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <cmocka.h>
#include "../../libcoupling/src/disturbance.h"
#include "scene.h"

static const double PI = 3.14159265358979323846;

static double sum_of(const cpl_disturbance *table, double re) {
  double share[CPL_MEMORY_VECTORS], sum = 0.0;
  cpl_disturbance_shares(table, re, share);
  for (int k = 0; k < CPL_MEMORY_VECTORS; k++)
    sum += share[k];
  return sum;
}

/* Steady force in creeping flow: w = f/(6 pi mu s0) sqrt(2/pi), so sum A_k = (2/3) sqrt(2/pi). */
static void test_stokes(void **state) {
  (void)state;
  cpl_disturbance table;
  cpl_disturbance_make(&table);
  assert_near(sum_of(&table, 0.0), 2.0 / 3.0 * sqrt(2.0 / PI), 2e-3);
}

/* The same response from Fourier space: w = 1/(rho (2 pi)^3) int (1 - kz^2/k^2) exp(-k^2 s0^2/2)
 * nu k^2/((nu k^2)^2 + (kz U)^2) d3k for a steady force; by the angle in closed form, then the
 * trapezoidal rule over k. */
static double fourier(double re) {
  const int n = 4000;
  double sum = 0.0;
  for (int i = 1; i < n; i++) { /* k s0 from 0 to 8; a = U/(nu k) = 2 re/(k s0) */
    const double k = 8.0 * i / n, a = 2.0 * re / k;
    /* int_-1^1 (1 - c^2)/(1 + a^2 c^2) dc */
    const double angle =
        a < 1e-3 ? 4.0 / 3.0 : 2.0 * ((1.0 + 1.0 / (a * a)) * atan(a) / a - 1.0 / (a * a));
    sum += exp(-0.5 * k * k) * angle * 8.0 / n;
  }
  /* w rho nu s0/f = sum/(2 pi)^2; in units of 1/(4 pi): */
  return 4.0 * PI * sum / (4.0 * PI * PI);
}

static void test_oseen(void **state) {
  (void)state;
  cpl_disturbance table;
  cpl_disturbance_make(&table);
  for (double re = 0.02; re < 2000.0; re *= 3.1)
    assert_near(sum_of(&table, re) / fourier(re), 1.0, 6e-3);
}

/* A force that begins at t = 0: the memories give the step response of the kernel to MEMORY_ERROR
 * of the steady value, the residual of the fit. */
static const double MEMORY_ERROR = 0.07;

static void test_memory(void **state) {
  (void)state;
  cpl_disturbance table;
  cpl_disturbance_make(&table);
  const double reynolds[] = {0.02, 1.0, 50.0};
  for (int r = 0; r < 3; r++) {
    double share[CPL_MEMORY_VECTORS], exact = 0.0, last = 0.0, worst = 0.0;
    cpl_disturbance_shares(&table, reynolds[r], share);
    const double steady = sum_of(&table, reynolds[r]);
    for (double t = 1e-5; t < 1e4; t *= 1.02) {
      exact += (t - last) * cpl_disturbance_kernel(0.5 * (t + last), reynolds[r]);
      last = t;
      double w = 0.0;
      for (int k = 0; k < CPL_MEMORY_VECTORS; k++)
        w -= share[k] * expm1(-t / cpl_memory_time(k));
      worst = fmax(worst, fabs(w - exact) / steady);
    }
    print_message("# Re %g: worst %g of the steady value\n", reynolds[r], worst);
    assert_true(worst < MEMORY_ERROR);
    assert_near(exact, steady, 0.02 * steady); /* what comes after 1e4 T: t^(-1/2) */
  }
}

int main(int argc, char **argv) {
  MPI_Init(&argc, &argv);
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_stokes),
      cmocka_unit_test(test_oseen),
      cmocka_unit_test(test_memory),
  };
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
