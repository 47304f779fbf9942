/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Drag laws: published numbers, limits, and what every row of drag_laws.def has to keep. */
#include <fenv.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>
#include "scene.h"

static const double PI = 3.14159265358979323846;

static int law_number(const char *name) {
  for (int k = 0; k < cpl_drag_count(); k++)
    if (strcmp(cpl_drag_name(k), name) == 0)
      return k;
  fail_msg("no drag law %s", name);
  return -1;
}

/* Force on one sphere of 1 mm in water (1000 kg/m3, 1e-3 Pa s) against the superficial slip w,
 * computed independently in Python from Markauskas et al. 2017, eq. 19, 21, 22 and from Robinson et
 * al. 2014, eq. 29, printed to 10 digits. */
static const struct {
  const char *law;
  double eps, w, force;
} reference[] = {
    {"stokes", 1.00, 1e-4, 9.424777961e-10},   {"stokes", 1.00, 1.0, 9.424777961e-06},
    {"stokes", 0.50, 1e-2, 9.424777961e-08},   {"diFelice", 1.00, 1e-4, 9.814427942e-10},
    {"diFelice", 1.00, 1e-2, 1.811695823e-07}, {"diFelice", 1.00, 1.0, 2.400155397e-04},
    {"diFelice", 0.90, 1e-4, 1.444976943e-09}, {"diFelice", 0.90, 1e-2, 2.518491269e-07},
    {"diFelice", 0.90, 1.0, 3.466459595e-04},  {"diFelice", 0.79, 1e-4, 2.331959934e-09},
    {"diFelice", 0.79, 1e-2, 3.785659872e-07}, {"diFelice", 0.79, 1.0, 5.462808439e-04},
    {"diFelice", 0.50, 1e-4, 1.250486067e-08}, {"diFelice", 0.50, 1e-2, 1.582043941e-06},
    {"diFelice", 0.50, 1.0, 2.694795166e-03},
};

static void test_published_numbers(void **state) {
  (void)state;
  for (size_t k = 0; k < sizeof reference / sizeof *reference; k++) {
    const double slip = reference[k].w / reference[k].eps;
    const cpl_drag_law law = cpl_drag_function(law_number(reference[k].law));
    const double force = slip * law(slip, 1e-3, reference[k].eps, 1000.0, 1e-3);
    /* the reference has 10 digits */
    assert_near(force / reference[k].force, 1.0, 6e-10);
  }
}

/* C_d -> 4.8^2/Re and chi -> 3.7, so beta -> 2.88 pi mu d eps^(1 - 3.7). */
static void test_di_felice_at_rest(void **state) {
  (void)state;
  const cpl_drag_law law = cpl_drag_function(law_number("diFelice"));
  for (double eps = 0.3; eps <= 1.0; eps += 0.1) {
    const double limit = 2.88 * PI * 1e-3 * 2e-3 * pow(eps, 1.0 - 3.7);
    assert_near(law(0.0, 2e-3, eps, 1000.0, 1e-3) / limit, 1.0, 1e-14);
    /* continuous: the part in |u|^(1/2) has gone at 1e-20 m/s to 2 sqrt(1e-20 rho d/mu) = 1e-8 */
    assert_near(law(1e-20, 2e-3, eps, 1000.0, 1e-3) / limit, 1.0, 1e-8);
  }
}

/* High Re: C_d -> 0.63^2 and chi -> 3.7. */
static void test_di_felice_fast(void **state) {
  (void)state;
  const cpl_drag_law law = cpl_drag_function(law_number("diFelice"));
  const double slip = 1e10, d = 1e-2, eps = 0.6;
  const double limit = PI / 8.0 * 0.63 * 0.63 * 1000.0 * d * d * slip * pow(eps, 2.0 - 3.7);
  /* 2 * 4.8/0.63/sqrt(Re) with Re = 6e13 is 2e-6 */
  assert_near(law(slip, d, eps, 1000.0, 1e-3) / limit, 1.0, 4e-6);
}

/* Every row: finite, positive, force grows with slip, not defined by a trap at rest. */
static void test_every_law(void **state) {
  (void)state;
  assert_true(cpl_drag_count() >= 2);
  for (int k = 0; k < cpl_drag_count(); k++) {
    const cpl_drag_law law = cpl_drag_function(k);
    assert_non_null(cpl_drag_name(k));
    for (double eps = 0.05; eps <= 1.0; eps += 0.05) {
      double last = 0.0;
      for (double slip = 1e-12; slip < 1e4; slip *= 1.7) {
        const double beta = law(slip, 1e-3, eps, 1000.0, 1e-3);
        assert_true(isfinite(beta) && beta > 0.0);
        assert_true(beta * slip > last);
        last = beta * slip;
      }
    }
  }
  assert_null(cpl_drag_name(-1));
  assert_null(cpl_drag_function(cpl_drag_count()));
}

/* A flow solver may trap floating point exceptions; a particle at rest must not raise one. */
static void test_no_trap_at_rest(void **state) {
  (void)state;
  feclearexcept(FE_ALL_EXCEPT);
  volatile double sum = 0.0;
  for (int k = 0; k < cpl_drag_count(); k++)
    sum += cpl_drag_function(k)(0.0, 1e-3, 1.0, 1000.0, 1e-3);
  assert_true(sum > 0.0);
  assert_int_equal(fetestexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_published_numbers), cmocka_unit_test(test_di_felice_at_rest),
      cmocka_unit_test(test_di_felice_fast),    cmocka_unit_test(test_every_law),
      cmocka_unit_test(test_no_trap_at_rest),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
