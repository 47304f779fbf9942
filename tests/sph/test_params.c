/* ranks: 1 2 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Input that is refused, and the errors of a run that goes wrong. */
#include "common.h"

static void refuse(const scene *s, const char *words) {
  sph_t *sph;
  FAILS(PART_ERR_RANGE, words, sph_create(s->comm, &s->box, &s->params, &sph));
  assert_null(sph);
}

static void parameters(void **state) {
  (void)state;
  sph_params empty;
  scene s = scene_2d(0.2, 0.2, 0.01);
  const scene good = s;
  sph_t *sph;
  part_params_default(&sph_params_table, &empty);
  assert_true(sph_create(s.comm, &s.box, &empty, &sph) != PART_OK);
  assert_non_null(strstr(part_last_error(), "spacing"));
  s.params.smoothing_length = 0.008;
  refuse(&s, "entry smoothingLength: 0.008 m is 0.8 spacings; must be in [0.9, 3]");
  s = good;
  s.params.depth = 0.0;
  refuse(&s, "entry depth must be given");
  s.params.dimensions = 3;
  s.params.depth = 1.0;
  refuse(&s, "entry depth is not allowed");
  s = good;
  s.params.gravity[2] = 1.0;
  refuse(&s, "entry gravity: its z component");
  s = good;
  s.box.periodic[2] = 1;
  refuse(&s, "periodic in z");
  s = good;
  s.params.density_scheme = SPH_SUMMATION;
  s.params.xsph = 0.5;
  refuse(&s, "entry xsph: 0.5 is not allowed with densityScheme summation");
  s.params.gradient_correction = 1;
  refuse(&s, "entry gradientCorrection: on is not allowed with densityScheme summation");
  s.params.shifting = 2.0;
  refuse(&s, "entry shifting: 2 is not allowed with densityScheme summation");
  s.params.density_diffusion = 0.1;
  refuse(&s, "entry densityDiffusion: 0.1 is not allowed with densityScheme summation");
  s = good;
  s.params.courant = 1.1;
  refuse(&s, "courant");
  s = good;
  s.params.density = -1.0;
  refuse(&s, "density");
  s = good;
  s.params.kernel = SPH_KERNEL_COUNT;
  refuse(&s, "kernel");
  assert_string_equal(part_params_nearest(&sph_params_table, "soundspeed"), "soundSpeed");
}

static void filling(void **state) {
  (void)state;
  scene s = scene_2d(0.2, 0.2, 0.01);
  sph_insert box;
  double x[6] = {0.1, 0.1, 0.0, 0.11, 0.1, 0.0}, v[6] = {0.0}, volume[2] = {1e-5, 1e-5},
         p[2] = {0.0};
  int64_t n;
  sph_t *sph = scene_create(&s);
  part_params_default(&sph_insert_table, &box);
  FAILS(PART_ERR_ARGUMENT, "entry origin is missing", sph_insert_box(sph, &box, &n));
  for (int c = 0; c < 3; c++) {
    box.origin[c] = c < 2 ? 0.05 : 0.0;
    box.extent[c] = 0.102;
  }
  OK(sph_insert_box(sph, &box, &n));
  assert_int_equal(n, 100);
  box.extent[0] = 0.2;
  FAILS(PART_ERR_OUTSIDE, "outside the domain", sph_insert_box(sph, &box, &n));
  box.extent[0] = 0.004;
  FAILS(PART_ERR_RANGE, "entry extent: component 0 is 0.004 m", sph_insert_box(sph, &box, &n));
  box.extent[0] = 0.1;
  box.origin[2] = 0.001;
  FAILS(PART_ERR_RANGE, "z is 0.001 m; with dimensions 2", sph_insert_box(sph, &box, &n));
  box.origin[2] = 0.0;
  box.velocity[2] = 1.0;
  FAILS(PART_ERR_RANGE, "entry velocity", sph_insert_box(sph, &box, &n));
  OK(sph_insert_points(sph, 2, x, v, volume, p, &n));
  assert_int_equal(n, 2 * world_size());
  volume[1] = 0.0;
  FAILS(PART_ERR_RANGE, "point 1: its volume is 0", sph_insert_points(sph, 2, x, v, volume, p, &n));
  volume[1] = 1e-5;
  v[3] = (double)NAN;
  FAILS(PART_ERR_NUMERIC, "point 1: its velocity", sph_insert_points(sph, 2, x, v, volume, p, &n));
  v[3] = 0.0;
  x[3] = 0.3;
  FAILS(PART_ERR_OUTSIDE, "point 1 at (0.3 0.1 0) m",
        sph_insert_points(sph, 2, x, v, volume, p, &n));
  x[3] = 0.1;
  p[1] = -1e9;
  FAILS(PART_ERR_RANGE, "no density gives -1e+09 Pa",
        sph_insert_points(sph, 2, x, v, volume, p, &n));
  sph_destroy(sph);
}

