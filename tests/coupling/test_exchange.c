/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ranks: 1 2 3 4
 * Weights between particles and cells that are on different ranks: the sums that must hold whatever
 * the mesh, and the same numbers as on one rank. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "scene.h"

enum { MANY = 300 };

/* Meshes and methods that every law below is tried on. */
static const struct {
  const char *name;
  mesh_options options;
  int method, random_cells;
} variant[] = {
    {"hex, exact",
     {.kind = MESH_HEX, .n = {6, 5, 4}, .hi = {1.2, 1, 0.8}},
     CPL_VOID_FRACTION_exact,
     0},
    {"hex, exact, cells at random",
     {.kind = MESH_HEX, .n = {6, 5, 4}, .hi = {1.2, 1, 0.8}},
     CPL_VOID_FRACTION_exact,
     1},
    {"periodic",
     {.kind = MESH_HEX, .n = {5, 4, 4}, .hi = {1, 1, 1}, .periodic = {1, 1, 1}},
     CPL_VOID_FRACTION_exact,
     0},
    {"periodic in y, warped, cells at random",
     {.kind = MESH_HEX,
      .n = {4, 4, 4},
      .hi = {1, 1, 1},
      .periodic = {0, 1, 0},
      .warp = 0.2,
      .seed = 3},
     CPL_VOID_FRACTION_exact,
     1},
    {"tetrahedra", {.kind = MESH_TET, .n = {3, 3, 3}, .hi = {1, 1, 1}}, CPL_VOID_FRACTION_exact, 0},
    {"polyhedra, warped",
     {.kind = MESH_POLY, .n = {3, 3, 3}, .hi = {1, 1, 1}, .warp = 0.2, .seed = 4},
     CPL_VOID_FRACTION_exact,
     1},
    {"centre",
     {.kind = MESH_HEX, .n = {6, 5, 4}, .hi = {1.2, 1, 0.8}},
     CPL_VOID_FRACTION_centre,
     1},
    {"centre, periodic",
     {.kind = MESH_HEX, .n = {5, 4, 4}, .hi = {1, 1, 1}, .periodic = {1, 0, 1}},
     CPL_VOID_FRACTION_centre,
     1},
    {"subCell",
     {.kind = MESH_HEX, .n = {5, 4, 4}, .hi = {1, 1, 1}, .periodic = {1, 0, 1}},
     CPL_VOID_FRACTION_subCell,
     0},
    {"kernel, periodic",
     {.kind = MESH_HEX, .n = {5, 4, 4}, .hi = {1, 1, 1}, .periodic = {1, 0, 1}},
     CPL_VOID_FRACTION_kernel,
     1},
    {"kernel, tetrahedra",
     {.kind = MESH_TET, .n = {3, 3, 3}, .hi = {1, 1, 1}},
     CPL_VOID_FRACTION_kernel,
     1},
};
enum { VARIANTS = sizeof variant / sizeof *variant };

/* Spheres of 0.01 to r_max m at random, located. */
static void start(scene *s, int v, MPI_Comm comm, double r_max, uint64_t seed) {
  particle all[MANY];
  cpl_params params = scene_params();
  const cpl_fluid fluid = scene_water();
  params.void_fraction = variant[v].method;
  params.sub_cells = 10;
  params.bandwidth = 0.7; /* of kernel: it spans less than the period */
  scene_random(&variant[v].options, MANY, 0.01, r_max, seed, all);
  scene_mesh(s, comm, &variant[v].options, variant[v].random_cells);
  if (scene_start(s, &params, &fluid) != PART_OK)
    fail_msg("%s: %s", variant[v].name, part_last_error());
  scene_particles(s, MANY, all, 1, 0);
  if (cpl_locate(s->cpl, &s->view) != PART_OK)
    fail_msg("%s: %s", variant[v].name, part_last_error());
}

/* Deposited sums: each particle's value arrives once, whatever part of it is in a wall. */
static void test_deposit_conserves(void **state) {
  (void)state;
  for (int v = 0; v < VARIANTS; v++) {
    scene s;
    start(&s, v, MPI_COMM_WORLD, 0.15, 11);
    double *value = mesh_alloc((size_t)s.view.count * 2, sizeof *value);
    double *cell = mesh_alloc((size_t)s.mesh.view.cells * 2, sizeof *cell);
    double sent[2] = {0, 0}, arrived[2] = {0, 0}, size[2] = {0, 0};
    for (int i = 0; i < s.view.count; i++)
      for (int d = 0; d < 2; d++) {
        value[2 * i + d] = number_of((uint64_t)(2 * s.number[2 * i] + d));
        sent[d] += value[2 * i + d];
        size[d] += fabs(value[2 * i + d]);
      }
    assert_int_equal(cpl_deposit(s.cpl, 2, value, cell), PART_OK);
    for (int c = 0; c < s.mesh.view.cells; c++)
      for (int d = 0; d < 2; d++)
        arrived[d] += cell[2 * c + d];
    for (int d = 0; d < 2; d++)
      assert_near(sum_over(s.comm, arrived[d]), sum_over(s.comm, sent[d]),
                  1e-13 * sum_over(s.comm, size[d]));
    free(value);
    free(cell);
    scene_free(&s);
  }
}

