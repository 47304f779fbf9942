/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Walls that move (S.28) against closed forms: start-up of Couette flow, Stokes' second problem,
 * Taylor-Couette flow, a column on a piston, a box that moves with its fluid; restart and ranks. */
#include "common.h"

static sph_wall_params plane_at(double y, double normal) {
  sph_wall_params wall;
  part_params_default(&sph_wall_table, &wall);
  wall.type = SPH_PLANE;
  wall.point[1] = y;
  wall.normal[1] = normal;
  return wall;
}

/* Strip of fluid along x between two planes, at rest, of the viscosity nu (m2/s). */
enum { HIGH = 20 };
static const double height = 0.02, spacing = 0.001;
static sph_t *strip(double nu, const sph_wall_params *lower) {
  scene s = scene_2d(10.0 * spacing, height, spacing);
  s.box.periodic[0] = 1;
  s.params.viscosity = 1000.0 * nu;
  s.params.sound_speed = 1.0;
  sph_t *sph = scene_create(&s);
  const sph_wall_params upper = plane_at(height, -1.0);
  OK(sph_add_wall(sph, "lower", lower, 0, NULL));
  OK(sph_add_wall(sph, "upper", &upper, 0, NULL));
  fill_box(sph, &s);
  OK(sph_start(sph));
  return sph;
}

/* Largest difference from u(y) of all particles. */
static double furthest(sph_t *sph, double (*wanted)(double y, double t), double t) {
  sph_view view;
  double most = 0.0;
  OK(sph_get_view(sph, &view));
  for (int i = 0; i < view.own; i++)
    most = fmax(most, fabs(view.velocity[view.xv_stride * i] -
                           wanted(view.position[view.xv_stride * i + 1], t)));
  return most;
}

static const double viscosity = 1e-4, begins = 0.1; /* m2/s, s */
static double starting(double y, double t) {
  double u = 1.0 - y / height;
  for (int k = 1; k < 60; k++)
    u -= 2.0 / (k * PI) * sin(k * PI * y / height) *
         exp(-viscosity * k * k * PI * PI / (height * height) * t);
  return 0.01 * u;
}

/* 0.01 m/s along the plane from 0.1 s on: 20 particles across, 0.2 % of the speed of the wall off;
 * the wall's power is that of its force. */
static void starting_couette(void **state) {
  (void)state;
  sph_wall_params wall = plane_at(0.0, 1.0);
  sph_wall_report r;
  wall.velocity[0] = 0.01;
  wall.start_time = begins;
  sph_t *sph = strip(viscosity, &wall);
  OK(sph_advance(sph, 0.5 * begins, NULL));
  OK(sph_get_wall_report(sph, 0, &r));
  CLOSE(r.force[0], 0.0, 1e-15);
  OK(sph_advance(sph, 0.5 * begins, NULL));
  for (int k = 1; k <= 3; k++) {
    const double t[] = {0.0, 0.1, 0.4, 2.4};
    OK(sph_advance(sph, t[k] - t[k - 1], NULL));
    const double most = furthest(sph, starting, t[k]) / 0.01;
    print_message("Couette flow %.1f s after the start: %.3f %% of the speed of the wall off\n",
                  t[k], 100.0 * most);
    CLOSE(most, 0.0, 0.005);
  }
  OK(sph_get_wall_report(sph, 0, &r));
  CLOSE(r.force[0] / (-1000.0 * viscosity * 0.01 / height * 10.0 * spacing * 0.1), 1.0, 0.01);
  CLOSE(r.power / (-0.01 * r.force[0]), 1.0, 1e-12);
  CLOSE(r.work / (-0.01 * r.impulse[0]), 1.0, 0.01);
  CLOSE(r.centre[0], 0.024, 1e-12);
  sph_destroy(sph);
}

/* Plate that oscillates along itself, 10 spacings high: the layer is 3.6 spacings thick, the upper
 * wall 5.6 of it away. After five periods. */
