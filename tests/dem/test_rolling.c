/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A sphere that slides and rolls, against closed forms, for laws whose tangential spring is damped
 * (of others it goes on swinging): the way from sliding to rolling, rolling resistance on a plane
 * and on slopes (doc/equations.md D.8). */
#include "common.h"

#include "../../libdem/src/laws.h"

static const double radius = 0.01, g = 9.81;

static const int damped[] = {LINEAR, HERTZ};
enum { DAMPED = sizeof damped / sizeof damped[0] };

/* A sphere on the plane z = 0, in balance of weight and overlap; slope: tangent of the angle by
 * which gravity is tilted towards x. */
typedef struct roller {
  int law, triangles;
  double mu, mu_roll, slope, v, w; /* m/s along x; rad/s about y, rolling: v/r */
} roller;

/* Overlap under the weight. */
static double sag(const scene *s, double weight) {
  if (!isnan(s->contact.normal_stiffness))
    return weight / s->contact.normal_stiffness;
  const double k = 4.0 / 3.0 * 0.5 * s->young / (1.0 - s->poisson * s->poisson) * sqrt(radius);
  return pow(weight / k, 2.0 / 3.0);
}

static dem_t *start(const roller *b) {
  scene s = scene_with_law(b->law);
  const double still[3] = {0.0, 0.0, 0.0}, up[3] = {0.0, 0.0, 1.0}, cosine = 1 / hypot(1, b->slope);
  double vertices[18 * 25];
  s.comm = MPI_COMM_SELF;
  s.contact.friction = b->mu;
  s.contact.rolling_friction = b->mu_roll;
  s.contact.restitution = 0.5;
  s.params.gravity[0] = g * b->slope * cosine;
  s.params.gravity[2] = -g * cosine;
  s.params.impact_speed = isnan(s.contact.normal_stiffness) ? 0.1 : 0.0;
  dem_t *dem = scene_create(&s);
  const double z = radius - sag(&s, sphere_mass(s.density, radius) * g * cosine);
  dem_insert insert = lattice(DEM_FREE, 2 * radius, (double[3]){-0.5, 0.0, z}, 0.0, 1, 1, 1);
  insert.velocity[0] = b->v;
  insert.angular_velocity[1] = b->w;
  OK(dem_insert_particles(dem, &insert, -1, NULL));
  if (b->triangles)
    OK(dem_add_triangles(dem, "floor", 0, triangulated_square(still, up, 1.9, 5, vertices),
                         vertices));
  else
    OK(dem_add_plane(dem, "floor", 0, still, up));
  OK(dem_start(dem));
  return dem;
}

static body after(dem_t *dem, double time) {
  OK(dem_advance(dem, time, NULL));
  return find(dem, MPI_COMM_SELF, 0);
}

/* Nothing but motion along x and turn about y. */
static void straight(const body *b) {
  CLOSE(b->x[1], 0.0, 1e-9);
  CLOSE(b->v[1], 0.0, 1e-9);
  CLOSE(b->w[0], 0.0, 1e-7);
  CLOSE(b->w[2], 0.0, 1e-7);
}

/* Sliding sphere: decelerates by mu g, begins to roll with (5 v + 2 r w)/7 after |v - r w| 2/(7 mu
 * g), and goes on so. The end is a vibration of the tangential spring, which the dashpot ends.
 * Bounds: overlap and stretch of the spring, 1e-6 and 1e-5 m, against the ways here. */
static void sliding_to_rolling(void **state) {
  (void)state;
  const double v = 0.5, mu = 0.2, spins[] = {0.0, -20.0, 30.0};
  for (int k = 0; k < 6 * DAMPED; k++) {
    const double w = spins[k % 3];
    const roller b = {damped[k / 6], k / 3 % 2, mu, 0.0, 0.0, v, w};
    dem_t *dem = start(&b);
    const double slip = v - radius * w, time = 2.0 * slip / (7.0 * mu * g);
    const double rolling = (5.0 * v + 2.0 * radius * w) / 7.0;
    body now = after(dem, 0.5 * time);
    CLOSE(now.v[0], 0.5 * (v + rolling), 1e-3 * v);
    CLOSE(radius * now.w[1], 0.5 * (radius * w + rolling), 2e-3 * v);
    now = after(dem, time);
    straight(&now);
    CLOSE(now.v[0], rolling, 1e-3 * v);
    CLOSE(radius * now.w[1], rolling, 1e-3 * v);
    CLOSE(now.x[0] + 0.5, 0.5 * (v + rolling) * time + 0.5 * rolling * time, 1e-4);
    const double then = now.v[0];
    now = after(dem, 0.5);
    CLOSE(now.v[0], then, 1e-5 * v); /* no loss of a sphere that rolls */
    dem_destroy(dem);
  }
}

/* 5/7 g (sin - mu_r cos) down a slope that is steeper than mu_r. Bounds: until the rolling spring
 * is stretched to its limit, about 1 ms of 0.3 s, the resistance is less: 2e-3 of the least
 * acceleration here. */
