/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ranks: 1 2 3 4
 * Force of fluid points on particles and its reaction (equations P.5 to P.8). */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "points_scene.h"

static const double PI = 3.14159265358979323846;

/* A sphere in uniform flow feels its law, exactly: normalised sums of a constant are the constant. */
static void test_law(void **state) {
  (void)state;
  const double u[3] = {0.02, -0.03, 0.05}, radius = 0.004;
  for (int law = 0; law < cpl_drag_count(); law++)
    for (int form = 0; form < 2; form++) {
      points_scene s;
      double *points, sphere[SPHERE_WIDTH] = {0.52, 0.47, 0.5, radius, 0.01, 0.0, -0.01, 1.0};
      points_scene_init(&s, MPI_COMM_WORLD, 0.2, 1);
      s.params.drag = law;
      s.params.form = form;
      assert_int_equal(points_scene_start(&s, 0, NULL), PART_OK);
      const int n = points_lattice(&s.box, 10, 0.5, &points);
      for (int a = 0; a < n; a++) {
        memcpy(points + a * POINT_WIDTH + PU, u, sizeof u);
        points[a * POINT_WIDTH + PA + 1] = 3.0;
      }
      points_scene_spheres(&s, 1, sphere, law);
      points_scene_points(&s, n, points, 0);
      assert_int_equal(cpl_points_locate(s.points, &s.view, &s.fluid_view), PART_OK);
      assert_int_equal(cpl_points_porosity(s.points, &s.fluid_view), PART_OK);
      assert_int_equal(cpl_points_force(s.points, &s.view, &s.fluid_view), PART_OK);
      for (int i = 0; i < s.view.count; i++) {
        const double *row = s.sphere, *su = row + SSU, volume = 4.0 / 3.0 * PI * pow(radius, 3);
        const double eps = cpl_points_sampled_eps(s.points)[0];
        double slip = 0.0;
        for (int c = 0; c < 3; c++)
          slip += (u[c] - row[SV + c]) * (u[c] - row[SV + c]);
        const double beta =
            cpl_drag_function(law)(sqrt(slip), 2.0 * radius, eps, 1000.0, 1e-3, 2.0 * radius) /
            (form == CPL_POINTS_COMBINED ? eps : 1.0);
        assert_true(eps < 1.0 && eps > 0.9999);
        assert_near(row[SSP], beta, 1e-12 * beta);
        for (int c = 0; c < 3; c++) {
          double other = form == CPL_POINTS_GRADIENT && c == 1 ? volume * 1000.0 * 3.0 : 0.0;
          if (form == CPL_POINTS_COMBINED && c == 2)
            other = volume * 1000.0 * 9.81;
          assert_near(su[c], beta * u[c] + other, 1e-12 * (beta * 0.1 + volume * 1e4));
        }
        assert_near(cpl_points_wet(s.points)[0], 1.0, 0.0);
      }
      free(points);
      points_scene_free(&s);
    }
}

/* Pair forces along the line of centres add up to the law and to -V grad p, but for the disorder of the points; a pressure
 * that is the same everywhere adds nothing. Without the factor 3 the drag would be a third, with the 1/3 of Gao and Sun a
 * ninth. Points and particles keep momentum and angular momentum. */
