/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Walls of all models: closed forms of those that push, on one particle alone (S.24, S.25); water
 * at rest on each; the flow between plates of fixed points; what each refuses. */
#include "common.h"

static const double g = 9.81;

static sph_wall_params wall_of(int model) {
  sph_wall_params wall;
  part_params_default(&sph_wall_table, &wall);
  wall.type = SPH_PLANE;
  wall.model = model;
  wall.slip = model == SPH_WALL_ghost || model == SPH_WALL_fixed ? SPH_NO_SLIP : SPH_FREE_SLIP;
  wall.normal[1] = 1.0;
  return wall;
}

/* One particle of 0.01 m at a height over the plane y = 0, with a speed along y. */
static sph_t *alone(const sph_wall_params *wall, double height, double speed) {
  scene s = scene_2d(0.4, 0.4, 0.01);
  const double x[3] = {0.2, height, 0.0}, v[3] = {0.0, speed, 0.0};
  sph_t *sph = scene_create(&s);
  OK(sph_add_wall(sph, "floor", wall, 0, NULL));
  OK(sph_insert_points(sph, 1, x, v, NULL, NULL, NULL));
  OK(sph_start(sph));
  return sph;
}

static double acceleration(const sph_wall_params *wall, double height, double speed) {
  sph_view view;
  sph_t *sph = alone(wall, height, speed);
  OK(sph_get_view(sph, &view));
  const double a = view.acceleration[1];
  assert_true(view.acceleration[0] == 0.0);
  sph_destroy(sph);
  return a;
}

/* c = 10 m/s, h = 0.015 m: 0.01 c^2/y times the shape at y/h. */
static void repulsive_force(void **state) {
  (void)state;
  const sph_wall_params wall = wall_of(SPH_WALL_repulsive);
  const double q[5] = {0.3, 0.8, 1.0, 1.6, 2.0},
               shape[5] = {2.0 / 3.0, 1.6 - 1.5 * 0.64, 0.5, 0.08, 0.0};
  for (int k = 0; k < 5; k++) {
    const double y = 0.015 * q[k], wanted = 0.01 * 100.0 / y * shape[k];
    CLOSE(acceleration(&wall, y, 0.0), wanted, 1e-9 + 1e-12 * wanted);
  }
}

/* Mass 1000 x 0.01^2 x 0.1 = 0.01 kg, k = 50 N/m: k/m = 5000 1/s2. */
static void spring_force(void **state) {
  (void)state;
  sph_wall_params wall = wall_of(SPH_WALL_spring);
  wall.stiffness = 50.0;
  CLOSE(acceleration(&wall, 0.002, 0.0), 5000.0 * 0.003, 1e-9);
  CLOSE(acceleration(&wall, 0.0051, 0.0), 0.0, 0.0);
  CLOSE(acceleration(&wall, 0.002, -0.2), 5000.0 * 0.003, 1e-9);
  wall.restitution = 0.6;
  const double loss = -log(0.6), half = loss * sqrt(5000.0 / (PI * PI + loss * loss));
  CLOSE(acceleration(&wall, 0.002, -0.2), 5000.0 * 0.003 + 2.0 * half * 0.2, 1e-9);
}

/* Speed upwards after a particle has been thrown at the floor, over that before; momentum closes.
 */
static double thrown(const sph_wall_params *wall, double speed) {
  sph_report report;
  sph_view view;
  double force[3], impulse[3];
  sph_t *sph = alone(wall, 0.035, -speed);
  OK(sph_advance(sph, 0.09 / speed, NULL));
  OK(sph_get_view(sph, &view));
  OK(sph_get_report(sph, &report));
  OK(sph_get_wall_force(sph, 0, force, impulse));
  const double up = view.velocity[1];
  CLOSE(report.budget_error, 0.0, 1e-13);
  CLOSE(impulse[1], -0.01 * (speed + up), 1e-13);
  assert_true(view.position[1] > 0.01);
  sph_destroy(sph);
  return up / speed;
}

/* The spring gives back e (steps of a fiftieth of the contact: 0.2 %), the repulsive force, which
 * has a potential, everything (S.13 within 1e-3 at the steps of S.15). */
