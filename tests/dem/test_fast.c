/* ranks: 1 3 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The vector path against the plain loop: bed and gas, equal and unequal spheres, two materials,
 * every contact law, with and without friction, rolling resistance and cohesion. */
#define _GNU_SOURCE /* feenableexcept */
#include <fenv.h>

#include "common.h"

#include "../../libdem/src/fast.h"

enum { N = 400 };

typedef struct variant {
  int bed, materials, width, friction, fluid;
  double ratio; /* of diameters */
  int law, rolling, cohesion;
} variant;

static dem_t *create(const variant *v) {
  scene s = scene_with_law(v->law);
  const double d = 0.01, volume = N * PI / 6.0 * d * d * d, length = cbrt(volume / 0.3);
  const double floor_at[3] = {0.0, 0.0, 0.0}, up[3] = {0.0, 0.0, 1.0};
  for (int c = 0; c < 3; c++) {
    s.box.lo[c] = 0.0;
    s.box.hi[c] = length;
    s.box.periodic[c] = c < 2 || !v->bed;
  }
  s.params.gravity[2] = v->bed ? -9.81 : 0.0;
  if (isnan(s.contact.normal_stiffness))
    s.young = 1e7, s.params.impact_speed = 1.0;
  else
    s.contact.normal_stiffness = 2e3;
  s.contact.restitution = 0.8;
  s.contact.friction = v->friction ? 0.4 : 0.0;
  s.contact.rolling_friction = v->rolling ? 0.1 : 0.0;
  s.contact.work_of_adhesion = v->cohesion ? 0.05 : 0.0;
  dem_t *dem = scene_create(&s);
  if (v->materials == 2) {
    const dem_material other = {.name = "steel",
                                .density = 7800.0,
                                .youngs_modulus = s.young,
                                .poisson_ratio = s.young > 0.0 ? 0.25 : (double)NAN};
    int number;
    OK(dem_add_material(dem, &other, &number));
    s.contact.friction *= 0.5;
    s.contact.restitution = 0.6;
    OK(dem_set_contact(dem, 0, 1, &s.contact));
  }
  if (v->bed)
    OK(dem_add_plane(dem, "floor", 0, floor_at, up));
  dem_insert insert = random_spheres(N / 2, d / v->ratio, d, floor_at, length, 11);
  for (int k = 0; k < 2; k++) {
    if (k == 1 && v->materials == 2)
      strcpy(insert.material, "steel");
    insert.seed = 11 + k;
    OK(dem_insert_particles(dem, &insert, -1, NULL));
  }
  OK(dem_fast_limit(dem, 1));
  OK(dem_start(dem));
  stir(dem, 0.5);
  return dem;
}

static int64_t run(const variant *v, int advances, double steps, body *bodies) {
  dem_t *dem = create(v);
  const double su[3] = {1e-4, 0.0, 0.0};
  dem_report report;
  OK(dem_advance(dem, 400.0 * dem_stable_step(dem),
                 NULL)); /* plain, so that the start is the same */
  OK(dem_fast_limit(dem, v->width));
  for (int k = 0; k < advances; k++) {
    if (v->fluid)
      set_fluid(dem, su, 1e-3);
    OK(dem_advance(dem, steps * dem_stable_step(dem), NULL));
  }
  OK(dem_get_report(dem, &report));
  CLOSE(report.budget_error, 0.0, 1e-12);
  find_all(dem, MPI_COMM_WORLD, N, bodies);
  dem_destroy(dem);
  return report.contacts;
}

static const variant variants[] = {
    {1, 1, 0, 1, 0, 1.0, LINEAR, 0, 0}, {1, 2, 0, 1, 0, 1.0, LINEAR, 0, 0},
    {1, 1, 0, 0, 0, 1.0, LINEAR, 0, 0}, {1, 1, 0, 1, 1, 1.0, LINEAR, 0, 0},
    {1, 1, 0, 1, 0, 2.0, LINEAR, 0, 0}, {0, 1, 0, 1, 0, 1.0, LINEAR, 0, 0},
    {0, 2, 0, 1, 0, 2.0, LINEAR, 0, 0},
};
enum { VARIANTS = sizeof variants / sizeof variants[0] };

