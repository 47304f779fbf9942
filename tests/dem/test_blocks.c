/* ranks: 1 2 3 4 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rigid blocks and fixed particles: one translation, shares of the fluid impulse, supports. */
#include "common.h"

static const double still[3] = {0.0, 0.0, 0.0};
enum { NX = 4, NY = 3, NZ = 5, MEMBERS = NX * NY * NZ };

static dem_t *block_scene(scene *s, int periodic) {
  const double at[3] = {-0.05, -0.05, 0.1};
  for (int c = 0; c < 3; c++)
    s->box.periodic[c] = periodic;
  dem_t *dem = scene_create(s);
  dem_insert insert = lattice(DEM_BLOCK, 0.01, at, 0.0133, NX, NY, NZ);
  OK(dem_insert_particles(dem, &insert, 0, NULL));
  return dem;
}

/* Different for every member, by id. */
static void uneven_fluid(dem_t *dem, double sp) {
  const part_store *store = dem_store(dem);
  const int64_t *id = part_field_int64(store, DEM_FIELD_ID);
  double *fluid = part_field_double(store, DEM_FIELD_FLUID_SU);
  for (int i = 0; i < store->local; i++) {
    const double k = (double)id[4 * i];
    fluid[8 * i] = 1e-3 * sin(k);
    fluid[8 * i + 1] = -2e-4 * k;
    fluid[8 * i + 2] = 1e-2;
    fluid[8 * i + 3] = sp * (1.0 + 0.5 * cos(k));
  }
}

static void sums(double sp, double su[3], double *sp_sum) {
  su[0] = su[1] = su[2] = *sp_sum = 0.0;
  for (int k = 0; k < MEMBERS; k++) {
    su[0] += 1e-3 * sin(k);
    su[1] -= 2e-4 * k;
    su[2] += 1e-2;
    *sp_sum += sp * (1.0 + 0.5 * cos(k));
  }
}

/* All members move by the closed form of the whole; their shares add up to its impulse. */
static void one_body(void **state) {
  (void)state;
  const double dt = 1e-3;
  for (double stiff = 1e-6; stiff < 2e6; stiff *= 100.0) {
    scene s = scene_default();
    s.params.gravity[2] = -9.81;
    dem_t *dem = block_scene(&s, 1);
    OK(dem_start(dem));
    assert_true(isinf(dem_stable_step(dem)));
    const double mass = MEMBERS * sphere_mass(s.density, 0.005), sp = stiff * mass / MEMBERS / dt;
    double su[3], sp_sum, x0[3], x1[3], v[3], v1[3], shares[3] = {0.0, 0.0, 0.0};
    body first[MEMBERS], last[MEMBERS];
    find_all(dem, s.comm, MEMBERS, first);
    OK(dem_block_state(dem, 0, x0, v));
    int substeps;
    const int steps = 20;
    for (int k = 0; k < steps; k++) {
      uneven_fluid(dem, sp);
      OK(dem_advance(dem, dt, &substeps));
      assert_int_equal(substeps, 1);
      find_all(dem, s.comm, MEMBERS, last);
      for (int m = 0; m < MEMBERS; m++)
        for (int c = 0; c < 3; c++)
          shares[c] += last[m].impulse[c];
    }
    sums(sp, su, &sp_sum);
    OK(dem_block_state(dem, 0, x1, v1));
    for (int c = 0; c < 3; c++) {
      const double f = su[c] + mass * s.params.gravity[c], t = steps * dt;
      const double b = sp_sum * t / mass;
      CLOSE(v1[c], -f / sp_sum * expm1(-b), 1e-13 * fabs(f) / mass * t);
      CLOSE(mass * v1[c], mass * s.params.gravity[c] * t + shares[c], 1e-14 * fabs(f) * t);
      for (int m = 0; m < MEMBERS; m++) {
        double way = last[m].x[c] - first[m].x[c];
        way -= 2.0 * floor(way / 2.0 + 0.5); /* over the periodic box */
        CLOSE(way, x1[c] - x0[c], 1e-15 * steps);
        CLOSE(last[m].v[c], v1[c], 0.0);
      }
    }
    dem_report report;
    OK(dem_get_report(dem, &report));
    CLOSE(report.budget_error, 0.0, 1e-13);
    dem_destroy(dem);
  }
}

/* The state is the same on every rank, bit for bit, while a block lands on a floor. */
static void same_on_all_ranks(void **state) {
  (void)state;
  scene s = scene_default();
  const double up[3] = {0.0, 0.0, 1.0}, floor_at[3] = {0.0, 0.0, 0.09};
  s.params.gravity[2] = -9.81;
  s.contact.restitution = 0.1;
  s.contact.friction = 0.3;
  dem_t *dem = block_scene(&s, 0);
  add_sphere(dem, DEM_FREE, -1, (double[3]){-0.04, -0.045, 0.18}, 0.006, still);
  OK(dem_add_plane(dem, "floor", 0, floor_at, up));
  OK(dem_start(dem));
  double mine[6], roots[6];
  int contacts = 0;
  for (int k = 0; k < 100; k++) {
    OK(dem_advance(dem, 2e-3, NULL));
    OK(dem_block_state(dem, 0, mine, mine + 3));
    memcpy(roots, mine, sizeof roots);
    MPI_Bcast(roots, 6, MPI_DOUBLE, 0, MPI_COMM_WORLD);
    assert_memory_equal(mine, roots, sizeof mine);
    dem_report report;
    OK(dem_get_report(dem, &report));
    contacts += report.wall_contacts > 0;
  }
  dem_report report;
  OK(dem_get_report(dem, &report));
  CLOSE(report.budget_error, 0.0, 1e-12);
  assert_true(contacts > 10);
  /* At rest on the floor: twelve members deep, each with its share of the weight. */
  const double weight = (MEMBERS * sphere_mass(s.density, 0.005)) * 9.81;
  CLOSE(mine[2] - (0.1 + 2 * 0.0133), -0.005 - weight / (NX * NY) / 1e5, 2e-5);
  dem_destroy(dem);
}

