/* SPDX-License-Identifier: GPL-3.0-or-later */
/* timeout: 3000 */
/* Exact overlap against independent references, on every kind of cell.
 * OVERLAP_SPHERES=100000 runs that many spheres per mesh (tests/validation/long_overlap). */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "overlap_case.h"
#include "../../libcoupling/src/search_type.h"

/* What the project promises: per cell, and for the sum over cells of a sphere inside the mesh. */
static const double cell_bar = 1e-12, sum_bar = 1e-14;

typedef void (*place)(overlap_case *, double[3], double *);

static void compare(const mesh_options *o, place where, int spheres, ball_reference reference) {
  overlap_case c;
  int hint = -1, inside = 0;
  overlap_case_make(o, &c);
  for (int i = 0; i < spheres; i++) {
    double x[3], r, ref_sum;
    where(&c, x, &r);
    const double sum = overlap_run(&c, x, r, &hint);
    const double error = overlap_error(&c, reference, x, r, &ref_sum);
    if (!(error <= cell_bar) || (fabs(ref_sum - 1.0) < 1e-16 && !(fabs(sum - 1.0) <= sum_bar)))
      fail_msg("kind %d warp %g sphere %d (%.17g %.17g %.17g) radius %.17g: error %g, sum 1 + %g",
               (int)o->kind, o->warp, i, x[0], x[1], x[2], r, error, sum - 1.0);
    inside += fabs(ref_sum - 1.0) < 1e-16;
  }
  assert_true(spheres < 100 || inside > spheres / 10);
  overlap_case_free(&c);
}

static void on_all_meshes(place where, int spheres, ball_reference reference) {
  for (int kind = MESH_HEX; kind <= MESH_AGGLOMERATE; kind++)
    for (int variant = 0; variant < VARIANTS; variant++) {
      const mesh_options o = overlap_variant((mesh_kind)kind, variant);
      compare(&o, where, spheres, reference);
    }
}

static void random_spheres(void **state) {
  (void)state;
  on_all_meshes(random_sphere, overlap_spheres(100), ball_by_edges);
}

static void degenerate_positions(void **state) {
  (void)state;
  on_all_meshes(degenerate_sphere, overlap_spheres(100), ball_by_edges);
}

static void small_sphere(overlap_case *c, double x[3], double *r) {
  (mesh_random(&c->random) < 0.5 ? random_sphere : degenerate_sphere)(c, x, r);
  *r = c->cell * (0.1 + 0.4 * mesh_random(&c->random));
}

/* The other reference shares no formula with the library or with ball_by_edges. */
static void against_slices(void **state) {
  (void)state;
  const int many = overlap_spheres(0) > 0;
  for (int kind = MESH_HEX; kind <= MESH_AGGLOMERATE; kind++)
    for (int variant = many ? 0 : 2; variant < VARIANTS; variant++) {
      const mesh_options o = overlap_variant((mesh_kind)kind, variant);
      compare(&o, small_sphere, many ? 300 : 2, ball_by_slices);
    }
}

static void interior_sphere(overlap_case *c, double x[3], double *r) {
  *r = c->cell * (0.05 + 1.2 * mesh_random(&c->random));
  for (int d = 0; d < 3; d++)
    x[d] = c->mesh.box.lo[d] + *r +
           (c->mesh.box.hi[d] - c->mesh.box.lo[d] - 2.0 * *r) * mesh_random(&c->random);
}

/* 100 000 spheres: the closed form of boxes against the signed cones of polyhedra, which share no
 * formula; the latter against a reference. */
static void cartesian_many(void **state) {
  (void)state;
  mesh_options o = MESH_UNIT(MESH_HEX, 4, 3, 3);
  overlap_case box, general;
  overlap_case_make(&o, &box);
  overlap_case_make(&o, &general);
  assert_non_null(box.search->tensor);
  cpl_tensor *tensor = general.search->tensor;
  general.search->tensor = NULL;
  assert_int_equal(cpl_search_build_corners(general.search), PART_OK);
  memset(general.search->is_box, 0, (size_t)general.mesh.view.cells);
  int hint = -1, hint2 = -1;
  for (int i = 0; i < 100000; i++) {
    double x[3], r, worst = 0.0;
    (i % 2 ? interior_sphere : degenerate_sphere)(&box, x, &r);
    const double sum = overlap_run(&box, x, r, &hint);
    const double sum2 = overlap_run(&general, x, r, &hint2);
    for (int c = 0; c < box.mesh.view.cells; c++)
      worst = fmax(worst, fabs(box.volume[c] - general.volume[c]));
    if (!(worst <= cell_bar) || (i % 2 && !(fabs(sum - 1.0) <= sum_bar)) ||
        (i % 2 && !(fabs(sum2 - 1.0) <= sum_bar)))
      fail_msg("sphere %d: box and general differ by %g, sums 1 + %g, 1 + %g", i, worst, sum - 1.0,
               sum2 - 1.0);
  }
  compare(&o, interior_sphere, overlap_spheres(500), ball_by_edges);
  compare(&o, degenerate_sphere, overlap_spheres(500), ball_by_edges);
  general.search->tensor = tensor;
  overlap_case_free(&box);
  overlap_case_free(&general);
}

static void graded_grid(void **state) {
  (void)state;
  mesh_options o = MESH_UNIT(MESH_HEX, 7, 3, 5);
  o.grade[0] = 10.0;
  o.grade[2] = 0.2;
  compare(&o, random_sphere, overlap_spheres(200), ball_by_edges);
  compare(&o, degenerate_sphere, overlap_spheres(200), ball_by_edges);
}

