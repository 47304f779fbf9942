/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ranks: 1 2 3 4
 * Sampled fluid and the force F = Su - Sp v: every term alone, both models, one- and two-way. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "scene.h"

enum { MANY = 200 };
static const double PI = 3.14159265358979323846;
static const mesh_options box = {.kind = MESH_HEX, .n = {5, 4, 3}, .hi = {1, 0.8, 0.6}};

static void start(scene *s, const cpl_params *params, const cpl_fluid *fluid) {
  particle all[MANY];
  scene_random(&box, MANY, 0.005, 0.05, 21, all);
  scene_mesh(s, MPI_COMM_WORLD, &box, 1);
  assert_int_equal(scene_start(s, params, fluid), PART_OK);
  scene_particles(s, MANY, all, 2, 0);
  assert_int_equal(cpl_locate(s->cpl, &s->view), PART_OK);
  assert_int_equal(cpl_void_fraction(s->cpl, &s->view, &s->cells, NULL), PART_OK);
}

static void force(scene *s) {
  assert_int_equal(cpl_sample_fluid(s->cpl, &s->view, &s->cells), PART_OK);
  assert_int_equal(cpl_fluid_force(s->cpl, &s->view), PART_OK);
}

/* The particles move with the fluid: no drag, so the force is buoyancy and, model A, the pressure
 * gradient and stress force. */
static void constant_parts(int model, int pressure, int stress, int two_way) {
  cpl_params params = scene_params();
  const cpl_fluid fluid = scene_water();
  const double gradient[3] = {100.0, -50.0, 30.0}, tau[3] = {7.0, 8.0, -9.0};
  params.model = model;
  params.pressure_gradient = pressure;
  params.viscous_stress = stress;
  params.two_way = two_way;
  scene s;
  start(&s, &params, &fluid);
  for (int c = 0; c < s.mesh.view.cells; c++)
    for (int d = 0; d < 3; d++) {
      s.superficial[3 * c + d] = 0.0;
      s.pressure_gradient[3 * c + d] = gradient[d];
      s.stress_divergence[3 * c + d] = tau[d];
    }
  for (int i = 0; i < s.view.count; i++)
    for (int d = 0; d < 3; d++)
      s.row[i * ROW_WIDTH + ROW_V + d] = 0.0;
  force(&s);
  for (int i = 0; i < s.view.count; i++) {
    const double *row = s.row + i * ROW_WIDTH;
    for (int d = 0; d < 3; d++) {
      double expected = -fluid.density * fluid.gravity[d];
      if (pressure && model == CPL_MODEL_A)
        expected -= gradient[d];
      if (stress)
        expected += tau[d];
      assert_near(row[ROW_SU + d], expected * scene_row_volume(row), 1e-11 * scene_row_volume(row) * 1e4);
    }
    assert_true(row[ROW_SP] > 0.0);
  }
  scene_free(&s);
}

static void test_constant_parts(void **state) {
  (void)state;
  for (int k = 0; k < 8; k++)
    constant_parts(CPL_MODEL_A, k & 1, k >> 1 & 1, k >> 2 & 1);
  constant_parts(CPL_MODEL_B, 0, 0, 1);
  constant_parts(CPL_MODEL_B, 1, 0, 1);
}

/* Sauter mean diameter of the spheres around each particle, by the weights of the exchange. */
static double *sauter(scene *s) {
  const int cells = s->mesh.view.cells;
  double *value = calloc(2 * (size_t)s->view.count + 1, sizeof *value);
  double *cell = calloc(2 * (size_t)cells, sizeof *cell);
  assert_true(value && cell);
  for (int i = 0; i < s->view.count; i++) {
    const double *row = s->row + i * ROW_WIDTH;
    value[2 * i] = scene_row_volume(row);
    value[2 * i + 1] = scene_row_volume(row) / (2.0 * row[ROW_R]);
  }
  assert_int_equal(cpl_deposit(s->cpl, 2, value, cell), PART_OK);
  for (int c = 0; c < cells; c++)
    cell[c] = cell[2 * c + 1] > 0.0 ? cell[2 * c] / cell[2 * c + 1] : 0.0;
  assert_int_equal(cpl_sample(s->cpl, 1, cell, value), PART_OK);
  free(cell);
  return value;
}

/* Drag from what was sampled: Su - Sp v = beta (u - v) + buoyancy, u = U/eps; model B beta sum_c
 * w_ic/eps_c. One-way or two-way: the same force. */
