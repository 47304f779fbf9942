/* ranks: 1 2 3 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A square of water pressed into a corner along its diagonal: particles there are as far from one
 * wall as from the other, and walls that differ in slip act on them differently. Round-off, which
 * differs between ranks, must not choose between them. Planes, and a tank of triangles. */
#include "common.h"

enum { SIDE = 12, N = SIDE * SIDE };
static const double dx = 0.01, length = SIDE * 0.01;

static scene square(void) {
  scene s = scene_2d(length, length, dx);
  s.params.gravity[0] = s.params.gravity[1] = -7.0;
  s.params.sound_speed = 20.0;
  s.params.viscosity = 1.0;
  return s;
}

/* The four sides of the tank: x = 0 and x = length slip, the others not. */
static void add_triangles(sph_t *sph) {
  const double at[4][2] = {{0.0, 0.0}, {length, 0.0}, {length, length}, {0.0, length}};
  for (int slip = 0; slip < 2; slip++) {
    double v[4][9];
    sph_wall_params wall;
    for (int k = 0; k < 2; k++) {
      const double *p = at[2 * k + slip], *q = at[(2 * k + slip + 1) % 4], z = 0.5 * length;
      const double two[2][9] = {{p[0], p[1], -z, q[0], q[1], z, q[0], q[1], -z},
                                {p[0], p[1], -z, p[0], p[1], z, q[0], q[1], z}};
      memcpy(v[2 * k], two, sizeof two);
    }
    part_params_default(&sph_wall_table, &wall);
    wall.type = SPH_TRIANGLES;
    wall.slip = slip ? SPH_FREE_SLIP : SPH_NO_SLIP;
    OK(sph_add_wall(sph, slip ? "sides" : "floor", &wall, 4, &v[0][0]));
  }
}

static void press(MPI_Comm comm, int triangles, body *bodies) {
  scene s = square();
  sph_report report;
  s.comm = comm;
  sph_t *sph = scene_create(&s);
  if (triangles) {
    add_triangles(sph);
  } else {
    add_planes(sph, &s, 0, SPH_FREE_SLIP);
    add_planes(sph, &s, 1, SPH_NO_SLIP);
  }
  fill_box(sph, &s);
  OK(sph_start(sph));
  OK(sph_advance(sph, 0.02, NULL));
  OK(sph_get_report(sph, &report));
  CLOSE(report.budget_error, 0.0, 1e-12);
  find_all(sph, comm, 0, N, bodies);
  sph_destroy(sph);
}

static void diagonal(void **state) {
  static body here[N], alone[N];
  (void)state;
  for (int triangles = 0; triangles < 2; triangles++) {
    press(MPI_COMM_WORLD, triangles, here);
    press(MPI_COMM_SELF, triangles, alone);
    for (int k = 0; k < N; k++)
      for (int c = 0; c < 2; c++) {
        CLOSE(here[k].v[c], alone[k].v[c], 1e-12);
        CLOSE(here[k].x[c], alone[k].x[c], 1e-13);
        CLOSE(here[k].density, alone[k].density, 1e-8);
      }
  }
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(diagonal),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