static const double frequency = 2.5;
static double stokes(double y, double t) {
  const double omega = 2.0 * PI * frequency, delta = sqrt(2.0 * viscosity / omega);
  return omega * 1e-4 * exp(-y / delta) * cos(omega * t - y / delta);
}
static void oscillating_plate(void **state) {
  (void)state;
  const double speed = 2.0 * PI * frequency * 1e-4;
  sph_wall_params wall = plane_at(0.0, 1.0);
  wall.oscillation_amplitude = 1e-4;
  wall.oscillation_frequency = frequency;
  wall.oscillation_direction[0] = 3.0;
  sph_t *sph = strip(viscosity, &wall);
  OK(sph_advance(sph, 5.0 / frequency, NULL));
  double most = 0.0;
  for (int k = 1; k <= 4; k++) {
    OK(sph_advance(sph, 0.25 / frequency, NULL));
    most = fmax(most, furthest(sph, stokes, (5.0 + 0.25 * k) / frequency));
  }
  print_message("Stokes' second problem: %.2f %% of the speed of the plate off\n",
                100.0 * most / speed);
  CLOSE(most / speed, 0.0, 0.02);
  sph_destroy(sph);
}

/* ---- surfaces of triangles ---------------------------------------------------------------------
 */
/* Cylinder along z, triangles from -deep to deep; outward: normals away from the axis. */
static int cylinder(double radius, int sides, double deep, int outward, double *v) {
  for (int k = 0; k < sides; k++) {
    const double a = 2.0 * PI * (outward ? k : k + 1) / sides,
                 b = 2.0 * PI * (outward ? k + 1 : k) / sides;
    const double p[2] = {radius * cos(a), radius * sin(a)},
                 q[2] = {radius * cos(b), radius * sin(b)};
    const double two[18] = {p[0], p[1], -deep, q[0], q[1], -deep, q[0], q[1], deep,
                            p[0], p[1], -deep, q[0], q[1], deep,  p[0], p[1], deep};
    memcpy(v + 18 * k, two, sizeof two);
  }
  return 2 * sides;
}

/* Gap of 10 spacings, inner radius 10, inner cylinder turning. Closed form: u = A r + B/r,
 * torque 4 pi mu B per length. S.8 is mu times the Laplacian of u, so that a wall gets mu du/dn,
 * which of one that turns lacks 2 mu omega times its cross section; S.9 keeps angular momentum. */
