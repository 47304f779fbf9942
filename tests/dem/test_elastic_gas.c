/* timeout: 7200 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Elastic spheres in a periodic box over many collisions: energy does not drift, momentum stays to
 * round-off, nothing is lost. GAS_PARTICLES and GAS_STEPS in the environment make it longer
 * (tests/validation/long_elastic_gas).
 *
 * Over 1e6 steps of a dense gas the default step t_c/50 is too coarse for this: 1.0e-4 with the
 * linear law. The ends of a contact are placed with the velocity of the pair, and what a third body
 * does to it in the same step is not seen (doc/equations.md D.5). */
#include "common.h"

enum { SAMPLES = 50 };
static const double diameter = 0.01, stiffness = 1e5;

static int from_environment(const char *name, int otherwise) {
  const char *text = getenv(name);
  return text ? atoi(text) : otherwise;
}

typedef struct gas {
  dem_t *dem;
  int n, law;
  double length, dt;
} gas;

/* Diameters from 2/3 of the largest; solid: part of the volume; fraction: step over t_c. */
static gas start(int law, int n, double solid, double fraction) {
  gas g = {.n = n, .law = law};
  scene s = scene_with_law(law);
  const double mean_cube = (1.0 - 16.0 / 81.0) / (4.0 / 3.0); /* of uniform 2/3 .. 1 */
  g.length = diameter * cbrt(n * PI / 6.0 * mean_cube / solid);
  s.comm = MPI_COMM_SELF;
  s.contact.normal_stiffness = law == LINEAR ? stiffness : (double)NAN;
  s.params.time_step_fraction = fraction;
  s.params.impact_speed = law == LINEAR ? 0.0 : 3.0; /* twice the component below: the hardest */
  for (int c = 0; c < 3; c++) {
    s.box.lo[c] = 0.0;
    s.box.hi[c] = g.length;
    s.box.periodic[c] = 1;
  }
  g.dem = scene_create(&s);
  dem_insert insert = random_spheres(n, diameter * 2.0 / 3.0, diameter, s.box.lo, g.length, 5);
  OK(dem_insert_particles(g.dem, &insert, -1, NULL));
  OK(dem_start(g.dem));
  stir(g.dem, 1.0);
  g.dt = dem_stable_step(g.dem);
  return g;
}

typedef struct ball {
  double x[3], v[3], r, w; /* w: 1/m */
  int64_t id;
} ball;

static int by_x(const void *a, const void *b) {
  const double x = ((const ball *)a)->x[0], y = ((const ball *)b)->x[0];
  return (x > y) - (x < y);
}

/* All particles, in the box, by x. Every id once and nothing outside by more than the skin. */
static ball *balls_of(const gas *g) {
  const part_store *store = dem_store(g->dem);
  const int fields[] = {DEM_FIELD_POSITION, DEM_FIELD_VELOCITY, DEM_FIELD_RADIUS,
                        DEM_FIELD_INVERSE_MASS};
  const int64_t *id = part_field_int64(store, DEM_FIELD_ID);
  const int step = part_field_stride(store, DEM_FIELD_ID);
  ball *balls = calloc((size_t)g->n, sizeof *balls);
  char *seen = calloc((size_t)g->n, 1);
  assert_int_equal(store->local, g->n);
  for (int i = 0; i < g->n; i++) {
    double *to[] = {balls[i].x, balls[i].v, &balls[i].r, &balls[i].w};
    for (int f = 0; f < 4; f++)
      memcpy(to[f], part_field_double(store, fields[f]) + i * part_field_stride(store, fields[f]),
             (f < 2 ? 3 : 1) * sizeof(double));
    balls[i].id = id[step * i];
    assert_in_range(balls[i].id, 0, (uintmax_t)g->n - 1);
    assert_false(seen[balls[i].id]++);
    for (int c = 0; c < 3; c++) {
      assert_true(fabs(balls[i].x[c] - 0.5 * g->length) < 0.5 * g->length + diameter);
      balls[i].x[c] -= g->length * floor(balls[i].x[c] / g->length);
    }
  }
  free(seen);
  qsort(balls, (size_t)g->n, sizeof *balls, by_x);
  return balls;
}

/* Energy of two that touch, with what the step adds to it: of velocity Verlet the energy
 *   T + V + dt^2 (V'' v_n^2/12 - V'^2/(24 m))
 * is kept to the next order (backward error analysis: Hairer, Lubich and Wanner, Geometric
 * Numerical Integration, 2006, ch. IX); for a linear spring this is the exact invariant. */
