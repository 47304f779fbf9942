/* ranks: 1 3 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Going on from a file is the same computation as going on in memory, bit for bit. */
#include "common.h"

enum { N = 260, STEPS = 6 };

static const char *path_of(const char *name) {
  static char path[300];
  const char *folder = getenv("TMPDIR");
  snprintf(path, sizeof path, "%s/dem-%s-%d.vtkhdf", folder != NULL ? folder : "/tmp", name,
           world_size());
  return path;
}

/* Walls, friction, drag, a block, fixed particles; soft, so that many are in contact. */
static dem_t *scene_without_particles(MPI_Comm comm) {
  scene s = scene_default();
  double vertices[18 * 16];
  const double floor_at[3] = {0.0, 0.0, -0.05}, up[3] = {0.0, 0.0, 1.0};
  s.comm = comm;
  for (int c = 0; c < 3; c++) {
    s.box.lo[c] = -0.05;
    s.box.hi[c] = 0.05;
    s.box.periodic[c] = c < 2;
  }
  s.params.gravity[2] = -9.81;
  s.contact.normal_stiffness = 2e3;
  s.contact.friction = 0.5;
  s.contact.restitution = 0.7;
  dem_t *dem = scene_create(&s);
  OK(dem_add_triangles(dem, "floor", 0, triangulated_square(floor_at, up, 0.1, 4, vertices),
                       vertices));
  return dem;
}

static dem_t *scene_with_particles(MPI_Comm comm) {
  dem_t *dem = scene_without_particles(comm);
  const double at[3] = {-0.02, -0.02, 0.03}, low[3] = {0.03, 0.03, -0.044};
  const double from[3] = {-0.05, -0.05, -0.05};
  dem_insert insert = lattice(DEM_BLOCK, 0.01, at, 0.012, 4, 4, 1);
  OK(dem_insert_particles(dem, &insert, 0, NULL));
  insert = lattice(DEM_FIXED, 0.01, low, 0.011, 2, 2, 1);
  OK(dem_insert_particles(dem, &insert, -1, NULL));
  insert = random_spheres(N - 20, 0.008, 0.011, from, 0.1, 3);
  insert.extent[2] = 0.065;
  OK(dem_insert_particles(dem, &insert, -1, NULL));
  OK(dem_start(dem));
  stir(dem, 0.4);
  return dem;
}

static void run(dem_t *dem, int steps) {
  const double su[3] = {2e-4, 0.0, 0.0};
  for (int k = 0; k < steps; k++) {
    set_fluid(dem, su, 1e-3);
    OK(dem_advance(dem, 2e-3, NULL));
  }
}

static void same_records(dem_t *a, dem_t *b) {
  const part_store *s = dem_store(a), *t = dem_store(b);
  assert_int_equal(s->local, t->local);
  for (int r = 0; r < DEM_RECORD_COUNT; r++)
    assert_memory_equal(s->record[r], t->record[r],
                        (size_t)s->local * (size_t)dem_layout.records[r].width * 8);
}

static void bit_for_bit(void **state) {
  (void)state;
  const char *path = path_of("restart");
  dem_report here, there;
  double x[2][6];
  dem_t *one = scene_with_particles(MPI_COMM_WORLD);
  run(one, STEPS);
  OK(dem_write(one, path, NULL));
  OK(dem_get_report(one, &here));
  assert_true(here.contacts > 15);
  assert_true(here.wall_contacts > 2);

  dem_t *two = scene_without_particles(MPI_COMM_WORLD);
  OK(dem_read(two, path));
  OK(dem_start(two));
  CLOSE(dem_time(two), dem_time(one), 0.0);
  CLOSE(dem_stable_step(two), dem_stable_step(one), 0.0);
  same_records(one, two);
  run(one, 2 * STEPS);
  run(two, 2 * STEPS);
  same_records(one, two);
  OK(dem_get_report(one, &here));
  OK(dem_get_report(two, &there));
  assert_memory_equal(&here, &there, sizeof here);
  CLOSE(there.budget_error, 0.0, 1e-13);
  OK(dem_block_state(one, 0, x[0], x[0] + 3));
  OK(dem_block_state(two, 0, x[1], x[1] + 3));
  assert_memory_equal(x[0], x[1], sizeof x[0]);
  dem_destroy(one);
  dem_destroy(two);
  MPI_Barrier(MPI_COMM_WORLD);
  if (world_rank() == 0)
    remove(path);
}

