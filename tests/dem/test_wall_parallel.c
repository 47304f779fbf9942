/* ranks: 1 2 3 4 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Many particles among moving walls: budgets of every wall, ranks, restart, skip, vectors. */
#include "../../libdem/src/fast.h"
#include "common.h"

enum { N = 90, SIDES = 24 };

static void set(double to[3], double x, double y, double z) {
  to[0] = x;
  to[1] = y;
  to[2] = z;
}

static const char *path_of(const char *name) {
  static char path[300];
  const char *folder = getenv("TMPDIR");
  snprintf(path, sizeof path, "%s/dem-%s-%d.vtkhdf", folder != NULL ? folder : "/tmp", name,
           world_size());
  return path;
}

/* A drum of triangles that turns about y, periodic along y; a plane that swings in it and a bar at
 * the bottom (rod) that turns. Triangles in the order that `turned` makes. */
static dem_t *scene_without_particles(MPI_Comm comm, int skip, int turned) {
  const double R = 0.05, L = 0.03;
  static double vertices[18 * SIDES];
  scene s = scene_default();
  s.comm = comm;
  for (int c = 0; c < 3; c++) {
    s.box.lo[c] = c == 1 ? 0.0 : -0.06;
    s.box.hi[c] = c == 1 ? L : 0.06;
    s.box.periodic[c] = c == 1;
  }
  s.params.gravity[2] = -9.81;
  s.params.skip = skip;
  s.params.max_overlap = 0.2;
  s.contact.normal_stiffness = 2e3;
  s.contact.friction = 0.5;
  s.contact.restitution = 0.3;
  for (int m = 0; m < SIDES; m++) {
    double *t = vertices + 18 * (turned ? SIDES - 1 - m : m);
    const double a = 2.0 * PI * m / SIDES, b = 2.0 * PI * (m + 1) / SIDES;
    set(t, R * cos(a), 0.0, R * sin(a));
    set(t + 3, R * cos(b), 0.0, R * sin(b));
    set(t + 6, R * cos(b), L, R * sin(b));
    set(t + 9, R * cos(a), 0.0, R * sin(a));
    set(t + 12, R * cos(b), L, R * sin(b));
    set(t + 15, R * cos(a), L, R * sin(a));
  }
  dem_t *dem = scene_create(&s);
  dem_wall_params drum = wall_of(DEM_WALL_TRIANGLES), ram = wall_of(DEM_WALL_PLANE);
  dem_wall_params bar = wall_of(DEM_WALL_CYLINDER);
  set(drum.rotation_axis, 0.0, 1.0, 0.0);
  drum.rotation_rate = 12.0;
  set(drum.velocity, 0.0, 0.2, 0.0); /* along the periodic direction, too */
  OK(dem_add_wall(dem, "drum", &drum, 2 * SIDES, vertices));
  set(ram.point, -0.03, 0.0, 0.0);
  set(ram.normal, 1.0, 0.0, 0.2);
  ram.oscillation_amplitude = 2e-3;
  ram.oscillation_frequency = 15.0;
  set(ram.oscillation_direction, 1.0, 0.0, 0.0);
  OK(dem_add_wall(dem, "ram", &ram, 0, NULL));
  bar.side = DEM_WALL_OUTSIDE;
  bar.radius = 0.004;
  set(bar.point, -0.005, 0.0, -0.043);
  set(bar.axis, 0.0, 1.0, 0.0);
  set(bar.rotation_axis, 0.0, 1.0, 0.0);
  bar.rotation_rate = -8.0;
  OK(dem_add_wall(dem, "bar", &bar, 0, NULL));
  return dem;
}

static dem_t *scene_with_particles(MPI_Comm comm, int skip) {
  dem_t *dem = scene_without_particles(comm, skip, 0);
  const double low[3] = {-0.02, 0.0, -0.034};
  dem_insert insert = random_spheres(N, 0.004, 0.006, low, 0.03, 5);
  insert.extent[0] = 0.034;
  insert.extent[2] = 0.027;
  OK(dem_insert_particles(dem, &insert, -1, NULL));
  OK(dem_start(dem));
  return dem;
}

static void run(dem_t *dem, int steps) {
  for (int k = 0; k < steps; k++)
    OK(dem_advance(dem, 2e-3, NULL));
}

static void same_records(dem_t *a, dem_t *b) {
  const part_store *s = dem_store(a), *t = dem_store(b);
  assert_int_equal(s->local, t->local);
  for (int r = 0; r < DEM_RECORD_COUNT; r++)
    assert_memory_equal(s->record[r], t->record[r],
                        (size_t)s->local * (size_t)dem_layout.records[r].width * 8);
}

