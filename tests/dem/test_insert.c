/* ranks: 1 3 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Insertion: what comes out, and every kind of bad input. */
#include "common.h"

static const double lo[3] = {-0.5, -0.5, -0.5};

/* A file that all ranks see; rank 0 writes. */
static void write_text(const char *path, const char *text) {
  if (world_rank() == 0) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
  }
  MPI_Barrier(MPI_COMM_WORLD);
}

static const char *path_of(const char *name) {
  static char path[300];
  const char *folder = getenv("TMPDIR");
  snprintf(path, sizeof path, "%s/dem-%s-%d.txt", folder != NULL ? folder : "/tmp", name,
           world_size());
  return path;
}

static void random_is_repeatable(void **state) {
  (void)state;
  enum { N = 500 };
  static body all[N], own[N], seeded[N];
  scene s = scene_default();
  dem_insert insert = random_spheres(N, 0.05, 0.1, lo, 1.0, 11);
  for (int run = 0; run < 3; run++) {
    int64_t inserted;
    s.comm = run == 1 ? MPI_COMM_SELF : MPI_COMM_WORLD;
    insert.seed = run == 2 ? 12 : 11;
    dem_t *dem = scene_create(&s);
    OK(dem_insert_particles(dem, &insert, -1, &inserted));
    assert_int_equal(inserted, N);
    OK(dem_start(dem));
    find_all(dem, s.comm, N, run == 0 ? all : run == 1 ? own : seeded);
    dem_destroy(dem);
  }
  for (int k = 0; k < N; k++) {
    assert_memory_equal(all[k].x, own[k].x, sizeof all[k].x);
    assert_memory_not_equal(all[k].x, seeded[k].x, sizeof all[k].x);
    for (int c = 0; c < 3; c++)
      assert_true(fabs(all[k].x[c]) <= 0.475);
    for (int m = 0; m < k; m++) { /* no two closer than the smallest diameter */
      double d2 = 0.0;
      for (int c = 0; c < 3; c++)
        d2 += (all[k].x[c] - all[m].x[c]) * (all[k].x[c] - all[m].x[c]);
      assert_true(d2 >= 0.05 * 0.05);
    }
  }
}

static void rotated_lattice(void **state) {
  (void)state;
  scene s = scene_default();
  dem_t *dem = scene_create(&s);
  dem_insert insert = lattice(DEM_FREE, 0.05, (double[3]){0.1, 0.2, 0.3}, 0.1, 3, 2, 2);
  insert.rotation_axis[2] = 2.0;
  insert.rotation_angle = PI / 6.0;
  OK(dem_insert_particles(dem, &insert, -1, NULL));
  OK(dem_start(dem));
  const body b = find(dem, s.comm, 2), d = find(dem, s.comm, 11);
  CLOSE(b.x[0], 0.1 + 0.2 * cos(PI / 6.0), 1e-15);
  CLOSE(b.x[1], 0.2 + 0.2 * sin(PI / 6.0), 1e-15);
  CLOSE(d.x[0], 0.1 + 0.2 * cos(PI / 6.0) - 0.1 * sin(PI / 6.0), 1e-15);
  CLOSE(d.x[2], 0.4, 1e-15);
  dem_destroy(dem);
}

