/* ranks: 1 2 3 4 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Many bonds: on any number of ranks, across periodic borders, through files, on the vector path;
 * and bad input. */
#include "common.h"

#include "../../libdem/src/fast.h"

enum { NX = 9, NY = 5, NZ = 5, BODY = NX * NY * NZ, LOOSE = 60, N = BODY + LOOSE };

static const double r = 0.005;

static const char *path_of(const char *name) {
  static char path[300];
  const char *folder = getenv("TMPDIR");
  snprintf(path, sizeof path, "%s/dem-%s-%d.vtkhdf", folder != NULL ? folder : "/tmp", name,
           world_size());
  return path;
}

/* A bonded body of cubes flies into loose spheres and breaks in part; periodic in x and y. */
static dem_t *without_particles(MPI_Comm comm, double strength) {
  scene s = scene_default();
  dem_bond bond;
  part_params_default(&dem_bond_table, &bond);
  bond.youngs_modulus = 1e7;
  bond.poisson_ratio = 0.25;
  bond.tensile_strength = strength;
  bond.shear_strength = strength;
  bond.moment_contribution = 0.5;
  bond.damping = 0.05;
  bond.radius_fraction = 0.8;
  s.comm = comm;
  for (int c = 0; c < 3; c++) {
    s.box.lo[c] = 0.0;
    s.box.hi[c] = 0.12;
    s.box.periodic[c] = c < 2;
  }
  s.contact.friction = 0.4;
  s.contact.restitution = 0.7;
  s.contact.normal_stiffness = 2e4;
  const double floor_at[3] = {0.0, 0.0, 0.0}, up[3] = {0.0, 0.0, 1.0};
  dem_t *dem = scene_create(&s);
  const dem_material steel = {.name = "steel", .density = 4000.0};
  OK(dem_add_material(dem, &steel, NULL));
  OK(dem_add_bonds(dem, 1, 1, &bond));
  OK(dem_add_plane(dem, "floor", 0, floor_at, up));
  return dem;
}

static dem_t *body_and_spheres(MPI_Comm comm, double strength, int width) {
  dem_t *dem = without_particles(comm, strength);
  const double at[3] = {0.006, 0.04, 0.006}, loose[3] = {0.01, 0.01, 0.065};
  dem_insert insert = lattice(DEM_FREE, 2.0 * r, at, 2.0 * r, NX, NY, NZ);
  strcpy(insert.material, "steel");
  insert.velocity[0] = -2.0;
  insert.velocity[2] = -3.0;
  OK(dem_insert_particles(dem, &insert, -1, NULL));
  insert = random_spheres(LOOSE, 0.008, 0.01, loose, 0.05, 7);
  insert.extent[0] = 0.1;
  OK(dem_insert_particles(dem, &insert, -1, NULL));
  OK(dem_fast_limit(dem, width));
  OK(dem_start(dem));
  return dem;
}

static void run(dem_t *dem, int advances) {
  for (int k = 0; k < advances; k++)
    OK(dem_advance(dem, 2e-4, NULL));
}

static void compare(const body *a, const body *b, double tolerance) {
  for (int k = 0; k < N; k++)
    for (int c = 0; c < 3; c++) {
      /* A position may have been wrapped in one of them. */
      const double d = fabs(a[k].x[c] - b[k].x[c]);
      CLOSE(fmin(d, fabs(d - 0.12)), 0.0, 0.01 * tolerance);
      CLOSE(a[k].v[c], b[k].v[c], tolerance);
      CLOSE(a[k].w[c], b[k].w[c], 100.0 * tolerance);
    }
}

/* The same bonds break, at the same times. */
static void same_breaks(dem_t *a, dem_t *b, size_t at_least) {
  const dem_broken_bond *x, *y;
  size_t n, m;
  OK(dem_broken_bonds(a, &x, &n));
  OK(dem_broken_bonds(b, &y, &m));
  assert_int_equal(n, m);
  assert_true(n >= at_least);
  for (size_t k = 0; k < n; k++) {
    assert_int_equal(x[k].a, y[k].a);
    assert_int_equal(x[k].b, y[k].b);
    assert_int_equal(x[k].mode, y[k].mode);
    CLOSE(x[k].time, y[k].time, 1e-12);
    CLOSE(x[k].stress / y[k].stress, 1.0, 1e-6);
  }
}