/* Writing itself changes nothing but the order of particles and of sums. */
static void writing_is_harmless(void **state) {
  (void)state;
  const char *path = path_of("harmless");
  static body a[N], b[N];
  dem_t *one = scene_with_particles(MPI_COMM_WORLD), *two = scene_with_particles(MPI_COMM_WORLD);
  run(one, STEPS);
  run(two, STEPS);
  OK(dem_write(two, path, NULL));
  run(one, 2);
  run(two, 2);
  find_all(one, MPI_COMM_WORLD, N, a);
  find_all(two, MPI_COMM_WORLD, N, b);
  for (int k = 0; k < N; k++)
    for (int c = 0; c < 3; c++) {
      /* A position may have been wrapped in one of them. */
      const double d = fabs(a[k].x[c] - b[k].x[c]);
      CLOSE(fmin(d, fabs(d - 0.1)), 0.0, 1e-12);
      CLOSE(a[k].v[c], b[k].v[c], 1e-9);
    }
  dem_destroy(one);
  dem_destroy(two);
  MPI_Barrier(MPI_COMM_WORLD);
  if (world_rank() == 0)
    remove(path);
}

/* Read on one rank what several wrote: the same physics, history included. */
static void other_ranks(void **state) {
  (void)state;
  const char *path = path_of("ranks");
  static body a[N], b[N];
  dem_report here, there;
  dem_t *one = scene_with_particles(MPI_COMM_WORLD);
  run(one, STEPS);
  OK(dem_write(one, path, NULL));
  dem_t *two = scene_without_particles(MPI_COMM_SELF);
  OK(dem_read(two, path));
  OK(dem_start(two));
  run(one, 4);
  run(two, 4);
  find_all(one, MPI_COMM_WORLD, N, a);
  find_all(two, MPI_COMM_SELF, N, b);
  for (int k = 0; k < N; k++)
    for (int c = 0; c < 3; c++) {
      const double d = fabs(a[k].x[c] - b[k].x[c]);
      CLOSE(fmin(d, fabs(d - 0.1)), 0.0, 1e-11);
      CLOSE(a[k].v[c], b[k].v[c], 1e-8);
    }
  OK(dem_get_report(one, &here));
  OK(dem_get_report(two, &there));
  assert_int_equal(here.contacts, there.contacts);
  CLOSE(there.budget_error, 0.0, 1e-13);
  dem_destroy(one);
  dem_destroy(two);
  MPI_Barrier(MPI_COMM_WORLD);
  if (world_rank() == 0)
    remove(path);
}

static void bad_files(void **state) {
  (void)state;
  const char *path = path_of("bad");
  dem_t *one = scene_with_particles(MPI_COMM_WORLD);
  FAILS(PART_ERR_STATE, "dem_start", dem_read(one, path));
  FAILS(PART_ERR_IO, "/no/such/folder", dem_write(one, "/no/such/folder/x.vtkhdf", NULL));
  OK(dem_write(one, path, NULL));
  dem_destroy(one);
  scene s = scene_default();
  dem_t *two = scene_create(&s);
  FAILS(PART_ERR_FORMAT, "wall elements", dem_read(two, path));
  dem_destroy(two);
  MPI_Barrier(MPI_COMM_WORLD);
  if (world_rank() == 0)
    remove(path);
  two = scene_without_particles(MPI_COMM_WORLD);
  FAILS(PART_ERR_IO, path, dem_read(two, path));
  dem_destroy(two);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(bit_for_bit),
      cmocka_unit_test(writing_is_harmless),
      cmocka_unit_test(other_ranks),
      cmocka_unit_test(bad_files),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
