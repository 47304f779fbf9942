/* ranks: 1 2 3 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lubrication between two spheres or discs in closed form; many of them: momentum, energy, ranks,
 * restart, vector path; bad input. */
#include "common.h"

#include "../../libdem/src/fast.h"

static const double mu = 0.01, inner = 1e-6;

static dem_lubrication film(void) {
  dem_lubrication f;
  part_params_default(&dem_lubrication_table, &f);
  f.viscosity = mu;
  f.inner_gap = inner;
  return f;
}

/* Two bodies need no more than one rank: every rank computes its own. */
static scene stiff(int flat) {
  scene s = scene_default();
  s.comm = MPI_COMM_SELF;
  s.contact.restitution = 0.8;
  s.params.dimensions = flat ? 2 : 3;
  s.params.depth = flat ? 0.02 : 0.0;
  return s;
}

static double mass(const scene *s, double r) {
  return s->params.dimensions == 2 ? s->density * PI * r * r * s->params.depth
                                   : sphere_mass(s->density, r);
}

/* Two on the x axis with a gap, the first with a velocity. */
static dem_t *two(const scene *s, double r1, double r2, double gap, double v) {
  const double x1[3] = {0.0, 0.0, 0.0}, x2[3] = {r1 + r2 + gap, 0.0, 0.0},
               rest[3] = {0.0, 0.0, 0.0};
  const double v1[3] = {v, 0.0, 0.0};
  const dem_lubrication f = film();
  dem_t *dem = scene_create(s);
  OK(dem_set_lubrication(dem, &f));
  add_sphere(dem, DEM_FREE, -1, x1, r1, v1);
  add_sphere(dem, DEM_FREE, -1, x2, r2, rest);
  OK(dem_start(dem));
  return dem;
}

static double closing(dem_t *dem, const scene *s) {
  return find(dem, s->comm, 0).v[0] - find(dem, s->comm, 1).v[0];
}
static double gap_now(dem_t *dem, const scene *s, double reach) {
  return find(dem, s->comm, 1).x[0] - find(dem, s->comm, 0).x[0] - reach;
}

/* Integral of lambda over the gap from h to h0, h0 below the cut-off, h above the inner gap. */
static double lost(const scene *s, double r1, double r2, double h0, double h) {
  const double R = r1 * r2 / (r1 + r2);
  if (s->params.dimensions == 2)
    return 6.0 * sqrt(2.0) * PI * mu * s->params.depth * pow(R, 1.5) *
           (1.0 / sqrt(h) - 1.0 / sqrt(h0));
  return 6.0 * PI * mu * R * R * log(h0 / h);
}

/* Coasting: m_eff dv = -lambda dh, so that v falls by the integral of lambda over m_eff; beyond the
 * cut-off, at the harmonic mean diameter 4 R, it does not. Equal and unequal, spheres and discs. */
static void coasting(void **state) {
  (void)state;
  for (int flat = 0; flat < 2; flat++)
    for (int unequal = 0; unequal < 2; unequal++) {
      const scene s = stiff(flat);
      const double r1 = 0.005, r2 = unequal ? 0.015 : r1, v0 = 0.2;
      const double cut = 4.0 * r1 * r2 / (r1 + r2);
      dem_t *dem = two(&s, r1, r2, 1.5 * cut, v0);
      const double m = 1.0 / (1.0 / mass(&s, r1) + 1.0 / mass(&s, r2));
      dem_report report;
      int substeps;
      OK(dem_advance(dem, 0.01 * r1 / v0, &substeps));
      assert_int_equal(substeps, 1); /* no force can begin before the end */
      OK(dem_advance(dem, 0.45 * cut / v0, &substeps));
      CLOSE(closing(dem, &s), v0, 1e-15);
      double h = cut;
      for (int k = 0; k < 4; k++) {
        const double at = h;
        OK(dem_advance(dem, (k == 0 ? 0.3 : 0.5) * at / v0, &substeps));
        h = gap_now(dem, &s, r1 + r2);
        /* First order in the step: the velocity is that of half a step ago. */
        const double loss = lost(&s, r1, r2, cut, h) / m;
        CLOSE(v0 - closing(dem, &s), loss, 3e-3 * loss);
      }
      assert_true(substeps > 10 && v0 - closing(dem, &s) > 1e-4 * v0);
      OK(dem_get_report(dem, &report));
      CLOSE(report.momentum[0], mass(&s, r1) * v0, 1e-14 * mass(&s, r1));
      dem_destroy(dem);
    }
}

/* Pressed together by F in a thick fluid: 6 pi mu R^2 dh/dt = -F h, h = h0 exp(-F t/(6 pi mu R^2)).
 */