/* All ranks against one: rounding, which grows in collisions. */
static void ranks(void **state) {
  (void)state;
  static body all[N], alone[N];
  dem_report here, there;
  dem_t *one = body_and_spheres(MPI_COMM_WORLD, 4e4, 0);
  dem_t *two = body_and_spheres(MPI_COMM_SELF, 4e4, 0);
  OK(dem_get_report(one, &here));
  assert_int_equal(here.bonds, 3 * BODY - NX * NY - NY * NZ - NZ * NX);
  run(one, 25);
  run(two, 25);
  find_all(one, MPI_COMM_WORLD, N, all);
  find_all(two, MPI_COMM_SELF, N, alone);
  compare(all, alone, 1e-7);
  same_breaks(one, two, 10);
  OK(dem_get_report(one, &here));
  OK(dem_get_report(two, &there));
  assert_int_equal(here.bonds, there.bonds);
  assert_true(here.bonds > 200);
  assert_int_equal(here.broken_bonds, there.broken_bonds);
  assert_int_equal(here.contacts, there.contacts);
  CLOSE(here.bond_energy / there.bond_energy, 1.0, 1e-6);
  assert_true(here.rebuilds > 3);
  CLOSE(here.budget_error, 0.0, 1e-12);
  dem_destroy(one);
  dem_destroy(two);
}

/* The vector path is the plain one. */
static void vector_path(void **state) {
  (void)state;
  static body plain[N], fast[N];
  dem_t *one = body_and_spheres(MPI_COMM_WORLD, 4e4, 1);
  run(one, 20);
  find_all(one, MPI_COMM_WORLD, N, plain);
  for (int width = 4; width <= 8; width += 4) {
    dem_t *two = body_and_spheres(MPI_COMM_WORLD, 4e4, width);
    run(two, 20);
    find_all(two, MPI_COMM_WORLD, N, fast);
    compare(plain, fast, 1e-7);
    same_breaks(one, two, 10);
    dem_destroy(two);
  }
  dem_destroy(one);
}

static void same_records(dem_t *a, dem_t *b) {
  const part_store *s = dem_store(a), *t = dem_store(b);
  assert_int_equal(s->local, t->local);
  for (int k = 0; k < DEM_RECORD_COUNT; k++)
    assert_memory_equal(s->record[k], t->record[k],
                        (size_t)s->local * (size_t)dem_layout.records[k].width * 8);
}

/* From a file in the middle of the impact: bit for bit on as many ranks, rounding on one. */
static void restart(void **state) {
  (void)state;
  static body a[N], b[N];
  const char *path = path_of("bonds");
  dem_report here, there;
  dem_t *one = body_and_spheres(MPI_COMM_WORLD, 4e4, 0);
  run(one, 15);
  OK(dem_write(one, path, NULL));
  dem_t *two = without_particles(MPI_COMM_WORLD, 4e4);
  dem_t *three = without_particles(MPI_COMM_SELF, 4e4);
  OK(dem_read(two, path));
  OK(dem_start(two));
  OK(dem_read(three, path));
  OK(dem_start(three));
  CLOSE(dem_stable_step(two), dem_stable_step(one), 0.0);
  same_records(one, two);
  same_breaks(one, two, 1);
  run(one, 10);
  run(two, 10);
  run(three, 10);
  same_records(one, two);
  OK(dem_get_report(one, &here));
  OK(dem_get_report(two, &there));
  assert_memory_equal(&here, &there, sizeof here);
  same_breaks(one, two, 10);
  find_all(one, MPI_COMM_WORLD, N, a);
  find_all(three, MPI_COMM_SELF, N, b);
  compare(a, b, 1e-7);
  same_breaks(one, three, 10);
  dem_destroy(one);
  dem_destroy(two);
  dem_destroy(three);
  /* Without rules the bonds of the file would be lost. */
  scene s = scene_default();
  const double floor_at[3] = {0.0, 0.0, 0.0}, up[3] = {0.0, 0.0, 1.0};
  dem_t *four = scene_create(&s);
  const dem_material steel = {.name = "steel", .density = 4000.0};
  OK(dem_add_material(four, &steel, NULL));
  OK(dem_add_plane(four, "floor", 0, floor_at, up));
  OK(dem_read(four, path));
  FAILS(PART_ERR_FORMAT, "no rule of bonds", dem_start(four));
  dem_destroy(four);
  MPI_Barrier(MPI_COMM_WORLD);
  if (world_rank() == 0)
    remove(path);
}

