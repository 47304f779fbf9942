/* ranks: 1 2 3 4 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Clumps on any number of ranks, through files, and with the scene plan off: the same motion. */
#include "clump_scenes.h"

enum { CLUMPS = 50, SPHERES = 40, EACH = 5, N = CLUMPS * EACH + SPHERES + 4 };

static const char *path_of(const char *name) {
  static char path[300];
  const char *folder = getenv("TMPDIR");
  snprintf(path, sizeof path, "%s/dem-clumps-%s-%d.vtkhdf", folder != NULL ? folder : "/tmp", name,
           world_size());
  return path;
}

/* Periodic across, a floor of triangles, friction; soft, so that many are in contact. */
static dem_t *empty_scene(MPI_Comm comm, int skip) {
  scene s = scene_default();
  static double vertices[18 * 16];
  const double floor_at[3] = {0.0, 0.0, -0.06}, up[3] = {0.0, 0.0, 1.0};
  s.comm = comm;
  for (int c = 0; c < 3; c++) {
    s.box.lo[c] = -0.06;
    s.box.hi[c] = 0.06;
    s.box.periodic[c] = c < 2;
  }
  s.params.gravity[2] = -9.81;
  s.params.skip = skip;
  s.contact.normal_stiffness = 2e3;
  s.contact.friction = 0.5;
  s.contact.restitution = 0.7;
  dem_t *dem = scene_create(&s);
  OK(dem_add_triangles(dem, "floor", 0, triangulated_square(floor_at, up, 0.12, 4, vertices),
                       vertices));
  return dem;
}

static dem_t *full_scene(MPI_Comm comm, int skip) {
  dem_t *dem = empty_scene(comm, skip);
  const double from[3] = {-0.06, -0.06, -0.06}, low[3] = {0.03, 0.03, -0.054};
  dem_insert insert = lattice(DEM_FIXED, 0.01, low, 0.011, 2, 2, 1);
  OK(dem_insert_particles(dem, &insert, -1, NULL));
  insert = random_clumps(ell_shape(), CLUMPS, 0.011, 0.014, from, 0.12, 3);
  insert.angular_velocity[1] = 30.0;
  OK(dem_insert_particles(dem, &insert, -1, NULL));
  insert = random_spheres(SPHERES, 0.008, 0.011, from, 0.12, 4);
  OK(dem_insert_particles(dem, &insert, -1, NULL));
  OK(dem_start(dem));
  stir(dem, 0.9);
  return dem;
}

static void run(dem_t *dem, int steps) {
  const double su[3] = {1e-4, 0.0, 0.0};
  for (int k = 0; k < steps; k++) {
    set_fluid(dem, su, 5e-4);
    OK(dem_advance(dem, 2e-3, NULL));
  }
}

/* Positions modulo the box, as a rebuild may have wrapped them in one of the two. */
static void same_bodies(dem_t *a, MPI_Comm comm_a, dem_t *b, MPI_Comm comm_b, double tolerance) {
  static body x[N], y[N];
  find_all(a, comm_a, N, x);
  find_all(b, comm_b, N, y);
  for (int k = 0; k < N; k++)
    for (int c = 0; c < 3; c++) {
      const double d = fabs(x[k].x[c] - y[k].x[c]);
      CLOSE(fmin(d, fabs(d - 0.12)), 0.0, tolerance);
      CLOSE(x[k].v[c], y[k].v[c], 1e3 * tolerance);
      CLOSE(x[k].w[c], y[k].w[c], 1e5 * tolerance);
    }
  for (int k = 0; k < CLUMPS; k++) {
    dem_clump_report p, q;
    OK(dem_clump_state(a, k, &p));
    OK(dem_clump_state(b, k, &q));
    assert_int_equal(p.members, EACH);
    assert_int_equal(q.members, EACH);
    CLOSE(p.mass, q.mass, 0.0);
    for (int c = 0; c < 4; c++)
      CLOSE(p.attitude[c], q.attitude[c], 1e3 * tolerance);
  }
}