enum { SIDES = 64, RING = 2000 };
static void turning(int model) {
  const double dx = 0.001, r1 = 0.01, r2 = 0.02, omega = 0.5, nu = 1e-4;
  static double v[2 * SIDES * 9], x[3 * RING];
  scene s = scene_2d(2.4 * r2, 2.4 * r2, dx);
  sph_wall_params wall;
  sph_wall_report inner, outer;
  sph_report report;
  sph_view view;
  int n = 0;
  for (int c = 0; c < 2; c++) {
    s.box.lo[c] = -1.2 * r2;
    s.box.hi[c] = 1.2 * r2;
  }
  s.params.viscosity = 1000.0 * nu;
  s.params.viscosity_model = model;
  s.params.sound_speed = 0.2;
  s.params.background_pressure = 1.0;
  sph_t *sph = scene_create(&s);
  part_params_default(&sph_wall_table, &wall);
  wall.type = SPH_TRIANGLES;
  OK(sph_add_wall(sph, "outer", &wall, cylinder(r2, SIDES, r2, 0, v), v));
  wall.rotation_axis[2] = 2.0;
  wall.rotation_rate = omega;
  OK(sph_add_wall(sph, "inner", &wall, cylinder(r1, SIDES, r2, 1, v), v));
  for (int k = 0; k < 10; k++) { /* rings */
    const double r = r1 + (k + 0.5) * dx;
    const int m = (int)(2.0 * PI * r / dx + 0.5);
    for (int j = 0; j < m; j++, n++) {
      x[3 * n] = r * cos(2.0 * PI * j / m);
      x[3 * n + 1] = r * sin(2.0 * PI * j / m);
      x[3 * n + 2] = 0.0;
    }
  }
  OK(sph_insert_points(sph, n, x, NULL, NULL, NULL, NULL));
  OK(sph_start(sph));
  OK(sph_advance(sph, 0.8, NULL)); /* (r2 - r1)^2/(pi^2 nu) = 0.1 s */
  OK(sph_get_wall_report(sph, 0, &outer));
  OK(sph_get_wall_report(sph, 1, &inner));
  OK(sph_get_report(sph, &report));
  OK(sph_get_view(sph, &view));
  const double share = r2 * r2 - r1 * r1, b = omega * r1 * r1 * r2 * r2 / share,
               a = -omega * r1 * r1 / share;
  const double torque = 4.0 * PI * 1000.0 * nu * b * s.params.depth;
  const double lacks = model == SPH_MORRIS ? 0.5 * omega * r1 * r1 / b : 0.0;
  double square = 0.0;
  for (int i = 0; i < view.own; i++) {
    const double *y = view.position + view.xv_stride * i, *u = view.velocity + view.xv_stride * i;
    const double r = hypot(y[0], y[1]), around = (y[0] * u[1] - y[1] * u[0]) / r;
    square += (around - a * r - b / r) * (around - a * r - b / r) / view.own;
  }
  print_message(
      "Taylor-Couette: velocity off by %.2f %% of that of the wall, torques %.4f and %.4f of "
      "the closed form, power %.4f\n",
      100.0 * sqrt(square) / (omega * r1), -inner.torque[2] / torque, outer.torque[2] / torque,
      inner.power / (torque * omega));
  CLOSE(sqrt(square) / (omega * r1), 0.0, 0.03);
  CLOSE(-inner.torque[2] / torque, 1.0 - lacks, 0.06);
  CLOSE(outer.torque[2] / torque, 1.0, 0.06);
  CLOSE(inner.angle, 0.4, 1e-12);
  CLOSE(report.budget_error, 0.0, 1e-12);
  CLOSE(outer.power, 0.0, 0.0);
  sph_destroy(sph);
}

static void taylor_couette(void **state) {
  (void)state;
  turning(SPH_MORRIS);
  turning(SPH_MONAGHAN);
}

/* ---- walls whose place changes -----------------------------------------------------------------
 */
/* Column of water on a floor that goes up and down: it weighs m (g + a), and takes up the work of
 * the floor. The slowest sound wave of the column goes through it 60 times in a period. */
static scene column(sph_wall_params *wall) {
  scene s = scene_2d(10.0 * spacing, 3.0 * height, spacing);
  s.box.periodic[0] = 1;
  s.params.gravity[1] = -10.0;
  s.params.sound_speed = 6.0;
  s.params.artificial_viscosity = 0.1;
  s.box.lo[1] = -5.0 * spacing;
  *wall = plane_at(0.0, 1.0);
  wall->oscillation_amplitude = 2.0 * spacing;
  wall->oscillation_frequency = 5.0;
  wall->oscillation_direction[1] = 1.0;
  return s;
}
static void fill_column(sph_t *sph, const sph_wall_params *wall) {
  sph_insert insert;
  part_params_default(&sph_insert_table, &insert);
  memset(insert.origin, 0, sizeof insert.origin);
  memset(insert.extent, 0, sizeof insert.extent);
  insert.extent[0] = 10.0 * spacing;
  insert.extent[1] = height;
  insert.hydrostatic = 1;
  insert.surface[1] = height;
  insert.velocity[1] = 2.0 * PI * wall->oscillation_frequency * wall->oscillation_amplitude;
  OK(sph_insert_box(sph, &insert, NULL));
}

static double energy(sph_t *sph) {
  sph_view view;
  double sum = 0.0;
  OK(sph_get_view(sph, &view));
  for (int i = 0; i < view.own; i++) {
    const double *x = view.position + view.xv_stride * i, *v = view.velocity + view.xv_stride * i;
    sum += view.mass[view.mass_stride * i] * (0.5 * (v[0] * v[0] + v[1] * v[1]) + 10.0 * x[1]);
  }
  return sum;
}

