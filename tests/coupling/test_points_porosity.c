/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ranks: 1 2 3 4
 * Porosity at fluid points (equations P.1 to P.4). */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../../libcoupling/src/points_table.h"
#include "points_scene.h"

static const double PI = 3.14159265358979323846;

static double ball(double r) {
  return 4.0 / 3.0 * PI * r * r * r;
}

static double top_hat(const void *context, double r) {
  const double support = *(const double *)context;
  return r <= support ? 1.0 / ball(support) : 0.0;
}

/* With a kernel that is constant in a ball, the integral over a sphere is a lens in closed form. */
static void test_lens(void **state) {
  (void)state;
  const double support = 1.3, radius = 0.4;
  const cpl_points_kernel kernel = {support, top_hat, NULL, &support};
  for (int k = 0; k <= 20; k++) {
    const double s = 0.1 * k, a = support + radius - s;
    double lens = ball(radius);
    if (s > support - radius)
      lens = a > 0.0 ? PI * a * a *
                           (s * s + 2.0 * s * (support + radius) -
                            3.0 * (support - radius) * (support - radius)) /
                           (12.0 * s)
                     : 0.0;
    assert_near(points_sphere_mean(&kernel, s, radius), lens / ball(radius) / ball(support), 2e-9);
  }
}

/* The table: its integral over all space is 1, and it is the exact value between its rows. */
static void test_table(void **state) {
  (void)state;
  points_scene s;
  points_scene_init(&s, MPI_COMM_WORLD, 0.1, 0);
  assert_int_equal(points_scene_start(&s, 0, NULL), PART_OK);
  double spheres[2 * SPHERE_WIDTH] = {0.5, 0.5, 0.5, 0.01}, *points;
  memcpy(spheres + SPHERE_WIDTH, spheres, SPHERE_WIDTH * sizeof(double));
  spheres[SPHERE_WIDTH + SR] = 0.06;
  const int count = points_lattice(&s.box, 4, 0.0, &points);
  points_scene_spheres(&s, 2, spheres, 0);
  points_scene_points(&s, count, points, 0);
  assert_int_equal(cpl_points_locate(s.points, &s.view, &s.fluid_view), PART_OK);
  for (double r = 0.01; r < 0.0601; r += 0.0071) {
    double sum = 0.0;
    const double end = 0.26, step = end / 4000.0;
    for (int k = 0; k < 4000; k++) {
      const double d = ((double)k + 0.5) * step;
      sum += 4.0 * PI * d * d * step * cpl_points_sphere_kernel(s.points, d, r);
      /* rows of R^2, linear: the error is the second derivative's */
      if (k % 100 == 0)
        assert_near(cpl_points_sphere_kernel(s.points, d, r), points_sphere_mean(&s.kernel, d, r),
                    1e-4 * s.kernel.value(&s.h, 0.0)); /* W has a term in |s|^3 */
    }
    assert_near(sum, 1.0, 1e-5);
  }
  free(points);
  points_scene_free(&s);
}