static double pair_energy(const gas *g, const ball *a, const ball *b) {
  double n[3], d2 = 0.0, v_n = 0.0;
  for (int c = 0; c < 3; c++) {
    n[c] = a->x[c] - b->x[c];
    n[c] -= g->length * floor(n[c] / g->length + 0.5);
    d2 += n[c] * n[c];
  }
  const double reach = a->r + b->r, d = sqrt(d2), deep = reach - d;
  if (!(deep > 0.0))
    return 0.0;
  for (int c = 0; c < 3; c++)
    v_n += (a->v[c] - b->v[c]) * n[c] / d;
  /* As scene_with_law: E = 2e8 Pa, nu = 0.3. */
  const double k = g->law == LINEAR
                       ? stiffness
                       : 4.0 / 3.0 * 0.5 * 2e8 / (1.0 - 0.09) * sqrt(a->r * b->r / reach);
  const double p = g->law == LINEAR ? 1.0 : 1.5, force = k * pow(deep, p);
  return force * deep / (p + 1.0) +
         g->dt * g->dt * (p * force / deep * v_n * v_n / 12.0 - force * force * (a->w + b->w) / 24);
}

static double energy(const gas *g) {
  ball *balls = balls_of(g);
  double sum = 0.0;
  for (int i = 0; i < g->n; i++) {
    const ball *a = &balls[i];
    for (int c = 0; c < 3; c++)
      sum += 0.5 * a->v[c] * a->v[c] / a->w;
    for (int k = 1; k < g->n; k++) {
      const ball *b = &balls[(i + k) % g->n];
      const double x = b->x[0] - a->x[0] + (i + k >= g->n ? g->length : 0.0);
      if (x > diameter)
        break;
      sum += pair_energy(g, a, b);
    }
  }
  free(balls);
  return sum;
}

/* The number of contacts settles in the first steps. With each of a linear spring goes a bit of
 * energy that is lent where its force begins with a kink, and given back where it ends: 1e-5 of all
 * in a dense gas at t_c/50, the same at any time. */
static void run(int law, double solid, double fraction) {
  enum { WARM = 500 };
  const int n = from_environment("GAS_PARTICLES", 1000);
  const int steps = from_environment("GAS_STEPS", 2000);
  gas g = start(law, n, solid, fraction);
  dem_report first, last;
  OK(dem_get_report(g.dem, &first));
  OK(dem_advance(g.dem, (WARM - 1e-6) * g.dt, NULL));
  const double before = energy(&g);
  double worst = 0.0, mean[2] = {0.0, 0.0};
  int64_t contacts = 0;
  for (int k = 0; k < SAMPLES; k++) {
    OK(dem_advance(g.dem, (steps / SAMPLES - 1e-6) * g.dt, NULL));
    OK(dem_get_report(g.dem, &last));
    const double off = energy(&g) / before - 1.0;
    worst = fmax(worst, fabs(off));
    mean[k / (SAMPLES / 2)] += off / (SAMPLES / 2);
    contacts += last.contacts;
    if (steps > 100000)
      print_message("# law %d: %lld steps, energy %+.2e, contacts %lld, momentum %.1e\n", law,
                    last.substeps, off, (long long)last.contacts, last.budget_error);
  }
  const double mass_speed =
      sqrt(2.0 * first.kinetic_energy * n * sphere_mass(2500.0, 0.5 * diameter));
  print_message("# law %d: energy off by %.2e at most, mean of the halves %.2e %.2e\n", law, worst,
                mean[0], mean[1]);
  assert_true(contacts > SAMPLES * n / 200);
  /* Of a few, thin particles some steps are taken as one (doc/equations.md D.14). */
  assert_in_range(last.substeps, 0.95 * steps, WARM + steps);
  assert_int_equal(last.particles, n);
  assert_true(worst < 1e-5);
  CLOSE(last.budget_error, 0.0, 1e-13);
  for (int c = 0; c < 3; c++)
    CLOSE(last.momentum[c], first.momentum[c], 1e-13 * mass_speed);
  dem_destroy(g.dem);
}

static void dense_linear(void **state) {
  (void)state;
  run(LINEAR, 0.3, 1.0 / 100);
}

static void dense_hertz(void **state) {
  (void)state;
  run(HERTZ, 0.3, 1.0 / 100);
}

static void thin_linear(void **state) {
  (void)state;
  run(LINEAR, 0.1, 1.0 / 50);
}

static void thin_hertz(void **state) {
  (void)state;
  run(HERTZ, 0.1, 1.0 / 50);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(dense_linear),
      cmocka_unit_test(dense_hertz),
      cmocka_unit_test(thin_linear),
      cmocka_unit_test(thin_hertz),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
