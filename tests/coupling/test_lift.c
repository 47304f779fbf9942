/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lift by shear and spin, and the torque of the fluid: formulas, and what the fluid gets back. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../../libcoupling/src/spin_forces.h"
#include "scene.h"

static const double PI = 3.14159265358979323846;

/* Small Reynolds numbers: Saffman's and Rubinow and Keller's own results. */
static void test_creeping(void **state) {
  (void)state;
  const double d = 1e-4, rho = 1000.0, mu = 1e-2, slip = 1e-4, shear = 0.5;
  assert_near(cpl_saffman_scale(slip, shear, d, rho, mu) / (1.615 * d * d * sqrt(rho * mu / shear)),
              1.0, 1e-3);
  assert_near(cpl_magnus_scale(slip, 10.0, d, rho, mu) / (PI / 8.0 * rho * d * d * d), 1.0, 1e-2);
  assert_near(cpl_magnus_scale(0.0, 10.0, d, rho, mu), PI / 8.0 * rho * d * d * d, 1e-20);
  assert_near(cpl_turning_drag(10.0, d, rho, mu), PI * mu * d * d * d, 1e-25);
  assert_near(cpl_saffman_scale(slip, 0.0, d, rho, mu), 0.0, 0.0);
}

/* Mei's factor at the numbers of his fit: Re = 100, beta = 0.2: 0.0524 sqrt(20); Re = 10, beta =
 * 0.1. */
static void test_finite(void **state) {
  (void)state;
  const double d = 1e-3, rho = 1000.0, mu = 1e-3; /* Re = 1000 slip d .. = 1000 slip */
  for (int k = 0; k < 2; k++) {
    const double re = k ? 10.0 : 100.0, beta = k ? 0.1 : 0.2, slip = re * mu / (rho * d);
    const double curl = 2.0 * beta * re * mu / (rho * d * d);
    const double root = 0.3314 * sqrt(beta);
    const double f = k ? (1.0 - root) * exp(-1.0) + root : 0.0524 * sqrt(beta * re);
    assert_near(cpl_saffman_scale(slip, curl, d, rho, mu) /
                    (1.615 * d * d * sqrt(rho * mu / curl)) / f,
                1.0, 1e-12);
  }
  /* the torque has no jump where the formula changes */
  const double turn = 32.0 * mu / (rho * d * d);
  assert_near(cpl_turning_drag(turn * 1.0001, d, rho, mu) / cpl_turning_drag(turn, d, rho, mu), 1.0,
              2e-3);
  /* C_L = 0.45 + (Re_r/Re - 0.45) exp(-0.05684 Re_r^0.4 Re^0.3) at Re = 50, Re_r = 20 */
  const double c = 0.45 + (0.4 - 0.45) * exp(-0.05684 * pow(20.0, 0.4) * pow(50.0, 0.3));
  assert_near(cpl_magnus_scale(50.0 * mu / (rho * d), 20.0 * mu / (rho * d * d), d, rho, mu) /
                  (PI / 8.0 * rho * d * d * d * c / 0.4),
              1.0, 1e-12);
}

typedef struct lift_scene {
  scene s;
  double curl[3], omega[6];
} lift_scene;

/* Two equal spheres in one cell, that lag and lead, in shear u_x(y): opposite lifts. */
static void start(lift_scene *l, int model, int saffman, int magnus, int turning) {
  const mesh_options one_cell = MESH_UNIT(MESH_HEX, 1, 1, 1);
  cpl_params params = scene_params();
  const cpl_fluid fluid = {1000.0, 1e-3, {0, 0, 0}};
  params.model = model;
  params.pressure_gradient = model == CPL_MODEL_A;
  params.saffman_lift = saffman;
  params.magnus_lift = magnus;
  params.rotational_drag = turning;
  scene_mesh(&l->s, MPI_COMM_SELF, &one_cell, 0);
  assert_int_equal(scene_start(&l->s, &params, &fluid), PART_OK);
  const particle all[2] = {{{0.3, 0.4, 0.6}, 0.1, {-0.1, 0, 0}, 2000.0, 0},
                           {{0.7, 0.4, 0.6}, 0.1, {0.1, 0, 0}, 2000.0, 0}};
  scene_particles(&l->s, 2, all, 0, 0);
  scene *s = &l->s;
  assert_int_equal(cpl_locate(s->cpl, &s->view), PART_OK);
  assert_int_equal(cpl_void_fraction(s->cpl, &s->view, &s->cells, NULL), PART_OK);
  memset(s->superficial, 0, 3 * sizeof(double));
  memset(s->pressure_gradient, 0, 3 * sizeof(double));
  memset(s->stress_divergence, 0, 3 * sizeof(double));
  l->curl[0] = l->curl[1] = 0.0;
  l->curl[2] = -2.0; /* u_x = 2 y */
  for (int k = 0; k < 6; k++)
    l->omega[k] = k == 2 || k == 5 ? 3.0 : 0.0;
  s->cells.curl = l->curl;
  s->view.angular_velocity = l->omega;
  s->view.angular_velocity_stride = 3;
  assert_int_equal(cpl_sample_fluid(s->cpl, &s->view, &s->cells), PART_OK);
  assert_int_equal(cpl_fluid_force(s->cpl, &s->view), PART_OK);
}

