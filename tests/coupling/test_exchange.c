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
static const double PI = 3.14159265358979323846;

/* Meshes and methods that every law below is tried on. */
static const struct {
  const char *name;
  mesh_options options;
  int method, random_cells;
} variant[] = {
    {"hex, exact", {.kind = MESH_HEX, .n = {6, 5, 4}, .hi = {1.2, 1, 0.8}}, 0, 0},
    {"hex, exact, cells at random", {.kind = MESH_HEX, .n = {6, 5, 4}, .hi = {1.2, 1, 0.8}}, 0, 1},
    {"periodic", {.kind = MESH_HEX, .n = {5, 4, 4}, .hi = {1, 1, 1}, .periodic = {1, 1, 1}}, 0, 0},
    {"periodic in y, warped, cells at random",
     {.kind = MESH_HEX,
      .n = {4, 4, 4},
      .hi = {1, 1, 1},
      .periodic = {0, 1, 0},
      .warp = 0.2,
      .seed = 3},
     0,
     1},
    {"tetrahedra", {.kind = MESH_TET, .n = {3, 3, 3}, .hi = {1, 1, 1}}, 0, 0},
    {"polyhedra, warped",
     {.kind = MESH_POLY, .n = {3, 3, 3}, .hi = {1, 1, 1}, .warp = 0.2, .seed = 4},
     0,
     1},
    {"centre", {.kind = MESH_HEX, .n = {6, 5, 4}, .hi = {1.2, 1, 0.8}}, 2, 1},
    {"centre, periodic",
     {.kind = MESH_HEX, .n = {5, 4, 4}, .hi = {1, 1, 1}, .periodic = {1, 0, 1}},
     2,
     1},
    {"subCell", {.kind = MESH_HEX, .n = {5, 4, 4}, .hi = {1, 1, 1}, .periodic = {1, 0, 1}}, 1, 0},
};
enum { VARIANTS = sizeof variant / sizeof *variant };

static void start(scene *s, int v, MPI_Comm comm, int count, const particle *all) {
  cpl_params params = scene_params();
  const cpl_fluid fluid = scene_water();
  params.void_fraction = variant[v].method;
  params.sub_cells = 10;
  scene_mesh(s, comm, &variant[v].options, variant[v].random_cells);
  if (scene_start(s, &params, &fluid) != PART_OK)
    fail_msg("%s: %s", variant[v].name, part_last_error());
  scene_particles(s, count, all, 1, 0);
  if (cpl_locate(s->cpl, &s->view) != PART_OK)
    fail_msg("%s: %s", variant[v].name, part_last_error());
}

static double volume_of(const particle *p) {
  return 4.0 / 3.0 * PI * p->r * p->r * p->r;
}

