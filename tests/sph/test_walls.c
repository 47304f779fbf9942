/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Walls of triangles do what planes do; a sliding wall drags the fluid; bad walls are refused. */
#include "common.h"

/* Square in the plane x[axis] = at, from lo to hi in the two other directions, of 2 m m triangles
 * whose normal is along `sign` axis. */
static int square(int axis, double at, double sign, const double lo[3], const double hi[3], int m,
                  double *v) {
  const int p = (axis + 1) % 3, q = (axis + 2) % 3;
  const int corner[6][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
  for (int a = 0; a < m; a++)
    for (int b = 0; b < m; b++)
      for (int k = 0; k < 6; k++, v += 3) {
        const int *c = corner[sign > 0.0 || k % 3 == 0 ? k : k % 3 == 1 ? k + 1 : k - 1];
        v[axis] = at;
        v[p] = lo[p] + (hi[p] - lo[p]) * (a + c[0]) / m;
        v[q] = lo[q] + (hi[q] - lo[q]) * (b + c[1]) / m;
      }
  return 2 * m * m;
}

static scene tank(void) {
  const double length[3] = {0.08, 0.08, 0.12};
  scene s = scene_3d(length, 0.01);
  s.params.gravity[2] = -9.81;
  s.params.artificial_viscosity = 0.1;
  s.params.viscosity = 0.1;
  return s;
}

enum { N = 8 * 8 * 7, FINE = 6 };

/* closed: the box as one surface of triangles; flat: floor of triangles, sides planes. */
static void run(int closed, int flat, body *first, body *bodies) {
  const scene s = tank();
  static double v[6 * 2 * FINE * FINE * 9];
  sph_wall_params wall;
  sph_t *sph = scene_create(&s);
  part_params_default(&sph_wall_table, &wall);
  wall.type = SPH_TRIANGLES;
  if (closed) {
    int n = 0;
    for (int axis = 0; axis < 3; axis++)
      for (int end = 0; end < 2; end++)
        n += square(axis, end ? s.box.hi[axis] : 0.0, end ? -1.0 : 1.0, s.box.lo, s.box.hi, FINE,
                    v + 9 * n);
    OK(sph_add_wall(sph, "box", &wall, n, v));
  } else {
    const double lo[3] = {-0.05, -0.05, 0.0}, hi[3] = {0.13, 0.13, 0.0};
    add_planes(sph, &s, 0, SPH_NO_SLIP);
    add_planes(sph, &s, 1, SPH_NO_SLIP);
    if (flat)
      OK(sph_add_wall(sph, "floor", &wall, square(2, 0.0, 1.0, lo, hi, FINE, v), v));
    else
      add_planes(sph, &s, 2, SPH_NO_SLIP);
  }
  fill_water(sph, &s, 0.07, 2);
  stir(sph, &s, 0.1);
  OK(sph_start(sph));
  find_all(sph, MPI_COMM_WORLD, 0, N, first);
  OK(sph_advance(sph, 0.02, NULL));
  find_all(sph, MPI_COMM_WORLD, 0, N, bodies);
  sph_destroy(sph);
}

/* Away from the corners the first accelerations are the same (they are of the order of g, those of
 * the walls' friction 0.1 m/s2) but for the interpolation of the table that planes use, although a
 * particle sees many triangles. In corners they differ a little: a corner's points belong to the
 * deepest of planes, but to the nearest of triangles. */
static void triangles_are_planes(void **state) {
  (void)state;
  static body a[N], b[N], c[N], from[3][N];
  double worst = 0.0;
  run(0, 0, from[0], a);
  run(0, 1, from[1], b);
  run(1, 0, from[2], c);
  for (int k = 0; k < N; k++)
    for (int m = 0; m < 3; m++) {
      const double *x = from[0][k].x;
      if (fmin(fmin(x[0], 0.08 - x[0]), fmin(x[1], 0.08 - x[1])) > 0.03)
        for (int n = 1; n < 3; n++)
          CLOSE(from[n][k].a[m], from[0][k].a[m], 1e-6);
      worst = fmax(worst, fmax(fabs(b[k].x[m] - a[k].x[m]), fabs(c[k].x[m] - a[k].x[m])));
    }
  print_message("box of triangles: positions differ by %.2g spacings\n", worst / 0.01);
  CLOSE(worst, 0.0, 0.02 * 0.01);
}

/* Couette flow: half-way between a wall at rest and one that slides, in the end half of its speed.
 * The wall feels the shear mu U/L. Bar 1 %. */
static void sliding_wall(void **state) {
  (void)state;
  scene s = scene_2d(0.1, 0.2, 0.01);
  sph_wall_params wall;
  double force[3], impulse[3];
  const double speed = 0.1, mu = 20.0;
  s.box.periodic[0] = 1;
  s.params.viscosity = mu;
  sph_t *sph = scene_create(&s);
  part_params_default(&sph_wall_table, &wall);
  wall.type = SPH_PLANE;
  wall.normal[1] = 2.0;
  OK(sph_add_wall(sph, "still", &wall, 0, NULL));
  wall.point[1] = 0.2;
  wall.normal[1] = -1.0;
  wall.velocity[0] = speed;
  OK(sph_add_wall(sph, "sliding", &wall, 0, NULL));
  fill_box(sph, &s);
  OK(sph_start(sph));
  OK(sph_advance(sph, 2.0, NULL)); /* 10 times L^2/(pi^2 nu) = 0.2 s */
  sph_view view;
  OK(sph_get_view(sph, &view));
  for (int i = 0; i < view.own; i++)
    CLOSE(view.velocity[view.xv_stride * i], speed * view.position[view.xv_stride * i + 1] / 0.2,
          0.01 * speed);
  OK(sph_get_wall_force(sph, 1, force, impulse));
  CLOSE(force[0] / (-mu * speed / 0.2 * 0.1 * s.params.depth), 1.0, 0.02);
  OK(sph_get_wall_force(sph, 0, force, impulse));
  CLOSE(force[0] / (mu * speed / 0.2 * 0.1 * s.params.depth), 1.0, 0.02);
  FAILS(PART_ERR_RANGE, "no wall 2", sph_get_wall_force(sph, 2, force, impulse));
  assert_string_equal(sph_wall_name(sph, 1), "sliding");
  assert_null(sph_wall_name(sph, 2));
  CLOSE(sph_wall_gamma(sph, (const double[3]){0.05, 0.0, 0.0}), 0.5, 1e-9);
  CLOSE(sph_wall_gamma(sph, (const double[3]){0.05, 0.1, 0.0}), 1.0, 0.0);
  sph_destroy(sph);
}

static void bad_walls(void **state) {
  (void)state;
  scene s = tank();
  sph_wall_params plane, mesh;
  double v[9] = {0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 2.0, 0.0, 0.0};
  s.box.periodic[0] = 1;
  sph_t *sph = scene_create(&s);
  part_params_default(&sph_wall_table, &plane);
  mesh = plane;
  plane.type = SPH_PLANE;
  mesh.type = SPH_TRIANGLES;
  FAILS(PART_ERR_RANGE, "wall a: entry normal must be given",
        sph_add_wall(sph, "a", &plane, 0, NULL));
  plane.normal[2] = 1.0;
  FAILS(PART_ERR_ARGUMENT, "no triangles", sph_add_wall(sph, "a", &plane, 1, v));
  plane.normal[0] = 1.0;
  FAILS(PART_ERR_RANGE, "component 0 must be 0", sph_add_wall(sph, "a", &plane, 0, NULL));
  plane.normal[0] = 0.0;
  OK(sph_add_wall(sph, "a", &plane, 0, NULL));
  FAILS(PART_ERR_ARGUMENT, "given twice", sph_add_wall(sph, "a", &plane, 0, NULL));
  FAILS(PART_ERR_ARGUMENT, "1 to 255", sph_add_wall(sph, "", &plane, 0, NULL));
  FAILS(PART_ERR_ARGUMENT, "needs triangles", sph_add_wall(sph, "b", &mesh, 0, NULL));
  FAILS(PART_ERR_RANGE, "triangle 0 has no area", sph_add_wall(sph, "b", &mesh, 1, v));
  v[4] = (double)NAN;
  FAILS(PART_ERR_NUMERIC, "triangle 0", sph_add_wall(sph, "b", &mesh, 1, v));
  v[4] = 1.0;
  mesh.point[0] = 1.0;
  FAILS(PART_ERR_RANGE, "belong to type plane", sph_add_wall(sph, "b", &mesh, 1, v));
  assert_int_equal(sph_wall_count(sph), 1);
  sph_destroy(sph);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(triangles_are_planes),
      cmocka_unit_test(sliding_wall),
      cmocka_unit_test(bad_walls),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
