/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Flow through a square lattice of cylinders (Morris, Fox and Zhu 1997; Markauskas et al. 2017,
 * sec. 5.2.2), the cylinder a surface of triangles. The reference is our own finite element
 * solution (P2/P1, curved elements, converged to 0.02 %): superficial velocity 4.9003e-5
 * m/s, 1.1253e-4 m/s in the middle of the gap between two cylinders. */
#include "common.h"

static const double side = 0.1, radius = 0.02, drive = 1.5e-7;
enum { ACROSS = 33, SIDES = 64 };

/* Right-hand normals to the outside, where the fluid is. */
static void add_cylinder(sph_t *sph) {
  double v[SIDES][2][9];
  sph_wall_params wall;
  for (int k = 0; k < SIDES; k++) {
    const double a = 2.0 * PI * k / SIDES, b = 2.0 * PI * (k + 1) / SIDES, m = 0.5 * side;
    const double p[2] = {m + radius * cos(a), m + radius * sin(a)},
                 q[2] = {m + radius * cos(b), m + radius * sin(b)};
    const double two[2][9] = {{p[0], p[1], -m, q[0], q[1], -m, q[0], q[1], m},
                              {p[0], p[1], -m, q[0], q[1], m, p[0], p[1], m}};
    memcpy(v[k], two, sizeof two);
  }
  part_params_default(&sph_wall_table, &wall);
  wall.type = SPH_TRIANGLES;
  OK(sph_add_wall(sph, "cylinder", &wall, 2 * SIDES, &v[0][0][0]));
}

static int fill(sph_t *sph, double dx) {
  double x[3 * ACROSS * ACROSS];
  int n = 0;
  for (int k = 0; k < ACROSS * ACROSS; k++) {
    const double at[3] = {(k % ACROSS + 0.5) * dx, (k / ACROSS + 0.5) * dx, 0.0};
    if (hypot(at[0] - 0.5 * side, at[1] - 0.5 * side) > radius + 0.3 * dx)
      memcpy(x + 3 * n++, at, sizeof at);
  }
  OK(sph_insert_points(sph, n, x, NULL, NULL, NULL, NULL));
  return n;
}

/* 33 particles across: 1 % off in the superficial velocity, with 50 (10 s) 0.25 %; bars twice what
 * 33 give. The cylinder takes the whole of the driving force in the end. */
static void lattice_of_cylinders(void **state) {
  (void)state;
  const double dx = side / ACROSS;
  double flow = 0.0, gap[2] = {0.0, 0.0}, force[3], impulse[3];
  scene s = scene_2d(side, side, dx);
  sph_view view;
  sph_report report;
  s.box.periodic[0] = s.box.periodic[1] = 1;
  s.params.kernel = SPH_KERNEL_cubic_spline;
  s.params.smoothing_length = 1.2 * dx;
  s.params.gravity[0] = drive;
  s.params.sound_speed = 5.77e-4;
  s.params.viscosity = 1e-3;
  s.params.background_pressure = 1e-5;
  sph_t *sph = scene_create(&s);
  add_cylinder(sph);
  const int n = fill(sph, dx);
  OK(sph_start(sph));
  OK(sph_advance(sph, 3000.0, NULL));
  OK(sph_get_view(sph, &view));
  for (int i = 0; i < view.own; i++) {
    const double *x = view.position + view.xv_stride * i, u = view.velocity[view.xv_stride * i];
    const double along = fabs(x[0] - side * floor(x[0] / side) - 0.5 * side),
                 y = x[1] - side * floor(x[1] / side);
    flow += view.volume[view.xv_stride * i] * u / (side * side * s.params.depth);
    if (along < dx && fmin(y, side - y) < dx) {
      gap[0] += u;
      gap[1] += 1.0;
    }
  }
  OK(sph_get_wall_force(sph, 0, force, impulse));
  OK(sph_get_report(sph, &report));
  const double weight = 1000.0 * drive * n * dx * dx * s.params.depth;
  print_message("superficial %.4e (4.9003e-05), gap %.4e (1.1253e-04) m/s, force %.4f of the "
                "drive, %lld steps\n",
                flow, gap[0] / gap[1], force[0] / weight, report.steps);
  CLOSE(flow / 4.9003e-5, 1.0, 0.02);
  CLOSE(gap[0] / gap[1] / 1.1253e-4, 1.0, 0.02);
  CLOSE(force[0] / weight, 1.0, 0.02);
  CLOSE(report.budget_error, 0.0, 1e-12);
  sph_destroy(sph);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(lattice_of_cylinders),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