/* A plate that lands on all its members has the restitution asked for, whatever their number, and
 * the stable step knows that they push together. */
static void flat_landing(void **state) {
  (void)state;
  const double up[3] = {0.0, 0.0, 1.0};
  for (int n = 1; n <= 20; n += 19) {
    scene s = scene_default();
    s.contact.restitution = 0.4;
    s.params.time_step_fraction = 1.0 / 200;
    dem_t *dem = scene_create(&s);
    dem_insert insert = lattice(DEM_BLOCK, 0.01, (double[3]){-0.2, -0.2, 0.0052}, 0.0133, n, n, 1);
    insert.velocity[2] = -0.5;
    OK(dem_insert_particles(dem, &insert, 0, NULL));
    OK(dem_add_plane(dem, "floor", 0, still, up));
    OK(dem_start(dem));
    double x[3], v[3];
    const double contact_time = PI * sqrt(sphere_mass(s.density, 0.005) / 1e5);
    CLOSE(dem_stable_step(dem), contact_time / 200, 1e-12 * contact_time);
    for (int k = 0; k < 10; k++)
      OK(dem_advance(dem, 2e-4, NULL));
    OK(dem_block_state(dem, 0, x, v));
    assert_true(x[2] > 0.005);
    /* First order in the step, as in test_collision. */
    const double zeta = -log(0.4) / sqrt(PI * PI + log(0.4) * log(0.4));
    CLOSE(v[2] / 0.5, 0.4, 2.0 * zeta * PI / 200 + 1e-3);
    dem_destroy(dem);
  }
}

/* A kick on members moves the block by the sum. */
static void kick_block(void **state) {
  (void)state;
  scene s = scene_default();
  dem_t *dem = block_scene(&s, 0);
  OK(dem_start(dem));
  const part_store *store = dem_store(dem);
  double *impulse = calloc(3 * (size_t)store->local + 1, sizeof *impulse), x[3], v[3];
  for (int i = 0; i < store->local; i++)
    impulse[3 * i + 1] = 1e-4;
  OK(dem_kick(dem, impulse));
  free(impulse);
  OK(dem_block_state(dem, 0, x, v));
  CLOSE(v[1], 1e-4 / sphere_mass(s.density, 0.005), 1e-14);
  CLOSE(find(dem, s.comm, 7).v[1], v[1], 0.0);
  FAILS(PART_ERR_RANGE, "block 1", dem_block_state(dem, 1, x, v));
  dem_destroy(dem);
}

/* Fixed particles stay, and hand fluid and contact forces to their support. */
static void fixed_stay(void **state) {
  (void)state;
  scene s = scene_default();
  s.params.gravity[2] = -9.81;
  s.contact.restitution = 0.6;
  s.contact.friction = 0.4;
  dem_t *dem = scene_create(&s);
  dem_insert insert = lattice(DEM_FIXED, 0.02, (double[3]){-0.1, -0.1, 0.0}, 0.02, 11, 11, 1);
  OK(dem_insert_particles(dem, &insert, -1, NULL));
  insert = lattice(DEM_FREE, 0.012, (double[3]){-0.05, -0.045, 0.02}, 0.015, 6, 6, 2);
  OK(dem_insert_particles(dem, &insert, -1, NULL));
  OK(dem_start(dem));
  body first[193], last[193];
  find_all(dem, s.comm, 193, first);
  const double su[3] = {1e-4, 0.0, 2e-4};
  dem_report report;
  int64_t contacts = 0;
  for (int k = 0; k < 50; k++) {
    set_fluid(dem, su, 1e-3);
    OK(dem_advance(dem, 1e-3, NULL));
    OK(dem_get_report(dem, &report));
    contacts += report.contacts;
  }
  find_all(dem, s.comm, 193, last);
  for (int k = 0; k < 121; k++)
    for (int c = 0; c < 3; c++) {
      CLOSE(last[k].x[c], first[k].x[c], 0.0);
      CLOSE(last[k].v[c], 0.0, 0.0);
      CLOSE(last[k].impulse[c], su[c] * 1e-3, 1e-22);
    }
  assert_true(contacts > 10);
  assert_true(report.support_impulse[2] > 0.0);
  CLOSE(report.budget_error, 0.0, 1e-13);
  dem_destroy(dem);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(flat_landing),      cmocka_unit_test(one_body),
      cmocka_unit_test(same_on_all_ranks), cmocka_unit_test(kick_block),
      cmocka_unit_test(fixed_stay),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