/* sum_c w_ic = 1: a constant is sampled as itself. */
static void test_sample_of_constant(void **state) {
  (void)state;
  for (int v = 0; v < VARIANTS; v++) {
    scene s;
    start(&s, v, MPI_COMM_WORLD, 0.15, 12);
    double *value = mesh_alloc((size_t)s.view.count * 3, sizeof *value);
    double *cell = mesh_alloc((size_t)s.mesh.view.cells * 3, sizeof *cell);
    for (int c = 0; c < 3 * s.mesh.view.cells; c++)
      cell[c] = c % 3 == 0 ? 1.0 : c % 3 == 1 ? -2.5 : 0.0;
    assert_int_equal(cpl_sample(s.cpl, 3, cell, value), PART_OK);
    for (int i = 0; i < s.view.count; i++) {
      assert_near(value[3 * i], 1.0, 1e-13);
      assert_near(value[3 * i + 1], -2.5, 3e-13);
      assert_true(value[3 * i + 2] == 0.0);
    }
    free(value);
    free(cell);
    scene_free(&s);
  }
}

/* <q, deposit(Q)> = <sample(q), Q> */
static void test_adjoint(void **state) {
  (void)state;
  for (int v = 0; v < VARIANTS; v++) {
    scene s;
    start(&s, v, MPI_COMM_WORLD, 0.15, 13);
    const int count = s.view.count, cells = s.mesh.view.cells;
    double *big = mesh_alloc((size_t)count, sizeof *big);
    double *sampled = mesh_alloc((size_t)count, sizeof *big);
    double *small = mesh_alloc((size_t)cells, sizeof *big);
    double *deposited = mesh_alloc((size_t)cells, sizeof *big);
    for (int i = 0; i < count; i++)
      big[i] = number_of((uint64_t)s.number[2 * i]);
    for (int c = 0; c < cells; c++)
      small[c] = number_of(1000000u + (uint64_t)scene_global(&s, c));
    assert_int_equal(cpl_deposit(s.cpl, 1, big, deposited), PART_OK);
    assert_int_equal(cpl_sample(s.cpl, 1, small, sampled), PART_OK);
    double left = 0, right = 0, size = 0;
    for (int c = 0; c < cells; c++)
      left += small[c] * deposited[c];
    for (int i = 0; i < count; i++) {
      right += sampled[i] * big[i];
      size += fabs(sampled[i] * big[i]);
    }
    assert_true(sum_over(s.comm, size) > 1.0); /* not 0 = 0 */
    assert_near(sum_over(s.comm, left), sum_over(s.comm, right), 1e-13 * sum_over(s.comm, size));
    free(big);
    free(sampled);
    free(small);
    free(deposited);
    scene_free(&s);
  }
}

/* Every cell and every particle gets what it gets on one rank. */
static void test_same_as_serial(void **state) {
  (void)state;
  for (int v = 0; v < VARIANTS; v++) {
    scene s, one;
    start(&s, v, MPI_COMM_WORLD, 0.06, 14);
    start(&one, v, MPI_COMM_SELF, 0.06, 14);
    double error, largest_eps = 0.0, largest_v = 0.0;
    assert_int_equal(cpl_void_fraction(s.cpl, &s.view, &s.cells, &error), PART_OK);
    assert_true(error < 1e-13);
    assert_int_equal(cpl_void_fraction(one.cpl, &one.view, &one.cells, &error), PART_OK);
    assert_true(error < 1e-13);
    for (int c = 0; c < s.mesh.view.cells; c++) {
      const int g = scene_global(&s, c);
      largest_eps = fmax(largest_eps, fabs(s.eps[c] - one.eps[g]));
      for (int d = 0; d < 3; d++)
        largest_v =
            fmax(largest_v, fabs(s.solid_velocity[3 * c + d] - one.solid_velocity[3 * g + d]));
    }
    /* a thin slice of a sphere in a cell weighs little, so its round-off is larger there */
    if (largest_eps > 1e-12 || largest_v > 1e-10)
      fail_msg("%s: eps %g velocity %g", variant[v].name, largest_eps, largest_v);
    scene_fluid(&s);
    scene_fluid(&one);
    assert_int_equal(cpl_sample_fluid(s.cpl, &s.view, &s.cells), PART_OK);
    assert_int_equal(cpl_sample_fluid(one.cpl, &one.view, &one.cells), PART_OK);
    for (int i = 0; i < s.view.count; i++) {
      const int g = (int)s.number[2 * i];
      assert_near(cpl_sampled_eps(s.cpl)[i], cpl_sampled_eps(one.cpl)[g], 1e-12);
      for (int d = 0; d < 3; d++)
        assert_near(cpl_sampled_superficial(s.cpl)[3 * i + d],
                    cpl_sampled_superficial(one.cpl)[3 * g + d], 1e-12);
    }
    scene_free(&s);
    scene_free(&one);
  }
}

int main(int argc, char **argv) {
  MPI_Init(&argc, &argv);
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_deposit_conserves),
      cmocka_unit_test(test_sample_of_constant),
      cmocka_unit_test(test_adjoint),
      cmocka_unit_test(test_same_as_serial),
  };
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