static void pressed(void **state) {
  (void)state;
  scene s = stiff(0);
  const double r = 0.005, R = 0.5 * r, F = 1e-2, h0 = 2e-4;
  const double x1[3] = {0.0, 0.0, 0.0}, x2[3] = {2.0 * r + h0, 0.0, 0.0};
  dem_lubrication f = film();
  f.viscosity = 10.0;
  s.contact.normal_stiffness = 1e6;
  dem_t *dem = scene_create(&s);
  OK(dem_set_lubrication(dem, &f));
  add_sphere(dem, DEM_FREE, -1, x1, r, x1);
  add_sphere(dem, DEM_FREE, -1, x2, r, x1);
  OK(dem_start(dem));
  const double T = 6.0 * PI * f.viscosity * R * R / F;
  part_store *store = dem_store(dem);
  for (int i = 0; i < store->local; i++) {
    const int64_t id =
        part_field_int64(store, DEM_FIELD_ID)[i * part_field_stride(store, DEM_FIELD_ID)];
    part_field_double(store, DEM_FIELD_FLUID_SU)[i * part_field_stride(store, DEM_FIELD_FLUID_SU)] =
        id == 0 ? F : -F;
  }
  OK(dem_advance(dem, 0.05 * T, NULL)); /* from rest: relaxation m h/(12 pi mu R^2) = 1e-3 T */
  const double from = gap_now(dem, &s, 2.0 * r);
  OK(dem_advance(dem, 2.0 * T, NULL));
  CLOSE(gap_now(dem, &s, 2.0 * r) / from, exp(-2.0), 2e-3 * exp(-2.0));
  dem_destroy(dem);
}

/* Impact and rebound through the film: on the way in v falls by (ln(cut/inner) + 1) K/m, K = 6 pi
 * mu R^2, the 1 of the gap below innerGap; the contact restitutes as without fluid; on the way out
 * the same is lost again. */
static void rebound(void **state) {
  (void)state;
  scene s = stiff(0);
  const double r = 0.005, R = 0.5 * r, v0 = 0.5, cut = 2.0 * r;
  s.params.time_step_fraction = 0.002;
  dem_t *dem = two(&s, r, r, 1.1 * cut, v0);
  const double loss = 6.0 * PI * mu * R * R * (log(cut / inner) + 1.0) / (0.5 * mass(&s, r));
  const double wanted = s.contact.restitution * (v0 - loss) - loss;
  OK(dem_advance(dem, 0.1, NULL));
  assert_true(loss > 0.02 * v0 && gap_now(dem, &s, 2.0 * r) > cut);
  CLOSE(-closing(dem, &s), wanted, 2e-3 * v0);
  dem_destroy(dem);
}

/* ---- many ---------------------------------------------------------------------------------------
 */
enum { N = 150 };
static const double length = 0.06;

static dem_t *many_without_particles(MPI_Comm comm, double viscosity) {
  scene s = stiff(0);
  dem_lubrication f = film();
  f.viscosity = viscosity;
  f.cut_off = 0.4;
  for (int c = 0; c < 3; c++) {
    s.box.lo[c] = 0.0;
    s.box.hi[c] = length;
    s.box.periodic[c] = c < 2;
  }
  s.comm = comm;
  s.contact.friction = 0.3;
  s.contact.normal_stiffness = 2e3;
  dem_t *dem = scene_create(&s);
  OK(dem_set_lubrication(dem, &f));
  return dem;
}

static dem_t *many(MPI_Comm comm, double viscosity, int width) {
  dem_t *dem = many_without_particles(comm, viscosity);
  const double from[3] = {0.0, 0.0, 0.0};
  const dem_insert insert = random_spheres(N, 0.006, 0.01, from, length, 4);
  OK(dem_insert_particles(dem, &insert, -1, NULL));
  OK(dem_fast_limit(dem, width));
  OK(dem_start(dem));
  stir(dem, 0.5);
  return dem;
}

/* A viscosity far beyond what a step can take: still energy only falls, and momentum stays. */
static void thick(void **state) {
  (void)state;
  static const double viscosity[] = {0.05, 5.0, 5e4};
  for (int k = 0; k < 3; k++) {
    dem_t *dem = many(MPI_COMM_WORLD, viscosity[k], 0);
    dem_report before, now;
    OK(dem_get_report(dem, &before));
    double energy = before.kinetic_energy, first = energy;
    for (int n = 0; n < 20; n++) {
      OK(dem_advance(dem, 10.0 * dem_stable_step(dem), NULL));
      OK(dem_get_report(dem, &now));
      /* What contacts hold for a while may come back: below 1e-3 of the start. */
      assert_true(now.kinetic_energy <= energy + 1e-3 * first);
      energy = now.kinetic_energy;
      CLOSE(now.budget_error, 0.0, 1e-12);
    }
    assert_true(energy < 0.95 * first);
    dem_destroy(dem);
  }
}

