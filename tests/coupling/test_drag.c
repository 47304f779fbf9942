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
 * al. 2014, eq. 29; the other laws from beta per volume as their papers print it, times V/(1 -
 * eps); printed to 10 digits. Mean diameter 0.8 mm. */
static const struct {
  const char *law;
  double eps, w, force;
} reference[] = {
    {"stokes", 1.00, 1e-4, 9.424777961e-10},
    {"stokes", 1.00, 1.0, 9.424777961e-06},
    {"stokes", 0.50, 1e-2, 9.424777961e-08},
    {"diFelice", 1.00, 1e-4, 9.814427942e-10},
    {"diFelice", 1.00, 1e-2, 1.811695823e-07},
    {"diFelice", 1.00, 1.0, 2.400155397e-04},
    {"diFelice", 0.90, 1e-4, 1.444976943e-09},
    {"diFelice", 0.90, 1e-2, 2.518491269e-07},
    {"diFelice", 0.90, 1.0, 3.466459595e-04},
    {"diFelice", 0.79, 1e-4, 2.331959934e-09},
    {"diFelice", 0.79, 1e-2, 3.785659872e-07},
    {"diFelice", 0.79, 1.0, 5.462808439e-04},
    {"diFelice", 0.50, 1e-4, 1.250486067e-08},
    {"diFelice", 0.50, 1e-2, 1.582043941e-06},
    {"diFelice", 0.50, 1.0, 2.694795166e-03},
    {"schillerNaumann", 1.00, 0.001, 1.0838494655e-08},
    {"schillerNaumann", 1.00, 0.5, 5.5239536813e-05},
    {"schillerNaumann", 1.00, 2, 6.9115038379e-04},
    {"coulsonRichardson", 1.00, 0.001, 1.0717866239e-08},
    {"coulsonRichardson", 1.00, 0.5, 5.5519414094e-05},
    {"coulsonRichardson", 1.00, 2, 6.6174951661e-04},
    {"wenYu", 0.90, 0.001, 1.5921493663e-08},
    {"wenYu", 0.90, 0.5, 8.1145580019e-05},
    {"wenYu", 0.90, 2, 1.0152836538e-03},
    {"wenYu", 0.45, 0.001, 1.9986801188e-07},
    {"wenYu", 0.45, 0.5, 1.0186485072e-03},
    {"wenYu", 0.45, 2, 1.2745206555e-02},
    {"ergun", 0.90, 0.001, 1.0827505545e-08},
    {"ergun", 0.90, 0.5, 2.8765611746e-04},
    {"ergun", 0.90, 2, 4.5443202376e-03},
    {"ergun", 0.45, 0.001, 2.1784294738e-07},
    {"ergun", 0.45, 0.5, 1.2378909324e-03},
    {"ergun", 0.45, 2, 1.8526346801e-02},
    {"gidaspow", 0.90, 0.001, 1.5921493663e-08},
    {"gidaspow", 0.90, 0.5, 8.1145580019e-05},
    {"gidaspow", 0.90, 2, 1.0152836538e-03},
    {"gidaspow", 0.45, 0.001, 2.1784294738e-07},
    {"gidaspow", 0.45, 0.5, 1.2378909324e-03},
    {"gidaspow", 0.45, 2, 1.8526346801e-02},
    {"gidaspowSmooth", 0.90, 0.001, 1.5859753355e-08},
    {"gidaspowSmooth", 0.90, 0.5, 8.3648535234e-05},
    {"gidaspowSmooth", 0.90, 2, 1.0580563890e-03},
    {"gidaspowSmooth", 0.45, 0.001, 2.1778067392e-07},
    {"gidaspowSmooth", 0.45, 0.5, 1.2371313757e-03},
    {"gidaspowSmooth", 0.45, 2, 1.8506318268e-02},
    {"syamlalOBrien", 0.90, 0.001, 1.8886149153e-08},
    {"syamlalOBrien", 0.90, 0.5, 1.2491919602e-04},
    {"syamlalOBrien", 0.90, 2, 1.5775430682e-03},
    {"syamlalOBrien", 0.45, 0.001, 1.3256288155e-07},
    {"syamlalOBrien", 0.45, 0.5, 1.3262297060e-03},
    {"syamlalOBrien", 0.45, 2, 1.8865549170e-02},
    {"kochHill", 0.90, 0.001, 2.4489451784e-08},
    {"kochHill", 0.90, 0.5, 1.4746724889e-04},
    {"kochHill", 0.90, 2, 2.2157911159e-03},
    {"kochHill", 0.45, 0.001, 2.5903771350e-07},
    {"kochHill", 0.45, 0.5, 8.9201328055e-04},
    {"kochHill", 0.45, 2, 1.2736322747e-02},
    {"beetstra", 0.90, 0.001, 2.3544606099e-08},
    {"beetstra", 0.90, 0.5, 1.2748032302e-04},
    {"beetstra", 0.90, 2, 1.6325966407e-03},
    {"beetstra", 0.45, 0.001, 2.6021254254e-07},
    {"beetstra", 0.45, 0.5, 9.2148123772e-04},
    {"beetstra", 0.45, 2, 1.1999864782e-02},
    {"beetstraPolydisperse", 0.90, 0.001, 3.2604002424e-08},
    {"beetstraPolydisperse", 0.90, 0.5, 1.4907960294e-04},
    {"beetstraPolydisperse", 0.90, 2, 1.8737290942e-03},
    {"beetstraPolydisperse", 0.45, 0.001, 3.8450783167e-07},
    {"beetstraPolydisperse", 0.45, 0.5, 1.1459381348e-03},
    {"beetstraPolydisperse", 0.45, 2, 1.4528821714e-02},
};