static void close_states(dem_t *one, MPI_Comm a, dem_t *two, MPI_Comm b, double x, double v) {
  static body p[N], q[N];
  find_all(one, a, N, p);
  find_all(two, b, N, q);
  for (int k = 0; k < N; k++)
    for (int c = 0; c < 3; c++) {
      const double d = fabs(p[k].x[c] - q[k].x[c]);
      CLOSE(c == 1 ? fmin(d, fabs(d - 0.03)) : d, 0.0, x);
      CLOSE(p[k].v[c], q[k].v[c], v);
    }
}

/* What walls received is what particles did not. */
static void budget(void **state) {
  (void)state;
  dem_t *dem = scene_with_particles(MPI_COMM_WORLD, 1);
  dem_report all;
  dem_wall_report wall;
  double impulse[3] = {0.0, 0.0, 0.0}, scale = 0.0;
  run(dem, 80);
  OK(dem_get_report(dem, &all));
  assert_true(all.wall_contacts > 5);
  CLOSE(all.budget_error, 0.0, 1e-13);
  assert_int_equal(dem_wall_count(dem), 3);
  for (int w = 0; w < 3; w++) {
    OK(dem_get_wall_report(dem, w, &wall));
    for (int c = 0; c < 3; c++) {
      impulse[c] += wall.impulse[c];
      scale = fmax(scale, fabs(wall.impulse[c]));
    }
    assert_true(wall.work != 0.0 && wall.spin_impulse[1] != 0.0);
  }
  for (int c = 0; c < 3; c++)
    CLOSE(impulse[c], -all.wall_impulse[c], 1e-13 * scale);
  dem_destroy(dem);
}

static void bit_for_bit(void **state) {
  (void)state;
  const char *path = path_of("walls");
  dem_report report;
  dem_wall_report here, there;
  dem_t *one = scene_with_particles(MPI_COMM_WORLD, 1);
  run(one, 60);
  OK(dem_get_report(one, &report));
  assert_true(report.wall_contacts > 5);
  OK(dem_write(one, path, NULL));
  dem_t *two = scene_without_particles(MPI_COMM_WORLD, 1, 1);
  OK(dem_read(two, path));
  OK(dem_start(two));
  same_records(one, two);
  run(one, 25);
  run(two, 25);
  same_records(one, two);
  for (int w = 0; w < 3; w++) {
    OK(dem_get_wall_report(one, w, &here));
    OK(dem_get_wall_report(two, w, &there));
    there.name = here.name;
    assert_memory_equal(&here, &there, sizeof here);
  }
  dem_destroy(one);
  dem_destroy(two);
  MPI_Barrier(MPI_COMM_WORLD);
  if (world_rank() == 0)
    remove(path);
}

/* Written on these ranks and read on one: sums and history are all there. */
static void other_ranks(void **state) {
  (void)state;
  const char *path = path_of("wallsElsewhere");
  dem_wall_report here, there;
  dem_t *one = scene_with_particles(MPI_COMM_WORLD, 1);
  run(one, 60);
  OK(dem_write(one, path, NULL));
  dem_t *two = scene_without_particles(MPI_COMM_SELF, 1, 1);
  OK(dem_read(two, path));
  OK(dem_start(two));
  run(one, 3);
  run(two, 3);
  close_states(one, MPI_COMM_WORLD, two, MPI_COMM_SELF, 1e-11, 1e-8);
  for (int w = 0; w < 3; w++) {
    OK(dem_get_wall_report(one, w, &here));
    OK(dem_get_wall_report(two, w, &there));
    for (int c = 0; c < 3; c++) {
      CLOSE(there.impulse[c], here.impulse[c], 1e-9);
      CLOSE(there.spin_impulse[c], here.spin_impulse[c], 1e-10);
    }
    CLOSE(there.work, here.work, 1e-9);
  }
  dem_destroy(one);
  dem_destroy(two);
  MPI_Barrier(MPI_COMM_WORLD);
  if (world_rank() == 0)
    remove(path);
}

/* Another number of ranks, nothing skipped, the plain loop: the same but for rounding. */
static void same_physics(void **state) {
  (void)state;
  dem_t *one = scene_with_particles(MPI_COMM_WORLD, 1), *two;
  run(one, 8);
  two = scene_with_particles(MPI_COMM_SELF, 0);
  run(two, 8);
  close_states(one, MPI_COMM_WORLD, two, MPI_COMM_SELF, 1e-10, 1e-7);
  dem_destroy(two);
  two = scene_with_particles(MPI_COMM_SELF, 1);
  OK(dem_fast_limit(two, 1));
  run(two, 8);
  close_states(one, MPI_COMM_WORLD, two, MPI_COMM_SELF, 1e-10, 1e-7);
  dem_destroy(one);
  dem_destroy(two);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(budget),
      cmocka_unit_test(bit_for_bit),
      cmocka_unit_test(other_ranks),
      cmocka_unit_test(same_physics),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