/* A ring closed over the periodic border, spun off through every rank: nothing but rounding. */
static void ring_over_border(void **state) {
  (void)state;
  enum { RING = 12 };
  scene s = scene_default();
  dem_bond bond;
  part_params_default(&dem_bond_table, &bond);
  bond.youngs_modulus = 1e6;
  bond.poisson_ratio = 0.2;
  for (int c = 0; c < 3; c++) {
    s.box.lo[c] = 0.0;
    s.box.hi[c] = RING * 2.0 * r;
    s.box.periodic[c] = 1;
  }
  const double at[3] = {0.5 * r, 0.06, 0.06};
  dem_t *dem = scene_create(&s);
  OK(dem_add_bonds(dem, -1, -1, &bond));
  dem_insert row = lattice(DEM_FREE, 2.0 * r, at, 2.0 * r, RING, 1, 1);
  row.velocity[0] = 3.0;
  row.velocity[1] = -2.0;
  OK(dem_insert_particles(dem, &row, -1, NULL));
  OK(dem_start(dem));
  for (int k = 0; k < 60; k++) { /* 0.06 s: 1.5 lengths of the box */
    OK(dem_advance(dem, 0.001, NULL));
    if (k % 10 != 9)
      continue;
    body b[RING];
    dem_report report;
    find_all(dem, MPI_COMM_WORLD, RING, b);
    OK(dem_get_report(dem, &report));
    assert_int_equal(report.bonds, RING);
    for (int i = 0; i < RING; i++) {
      CLOSE(b[i].v[0], 3.0, 1e-9);
      CLOSE(b[i].v[1], -2.0, 1e-9);
    }
    CLOSE(report.bond_energy, 0.0, 1e-18); /* J; kinetic 0.1 */
  }
  dem_destroy(dem);
}

/* ---- bad input ----------------------------------------------------------------------------------
 */
static int add(double normal, double shear, double modulus, double ratio, int flat) {
  scene s = scene_default();
  dem_bond bond;
  part_params_default(&dem_bond_table, &bond);
  s.params.dimensions = flat ? 2 : 3;
  s.params.depth = flat ? 0.1 : 0.0;
  bond.normal_stiffness = normal;
  bond.shear_stiffness = shear;
  bond.youngs_modulus = modulus;
  bond.poisson_ratio = ratio;
  dem_t *dem = scene_create(&s);
  const int status = dem_add_bonds(dem, -1, -1, &bond);
  dem_destroy(dem);
  return status;
}

static void bad_rules(void **state) {
  (void)state;
  FAILS(PART_ERR_RANGE, "normalStiffness or youngsModulus", add(0.0, 0.0, 0.0, 0.0, 0));
  FAILS(PART_ERR_RANGE, "normalStiffness or youngsModulus", add(1e9, 1e9, 1e7, 0.0, 0));
  FAILS(PART_ERR_RANGE, "shearStiffness belongs to", add(0.0, 1e9, 1e7, 0.0, 0));
  FAILS(PART_ERR_RANGE, "poissonRatio belongs to", add(1e9, 1e9, 0.0, 0.2, 0));
  FAILS(PART_ERR_RANGE, "must be below 1/3", add(0.0, 0.0, 1e7, 0.34, 1));
  FAILS(PART_ERR_RANGE, "entry poissonRatio", add(0.0, 0.0, 1e7, 0.5, 0));
  FAILS(PART_ERR_RANGE, "entry normalStiffness", add(-1.0, 0.0, 0.0, 0.0, 0));
  FAILS(PART_ERR_RANGE, "entry shearStiffness", add(1e9, -1.0, 0.0, 0.0, 0));
  FAILS(PART_ERR_RANGE, "entry youngsModulus", add(0.0, 0.0, -1.0, 0.0, 0));
}

