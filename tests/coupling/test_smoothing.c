/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The smooth kernel: what it must keep to round-off, and its width. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../../libcoupling/src/smoothing.h"
#include "cyclic_mesh.h"
#include "scene.h"

/* ---- on any mesh ----------------------------------------------------------------------------- */
static double inner(const cpl_mesh *m, const double *a, const double *b) {
  double sum = 0.0;
  for (int c = 0; c < m->cells; c++)
    sum += m->volume[c] * a[c] * b[c];
  return sum;
}

static double *random_field(int cells, uint64_t seed) {
  double *q = mesh_alloc((size_t)cells, sizeof *q);
  for (int c = 0; c < cells; c++)
    q[c] = mesh_random(&seed);
  return q;
}

static double *smoothed(cpl_smoother *s, const double *q, int cells) {
  double *r = mesh_alloc((size_t)cells, sizeof *r);
  memcpy(r, q, (size_t)cells * sizeof *r);
  assert_int_equal(cpl_smoother_apply(s, 1, r), PART_OK);
  return r;
}

/* 1, the sum, symmetry and sign, all to round-off of the passes. */
static void check_kept(const cpl_mesh *m, double variance, double cells) {
  cpl_smoother *s;
  assert_int_equal(cpl_smoother_create(MPI_COMM_SELF, m, variance, cells, &s), PART_OK);
  assert_true(cpl_smoother_passes(s) > 3);
  double *a = random_field(m->cells, 1), *b = random_field(m->cells, 2);
  double *sa = smoothed(s, a, m->cells), *sb = smoothed(s, b, m->cells);
  double *one = mesh_alloc((size_t)m->cells, sizeof *one), low = 1.0, high = 0.0;
  for (int c = 0; c < m->cells; c++)
    one[c] = 1.0;
  double *sone = smoothed(s, one, m->cells);
  for (int c = 0; c < m->cells; c++) {
    assert_near(sone[c], 1.0, 1e-14);
    low = fmin(low, sa[c]);
    high = fmax(high, sa[c]);
  }
  assert_true(low > 0.0 && high < 1.0);
  const double size = inner(m, a, one);
  assert_near(inner(m, sa, one), size, 1e-13 * size);
  assert_near(inner(m, sa, b), inner(m, a, sb), 1e-13 * size);
  free(a);
  free(b);
  free(sa);
  free(sb);
  free(one);
  free(sone);
  cpl_smoother_destroy(s);
}

static void test_kept(void **state) {
  (void)state;
  const mesh_kind kinds[] = {MESH_HEX, MESH_PRISM, MESH_TET, MESH_POLY, MESH_AGGLOMERATE};
  for (int k = 0; k < 5; k++) {
    mesh_options options = MESH_UNIT(kinds[k], 8, 8, 8);
    options.warp = 0.2;
    options.shear = 0.3;
    options.seed = 3;
    made_mesh mesh;
    mesh_make(&options, &mesh);
    check_kept(&mesh.view, 0.04, 0.0);
    check_kept(&mesh.view, 0.0, 2.0); /* as wide as the cells ask for */
    mesh_free(&mesh);
  }
  cyclic_mesh c;
  cyclic_make(&c, 6);
  check_kept(&c.mesh.view, 0.04, 0.0);
  cyclic_free(&c);
}

/* ---- width ----------------------------------------------------------------------------------- */
/* Mean over all cells of the second moment per axis of what a unit in one cell becomes, the volume
 * as weight, with the way to a cell the shortest on the periodic block (period 0: none). */
static double mean_variance(cpl_smoother *s, const cpl_mesh *m, double period) {
  /* sum_c V_c (S |x - x_c|^2)_c/3 = sum_c V_c (S x^2 - 2 x.S x + x^2)/3 by the symmetry of S; with
   * a period from one cell, as all are alike */
  double sum = 0.0, volume = 0.0;
  if (period > 0.0) {
    double *q = mesh_alloc((size_t)m->cells, sizeof *q);
    q[0] = 1.0 / m->volume[0];
    double *r = smoothed(s, q, m->cells);
    for (int c = 0; c < m->cells; c++)
      for (int d = 0; d < 3; d++) {
        const double y =
            remainder(m->cell_centre[3 * (size_t)c + (size_t)d] - m->cell_centre[d], period);
        sum += m->volume[c] * r[c] * y * y / 3.0;
      }
    free(q);
    free(r);
    return sum;
  }
  double *row = mesh_alloc(4 * (size_t)m->cells, sizeof *row);
  for (int c = 0; c < m->cells; c++) {
    const double *x = m->cell_centre + 3 * (size_t)c;
    memcpy(row + 4 * (size_t)c, x, 3 * sizeof *x);
    row[4 * (size_t)c + 3] = x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
  }
  assert_int_equal(cpl_smoother_apply(s, 4, row), PART_OK);
  for (int c = 0; c < m->cells; c++) {
    const double *x = m->cell_centre + 3 * (size_t)c, *q = row + 4 * (size_t)c;
    int inside = 1; /* several widths from the borders */
    for (int d = 0; d < 3; d++)
      inside = inside && fabs(x[d] - 0.5) < 0.1;
    if (!inside)
      continue;
    const double square = x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
    sum += m->volume[c] * (q[3] - 2.0 * (x[0] * q[0] + x[1] * q[1] + x[2] * q[2]) + square) / 3.0;
    volume += m->volume[c];
  }
  free(row);
  return sum / volume;
}

