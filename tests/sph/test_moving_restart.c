/* ranks: 1 3 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Walls that move: going on from a file is bit for bit the same, any number of ranks gives the same
 * to round-off. A square paddle turns and swings in a tank whose floor goes up and down. */
#include "common.h"

enum { ACROSS = 24, MOST = ACROSS * ACROSS };
static const double dx = 0.001;

static scene tank(MPI_Comm comm) {
  scene s = scene_2d(ACROSS * dx, 2.0 * ACROSS * dx, dx);
  s.comm = comm;
  s.box.lo[1] = -4.0 * dx;
  s.params.gravity[1] = -1.0;
  s.params.sound_speed = 2.0;
  s.params.viscosity = 0.1;
  return s;
}

static sph_t *with_walls(const scene *s) {
  static const double turn[5][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}, {1, 1}};
  const double middle = 0.5 * ACROSS * dx, half = 3.0 * dx, z = 0.05;
  double v[8][9];
  sph_wall_params floor, paddle;
  sph_t *sph = scene_create(s);
  add_planes(sph, s, 0, SPH_NO_SLIP);
  part_params_default(&sph_wall_table, &floor);
  paddle = floor;
  floor.type = SPH_PLANE;
  floor.normal[1] = 1.0;
  floor.oscillation_amplitude = dx;
  floor.oscillation_frequency = 10.0;
  floor.oscillation_direction[1] = 1.0;
  OK(sph_add_wall(sph, "floor", &floor, 0, NULL));
  for (int k = 0; k < 4; k++) {
    const double p[2] = {middle + half * turn[k][0], middle + half * turn[k][1]};
    const double q[2] = {middle + half * turn[k + 1][0], middle + half * turn[k + 1][1]};
    const double two[2][9] = {{p[0], p[1], -z, q[0], q[1], -z, q[0], q[1], z},
                              {p[0], p[1], -z, q[0], q[1], z, p[0], p[1], z}};
    memcpy(v[2 * k], two, sizeof two);
  }
  paddle.type = SPH_TRIANGLES;
  paddle.velocity[0] = 0.02;
  paddle.centre[0] = paddle.centre[1] = middle;
  paddle.rotation_axis[2] = 1.0;
  paddle.rotation_rate = 10.0;
  OK(sph_add_wall(sph, "paddle", &paddle, 8, &v[0][0]));
  return sph;
}

/* The first rank of the scene puts all of them in. */
static int64_t fill(sph_t *sph, MPI_Comm comm) {
  double x[3 * MOST];
  int64_t all = 0;
  int n = 0, rank;
  MPI_Comm_rank(comm, &rank);
  for (int k = 0; k < MOST && rank == 0; k++) {
    const double at[3] = {(k % ACROSS + 0.5) * dx, (k / ACROSS + 0.5) * dx, 0.0};
    const double off = 0.5 * ACROSS * dx;
    if (fmax(fabs(at[0] - off), fabs(at[1] - off)) > 3.2 * dx)
      memcpy(x + 3 * n++, at, sizeof at);
  }
  OK(sph_insert_points(sph, n, x, NULL, NULL, NULL, &all));
  return all;
}

static void same_on_any_ranks(void **state) {
  (void)state;
  static body one[MOST], all[MOST];
  double worst = 0.0;
  sph_wall_report here, there;
  sph_report report;
  const scene alone = tank(MPI_COMM_SELF), together = tank(MPI_COMM_WORLD);
  sph_t *a = with_walls(&alone), *b = with_walls(&together);
  const int64_t n = fill(a, MPI_COMM_SELF);
  assert_int_equal(fill(b, MPI_COMM_WORLD), n);
  OK(sph_start(a));
  OK(sph_start(b));
  OK(sph_advance(a, 0.02, NULL));
  OK(sph_advance(b, 0.02, NULL));
  find_all(a, MPI_COMM_SELF, 0, n, one);
  find_all(b, MPI_COMM_WORLD, 0, n, all);
  for (int64_t k = 0; k < n; k++)
    for (int c = 0; c < 3; c++)
      worst = fmax(worst, fabs(one[k].x[c] - all[k].x[c]));
  OK(sph_get_wall_report(a, 3, &here));
  OK(sph_get_wall_report(b, 3, &there));
  OK(sph_get_report(b, &report));
  if (world_rank() == 0)
    print_message(
        "one rank and all: positions differ by %.1e m, paddle: torque %.6g, work %.6g, budget "
        "%.1e\n",
        worst, there.torque[2], there.work, report.budget_error);
  CLOSE(worst, 0.0, 1e-12);
  CLOSE(there.torque[2] / here.torque[2], 1.0, 1e-6);
  CLOSE(there.work / here.work, 1.0, 1e-8);
  CLOSE(report.budget_error, 0.0, 1e-12);
  sph_destroy(a);
  sph_destroy(b);
}