/* Boxes beside warped hexahedra: both paths in one sphere. */
static void boxes_and_others(void **state) {
  (void)state;
  mesh_options o = MESH_UNIT(MESH_HEX, 6, 4, 4);
  o.warp = 0.2;
  o.warp_from = 0.5;
  compare(&o, random_sphere, overlap_spheres(200), ball_by_edges);
  compare(&o, degenerate_sphere, overlap_spheres(200), ball_by_edges);
}

static void rotated_grid_is_the_grid(void **state) {
  (void)state;
  mesh_options o = MESH_UNIT(MESH_HEX, 4, 4, 4);
  overlap_case plain, turned;
  overlap_case_make(&o, &plain);
  o.rotate[2] = 2.0 * atan(0.5); /* cos 3/5, sin 4/5 */
  overlap_case_make(&o, &turned);
  int hint = -1, hint2 = -1;
  for (int i = 0; i < 3000; i++) {
    double x[3], r;
    random_sphere(&plain, x, &r);
    const double y[3] = {0.6 * x[0] - 0.8 * x[1], 0.8 * x[0] + 0.6 * x[1], x[2]};
    overlap_run(&plain, x, r, &hint);
    overlap_run(&turned, y, r, &hint2);
    for (int c = 0; c < plain.mesh.view.cells; c++)
      assert_true(fabs(plain.volume[c] - turned.volume[c]) <= cell_bar);
  }
  overlap_case_free(&plain);
  overlap_case_free(&turned);
}

static void ball_around_the_mesh_fills_every_cell(void **state) {
  (void)state;
  for (int kind = MESH_HEX; kind <= MESH_AGGLOMERATE; kind++)
    for (int variant = 0; variant < VARIANTS; variant++) {
      const mesh_options o = overlap_variant((mesh_kind)kind, variant);
      overlap_case c;
      overlap_case_make(&o, &c);
      const double x[3] = {0.1, 0.2, 0.3}, r = 4.0, ball = BALL * r * r * r;
      int hint = -1;
      overlap_run(&c, x, r, &hint);
      for (int i = 0; i < c.mesh.view.cells; i++)
        assert_true(fabs(c.volume[i] * ball - c.mesh.volume[i]) <= 1e-15 * c.mesh.volume[i]);
      overlap_case_free(&c);
    }
}

/* Every rank reports its own cells; together the same as one rank. */
static void ranks_add_up(void **state) {
  (void)state;
  enum { RANKS = 3 };
  for (int q = 0; q < 4; q++) {
    const mesh_kind kind = q < 2 ? MESH_HEX : q == 2 ? MESH_POLY : MESH_AGGLOMERATE;
    mesh_options o = overlap_variant(kind, q == 0 ? 0 : 2);
    overlap_case c;
    overlap_case_make(&o, &c);
    made_mesh part[RANKS];
    cpl_search *search[RANKS];
    int *rank_of = mesh_alloc((size_t)c.mesh.view.cells, sizeof *rank_of), hint = -1;
    mesh_part_random(&c.mesh, RANKS, 3, rank_of);
    for (int r = 0; r < RANKS; r++) {
      mesh_split(&c.mesh, rank_of, r, &part[r]);
      assert_int_equal(cpl_search_create(&part[r].view, &search[r]), PART_OK);
    }
    for (int i = 0; i < 300; i++) {
      double x[3], radius, worst = 0.0;
      (i % 2 ? random_sphere : degenerate_sphere)(&c, x, &radius);
      overlap_run(&c, x, radius, &hint);
      for (int r = 0; r < RANKS; r++) {
        cpl_overlaps list = {0};
        int none = -1;
        assert_int_equal(cpl_overlap_exact(search[r], 0, x, radius, &none, &list), PART_OK);
        for (int k = 0; k < list.count; k++)
          c.volume[part[r].global_cell[list.cell[k]]] -=
              list.volume[k] / (BALL * radius * radius * radius);
        cpl_overlaps_free(&list);
      }
      for (int k = 0; k < c.mesh.view.cells; k++)
        worst = fmax(worst, fabs(c.volume[k]));
      if (!(worst <= cell_bar))
        fail_msg("mesh %d sphere %d: ranks differ from one rank by %g", q, i, worst);
    }
    for (int r = 0; r < RANKS; r++) {
      cpl_search_destroy(search[r]);
      mesh_free(&part[r]);
    }
    free(rank_of);
    overlap_case_free(&c);
  }
}

static void bad_radius(void **state) {
  (void)state;
  mesh_options o = MESH_UNIT(MESH_HEX, 2, 2, 2);
  overlap_case c;
  overlap_case_make(&o, &c);
  const double x[3] = {0.5, 0.5, 0.5}, bad[4] = {0.0, -1.0, NAN, INFINITY};
  for (int i = 0; i < 4; i++) {
    cpl_overlaps list = {0};
    int hint = -1;
    assert_int_equal(cpl_overlap_exact(c.search, 0, x, bad[i], &hint, &list), PART_ERR_RANGE);
    assert_non_null(strstr(part_last_error(), "radius"));
  }
  overlap_case_free(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(random_spheres),
      cmocka_unit_test(degenerate_positions),
      cmocka_unit_test(against_slices),
      cmocka_unit_test(cartesian_many),
      cmocka_unit_test(graded_grid),
      cmocka_unit_test(boxes_and_others),
      cmocka_unit_test(rotated_grid_is_the_grid),
      cmocka_unit_test(ball_around_the_mesh_fills_every_cell),
      cmocka_unit_test(ranks_add_up),
      cmocka_unit_test(bad_radius),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
