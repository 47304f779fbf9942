/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The cell of a point. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "../../libcoupling/src/void_fractions.h"
#include "../../libcoupling/src/overlap.h"
#include "../../libcoupling/src/search_type.h"
#include "overlap_case.h"

static int brute_force(const overlap_case *c, const double x[3]) {
  for (int cell = 0; cell < c->mesh.view.cells; cell++)
    if (ball_may_touch(&c->cells, cell, x, 0.0) && ball_winding(&c->cells, cell, x) > 0.5L)
      return cell;
  return -1;
}

static void random_points(void **state) {
  (void)state;
  for (int kind = MESH_HEX; kind <= MESH_AGGLOMERATE; kind++)
    for (int variant = 0; variant < VARIANTS; variant++) {
      const mesh_options o = overlap_variant((mesh_kind)kind, variant);
      overlap_case c;
      int outside = 0;
      overlap_case_make(&o, &c);
      for (int i = 0; i < 1000; i++) {
        double x[3], r;
        random_sphere(&c, x, &r);
        const int cell = brute_force(&c, x);
        const int hint = (int)(mesh_random(&c.random) * c.mesh.view.cells);
        assert_int_equal(cpl_search_cell(c.search, x, -1), cell);
        assert_int_equal(cpl_search_cell(c.search, x, hint), cell);
        assert_int_equal(cpl_search_cell(c.search, x, cell), cell);
        outside += cell < 0;
      }
      assert_in_range(outside, 1, 900);
      for (int cell = 0; cell < c.mesh.view.cells && kind != MESH_AGGLOMERATE; cell++)
        assert_int_equal(cpl_search_cell(c.search, c.mesh.cell_centre + 3 * cell, -1), cell);
      overlap_case_free(&c);
    }
}

/* A vertex, or the middle of an edge, is in the first cell that has it. */
static void ties_go_to_the_first_cell(void **state) {
  (void)state;
  for (int kind = MESH_HEX; kind <= MESH_AGGLOMERATE; kind++)
    for (int variant = 0; variant < VARIANTS; variant++) {
      const mesh_options o = overlap_variant((mesh_kind)kind, variant);
      overlap_case c;
      overlap_case_make(&o, &c);
      const cpl_mesh *m = &c.mesh.view;
      int *first = mesh_alloc((size_t)m->points, sizeof *first);
      for (int p = 0; p < m->points; p++)
        first[p] = m->cells;
      for (int f = 0; f < m->faces; f++)
        for (int k = m->face_start[f]; k < m->face_start[f + 1]; k++)
          if (m->owner[f] < first[m->face_point[k]]) /* an owner is before its neighbour */
            first[m->face_point[k]] = m->owner[f];
      for (int p = 0; p < m->points; p++) {
        if (first[p] == m->cells)
          continue; /* inside an agglomerated cell */
        const int last = m->cells - 1;
        const int cell = cpl_search_cell(c.search, m->point + 3 * p, last);
        /* a cell may also touch the point with an edge of L shape that has no vertex there */
        if (kind == MESH_AGGLOMERATE)
          assert_true(cell >= 0 && cell <= first[p]);
        else
          assert_int_equal(cell, first[p]);
      }
      for (int f = 0; f < m->internal; f++)
        assert_int_equal(cpl_search_cell(c.search, m->face_centre + 3 * f, m->neighbour[f]),
                         m->owner[f]);
      free(first);
      overlap_case_free(&c);
    }
}

/* Points next to faces, closer than any tolerance: in one of the two cells, with any hint. */
static void no_gaps(void **state) {
  (void)state;
  for (int kind = MESH_HEX; kind <= MESH_AGGLOMERATE; kind++)
    for (int variant = 0; variant < VARIANTS; variant++) {
      const mesh_options o = overlap_variant((mesh_kind)kind, variant);
      overlap_case c;
      overlap_case_make(&o, &c);
      const cpl_mesh *m = &c.mesh.view;
      for (int i = 0; i < 2000; i++) {
        const int f = (int)(mesh_random(&c.random) * m->internal);
        const double *a = m->point + 3 * m->face_point[m->face_start[f]],
                     *b = m->face_centre + 3 * f;
        const double size = pow(10.0, -17.0 + 4.0 * mesh_random(&c.random));
        const double w = 0.1 + 0.8 * mesh_random(&c.random);
        double x[3];
        for (int d = 0; d < 3; d++)
          x[d] = w * a[d] + (1.0 - w) * b[d] + size * (2.0 * mesh_random(&c.random) - 1.0);
        const int hint = (int)(mesh_random(&c.random) * m->cells);
        const int cell = cpl_search_cell(c.search, x, hint);
        assert_true(cell == m->owner[f] || cell == m->neighbour[f]);
        assert_int_equal(cpl_search_cell(c.search, x, -1), cell);
      }
      overlap_case_free(&c);
    }
}