static void down_a_slope(void **state) {
  (void)state;
  const double slopes[] = {0.1, 0.3, 0.5}, rolling[] = {0.0, 0.05};
  for (int k = 0; k < 12 * DAMPED; k++) {
    const double slope = slopes[k % 3], mu_r = rolling[k / 3 % 2], time = 0.3;
    const roller b = {damped[k / 12], k / 6 % 2, 0.6, mu_r, slope, 0.0, 0.0};
    dem_t *dem = start(&b);
    const body now = after(dem, time);
    const double a = 5.0 / 7.0 * g * (slope - mu_r) / hypot(1.0, slope);
    straight(&now);
    CLOSE(now.v[0], a * time, 3e-3 * a * time);
    CLOSE(now.w[1], a * time / radius, 3e-3 * a * time / radius);
    CLOSE(now.x[0] + 0.5, 0.5 * a * time * time, 3e-3 * a * time * time);
    dem_destroy(dem);
  }
}

/* Rests on slopes below mu_r, for good: the springs of sliding and rolling hold it. Let go with
 * relaxed springs it goes on until they do: what gravity gives it over their stretch at the limit,
 * mu_r F_n/k (7e-7 m), is lost over a way that is longer, the less is left, 1 - slope/mu_r. */
static void rests_on_a_slope(void **state) {
  (void)state;
  for (int k = 0; k < 6 * DAMPED; k++) {
    const double mu_r = 0.2, part = (double[]){0.3, 0.9, 0.99}[k % 3], slope = mu_r * part;
    const roller b = {damped[k / 6], k / 3 % 2, 0.6, mu_r, slope, 0.0, 0.0};
    dem_t *dem = start(&b);
    const body settled = after(dem, 0.5), later = after(dem, 0.5);
    CLOSE(settled.x[0], -0.5, 1.5e-6 / (1.0 - part));
    CLOSE(later.x[0], settled.x[0], 1e-12);
    CLOSE(later.v[0], 0.0, 1e-10);
    CLOSE(later.w[1], 0.0, 1e-8);
    dem_destroy(dem);
  }
}

/* Comes to rest on a plane after 7 v^2/(10 mu_r g), and stays. Bound: the rolling spring lets go at
 * the end, and swings back by mu_r F_n/k_r at most, 1e-6 m. */
static void to_rest_on_a_plane(void **state) {
  (void)state;
  const double v = 0.4, mu_rs[] = {0.02, 0.05, 0.2};
  for (int k = 0; k < 6 * DAMPED; k++) {
    const double mu_r = mu_rs[k % 3], way = 0.7 * v * v / (mu_r * g);
    const double time = 1.4 * v / (mu_r * g);
    const roller b = {damped[k / 6], k / 3 % 2, 0.6, mu_r, 0.0, v, v / radius};
    dem_t *dem = start(&b);
    const body half = after(dem, 0.5 * time), end = after(dem, 0.5 * time + 0.5);
    CLOSE(half.v[0], 0.5 * v, 2e-3 * v);
    CLOSE(end.x[0] + 0.5, way, 2e-3 * way);
    straight(&end);
    CLOSE(end.v[0], 0.0, 1e-9);
    CLOSE(end.w[1], 0.0, 1e-7);
    dem_destroy(dem);
  }
}

/* Whatever the state: no more than mu_r R F_n, and no torque about the normal. */
static void bound_of_torque(void **state) {
  (void)state;
  uint64_t random = 3;
  int at_bound = 0;
  for (int k = 0; k < 1000 * LAWS; k++) {
    scene s = scene_with_law(k / 1000);
    const dem_material m = {.density = 2500.0, .youngs_modulus = 2e8, .poisson_ratio = 0.3};
    double value[16], history[DEM_HISTORY], force[3], moment[3];
    s.contact.restitution = 0.6;
    s.contact.friction = 0.5;
    s.contact.rolling_friction = 0.07;
    const dem_pairing pairing = {&s.contact, {&m, &m}, 2.0 / 7.0, radius, 1.0};
    dem_coefs coefs;
    OK(dem_laws_coefs(&pairing, &coefs));
    for (int c = 0; c < 16; c++) {
      random = random * 6364136223846793005u + 1442695040888963407u;
      value[c] = (double)(random >> 11) * 0x1p-52 - 1.0;
    }
    const double size = sqrt(value[0] * value[0] + value[1] * value[1] + value[2] * value[2]);
    dem_touch touch = {.overlap = 1e-5,
                       .radius = 0.5 * radius,
                       .root_mass = 0.1,
                       .inverse_root = 10.0,
                       .touches = 1};
    double f_n = 0.0, along = 0.0, all = 0.0;
    for (int c = 0; c < 3; c++) {
      touch.n[c] = value[c] / size;
      touch.v[c] = 0.1 * value[3 + c];
      touch.spin[c] = 30.0 * value[6 + c];
      history[c] = 1e-5 * value[9 + c];
      history[3 + c] = 1e-6 * value[12 + c];
    }
    dem_laws_any(&coefs, &touch, DEM_SLIDING | DEM_ROLLING, 1e-6, history, force, moment);
    for (int c = 0; c < 3; c++) {
      f_n += force[c] * touch.n[c];
      along += moment[c] * touch.n[c];
      all += moment[c] * moment[c];
    }
    const double bound = 0.07 * touch.radius * fmax(f_n, 0.0);
    assert_true(sqrt(all) <= bound * (1.0 + 1e-12) + 1e-18);
    CLOSE(along, 0.0, 1e-12 * bound + 1e-18);
    at_bound += sqrt(all) > 0.999 * bound;
  }
  assert_in_range(at_bound, 100 * LAWS, 990 * LAWS); /* both happen */
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sliding_to_rolling), cmocka_unit_test(down_a_slope),
      cmocka_unit_test(rests_on_a_slope),   cmocka_unit_test(to_rest_on_a_plane),
      cmocka_unit_test(bound_of_torque),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
