/* ranks: 1 2 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Motion without contact against closed forms. */
#include "common.h"

static const double origin[3] = {0.1, -0.2, 0.3}, still[3] = {0.0, 0.0, 0.0};

/* Constant acceleration is exact for any step: only rounding is left. */
static void free_fall(void **state) {
  (void)state;
  for (int n = 1; n <= 1000; n *= 10) {
    scene s = scene_default();
    const double v0[3] = {0.3, 0.2, 0.1}, t = 0.2;
    s.params.gravity[2] = -9.81;
    dem_t *dem = scene_create(&s);
    add_sphere(dem, DEM_FREE, -1, origin, 0.01, v0);
    OK(dem_start(dem));
    for (int k = 0; k < n; k++)
      OK(dem_advance(dem, t / n, NULL));
    const body b = find(dem, s.comm, 0);
    for (int c = 0; c < 3; c++) {
      const double g = s.params.gravity[c];
      CLOSE(b.x[c], origin[c] + v0[c] * t + 0.5 * g * t * t, 1e-14 * sqrt(n));
      CLOSE(b.v[c], v0[c] + g * t, 1e-14 * sqrt(n));
    }
    CLOSE(dem_time(dem), t, 1e-15 * n);
    dem_destroy(dem);
  }
}

/* m dv/dt = m g + Su - Sp v for Sp dt/m over twelve decades: velocity, position and impulse. */
static void drag(void **state) {
  (void)state;
  const double dt = 1e-3, r = 0.005, su[3] = {2e-3, 0.0, -1e-3}, v0[3] = {0.5, -0.1, 0.2};
  const int n = 5;
  for (double stiff = 1e-6; stiff < 2e6; stiff *= 10.0) {
    scene s = scene_default();
    s.params.gravity[1] = -9.81;
    const double m = sphere_mass(s.density, r), sp = stiff * m / dt, t = n * dt, b = sp * t / m;
    dem_t *dem = scene_create(&s);
    add_sphere(dem, DEM_FREE, -1, origin, r, v0);
    OK(dem_start(dem));
    double impulse[3] = {0.0, 0.0, 0.0};
    for (int k = 0; k < n; k++) {
      set_fluid(dem, su, sp);
      OK(dem_advance(dem, dt, NULL));
      const body now = find(dem, s.comm, 0);
      for (int c = 0; c < 3; c++)
        impulse[c] += now.impulse[c];
    }
    const body got = find(dem, s.comm, 0);
    for (int c = 0; c < 3; c++) {
      const double f = su[c] + m * s.params.gravity[c], end = f / sp;
      const double v = v0[c] * exp(-b) - f / sp * expm1(-b);
      /* Written so that neither end of the range cancels. */
      const double x = b < 1e-2 ? v0[c] * t * (1.0 - b / 2.0 + b * b / 6.0) +
                                      f / m * t * t * (0.5 - b / 6.0 + b * b / 24.0)
                                : end * t - (v0[c] - end) * m / sp * expm1(-b);
      const double size = fabs(v0[c]) + fabs(f) / m * t;
      CLOSE(got.v[c], v, 1e-14 * size);
      CLOSE(got.x[c], origin[c] + x, b < 1e-2 ? 1e-14 + b * b * b * size * t : 1e-14);
      CLOSE(m * (got.v[c] - v0[c]), m * s.params.gravity[c] * t + impulse[c], 2e-15 * m * size);
    }
    dem_destroy(dem);
  }
}