static void test_pairwise(void **state) {
  (void)state;
  const double u[3] = {0.02, -0.03, 0.05}, slope[3] = {30.0, -10.0, 20.0}, radius = 0.03;
  for (int k = 0; k < 3; k++) { /* flow, pressure, a constant */
    points_scene s;
    double *points, sphere[SPHERE_WIDTH] = {0.52, 0.47, 0.5, radius, 0.01, 0.0, -0.01, 1.0}, sums[6] = {0.0};
    const double volume = 4.0 / 3.0 * PI * pow(radius, 3);
    points_scene_init(&s, MPI_COMM_WORLD, 0.2, 0);
    s.params.form = CPL_POINTS_PAIRWISE;
    assert_int_equal(points_scene_start(&s, 0, NULL), PART_OK);
    const int n = points_lattice(&s.box, 12, 0.3, &points);
    for (int a = 0; a < n; a++) {
      double *row = points + a * POINT_WIDTH;
      for (int c = 0; c < 3; c++) {
        row[PU + c] = k == 0 ? u[c] : sphere[SV + c];
        row[PP] += k == 1 ? slope[c] * row[c] : 0.0;
      }
      row[PP] += k == 2 ? 1e5 : 0.0;
    }
    points_scene_spheres(&s, 1, sphere, 0);
    points_scene_points(&s, n, points, 0);
    assert_int_equal(cpl_points_locate(s.points, &s.view, &s.fluid_view), PART_OK);
    assert_int_equal(cpl_points_porosity(s.points, &s.fluid_view), PART_OK);
    assert_int_equal(cpl_points_force(s.points, &s.view, &s.fluid_view), PART_OK);
    for (int i = 0; i < s.view.count; i++)
      for (int c = 0; c < 3; c++) {
        const double f = s.sphere[SSU + c] - s.sphere[SSP] * sphere[SV + c];
        const double law = s.sphere[SSP] * (u[c] - sphere[SV + c]);
        s.sphere[SJ + c] = 0.01 * f;
        if (k == 0)
          assert_near(f, law, 0.03 * s.sphere[SSP] * 0.06);
        else if (k == 1)
          assert_near(f, -volume * slope[c], 0.03 * volume * 37.0);
        else
          assert_near(f, 0.0, 1e-12 * volume * 1e5 / s.h);
      }
    assert_int_equal(cpl_points_reaction(s.points, &s.view, &s.fluid_view, 0.01), PART_OK);
    for (int a = 0; a < s.fluid_view.count; a++) {
      const double *row = s.point + a * POINT_WIDTH, *f = row + PF;
      for (int c = 0; c < 3; c++) {
        const int d = (c + 1) % 3, e = (c + 2) % 3;
        sums[c] += (row[d] - sphere[d]) * f[e] - (row[e] - sphere[e]) * f[d];
        sums[3 + c] += fabs(f[c]) * s.h;
      }
    }
    MPI_Allreduce(MPI_IN_PLACE, sums, 6, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
    for (int c = 0; c < 3 && k < 2; c++)
      assert_near(sums[c], 0.0, 1e-12 * (sums[3] + sums[4] + sums[5]));
    free(points);
    points_scene_free(&s);
  }
}

typedef struct result {
  double *eps, *force; /* [points], [points][3] */
  double *su, *error; /* [spheres][4], [1] */
} result;

enum { N = 9, SPHERES = 150 };
static const double still[3] = {0.3, 0.0, -2.0}; /* P.10 */

/* Spheres of all sizes in a shear flow; impulses as particles would receive them, in another order and on other
 * ranks than before. */
static void run(MPI_Comm comm, int form, int walls, result *r) {
  const cpl_points_plane plane[3] = {{{0, 0, 0}, {0, 0, 1}}, {{0, 0, 1}, {0, 0, -1}}, {{0, 0, 0}, {0, 1, 0}}};
  points_scene s;
  double *points, *spheres = calloc(SPHERES * SPHERE_WIDTH, sizeof *spheres);
  uint64_t seed = 77;
  points_scene_init(&s, comm, 0.15, 1);
  for (int k = 0; walls && k < 2; k++)
    s.box.periodic[2 - k] = 0;
  s.params.form = form;
  memcpy(s.params.still, still, sizeof still);
  for (int k = 0; k < cpl_drag_count(); k++)
    if (strcmp(cpl_drag_name(k), "beetstraPolydisperse") == 0)
      s.params.drag = k;
  assert_int_equal(points_scene_start(&s, walls ? 3 : 0, plane), PART_OK);
  const int n = points_lattice(&s.box, N, 0.9, &points);
  for (int a = 0; a < n; a++) {
    double *row = points + a * POINT_WIDTH;
    row[PU] = 0.1 * sin(2.0 * PI * row[1]);
    row[PU + 2] = -0.2;
    for (int c = 0; c < 3; c++)
      row[PA + c] = points_random(&seed) - 0.5;
    row[PP] = 1e3 * (points_random(&seed) - 0.5);
    row[PV] *= 0.9 + 0.2 * points_random(&seed);
  }
  for (int i = 0; i < SPHERES; i++) {
    double *row = spheres + i * SPHERE_WIDTH;
    for (int c = 0; c < 3; c++) {
      row[c] = points_random(&seed);
      row[SV + c] = 0.1 * points_random(&seed);
      row[SJ + c] = points_random(&seed) - 0.3;
    }
    row[SR] = 0.01 + 0.03 * points_random(&seed);
    row[SIM] = 1.0;
  }
  points_scene_spheres(&s, SPHERES, spheres, 3);
  points_scene_points(&s, n, points, 0);
  assert_int_equal(cpl_points_locate(s.points, &s.view, &s.fluid_view), PART_OK);
  assert_int_equal(cpl_points_porosity(s.points, &s.fluid_view), PART_OK);
  assert_int_equal(cpl_points_force(s.points, &s.view, &s.fluid_view), PART_OK);
  double in_fluid = 0.0; /* m3 */
  for (int i = 0; i < s.view.count; i++)
    in_fluid += cpl_points_wet(s.points)[i] * 4.0 / 3.0 * PI * pow(s.sphere[i * SPHERE_WIDTH + SR], 3.0);
  MPI_Allreduce(MPI_IN_PLACE, &in_fluid, 1, MPI_DOUBLE, MPI_SUM, comm);
  points_gather(&s, SPHERES, s.view.count, s.number, 2, s.sphere, SPHERE_WIDTH, SSU, 4, r->su);
  points_scene_spheres(&s, SPHERES, spheres, 1); /* elsewhere */
  for (int i = 0; i < s.view.count / 2; i++) {   /* and in another order */
    const int k = s.view.count - 1 - i;
    double row[SPHERE_WIDTH];
    memcpy(row, s.sphere + i * SPHERE_WIDTH, sizeof row);
    memcpy(s.sphere + i * SPHERE_WIDTH, s.sphere + k * SPHERE_WIDTH, sizeof row);
    memcpy(s.sphere + k * SPHERE_WIDTH, row, sizeof row);
    const int64_t id = s.number[2 * i];
    s.number[2 * i] = s.number[2 * k];
    s.number[2 * k] = id;
  }
  assert_int_equal(cpl_points_reaction(s.points, &s.view, &s.fluid_view, 0.01), PART_OK);
  points_gather(&s, n, s.fluid_view.count, s.point_id, 1, s.point, POINT_WIDTH, PEPS, 1, r->eps);
  points_gather(&s, n, s.fluid_view.count, s.point_id, 1, s.point, POINT_WIDTH, PF, 3, r->force);
  cpl_budget budget;
  assert_int_equal(cpl_points_budget(s.points, &budget), PART_OK);
  for (int c = 0; c < 3; c++) {
    double given = 0.0, taken = 0.0;
    for (int i = 0; i < SPHERES; i++)
      given += spheres[i * SPHERE_WIDTH + SJ + c];
    given += 0.01 * s.fluid.density * in_fluid * still[c];
    for (int a = 0; a < n; a++)
      taken -= 0.01 * r->force[3 * a + c];
    assert_near(taken, given, 1e-12 * SPHERES);
    assert_near(budget.particles[c], given, 1e-12 * SPHERES);
  }
  r->error[0] = budget.error;
  free(points);
  free(spheres);
  points_scene_free(&s);
}

static void make(result *r) {
  r->eps = calloc(N * N * N, sizeof(double));
  r->force = calloc(3 * N * N * N, sizeof(double));
  r->su = calloc(4 * SPHERES, sizeof(double));
  r->error = calloc(1, sizeof(double));
}

static void compare(const double *a, const double *b, int n, double tolerance) {
  double most = 0.0;
  for (int k = 0; k < n; k++)
    most = fmax(most, fabs(b[k]));
  assert_true(most > 0.0);
  for (int k = 0; k < n; k++)
    assert_near(a[k], b[k], tolerance * most);
}

/* Momentum closes to round-off; one and several ranks agree to round-off. */
static void test_ranks(void **state) {
  (void)state;
  result here, one;
  make(&here);
  make(&one);
  for (int form = 0; form < 3; form++)
    for (int walls = 0; walls < (form == CPL_POINTS_PAIRWISE ? 1 : 2); walls++) {
      run(MPI_COMM_WORLD, form, walls, &here);
      run(MPI_COMM_SELF, form, walls, &one);
      assert_true(here.error[0] < 1e-13);
      compare(here.eps, one.eps, N * N * N, 1e-13);
      compare(here.force, one.force, 3 * N * N * N, 1e-12);
      compare(here.su, one.su, 4 * SPHERES, 1e-12);
    }
  double *all[] = {here.eps, here.force, here.su, here.error, one.eps, one.force, one.su, one.error};
  for (int k = 0; k < 8; k++)
    free(all[k]);
}

/* Fluid below z = 0.5: a sphere deep in it feels all of its buoyancy, one above none, between grows. */
static void test_surface(void **state) {
  (void)state;
  points_scene s;
  double *points, last = 2.0;
  points_scene_init(&s, MPI_COMM_WORLD, 0.08, 1);
  s.box.periodic[2] = 0;
  const cpl_points_plane floor = {{0, 0, 0}, {0, 0, 1}};
  assert_int_equal(points_scene_start(&s, 1, &floor), PART_OK);
  const int n = points_lattice(&s.box, 20, 0.0, &points) / 2;
  for (int k = 0; k < 20; k++) {
    double sphere[SPHERE_WIDTH] = {0.5, 0.5, 0.02 + 0.04 * k, 0.01, 0, 0, 0, 1.0};
    points_scene_spheres(&s, 1, sphere, k);
    points_scene_points(&s, n, points, 0);
    assert_int_equal(cpl_points_locate(s.points, &s.view, &s.fluid_view), PART_OK);
    assert_int_equal(cpl_points_porosity(s.points, &s.fluid_view), PART_OK);
    assert_int_equal(cpl_points_force(s.points, &s.view, &s.fluid_view), PART_OK);
    double wet = s.view.count > 0 ? cpl_points_wet(s.points)[0] : 0.0;
    MPI_Allreduce(MPI_IN_PLACE, &wet, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
    assert_true(wet <= last + 1e-12);
    if (sphere[2] < 0.37) /* beside the floor too */
      assert_near(wet, 1.0, 0.0);
    if (sphere[2] > 0.68)
      assert_near(wet, 0.0, 0.0);
    for (int i = 0; i < s.view.count; i++)
      assert_near(s.sphere[SSU + 2], wet * 4.0 / 3.0 * PI * 1e-6 * 9810.0, 1e-12);
    last = wet;
  }
  free(points);
  points_scene_free(&s);
}

/* A sphere at rest in a fluid that creeps with u, whose steady drag so far was f: P.11 adds f sqrt(2/pi)/(6 pi mu s0) to the
 * velocity it feels, its drag is that in clear fluid, not in one of the porosity 0.995 that its own volume makes, and after a step of dt each memory is the mean of f and the new drag over its time. */
static void test_disturbance(void **state) {
  (void)state;
  const double radius = 0.03, f = -1e-7, dt = 1e-3, drag = 0.7;
  points_scene s;
  double *points, memory[3 * CPL_MEMORY_VECTORS] = {0.0};
  double sphere[SPHERE_WIDTH] = {0.5, 0.5, 0.5, radius};
  points_scene_init(&s, MPI_COMM_SELF, 0.15, 1);
  s.params.self_disturbance = 1;
  s.params.form = CPL_POINTS_GRADIENT;
  assert_int_equal(points_scene_start(&s, 0, NULL), PART_ERR_RANGE);
  s.params.form = CPL_POINTS_COMBINED;
  assert_int_equal(points_scene_start(&s, 0, NULL), PART_OK);
  const int n = points_lattice(&s.box, 12, 0.0, &points);
  points_scene_spheres(&s, 1, sphere, 0);
  points_scene_points(&s, n, points, 0);
  assert_int_equal(cpl_points_locate(s.points, &s.view, &s.fluid_view), PART_OK);
  assert_int_equal(cpl_points_porosity(s.points, &s.fluid_view), PART_OK);
  assert_int_equal(cpl_points_force(s.points, &s.view, &s.fluid_view), PART_ERR_ARGUMENT);
  s.view.memory = memory;
  s.view.memory_stride = 3 * CPL_MEMORY_VECTORS;
  for (int k = 0; k < CPL_MEMORY_VECTORS; k++)
    memory[3 * k] = f;
  assert_int_equal(cpl_points_force(s.points, &s.view, &s.fluid_view), PART_OK);
  const double variance = 4.0 / 15.0 * 0.15 * 0.15 + 0.2 * radius * radius, s0 = sqrt(2.0 * variance);
  const double volume = 4.0 / 3.0 * PI * radius * radius * radius;
  const double alone = volume / pow(2.0 * PI * s0 * s0, 1.5) / (1.0 - cpl_points_sampled_eps(s.points)[0]);
  const double w = fmin(alone, 1.0) * f * sqrt(2.0 / PI) / (6.0 * PI * s.fluid.viscosity * s0);
  assert_true(alone > 0.9);
  assert_near(cpl_points_sampled_velocity(s.points)[0], w, 3e-3 * fabs(w));
  assert_near(cpl_points_sampled_velocity(s.points)[1], 0.0, 1e-12 * fabs(w));
  const double rho = s.fluid.density, mu = s.fluid.viscosity, sampled = cpl_points_sampled_eps(s.points)[0];
  const double around = alone < 1.0 ? sampled + alone * alone * (1.0 - sampled) : 1.0;
  const double clear = cpl_drag_function(s.params.drag)(fabs(w), 2.0 * radius, around, rho, mu, 2.0 * radius) / around;
  assert_true(1.0 - around < 0.1 * (1.0 - sampled));
  assert_near(*s.view.fluid_sp, clear, 2e-3 * clear);
  for (int c = 0; c < 3; c++)
    s.sphere[SJ + c] = -s.fluid.density * volume * s.fluid.gravity[c] * dt + (c == 1 ? drag * dt : 0.0);
  assert_int_equal(cpl_points_reaction(s.points, &s.view, &s.fluid_view, dt), PART_OK);
  for (int k = 0; k < CPL_MEMORY_VECTORS; k++) {
    const double left = exp(-dt * s.fluid.viscosity / s.fluid.density / variance / (0.002 * pow(7.0, k)));
    assert_near(memory[3 * k], left * f, 1e-9 * fabs(f));
    assert_near(memory[3 * k + 1], (1.0 - left) * drag, 1e-9);
    assert_near(memory[3 * k + 2], 0.0, 1e-9);
  }
  free(points);
  points_scene_free(&s);
}

static void test_errors(void **state) {
  (void)state;
  points_scene s;
  const cpl_points_plane floor = {{0, 0, 0}, {0, 0, 1}};
  points_scene_init(&s, MPI_COMM_WORLD, 0.15, 0);
  s.params.form = CPL_POINTS_PAIRWISE;
  assert_int_equal(points_scene_start(&s, 1, &floor), PART_ERR_ARGUMENT);
  assert_non_null(strstr(part_last_error(), "form pairwise has no planes"));
  double *points, *spheres;
  points_scene_init(&s, MPI_COMM_WORLD, 0.15, 0);
  assert_int_equal(points_scene_start(&s, 0, NULL), PART_OK);
  const int n = points_lattice(&s.box, 6, 0.0, &points);
  const int m = spheres_lattice(&s.box, 4, 0.02, &spheres);
  points_scene_spheres(&s, m, spheres, 0);
  points_scene_points(&s, n, points, 0);
  assert_int_equal(cpl_points_force(s.points, &s.view, &s.fluid_view), PART_ERR_STATE);
  assert_int_equal(cpl_points_locate(s.points, &s.view, &s.fluid_view), PART_OK);
  assert_int_equal(cpl_points_reaction(s.points, &s.view, &s.fluid_view, 0.1), PART_ERR_STATE);
  assert_int_equal(cpl_points_porosity(s.points, &s.fluid_view), PART_OK);
  assert_int_equal(cpl_points_force(s.points, &s.view, &s.fluid_view), PART_OK);
  assert_int_equal(cpl_points_reaction(s.points, &s.view, &s.fluid_view, -1.0), PART_ERR_RANGE);
  double step;
  assert_int_equal(cpl_points_stable_step(s.points, &step), PART_OK);
  s.number[0] += 1000;
  assert_int_equal(cpl_points_force(s.points, &s.view, &s.fluid_view), PART_ERR_STATE);
  free(points);
  free(spheres);
  points_scene_free(&s);
}

int main(int argc, char **argv) {
  MPI_Init(&argc, &argv);
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_law), cmocka_unit_test(test_pairwise), cmocka_unit_test(test_ranks),
                                     cmocka_unit_test(test_surface), cmocka_unit_test(test_disturbance),
                                     cmocka_unit_test(test_errors)};
  cmocka_set_message_output(CM_OUTPUT_TAP);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
