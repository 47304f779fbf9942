/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ranks: 1 2 3 4
 * Momentum source, reaction and budget: nothing is lost between fluid and particles, however stiff
 * the drag, whatever the order of the particles, on any number of ranks. */
#include <fenv.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "scene.h"

enum { MANY = 200 };
static void start_with(scene *s, const mesh_options *options, const cpl_params *given, int model,
                       particle *all) {
  cpl_params params = *given;
  const cpl_fluid fluid = scene_water();
  params.model = model;
  scene_random(options, MANY, 0.005, 0.05, 31, all);
  scene_mesh(s, MPI_COMM_WORLD, options, 1);
  assert_int_equal(scene_start(s, &params, &fluid), PART_OK);
  scene_particles(s, MANY, all, 0, 0);
}

static void start(scene *s, const mesh_options *options, int model, particle *all) {
  const cpl_params params = scene_params();
  start_with(s, options, &params, model, all);
}

/* Up to the force. */
static void couple(scene *s) {
  assert_int_equal(cpl_locate(s->cpl, &s->view), PART_OK);
  assert_int_equal(cpl_void_fraction(s->cpl, &s->view, &s->cells, NULL), PART_OK);
  scene_fluid(s);
  assert_int_equal(cpl_sample_fluid(s->cpl, &s->view, &s->cells), PART_OK);
  assert_int_equal(cpl_fluid_force(s->cpl, &s->view), PART_OK);
}

/* What a flow step would give up: drag of a new velocity, and pressure on the solid. */
static void react(const scene *s, double dt, double *drag, double *volume) {
  for (int c = 0; c < s->mesh.view.cells; c++)
    for (int d = 0; d < 3; d++) {
      const uint64_t key = (uint64_t)(3 * scene_global(s, c) + d);
      const double now = s->superficial[3 * c + d] + 0.1 * number_of(key);
      drag[3 * c + d] =
          (s->coefficient[c] * now - s->explicit_part[3 * c + d]) * s->mesh.volume[c] * dt;
      volume[3 * c + d] = (1.0 - s->eps[c]) * s->mesh.volume[c] * dt * 500.0 * number_of(key + 7);
      if (1.0 - s->eps[c] < 1e-12)
        drag[3 * c + d] = volume[3 * c + d] = 0.0;
    }
}

/* Fluid velocity unchanged: the drag D U - G, summed over cells, is what the particles received. */
static void test_source_is_the_impulse(void **state) {
  (void)state;
  particle all[MANY];
  for (int model = 0; model < 2; model++)
    for (int fixed = 0; fixed < 2; fixed++) {
      scene s;
      start(&s, &scene_meshes[0], model, all);
      for (int i = 0; i < MANY; i++)
        all[i].kind = fixed;
      scene_particles(&s, MANY, all, 0, 0);
      const double dt = 1e-3, u[3] = {0.1, -0.2, 0.3};
      couple(&s);
      for (int c = 0; c < s.mesh.view.cells; c++) /* uniform: U_i = U_c */
        memcpy(s.superficial + 3 * c, u, sizeof u);
      assert_int_equal(cpl_sample_fluid(s.cpl, &s.view, &s.cells), PART_OK);
      assert_int_equal(cpl_fluid_force(s.cpl, &s.view), PART_OK);
      scene_receive(&s, dt);
      assert_int_equal(cpl_momentum_source(s.cpl, &s.view, &s.cells, dt), PART_OK);
      double taken[3] = {0}, received[3] = {0}, size = 0.0;
      for (int c = 0; c < s.mesh.view.cells; c++)
        for (int d = 0; d < 3; d++)
          taken[d] += (s.coefficient[c] * u[d] - s.explicit_part[3 * c + d]) * s.mesh.volume[c];
      for (int i = 0; i < s.view.count; i++) {
        const double *row = s.row + i * ROW_WIDTH;
        for (int d = 0; d < 3; d++) {
          /* drag alone: what the pressure gradient and buoyancy gave goes back another way. Su
           * holds them: drag = impulse - (Su - beta u) dt */
          const double eps = cpl_sampled_eps(s.cpl)[i];
          const double constant = row[ROW_SU + d] - row[ROW_SP] * u[d] / eps;
          received[d] += row[ROW_J + d] / dt - constant;
          size += fabs(row[ROW_J + d] / dt) + fabs(constant) + row[ROW_SP];
        }
      }
      for (int d = 0; d < 3; d++)
        assert_near(sum_over(s.comm, taken[d]), sum_over(s.comm, received[d]),
                    1e-13 * sum_over(s.comm, size));
      scene_free(&s);
    }
}

