/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sub-cells: the row fill marks exactly the sub-cells whose centre passes the plain test. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "../../libcoupling/src/search_type.h"
#include "overlap_case.h"

#ifdef __clang__ /* the library does not contract either */
#pragma STDC FP_CONTRACT OFF
#endif

enum { N = 40 };

static int inside_ball(const double p[3], const double x[3], double r) {
  const double dx = p[0] - x[0], dy = p[1] - x[1], dz = p[2] - x[2];
  return dx * dx + (dy * dy + dz * dz) < r * r;
}

/* All marks of one cell; returns how many there are. in_cell: NULL, or which points count. */
static int compare_marks(overlap_case *c, int n, int cell, const double *point,
                         const unsigned char *in_cell, const double x[3], double r) {
  const int count = n * n * n;
  unsigned char *mark = mesh_alloc((size_t)count, 1);
  int marked = 0, wrong = 0;
  assert_int_equal(cpl_sub_cell_marks(c->search, n, cell, x, r, mark), PART_OK);
  for (int i = 0; i < count; i++) {
    const int expected = inside_ball(point + 3 * i, x, r) && (in_cell == NULL || in_cell[i]);
    wrong += mark[i] != expected;
    marked += mark[i];
  }
  free(mark);
  if (wrong > 0)
    fail_msg("cell %d: %d of %d marks differ, ball (%.17g %.17g %.17g) %.17g", cell, wrong, count,
             x[0], x[1], x[2], r);
  return marked;
}

/* Every cell near some spheres; the marks of a box times its part volume are its overlap. */
static void compare_hexes(const mesh_options *o, int n, int spheres) {
  overlap_case c;
  int total = 0;
  overlap_case_make(o, &c);
  double *point = mesh_alloc((size_t)n * (size_t)n * (size_t)n, 3 * sizeof *point);
  for (int s = 0; s < spheres; s++) {
    double x[3], r;
    (s % 2 ? random_sphere : degenerate_sphere)(&c, x, &r);
    cpl_overlaps list = {0};
    int hint = -1;
    assert_int_equal(cpl_overlap_subCell(c.search, n, x, r, &hint, &list), PART_OK);
    memset(c.volume, 0, (size_t)c.mesh.view.cells * sizeof *c.volume);
    for (int k = 0; k < list.count; k++)
      c.volume[list.cell[k]] = list.volume[k];
    for (int cell = 0; cell < c.mesh.view.cells; cell++) {
      if (!ball_may_touch(&c.cells, cell, x, r)) {
        assert_true(c.volume[cell] == 0.0);
        continue;
      }
      assert_int_equal(cpl_sub_cell_points(c.search, n, cell, point), PART_OK);
      const int marked = compare_marks(&c, n, cell, point, NULL, x, r);
      const double volume = marked * c.mesh.volume[cell] / n / n / n;
      if (c.search->is_box[cell])
        assert_true(fabs(volume - c.volume[cell]) <= 1e-13 * volume);
      total += marked;
    }
    cpl_overlaps_free(&list);
  }
  assert_true(total > 1000 * spheres);
  free(point);
  overlap_case_free(&c);
}

static void boxes(void **state) {
  (void)state;
  mesh_options o = MESH_UNIT(MESH_HEX, 3, 4, 3);
  o.grade[0] = 3.0;
  compare_hexes(&o, N, overlap_spheres(100));
  compare_hexes(&o, 7, overlap_spheres(300));
}

/* Centre and radius on the lattice of sub-cell centres: many centres exactly on the sphere. */
static void boxes_with_ties(void **state) {
  (void)state;
  mesh_options o = MESH_UNIT(MESH_HEX, 2, 2, 2);
  overlap_case c;
  overlap_case_make(&o, &c);
  const double part = 0.5 / 32;
  double *point = mesh_alloc(32 * 32 * 32, 3 * sizeof *point);
  for (int i = 0; i < 60; i++) {
    double x[3];
    for (int d = 0; d < 3; d++)
      x[d] = 0.25 + part * (floor(32 * mesh_random(&c.random)) + (i % 2 ? 0.5 : 0.0));
    const double r = part * (1 + i % 20);
    for (int cell = 0; cell < 8; cell++) {
      assert_int_equal(cpl_sub_cell_points(c.search, 32, cell, point), PART_OK);
      compare_marks(&c, 32, cell, point, NULL, x, r);
    }
  }
  free(point);
  overlap_case_free(&c);
}