static void compare(const body *a, const body *b) {
  for (int k = 0; k < N; k++)
    for (int c = 0; c < 3; c++) {
      const double d = fabs(a[k].x[c] - b[k].x[c]);
      CLOSE(fmin(d, fabs(d - length)), 0.0, 1e-11);
      CLOSE(a[k].v[c], b[k].v[c], 1e-9);
    }
}

/* All ranks against one, the vector path against the plain one. */
static void ranks_and_paths(void **state) {
  (void)state;
  static body all[N], other[N];
  dem_t *dem = many(MPI_COMM_WORLD, 0.1, 0);
  OK(dem_advance(dem, 0.02, NULL));
  find_all(dem, MPI_COMM_WORLD, N, all);
  dem_destroy(dem);
  dem = many(MPI_COMM_SELF, 0.1, 0);
  OK(dem_advance(dem, 0.02, NULL));
  find_all(dem, MPI_COMM_SELF, N, other);
  compare(all, other);
  dem_destroy(dem);
  dem = many(MPI_COMM_WORLD, 0.1, 1);
  OK(dem_advance(dem, 0.02, NULL));
  find_all(dem, MPI_COMM_WORLD, N, other);
  compare(all, other);
  dem_destroy(dem);
}

static void restart(void **state) {
  (void)state;
  static body here[N], there[N];
  char path[300];
  const char *folder = getenv("TMPDIR");
  snprintf(path, sizeof path, "%s/dem-film-%d.vtkhdf", folder != NULL ? folder : "/tmp",
           world_size());
  dem_t *one = many(MPI_COMM_WORLD, 0.1, 0);
  OK(dem_advance(one, 0.01, NULL));
  OK(dem_write(one, path, NULL));
  dem_t *two_ = many_without_particles(MPI_COMM_WORLD, 0.1);
  OK(dem_read(two_, path));
  OK(dem_start(two_));
  OK(dem_advance(one, 0.01, NULL));
  OK(dem_advance(two_, 0.01, NULL));
  find_all(one, MPI_COMM_WORLD, N, here);
  find_all(two_, MPI_COMM_WORLD, N, there);
  assert_memory_equal(here, there, sizeof here);
  dem_destroy(one);
  dem_destroy(two_);
  MPI_Barrier(MPI_COMM_WORLD);
  if (world_rank() == 0)
    remove(path);
}

static void bad_input(void **state) {
  (void)state;
  static const struct {
    const char *entry;
    double value;
  } list[] = {{"viscosity", 0.0},  {"viscosity", -1.0}, {"innerGap", 0.0},
              {"innerGap", -1e-6}, {"cutOff", 0.0},     {"cutOff", 11.0}};
  dem_lubrication f = film(), none;
  part_params_default(&dem_lubrication_table, &none);
  for (size_t k = 0; k < sizeof list / sizeof *list; k++)
    FAILS(PART_ERR_RANGE, list[k].entry,
          part_params_set(&dem_lubrication_table, list[k].entry, &list[k].value, NULL, &f));
  const scene s = stiff(0);
  const double x[3] = {0.0, 0.0, 0.0}, y[3] = {0.1, 0.0, 0.0};
  dem_t *dem = scene_create(&s);
  FAILS(PART_ERR_ARGUMENT, "entry viscosity is missing", dem_set_lubrication(dem, &none));
  none.viscosity = 1.0;
  FAILS(PART_ERR_ARGUMENT, "entry innerGap is missing", dem_set_lubrication(dem, &none));
  f.inner_gap = 0.02;
  OK(dem_set_lubrication(dem, &f));
  FAILS(PART_ERR_ARGUMENT, "given twice", dem_set_lubrication(dem, &f));
  add_sphere(dem, DEM_FREE, -1, x, 0.005, x);
  add_sphere(dem, DEM_FREE, -1, y, 0.005, x);
  FAILS(PART_ERR_RANGE, "must be below cutOff times the smallest diameter", dem_start(dem));
  dem_destroy(dem);
  dem = two(&s, 0.005, 0.005, 0.1, 0.0);
  FAILS(PART_ERR_STATE, "before dem_start", dem_set_lubrication(dem, &f));
  dem_destroy(dem);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(coasting),  cmocka_unit_test(pressed),         cmocka_unit_test(rebound),
      cmocka_unit_test(thick),     cmocka_unit_test(ranks_and_paths), cmocka_unit_test(restart),
      cmocka_unit_test(bad_input),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
