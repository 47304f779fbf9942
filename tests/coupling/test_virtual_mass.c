/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ranks: 1 2 3 4
 * Virtual mass: the force by the fluid's acceleration, what the fluid gets back for that of the
 * particles (contacts and the last kick included), and the budget of the exchange. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "scene.h"

enum { MANY = 200 };
static const double COEFFICIENT = 0.5, RHO = 1000.0;
static const double GRAVITY[3] = {0.3, -0.2, -9.81}, NONE[3] = {0, 0, 0};

static double added_of(const double *row) {
  return COEFFICIENT * RHO * scene_row_volume(row);
}

typedef struct virtual_scene {
  scene s;
  double *before, *acceleration;
} virtual_scene;

/* before: at random by id, as contacts and kicks would leave it. */
static void start(virtual_scene *v, MPI_Comm comm, const mesh_options *mesh, int count,
                  const double g[3], const particle *all) {
  cpl_params params = scene_params();
  const cpl_fluid fluid = {RHO, 1e-3, {g[0], g[1], g[2]}};
  scene *s = &v->s;
  params.virtual_mass = 1;
  params.virtual_mass_coefficient = COEFFICIENT;
  scene_mesh(s, comm, mesh, 1);
  assert_int_equal(scene_start(s, &params, &fluid), PART_OK);
  scene_particles(s, count, all, 0, 0);
  v->before = mesh_alloc(3 * MANY, sizeof *v->before);
  v->acceleration = mesh_alloc(3 * (size_t)s->mesh.view.cells, sizeof *v->acceleration);
  for (int i = 0; i < s->view.count; i++) {
    double *row = s->row + i * ROW_WIDTH;
    for (int d = 0; d < 3; d++)
      v->before[3 * i + d] =
          row[ROW_V + d] -
          (s->number[2 * i + 1] == 1 ? 0.0 : number_of((uint64_t)(3 * s->number[2 * i] + d)));
    if (s->number[2 * i + 1] != 1)
      row[ROW_IMASS] = 1.0 / (1.0 / row[ROW_IMASS] + added_of(row));
  }
  s->view.velocity_before = v->before;
  s->view.velocity_before_stride = 3;
  for (int c = 0; c < s->mesh.view.cells; c++)
    for (int d = 0; d < 3; d++)
      v->acceleration[3 * c + d] = 5.0 * number_of((uint64_t)(3 * scene_global(s, c) + d) + 99);
  s->cells.acceleration = v->acceleration;
  assert_int_equal(cpl_locate(s->cpl, &s->view), PART_OK);
  assert_int_equal(cpl_void_fraction(s->cpl, &s->view, &s->cells, NULL), PART_OK);
  scene_fluid(s);
}

static void stop(virtual_scene *v) {
  free(v->before);
  free(v->acceleration);
  scene_free(&v->s);
}

/* Su grows by m_a Du/Dt, Sp does not change. */
static void test_force(void **state) {
  (void)state;
  particle all[MANY];
  virtual_scene v;
  scene_random(&scene_meshes[0], MANY, 0.005, 0.05, 31, all);
  start(&v, MPI_COMM_WORLD, &scene_meshes[0], MANY, GRAVITY, all);
  scene *s = &v.s;
  const double a[3] = {3.0, -4.0, 5.0};
  double *su = mesh_alloc(4 * MANY, sizeof *su);
  for (int with = 0; with < 2; with++) {
    for (int k = 0; k < 3 * s->mesh.view.cells; k++)
      v.acceleration[k] = with ? a[k % 3] : 0.0;
    assert_int_equal(cpl_sample_fluid(s->cpl, &s->view, &s->cells), PART_OK);
    assert_int_equal(cpl_fluid_force(s->cpl, &s->view), PART_OK);
    for (int i = 0; i < s->view.count; i++) {
      const double *row = s->row + i * ROW_WIDTH;
      for (int d = 0; with && d < 3; d++)
        assert_near(row[ROW_SU + d] - su[4 * i + d], added_of(row) * a[d],
                    1e-13 * (fabs(row[ROW_SU + d]) + added_of(row) * 5.0));
      if (with)
        assert_true(row[ROW_SP] == su[4 * i + 3]);
      memcpy(su + 4 * i, row + ROW_SU, 4 * sizeof *su);
    }
  }
  free(su);
  stop(&v);
}