/* b_i = m/eps (1 - exp(-beta dt/m))/dt from the explicit limit to the stiff one. */
static void test_stiff(void **state) {
  (void)state;
  const mesh_options one_cell = MESH_UNIT(MESH_HEX, 1, 1, 1);
  const cpl_params params = scene_params();
  const cpl_fluid fluid = scene_water();
  for (double stiff = 1e-6; stiff < 2e6; stiff *= 10.0) {
    scene s;
    scene_mesh(&s, MPI_COMM_SELF, &one_cell, 0);
    assert_int_equal(scene_start(&s, &params, &fluid), PART_OK);
    const particle p = {{0.5, 0.5, 0.5}, 1e-3, {0.3, 0, 0}, 2000.0, 0};
    scene_particles(&s, 1, &p, 0, 0);
    couple(&s);
    const double mass = 1.0 / s.row[ROW_IMASS], beta = s.row[ROW_SP], dt = stiff * mass / beta;
    const double eps = cpl_sampled_eps(s.cpl)[0];
    scene_receive(&s, dt);
    assert_int_equal(cpl_momentum_source(s.cpl, &s.view, &s.cells, dt), PART_OK);
    const double expected = stiff < 1e-3 ? beta * (1.0 - stiff / 2.0 + stiff * stiff / 6.0) / eps
                                         : mass * (1.0 - exp(-stiff)) / dt / eps;
    /* 1 - exp(-1e-3) loses 3 digits, the series at 1e-4 its third power */
    assert_near(s.coefficient[0] / expected, 1.0, 3e-12);
    /* the particle takes no more than its mass times the change of interstitial velocity */
    assert_true(s.coefficient[0] * dt * eps <= mass * (1.0 + 1e-15));
    scene_free(&s);
  }
}

/* Reactions to particles and back: closed to round-off, for any dt. */
static void budget_closes(int unresolved_drag) {
  cpl_params params = scene_params();
  params.unresolved_drag = unresolved_drag;
  particle all[MANY];
  for (int m = 0; m < 2; m++)
    for (int model = 0; model < 2; model++)
      for (double dt = 1e-7; dt < 1e3; dt *= 1e3) {
        scene s;
        start_with(&s, &scene_meshes[m], &params, model, all);
        couple(&s);
        scene_receive(&s, dt);
        assert_int_equal(cpl_momentum_source(s.cpl, &s.view, &s.cells, dt), PART_OK);
        const size_t cells = (size_t)s.mesh.view.cells;
        double *drag = mesh_alloc(3 * cells, sizeof *drag);
        double *volume = mesh_alloc(3 * cells, sizeof *volume);
        double *kick = mesh_alloc(3 * (size_t)s.view.count, sizeof *kick);
        react(&s, dt, drag, volume);
        assert_int_equal(cpl_reaction(s.cpl, &s.view, drag, volume, dt, kick), PART_OK);
        cpl_budget budget;
        assert_int_equal(cpl_get_budget(s.cpl, &budget), PART_OK);
        assert_true(budget.error < 1e-13);
        /* the same sums here, without the library's */
        for (int d = 0; d < 3; d++) {
          double fluid = 0, particles = 0, size = 0;
          for (size_t c = 0; c < cells; c++) {
            fluid += drag[3 * c + (size_t)d] + volume[3 * c + (size_t)d];
            size += fabs(drag[3 * c + (size_t)d]) + fabs(volume[3 * c + (size_t)d]);
          }
          for (int i = 0; i < s.view.count; i++) {
            const double *row = s.row + i * ROW_WIDTH;
            const double buoyancy = -1000.0 * scene_row_volume(row) * s.fluid.gravity[d] * dt;
            fluid += buoyancy;
            particles += row[ROW_J + d] + kick[3 * i + d];
            size += fabs(row[ROW_J + d]) + fabs(buoyancy);
          }
          fluid = sum_over(s.comm, fluid);
          particles = sum_over(s.comm, particles);
          size = sum_over(s.comm, size);
          assert_near(particles, fluid, 1e-13 * size);
          assert_near(budget.fluid[d], fluid, 1e-13 * size);
          assert_near(budget.particles[d], particles, 1e-13 * size);
        }
        /* without kicks: the same budget, by cells */
        cpl_budget cells_only;
        assert_int_equal(cpl_reaction(s.cpl, &s.view, drag, volume, dt, NULL), PART_OK);
        assert_int_equal(cpl_get_budget(s.cpl, &cells_only), PART_OK);
        assert_true(cells_only.error < 1e-13);
        for (int d = 0; d < 3; d++) {
          double size = 0;
          for (size_t c = 0; c < 3 * cells; c++)
            size += fabs(drag[c]) + fabs(volume[c]);
          size = sum_over(s.comm, size) + fabs(budget.fluid[d]);
          assert_near(cells_only.fluid[d], budget.fluid[d], 1e-13 * size);
          assert_near(cells_only.particles[d], budget.particles[d], 1e-13 * size);
        }
        free(drag);
        free(volume);
        free(kick);
        scene_free(&s);
      }
}