static void test_width(void **state) {
  (void)state;
  cyclic_mesh c;
  cyclic_make(&c, 16);
  cpl_smoother *s;
  const double variance = 0.07 * 0.07; /* 7 sigma to half the period: nothing wraps around */
  assert_int_equal(cpl_smoother_create(MPI_COMM_SELF, &c.mesh.view, variance, 0.0, &s), PART_OK);
  assert_near(mean_variance(s, &c.mesh.view, 1.0), variance, 1e-9 * variance);
  cpl_smoother_destroy(s);
  cyclic_free(&c);
  /* Where the ways from a cell to its neighbours do not cancel, successive passes are correlated,
   * and the width is right to some percent only */
  const mesh_kind kinds[] = {MESH_HEX, MESH_PRISM, MESH_TET, MESH_POLY};
  const double near[] = {1e-9, 0.05, 0.12, 0.12};
  for (int k = 0; k < 4; k++) {
    mesh_options options = MESH_UNIT(kinds[k], 16, 16, 16);
    made_mesh mesh;
    mesh_make(&options, &mesh);
    assert_int_equal(cpl_smoother_create(MPI_COMM_SELF, &mesh.view, 0.06 * 0.06, 0.0, &s), PART_OK);
    const double found = mean_variance(s, &mesh.view, 0.0);
    print_message("# mesh kind %d: variance %g of the one asked for\n", kinds[k], found / 0.0036);
    assert_near(found, 0.0036, near[k] * 0.0036);
    cpl_smoother_destroy(s);
    mesh_free(&mesh);
  }
}

static void test_too_wide(void **state) {
  (void)state;
  mesh_options options = MESH_UNIT(MESH_HEX, 4, 4, 4);
  options.grade[0] = 1e6;
  made_mesh mesh;
  mesh_make(&options, &mesh);
  cpl_smoother *s = NULL;
  assert_int_equal(cpl_smoother_create(MPI_COMM_SELF, &mesh.view, 1.0, 0.0, &s), PART_ERR_RANGE);
  assert_non_null(strstr(part_last_error(), "bandwidth"));
  assert_null(s);
  mesh_free(&mesh);
}

/* ---- the exchange through it ------------------------------------------------------------------
 */
/* Deposit and sample stay adjoint, volume is conserved, 1 is sampled as 1. */
static void test_exchange(void **state) {
  (void)state;
  mesh_options options = MESH_UNIT(MESH_HEX, 8, 8, 8);
  enum { COUNT = 60 };
  particle all[COUNT];
  scene_random(&options, COUNT, 0.03, 0.06, 8, all);
  scene s;
  scene_mesh(&s, MPI_COMM_SELF, &options, 0);
  cpl_params params = scene_params();
  params.smoothing = 1;
  params.bandwidth = 3.0;
  const cpl_fluid fluid = scene_water();
  assert_int_equal(scene_start(&s, &params, &fluid), PART_OK);
  assert_near(scene_fill(&s, COUNT, all), 0.0, 1e-13);
  const int cells = s.mesh.view.cells;
  double *q = random_field(cells, 5), *deposit = mesh_alloc((size_t)cells, sizeof *deposit);
  double value[COUNT], sampled[COUNT], by_cells = 0.0, by_particles = 0.0;
  for (int i = 0; i < COUNT; i++)
    value[i] = number_of((uint64_t)i);
  assert_int_equal(cpl_deposit(s.cpl, 1, value, deposit), PART_OK);
  assert_int_equal(cpl_sample(s.cpl, 1, q, sampled), PART_OK);
  for (int c = 0; c < cells; c++) {
    by_cells += deposit[c] * q[c];
    q[c] = 1.0;
  }
  for (int i = 0; i < COUNT; i++)
    by_particles += value[i] * sampled[i];
  assert_near(by_cells, by_particles, 1e-13 * COUNT);
  assert_int_equal(cpl_sample(s.cpl, 1, q, sampled), PART_OK);
  for (int i = 0; i < COUNT; i++)
    assert_near(sampled[i], 1.0, 1e-13);
  free(q);
  free(deposit);
  scene_free(&s);
}