static void fill(points_scene *s, double h, int periodic, int planes, const cpl_points_plane *plane,
                 int porosity, int n, double radius, double *lo, double *hi) {
  double *spheres, *points;
  points_scene_init(s, MPI_COMM_WORLD, h, periodic);
  s->params.porosity = porosity;
  assert_int_equal(points_scene_start(s, planes, plane), PART_OK);
  const int n_spheres = spheres_lattice(&s->box, n, radius, &spheres);
  const int n_points = points_lattice(&s->box, 13, 0.9, &points);
  points_scene_spheres(s, n_spheres, spheres, 2);
  points_scene_points(s, n_points, points, 0);
  assert_int_equal(cpl_points_locate(s->points, &s->view, &s->fluid_view), PART_OK);
  assert_int_equal(cpl_points_porosity(s->points, &s->fluid_view), PART_OK);
  double range[2] = {-HUGE_VAL, -HUGE_VAL};
  for (int a = 0; a < s->fluid_view.count; a++) {
    range[0] = fmax(range[0], -s->point[a * POINT_WIDTH + PEPS]);
    range[1] = fmax(range[1], s->point[a * POINT_WIDTH + PEPS]);
  }
  MPI_Allreduce(MPI_IN_PLACE, range, 2, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
  *lo = -range[0];
  *hi = range[1];
  free(spheres);
  free(points);
}

/* A lattice that fills the box has the porosity 1 - n V everywhere, between walls and in their corners as in a
 * periodic box; so has the mean over a sphere with less ripple than the kernel at its centre. */
static void test_lattice(void **state) {
  (void)state;
  const cpl_points_plane six[6] = {{{0, 0, 0}, {1, 0, 0}},  {{1, 0, 0}, {-2, 0, 0}}, {{0, 0, 0}, {0, 1, 0}},
                                   {{0, 1, 0}, {0, -1, 0}}, {{0, 0, 0}, {0, 0, 3}},  {{0, 0, 1}, {0, 0, -1}}};
  const double radius = 0.025, expected = 1.0 - 4096.0 * ball(radius);
  double ripple[2], lo, hi;
  for (int porosity = 0; porosity < 2; porosity++) {
    points_scene s;
    fill(&s, 0.2, 1, 0, NULL, porosity, 16, radius, &lo, &hi);
    points_scene_free(&s);
    ripple[porosity] = hi - lo;
    assert_near(lo, expected, 2e-5);
    assert_near(hi, expected, 2e-5);
    fill(&s, 0.2, 0, 6, six, porosity, 16, radius, &lo, &hi);
    points_scene_free(&s);
    assert_near(lo, expected, 2e-5);
    assert_near(hi, expected, 2e-5);
  }
  assert_true(ripple[CPL_POINTS_EXACT] < ripple[CPL_POINTS_CENTRE]);
}

/* Share of the kernel on this side of a plane at x = 0, by shells (Gamma of Markauskas et al. 2017, eq. 17). */
static double half_space(const void *context, const double x[3]) {
  const double h = *(const double *)context, end = 2.0 * h;
  double sum = 0.0;
  for (int k = 0; k < 4000; k++) {
    const double q = end * (k + 0.5) / 4000.0, t = 1.0 - 0.5 * q / h;
    const double w = 21.0 / (16.0 * PI * h * h * h) * t * t * t * t * (2.0 * q / h + 1.0);
    sum += end / 4000.0 * 4.0 * PI * q * q * w * (q <= x[0] ? 1.0 : 0.5 * (1.0 + x[0] / q));
  }
  return sum;
}

/* The factor Gamma does the same beside one plane, where it is known. */
static void test_gamma(void **state) {
  (void)state;
  points_scene s;
  double *spheres, *points;
  points_scene_init(&s, MPI_COMM_WORLD, 0.15, 0);
  s.params.porosity = CPL_POINTS_CENTRE; /* Gamma is that of the kernel itself */
  s.kernel.gamma = half_space;
  assert_int_equal(points_scene_start(&s, 0, NULL), PART_OK);
  const int n_spheres = spheres_lattice(&s.box, 14, 0.03, &spheres);
  const int n_points = points_lattice(&s.box, 20, 0.0, &points);
  points_scene_spheres(&s, n_spheres, spheres, 1);
  points_scene_points(&s, n_points, points, 0);
  assert_int_equal(cpl_points_locate(s.points, &s.view, &s.fluid_view), PART_OK);
  assert_int_equal(cpl_points_porosity(s.points, &s.fluid_view), PART_OK);
  int checked = 0;
  for (int a = 0; a < s.fluid_view.count; a++) {
    const double *row = s.point + a * POINT_WIDTH;
    if (row[0] > 0.6 || fabs(row[1] - 0.5) > 0.19 || fabs(row[2] - 0.5) > 0.19)
      continue;
    /* 1.6 % of the solids, for a lattice that a wall cuts is no integral; without Gamma it is 50 % */
    assert_near(row[PEPS], 1.0 - 2744.0 * ball(0.03), 5e-3);
    checked++;
  }
  MPI_Allreduce(MPI_IN_PLACE, &checked, 1, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
  assert_true(checked > 100);
  free(spheres);
  free(points);
  points_scene_free(&s);
}

static void locate_eps(points_scene *s) {
  assert_int_equal(cpl_points_locate(s->points, &s->view, &s->fluid_view), PART_OK);
  assert_int_equal(cpl_points_porosity(s->points, &s->fluid_view), PART_OK);
}

/* The gradient at the points against differences of eps at points moved either way. The table has kinks between its
 * nodes, some 1/4096 of the slope; a moved pair that crosses one sees both sides of it: 4e-4 were met. */
static void compare_gradient(points_scene *s) {
  const double step = 1e-6;
  const int n = s->fluid_view.count;
  double *gradient = calloc(3 * (size_t)n + 1, sizeof *gradient);
  double *lower = calloc((size_t)n + 1, sizeof *lower), error = 0.0, most = 0.0;
  assert_true(gradient && lower);
  s->fluid_view.eps_gradient = gradient;
  s->fluid_view.eps_gradient_stride = 3;
  locate_eps(s);
  s->fluid_view.eps_gradient = NULL;
  for (int c = 0; c < 3; c++) {
    for (int end = 0; end < 2; end++) {
      for (int a = 0; a < n; a++)
        s->point[a * POINT_WIDTH + PX + c] += end ? 2.0 * step : -step;
      locate_eps(s);
      for (int a = 0; a < n && !end; a++)
        lower[a] = s->point[a * POINT_WIDTH + PEPS];
    }
    for (int a = 0; a < n; a++) {
      const double difference = (s->point[a * POINT_WIDTH + PEPS] - lower[a]) / (2.0 * step);
      error = fmax(error, fabs(difference - gradient[3 * a + c]));
      most = fmax(most, fabs(difference));
      s->point[a * POINT_WIDTH + PX + c] -= step;
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, &error, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
  MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
  assert_true(most > 0.5);
  if (error > 1e-3 * most)
    fail_msg("gradient of eps differs by %g of %g 1/m", error, most);
  free(gradient);
  free(lower);
}

/* Periodic, mirrored at six planes, and beside a wall that has a Gamma; one size, and sizes that differ. */
static void test_gradient(void **state) {
  (void)state;
  const cpl_points_plane six[6] = {{{0, 0, 0}, {1, 0, 0}},  {{1, 0, 0}, {-2, 0, 0}}, {{0, 0, 0}, {0, 1, 0}},
                                   {{0, 1, 0}, {0, -1, 0}}, {{0, 0, 0}, {0, 0, 3}},  {{0, 0, 1}, {0, 0, -1}}};
  for (int kind = 0; kind < 6; kind++) {
    const int walls = kind / 2, sizes = kind % 2;
    points_scene s;
    double *spheres, *points;
    points_scene_init(&s, MPI_COMM_WORLD, 0.06, walls == 0);
    if (walls == 2)
      s.kernel.gamma = half_space;
    assert_int_equal(points_scene_start(&s, walls == 1 ? 6 : 0, six), PART_OK);
    const int n_spheres = spheres_lattice(&s.box, 5, 0.04, &spheres);
    const int n_points = points_lattice(&s.box, 7, 0.5, &points);
    for (int i = 0; i < n_spheres; i++)
      spheres[i * SPHERE_WIDTH + SR] *= 1.0 + 0.4 * sizes * (i % 4);
    points_scene_spheres(&s, n_spheres, spheres, 1);
    points_scene_points(&s, n_points, points, 0);
    compare_gradient(&s);
    free(spheres);
    free(points);
    points_scene_free(&s);
  }
}

static void expect(points_scene *s, int planes, const cpl_points_plane *plane, int status, const char *text) {
  const int got = points_scene_start(s, planes, plane);
  if (got != status || !strstr(part_last_error(), text))
    fail_msg("status %d, text '%s', not %d with '%s'", got, part_last_error(), status, text);
}

static void test_errors(void **state) {
  (void)state;
  points_scene s;
  double *spheres, *points;
  const cpl_points_plane oblique[2] = {{{0, 0, 0}, {1, 0, 0}}, {{0, 0, 0}, {1, 1, 0}}};
  const cpl_points_plane third[3] = {
      {{0, 0, 0}, {1, 0, 0}}, {{1, 0, 0}, {-1, 0, 0}}, {{0.5, 0, 0}, {1, 0, 0}}};
  points_scene_init(&s, MPI_COMM_WORLD, 0.1, 0);
  expect(&s, 2, oblique, PART_ERR_ARGUMENT, "right angles");
  expect(&s, 3, third, PART_ERR_ARGUMENT, "third one");
  s.box.periodic[0] = 1;
  expect(&s, 1, third, PART_ERR_ARGUMENT, "periodic direction 0");
  s.params.drag = 99;
  expect(&s, 0, NULL, PART_ERR_RANGE, "drag law 99");
  points_scene_init(&s, MPI_COMM_WORLD, 0.1, 0);
  s.params.coupling_length = 0.5;
  expect(&s, 0, NULL, PART_ERR_RANGE, "couplingLength");
  points_scene_init(&s, MPI_COMM_WORLD, 0.6, 1);
  assert_int_equal(points_scene_start(&s, 0, NULL), PART_OK);
  const int n_spheres = spheres_lattice(&s.box, 4, 0.05, &spheres);
  const int n_points = points_lattice(&s.box, 4, 0.0, &points);
  points_scene_spheres(&s, n_spheres, spheres, 0);
  points_scene_points(&s, n_points, points, 0);
  assert_int_equal(cpl_points_porosity(s.points, &s.fluid_view), PART_ERR_STATE);
  assert_int_equal(cpl_points_locate(s.points, &s.view, &s.fluid_view), PART_ERR_RANGE);
  points_scene_free(&s);
  points_scene_init(&s, MPI_COMM_WORLD, 0.1, 0);
  s.params.minimum_eps = 0.9999;
  assert_int_equal(points_scene_start(&s, 0, NULL), PART_OK);
  points_scene_spheres(&s, n_spheres, spheres, 0);
  points_scene_points(&s, n_points, points, 0);
  assert_int_equal(cpl_points_locate(s.points, &s.view, &s.fluid_view), PART_OK);
  assert_int_equal(cpl_points_porosity(s.points, &s.fluid_view), PART_ERR_RANGE);
  free(spheres);
  free(points);
  points_scene_free(&s);
}

int main(int argc, char **argv) {
  MPI_Init(&argc, &argv);
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_lens), cmocka_unit_test(test_table),
                                     cmocka_unit_test(test_lattice), cmocka_unit_test(test_gamma), cmocka_unit_test(test_gradient),
                                     cmocka_unit_test(test_errors)};
  cmocka_set_message_output(CM_OUTPUT_TAP);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