static void bad_lattice(void **state) {
  (void)state;
  scene s = scene_default();
  dem_t *dem = scene_create(&s);
  const double at[3] = {0.0, 0.0, 0.0};
  dem_insert insert = lattice(DEM_FREE, -0.1, at, 0.2, 2, 2, 2);
  FAILS(PART_ERR_RANGE, "diameter", dem_insert_particles(dem, &insert, -1, NULL));
  insert = lattice(DEM_FREE, 0.1, at, 0.2, 2, 0, 2);
  FAILS(PART_ERR_RANGE, "zero particles", dem_insert_particles(dem, &insert, -1, NULL));
  insert = lattice(DEM_FREE, 0.1, at, 0.09, 2, 2, 2);
  FAILS(PART_ERR_OVERLAP, "particles 0 and 1 overlap by 0.01 m",
        dem_insert_particles(dem, &insert, -1, NULL));
  insert = lattice(DEM_FREE, 0.1, at, 0.6, 2, 2, 3);
  FAILS(PART_ERR_OUTSIDE, "particle 8", dem_insert_particles(dem, &insert, -1, NULL));
  insert = lattice(DEM_FREE, 2.5, at, 0.6, 1, 1, 1);
  FAILS(PART_ERR_RANGE, "larger than the domain", dem_insert_particles(dem, &insert, -1, NULL));
  insert = lattice(DEM_FREE, 0.1, at, 0.2, 2, 2, 2);
  insert.count[1] = 1.5;
  FAILS(PART_ERR_RANGE, "whole", dem_insert_particles(dem, &insert, -1, NULL));
  insert.count[1] = 2;
  strcpy(insert.material, "glas");
  FAILS(PART_ERR_ARGUMENT, "did you mean 'glass'", dem_insert_particles(dem, &insert, -1, NULL));
  strcpy(insert.material, "glass");
  insert.kind = DEM_BLOCK;
  FAILS(PART_ERR_RANGE, "block number -1", dem_insert_particles(dem, &insert, -1, NULL));
  insert.kind = DEM_FIXED;
  insert.velocity[1] = 1.0;
  FAILS(PART_ERR_RANGE, "velocity", dem_insert_particles(dem, &insert, -1, NULL));
  insert.kind = DEM_FREE;
  OK(dem_insert_particles(dem, &insert, -1, NULL));
  FAILS(PART_ERR_OVERLAP, "particles 0 and 8", dem_insert_particles(dem, &insert, -1, NULL));
  dem_destroy(dem);
}

/* Across a periodic border, too. */
static void overlap_over_border(void **state) {
  (void)state;
  scene s = scene_default();
  s.box.periodic[0] = 1;
  dem_t *dem = scene_create(&s);
  const double a[3] = {-0.98, 0.0, 0.0}, b[3] = {0.97, 0.0, 0.0}, v[3] = {0.0, 0.0, 0.0};
  add_sphere(dem, DEM_FREE, -1, a, 0.05, v);
  dem_insert insert = lattice(DEM_FREE, 0.1, b, 0.0, 1, 1, 1);
  FAILS(PART_ERR_OVERLAP, "particles 0 and 1 overlap by 0.05 m",
        dem_insert_particles(dem, &insert, -1, NULL));
  dem_destroy(dem);
}

static void bad_random(void **state) {
  (void)state;
  scene s = scene_default();
  dem_t *dem = scene_create(&s);
  dem_insert insert = random_spheres(0, 0.1, 0.0, lo, 1.0, 1);
  FAILS(PART_ERR_RANGE, "zero particles", dem_insert_particles(dem, &insert, -1, NULL));
  insert = random_spheres(10000, 0.1, 0.0, lo, 1.0, 1);
  FAILS(PART_ERR_RANGE, "would fill 5.24", dem_insert_particles(dem, &insert, -1, NULL));
  insert = random_spheres(900, 0.1, 0.0, lo, 1.0, 1);
  FAILS(PART_ERR_RANGE, "of 900 spheres", dem_insert_particles(dem, &insert, -1, NULL));
  insert = random_spheres(10, 0.1, 0.05, lo, 1.0, 1);
  FAILS(PART_ERR_RANGE, "diameterMax", dem_insert_particles(dem, &insert, -1, NULL));
  insert = random_spheres(10, 0.1, 0.0, lo, 0.05, 1);
  FAILS(PART_ERR_RANGE, "does not hold", dem_insert_particles(dem, &insert, -1, NULL));
  dem_destroy(dem);
}

static dem_insert from_file(const char *path) {
  dem_insert insert = lattice(DEM_FREE, 0.0, lo, 0.0, 0, 0, 0);
  insert.method = DEM_INSERT_FILE;
  strcpy(insert.file, path);
  return insert;
}