static void test_budget_closes(void **state) {
  (void)state;
  budget_closes(1);
  budget_closes(0);
}

/* Spheres over several cells each, in a flow that is not uniform and does not change: with
 * unresolvedDrag the drag of a cell is not what its particles got, and they are kicked; without, no
 * kick is left. */
static double largest_kick(int unresolved_drag, int model) {
  particle all[MANY];
  cpl_params params = scene_params();
  params.unresolved_drag = unresolved_drag;
  const double dt = 1e-3;
  scene s;
  start_with(&s, &scene_meshes[0], &params, model, all);
  couple(&s);
  scene_receive(&s, dt);
  assert_int_equal(cpl_momentum_source(s.cpl, &s.view, &s.cells, dt), PART_OK);
  const size_t cells = (size_t)s.mesh.view.cells;
  double *drag = mesh_alloc(3 * cells, sizeof *drag);
  double *volume = mesh_alloc(3 * cells, sizeof *volume);
  double *kick = mesh_alloc(3 * MANY, sizeof *kick);
  for (size_t k = 0; k < 3 * cells; k++) {
    const double v = s.mesh.volume[k / 3], solid = scene_solid(&s, (int)(k / 3));
    if (!(solid > 0.0))
      continue;
    drag[k] = (s.coefficient[k / 3] * s.superficial[k] - s.explicit_part[k]) * v * dt;
    volume[k] = model == CPL_MODEL_B ? 0.0 : -s.pressure_gradient[k] * solid * dt;
  }
  assert_int_equal(cpl_reaction(s.cpl, &s.view, drag, volume, dt, kick), PART_OK);
  double largest = 0.0;
  for (int i = 0; i < s.view.count; i++)
    for (int d = 0; d < 3; d++)
      largest =
          fmax(largest, fabs(kick[3 * i + d]) / (fabs(s.row[i * ROW_WIDTH + ROW_J + d]) + 1e-9));
  free(drag);
  free(volume);
  free(kick);
  const double all_ranks = max_over(s.comm, largest);
  scene_free(&s);
  return all_ranks;
}

static void test_unresolved_drag(void **state) {
  (void)state;
  assert_true(largest_kick(1, CPL_MODEL_A) > 1e-3);
  assert_true(largest_kick(0, CPL_MODEL_A) < 1e-10);
  assert_true(largest_kick(0, CPL_MODEL_B) < 1e-10);
}

/* Particles of one cell that move against each other and differ in size. */
static void company(scene *s, int model) {
  const mesh_options one_cell = MESH_UNIT(MESH_HEX, 1, 1, 1);
  const particle all[] = {
      {{0.5, 0.4, 0.6}, 0.1, {0.3, 0.1, -0.2}, 2000.0, 0},
      {{0.7, 0.4, 0.6}, 0.1, {-0.3, -0.1, 0.2}, 2000.0, 0},
      {{0.3, 0.7, 0.2}, 0.05, {0.0, -1.0, 0.0}, 8000.0, 0},
      {{0.3, 0.3, 0.2}, 0.08, {0.0, 0.0, 0.0}, 2000.0, 1},
  };
  cpl_params params = scene_params();
  const cpl_fluid fluid = scene_water();
  params.model = model;
  scene_mesh(s, MPI_COMM_SELF, &one_cell, 0);
  assert_int_equal(scene_start(s, &params, &fluid), PART_OK);
  scene_particles(s, 4, all, 0, 0);
  couple(s);
}