/* The void fraction of one sphere does not depend on the mesh once cells are below its kernel. */
static void test_mesh_independence(void **state) {
  (void)state;
  const particle one = {{0.47, 0.52, 0.49}, 0.05, {0, 0, 0}, 1000.0, 0};
  double largest[3];
  for (int k = 0; k < 3; k++) {
    const int n = 8 << k;
    mesh_options options = MESH_UNIT(MESH_HEX, n, n, n);
    scene s;
    scene_mesh(&s, MPI_COMM_SELF, &options, 0);
    cpl_params params = scene_params();
    params.smoothing = 1;
    params.bandwidth = 3.0; /* 0.3: sigma 0.21 */
    const cpl_fluid fluid = scene_water();
    assert_int_equal(scene_start(&s, &params, &fluid), PART_OK);
    scene_fill(&s, 1, &one);
    largest[k] = 0.0;
    for (int c = 0; c < s.mesh.view.cells; c++)
      largest[k] = fmax(largest[k], 1.0 - s.eps[c]);
    scene_free(&s);
  }
  /* Dividing the sphere among cells adds up to h^2/4 to sigma^2 per axis, so the peak, which goes
   * as sigma^-3, is lower by up to 3/2 of that part: 13 % and 3.3 % */
  assert_near(largest[0], largest[2], 0.13 * largest[2]);
  assert_near(largest[1], largest[2], 0.033 * largest[2]);
}

/* voidFraction kernel: K(xi) of Gao and Sun at the centres of the cells, normalised. */
static void test_kernel_method(void **state) {
  (void)state;
  mesh_options options = MESH_UNIT(MESH_HEX, 8, 8, 8);
  const particle one = {{0.47, 0.52, 0.49}, 0.05, {0, 0, 0}, 1000.0, 0};
  scene s;
  scene_mesh(&s, MPI_COMM_SELF, &options, 0);
  cpl_params params = scene_params();
  params.void_fraction = CPL_VOID_FRACTION_kernel;
  params.bandwidth = 1.35; /* w = 1.35/0.45 diameters = 0.3 */
  const cpl_fluid fluid = scene_water();
  assert_int_equal(scene_start(&s, &params, &fluid), PART_OK);
  assert_near(scene_fill(&s, 1, &one), 0.0, 1e-14);
  double sum = 0.0, k[512];
  for (int c = 0; c < 512; c++) {
    const double *x = s.mesh.view.cell_centre + 3 * (size_t)c;
    double xi2 = 0.0;
    for (int d = 0; d < 3; d++)
      xi2 += (x[d] - one.x[d]) * (x[d] - one.x[d]) / 0.09;
    k[c] = xi2 < 1.0 ? pow(1.0 - xi2, 4.0) : 0.0;
    sum += k[c];
  }
  for (int c = 0; c < 512; c++)
    assert_near(scene_solid(&s, c), scene_volume(&one) * k[c] / sum, 1e-15);
  scene_free(&s);
}

static void expect(cpl_params *params, const char *word) {
  mesh_options options = MESH_UNIT(MESH_HEX, 2, 2, 2);
  scene s;
  scene_mesh(&s, MPI_COMM_SELF, &options, 0);
  const cpl_fluid fluid = scene_water();
  assert_int_equal(scene_start(&s, params, &fluid), PART_ERR_ARGUMENT);
  assert_non_null(strstr(part_last_error(), word));
  scene_free(&s);
}

static void test_needs(void **state) {
  (void)state;
  cpl_params params = scene_params();
  params.self_disturbance = 1;
  expect(&params, "smoothing is off");
  params.smoothing = 1;
  params.two_way = 0;
  expect(&params, "twoWay is off");
}

int main(int argc, char **argv) {
  MPI_Init(&argc, &argv);
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_kept),
      cmocka_unit_test(test_width),
      cmocka_unit_test(test_too_wide),
      cmocka_unit_test(test_exchange),
      cmocka_unit_test(test_needs),
      cmocka_unit_test(test_kernel_method),
      cmocka_unit_test(test_mesh_independence),
  };
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