/* All spheres of a clump are on one rank, at their places about its centre. */
static int moved_over_borders(dem_t *dem, int *rank_of) {
  const part_store *store = dem_store(dem);
  const int64_t *meta = part_field_int64(store, DEM_FIELD_ID);
  const size_t stride = (size_t)part_field_stride(store, DEM_FIELD_ID);
  int members[CLUMPS] = {0}, owner[CLUMPS] = {0}, moved = 0;
  for (int i = 0; i < store->local; i++)
    if (meta[stride * (size_t)i + 1] == DEM_CLUMP)
      members[meta[stride * (size_t)i + 2]]++;
  for (int k = 0; k < CLUMPS; k++) {
    assert_true(members[k] == 0 || members[k] == EACH);
    owner[k] = members[k] > 0 ? world_rank() : 0;
  }
  MPI_Allreduce(MPI_IN_PLACE, owner, CLUMPS, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
  for (int k = 0; k < CLUMPS; k++) {
    moved += rank_of[k] >= 0 && rank_of[k] != owner[k];
    rank_of[k] = owner[k];
  }
  return moved;
}

static void equal_to_one_rank(void **state) {
  (void)state;
  dem_t *all = full_scene(MPI_COMM_WORLD, 1), *one = full_scene(MPI_COMM_SELF, 1);
  int rank_of[CLUMPS], moved = 0;
  dem_report a, b;
  int64_t touched = 0, walls = 0;
  for (int k = 0; k < CLUMPS; k++)
    rank_of[k] = -1;
  for (int n = 0; n < 8; n++) {
    run(all, 1);
    run(one, 1);
    OK(dem_get_report(all, &a));
    OK(dem_get_report(one, &b));
    assert_int_equal(a.contacts, b.contacts);
    assert_int_equal(a.wall_contacts, b.wall_contacts);
    CLOSE(a.kinetic_energy, b.kinetic_energy, 1e-9 * b.kinetic_energy);
    CLOSE(a.budget_error, 0.0, 1e-12);
    touched += a.contacts;
    walls += a.wall_contacts;
    moved += moved_over_borders(all, rank_of);
  }
  print_message("# seen: %lld contacts of particles, %lld of walls, %d changes of rank\n",
                (long long)touched, (long long)walls, moved);
  assert_true(touched > 25 && walls > 5);
  assert_true(world_size() == 1 || moved > 0);
  /* Round-off of 1e-17 m grows in contacts, here by less than 1e5. */
  same_bodies(all, MPI_COMM_WORLD, one, MPI_COMM_SELF, 1e-12);
  dem_destroy(all);
  dem_destroy(one);
}

static void same_records(dem_t *a, dem_t *b) {
  const part_store *s = dem_store(a), *t = dem_store(b);
  assert_int_equal(s->local, t->local);
  for (int r = 0; r < DEM_RECORD_COUNT; r++)
    assert_memory_equal(s->record[r], t->record[r],
                        (size_t)s->local * (size_t)dem_layout.records[r].width * 8);
}

static void restart(void **state) {
  (void)state;
  const char *path = path_of("restart");
  dem_report here, there;
  dem_t *one = full_scene(MPI_COMM_WORLD, 1);
  run(one, 6);
  OK(dem_write(one, path, NULL));
  OK(dem_get_report(one, &here));
  assert_true(here.contacts > 5);
  dem_t *two = empty_scene(MPI_COMM_WORLD, 1);
  OK(dem_read(two, path));
  OK(dem_start(two));
  CLOSE(dem_stable_step(two), dem_stable_step(one), 0.0);
  same_records(one, two);
  run(one, 8);
  run(two, 8);
  same_records(one, two);
  OK(dem_get_report(one, &here));
  OK(dem_get_report(two, &there));
  assert_memory_equal(&here, &there, sizeof here);
  CLOSE(there.budget_error, 0.0, 1e-12);
  for (int k = 0; k < CLUMPS; k++) {
    dem_clump_report p, q;
    OK(dem_clump_state(one, k, &p));
    OK(dem_clump_state(two, k, &q));
    assert_memory_equal(&p, &q, sizeof p);
  }
  dem_destroy(one);
  dem_destroy(two);
  MPI_Barrier(MPI_COMM_WORLD);
  if (world_rank() == 0)
    remove(path);
}

/* Read on one rank what several wrote. */
static void other_ranks(void **state) {
  (void)state;
  const char *path = path_of("ranks");
  dem_t *one = full_scene(MPI_COMM_WORLD, 1);
  run(one, 6);
  OK(dem_write(one, path, NULL));
  dem_t *two = empty_scene(MPI_COMM_SELF, 1);
  OK(dem_read(two, path));
  OK(dem_start(two));
  run(one, 3);
  run(two, 3);
  same_bodies(one, MPI_COMM_WORLD, two, MPI_COMM_SELF, 1e-12);
  dem_destroy(one);
  dem_destroy(two);
  MPI_Barrier(MPI_COMM_WORLD);
  if (world_rank() == 0)
    remove(path);
}

/* Few clumps far apart, spinning and falling, with a fluid: one substep an advance and the same
 * motion as with all of them. */
static void skip_off(void **state) {
  (void)state;
  const double su[3] = {1e-4, 2e-4, 0.0}, lo[3] = {-1.0, -1.0, 0.0};
  static body end[2][6 * EACH];
  long long substeps[2];
  for (int fluid = 0; fluid < 2; fluid++) {
    for (int skip = 0; skip < 2; skip++) {
      scene s = scene_default();
      s.params.gravity[2] = -0.5;
      s.params.skip = skip;
      s.params.skin_fraction = 1.0; /* so that the horizon is beyond the whole way */
      s.contact.restitution = 0.8;
      s.contact.normal_stiffness = 1e4;
      dem_t *dem = scene_create(&s);
      dem_insert insert = random_clumps(ell_shape(), 6, 0.0, 0.0, lo, 1.0, 9);
      insert.extent[0] = insert.extent[1] = 2.0;
      insert.angular_velocity[0] = 4.0;
      insert.angular_velocity[2] = -2.0;
      OK(dem_insert_particles(dem, &insert, -1, NULL));
      OK(dem_start(dem));
      for (int n = 0; n < 10; n++) {
        if (fluid)
          set_fluid(dem, su, 1e-4);
        OK(dem_advance(dem, 1e-3, NULL));
      }
      dem_report report;
      OK(dem_get_report(dem, &report));
      CLOSE(report.budget_error, 0.0, 1e-12);
      substeps[skip] = report.substeps;
      find_all(dem, s.comm, 6 * EACH, end[skip]);
      dem_destroy(dem);
    }
    assert_int_equal(substeps[1], 10);
    assert_true(substeps[0] > 200);
    for (int k = 0; k < 6 * EACH; k++)
      for (int c = 0; c < 3; c++) {
        CLOSE(end[0][k].x[c], end[1][k].x[c], 1e-13);
        CLOSE(end[0][k].v[c], end[1][k].v[c], 1e-12);
        CLOSE(end[0][k].w[c], end[1][k].w[c], 1e-10);
        CLOSE(end[0][k].impulse[c], end[1][k].impulse[c], 1e-17);
      }
  }
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(equal_to_one_rank),
      cmocka_unit_test(restart),
      cmocka_unit_test(other_ranks),
      cmocka_unit_test(skip_off),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, remove_clump_files);
  MPI_Finalize();
  return failed;
}