static double worst(const body *a, const body *b, size_t offset, int periodic) {
  double most = 0.0;
  const double length = cbrt(N * PI / 6.0 * 1e-6 / 0.3);
  for (int k = 0; k < N; k++)
    for (size_t c = 0; c < 3; c++) {
      double difference = ((const double *)&a[k])[offset + c] - ((const double *)&b[k])[offset + c];
      if (periodic)
        difference -= length * floor(difference / length + 0.5);
      most = fmax(most, fabs(difference));
    }
  return most;
}

static void compare_one(variant v, int advances, double steps, double growth) {
  static body plain[N], fast[N];
  v.width = 1;
  const int64_t contacts = run(&v, advances, steps, plain);
  assert_true(contacts > 10);
  for (v.width = 8; v.width >= 4; v.width -= 4) {
    assert_int_equal(run(&v, advances, steps, fast), contacts);
    double force = 0.0;
    for (int i = 0; i < N; i++)
      for (int c = 0; c < 3; c++)
        force = fmax(force, fabs(plain[i].force[c]));
    CLOSE(worst(fast, plain, 0, 1), 0.0, 1e-16 * growth);         /* x: 0.1 m */
    CLOSE(worst(fast, plain, 3, 0), 0.0, 1e-15 * growth);         /* v: 1 m/s */
    CLOSE(worst(fast, plain, 6, 0), 0.0, 1e-13 * growth);         /* omega: 100 rad/s */
    CLOSE(worst(fast, plain, 9, 0) / force, 0.0, 1e-12 * growth); /* overlap: 1e-4 m of x */
    CLOSE(worst(fast, plain, 12, 0), 0.0, 1e-19 * growth);
  }
}

static void compare(int advances, double steps, double growth) {
  for (int k = 0; k < VARIANTS; k++)
    compare_one(variants[k], advances, steps, growth);
}

/* All combinations of the parts of a contact, in every law; unequal spheres of two materials. */
static void laws_and_parts(void **state) {
  (void)state;
  for (int law = 0; law < LAWS; law++)
    for (int k = 0; k < 6; k++) {
      const variant v = {k % 2, 2, 0, k % 3 > 0, 0, 1.5, law, k % 3 > 1, k / 3};
      compare_one(v, 1, 1.0, 10.0);
      compare_one(v, 4, 50.0, 1e5);
    }
}

/* One substep: rounding only. */
static void first_step(void **state) {
  (void)state;
  compare(1, 1.0, 10.0);
}

/* Several hundred, a few collisions a particle: rounding errors grow by a factor with each. */
static void many_steps(void **state) {
  (void)state;
  compare(20, 50.0, 1e6);
}

/* Whoever traps floating point exceptions, as OpenFOAM does, sees none of the lanes without
 * contact: a lattice of spheres that just touch, where many distances are the sum of radii to the
 * bit. */
static void exceptions_are_held(void **state) {
  (void)state;
  const double origin[3] = {0.002, 0.002, 0.002};
  for (int tangential = 0; tangential < 2; tangential++) {
    scene s = scene_default();
    for (int c = 0; c < 3; c++) {
      s.box.lo[c] = 0.0;
      s.box.hi[c] = 0.032;
      s.box.periodic[c] = c < 2;
    }
    s.contact.friction = 0.4 * tangential;
    dem_t *dem = scene_create(&s);
    const dem_insert insert = lattice(DEM_FREE, 0.004, origin, 0.004, 8, 8, 7);
    OK(dem_insert_particles(dem, &insert, -1, NULL));
    feclearexcept(FE_ALL_EXCEPT);
    feenableexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW);
    const int started = dem_start(dem), advanced = dem_advance(dem, dem_stable_step(dem), NULL);
    fedisableexcept(FE_ALL_EXCEPT);
    OK(started);
    OK(advanced);
    dem_destroy(dem);
  }
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(first_step),
      cmocka_unit_test(many_steps),
      cmocka_unit_test(laws_and_parts),
      cmocka_unit_test(exceptions_are_held),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
