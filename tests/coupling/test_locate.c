/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ranks: 1 2 3 4
 * Particles that can not be located, that have not moved, that are not there. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "scene.h"

static void one_bad(scene *s, const particle *bad, int status, const char *word, const char *id) {
  particle all[4];
  for (int i = 0; i < 4; i++)
    all[i] = (particle){{0.2 + 0.2 * i, 0.5, 0.5}, 0.05, {0, 0, 0}, 1000.0, 0};
  all[2] = *bad;
  scene_particles(s, 4, all, 0, 0);
  assert_int_equal(cpl_locate(s->cpl, &s->view), status);
  assert_non_null(strstr(part_last_error(), word));
  assert_non_null(strstr(part_last_error(), id));
}

static void test_bad_particles(void **state) {
  (void)state;
  const mesh_options options = {.kind = MESH_HEX, .n = {4, 4, 4}, .hi = {1, 1, 1}};
  for (int method = 0; method < CPL_VOID_FRACTION_COUNT; method++) {
    scene s;
    scene_make(&s, MPI_COMM_WORLD, &options, 0, method);
    particle p = {{1.3, 0.5, 0.25}, 0.1, {0, 0, 0}, 1000.0, 0};
    one_bad(&s, &p, PART_ERR_OUTSIDE, "(1.3 0.5 0.25)", "particle 2");
    p.x[0] = 1e30;
    one_bad(&s, &p, PART_ERR_OUTSIDE, "1e+30", "particle 2");
    p.x[0] = NAN;
    one_bad(&s, &p, PART_ERR_NUMERIC, "nan", "particle 2");
    p.x[0] = 0.5;
    p.r = 0.0;
    one_bad(&s, &p, PART_ERR_RANGE, "radius", "particle 2");
    /* and goes on after them */
    p.r = 0.1;
    scene_particles(&s, 1, &p, 0, 0);
    assert_int_equal(cpl_void_fraction(s.cpl, &s.view, &s.cells, NULL), PART_ERR_STATE);
    assert_int_equal(cpl_locate(s.cpl, &s.view), PART_OK);
    assert_int_equal(cpl_void_fraction(s.cpl, &s.view, &s.cells, NULL), PART_OK);
    scene_free(&s);
  }
}

/* Fixed particles: located once; any change of position, radius or order is seen. */
static void test_reuse(void **state) {
  (void)state;
  const mesh_options options = {.kind = MESH_HEX, .n = {4, 4, 4}, .hi = {1, 1, 1}};
  particle all[40];
  char text[2048];
  scene s;
  scene_random(&options, 40, 0.05, 0.1, 16, all);
  scene_make(&s, MPI_COMM_WORLD, &options, 0, CPL_VOID_FRACTION_exact);
  scene_particles(&s, 40, all, 0, 0);
  for (int k = 0; k < 3; k++)
    assert_int_equal(cpl_locate(s.cpl, &s.view), PART_OK);
  assert_int_equal(cpl_void_fraction(s.cpl, &s.view, &s.cells, NULL), PART_OK);
  assert_int_equal(cpl_plan_text(s.cpl, sizeof text, text), PART_OK);
  assert_non_null(strstr(text, "in 2 of 3 calls"));
  if (s.view.count > 0)
    s.row[ROW_X] += s.row[ROW_X] < 0.5 ? 0.25 : -0.25;
  const double before = sum_over(s.comm, s.rank == 0 ? s.eps[0] : 0.0);
  double change = 0.0;
  double *eps = mesh_alloc((size_t)s.mesh.view.cells, sizeof *eps);
  memcpy(eps, s.eps, (size_t)s.mesh.view.cells * sizeof *eps);
  assert_int_equal(cpl_locate(s.cpl, &s.view), PART_OK);
  assert_int_equal(cpl_void_fraction(s.cpl, &s.view, &s.cells, NULL), PART_OK);
  for (int c = 0; c < s.mesh.view.cells; c++)
    change = fmax(change, fabs(s.eps[c] - eps[c]));
  assert_true(isfinite(before) && max_over(s.comm, change) > 1e-3);
  scene_particles(&s, 40, all, 0, 1); /* another order: not the order that was located */
  assert_int_equal(cpl_void_fraction(s.cpl, &s.view, &s.cells, NULL), PART_ERR_STATE);
  free(eps);
  scene_free(&s);
}

/* No particles at all, and ranks without cells. */
static void test_empty(void **state) {
  (void)state;
  const mesh_options options = {.kind = MESH_HEX, .n = {2, 1, 1}, .hi = {1, 1, 1}};
  scene s;
  scene_make(&s, MPI_COMM_WORLD, &options, 0, CPL_VOID_FRACTION_exact);
  scene_particles(&s, 0, NULL, 0, 0);
  double error = -1.0;
  assert_int_equal(cpl_locate(s.cpl, &s.view), PART_OK);
  assert_int_equal(cpl_void_fraction(s.cpl, &s.view, &s.cells, &error), PART_OK);
  assert_true(error == 0.0);
  for (int c = 0; c < s.mesh.view.cells; c++)
    assert_true(s.eps[c] == 1.0);
  const particle p = {{0.5, 0.5, 0.5}, 0.1, {0, 0, 0}, 1000.0, 0};
  scene_particles(&s, 1, &p, 0, 0);
  assert_int_equal(cpl_locate(s.cpl, &s.view), PART_OK);
  assert_int_equal(cpl_void_fraction(s.cpl, &s.view, &s.cells, &error), PART_OK);
  for (int c = 0; c < s.mesh.view.cells; c++)
    assert_near(scene_solid(&s, c), scene_volume(&p) / 2.0, 1e-15);
  scene_free(&s);
}

int main(int argc, char **argv) {
  MPI_Init(&argc, &argv);
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_bad_particles),
      cmocka_unit_test(test_reuse),
      cmocka_unit_test(test_empty),
  };
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