static void piston(void **state) {
  (void)state;
  sph_wall_params wall;
  const scene s = column(&wall);
  const double omega = 2.0 * PI * 5.0, mass = 1000.0 * 10.0 * spacing * height * s.params.depth;
  double most = 0.0;
  sph_wall_report r;
  sph_report report;
  sph_t *sph = scene_create(&s);
  OK(sph_add_wall(sph, "floor", &wall, 0, NULL));
  fill_column(sph, &wall);
  OK(sph_start(sph));
  const double before = energy(sph);
  for (int k = 1; k <= 40; k++) {
    double impulse = 0.0, wanted = 0.0;
    OK(sph_get_wall_report(sph, 0, &r));
    impulse = -r.impulse[1];
    wanted = -10.0 * 0.00625 -
             2.0 * spacing * omega * (cos(omega * 0.00625 * k) - cos(omega * 0.00625 * (k - 1)));
    OK(sph_advance(sph, 0.00625, NULL));
    OK(sph_get_wall_report(sph, 0, &r));
    impulse += r.impulse[1];
    most = fmax(most, fabs(impulse / mass - wanted) / (10.0 * 0.00625));
    CLOSE(r.centre[1], 2.0 * spacing * sin(omega * 0.00625 * k), 1e-12);
  }
  OK(sph_get_report(sph, &report));
  const double gained = energy(sph) - before;
  print_message(
      "piston: force %.2f %% of the weight off, work of the floor %.5g J, taken up %.5g J, "
      "budget %.1e\n",
      100.0 * most, r.work, gained, report.budget_error);
  CLOSE(most, 0.0, 0.03);
  CLOSE(r.work / gained, 1.0, 0.02);
  CLOSE(report.budget_error, 0.0, 1e-12);
  sph_destroy(sph);
}

/* Box of triangles and the fluid in it, both with one velocity: nothing happens to it. */
static void moving_box(void **state) {
  (void)state;
  const double side = 0.01, u[2] = {0.04, -0.03};
  const double corner[4][2] = {{0.0, 0.0}, {side, 0.0}, {side, side}, {0.0, side}};
  static double v[8][9], x[300], w[300];
  scene s = scene_2d(0.06, 0.06, spacing);
  sph_wall_params wall;
  sph_view view;
  int n = 0;
  s.params.viscosity = 1.0;
  s.params.background_pressure = 100.0;
  s.box.lo[0] = s.box.lo[1] = -0.03;
  for (int k = 0; k < 4; k++) {
    const double *p = corner[(k + 1) % 4], *q = corner[k], z = 0.05; /* normals inwards */
    const double two[2][9] = {{p[0], p[1], -z, q[0], q[1], -z, q[0], q[1], z},
                              {p[0], p[1], -z, q[0], q[1], z, p[0], p[1], z}};
    memcpy(v[2 * k], two, sizeof two);
  }
  part_params_default(&sph_wall_table, &wall);
  wall.type = SPH_TRIANGLES;
  memcpy(wall.velocity, u, sizeof u);
  sph_t *sph = scene_create(&s);
  OK(sph_add_wall(sph, "box", &wall, 8, &v[0][0]));
  for (int k = 0; k < 100; k++, n++) {
    x[3 * n] = (k % 10 + 0.5) * spacing;
    x[3 * n + 1] = (k / 10 + 0.5) * spacing;
    memcpy(w + 3 * n, u, sizeof u);
  }
  OK(sph_insert_points(sph, n, x, w, NULL, NULL, NULL));
  OK(sph_start(sph));
  OK(sph_advance(sph, 0.2, NULL));
  OK(sph_get_view(sph, &view));
  double most = 0.0;
  for (int i = 0; i < view.own; i++)
    for (int c = 0; c < 2; c++)
      most = fmax(most, fabs(view.velocity[view.xv_stride * i + c] - u[c]));
  print_message("box moved by 10 mm: velocities differ by %.1e m/s\n", most);
  CLOSE(most, 0.0, 1e-9);
  sph_destroy(sph);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(starting_couette), cmocka_unit_test(oscillating_plate),
      cmocka_unit_test(taylor_couette),   cmocka_unit_test(piston),
      cmocka_unit_test(moving_box),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