/* The flow took what the source told it of velocity U + change: each particle keeps its own drag
 * and gets b_i of the change, with or without others in its cell. */
static void test_kick_is_what_changed(void **state) {
  (void)state;
  const double dt = 1e-3, changes[] = {0.0, 0.4};
  for (int model = 0; model < 2; model++)
    for (int k = 0; k < 2; k++) {
      scene s;
      company(&s, model);
      scene_receive(&s, dt);
      assert_int_equal(cpl_momentum_source(s.cpl, &s.view, &s.cells, dt), PART_OK);
      const double eps = s.eps[0];
      double drag[3], volume[3], kick[12];
      for (int d = 0; d < 3; d++) {
        drag[d] = (s.coefficient[0] * (s.superficial[d] + changes[k]) - s.explicit_part[d]) * dt;
        volume[d] = 0.0;
        for (int i = 0; i < 4 && !model; i++)
          volume[d] -= scene_row_volume(s.row + i * ROW_WIDTH) * s.pressure_gradient[d] * dt;
      }
      assert_int_equal(cpl_reaction(s.cpl, &s.view, drag, volume, dt, kick), PART_OK);
      for (int i = 0; i < 4; i++) {
        const double *row = s.row + i * ROW_WIDTH;
        const double x = row[ROW_SP] * row[ROW_IMASS] * dt;
        const double b = row[ROW_SP] / eps * (i < 3 ? -expm1(-x) / x : 1.0);
        for (int d = 0; d < 3; d++)
          assert_near(kick[3 * i + d], b * changes[k] * dt,
                      1e-12 * (fabs(row[ROW_J + d]) + b * dt));
      }
      scene_free(&s);
    }
}

/* Without drag and pressure the particles give back all but buoyancy. */
static void test_nothing_given(void **state) {
  (void)state;
  const double dt = 1e-3;
  scene s;
  company(&s, 0);
  scene_receive(&s, dt);
  assert_int_equal(cpl_momentum_source(s.cpl, &s.view, &s.cells, dt), PART_OK);
  double kick[12];
  assert_int_equal(cpl_reaction(s.cpl, &s.view, NULL, NULL, dt, kick), PART_OK);
  for (int d = 0; d < 3; d++) {
    double sum = 0.0, size = 0.0;
    for (int i = 0; i < 4; i++) {
      const double *row = s.row + i * ROW_WIDTH;
      const double buoyancy = -1000.0 * scene_row_volume(row) * s.fluid.gravity[d] * dt;
      sum += kick[3 * i + d] - (buoyancy - row[ROW_J + d]);
      size += fabs(buoyancy) + fabs(row[ROW_J + d]);
    }
    assert_near(sum, 0.0, 1e-13 * size);
  }
  scene_free(&s);
}

/* Between force and source the particles are sorted and change ranks (as dem_advance may do): each
 * cell and each particle gets the same as without. relocate: cpl_locate again in the new order. */
