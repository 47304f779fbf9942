/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps at half the limits of S.15, at them, and beyond. Up to the largest fractions that the
 * parameters allow, stirred water with a step of porosity (1 to 0.4) stays as it should; larger
 * ones are refused. With the limits broken on purpose (inside the library, where no user gets) a
 * run ends with an error that names particle, place and time: no garbage goes on. */
#include "../../libsph/src/internal.h"
#include "common.h"

static const double depth = 0.2, g = 9.81, dx = 0.01;

static scene tank(int time_scheme, double share) {
  scene s = scene_2d(0.2, 0.3, dx);
  s.params.gravity[1] = -g;
  s.params.sound_speed = 15.0;
  s.params.viscosity = 1e-3;
  s.params.artificial_viscosity = 0.1;
  s.params.time_scheme = time_scheme;
  s.params.courant = share * 1.0; /* each is the upper end of its range */
  s.params.viscous_fraction = share * 0.25;
  s.params.force_fraction = share * 0.5;
  return s;
}

/* Solids in the lower half, at rest; they carry (1 - eps) of the pressure gradient. */
static double eps_of(double y) {
  return 0.7 + 0.3 * tanh((y - 0.5 * depth) / 0.02);
}

static void set_solids(sph_t *sph) {
  sph_view view;
  OK(sph_get_view(sph, &view));
  for (int i = 0; i < view.own; i++) {
    const double y = view.position[view.xv_stride * i + 1], t = tanh((y - 0.5 * depth) / 0.02);
    view.eps[view.mass_stride * i] = eps_of(y);
    view.eps_gradient[view.force_stride * i + 1] = 0.3 * (1.0 - t * t) / 0.02;
    view.force[view.force_stride * i + 1] =
        -g * view.mass[view.mass_stride * i] * (1.0 / eps_of(y) - 1.0);
  }
}

static sph_t *make(const scene *s) {
  sph_view view;
  sph_t *sph = scene_create(s);
  add_planes(sph, s, 0, SPH_NO_SLIP);
  add_planes(sph, s, 1, SPH_NO_SLIP);
  fill_water(sph, s, depth, 1);
  stir(sph, s, 0.3);
  OK(sph_start(sph));
  OK(sph_get_view(sph, &view));
  double *eps = calloc((size_t)view.own + 1, sizeof *eps);
  for (int i = 0; i < view.own; i++)
    eps[i] = eps_of(view.position[view.xv_stride * i + 1]);
  OK(sph_displace(sph, eps));
  free(eps);
  return sph;
}

static int run(sph_t *sph, long long steps) {
  sph_report r;
  do {
    double step;
    set_solids(sph);
    PART_TRY(sph_stable_step(sph, &step));
    PART_TRY(sph_advance(sph, 20.0 * step, NULL));
    OK(sph_get_report(sph, &r));
  } while (r.steps < steps);
  return PART_OK;
}

static void within(void **state) {
  (void)state;
  for (int k = 0; k < 4; k++) {
    const int scheme = k % 2 ? SPH_PREDICTOR_CORRECTOR : SPH_SYMPLECTIC;
    const double share = k < 2 ? 0.5 : 1.0;
    const scene s = tank(scheme, share);
    sph_t *sph = make(&s);
    sph_report before, r;
    OK(sph_get_report(sph, &before));
    OK(run(sph, 4000));
    OK(sph_get_report(sph, &r));
    print_message(
        "%s, %g of the limits: %.3f s, %lld steps, speed up to %.4f m/s, density %.2f to %.2f\n",
        scheme == SPH_SYMPLECTIC ? "symplectic" : "predictorCorrector", share, sph_time(sph),
        r.steps, r.max_speed, r.least_density, r.most_density);
    assert_int_equal(r.particles, before.particles);
    assert_true(r.kinetic_energy < before.kinetic_energy);
    assert_true(r.max_speed <
                0.3); /* that of the stirring, at rest in the end but for the surface */
    CLOSE(r.least_density, 1000.0, 20.0);
    CLOSE(r.most_density, 1000.0, 20.0);
    CLOSE(r.budget_error, 0.0, 1e-12);
    sph_destroy(sph);
  }
}

static void refused(void **state) {
  (void)state;
  const scene good = tank(SPH_SYMPLECTIC, 1.0);
  static const char *const names[] = {"courant", "viscousFraction", "forceFraction"};
  for (int k = 0; k < 3; k++) {
    scene s = good;
    sph_t *sph;
    double *const entry[] = {&s.params.courant, &s.params.viscous_fraction,
                             &s.params.force_fraction};
    *entry[k] *= 1.5;
    FAILS(PART_ERR_RANGE, names[k], sph_create(s.comm, &s.box, &s.params, &sph));
  }
}

/* The water is as it was in `within`. */
static void still_good(sph_t *sph) {
  sph_report r;
  OK(sph_get_report(sph, &r));
  assert_true(r.max_speed < 0.3);
  CLOSE(r.least_density, 1000.0, 20.0);
  CLOSE(r.most_density, 1000.0, 20.0);
}

static void breaks(int scheme, double beyond) {
  const scene s = tank(scheme, 1.0);
  sph_t *sph = make(&s);
  sph->params.courant *= beyond;
  sph->params.viscous_fraction = sph->params.force_fraction = 10.0; /* courant is the limit */
  const int status = run(sph, 4000);
  print_message("%s, courant %g: %s\n",
                scheme == SPH_SYMPLECTIC ? "symplectic" : "predictorCorrector", beyond,
                status == PART_OK ? "stays" : part_last_error());
  if (status == PART_OK && beyond < 2.0) {
    still_good(sph);
  } else {
    assert_int_equal(status, PART_ERR_NUMERIC);
    assert_non_null(strstr(part_last_error(), "particle "));
    assert_non_null(strstr(part_last_error(), " m, time "));
    assert_non_null(strstr(part_last_error(), "step"));
  }
  sph_destroy(sph);
}

/* The instability grows until a particle is faster than sound, far from its density, or moves
 * farther in a step than its lists allow, within some ten steps. At 1.5 the symplectic scheme may
 * hold: the limit is that of the densest solids. */
static void detected(void **state) {
  (void)state;
  for (int k = 0; k < 6; k++)
    breaks(k % 2 ? SPH_PREDICTOR_CORRECTOR : SPH_SYMPLECTIC, 1.5 + 0.75 * (k / 2));
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(within),
      cmocka_unit_test(refused),
      cmocka_unit_test(detected),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