/* Markauskas et al. 2017 eq. 3-4: v = integral of g [rho_f/rho_s + (1 - rho_f/rho_s) xi]. */
static void ramp(void **state) {
  (void)state;
  scene s = scene_default();
  const double ramp_time = 0.1, rho = 1000.0, ratio = rho / s.density, g = 9.81;
  s.params.gravity[2] = -g;
  s.params.ramp_time = ramp_time;
  s.params.ramp_fluid_density = rho;
  dem_t *dem = scene_create(&s);
  add_sphere(dem, DEM_FREE, -1, origin, 0.01, still);
  OK(dem_start(dem));
  double t = 0.0;
  for (int k = 0; k < 15; k++) {
    OK(dem_advance(dem, 0.01, NULL));
    t += 0.01;
    const double end = t < ramp_time ? t : ramp_time;
    const double xi = 0.5 * (end - ramp_time / PI * sin(PI * end / ramp_time)) + (t - end);
    CLOSE(find(dem, s.comm, 0).v[2], -g * (ratio * t + (1.0 - ratio) * xi), 1e-14);
  }
  dem_report report;
  OK(dem_get_report(dem, &report));
  CLOSE(report.budget_error, 0.0, 1e-14);
  dem_destroy(dem);

  s.params.ramp_fluid_density = 0.0;
  FAILS(PART_ERR_RANGE, "rampFluidDensity", dem_create(s.comm, &s.box, &s.params, &dem));
}

static void kick(void **state) {
  (void)state;
  scene s = scene_default();
  dem_t *dem = scene_create(&s);
  add_sphere(dem, DEM_FREE, -1, origin, 0.01, still);
  add_sphere(dem, DEM_FIXED, -1, still, 0.01, still);
  OK(dem_start(dem));
  const part_store *store = dem_store(dem);
  double *impulse = calloc(3 * (size_t)store->local + 1, sizeof *impulse);
  for (int i = 0; i < store->local; i++)
    impulse[3 * i] = 2e-3;
  OK(dem_kick(dem, impulse));
  CLOSE(find(dem, s.comm, 0).v[0], 2e-3 / sphere_mass(s.density, 0.01), 1e-15);
  CLOSE(find(dem, s.comm, 1).v[0], 0.0, 0.0);
  dem_report report;
  OK(dem_get_report(dem, &report));
  CLOSE(report.fluid_impulse[0], 2e-3, 1e-18);
  CLOSE(report.budget_error, 0.0, 1e-15);
  if (store->local > 0)
    impulse[0] = NAN;
  FAILS(PART_ERR_NUMERIC, "not finite", dem_kick(dem, impulse));
  free(impulse);
  dem_destroy(dem);
}

static void bad_states(void **state) {
  (void)state;
  scene s = scene_default();
  dem_t *dem = scene_create(&s);
  FAILS(PART_ERR_STATE, "dem_start", dem_advance(dem, 1.0, NULL));
  FAILS(PART_ERR_STATE, "no particles", dem_start(dem));
  add_sphere(dem, DEM_FREE, -1, origin, 0.01, still);
  OK(dem_start(dem));
  FAILS(PART_ERR_STATE, "once", dem_start(dem));
  FAILS(PART_ERR_RANGE, "positive", dem_advance(dem, -1.0, NULL));
  const double su[3] = {NAN, 0.0, 0.0};
  set_fluid(dem, su, 0.0);
  FAILS(PART_ERR_NUMERIC, "particle 0", dem_advance(dem, 1e-3, NULL));
  set_fluid(dem, still, -1.0);
  FAILS(PART_ERR_NUMERIC, "Sp >= 0", dem_advance(dem, 1e-3, NULL));
  dem_destroy(dem);
}

/* A particle that leaves a bounded direction is an error with its id; an unbounded one is not. */
static void leaves(void **state) {
  (void)state;
  const double v[3] = {100.0, 0.0, 0.0};
  for (int bounded = 0; bounded <= 1; bounded++) {
    scene s = scene_default();
    s.box.bounded[0] = bounded;
    dem_t *dem = scene_create(&s);
    add_sphere(dem, DEM_FREE, -1, origin, 0.01, v);
    OK(dem_start(dem));
    if (bounded)
      FAILS(PART_ERR_OUTSIDE, "0", dem_advance(dem, 0.1, NULL));
    else
      OK(dem_advance(dem, 0.1, NULL));
    dem_destroy(dem);
  }
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(free_fall), cmocka_unit_test(drag),       cmocka_unit_test(ramp),
      cmocka_unit_test(kick),      cmocka_unit_test(bad_states), cmocka_unit_test(leaves),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