typedef struct wrong {
  const char *entry;
  double value;
} wrong;

static void bad_entries(void **state) {
  (void)state;
  static const wrong list[] = {
      {"radiusFraction", 0.0},
      {"radiusFraction", 1.1},
      {"tensileStrength", 0.0},
      {"shearStrength", -1.0},
      {"momentContribution", -0.1},
      {"momentContribution", 1.1},
      {"damping", -0.1},
      {"damping", 1.1},
      {"gapFraction", -0.1},
      {"gapFraction", 1.1},
      {"tensileStrength", (double)INFINITY},
      {"normalStiffness", (double)NAN},
  };
  dem_bond bond;
  part_params_default(&dem_bond_table, &bond);
  for (size_t k = 0; k < sizeof list / sizeof *list; k++)
    FAILS(PART_ERR_RANGE, list[k].entry,
          part_params_set(&dem_bond_table, list[k].entry, &list[k].value, NULL, &bond));
  FAILS(PART_ERR_ARGUMENT, "did you mean 'tensileStrength'",
        part_params_set(&dem_bond_table, "tensilStrength", &list[0].value, NULL, &bond));
}

static void bad_scenes(void **state) {
  (void)state;
  scene s = scene_default();
  dem_bond bond;
  const dem_bond_state *now;
  const dem_broken_bond *broken;
  size_t n;
  const double a[3] = {0.0, 0.0, 0.0}, b[3] = {2.02 * r, 0.0, 0.0}, c[3] = {0.0, 2.5 * r, 0.0};
  part_params_default(&dem_bond_table, &bond);
  bond.youngs_modulus = 1e7;
  dem_t *dem = scene_create(&s);
  FAILS(PART_ERR_RANGE, "numbers are 0 to 0", dem_add_bonds(dem, 0, 1, &bond));
  FAILS(PART_ERR_RANGE, "numbers are 0 to 0", dem_add_bonds(dem, -1, 0, &bond));
  OK(dem_add_bonds(dem, 0, 0, &bond));
  FAILS(PART_ERR_ARGUMENT, "given twice", dem_add_bonds(dem, 0, 0, &bond));
  add_sphere(dem, DEM_FREE, -1, a, r, a);
  add_sphere(dem, DEM_FREE, -1, b, r, a);
  FAILS(PART_ERR_STATE, "after dem_start", dem_bond_states(dem, &now, &n));
  FAILS(PART_ERR_STATE, "after dem_start", dem_broken_bonds(dem, &broken, &n));
  /* A gap of 0.02 r, over gapFraction 0.01. */
  FAILS(PART_ERR_RANGE, "no two particles of materials glass and glass", dem_start(dem));
  dem_destroy(dem);
  s.params.dimensions = 2;
  s.params.depth = 0.1;
  dem = scene_create(&s);
  OK(dem_add_bonds(dem, -1, -1, &bond));
  add_sphere(dem, DEM_FREE, -1, a, r, a);
  add_sphere(dem, DEM_FREE, -1, c, 1.5 * r, a);
  FAILS(PART_ERR_RANGE, "particles 0 and 1 have radii 0.005 and 0.0075", dem_start(dem));
  dem_destroy(dem);
  s = scene_default();
  dem = scene_create(&s);
  bond.gap_fraction = 0.05;
  OK(dem_add_bonds(dem, -1, -1, &bond));
  add_sphere(dem, DEM_FREE, -1, a, r, a);
  add_sphere(dem, DEM_FREE, -1, b, r, a);
  OK(dem_start(dem));
  FAILS(PART_ERR_STATE, "before dem_start", dem_add_bonds(dem, 0, 0, &bond));
  dem_destroy(dem);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(ranks),
      cmocka_unit_test(vector_path),
      cmocka_unit_test(restart),
      cmocka_unit_test(bad_rules),
      cmocka_unit_test(ring_over_border),
      cmocka_unit_test(bad_entries),
      cmocka_unit_test(bad_scenes),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
