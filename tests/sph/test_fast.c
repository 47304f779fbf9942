/* ranks: 1 2 3 4 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The same scene by the plain loops and by the vector loops, with and without what the plan leaves
 * out, and on any number of ranks: equal to round-off. */
#include "common.h"

enum { NX = 10, NY = 8, NZ = 9, N = NX * NY * NZ };

typedef struct variant {
  int kernel, viscosity, scheme, density, porous, width, skip, extra;
} variant;

static scene tank(const variant *v) {
  const double length[3] = {0.1, 0.08, 0.11};
  scene s = scene_3d(length, 0.01);
  s.box.periodic[0] = 1;
  s.params.kernel = v->kernel;
  s.params.smoothing_length = v->kernel == SPH_KERNEL_quintic_spline ? 0.0125 : 0.015;
  s.params.skin_fraction = 0.05;
  s.params.viscosity = 0.5;
  s.params.viscosity_model = v->viscosity;
  s.params.time_scheme = v->scheme;
  s.params.density_scheme = v->density;
  s.params.gravity[2] = v->density == SPH_SUMMATION ? 0.0 : -9.81;
  s.params.artificial_viscosity = 0.05;
  s.params.xsph = v->density == SPH_SUMMATION ? 0.0 : 0.2;
  s.params.skip = v->skip;
  if (v->extra == 2) {
    s.params.variable_smoothing = 1;
    s.params.largest_smoothing = 1.1;
    s.box.periodic[1] = v->density == SPH_SUMMATION;
  }
  if (v->extra == 1) {
    s.params.shifting = 2.0;
    s.params.artificial_pressure = 0.2;
    s.params.anti_clump = 0.01;
    s.params.gradient_correction = 1;
  }
  if (v->density == SPH_SUMMATION) {
    s.box.hi[2] = 0.09;
    s.box.periodic[2] = 1;
  }
  return s;
}

static void run(const variant *v, MPI_Comm comm, body *bodies, sph_report *report) {
  scene s = tank(v);
  s.comm = comm;
  sph_t *sph = scene_create(&s);
  sph_view view;
  double eps[N];
  if (!s.box.periodic[1])
    add_planes(sph, &s, 1, SPH_NO_SLIP);
  if (v->density == SPH_CONTINUITY)
    add_planes(sph, &s, 2, SPH_FREE_SLIP);
  fill_water(sph, &s, 0.09, 2);
  stir(sph, &s, 0.2);
  OK(sph_limit_width(sph, v->width));
  OK(sph_start(sph));
  OK(sph_get_view(sph, &view));
  for (int i = 0; i < view.own; i++)
    eps[i] = v->porous ? 0.8 + 1.5 * view.position[view.xv_stride * i + 1] : 1.0;
  OK(sph_displace(sph, eps));
  for (int i = 0; i < view.own && v->porous; i++) {
    view.eps_rate[view.force_stride * i] = 0.3;
    view.eps_gradient[view.force_stride * i + 1] = 1.5;
  }
  OK(sph_advance(sph, 6e-3, NULL));
  OK(sph_advance(sph, 6e-3, NULL));
  OK(sph_get_report(sph, report));
  assert_true(report->steps > 5);
  assert_true(report->rebuilds > 1);
  CLOSE(report->budget_error, 0.0, 1e-12);
  find_all(sph, comm, 0, N, bodies);
  sph_destroy(sph);
}

/* Velocities of 0.2 m/s and accelerations of some 100 m/s2; rounding grows in moving water. more:
 * how much more than rounding is allowed. */
static void same(const body *a, const body *b, double more) {
  for (int k = 0; k < N; k++)
    for (int c = 0; c < 3; c++) {
      CLOSE(a[k].v[c], b[k].v[c], 1e-11 * more);
      CLOSE(a[k].a[c], b[k].a[c], 1e-8 * more);
      CLOSE(a[k].density, b[k].density, 1e-8 * more);
      CLOSE(b[k].count, 1.0, 0.0);
    }
}

