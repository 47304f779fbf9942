/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cells with more solids than they have room for. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "scene.h"

enum { COUNT = 40 };

/* Spheres heaped around one point: nine tenths of them overlap, the cells there overflow. */
static void heap(particle *all) {
  for (int i = 0; i < COUNT; i++) {
    const uint64_t k = (uint64_t)(3 * i);
    all[i] = (particle){
        {0.45 + 0.1 * number_of(k), 0.55 + 0.1 * number_of(k + 1), 0.4 + 0.1 * number_of(k + 2)},
        0.05,
        {0, 0, 0},
        1000.0,
        0};
  }
}

static void start(scene *s, const mesh_options *options, int overfull, int smoothing) {
  const cpl_fluid fluid = scene_water();
  cpl_params params = scene_params();
  params.minimum_eps = 0.3;
  params.overfull = overfull;
  params.smoothing = smoothing;
  params.bandwidth = 1.0;
  params.bandwidth_cells = 0.5;
  scene_mesh(s, MPI_COMM_SELF, options, 0);
  assert_int_equal(scene_start(s, &params, &fluid), PART_OK);
}

/* All cells keep room, volume and sign are kept, deposit and sample stay adjoint, and the report
 * says how much was moved. */
static void test_spread(void **state) {
  (void)state;
  const mesh_kind kinds[] = {MESH_HEX, MESH_TET, MESH_POLY};
  particle all[COUNT];
  heap(all);
  for (int k = 0; k < 6; k++) {
    mesh_options options = MESH_UNIT(kinds[k / 2], 8, 8, 8);
    options.warp = 0.15;
    options.seed = 2;
    scene s;
    start(&s, &options, CPL_OVERFULL_SPREAD, k % 2);
    assert_near(scene_fill(&s, COUNT, all), 0.0, 1e-13);
    long long full;
    double moved, low = 1.0, high = 0.0, volume = 0.0;
    cpl_overfull_of(s.cpl, &full, &moved);
    const int cells = s.mesh.view.cells;
    for (int c = 0; c < cells; c++) {
      low = fmin(low, s.eps[c]);
      high = fmax(high, s.eps[c]);
      volume += (1.0 - s.eps[c]) * s.mesh.view.volume[c];
    }
    assert_true(low >= 0.3 - 1e-12 && high <= 1.0 + 1e-14);
    assert_true(full > 0 && moved > 0.0 && moved < volume);
    assert_near(volume, COUNT * scene_volume(all), 1e-13 * volume);
    double *q = mesh_alloc((size_t)cells, sizeof *q), *to = mesh_alloc((size_t)cells, sizeof *to);
    double value[COUNT], sampled[COUNT], by_cells = 0.0, by_particles = 0.0;
    for (int c = 0; c < cells; c++)
      q[c] = number_of((uint64_t)c);
    for (int i = 0; i < COUNT; i++)
      value[i] = number_of((uint64_t)(1000 + i));
    assert_int_equal(cpl_deposit(s.cpl, 1, value, to), PART_OK);
    assert_int_equal(cpl_sample(s.cpl, 1, q, sampled), PART_OK);
    for (int c = 0; c < cells; c++) {
      by_cells += to[c] * q[c];
      q[c] = 1.0;
    }
    for (int i = 0; i < COUNT; i++)
      by_particles += value[i] * sampled[i];
    assert_near(by_cells, by_particles, 1e-13 * COUNT);
    assert_int_equal(cpl_sample(s.cpl, 1, q, sampled), PART_OK);
    for (int i = 0; i < COUNT; i++)
      assert_near(sampled[i], 1.0, 1e-13);
    free(q);
    free(to);
    /* and one sphere alone needs none of it */
    scene_fill(&s, 1, all);
    cpl_overfull_of(s.cpl, &full, &moved);
    assert_int_equal(full, 0);
    scene_free(&s);
  }
}

static void test_error(void **state) {
  (void)state;
  particle all[COUNT];
  heap(all);
  const mesh_options options = MESH_UNIT(MESH_HEX, 8, 8, 8);
  scene s;
  start(&s, &options, CPL_OVERFULL_ERROR, 0);
  scene_particles(&s, COUNT, all, 0, 0);
  assert_int_equal(cpl_locate(s.cpl, &s.view), PART_OK);
  assert_int_equal(cpl_void_fraction(s.cpl, &s.view, &s.cells, NULL), PART_ERR_RANGE);
  assert_non_null(strstr(part_last_error(), "minimumEps"));
  scene_free(&s);
  /* no room anywhere */
  const mesh_options small = {.kind = MESH_HEX, .n = {3, 3, 3}, .hi = {0.25, 0.25, 0.25}};
  start(&s, &small, CPL_OVERFULL_SPREAD, 0);
  for (int i = 0; i < COUNT; i++)
    for (int d = 0; d < 3; d++)
      all[i].x[d] *= 0.25;
  scene_particles(&s, COUNT, all, 0, 0);
  assert_int_equal(cpl_locate(s.cpl, &s.view), PART_OK);
  assert_int_equal(cpl_void_fraction(s.cpl, &s.view, &s.cells, NULL), PART_ERR_RANGE);
  assert_non_null(strstr(part_last_error(), "no room"));
  scene_free(&s);
}

int main(int argc, char **argv) {
  MPI_Init(&argc, &argv);
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_spread), cmocka_unit_test(test_error)};
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