static void hexahedra(void **state) {
  (void)state;
  mesh_options o = overlap_variant(MESH_HEX, 2);
  compare_hexes(&o, N, overlap_spheres(12));
  o = overlap_variant(MESH_HEX, 1);
  compare_hexes(&o, 9, overlap_spheres(100));
}

/* Other cells: grid points of the bound that are inside by their winding number. The meshes are
 * warped and turned, so that no point is on a face. */
static void polyhedra(void **state) {
  (void)state;
  const mesh_kind kinds[] = {MESH_PRISM, MESH_TET, MESH_POLY, MESH_AGGLOMERATE};
  for (int q = 0; q < 4; q++) {
    const mesh_options o = overlap_variant(kinds[q], 2);
    overlap_case c;
    overlap_case_make(&o, &c);
    double *point = mesh_alloc(N * N * N, 3 * sizeof *point);
    unsigned char *in_cell = mesh_alloc(N * N * N, 1);
    for (int i = 0; i < 3; i++) {
      int cell = (int)(mesh_random(&c.random) * c.mesh.view.cells);
      if (kinds[q] == MESH_AGGLOMERATE)
        cell -= cell % 2; /* L-shaped; the odd ones are hexahedra */
      assert_int_equal(cpl_sub_cell_points(c.search, N, cell, point), PART_OK);
      int all = 0, marked = 0;
      for (int k = 0; k < N * N * N; k++) {
        in_cell[k] = ball_winding(&c.cells, cell, point + 3 * k) > 0.5L;
        all += in_cell[k];
      }
      for (int s = 0; s < 20; s++) {
        double x[3];
        for (int d = 0; d < 3; d++)
          x[d] = c.mesh.cell_centre[3 * cell + d] + c.cell * (mesh_random(&c.random) - 0.5);
        marked +=
            compare_marks(&c, N, cell, point, in_cell, x, c.cell * (0.1 + mesh_random(&c.random)));
      }
      assert_true(marked > 0);
      assert_int_equal(
          compare_marks(&c, N, cell, point, in_cell, c.mesh.cell_centre + 3 * cell, 100.0), all);
    }
    free(point);
    free(in_cell);
    overlap_case_free(&c);
  }
}

/* Volumes tend to the exact ones, on every kind of cell. */
static void tends_to_exact(void **state) {
  (void)state;
  for (int kind = MESH_HEX; kind <= MESH_AGGLOMERATE; kind++) {
    const mesh_options o = overlap_variant((mesh_kind)kind, 2);
    overlap_case c;
    overlap_case_make(&o, &c);
    double worst = 0.0;
    int hint = -1, touched = 0;
    for (int s = 0; s < 20; s++) {
      double x[3], r;
      random_sphere(&c, x, &r);
      r = c.cell;
      overlap_run(&c, x, r, &hint);
      cpl_overlaps list = {0};
      assert_int_equal(cpl_overlap_subCell(c.search, N, x, r, &hint, &list), PART_OK);
      for (int k = 0; k < list.count; k++)
        c.volume[list.cell[k]] -= list.volume[k] / (BALL * r * r * r);
      for (int cell = 0; cell < c.mesh.view.cells; cell++)
        worst = fmax(worst, fabs(c.volume[cell]));
      touched += list.count;
      cpl_overlaps_free(&list);
    }
    assert_true(touched > 20);
    assert_true(worst < 2e-3); /* design: 1.6e-3 at most for a sphere of one cell diameter */
    overlap_case_free(&c);
  }
}

static void smaller_than_a_sub_cell(void **state) {
  (void)state;
  mesh_options o = MESH_UNIT(MESH_HEX, 2, 2, 2);
  overlap_case c;
  overlap_case_make(&o, &c);
  const double x[3] = {0.6, 0.1, 0.1}, r = 1e-3;
  cpl_overlaps list = {0};
  int hint = -1;
  assert_int_equal(cpl_overlap_subCell(c.search, 3, x, r, &hint, &list), PART_OK);
  assert_int_equal(list.count, 0); /* no centre in it; who asks divides it exactly */
  assert_int_equal(hint, 1);
  assert_int_equal(cpl_overlap_subCell(c.search, 0, x, r, &hint, &list), PART_ERR_RANGE);
  assert_non_null(strstr(part_last_error(), "sub-cells"));
  cpl_overlaps_free(&list);
  overlap_case_free(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(boxes),          cmocka_unit_test(boxes_with_ties),
      cmocka_unit_test(hexahedra),      cmocka_unit_test(polyhedra),
      cmocka_unit_test(tends_to_exact), cmocka_unit_test(smaller_than_a_sub_cell),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
