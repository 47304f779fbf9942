/* ranks: 1 2 3 4 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The contact horizon: dilute scenes take hardly any contact steps, and the answer is that of all
 * steps. */
#include "common.h"

enum { MOST = 100, ADVANCES = 60 };

typedef struct dilute {
  const char *name;
  int number, together; /* together: one velocity, nearly; else random ones */
  double speed, box, extent, drag;
  int floor;
  double gravity, share; /* of the steps of skip off */
} dilute;

static dem_t *create_empty(const dilute *d, MPI_Comm comm, int skip) {
  scene s = scene_default();
  const double at[3] = {0.0, 0.0, 0.0}, up[3] = {0.0, 0.0, 1.0};
  s.comm = comm;
  for (int c = 0; c < 3; c++) {
    s.box.lo[c] = 0.0;
    s.box.hi[c] = d->box;
    s.box.periodic[c] = c < 2 || !d->floor;
  }
  s.params.skip = skip;
  s.params.gravity[2] = d->gravity;
  s.contact.normal_stiffness = 1e4;
  s.contact.restitution = 0.8;
  s.contact.friction = 0.3;
  dem_t *dem = scene_create(&s);
  if (d->floor)
    OK(dem_add_plane(dem, "floor", 0, at, up));
  return dem;
}

static dem_t *create(const dilute *d, MPI_Comm comm, int skip) {
  dem_t *dem = create_empty(d, comm, skip);
  const double lo[3] = {0.3 * d->box, 0.3 * d->box, 0.3 * d->box};
  dem_insert insert = random_spheres(d->number, 1e-3, 0.0, lo, d->extent, 5);
  insert.velocity[0] = d->together ? d->speed : 0.0;
  OK(dem_insert_particles(dem, &insert, -1, NULL));
  OK(dem_start(dem));
  stir(dem, d->together ? 1e-3 * d->speed : d->speed);
  return dem;
}

static void advance(dem_t *dem, const dilute *d, int advances) {
  const double su[3] = {2e-7, 0.0, 0.0};
  for (int k = 0; k < advances; k++) {
    if (d->drag > 0.0)
      set_fluid(dem, su, d->drag);
    OK(dem_advance(dem, 1e-3, NULL));
  }
}

static long long run(const dilute *d, MPI_Comm comm, int skip, int advances, body *bodies) {
  dem_t *dem = create(d, comm, skip);
  dem_report report;
  advance(dem, d, advances);
  OK(dem_get_report(dem, &report));
  assert_int_equal(report.particles, d->number);
  find_all(dem, comm, d->number, bodies);
  dem_destroy(dem);
  return report.substeps;
}

static const dilute scenes[] = {
    {"one sphere falls on a floor", 1, 0, 0.3, 0.1, 0.01, 0.0, 1, -9.81, 0.02},
    {"100 far apart", 100, 0, 0.3, 0.1, 0.04, 0.0, 0, 0.0, 0.02},
    {"100 together", 100, 1, 1.0, 0.1, 0.008, 0.0, 0, -9.81, 0.02},
    {"100 together in a fluid", 100, 1, 1.0, 0.1, 0.008, 1e-5, 0, -9.81, 0.02},
};

enum { SCENES = sizeof scenes / sizeof *scenes };

/* Rounding of 1e5 steps, 1e-14 m; each of up to three collisions one after the other makes an error
 * larger by the free path over the diameter, some 30. */
static void compare(const dilute *d, const char *what, const body *on, const body *off) {
  double most = 0.0, fastest = 0.0;
  for (int i = 0; i < d->number; i++)
    for (int c = 0; c < 3; c++) {
      double x = on[i].x[c] - off[i].x[c];
      x -= d->box * floor(x / d->box + 0.5);
      most = fmax(most, fabs(x));
      fastest = fmax(fastest, fabs(on[i].v[c] - off[i].v[c]));
    }
  print_message("# %s, %s: positions differ by %.1e m, velocities by %.1e m/s\n", d->name, what,
                most, fastest);
  CLOSE(most, 0.0, 3e-10);
  CLOSE(fastest, 0.0, 3e-8);
}

static void few_contact_steps(void **state) {
  static body on[MOST], off[MOST];
  (void)state;
  for (int k = 0; k < SCENES; k++) {
    const dilute *d = &scenes[k];
    const int advances = world_size() > 1 ? 2 : ADVANCES; /* 1e5 steps only on one */
    const long long few = run(d, MPI_COMM_WORLD, 1, advances, on);
    const long long all = run(d, MPI_COMM_WORLD, 0, advances, off);
    print_message("# %s: %lld of %lld steps, %.3f %%\n", d->name, few, all,
                  100.0 * (double)few / (double)all);
    assert_true((double)few <= d->share * (double)all);
    compare(d, "skip on and off", on, off);
  }
}

static void all_numbers_of_ranks(void **state) {
  static body here[MOST], alone[MOST];
  (void)state;
  for (int k = 0; k < SCENES; k++) {
    run(&scenes[k], MPI_COMM_WORLD, 1, ADVANCES / 2, here);
    run(&scenes[k], MPI_COMM_SELF, 1, ADVANCES / 2, alone);
    compare(&scenes[k], "these ranks and one", here, alone);
  }
}

/* Without contact the answer is the parabola, however long the step. */
static void flight_is_exact(void **state) {
  const dilute *d = &scenes[0];
  body start, end;
  int substeps;
  (void)state;
  dem_t *dem = create(d, MPI_COMM_WORLD, 1);
  const double t = 0.03;
  start = find(dem, MPI_COMM_WORLD, 0);
  OK(dem_advance(dem, t, &substeps));
  assert_int_equal(substeps, 1);
  end = find(dem, MPI_COMM_WORLD, 0);
  for (int c = 0; c < 3; c++) {
    const double g = c == 2 ? d->gravity : 0.0;
    CLOSE(end.x[c], start.x[c] + start.v[c] * t + 0.5 * g * t * t, 1e-17);
    CLOSE(end.v[c], start.v[c] + g * t, 2e-16);
  }
  dem_destroy(dem);
}

static void restart_bit_for_bit(void **state) {
  char path[300];
  const char *folder = getenv("TMPDIR");
  (void)state;
  snprintf(path, sizeof path, "%s/dem-horizon-%d.vtkhdf", folder != NULL ? folder : "/tmp",
           world_size());
  const int advances = world_size() > 1 ? 10 : ADVANCES / 2;
  for (int k = 0; k < SCENES; k++) {
    const dilute *d = &scenes[k];
    dem_t *one = create(d, MPI_COMM_WORLD, 1), *two = create_empty(d, MPI_COMM_WORLD, 1);
    advance(one, d, advances);
    OK(dem_write(one, path, NULL));
    OK(dem_read(two, path));
    OK(dem_start(two));
    advance(one, d, advances);
    advance(two, d, advances);
    const part_store *s = dem_store(one), *t = dem_store(two);
    assert_int_equal(s->local, t->local);
    for (int r = 0; r < DEM_RECORD_COUNT; r++)
      assert_memory_equal(s->record[r], t->record[r],
                          (size_t)s->local * (size_t)dem_layout.records[r].width * 8);
    dem_destroy(one);
    dem_destroy(two);
    MPI_Barrier(MPI_COMM_WORLD);
    if (world_rank() == 0)
      remove(path);
  }
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(few_contact_steps),
      cmocka_unit_test(all_numbers_of_ranks),
      cmocka_unit_test(flight_is_exact),
      cmocka_unit_test(restart_bit_for_bit),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