static void test_directions(void **state) {
  (void)state;
  lift_scene l;
  start(&l, CPL_MODEL_A, 1, 0, 0);
  /* the one that lags (v_x = -0.1) goes to where the fluid is faster, +y; the other to -y */
  const double scale = cpl_saffman_scale(0.1, 2.0, 0.2, 1000.0, 1e-3);
  assert_near(l.s.row[ROW_SU + 1], 0.1 * 2.0 * scale, 1e-12 * scale);
  assert_near(l.s.row[ROW_WIDTH + ROW_SU + 1], -0.1 * 2.0 * scale, 1e-12 * scale);
  assert_null(cpl_turning(l.s.cpl));
  scene_free(&l.s);
  start(&l, CPL_MODEL_A, 0, 1, 1);
  /* it spins by 4/s about z relative to the fluid (3 - (-1)) and flies along -x: force along
   * omega x v = -y */
  const double turn = cpl_magnus_scale(0.1, 4.0, 0.2, 1000.0, 1e-3);
  assert_near(l.s.row[ROW_SU + 1], -4.0 * 0.1 * turn, 1e-12 * turn);
  const double *turning = cpl_turning(l.s.cpl);
  assert_near(turning[2], -1.0, 1e-15);
  assert_near(turning[3], cpl_turning_drag(4.0, 0.2, 1000.0, 1e-3), 1e-15);
  scene_free(&l.s);
}

/* Each particle keeps its own lift: when the flow took what it was told there is nothing to kick,
 * although the lifts of the two cancel in their cell. And the budget is closed. */
static void test_given_back(void **state) {
  (void)state;
  for (int model = 0; model < 2; model++) {
    lift_scene l;
    start(&l, model, 1, 1, 0);
    scene *s = &l.s;
    const double dt = 1e-3;
    for (int i = 0; i < 2; i++) {
      double *row = s->row + i * ROW_WIDTH;
      const double x = row[ROW_SP] * row[ROW_IMASS] * dt, f = -expm1(-x) / x;
      for (int d = 0; d < 3; d++)
        row[ROW_J + d] = f * dt * (row[ROW_SU + d] - row[ROW_SP] * row[ROW_V + d]);
    }
    /* lift is not slowed down by drag here: what the view says was received is what counts */
    assert_int_equal(cpl_momentum_source(s->cpl, &s->view, &s->cells, dt), PART_OK);
    double drag[3], kick[6], lift = fabs(s->row[ROW_J + 1]);
    for (int d = 0; d < 3; d++)
      drag[d] = (s->coefficient[0] * s->superficial[d] - s->explicit_part[d]) *
                s->mesh.view.volume[0] * dt;
    assert_true(lift > 0.0);
    assert_int_equal(cpl_reaction(s->cpl, &s->view, drag, NULL, dt, kick), PART_OK);
    cpl_budget budget;
    assert_int_equal(cpl_get_budget(s->cpl, &budget), PART_OK);
    assert_true(budget.error < 1e-13);
    /* the drag part differs by how drag answered lift within dt, O(x) of it; without extra forces
     * in the exchange the kick would be all of the lift */
    for (int i = 0; i < 2; i++)
      assert_true(fabs(kick[3 * i + 1]) < 0.05 * lift);
    scene_free(s);
  }
}

static void test_refused(void **state) {
  (void)state;
  lift_scene l;
  start(&l, CPL_MODEL_A, 1, 1, 0);
  l.s.cells.curl = NULL;
  assert_int_equal(cpl_sample_fluid(l.s.cpl, &l.s.view, &l.s.cells), PART_ERR_ARGUMENT);
  l.s.view.angular_velocity = NULL;
  assert_int_equal(cpl_fluid_force(l.s.cpl, &l.s.view), PART_ERR_ARGUMENT);
  assert_non_null(strstr(part_last_error(), "angular_velocity"));
  scene_free(&l.s);
}

int main(int argc, char **argv) {
  MPI_Init(&argc, &argv);
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_creeping),   cmocka_unit_test(test_finite),
      cmocka_unit_test(test_directions), cmocka_unit_test(test_given_back),
      cmocka_unit_test(test_refused),
  };
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