static void test_published_numbers(void **state) {
  (void)state;
  for (size_t k = 0; k < sizeof reference / sizeof *reference; k++) {
    const double slip = reference[k].w / reference[k].eps;
    const cpl_drag_law law = cpl_drag_function(law_number(reference[k].law));
    const double force = slip * law(slip, 1e-3, reference[k].eps, 1000.0, 1e-3, 0.8e-3);
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
    assert_near(law(0.0, 2e-3, eps, 1000.0, 1e-3, 2e-3) / limit, 1.0, 1e-14);
    /* continuous: the part in |u|^(1/2) has gone at 1e-20 m/s to 2 sqrt(1e-20 rho d/mu) = 1e-8 */
    assert_near(law(1e-20, 2e-3, eps, 1000.0, 1e-3, 2e-3) / limit, 1.0, 1e-8);
  }
}

/* High Re: C_d -> 0.63^2 and chi -> 3.7. */
static void test_di_felice_fast(void **state) {
  (void)state;
  const cpl_drag_law law = cpl_drag_function(law_number("diFelice"));
  const double slip = 1e10, d = 1e-2, eps = 0.6;
  const double limit = PI / 8.0 * 0.63 * 0.63 * 1000.0 * d * d * slip * pow(eps, 2.0 - 3.7);
  /* 2 * 4.8/0.63/sqrt(Re) with Re = 6e13 is 2e-6 */
  assert_near(law(slip, d, eps, 1000.0, 1e-3, d) / limit, 1.0, 4e-6);
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
        const double beta = law(slip, 1e-3, eps, 1000.0, 1e-3, 1e-3);
        assert_true(isfinite(beta) && beta > 0.0);
        assert_true(beta * slip > last);
        last = beta * slip;
      }
    }
  }
  assert_null(cpl_drag_name(-1));
  assert_null(cpl_drag_function(cpl_drag_count()));
}

/* Creeping flow past one sphere: every law for that limit is Stokes' within its own accuracy there
 * (Dallavalle's 4.8^2/24 = 0.96 is the worst); Ergun is for beds. */