/* Deposited sums: each particle's value arrives once, whatever part of it is in a wall. */
static void test_deposit_conserves(void **state) {
  (void)state;
  particle all[MANY];
  for (int v = 0; v < VARIANTS; v++) {
    scene s;
    scene_random(&variant[v].options, MANY, 0.01, 0.15, 11, all);
    start(&s, v, MPI_COMM_WORLD, MANY, all);
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
  particle all[MANY];
  for (int v = 0; v < VARIANTS; v++) {
    scene s;
    scene_random(&variant[v].options, MANY, 0.01, 0.15, 12, all);
    start(&s, v, MPI_COMM_WORLD, MANY, all);
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
  particle all[MANY];
  for (int v = 0; v < VARIANTS; v++) {
    scene s;
    scene_random(&variant[v].options, MANY, 0.01, 0.15, 13, all);
    start(&s, v, MPI_COMM_WORLD, MANY, all);
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
  particle all[MANY];
  for (int v = 0; v < VARIANTS; v++) {
    scene s, one;
    scene_random(&variant[v].options, MANY, 0.01, 0.06, 14, all);
    start(&s, v, MPI_COMM_WORLD, MANY, all);
    start(&one, v, MPI_COMM_SELF, MANY, all);
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

/* A sphere across a periodic border fills cells on both sides as its shifted copy inside does. */
static void test_periodic_images(void **state) {
  (void)state;
  const mesh_options options = {
      .kind = MESH_HEX, .n = {4, 4, 4}, .hi = {1, 1, 1}, .periodic = {1, 1, 1}};
  const cpl_params params = scene_params();
  const cpl_fluid fluid = scene_water();
  scene s;
  scene_mesh(&s, MPI_COMM_WORLD, &options, 1);
  assert_int_equal(scene_start(&s, &params, &fluid), PART_OK);
  /* at a corner of the box: an eighth of it in each of the 8 corner cells; far outside is the same
   * place, and so is exactly on the upper border */
  const double at[4] = {0.0, 1.0, -3.0, 7.0};
  for (int k = 0; k < 4; k++) {
    const particle p = {{at[k], at[(k + 1) % 4], at[(k + 2) % 4]}, 0.1, {0, 0, 0}, 1000.0, 0};
    scene_particles(&s, 1, &p, k, 0);
    assert_int_equal(cpl_locate(s.cpl, &s.view), PART_OK);
    assert_int_equal(cpl_void_fraction(s.cpl, &s.view, &s.cells, NULL), PART_OK);
    for (int c = 0; c < s.mesh.view.cells; c++) {
      const int g = scene_global(&s, c), i = g % 4, j = g / 4 % 4, l = g / 16;
      const int corner = i % 3 == 0 && j % 3 == 0 && l % 3 == 0;
      const double solid = (1.0 - s.eps[c]) * s.mesh.volume[c];
      assert_near(solid, corner ? volume_of(&p) / 8.0 : 0.0, 1e-15);
    }
  }
  /* 0.07 of it across the upper border: a cap in the first cell; and the mirror image of that */
  const double cap = PI * 0.07 * 0.07 * (3.0 * 0.1 - 0.07) / 3.0;
  for (int axis = 0; axis < 3; axis++)
    for (int upper = 0; upper < 2; upper++) {
      particle p = {{0.375, 0.375, 0.375}, 0.1, {0, 0, 0}, 1000.0, 0};
      p.x[axis] = upper ? 0.97 : 0.03;
      scene_particles(&s, 1, &p, 0, 0);
      assert_int_equal(cpl_locate(s.cpl, &s.view), PART_OK);
      assert_int_equal(cpl_void_fraction(s.cpl, &s.view, &s.cells, NULL), PART_OK);
      for (int c = 0; c < s.mesh.view.cells; c++) {
        const int g = scene_global(&s, c), at3[3] = {g % 4, g / 4 % 4, g / 16};
        const int row = at3[(axis + 1) % 3] == 1 && at3[(axis + 2) % 3] == 1;
        const double expected = !row || at3[axis] % 3 != 0     ? 0.0
                                : at3[axis] == (upper ? 0 : 3) ? cap
                                                               : volume_of(&p) - cap;
        assert_near((1.0 - s.eps[c]) * s.mesh.volume[c], expected, 1e-15);
      }
    }
  const particle large = {{0.5, 0.5, 0.5}, 0.51, {0, 0, 0}, 1000.0, 0};
  scene_particles(&s, 1, &large, 0, 0);
  assert_int_equal(cpl_locate(s.cpl, &s.view), PART_ERR_RANGE);
  assert_non_null(strstr(part_last_error(), "periodic length"));
  scene_free(&s);
}

/* Half in a wall: all of the volume goes to the cell that has the other half. */
static void test_partly_in_a_wall(void **state) {
  (void)state;
  const mesh_options options = {.kind = MESH_HEX, .n = {4, 4, 4}, .hi = {1, 1, 1}};
  for (int method = 0; method < 3; method++) {
    cpl_params params = scene_params();
    const cpl_fluid fluid = scene_water();
    params.void_fraction = method;
    scene s;
    scene_mesh(&s, MPI_COMM_WORLD, &options, 0);
    assert_int_equal(scene_start(&s, &params, &fluid), PART_OK);
    const particle p[2] = {{{0.0, 0.375, 0.375}, 0.1, {0, 0, 0}, 1000.0, 0},
                           {{0.625, 0.625, 1.02}, 0.1, {0, 0, 0}, 1000.0, 0}};
    scene_particles(&s, 2, p, 0, 0);
    assert_int_equal(cpl_locate(s.cpl, &s.view), PART_OK);
    assert_int_equal(cpl_void_fraction(s.cpl, &s.view, &s.cells, NULL), PART_OK);
    for (int c = 0; c < s.mesh.view.cells; c++) {
      const int g = scene_global(&s, c);
      const int full = g == 0 + 4 * 1 + 16 * 1 || g == 2 + 4 * 2 + 16 * 3;
      assert_near((1.0 - s.eps[c]) * s.mesh.volume[c], full ? volume_of(p) : 0.0, 1e-15);
    }
    scene_free(&s);
  }
}

/* centre: on a face, edge or vertex between ranks it is still one cell, that of one rank. */
static void test_centre_on_faces(void **state) {
  (void)state;
  const mesh_options options = {
      .kind = MESH_HEX, .n = {4, 4, 4}, .hi = {1, 1, 1}, .periodic = {1, 0, 0}};
  enum { LATTICE = 9 * 9 * 9 };
  particle *all = mesh_alloc(LATTICE, sizeof *all);
  for (int i = 0; i < LATTICE; i++)
    all[i] = (particle){
        {0.125 * (i % 9), 0.125 * (i / 9 % 9), 0.125 * (i / 81)}, 0.01, {0, 0, 0}, 1000.0, 0};
  cpl_params params = scene_params();
  const cpl_fluid fluid = scene_water();
  params.void_fraction = 2;
  scene s, one;
  scene_mesh(&s, MPI_COMM_WORLD, &options, 1);
  scene_mesh(&one, MPI_COMM_SELF, &options, 0);
  assert_int_equal(scene_start(&s, &params, &fluid), PART_OK);
  assert_int_equal(scene_start(&one, &params, &fluid), PART_OK);
  scene_particles(&s, LATTICE, all, 0, 0);
  scene_particles(&one, LATTICE, all, 0, 0);
  assert_int_equal(cpl_locate(s.cpl, &s.view), PART_OK);
  assert_int_equal(cpl_locate(one.cpl, &one.view), PART_OK);
  double error;
  assert_int_equal(cpl_void_fraction(s.cpl, &s.view, &s.cells, &error), PART_OK);
  assert_int_equal(cpl_void_fraction(one.cpl, &one.view, &one.cells, NULL), PART_OK);
  assert_true(error < 1e-13); /* round-off of a sum of 729 */
  const double volume = volume_of(all);
  for (int c = 0; c < s.mesh.view.cells; c++) {
    const double number = (1.0 - s.eps[c]) * s.mesh.volume[c] / volume;
    assert_near(number, round(number), 1e-9);
    assert_near(s.eps[c], one.eps[scene_global(&s, c)], 1e-14);
  }
  free(all);
  scene_free(&s);
  scene_free(&one);
}

/* Spheres of the size of a sub-cell and far below: many hold no sub-cell centre, some only one of
 * another rank than that of their own centre. Nothing is lost, and ranks make no difference. */
static void test_tiny_spheres(void **state) {
  (void)state;
  enum { TINY = 3000 };
  /* sub-cells differ in size along x, so that the nearest centre may be that of the next cell */
  const mesh_options options = {
      .kind = MESH_HEX, .n = {6, 4, 4}, .hi = {1, 1, 1}, .grade = {50, 0, 0}};
  particle *all = mesh_alloc(TINY, sizeof *all);
  cpl_params params = scene_params();
  const cpl_fluid fluid = scene_water();
  params.void_fraction = 1;
  params.sub_cells = 3;
  scene s, one;
  scene_random(&options, TINY, 1e-3, 6e-2, 15, all);
  scene_mesh(&s, MPI_COMM_WORLD, &options, 1);
  scene_mesh(&one, MPI_COMM_SELF, &options, 0);
  assert_int_equal(scene_start(&s, &params, &fluid), PART_OK);
  assert_int_equal(scene_start(&one, &params, &fluid), PART_OK);
  scene_particles(&s, TINY, all, 0, 0);
  scene_particles(&one, TINY, all, 0, 0);
  assert_int_equal(cpl_locate(s.cpl, &s.view), PART_OK);
  assert_int_equal(cpl_locate(one.cpl, &one.view), PART_OK);
  double *value = mesh_alloc(TINY, sizeof *value);
  double *cell = mesh_alloc((size_t)s.mesh.view.cells, sizeof *cell);
  double *cell_one = mesh_alloc((size_t)one.mesh.view.cells, sizeof *cell);
  for (int i = 0; i < TINY; i++)
    value[i] = 1.0;
  assert_int_equal(cpl_deposit(s.cpl, 1, value, cell), PART_OK);
  assert_int_equal(cpl_deposit(one.cpl, 1, value, cell_one), PART_OK);
  double sum = 0.0;
  for (int c = 0; c < s.mesh.view.cells; c++) {
    sum += cell[c];
    assert_near(cell[c], cell_one[scene_global(&s, c)], 1e-12 * TINY);
  }
  assert_near(sum_over(s.comm, sum), TINY, 1e-13 * TINY);
  free(all);
  free(value);
  free(cell);
  free(cell_one);
  scene_free(&s);
  scene_free(&one);
}

/* Volume-weighted: two spheres of different size and velocity in one cell, none in the others. */
static void test_solid_velocity(void **state) {
  (void)state;
  const mesh_options options = {.kind = MESH_HEX, .n = {2, 2, 2}, .hi = {1, 1, 1}};
  const cpl_params params = scene_params();
  const cpl_fluid fluid = scene_water();
  scene s;
  scene_mesh(&s, MPI_COMM_WORLD, &options, 0);
  assert_int_equal(scene_start(&s, &params, &fluid), PART_OK);
  const particle p[2] = {{{0.2, 0.2, 0.2}, 0.05, {1.0, -2.0, 0.5}, 1000.0, 0},
                         {{0.3, 0.3, 0.3}, 0.1, {-0.5, 1.0, 4.0}, 3000.0, 0}};
  scene_particles(&s, 2, p, 0, 0);
  assert_int_equal(cpl_locate(s.cpl, &s.view), PART_OK);
  assert_int_equal(cpl_void_fraction(s.cpl, &s.view, &s.cells, NULL), PART_OK);
  for (int c = 0; c < s.mesh.view.cells; c++)
    for (int d = 0; d < 3; d++)
      assert_near(s.solid_velocity[3 * c + d],
                  scene_global(&s, c) == 0 ? (p[0].v[d] + 8.0 * p[1].v[d]) / 9.0 : 0.0, 1e-14);
  scene_free(&s);
}

/* ---- errors --------------------------------------------------------------------------------- */
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
  for (int method = 0; method < 3; method++) {
    cpl_params params = scene_params();
    const cpl_fluid fluid = scene_water();
    params.void_fraction = method;
    scene s;
    scene_mesh(&s, MPI_COMM_WORLD, &options, 0);
    assert_int_equal(scene_start(&s, &params, &fluid), PART_OK);
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

/* A sphere larger than the mesh, or too many in a cell: eps below minimumEps names the cell. */
static void test_too_dense(void **state) {
  (void)state;
  const mesh_options options = {.kind = MESH_HEX, .n = {2, 2, 2}, .hi = {1, 1, 1}};
  const cpl_params params = scene_params();
  const cpl_fluid fluid = scene_water();
  scene s;
  scene_mesh(&s, MPI_COMM_WORLD, &options, 0);
  assert_int_equal(scene_start(&s, &params, &fluid), PART_OK);
  const particle p = {{0.5, 0.5, 0.5}, 2.0, {0, 0, 0}, 1000.0, 0};
  scene_particles(&s, 1, &p, 0, 0);
  assert_int_equal(cpl_locate(s.cpl, &s.view), PART_OK);
  assert_int_equal(cpl_void_fraction(s.cpl, &s.view, &s.cells, NULL), PART_ERR_RANGE);
  assert_non_null(strstr(part_last_error(), "minimumEps"));
  scene_free(&s);
}

/* Fixed particles: located once; any change of position, radius or order is seen. */
static void test_reuse(void **state) {
  (void)state;
  const mesh_options options = {.kind = MESH_HEX, .n = {4, 4, 4}, .hi = {1, 1, 1}};
  particle all[40];
  char text[2048];
  const cpl_params params = scene_params();
  const cpl_fluid fluid = scene_water();
  scene s;
  scene_random(&options, 40, 0.05, 0.1, 16, all);
  scene_mesh(&s, MPI_COMM_WORLD, &options, 0);
  assert_int_equal(scene_start(&s, &params, &fluid), PART_OK);
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
  const cpl_params params = scene_params();
  const cpl_fluid fluid = scene_water();
  scene s;
  scene_mesh(&s, MPI_COMM_WORLD, &options, 0);
  assert_int_equal(scene_start(&s, &params, &fluid), PART_OK);
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
    assert_near((1.0 - s.eps[c]) * s.mesh.volume[c], volume_of(&p) / 2.0, 1e-15);
  scene_free(&s);
}

int main(int argc, char **argv) {
  MPI_Init(&argc, &argv);
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_deposit_conserves),
      cmocka_unit_test(test_sample_of_constant),
      cmocka_unit_test(test_adjoint),
      cmocka_unit_test(test_same_as_serial),
      cmocka_unit_test(test_periodic_images),
      cmocka_unit_test(test_partly_in_a_wall),
      cmocka_unit_test(test_centre_on_faces),
      cmocka_unit_test(test_tiny_spheres),
      cmocka_unit_test(test_solid_velocity),
      cmocka_unit_test(test_bad_particles),
      cmocka_unit_test(test_too_dense),
      cmocka_unit_test(test_reuse),
      cmocka_unit_test(test_empty),
  };
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
