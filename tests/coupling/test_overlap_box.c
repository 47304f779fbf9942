/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Closed form of a ball in an axis-aligned box. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include "../../libcoupling/src/box_sphere.h"
#include "overlap_case.h"

static const double pi = 3.14159265358979323846;

static void assert_near(double a, double b, double tolerance) {
  if (!(fabs(a - b) <= tolerance))
    fail_msg("%.17g and %.17g differ by %g", a, b, a - b);
}

static void simple_parts(void **state) {
  (void)state;
  assert_near(cpl_cap(0.0), BALL / 2, 3e-16 * BALL);
  assert_near(cpl_cap(0.5), pi * 0.25 * 2.5 / 3.0, 3e-16 * BALL);
  assert_true(cpl_cap(1.0) == 0.0 && cpl_cap(7.0) == 0.0);
  assert_near(cpl_cap(-1.0), BALL, 3e-16 * BALL);
  assert_near(cpl_edge_part(0.0, 0.0), BALL / 4, 3e-16 * BALL);
  assert_near(cpl_corner_part(0.0, 0.0, 0.0), BALL / 8, 3e-16 * BALL);
  assert_near(cpl_corner_part(-2.0, -2.0, -2.0), BALL, 3e-16 * BALL);
  assert_true(cpl_corner_part(0.6, 0.6, 0.6) == 0.0);
  /* the corner on the sphere: nothing is left */
  assert_near(cpl_corner_part(0.6, 0.8, 0.0), 0.0, 3e-16 * BALL);
}

static double random_plane(uint64_t *state) { /* all signs, 0, tangent, near both, far away */
  const double u = mesh_random(state), v = 2.0 * mesh_random(state) - 1.0;
  if (u < 0.1)
    return 0.0;
  if (u < 0.2)
    return v < 0.0 ? -1.0 : 1.0;
  if (u < 0.4)
    return (u < 0.3 ? 0.0 : v < 0.0 ? -1.0 : 1.0) + copysign(pow(10.0, -16.0 * fabs(v)), v);
  return 1.3 * v;
}

/* The part beyond a corner is what mirroring says it is, wherever the corner lies. */
static void mirrored_parts_add_up(void **state) {
  (void)state;
  uint64_t random = 1;
  for (int i = 0; i < 200000; i++) {
    const double a = random_plane(&random), b = random_plane(&random), c = random_plane(&random);
    assert_near(cpl_cap(a) + cpl_cap(-a), BALL, 1e-15 * BALL);
    assert_near(cpl_edge_part(a, b) + cpl_edge_part(-a, b), cpl_cap(b), 1e-15 * BALL);
    assert_near(cpl_corner_part(a, b, c) + cpl_corner_part(a, -b, c), cpl_edge_part(a, c),
                2e-15 * BALL);
    assert_near(cpl_corner_part(a, b, c), cpl_corner_part(c, a, b), 1e-15 * BALL);
  }
}

static double corner_on_the_sphere(double a, double b, uint64_t *state) {
  const double z2 = 1.0 - a * a - b * b, v = 2.0 * mesh_random(state) - 1.0;
  return z2 > 0.0 ? copysign(sqrt(z2), v) + copysign(pow(10.0, -16.0 * fabs(v)), v) : v;
}

/* Boxes as meshes of one cell, against quadrature of slices. */
static void boxes_against_slices(void **state) {
  (void)state;
  uint64_t random = 2;
  for (int i = 0; i < 60; i++) {
    mesh_options o = {.kind = MESH_HEX, .n = {1, 1, 1}};
    double other[3];
    for (int d = 0; d < 3; d++) {
      o.lo[d] = random_plane(&random);
      other[d] = random_plane(&random);
    }
    if (i % 3 == 0)
      o.lo[2] = corner_on_the_sphere(o.lo[0], o.lo[1], &random);
    int empty = 0;
    for (int d = 0; d < 3; d++) {
      o.hi[d] = fmax(o.lo[d], other[d]);
      o.lo[d] = fmin(o.lo[d], other[d]);
      empty = empty || o.hi[d] - o.lo[d] < 1e-6;
    }
    if (empty)
      continue;
    made_mesh mesh;
    ball_cells cells;
    const double origin[3] = {0.0, 0.0, 0.0};
    mesh_make(&o, &mesh);
    ball_cells_create(&mesh.view, &cells);
    assert_near(cpl_box_ball(o.lo, o.hi), (double)ball_by_slices(&cells, 0, origin, 1.0),
                1e-15 * BALL);
    ball_cells_free(&cells);
    mesh_free(&mesh);
  }
}

/* A box cut by planes near to and on the centre: the parts add up to the box. */
static void parts_add_up_to_the_box(void **state) {
  (void)state;
  uint64_t random = 3;
  for (int i = 0; i < 100000; i++) {
    double x[3][3], sum = 0.0;
    for (int d = 0; d < 3; d++)
      for (int k = 0; k < 3; k++) {
        x[d][k] = random_plane(&random);
        for (int j = k; j > 0 && x[d][j] < x[d][j - 1]; j--) {
          const double swap = x[d][j];
          x[d][j] = x[d][j - 1];
          x[d][j - 1] = swap;
        }
      }
    for (int q = 0; q < 8; q++) {
      const int a = q & 1, b = q >> 1 & 1, c = q >> 2;
      const double lo[3] = {x[0][a], x[1][b], x[2][c]};
      const double hi[3] = {x[0][a + 1], x[1][b + 1], x[2][c + 1]};
      const double part = cpl_box_ball(lo, hi);
      assert_true(part >= 0.0);
      sum += part;
    }
    const double lo[3] = {x[0][0], x[1][0], x[2][0]}, hi[3] = {x[0][2], x[1][2], x[2][2]};
    assert_near(sum, cpl_box_ball(lo, hi), 1e-14 * BALL);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(simple_parts),
      cmocka_unit_test(mirrored_parts_add_up),
      cmocka_unit_test(boxes_against_slices),
      cmocka_unit_test(parts_add_up_to_the_box),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
