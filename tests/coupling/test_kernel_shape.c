/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The kernel of each cell, by its moments, and what of the solids around a sphere are its own. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../../libcoupling/src/smoothing.h"
#include "../../libcoupling/src/wake.h"
#include "cyclic_mesh.h"
#include "scene.h"

/* Kernel of cell c written down: shift[3] and the moments about it, and the density with itself. */
static double kernel_of(cpl_smoother *s, const cpl_mesh *m, int c, double shift[3],
                        double moment[3][3]) {
  double *r = mesh_alloc((size_t)m->cells, sizeof *r), itself = 0.0;
  r[c] = 1.0 / m->volume[c];
  assert_int_equal(cpl_smoother_apply(s, 1, r), PART_OK);
  memset(shift, 0, 3 * sizeof *shift);
  memset(moment, 0, 9 * sizeof **moment);
  for (int e = 0; e < m->cells; e++) {
    itself += m->volume[e] * r[e] * r[e];
    for (int a = 0; a < 3; a++) {
      const double x = m->cell_centre[3 * e + a] - m->cell_centre[3 * c + a];
      shift[a] += m->volume[e] * r[e] * x;
      for (int b = 0; b < 3; b++)
        moment[a][b] +=
            m->volume[e] * r[e] * x * (m->cell_centre[3 * e + b] - m->cell_centre[3 * c + b]);
    }
  }
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++)
      moment[a][b] -= shift[a] * shift[b];
  free(r);
  return itself;
}

static double determinant(double m[3][3]) {
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
         m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

/* Cells in the middle of a mesh: shape against the kernel written down; of a sphere alone in a cell
 * all solids are its own. *least: its share if the kernel were as wide as asked for. */
static void check_shape(const mesh_options *options, double width, double *least) {
  made_mesh mesh;
  mesh_make(options, &mesh);
  const cpl_mesh *m = &mesh.view;
  const double b = width / cbrt((double)m->cells), volume = 1e-9;
  cpl_smoother *s;
  const double *shape;
  assert_int_equal(cpl_smoother_create(MPI_COMM_SELF, m, 0.5 * b * b, 0.0, &s), PART_OK);
  assert_int_equal(cpl_smoother_shape(s, &shape), PART_OK);
  int checked = 0;
  for (int c = 0; c < m->cells; c++) {
    const double *x = m->cell_centre + 3 * (size_t)c, *found = shape + CPL_SHAPE * (size_t)c;
    if (fabs(x[0] - 0.5) > 0.12 || fabs(x[1] - 0.5) > 0.12 || fabs(x[2] - 0.5) > 0.12)
      continue;
    double shift[3], moment[3][3];
    const double itself = kernel_of(s, m, c, shift, moment);
    for (int a = 0; a < 3; a++)
      assert_near(found[a], shift[a], 1e-11 * b);
    assert_near(found[3], 0.5 * b * b, 1e-12 * b * b);
    assert_near(found[4], cbrt(determinant(moment)), 1e-10 * b * b);
    const double eps = 1.0 - volume * itself;
    assert_near(cpl_wake_share(volume, found[4], eps), 1.0, 1e-9);
    /* alone the sphere stands in clear fluid; in a bed its own volume is one of many */
    const double self = volume / pow(4.0 * acos(-1.0) * found[4], 1.5);
    assert_near(1.0 - cpl_wake_eps(volume, found[4], eps), fmax(volume * itself - self, 0.0), 1e-15);
    const double large = 1e5 * self;
    assert_near(cpl_wake_eps(1e5 * volume, found[4], 0.4) - 0.4, large * large / (0.6 - 0.5 * large), 1e-12);
    *least = fmin(*least, cpl_wake_share(volume, found[3], eps));
    checked++;
  }
  assert_true(checked > 0);
  cpl_smoother_destroy(s);
  mesh_free(&mesh);
}

static void test_shape(void **state) {
  (void)state;
  const mesh_kind kinds[] = {MESH_HEX, MESH_PRISM, MESH_TET, MESH_POLY};
  for (int k = 0; k < 4; k++) {
    const int n = kinds[k] == MESH_TET ? 9 : 12;
    mesh_options options = MESH_UNIT(kinds[k], n, n, n);
    double plain = 1.0, sheared = 1.0;
    check_shape(&options, 1.5, &plain);
    check_shape(&options, 3.0, &plain);
    options.warp = 0.1;
    options.seed = 3;
    check_shape(&options, 1.5, &plain);
    options.warp = 0.0;
    options.shear = 0.3;
    check_shape(&options, 2.0, &sheared);
    print_message("# mesh kind %d: share by the width asked for %g, sheared %g\n", kinds[k], plain,
                  sheared);
    if (kinds[k] == MESH_TET) /* so the width that is there matters */
      assert_true(sheared < 0.7);
  }
}

/* Through cyclic faces; a block one cell thick, where the density is that of a plane. */
static void test_shape_borders(void **state) {
  (void)state;
  const double variance = 0.2 * 0.2;
  const double *shape;
  cyclic_mesh c;
  cpl_smoother *s;
  cyclic_make(&c, 8);
  assert_int_equal(cpl_smoother_create(MPI_COMM_SELF, &c.mesh.view, variance, 0.0, &s), PART_OK);
  assert_int_equal(cpl_smoother_shape(s, &shape), PART_OK);
  for (int k = 0; k < c.mesh.view.cells; k++) {
    for (int a = 0; a < 3; a++)
      assert_near(shape[CPL_SHAPE * k + a], 0.0, 1e-13);
    assert_near(shape[CPL_SHAPE * k + 4], variance, 1e-12);
  }
  cpl_smoother_destroy(s);
  cyclic_free(&c);
  mesh_options options = MESH_UNIT(MESH_HEX, 31, 31, 1);
  made_mesh mesh;
  mesh_make(&options, &mesh);
  assert_int_equal(cpl_smoother_create(MPI_COMM_SELF, &mesh.view, 0.01, 0.0, &s), PART_OK);
  assert_int_equal(cpl_smoother_shape(s, &shape), PART_OK);
  const double *middle = shape + CPL_SHAPE * (size_t)(31 * 15 + 15);
  assert_near(middle[4], cbrt(0.01 * 0.01 / (4.0 * 3.14159265358979323846)), 1e-4 * middle[4]);
  cpl_smoother_destroy(s);
  mesh_free(&mesh);
}

static void test_share(void **state) {
  (void)state;
  const double v = 0.01, self = 1e-4 / pow(4.0 * 3.14159265358979323846 * v, 1.5);
  assert_near(cpl_wake_share(1e-4, v, 1.0 - self), 1.0, 1e-12);
  assert_near(cpl_wake_share(1e-4, v, 1.0 - 0.9 * self), 1.0, 1e-12);
  assert_near(cpl_wake_share(1e-4, v, 1.0 - 100.0 * self), 1.0 / 99.5, 1e-10);
}

int main(int argc, char **argv) {
  MPI_Init(&argc, &argv);
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_shape),
      cmocka_unit_test(test_shape_borders),
      cmocka_unit_test(test_share),
  };
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