static void test_drag_of_sampled(void **state) {
  (void)state;
  for (int law = 0; law < cpl_drag_count(); law++)
    for (int model = 0; model < 2; model++)
      for (int two_way = 0; two_way < 2; two_way++) {
        cpl_params params = scene_params();
        const cpl_fluid fluid = scene_water();
        params.model = model;
        params.drag = law;
        params.two_way = two_way;
        params.pressure_gradient = 0;
        scene s;
        start(&s, &params, &fluid);
        scene_fluid(&s);
        force(&s);
        const double *eps = cpl_sampled_eps(s.cpl), *superficial = cpl_sampled_superficial(s.cpl);
        double *cell = calloc((size_t)s.mesh.view.cells, sizeof *cell);
        double *inverse = calloc((size_t)s.view.count + 1, sizeof *inverse);
        assert_true(cell && inverse);
        for (int c = 0; c < s.mesh.view.cells; c++)
          cell[c] = 1.0 / s.eps[c];
        assert_int_equal(cpl_sample(s.cpl, 1, cell, inverse), PART_OK);
        double *mean_d = sauter(&s);
        const cpl_drag_range *range = cpl_drag_range_of(law);
        int64_t outside = 0;
        for (int i = 0; i < s.view.count; i++) {
          const double *row = s.row + i * ROW_WIDTH;
          double slip[3], speed = 0.0;
          for (int d = 0; d < 3; d++) {
            slip[d] = superficial[3 * i + d] / eps[i] - row[ROW_V + d];
            speed += slip[d] * slip[d];
          }
          const double beta = cpl_drag_function(law)(sqrt(speed), 2.0 * row[ROW_R], eps[i], 1000.0,
                                                     1e-3, mean_d[i]) *
                              (model == CPL_MODEL_B ? inverse[i] : 1.0);
          const double re = eps[i] * sqrt(speed) * 2.0 * row[ROW_R] * 1000.0 / 1e-3;
          outside += re < range->re_low || re > range->re_high || eps[i] < range->eps_low ||
                     eps[i] > range->eps_high + 1e-12;
          assert_near(row[ROW_SP] / beta, 1.0, 1e-13);
          for (int d = 0; d < 3; d++) {
            const double f = row[ROW_SU + d] - row[ROW_SP] * row[ROW_V + d];
            const double buoyancy = -1000.0 * scene_row_volume(row) * fluid.gravity[d];
            assert_near(f, beta * slip[d] + buoyancy,
                        1e-13 * (beta * (1.0 + fabs(slip[d])) + fabs(buoyancy)));
          }
        }
        assert_int_equal(cpl_outside_range(s.cpl), outside);
        free(mean_d);
        free(cell);
        free(inverse);
        scene_free(&s);
      }
}

/* A uniform interstitial velocity is felt as such, whatever the void fraction around a particle. */
static void test_uniform_velocity(void **state) {
  (void)state;
  const cpl_params params = scene_params();
  const cpl_fluid fluid = scene_water();
  const double u[3] = {0.3, -0.1, 0.2};
  scene s;
  start(&s, &params, &fluid);
  for (int c = 0; c < s.mesh.view.cells; c++)
    for (int d = 0; d < 3; d++) {
      s.superficial[3 * c + d] = s.eps[c] * u[d];
      s.pressure_gradient[3 * c + d] = 0.0;
    }
  for (int i = 0; i < s.view.count; i++)
    memcpy(s.row + i * ROW_WIDTH + ROW_V, u, sizeof u);
  force(&s);
  for (int i = 0; i < s.view.count; i++) {
    const double *row = s.row + i * ROW_WIDTH;
    for (int d = 0; d < 3; d++) /* no slip: buoyancy alone; round-off of u times beta */
      assert_near(row[ROW_SU + d] - row[ROW_SP] * row[ROW_V + d],
                  -1000.0 * scene_row_volume(row) * fluid.gravity[d],
                  1e-13 * (row[ROW_SP] + 1e4 * scene_row_volume(row)));
  }
  scene_free(&s);
}

/* Terminal slip of one sphere settling alone, one-way: drag = weight less buoyancy. Reference:
 * closed form from Markauskas et al. 2017, eq. 19 and 27, by bisection in Python, 10 digits. */
static void test_terminal_slip(void **state) {
  (void)state;
  /* one cell whose void fraction is 0.935 with a sphere of 8 mm, solid density 1200 kg/m3 */
  const double d = 8e-3, volume = PI / 6.0 * d * d * d, edge = cbrt(volume / (1.0 - 0.935));
  const mesh_options options = {.kind = MESH_HEX, .n = {1, 1, 1}, .hi = {edge, edge, edge}};
  const cpl_fluid fluid = {1000.0, 1e-3, {0, 0, -9.81}};
  cpl_params params = scene_params();
  params.two_way = 0;
  scene s;
  scene_mesh(&s, MPI_COMM_SELF, &options, 0);
  assert_int_equal(scene_start(&s, &params, &fluid), PART_OK);
  const particle p = {{edge / 2, edge / 2, edge / 2}, d / 2, {0, 0, -0.18068693}, 1200.0, 0};
  scene_particles(&s, 1, &p, 0, 0);
  assert_int_equal(cpl_locate(s.cpl, &s.view), PART_OK);
  assert_int_equal(cpl_void_fraction(s.cpl, &s.view, &s.cells, NULL), PART_OK);
  assert_near(s.eps[0], 0.935, 1e-13);
  force(&s);
  const double f = s.row[ROW_SU + 2] - s.row[ROW_SP] * p.v[2];
  const double weight = 1200.0 * volume * 9.81;
  /* 8 digits of the slip, force about quadratic in it */
  assert_near((f - weight) / weight, 0.0, 1e-7);
  scene_free(&s);
}