/* What the particles really received, J - m_a dv and the kick, is what the fluid gave up. */
static void budget(const mesh_options *mesh, double dt) {
  particle all[MANY];
  virtual_scene v;
  scene_random(mesh, MANY, 0.005, 0.05, 31, all);
  for (int i = 0; i < MANY; i++)
    all[i].kind = i % 5 == 0;
  start(&v, MPI_COMM_WORLD, mesh, MANY, GRAVITY, all);
  scene *s = &v.s;
  assert_int_equal(cpl_sample_fluid(s->cpl, &s->view, &s->cells), PART_OK);
  assert_int_equal(cpl_fluid_force(s->cpl, &s->view), PART_OK);
  scene_receive(s, dt);
  assert_int_equal(cpl_momentum_source(s->cpl, &s->view, &s->cells, dt), PART_OK);
  const size_t cells = (size_t)s->mesh.view.cells;
  double *drag = mesh_alloc(3 * cells, sizeof *drag), *kick = mesh_alloc(3 * MANY, sizeof *kick);
  for (size_t c = 0; c < cells; c++)
    for (size_t d = 0; d < 3 && 1.0 - s->eps[c] > 1e-12; d++)
      drag[3 * c + d] =
          (s->coefficient[c] * (s->superficial[3 * c + d] + 0.1) - s->explicit_part[3 * c + d]) *
          s->mesh.volume[c] * dt;
  assert_int_equal(cpl_reaction(s->cpl, &s->view, drag, NULL, dt, kick), PART_OK);
  cpl_budget got;
  assert_int_equal(cpl_get_budget(s->cpl, &got), PART_OK);
  assert_true(got.error < 1e-13);
  for (int d = 0; d < 3; d++) {
    double fluid = 0, particles = 0, size = 0;
    for (size_t c = 0; c < cells; c++)
      fluid += drag[3 * c + (size_t)d];
    for (int i = 0; i < s->view.count; i++) {
      const double *row = s->row + i * ROW_WIDTH;
      const double dv = row[ROW_V + d] - v.before[3 * i + d];
      fluid -= added_of(row) / COEFFICIENT * s->fluid.gravity[d] * dt;
      particles += row[ROW_J + d] - added_of(row) * dv + kick[3 * i + d];
      size += fabs(row[ROW_J + d]) + fabs(added_of(row) * dv);
    }
    size = sum_over(s->comm, size);
    assert_near(sum_over(s->comm, particles), sum_over(s->comm, fluid), 1e-13 * size);
  }
  free(drag);
  free(kick);
  stop(&v);
}

static void test_budget(void **state) {
  (void)state;
  for (int m = 0; m < 2; m++)
    for (double dt = 1e-6; dt < 1e1; dt *= 1e3)
      budget(&scene_meshes[m], dt);
}

/* Two spheres of one cell, stopped by contacts in opposite directions: the fluid gets back what
 * each of them did, and neither is kicked for the other. Without particles in motion: -m_a dv/dt
 * whole. */
