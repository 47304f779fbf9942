/* ranks: 1 2 3 4 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Many particles: energy, momentum, skipping, and the serial run against any number of ranks. */
#include "common.h"

static const double lo[3] = {-0.05, -0.05, -0.05};

static scene gas_scene(void) {
  scene s = scene_default();
  for (int c = 0; c < 3; c++) {
    s.box.lo[c] = -0.05;
    s.box.hi[c] = 0.05;
    s.box.periodic[c] = 1;
  }
  return s;
}

static dem_t *start_gas(const scene *s, int64_t n, double d, double d_max) {
  dem_t *dem = scene_create(s);
  dem_insert insert = random_spheres(n, d, d_max, lo, 0.1, 7);
  OK(dem_insert_particles(dem, &insert, -1, NULL));
  OK(dem_start(dem));
  stir(dem, 1.0);
  return dem;
}

/* Elastic spheres, 0.16 of the volume: energy returns between contacts, and no drift. Bounds: in a
 * contact it is stored in springs (a few of 300 at a time); a contact at tc/50 returns what it took
 * but for 2e-6 in its worst phase (test_collision), and a particle has a few. */
static void elastic_gas(void **state) {
  (void)state;
  const scene s = gas_scene();
  dem_t *dem = start_gas(&s, 300, 0.01, 0.0);
  dem_report first, last;
  OK(dem_get_report(dem, &first));
  double low = first.kinetic_energy, high = 0.0;
  int64_t contacts = 0;
  for (int k = 0; k < 40; k++) {
    OK(dem_advance(dem, 5e-4, NULL));
    OK(dem_get_report(dem, &last));
    low = fmin(low, last.kinetic_energy);
    high = fmax(high, last.kinetic_energy);
    contacts += last.contacts;
    assert_int_equal(last.particles, 300);
  }
  assert_true(contacts > 100);
  assert_true(high < first.kinetic_energy * (1.0 + 1e-5));
  assert_true(low > first.kinetic_energy * 0.95);
  CLOSE(last.budget_error, 0.0, 1e-13);
  dem_destroy(dem);
}

/* A bed with everything: walls, friction, gravity, drag, sizes. The report has the contacts of all
 * advances added up. */
static dem_report run_bed(MPI_Comm comm, int skip, body *bodies) {
  scene s = gas_scene();
  const double floor_at[3] = {0.0, 0.0, -0.05}, up[3] = {0.0, 0.0, 1.0}, su[3] = {1e-3, 0.0, 0.0};
  s.comm = comm;
  s.params.skip = skip;
  s.box.periodic[2] = 0;
  s.params.gravity[2] = -9.81;
  s.contact.friction = 0.5;
  s.contact.normal_stiffness = 2e3; /* soft, so that many are in contact at any time */
  s.contact.restitution = 0.7;
  double vertices[18 * 16];
  dem_t *dem = scene_create(&s);
  dem_insert insert = random_spheres(300, 0.008, 0.012, lo, 0.1, 3);
  OK(dem_insert_particles(dem, &insert, -1, NULL));
  OK(dem_add_triangles(dem, "floor", 0, triangulated_square(floor_at, up, 0.1, 4, vertices),
                       vertices));
  OK(dem_start(dem));
  stir(dem, 0.5);
  dem_report report = {0};
  for (int k = 0; k < 16; k++) {
    const int64_t contacts = report.contacts, wall_contacts = report.wall_contacts;
    set_fluid(dem, su, 1e-3);
    OK(dem_advance(dem, 1e-3, NULL));
    OK(dem_get_report(dem, &report));
    report.contacts += contacts;
    report.wall_contacts += wall_contacts;
  }
  int ranks;
  MPI_Comm_size(comm, &ranks);
  if (ranks > 1)
    assert_in_range(dem_store(dem)->local, 300 / ranks - 60, 300 / ranks + 60);
  find_all(dem, comm, 300, bodies);
  dem_destroy(dem);
  return report;
}

static double distance(const body *a, const body *b, double length) {
  double most = 0.0;
  for (int c = 0; c < 3; c++) {
    double d = a->x[c] - b->x[c];
    d -= length * floor(d / length + 0.5);
    most = fmax(most, fabs(d));
  }
  return most;
}

/* Round-off of sums grows with every collision; 16 ms are about one collision a particle. */
static void ranks_agree(void **state) {
  (void)state;
  body serial[300], parallel[300];
  const dem_report one = run_bed(MPI_COMM_SELF, 1, serial);
  const dem_report all = run_bed(MPI_COMM_WORLD, 1, parallel);
  assert_int_equal(one.particles, all.particles);
  assert_int_equal(one.contacts, all.contacts);
  assert_int_equal(one.wall_contacts, all.wall_contacts);
  assert_true(one.contacts > 300);
  assert_true(one.wall_contacts > 20);
  CLOSE(all.budget_error, 0.0, 1e-13);
  for (int k = 0; k < 300; k++) {
    CLOSE(distance(&serial[k], &parallel[k], 0.1), 0.0, 1e-11);
    for (int c = 0; c < 3; c++) {
      CLOSE(parallel[k].v[c], serial[k].v[c], 1e-8);
      CLOSE(parallel[k].w[c], serial[k].w[c], 1e-5);
    }
  }
}

/* Nothing that the plan leaves out changes the answer beyond rounding. */
static void skipping(void **state) {
  (void)state;
  body on[300], off[300];
  run_bed(MPI_COMM_WORLD, 1, on);
  run_bed(MPI_COMM_WORLD, 0, off);
  for (int k = 0; k < 300; k++)
    CLOSE(distance(&on[k], &off[k], 0.1), 0.0, 1e-11);
}

/* Dilute, no friction, far from the walls: most of the plan applies. */
static void skipping_dilute(void **state) {
  (void)state;
  body end[2][20];
  dem_report report[2];
  for (int skip = 0; skip <= 1; skip++) {
    scene s = gas_scene();
    const double floor_at[3] = {0.0, 0.0, -0.05}, up[3] = {0.0, 0.0, 1.0};
    s.box.periodic[2] = 0;
    s.params.skip = skip;
    s.params.skin_fraction = 2.0;
    s.params.gravity[2] = -1.0;
    dem_t *dem = scene_create(&s);
    const double region[3] = {-0.05, -0.05, -0.04};
    dem_insert insert = random_spheres(20, 0.004, 0.0, region, 0.08, 5);
    OK(dem_insert_particles(dem, &insert, -1, NULL));
    OK(dem_add_plane(dem, "floor", 0, floor_at, up));
    OK(dem_start(dem));
    stir(dem, 0.1);
    for (int k = 0; k < 60; k++)
      OK(dem_advance(dem, 1e-3, NULL));
    OK(dem_get_report(dem, &report[skip]));
    find_all(dem, s.comm, 20, end[skip]);
    char text[2000];
    OK(dem_plan_text(dem, sizeof text, text));
    assert_non_null(strstr(text, skip ? "rotation" : "nothing skipped"));
    FAILS(PART_ERR_RANGE, "characters", dem_plan_text(dem, 10, text));
    dem_destroy(dem);
  }
  for (int k = 0; k < 20; k++)
    CLOSE(distance(&end[0][k], &end[1][k], 0.1), 0.0, 1e-11);
  assert_true(report[1].substeps < report[0].substeps / 2);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(elastic_gas),
      cmocka_unit_test(ranks_agree),
      cmocka_unit_test(skipping),
      cmocka_unit_test(skipping_dilute),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