static void bounce(void **state) {
  (void)state;
  sph_wall_params spring = wall_of(SPH_WALL_spring);
  const sph_wall_params repulsive = wall_of(SPH_WALL_repulsive);
  spring.stiffness = 200.0;
  for (int k = 0; k < 3; k++) {
    spring.restitution = 1.0 - 0.3 * k;
    const double e = thrown(&spring, 0.2);
    print_message("spring: restitution %.4f, given %.1f\n", e, spring.restitution);
    CLOSE(e, spring.restitution, 0.01);
  }
  const double e = thrown(&repulsive, 0.5);
  print_message("repulsive: %.5f of the speed\n", e);
  CLOSE(e, 1.0, 2e-3);
}

/* Slope of the pressure along y in the middle of the tank, by least squares. */
static double slope_of(sph_t *sph) {
  double n = 0.0, y = 0.0, p = 0.0, yy = 0.0, yp = 0.0;
  sph_view view;
  OK(sph_get_view(sph, &view));
  for (int i = 0; i < view.own; i++) {
    const double *x = view.position + view.xv_stride * i, here = view.pressure[view.xv_stride * i];
    if (fabs(x[0] - 0.05) > 0.03 || x[1] < 0.02 || x[1] > 0.08)
      continue;
    n += 1.0;
    y += x[1];
    p += here;
    yy += x[1] * x[1];
    yp += x[1] * here;
  }
  return (n * yp - y * p) / (n * yy - y * y);
}

/* Water, 0.1 m deep, 20 particles, after 1 s and over another: the mean slope of its pressure over
 * that of a fluid at rest (where the surface is depends on the gap that a wall leaves). The floor
 * carries it whatever the model. The repulsive force is a floor between periodic sides, as in
 * Robinson et al. (2014): it acts over 2h, and sides push the surface away by several g. The column
 * bounces on it, for nothing damps that: hence means. */
static void still(int model, double bar) {
  scene s = scene_2d(0.1, 0.16, 0.005);
  sph_report report;
  sph_view view;
  double carried = 0.0, slope = 0.0, force[3], impulse[2][3], mass = 0.0;
  s.params.gravity[1] = -g;
  s.params.sound_speed = 10.0 * sqrt(g * 0.1);
  s.params.viscosity = 1e-3;
  s.params.artificial_viscosity = 0.2;
  s.box.periodic[0] = model == SPH_WALL_repulsive;
  sph_t *sph = scene_create(&s);
  for (int k = 0; k < (s.box.periodic[0] ? 1 : 3); k++) {
    sph_wall_params wall = wall_of(model);
    const char *const names[3] = {"floor", "left", "right"};
    wall.normal[0] = k == 1 ? 1.0 : k == 2 ? -1.0 : 0.0;
    wall.normal[1] = k == 0 ? 1.0 : 0.0;
    wall.point[0] = k == 2 ? 0.1 : 0.0;
    wall.stiffness = model == SPH_WALL_spring ? 2000.0 : 0.0;
    wall.restitution = model == SPH_WALL_spring ? 0.3 : 1.0;
    OK(sph_add_wall(sph, names[k], &wall, 0, NULL));
  }
  fill_water(sph, &s, 0.1, 1);
  OK(sph_start(sph));
  OK(sph_advance(sph, 1.0, NULL));
  OK(sph_get_wall_force(sph, 0, force, impulse[0]));
  for (int n = 0; n < 100; n++) {
    OK(sph_advance(sph, 0.01, NULL));
    slope += 0.01 * slope_of(sph);
  }
  OK(sph_get_wall_force(sph, 0, force, impulse[1]));
  OK(sph_get_view(sph, &view));
  for (int i = 0; i < view.own; i++)
    mass += view.mass[view.mass_stride * i];
  OK(sph_get_report(sph, &report));
  carried = (impulse[0][1] - impulse[1][1]) / (mass * g);
  print_message(
      "model %d: slope of the pressure %.4f of rho g, floor carries %.4f, fastest %.3f m/s\n",
      model, slope / (-1000.0 * g), carried, report.max_speed);
  CLOSE(slope / (-1000.0 * g), 1.0, bar);
  CLOSE(carried, 1.0, 0.02);
  CLOSE(report.budget_error, 0.0, 1e-12);
  assert_int_equal(report.particles, 400);
  sph_destroy(sph);
}

static void still_water(void **state) {
  (void)state;
  for (int model = 0; model < SPH_WALL_MODEL_COUNT; model++)
    still(model, 0.05);
}

/* Couette flow: plates of fixed points, the upper one slides; linear in between. Without the mirror
 * of S.16 the fluid's velocity at the wall is not that of the wall. */