static void test_each_its_own(void **state) {
  (void)state;
  const mesh_options one_cell = MESH_UNIT(MESH_HEX, 1, 1, 1);
  const particle all[2] = {{{0.3, 0.4, 0.6}, 0.1, {0, 0, 0}, 2000.0, 0},
                           {{0.7, 0.4, 0.6}, 0.1, {0, 0, 0}, 2000.0, 0}};
  virtual_scene v;
  start(&v, MPI_COMM_SELF, &one_cell, 2, NONE, all);
  scene *s = &v.s;
  const double dt = 1e-3, dv[2] = {2.0, -1.0};
  memset(s->superficial, 0, 3 * sizeof(double));
  memset(s->pressure_gradient, 0, 3 * sizeof(double));
  memset(v.acceleration, 0, 3 * sizeof(double));
  for (int i = 0; i < 2; i++)
    for (int d = 0; d < 3; d++)
      v.before[3 * i + d] = d == 0 ? -dv[i] : 0.0;
  assert_int_equal(cpl_sample_fluid(s->cpl, &s->view, &s->cells), PART_OK);
  assert_int_equal(cpl_fluid_force(s->cpl, &s->view), PART_OK);
  scene_receive(s, dt);
  assert_int_equal(cpl_momentum_source(s->cpl, &s->view, &s->cells, dt), PART_OK);
  const double added = added_of(s->row);
  assert_near(s->explicit_part[0] * s->mesh.volume[0], added * (dv[0] + dv[1]) / dt,
              1e-12 * added / dt);
  double drag[3], kick[6];
  for (int d = 0; d < 3; d++)
    drag[d] = -s->explicit_part[d] * s->mesh.volume[0] * dt; /* U stayed 0: the source itself */
  assert_int_equal(cpl_reaction(s->cpl, &s->view, drag, NULL, dt, kick), PART_OK);
  for (int k = 0; k < 6; k++)
    assert_near(kick[k], 0.0, 1e-12 * added);
  stop(&v);
}

static void test_refuses(void **state) {
  (void)state;
  const mesh_options one_cell = MESH_UNIT(MESH_HEX, 1, 1, 1);
  const particle p = {{0.5, 0.5, 0.5}, 0.1, {0, 0, 0}, 2000.0, 0};
  cpl_params params = scene_params();
  const cpl_fluid fluid = scene_water();
  const double negative = -0.5;
  assert_int_equal(
      part_params_set(&cpl_params_table, "virtualMassCoefficient", &negative, NULL, &params),
      PART_ERR_RANGE);
  scene s;
  params.virtual_mass = 1;
  params.model = CPL_MODEL_B;
  scene_mesh(&s, MPI_COMM_SELF, &one_cell, 0);
  assert_int_equal(scene_start(&s, &params, &fluid), PART_ERR_ARGUMENT);
  assert_non_null(strstr(part_last_error(), "virtualMass"));
  params.model = CPL_MODEL_A;
  assert_int_equal(scene_start(&s, &params, &fluid), PART_OK);
  scene_particles(&s, 1, &p, 0, 0);
  assert_int_equal(cpl_locate(s.cpl, &s.view), PART_OK);
  assert_int_equal(cpl_void_fraction(s.cpl, &s.view, &s.cells, NULL), PART_OK);
  scene_fluid(&s);
  assert_int_equal(cpl_sample_fluid(s.cpl, &s.view, &s.cells), PART_ERR_ARGUMENT);
  assert_non_null(strstr(part_last_error(), "acceleration"));
  double a[3] = {0.0, NAN, 0.0};
  s.cells.acceleration = a;
  assert_int_equal(cpl_sample_fluid(s.cpl, &s.view, &s.cells), PART_OK);
  assert_int_equal(cpl_fluid_force(s.cpl, &s.view), PART_ERR_ARGUMENT);
  assert_non_null(strstr(part_last_error(), "velocity_before"));
  s.view.velocity_before = a;
  s.view.velocity_before_stride = 3;
  assert_int_equal(cpl_fluid_force(s.cpl, &s.view), PART_ERR_NUMERIC);
  scene_free(&s);
}

int main(int argc, char **argv) {
  MPI_Init(&argc, &argv);
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_force),
      cmocka_unit_test(test_budget),
      cmocka_unit_test(test_each_its_own),
      cmocka_unit_test(test_refuses),
  };
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