static void files(void **state) {
  (void)state;
  scene s = scene_default();
  const char *path = path_of("insert");
  const struct {
    const char *text, *words;
    int status;
  } bad[] = {
      {"0 0 0 0.1\n0.5 nan 0 0.1\n", "line 2: 'nan", PART_ERR_FORMAT},
      {"0 0 0 0.1\n\n0.5 x1 0 0.1\n", "line 3: 'x1", PART_ERR_FORMAT},
      {"# c\n0 0 0\n", "line 2: 3 numbers", PART_ERR_FORMAT},
      {"0 0 0 -0.1\n", "line 1: diameter -0.1", PART_ERR_RANGE},
      {"# nothing\n", "zero particles", PART_ERR_RANGE},
      {"0 0 0 0.1\n0.05 0 0 0.1\n", "particles 0 and 1", PART_ERR_OVERLAP},
      {"0 0 3 0.1\n", "particle 0", PART_ERR_OUTSIDE},
  };
  dem_insert insert = from_file(path);
  for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
    dem_t *dem = scene_create(&s);
    write_text(path, bad[k].text);
    FAILS(bad[k].status, bad[k].words, dem_insert_particles(dem, &insert, -1, NULL));
    dem_destroy(dem);
  }
  dem_t *dem = scene_create(&s);
  write_text(path, "# x y z d vx vy vz\n0.1 0.2 0.3 0.05 # one\n\n-0.1 0 0 0.04 1 2 3");
  insert.velocity[2] = -0.5;
  OK(dem_insert_particles(dem, &insert, -1, NULL));
  OK(dem_start(dem));
  CLOSE(find(dem, s.comm, 0).v[2], -0.5, 0.0);
  CLOSE(find(dem, s.comm, 1).v[1], 2.0, 0.0);
  CLOSE(find(dem, s.comm, 1).x[0], -0.1, 0.0);
  dem_destroy(dem);
  if (world_rank() == 0)
    remove(path);
  MPI_Barrier(MPI_COMM_WORLD);
  dem = scene_create(&s);
  FAILS(PART_ERR_IO, "cannot be opened", dem_insert_particles(dem, &insert, -1, NULL));
  dem_destroy(dem);
}

static void bad_materials(void **state) {
  (void)state;
  scene s = scene_default();
  dem_t *dem = scene_create(&s);
  dem_material m = {.name = "steel", .density = -1.0};
  int number;
  FAILS(PART_ERR_RANGE, "density", dem_add_material(dem, &m, &number));
  m.density = 7800.0;
  OK(dem_add_material(dem, &m, &number));
  assert_int_equal(number, 1);
  FAILS(PART_ERR_ARGUMENT, "twice", dem_add_material(dem, &m, &number));
  s.contact.restitution = 0.0;
  FAILS(PART_ERR_RANGE, "restitution", dem_set_contact(dem, 0, 1, &s.contact));
  s.contact.restitution = 0.5;
  FAILS(PART_ERR_RANGE, "materials 0 and 2", dem_set_contact(dem, 0, 2, &s.contact));
  dem_destroy(dem);

  /* Particles that may touch need a contact. */
  OK(dem_create(s.comm, &s.box, &s.params, &dem));
  strcpy(m.name, "glass");
  OK(dem_add_material(dem, &m, NULL));
  dem_insert insert = lattice(DEM_FREE, 0.1, lo, 0.2, 2, 1, 1);
  OK(dem_insert_particles(dem, &insert, -1, NULL));
  FAILS(PART_ERR_RANGE, "no contact is given for materials glass and glass", dem_start(dem));
  dem_destroy(dem);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(random_is_repeatable), cmocka_unit_test(rotated_lattice),
      cmocka_unit_test(bad_lattice),          cmocka_unit_test(overlap_over_border),
      cmocka_unit_test(bad_random),           cmocka_unit_test(files),
      cmocka_unit_test(bad_materials),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