static void boxes_are_seen(void **state) {
  (void)state;
  mesh_options o = MESH_UNIT(MESH_HEX, 6, 4, 4);
  overlap_case c;
  overlap_case_make(&o, &c);
  assert_non_null(c.search->tensor);
  overlap_case_free(&c);
  o.warp = 0.2;
  o.warp_from = 0.5;
  overlap_case_make(&o, &c);
  assert_null(c.search->tensor);
  int boxes = 0;
  for (int i = 0; i < c.mesh.view.cells; i++)
    boxes += c.search->is_box[i];
  assert_int_equal(boxes, 2 * 4 * 4); /* two of six layers have no moved point */
  overlap_case_free(&c);
  o = MESH_UNIT(MESH_HEX, 4, 4, 4);
  o.rotate[2] = 1e-9;
  overlap_case_make(&o, &c);
  assert_null(c.search->tensor);
  overlap_case_free(&c);
}

static void bounds_and_marks(void **state) {
  (void)state;
  mesh_options o = overlap_variant(MESH_TET, 2);
  overlap_case c;
  overlap_case_make(&o, &c);
  double lo[3], hi[3], bin[3];
  const int n[3] = {5, 7, 6};
  unsigned char mark[5 * 7 * 6] = {0};
  cpl_search_bounds(c.search, lo, hi);
  for (int d = 0; d < 3; d++) {
    assert_true(lo[d] == c.mesh.box.lo[d] && hi[d] == c.mesh.box.hi[d]);
    bin[d] = (hi[d] - lo[d]) / n[d];
  }
  cpl_search_mark(c.search, lo, bin, n, mark);
  int empty = 0;
  for (int i = 0; i < 5 * 7 * 6; i++)
    empty += mark[i] == 0;
  assert_in_range(empty, 1, 5 * 7 * 6 - 1); /* the sheared box leaves corners free */
  for (int i = 0; i < 5000; i++) {
    double x[3], r;
    random_sphere(&c, x, &r);
    if (cpl_search_cell(c.search, x, -1) < 0)
      continue;
    int b[3];
    for (int d = 0; d < 3; d++)
      b[d] = (int)((x[d] - lo[d]) / bin[d]);
    assert_true(mark[b[0] + n[0] * (b[1] + n[1] * b[2])]);
  }
  overlap_case_free(&c);
}

static void no_cells(void **state) {
  (void)state;
  mesh_options o = MESH_UNIT(MESH_HEX, 2, 2, 2);
  made_mesh whole, none;
  int rank_of[8] = {0}, hint = -1;
  mesh_make(&o, &whole);
  mesh_split(&whole, rank_of, 1, &none);
  cpl_search *search;
  double lo[3], hi[3];
  const double x[3] = {0.5, 0.5, 0.5};
  cpl_overlaps list = {0};
  assert_int_equal(cpl_search_create(&none.view, &search), PART_OK);
  cpl_search_bounds(search, lo, hi);
  assert_true(lo[0] > hi[0]);
  assert_int_equal(cpl_search_cell(search, x, -1), -1);
  for (int method = 0; method < CPL_VOID_FRACTION_COUNT; method++)
    assert_int_equal(cpl_overlap(method, search, 40, x, 0.3, &hint, &list), PART_OK);
  assert_int_equal(list.count, 0);
  assert_int_equal(hint, -1);
  assert_int_equal(cpl_overlap(CPL_VOID_FRACTION_COUNT, search, 40, x, 0.3, &hint, &list), PART_ERR_ARGUMENT);
  cpl_overlaps_free(&list);
  cpl_search_destroy(search);
  mesh_free(&none);
  mesh_free(&whole);
}

static void bad_mesh(void **state) {
  (void)state;
  mesh_options o = MESH_UNIT(MESH_HEX, 2, 2, 2);
  made_mesh mesh;
  cpl_search *search;
  mesh_make(&o, &mesh);
  mesh.owner[3] = 8;
  assert_int_equal(cpl_search_create(&mesh.view, &search), PART_ERR_ARGUMENT);
  assert_null(search);
  assert_non_null(strstr(part_last_error(), "face 3"));
  mesh_free(&mesh);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(random_points),    cmocka_unit_test(ties_go_to_the_first_cell),
      cmocka_unit_test(no_gaps),          cmocka_unit_test(boxes_are_seen),
      cmocka_unit_test(bounds_and_marks), cmocka_unit_test(no_cells),
      cmocka_unit_test(bad_mesh),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