/* A part of a body 1.5 times as wide has the share of its drag that it has of its volume: in
 * creeping flow, where drag goes with the diameter, 1/1.5^2 of its own; what goes with volume is
 * the same. */
static void test_part_of_body(void **state) {
  (void)state;
  cpl_params params = scene_params();
  const cpl_fluid fluid = scene_water();
  params.two_way = 0;
  assert_int_equal(part_params_set(&cpl_params_table, "drag", NULL, "stokes", &params), PART_OK);
  scene s;
  start(&s, &params, &fluid);
  for (int c = 0; c < 3 * s.mesh.view.cells; c++)
    s.superficial[c] = 0.01;
  force(&s);
  const int n = s.view.count;
  double alone[MANY], constant[MANY], wide[MANY];
  for (int i = 0; i < n; i++) {
    const double *row = s.row + i * ROW_WIDTH;
    alone[i] = row[ROW_SP];
    constant[i] = row[ROW_SU + 2] - row[ROW_SP] * 0.01 / cpl_sampled_eps(s.cpl)[i];
    wide[i] = 1.5 * row[ROW_R];
  }
  s.view.drag_radius = wide;
  s.view.drag_radius_stride = 1;
  force(&s);
  for (int i = 0; i < n; i++) {
    const double *row = s.row + i * ROW_WIDTH;
    const double rest = row[ROW_SU + 2] - row[ROW_SP] * 0.01 / cpl_sampled_eps(s.cpl)[i];
    assert_true(fabs(row[ROW_SP] - alone[i] / 2.25) <= 1e-14 * alone[i]);
    assert_true(fabs(rest - constant[i]) <= 1e-12 * fabs(constant[i]));
  }
  scene_free(&s);
}

/* ---- errors --------------------------------------------------------------------------------- */
static void test_not_finite(void **state) {
  (void)state;
  const cpl_params params = scene_params();
  const cpl_fluid fluid = scene_water();
  scene s;
  start(&s, &params, &fluid);
  scene_fluid(&s);
  double *const field[3] = {s.eps, s.superficial, s.pressure_gradient};
  const char *const name[3] = {"void fraction", "superficial velocity", "pressure gradient"};
  for (int f = 0; f < 3; f++) {
    /* the cells of rank 0 are all bad, so that some rank has a particle in one */
    const int n = (f == 0 ? 1 : 3) * s.mesh.view.cells;
    double *keep = mesh_alloc((size_t)n, sizeof *keep);
    memcpy(keep, field[f], (size_t)n * sizeof *keep);
    for (int k = 0; k < n && s.rank == 0; k++)
      field[f][k] = NAN;
    assert_int_equal(cpl_sample_fluid(s.cpl, &s.view, &s.cells), PART_OK);
    const int status = part_agree(s.comm, cpl_fluid_force(s.cpl, &s.view));
    assert_int_equal(status, PART_ERR_NUMERIC);
    assert_non_null(strstr(part_last_error(), name[f]));
    assert_non_null(strstr(part_last_error(), "particle"));
    memcpy(field[f], keep, (size_t)n * sizeof *keep);
    free(keep);
  }
  for (int c = 0; c < s.mesh.view.cells; c++)
    s.eps[c] = -0.1;
  assert_int_equal(cpl_sample_fluid(s.cpl, &s.view, &s.cells), PART_OK);
  assert_int_equal(part_agree(s.comm, cpl_fluid_force(s.cpl, &s.view)), PART_ERR_NUMERIC);
  scene_free(&s);
}

static void test_missing_fields_and_order(void **state) {
  (void)state;
  cpl_params params = scene_params();
  const cpl_fluid fluid = scene_water();
  params.viscous_stress = 1;
  scene s;
  start(&s, &params, &fluid);
  cpl_cells cells = s.cells;
  cells.pressure_gradient = NULL;
  assert_int_equal(cpl_sample_fluid(s.cpl, &s.view, &cells), PART_ERR_ARGUMENT);
  cells = s.cells;
  cells.stress_divergence = NULL;
  assert_int_equal(cpl_sample_fluid(s.cpl, &s.view, &cells), PART_ERR_ARGUMENT);
  cells = s.cells;
  cells.superficial = NULL;
  assert_int_equal(cpl_sample_fluid(s.cpl, &s.view, &cells), PART_ERR_ARGUMENT);
  assert_int_equal(cpl_fluid_force(s.cpl, &s.view), PART_ERR_STATE); /* nothing sampled yet */
  scene_free(&s);
}

int main(int argc, char **argv) {
  MPI_Init(&argc, &argv);
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_constant_parts),
      cmocka_unit_test(test_drag_of_sampled),
      cmocka_unit_test(test_uniform_velocity),
      cmocka_unit_test(test_terminal_slip),
      cmocka_unit_test(test_part_of_body),
      cmocka_unit_test(test_not_finite),
      cmocka_unit_test(test_missing_fields_and_order),
  };
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