static void new_order(int relocate, int shift, int reverse) {
  particle all[MANY];
  const double dt = 1e-2;
  scene s, plain;
  start(&s, &scene_meshes[0], 0, all);
  start(&plain, &scene_meshes[0], 0, all);
  couple(&s);
  couple(&plain);
  scene_receive(&plain, dt);
  scene_particles(&s, MANY, all, shift, reverse);
  for (int i = 0; i < s.view.count; i++) /* impulses by id: what each received */
    for (int d = 0; d < 3; d++)
      s.row[i * ROW_WIDTH + ROW_J + d] = 1e-3 * number_of((uint64_t)(3 * s.number[2 * i] + d));
  for (int i = 0; i < plain.view.count; i++)
    for (int d = 0; d < 3; d++)
      plain.row[i * ROW_WIDTH + ROW_J + d] =
          1e-3 * number_of((uint64_t)(3 * plain.number[2 * i] + d));
  if (relocate) {
    assert_int_equal(cpl_locate(s.cpl, &s.view), PART_OK);
    assert_int_equal(cpl_void_fraction(s.cpl, &s.view, &s.cells, NULL), PART_OK);
  }
  assert_int_equal(cpl_momentum_source(s.cpl, &s.view, &s.cells, dt), PART_OK);
  assert_int_equal(cpl_momentum_source(plain.cpl, &plain.view, &plain.cells, dt), PART_OK);
  const size_t cells = (size_t)s.mesh.view.cells;
  double *drag = mesh_alloc(3 * cells, sizeof *drag);
  double *volume = mesh_alloc(3 * cells, sizeof *volume);
  double *kick = mesh_alloc(3 * MANY, sizeof *kick);
  double *kick_plain = mesh_alloc(3 * MANY, sizeof *kick);
  for (size_t c = 0; c < cells; c++) {
    assert_near(s.coefficient[c], plain.coefficient[c], 1e-12 * plain.coefficient[c]);
    for (size_t d = 0; d < 3; d++)
      assert_near(s.explicit_part[3 * c + d], plain.explicit_part[3 * c + d],
                  1e-11 * (fabs(plain.explicit_part[3 * c + d]) + plain.coefficient[c] + 1e-3));
  }
  react(&plain, dt, drag, volume);
  assert_int_equal(cpl_reaction(s.cpl, &s.view, drag, volume, dt, kick), PART_OK);
  assert_int_equal(cpl_reaction(plain.cpl, &plain.view, drag, volume, dt, kick_plain), PART_OK);
  /* compare by id over all ranks */
  double *by_id = mesh_alloc(6 * MANY, sizeof *by_id);
  for (int i = 0; i < s.view.count; i++)
    memcpy(by_id + 6 * s.number[2 * i], kick + 3 * i, 3 * sizeof *kick);
  for (int i = 0; i < plain.view.count; i++)
    memcpy(by_id + 6 * plain.number[2 * i] + 3, kick_plain + 3 * i, 3 * sizeof *kick);
  MPI_Allreduce(MPI_IN_PLACE, by_id, 6 * MANY, MPI_DOUBLE, MPI_SUM, s.comm);
  for (int i = 0; i < MANY; i++)
    for (int d = 0; d < 3; d++)
      assert_near(by_id[6 * i + d], by_id[6 * i + 3 + d], 1e-12 * fabs(by_id[6 * i + d]) + 1e-14);
  cpl_budget budget;
  assert_int_equal(cpl_get_budget(s.cpl, &budget), PART_OK);
  assert_true(budget.error < 1e-13);
  free(by_id);
  free(kick);
  free(kick_plain);
  free(drag);
  free(volume);
  scene_free(&s);
  scene_free(&plain);
}

static void test_new_order(void **state) {
  (void)state;
  for (int relocate = 0; relocate < 2; relocate++)
    for (int shift = 0; shift < 3; shift++)
      for (int reverse = 0; reverse < 2; reverse++)
        new_order(relocate, shift, reverse);
}

/* A flow solver may stop at floating point exceptions: a whole step, also with everything at rest
 * and empty cells, raises none. */
static void test_no_trap(void **state) {
  (void)state;
  particle all[MANY];
  for (int k = 0; k < 4; k++) {
    const int rest = k & 1;
    scene s;
    start(&s, &scene_meshes[k >> 1], rest, all);
    for (int i = 0; rest && i < s.view.count; i++)
      memset(s.row + i * ROW_WIDTH + ROW_V, 0, 3 * sizeof(double));
    double kick[3 * MANY];
    feclearexcept(FE_ALL_EXCEPT);
    assert_int_equal(cpl_locate(s.cpl, &s.view), PART_OK);
    assert_int_equal(cpl_void_fraction(s.cpl, &s.view, &s.cells, NULL), PART_OK);
    assert_int_equal(cpl_sample_fluid(s.cpl, &s.view, &s.cells), PART_OK);
    assert_int_equal(cpl_fluid_force(s.cpl, &s.view), PART_OK);
    assert_int_equal(cpl_momentum_source(s.cpl, &s.view, &s.cells, 1e-3), PART_OK);
    assert_int_equal(cpl_reaction(s.cpl, &s.view, NULL, NULL, 1e-3, kick), PART_OK);
    assert_int_equal(fetestexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW), 0);
    scene_free(&s);
  }
}