static void couette(void **state) {
  const double width = 0.02, speed = 0.1, dx = width / 20;
  scene s = scene_2d(0.02, width, dx);
  sph_view view;
  sph_report report;
  double worst = 0.0;
  (void)state;
  s.box.periodic[0] = 1;
  s.params.viscosity = 1.0;
  s.params.sound_speed = 2.0;
  s.params.background_pressure = 10.0;
  sph_t *sph = scene_create(&s);
  for (int end = 0; end < 2; end++) {
    sph_wall_params wall = wall_of(SPH_WALL_fixed);
    wall.layers = 3;
    wall.normal[1] = end ? -1.0 : 1.0;
    wall.point[1] = end ? width : 0.0;
    wall.velocity[0] = end ? speed : 0.0;
    OK(sph_add_wall(sph, end ? "upper" : "lower", &wall, 0, NULL));
  }
  fill_box(sph, &s);
  OK(sph_start(sph));
  OK(sph_advance(sph, 1.0, NULL));
  OK(sph_get_view(sph, &view));
  for (int i = 0; i < view.own; i++) {
    const double *x = view.position + view.xv_stride * i, *v = view.velocity + view.xv_stride * i;
    worst = fmax(worst, fabs(v[0] / speed - x[1] / width));
  }
  OK(sph_get_report(sph, &report));
  print_message("Couette flow of fixed points: %.4f of the speed off\n", worst);
  assert_true(worst < 0.05);
  CLOSE(report.budget_error, 0.0, 1e-12);
  sph_destroy(sph);
}

static void refused(void **state) {
  scene s = scene_2d(0.4, 0.4, 0.01);
  sph_wall_params wall;
  sph_t *sph = scene_create(&s);
  (void)state;
  wall = wall_of(SPH_WALL_repulsive);
  wall.slip = SPH_NO_SLIP;
  FAILS(PART_ERR_RANGE, "wall a: entry slip: must be freeSlip",
        sph_add_wall(sph, "a", &wall, 0, NULL));
  wall = wall_of(SPH_WALL_fixed);
  wall.slip = SPH_FREE_SLIP;
  FAILS(PART_ERR_RANGE, "entry slip: must be noSlip", sph_add_wall(sph, "a", &wall, 0, NULL));
  wall = wall_of(SPH_WALL_repulsive);
  wall.velocity[0] = 1.0;
  FAILS(PART_ERR_RANGE, "entry velocity: must be 0", sph_add_wall(sph, "a", &wall, 0, NULL));
  wall = wall_of(SPH_WALL_spring);
  FAILS(PART_ERR_RANGE, "entry stiffness: must be given", sph_add_wall(sph, "a", &wall, 0, NULL));
  wall = wall_of(SPH_WALL_repulsive);
  wall.stiffness = 1.0;
  FAILS(PART_ERR_RANGE, "entry stiffness: is not allowed with model repulsive",
        sph_add_wall(sph, "a", &wall, 0, NULL));
  wall = wall_of(SPH_WALL_ghost);
  wall.restitution = 0.5;
  FAILS(PART_ERR_RANGE, "entry restitution: is not allowed",
        sph_add_wall(sph, "a", &wall, 0, NULL));
  wall = wall_of(SPH_WALL_spring);
  wall.stiffness = 1.0;
  wall.layers = 2;
  FAILS(PART_ERR_RANGE, "entry layers: is not allowed", sph_add_wall(sph, "a", &wall, 0, NULL));
  wall.layers = 0;
  OK(sph_add_wall(sph, "a", &wall, 0, NULL));
  wall = wall_of(SPH_WALL_ghost);
  FAILS(PART_ERR_RANGE, "differs from that of wall a", sph_add_wall(sph, "b", &wall, 0, NULL));
  sph_destroy(sph);
  s.params.density_scheme = SPH_SUMMATION;
  sph = scene_create(&s);
  wall = wall_of(SPH_WALL_repulsive);
  FAILS(PART_ERR_RANGE, "must be ghostPoints", sph_add_wall(sph, "a", &wall, 0, NULL));
  sph_destroy(sph);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(repulsive_force), cmocka_unit_test(spring_force), cmocka_unit_test(bounce),
      cmocka_unit_test(still_water),     cmocka_unit_test(couette),      cmocka_unit_test(refused),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