static void order_of_calls(void **state) {
  (void)state;
  scene s = scene_2d(0.2, 0.2, 0.01);
  sph_t *sph = scene_create(&s);
  sph_report report;
  sph_view view;
  double eps[500], step;
  FAILS(PART_ERR_STATE, "sph_start", sph_advance(sph, 1.0, NULL));
  FAILS(PART_ERR_STATE, "sph_start", sph_get_report(sph, &report));
  FAILS(PART_ERR_STATE, "sph_start", sph_get_view(sph, &view));
  FAILS(PART_ERR_STATE, "sph_start", sph_stable_step(sph, &step));
  FAILS(PART_ERR_STATE, "no particles", sph_start(sph));
  fill_box(sph, &s);
  OK(sph_start(sph));
  FAILS(PART_ERR_STATE, "called once", sph_start(sph));
  FAILS(PART_ERR_STATE, "before sph_start",
        sph_insert_box(sph, &(sph_insert){.hydrostatic = 0}, NULL));
  FAILS(PART_ERR_RANGE, "must be positive", sph_advance(sph, 0.0, NULL));
  OK(sph_get_view(sph, &view));
  for (int i = 0; i < 500; i++)
    eps[i] = 1.5;
  FAILS(PART_ERR_RANGE, "eps is 1.5; must be in (0, 1]", sph_displace(sph, eps));
  if (view.own > 0)
    view.eps[0] = 0.0;
  FAILS(PART_ERR_RANGE, "eps is 0; must be in (0, 1]", sph_advance(sph, 1e-3, NULL));
  if (view.own > 0) {
    view.eps[0] = 1.0;
    view.force[2] = 1.0;
  }
  FAILS(PART_ERR_RANGE, "z component of 1 N", sph_advance(sph, 1e-3, NULL));
  if (view.own > 0)
    view.force[2] = (double)NAN;
  FAILS(PART_ERR_NUMERIC, "force on it is not finite", sph_advance(sph, 1e-3, NULL));
  if (view.own > 0)
    view.force[2] = 0.0;
  OK(sph_stable_step(sph, &step));
  CLOSE(step, 0.7 * 0.015 / 10.0, 1e-15);
  OK(sph_advance(sph, step, NULL));
  FAILS(PART_ERR_STATE, "before sph_advance", sph_displace(sph, eps));
  sph_destroy(sph);
}

/* A flow faster than its speed of sound, and a box too short for its kernel. */
static void errors_of_a_run(void **state) {
  (void)state;
  scene s = scene_2d(0.2, 0.2, 0.01);
  s.params.gravity[1] = -1000.0;
  s.params.sound_speed = 1.0;
  sph_t *sph = scene_create(&s);
  fill_box(sph, &s);
  OK(sph_start(sph));
  FAILS(PART_ERR_NUMERIC, "is faster than sound: soundSpeed must be", sph_advance(sph, 1.0, NULL));
  assert_non_null(strstr(part_last_error(), "particle "));
  assert_non_null(strstr(part_last_error(), "time 0.00"));
  sph_destroy(sph);
  s = scene_2d(0.05, 0.2, 0.01);
  s.box.periodic[0] = 1;
  sph = scene_create(&s);
  fill_box(sph, &s);
  FAILS(PART_ERR_RANGE, "0.05 m long in its periodic direction 0; must be at least",
        sph_start(sph));
  sph_destroy(sph);
}

/* Of a fluid in a box without walls every outermost particle is at a free surface. */
static void summation_at_a_surface(void **state) {
  (void)state;
  scene s = scene_2d(0.2, 0.2, 0.01);
  s.params.density_scheme = SPH_SUMMATION;
  sph_t *sph = scene_create(&s);
  fill_box(sph, &s);
  FAILS(PART_ERR_RANGE, "entry densityScheme: summation gives particle", sph_start(sph));
  assert_non_null(strstr(part_last_error(), "must be continuity"));
  sph_destroy(sph);
  s.box.periodic[0] = s.box.periodic[1] = 1;
  sph = scene_create(&s);
  fill_box(sph, &s);
  OK(sph_start(sph));
  sph_destroy(sph);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(parameters),
      cmocka_unit_test(filling),
      cmocka_unit_test(order_of_calls),
      cmocka_unit_test(errors_of_a_run),
      cmocka_unit_test(summation_at_a_surface),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
