/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What keeps particles even: shifting (S.19), and the pushes of S.20 and S.21 on two particles. */
#include "common.h"

/* Acceleration of the first of two particles along the line of both, and what S.7, S.20 and S.21
 * make of it. */
static double push(double pressure_a, double pressure_b, double repulsion, double clump,
                   double *wanted) {
  scene s = scene_2d(0.4, 0.4, 0.01);
  const double r = 0.008, x[6] = {0.2, 0.2, 0.0, 0.2 + r, 0.2, 0.0};
  const double p[2] = {pressure_a, pressure_b}, h = s.params.smoothing_length;
  double a = 0.0, rate = 0.0, volume[2] = {0.0, 0.0}, both = pressure_a + pressure_b;
  s.params.artificial_pressure = repulsion;
  s.params.anti_clump = clump;
  sph_t *sph = scene_create(&s);
  sph_view view;
  OK(sph_insert_points(sph, 2, x, NULL, NULL, p, NULL));
  OK(sph_start(sph));
  OK(sph_get_view(sph, &view));
  for (int i = 0; i < 2; i++) {
    const int second = view.position[view.xv_stride * i] > 0.2 + 0.5 * r;
    volume[second] = view.volume[view.xv_stride * i];
    if (!second) {
      a = view.acceleration[view.rate_stride * i];
      rate = view.density[view.mass_stride * i];
    }
  }
  const double f = sph_kernel_value(s.params.kernel, 2, h, r) /
                   sph_kernel_value(s.params.kernel, 2, h, s.params.spacing);
  double more = repulsion * (fmax(-pressure_a, 0.0) + fmax(-pressure_b, 0.0)) + clump * fabs(both);
  if (pressure_a > 0.0 && pressure_b > 0.0)
    more += 0.05 * repulsion * both;
  *wanted = volume[1] * (both + more * pow(f, 4.0)) * r / rate *
            sph_kernel_slope(s.params.kernel, 2, h, r) / s.params.depth;
  sph_destroy(sph);
  return a;
}

static void pushes(void **state) {
  (void)state;
  static const double p[][2] = {{-800.0, -500.0}, {300.0, 900.0}, {700.0, -400.0}};
  for (int k = 0; k < 3; k++)
    for (int n = 0; n < 4; n++) {
      double wanted;
      const double a = push(p[k][0], p[k][1], n % 2 ? 0.2 : 0.0, n / 2 ? 0.01 : 0.0, &wanted);
      assert_true(fabs(wanted) > 1e-3);
      CLOSE(a, wanted, 1e-10 * fabs(wanted));
    }
}

/* Least and mean distance of nearest neighbours, over the spacing. */
static void evenness(sph_t *sph, const scene *s, double *least, double *mean) {
  sph_view view;
  const double length = s->box.hi[0];
  *least = HUGE_VAL;
  *mean = 0.0;
  OK(sph_get_view(sph, &view));
  for (int i = 0; i < view.own; i++) {
    double near = HUGE_VAL;
    for (int j = 0; j < view.own; j++) {
      double d2 = 0.0;
      for (int c = 0; c < 2; c++) {
        const double d =
            view.position[view.xv_stride * i + c] - view.position[view.xv_stride * j + c];
        const double image = d - length * floor(d / length + 0.5);
        d2 += image * image;
      }
      if (j != i)
        near = fmin(near, d2);
    }
    *least = fmin(*least, sqrt(near) / s->params.spacing);
    *mean += sqrt(near) / s->params.spacing / view.own;
  }
}

/* Decaying vortices (Taylor and Green 1937) at Re = 100 without a background pressure, where
 * particles come to lie in lines and leave holes (a tensile instability). Returns the decay of
 * energy over the closed form's. */
static double vortices(double shifting, int scheme, double *least, double *mean) {
  const double speed = 0.1, k = 2.0 * PI, nu = 0.001;
  scene s = scene_2d(1.0, 1.0, 0.025);
  sph_report report[2];
  s.box.periodic[0] = s.box.periodic[1] = 1;
  s.params.sound_speed = 1.0;
  s.params.viscosity = 1000.0 * nu;
  s.params.shifting = shifting;
  s.params.time_scheme = scheme;
  sph_t *sph = scene_create(&s);
  fill_box(sph, &s);
  double *xv = part_record_double(sph_store(sph), SPH_RECORD_XV);
  for (int i = 0; i < sph_store(sph)->local; i++) {
    double *x = xv + 8 * i;
    x[4] = speed * sin(k * x[0]) * cos(k * x[1]);
    x[5] = -speed * cos(k * x[0]) * sin(k * x[1]);
  }
  OK(sph_start(sph));
  OK(sph_get_report(sph, &report[0]));
  OK(sph_advance(sph, 4.0, NULL));
  OK(sph_get_report(sph, &report[1]));
  CLOSE(report[1].budget_error, 0.0, 1e-12);
  evenness(sph, &s, least, mean);
  sph_destroy(sph);
  return log(report[0].kinetic_energy / report[1].kinetic_energy) / (4.0 * nu * k * k * 4.0);
}

static void vortices_stay_even(void **state) {
  (void)state;
  double least[3], mean[3];
  const double without = vortices(0.0, SPH_SYMPLECTIC, &least[0], &mean[0]);
  const double with = vortices(2.0, SPH_SYMPLECTIC, &least[1], &mean[1]);
  const double corrected = vortices(2.0, SPH_PREDICTOR_CORRECTOR, &least[2], &mean[2]);
  print_message(
      "decay %.3f %.3f %.3f, nearest neighbour: least %.3f %.3f %.3f, mean %.3f %.3f %.3f\n",
      without, with, corrected, least[0], least[1], least[2], mean[0], mean[1], mean[2]);
  for (int k = 1; k < 3; k++) {
    assert_true(least[k] > least[0]);
    assert_true(mean[k] > mean[0]);
  }
  assert_true(with < without && corrected < without);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(pushes),
      cmocka_unit_test(vortices_stay_even),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