static void bit_for_bit(void **state) {
  (void)state;
  const char *path = path_of("moving");
  for (int scheme = SPH_SYMPLECTIC; scheme <= SPH_PREDICTOR_CORRECTOR; scheme++) {
    scene s = tank(MPI_COMM_WORLD);
    sph_wall_report here, there;
    s.params.time_scheme = scheme;
    sph_t *one = with_walls(&s);
    fill(one, MPI_COMM_WORLD);
    OK(sph_start(one));
    OK(sph_advance(one, 0.007, NULL));
    OK(sph_write(one, path, NULL));
    sph_t *two = with_walls(&s);
    OK(sph_read(two, path));
    OK(sph_start(two));
    OK(sph_advance(one, 0.005, NULL));
    OK(sph_advance(two, 0.005, NULL));
    const part_store *p = sph_store(one), *q = sph_store(two);
    assert_int_equal(p->local, q->local);
    for (int r = 0; r < SPH_RECORD_COUNT; r++)
      assert_memory_equal(p->record[r], q->record[r],
                          (size_t)p->local * (size_t)sph_layout.records[r].width * 8);
    for (int w = 2; w < 4; w++) {
      OK(sph_get_wall_report(one, w, &here));
      OK(sph_get_wall_report(two, w, &there));
      assert_memory_equal(&here, &there, sizeof here);
    }
    sph_destroy(one);
    sph_destroy(two);
  }
}

/* What can not be is refused, with the entry's name. */
static void bad_motions(void **state) {
  (void)state;
  scene s = tank(MPI_COMM_WORLD);
  sph_wall_params plane, mesh, bad;
  const double v[9] = {0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0};
  s.box.periodic[0] = 1;
  sph_t *sph = scene_create(&s);
  part_params_default(&sph_wall_table, &plane);
  mesh = plane;
  plane.type = SPH_PLANE;
  plane.normal[1] = 2.0;
  mesh.type = SPH_TRIANGLES;
#define REFUSED(wanted, of, change)                                                                \
  do {                                                                                             \
    bad = of;                                                                                      \
    change;                                                                                        \
    FAILS(PART_ERR_RANGE, wanted,                                                                  \
          sph_add_wall(sph, "a", &bad, bad.type == SPH_TRIANGLES,                                  \
                       bad.type == SPH_PLANE ? NULL : v));                                         \
  } while (0)
  REFUSED("wall a: entry rotationAxis: a vector", plane, bad.rotation_rate = 1.0);
  REFUSED("about its normal", plane, (bad.rotation_rate = 1.0, bad.rotation_axis[2] = 1.0));
  REFUSED("entry oscillationDirection", plane, bad.oscillation_amplitude = 1.0);
  REFUSED("entry oscillationFrequency", plane,
          (bad.oscillation_amplitude = 1.0, bad.oscillation_direction[1] = 1.0));
  REFUSED("entry stopTime", plane, (bad.start_time = 1.0, bad.stop_time = 0.0));
  REFUSED("entry velocity: triangles can not move along x, in which", mesh, bad.velocity[0] = 1.0);
  REFUSED("entry velocity: triangles can not move along z, with dimensions 2", mesh,
          bad.velocity[2] = 1.0);
  REFUSED("entry rotationAxis: must be along x", mesh,
          (bad.rotation_rate = 1.0, bad.rotation_axis[2] = 1.0));
  REFUSED("entry velocity: must be 0 with the wall's model", plane,
          (bad.model = SPH_WALL_repulsive, bad.slip = SPH_FREE_SLIP, bad.velocity[1] = 1.0));
  REFUSED("planes along themselves with fixedPoints", plane,
          (bad.model = SPH_WALL_fixed, bad.velocity[1] = 1.0));
#undef REFUSED
  sph_destroy(sph);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(same_on_any_ranks),
      cmocka_unit_test(bit_for_bit),
      cmocka_unit_test(bad_motions),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