static void test_one_way(void **state) {
  (void)state;
  particle all[MANY];
  cpl_params params = scene_params();
  const cpl_fluid fluid = scene_water();
  params.two_way = 0;
  scene s;
  scene_random(&scene_meshes[0], MANY, 0.005, 0.05, 31, all);
  scene_mesh(&s, MPI_COMM_WORLD, &scene_meshes[0], 1);
  assert_int_equal(scene_start(&s, &params, &fluid), PART_OK);
  scene_particles(&s, MANY, all, 0, 0);
  couple(&s);
  for (int c = 0; c < s.mesh.view.cells; c++)
    s.coefficient[c] = s.explicit_part[3 * c] = 1.0;
  assert_int_equal(cpl_momentum_source(s.cpl, &s.view, &s.cells, 1e-3), PART_OK);
  for (int c = 0; c < s.mesh.view.cells; c++)
    assert_true(s.coefficient[c] == 0.0 && s.explicit_part[3 * c] == 0.0);
  double kick[3 * MANY];
  assert_int_equal(cpl_reaction(s.cpl, &s.view, NULL, NULL, 1e-3, kick), PART_ERR_STATE);
  scene_free(&s);
}

static void test_errors(void **state) {
  (void)state;
  particle all[MANY];
  scene s;
  start(&s, &scene_meshes[0], 0, all);
  cpl_budget budget;
  assert_int_equal(cpl_get_budget(s.cpl, &budget), PART_ERR_STATE);
  assert_int_equal(cpl_momentum_source(s.cpl, &s.view, &s.cells, 1e-3), PART_ERR_STATE);
  couple(&s);
  scene_receive(&s, 1e-3);
  assert_int_equal(cpl_momentum_source(s.cpl, &s.view, &s.cells, 0.0), PART_ERR_RANGE);
  const size_t cells = (size_t)s.mesh.view.cells;
  double *drag = mesh_alloc(3 * cells, sizeof *drag);
  double kick[3 * MANY];
  assert_int_equal(cpl_reaction(s.cpl, &s.view, drag, NULL, 1e-3, kick), PART_ERR_STATE);
  assert_int_equal(cpl_momentum_source(s.cpl, &s.view, &s.cells, 1e-3), PART_OK);
  if (s.rank == s.size - 1)
    drag[0] = NAN;
  assert_int_equal(cpl_reaction(s.cpl, &s.view, drag, NULL, 1e-3, kick), PART_ERR_NUMERIC);
  drag[0] = 0.0;
  /* one particle alone: most cells are empty and must not react */
  particle p = {{0.1, 0.1, 0.1}, 0.01, {0, 0, 0}, 2000.0, 0};
  scene_particles(&s, 1, &p, 0, 0);
  couple(&s);
  scene_receive(&s, 1e-3);
  assert_int_equal(cpl_momentum_source(s.cpl, &s.view, &s.cells, 1e-3), PART_OK);
  for (size_t c = 0; c < cells; c++)
    drag[3 * c + 1] = s.eps[c] == 1.0 ? 1e-3 : 0.0;
  assert_int_equal(cpl_reaction(s.cpl, &s.view, drag, NULL, 1e-3, kick), PART_ERR_ARGUMENT);
  assert_non_null(strstr(part_last_error(), "without particles"));
  /* a particle that was not there when forces were computed */
  scene_particles(&s, 2, all, 0, 0);
  assert_int_equal(cpl_momentum_source(s.cpl, &s.view, &s.cells, 1e-3), PART_ERR_STATE);
  assert_non_null(strstr(part_last_error(), "since cpl_locate"));
  assert_int_equal(cpl_locate(s.cpl, &s.view), PART_OK);
  assert_int_equal(cpl_momentum_source(s.cpl, &s.view, &s.cells, 1e-3), PART_ERR_STATE);
  assert_non_null(strstr(part_last_error(), "since cpl_fluid_force"));
  free(drag);
  scene_free(&s);
}

int main(int argc, char **argv) {
  MPI_Init(&argc, &argv);
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_source_is_the_impulse),
      cmocka_unit_test(test_stiff),
      cmocka_unit_test(test_budget_closes),
      cmocka_unit_test(test_unresolved_drag),
      cmocka_unit_test(test_kick_is_what_changed),
      cmocka_unit_test(test_nothing_given),
      cmocka_unit_test(test_new_order),
      cmocka_unit_test(test_no_trap),
      cmocka_unit_test(test_one_way),
      cmocka_unit_test(test_errors),
  };
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