static void test_one_slow_sphere(void **state) {
  (void)state;
  const double slip = 1e-6, stokes = 3.0 * PI * 1e-3 * 1e-3;
  for (int k = 0; k < cpl_drag_count(); k++) {
    if (strcmp(cpl_drag_name(k), "ergun") == 0)
      continue;
    /* the polydisperse factor of beetstra is 1.064 for one sphere */
    assert_near(cpl_drag_function(k)(slip, 1e-3, 1.0, 1000.0, 1e-3, 1e-3) / stokes, 1.0, 0.07);
  }
}

/* Pressure drop of a homogeneous bed from the drag on its spheres is Ergun's (1952). */
static void test_ergun_bed(void **state) {
  (void)state;
  const double d = 2e-3, rho = 1.2, mu = 1.8e-5, eps = 0.42, flow = 0.7;
  const double beta = cpl_drag_function(law_number("ergun"))(flow / eps, d, eps, rho, mu, d);
  /* model A: eps grad p = n beta u with n = (1 - eps)/V spheres per volume */
  const double n = (1.0 - eps) / (PI / 6.0 * d * d * d), drop = n * beta * flow / eps / eps;
  const double ergun = 150.0 * mu * flow * (1.0 - eps) * (1.0 - eps) / (eps * eps * eps * d * d) +
                       1.75 * rho * flow * flow * (1.0 - eps) / (eps * eps * eps * d);
  assert_near(drop / ergun, 1.0, 1e-14);
}

/* The smooth switch is gidaspow far from eps = 0.8, and continuous there. */
static void test_smooth_switch(void **state) {
  (void)state;
  const cpl_drag_law hard = cpl_drag_function(law_number("gidaspow"));
  const cpl_drag_law smooth = cpl_drag_function(law_number("gidaspowSmooth"));
  const double slip = 0.3, d = 1e-3;
  /* pi/2 - arctan(x) < 1/x: that much of the other law is left */
  for (double eps = 0.4; eps <= 1.0; eps += 0.1) {
    const double gap = fabs(eps - 0.8), mu = 1e-3, rho = 1000.0;
    const double mixed = smooth(slip, d, eps, rho, mu, d), one = hard(slip, d, eps, rho, mu, d);
    const double other =
        cpl_drag_function(law_number(eps < 0.8 ? "wenYu" : "ergun"))(slip, d, eps, rho, mu, d);
    if (gap > 0.05)
      assert_true((mixed - one) / (other - one) > 0.0 &&
                  (mixed - one) / (other - one) < 1.0 / (PI * 262.5 * gap));
  }
  const double below = smooth(slip, d, 0.8 - 1e-9, 1000.0, 1e-3, d);
  const double above = smooth(slip, d, 0.8 + 1e-9, 1000.0, 1e-3, d);
  assert_near(below / above, 1.0, 1e-6);
}

/* Ranges: every law has one, and a row that is none has none. */
static void test_ranges(void **state) {
  (void)state;
  for (int k = 0; k < cpl_drag_count(); k++) {
    const cpl_drag_range *range = cpl_drag_range_of(k);
    assert_true(range->re_low < range->re_high && range->eps_low < range->eps_high);
  }
  assert_null(cpl_drag_range_of(-1));
  assert_null(cpl_drag_range_of(cpl_drag_count()));
}

/* A flow solver may trap floating point exceptions; a particle at rest must not raise one. */
static void test_no_trap_at_rest(void **state) {
  (void)state;
  feclearexcept(FE_ALL_EXCEPT);
  volatile double sum = 0.0;
  for (int k = 0; k < cpl_drag_count(); k++)
    sum += cpl_drag_function(k)(0.0, 1e-3, 1.0, 1000.0, 1e-3, 1e-3);
  assert_true(sum > 0.0);
  assert_int_equal(fetestexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_published_numbers), cmocka_unit_test(test_di_felice_at_rest),
      cmocka_unit_test(test_di_felice_fast),    cmocka_unit_test(test_every_law),
      cmocka_unit_test(test_one_slow_sphere),   cmocka_unit_test(test_ergun_bed),
      cmocka_unit_test(test_smooth_switch),     cmocka_unit_test(test_ranges),
      cmocka_unit_test(test_no_trap_at_rest),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
