/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ranks: 1 2 3 4
 * Where the volume of a sphere goes: over periodic borders, into walls, onto faces between ranks.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "scene.h"

static const double PI = 3.14159265358979323846;

/* A sphere across a periodic border fills cells on both sides as its shifted copy inside does. */
static void test_periodic_images(void **state) {
  (void)state;
  const mesh_options options = {
      .kind = MESH_HEX, .n = {4, 4, 4}, .hi = {1, 1, 1}, .periodic = {1, 1, 1}};
  scene s;
  scene_make(&s, MPI_COMM_WORLD, &options, 1, CPL_VOID_FRACTION_exact);
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
      const double solid = scene_solid(&s, c);
      assert_near(solid, corner ? scene_volume(&p) / 8.0 : 0.0, 1e-15);
    }
  }
  /* 0.07 of it across the upper border: a cap in the first cell; and the mirror image of that */
  const double cap = PI * 0.07 * 0.07 * (3.0 * 0.1 - 0.07) / 3.0;
  for (int axis = 0; axis < 3; axis++)
    for (int upper = 0; upper < 2; upper++) {
      particle p = {{0.375, 0.375, 0.375}, 0.1, {0, 0, 0}, 1000.0, 0};
      p.x[axis] = upper ? 0.97 : 0.03;
      scene_fill(&s, 1, &p);
      for (int c = 0; c < s.mesh.view.cells; c++) {
        const int g = scene_global(&s, c), at3[3] = {g % 4, g / 4 % 4, g / 16};
        const int row = at3[(axis + 1) % 3] == 1 && at3[(axis + 2) % 3] == 1;
        const double expected = !row || at3[axis] % 3 != 0     ? 0.0
                                : at3[axis] == (upper ? 0 : 3) ? cap
                                                               : scene_volume(&p) - cap;
        assert_near(scene_solid(&s, c), expected, 1e-15);
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
    scene s;
    scene_make(&s, MPI_COMM_WORLD, &options, 0, method);
    const particle p[2] = {{{0.0, 0.375, 0.375}, 0.1, {0, 0, 0}, 1000.0, 0},
                           {{0.625, 0.625, 1.02}, 0.1, {0, 0, 0}, 1000.0, 0}};
    scene_fill(&s, 2, p);
    for (int c = 0; c < s.mesh.view.cells; c++) {
      const int g = scene_global(&s, c);
      const int full = g == 0 + 4 * 1 + 16 * 1 || g == 2 + 4 * 2 + 16 * 3;
      assert_near(scene_solid(&s, c), full ? scene_volume(p) : 0.0, 1e-15);
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
  scene s, one;
  scene_make(&s, MPI_COMM_WORLD, &options, 1, CPL_VOID_FRACTION_centre);
  scene_make(&one, MPI_COMM_SELF, &options, 0, CPL_VOID_FRACTION_centre);
  scene_fill(&one, LATTICE, all);
  assert_true(scene_fill(&s, LATTICE, all) < 1e-13); /* round-off of a sum of 729 */
  const double volume = scene_volume(all);
  for (int c = 0; c < s.mesh.view.cells; c++) {
    const double number = scene_solid(&s, c) / volume;
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
  const cpl_fluid fluid = scene_water();
  cpl_params params = scene_params();
  params.void_fraction = CPL_VOID_FRACTION_subCell;
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
  scene s;
  scene_make(&s, MPI_COMM_WORLD, &options, 0, CPL_VOID_FRACTION_exact);
  const particle p[2] = {{{0.2, 0.2, 0.2}, 0.05, {1.0, -2.0, 0.5}, 1000.0, 0},
                         {{0.3, 0.3, 0.3}, 0.1, {-0.5, 1.0, 4.0}, 3000.0, 0}};
  scene_fill(&s, 2, p);
  for (int c = 0; c < s.mesh.view.cells; c++)
    for (int d = 0; d < 3; d++)
      assert_near(s.solid_velocity[3 * c + d],
                  scene_global(&s, c) == 0 ? (p[0].v[d] + 8.0 * p[1].v[d]) / 9.0 : 0.0, 1e-14);
  scene_free(&s);
}

/* A sphere larger than the mesh, or too many in a cell: eps below minimumEps names the cell. */
static void test_too_dense(void **state) {
  (void)state;
  const mesh_options options = {.kind = MESH_HEX, .n = {2, 2, 2}, .hi = {1, 1, 1}};
  scene s;
  scene_make(&s, MPI_COMM_WORLD, &options, 0, CPL_VOID_FRACTION_exact);
  const particle p = {{0.5, 0.5, 0.5}, 2.0, {0, 0, 0}, 1000.0, 0};
  scene_particles(&s, 1, &p, 0, 0);
  assert_int_equal(cpl_locate(s.cpl, &s.view), PART_OK);
  assert_int_equal(cpl_void_fraction(s.cpl, &s.view, &s.cells, NULL), PART_ERR_RANGE);
  assert_non_null(strstr(part_last_error(), "minimumEps"));
  scene_free(&s);
}

int main(int argc, char **argv) {
  MPI_Init(&argc, &argv);
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_periodic_images), cmocka_unit_test(test_partly_in_a_wall),
      cmocka_unit_test(test_centre_on_faces), cmocka_unit_test(test_tiny_spheres),
      cmocka_unit_test(test_solid_velocity),  cmocka_unit_test(test_too_dense),
  };
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