static const variant variants[] = {
    {SPH_KERNEL_wendland_c2, SPH_MORRIS, SPH_SYMPLECTIC, SPH_CONTINUITY, 0, 1, 1, 0},
    {SPH_KERNEL_cubic_spline, SPH_MONAGHAN, SPH_PREDICTOR_CORRECTOR, SPH_CONTINUITY, 1, 1, 1, 0},
    {SPH_KERNEL_quintic_spline, SPH_MORRIS, SPH_SYMPLECTIC, SPH_SUMMATION, 0, 1, 1, 0},
    {SPH_KERNEL_wendland_c4, SPH_MONAGHAN, SPH_SYMPLECTIC, SPH_CONTINUITY, 1, 1, 1, 0},
    {SPH_KERNEL_cubic_spline, SPH_MORRIS, SPH_PREDICTOR_CORRECTOR, SPH_SUMMATION, 1, 1, 1, 0},
    {SPH_KERNEL_wendland_c2, SPH_MORRIS, SPH_SYMPLECTIC, SPH_CONTINUITY, 1, 1, 1, 1},
    {SPH_KERNEL_cubic_spline, SPH_MORRIS, SPH_PREDICTOR_CORRECTOR, SPH_CONTINUITY, 1, 1, 1, 1},
    {SPH_KERNEL_wendland_c2, SPH_MORRIS, SPH_SYMPLECTIC, SPH_CONTINUITY, 1, 1, 1, 2},
    {SPH_KERNEL_wendland_c4, SPH_MONAGHAN, SPH_SYMPLECTIC, SPH_CONTINUITY, 0, 1, 1, 2},
    {SPH_KERNEL_wendland_c2, SPH_MORRIS, SPH_SYMPLECTIC, SPH_SUMMATION, 1, 1, 1, 2},
};
/* ... and, as the last ones, with a smoothing length for each particle (S.26) */
enum { VARIANTS = sizeof variants / sizeof variants[0] };

static void widths(void **state) {
  (void)state;
  static body a[N], b[N];
  sph_report report;
  for (int k = 0; k < VARIANTS; k++) {
    variant v = variants[k];
    run(&v, MPI_COMM_WORLD, a, &report);
    for (v.width = 4; v.width <= 8; v.width += 4) {
      run(&v, MPI_COMM_WORLD, b, &report);
      same(a, b, 1.0);
    }
  }
}

/* Walls by table or by points: the table is interpolated to 1e-7 of the walls' part, which is 1e4
 * times rounding. */
static void skip_off(void **state) {
  (void)state;
  static body a[N], b[N];
  sph_report report;
  for (int k = 0; k < VARIANTS; k++) {
    variant v = variants[k];
    v.width = 0;
    run(&v, MPI_COMM_WORLD, a, &report);
    v.skip = 0;
    run(&v, MPI_COMM_WORLD, b, &report);
    same(a, b, 1e4);
  }
}

/* Each rank runs the whole for itself, too; on one rank the two are the same bits. */
static void ranks(void **state) {
  (void)state;
  static body a[N], b[N];
  sph_report here, there;
  for (int k = 0; k < VARIANTS; k++) {
    variant v = variants[k];
    v.width = 0;
    run(&v, MPI_COMM_WORLD, a, &here);
    run(&v, MPI_COMM_SELF, b, &there);
    same(a, b, 1.0);
    assert_int_equal(here.steps, there.steps);
    assert_int_equal(here.particles, there.particles);
    CLOSE(here.kinetic_energy, there.kinetic_energy, 1e-11 * there.kinetic_energy);
    for (int c = 0; c < 3; c++)
      CLOSE(here.wall_impulse[c], there.wall_impulse[c], 1e-10);
  }
}

static void plan_text(void **state) {
  (void)state;
  const variant v = variants[0];
  scene s = tank(&v);
  char text[2000], little[20];
  sph_t *sph = scene_create(&s);
  FAILS(PART_ERR_STATE, "sph_start", sph_plan_text(sph, sizeof text, text));
  fill_water(sph, &s, 0.09, 2);
  OK(sph_start(sph));
  OK(sph_plan_text(sph, sizeof text, text));
  assert_non_null(strstr(text, "eps of partners | eps is 1 everywhere |"));
  assert_non_null(strstr(text, "walls | there are none |"));
  FAILS(PART_ERR_RANGE, "20 characters", sph_plan_text(sph, sizeof little, little));
  FAILS(PART_ERR_RANGE, "width 3", sph_limit_width(sph, 3));
  sph_destroy(sph);
}

/* On several ranks only what compares them with one. */
int main(int argc, char **argv) {
  const struct CMUnitTest one[] = {
      cmocka_unit_test(widths),
      cmocka_unit_test(skip_off),
      cmocka_unit_test(plan_text),
  };
  const struct CMUnitTest any[] = {cmocka_unit_test(ranks)};
  MPI_Init(&argc, &argv);
  int failed = cmocka_run_group_tests(any, NULL, NULL);
  if (world_size() == 1)
    failed += cmocka_run_group_tests(one, NULL, NULL);
  MPI_Finalize();
  return failed;
}
