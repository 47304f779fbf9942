/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Walls that move, against closed forms and against the same scene seen from the wall. */
#include "common.h"

static const double still[3] = {0.0, 0.0, 0.0};

static void set(double to[3], double x, double y, double z) {
  to[0] = x;
  to[1] = y;
  to[2] = z;
}

static dem_wall_params ground(void) {
  dem_wall_params wall = wall_of(DEM_WALL_PLANE);
  set(wall.normal, 0.0, 0.0, 1.0);
  return wall;
}

static dem_t *one_sphere(const scene *s, const dem_wall_params *wall, int count,
                         const double *vertices, const double x[3], const double v[3]) {
  dem_t *dem = scene_create(s);
  add_sphere(dem, DEM_FREE, -1, x, 0.01, v);
  OK(dem_add_wall(dem, "wall", wall, count, vertices));
  OK(dem_start(dem));
  return dem;
}

static void advance(dem_t *dem, double step, int steps) {
  for (int k = 0; k < steps; k++)
    OK(dem_advance(dem, step, NULL));
}

/* A piston with speed U that meets a sphere at rest sends it off with (1 + e) U. */
static void piston(void **state) {
  (void)state;
  const double speed = 0.4, x[3] = {0.0, 0.0, 0.02}, restitution[] = {1.0, 0.5};
  for (int k = 0; k < 2; k++) {
    scene s = scene_default();
    dem_wall_params wall = ground();
    dem_wall_report report;
    s.contact.restitution = restitution[k];
    set(wall.velocity, 0.3, 0.0, speed);
    dem_t *dem = one_sphere(&s, &wall, 0, NULL, x, still);
    const double mass = sphere_mass(s.density, 0.01), end = (1.0 + restitution[k]) * speed;
    advance(dem, 1e-3, 50);
    const body b = find(dem, s.comm, 0);
    CLOSE(b.v[2], end, 1e-3 * end);
    CLOSE(b.v[0], 0.0, 0.0);
    OK(dem_get_wall_report(dem, 0, &report));
    assert_string_equal(report.name, "wall");
    CLOSE(report.centre[2], 0.05 * speed, 1e-15);
    CLOSE(report.velocity[0], 0.3, 0.0);
    CLOSE(report.impulse[2], -mass * b.v[2], 1e-14 * mass);
    /* All energy comes from the piston: but for what is lost in the contact. */
    CLOSE(report.work, mass * b.v[2] * speed, 1e-13 * mass);
    dem_destroy(dem);
  }
}

/* A belt with speed U accelerates a resting sphere by mu g until 2 U/(7 mu g), when it rolls with
 * 2/7 U; spin 5/7 U/r. Triangles that travel through a periodic box do the same. */
static void belt(void **state) {
  (void)state;
  const double U = 0.5, g = 9.81, mu = 0.2, rolls = 2.0 * U / (7.0 * mu * g), r = 0.01;
  const double at[3] = {0.0, 0.0, 0.0}, up[3] = {0.0, 0.0, 1.0};
  double vertices[18 * 25];
  body end[2][2];
  for (int k = 0; k < 2; k++) {
    scene s = scene_default();
    dem_wall_params wall = k == 0 ? ground() : wall_of(DEM_WALL_TRIANGLES);
    s.box.lo[0] = s.box.lo[1] = -0.1;
    s.box.hi[0] = s.box.hi[1] = 0.1;
    s.box.periodic[0] = s.box.periodic[1] = 1;
    s.params.gravity[2] = -g;
    s.contact.friction = mu;
    s.contact.restitution = 0.3;
    set(wall.velocity, U * 0.8, U * 0.6, 0.0);
    const int n = k == 0 ? 0 : triangulated_square(at, up, 0.2, 5, vertices);
    const double depth = sphere_mass(s.density, r) * g / s.contact.normal_stiffness;
    const double x[3] = {0.05, 0.02, r - depth};
    dem_t *dem = one_sphere(&s, &wall, n, vertices, x, still);
    advance(dem, 0.5 * rolls, 1);
    end[k][0] = find(dem, s.comm, 0);
    advance(dem, 0.05, 20); /* 0.5 m of belt: over its end and back, several times */
    end[k][1] = find(dem, s.comm, 0);
    dem_destroy(dem);
    /* Sliding: the tangential spring takes 2/7 of a contact time to load, 1e-4 of the velocity. */
    CLOSE(end[k][0].v[0], 0.8 * U / 7.0, 2e-3 * U / 7.0);
    CLOSE(end[k][0].v[1], 0.6 * U / 7.0, 2e-3 * U / 7.0);
    CLOSE(end[k][1].v[0], 0.8 * U * 2.0 / 7.0, 1e-4 * U);
    CLOSE(end[k][1].v[1], 0.6 * U * 2.0 / 7.0, 1e-4 * U);
    CLOSE(end[k][1].w[0] * r, 0.6 * U * 5.0 / 7.0, 1e-4 * U);
    CLOSE(end[k][1].w[1] * r, -0.8 * U * 5.0 / 7.0, 1e-4 * U);
  }
  for (int c = 0; c < 3; c++) {
    CLOSE(end[1][1].v[c], end[0][1].v[c], 1e-9);
    CLOSE(end[1][1].w[c], end[0][1].w[c], 1e-7);
  }
}

/* A pipe that turns drags a sphere that circles inside along until it rolls without slip: its speed
 * grows by 2/7 of the slip, its spin by 5/7 of it over r. */
static void rotating_pipe(void **state) {
  (void)state;
  const double R = 0.05, r = 0.01, rate = 40.0, v = 0.3, slip = rate * R - v;
  scene s = scene_default();
  dem_wall_params wall = wall_of(DEM_WALL_CYLINDER);
  const double x[3] = {0.0, 0.0, -(R - r)}, u[3] = {-v, 0.0, 0.0};
  dem_wall_report report;
  wall.radius = R;
  set(wall.axis, 0.0, 1.0, 0.0);
  set(wall.rotation_axis, 0.0, 2.0, 0.0);
  wall.rotation_rate = rate;
  s.contact.friction = 0.4;
  s.contact.restitution = 0.2;
  dem_t *dem = one_sphere(&s, &wall, 0, NULL, x, u);
  advance(dem, 0.1, 20);
  const body b = find(dem, s.comm, 0);
  const double speed = sqrt(b.v[0] * b.v[0] + b.v[2] * b.v[2]), end = v + 2.0 / 7.0 * slip;
  /* Arms and radii differ by the overlap: 1e-3 of r. */
  CLOSE(speed, end, 2e-3 * end);
  CLOSE(b.w[1] * r, 5.0 / 7.0 * slip, 2e-3 * slip);
  CLOSE(b.v[1], 0.0, 1e-12);
  /* Angular momentum about the axis came from the pipe's torque, to round-off. */
  const double mass = sphere_mass(s.density, r), inertia = 0.4 * mass * r * r;
  const double momentum = mass * (b.x[2] * b.v[0] - b.x[0] * b.v[2]) + inertia * b.w[1];
  OK(dem_get_wall_report(dem, 0, &report));
  CLOSE(momentum - mass * x[2] * u[0], -report.spin_impulse[1], 1e-12 * momentum);
  CLOSE(report.spin[1], rate, 1e-12 * rate);
  CLOSE(report.work, -rate * report.spin_impulse[1], 1e-6 * report.work);
  dem_destroy(dem);
}

/* A drum of triangles: momentum and angular momentum of a sphere that bounces about in it. */
static void rotating_drum(void **state) {
  (void)state;
  enum { SIDES = 60 };
  const double R = 0.05, r = 0.01, L = 0.04;
  double vertices[18 * SIDES];
  scene s = scene_default();
  dem_wall_params wall = wall_of(DEM_WALL_TRIANGLES);
  dem_wall_report report;
  const double x[3] = {0.0, 0.0, -(R - r) + 1e-3}, u[3] = {0.2, 0.0, -0.1};
  for (int k = 0; k < SIDES; k++) {
    double *t = vertices + 18 * k;
    const double a = 2.0 * PI * k / SIDES, b = 2.0 * PI * (k + 1) / SIDES;
    set(t, R * cos(a), -L, R * sin(a));
    set(t + 3, R * cos(b), -L, R * sin(b));
    set(t + 6, R * cos(b), L, R * sin(b));
    set(t + 9, R * cos(a), -L, R * sin(a));
    set(t + 12, R * cos(b), L, R * sin(b));
    set(t + 15, R * cos(a), L, R * sin(a));
  }
  set(wall.rotation_axis, 0.0, 1.0, 0.0);
  wall.rotation_rate = 20.0;
  s.contact.friction = 0.5;
  s.contact.restitution = 0.3;
  dem_t *dem = one_sphere(&s, &wall, 2 * SIDES, vertices, x, u);
  advance(dem, 0.05, 20);
  const body b = find(dem, s.comm, 0);
  const double mass = sphere_mass(s.density, r), inertia = 0.4 * mass * r * r;
  const double momentum = mass * (b.x[2] * b.v[0] - b.x[0] * b.v[2]) + inertia * b.w[1];
  const double before = mass * (x[2] * u[0] - x[0] * u[2]);
  OK(dem_get_wall_report(dem, 0, &report));
  /* Several bounces changed it; what is left to rounding is of the sum of their sizes. */
  assert_true(fabs(report.spin_impulse[1]) > 0.5 * fabs(before));
  CLOSE(momentum - before, -report.spin_impulse[1], 1e-12 * fabs(before));
  CLOSE(b.v[1], 0.0, 1e-10);
  CLOSE(report.impulse[0], -mass * (b.v[0] - u[0]), 1e-12 * mass);
  CLOSE(report.impulse[2], -mass * (b.v[2] - u[2]), 1e-12 * mass);
  /* Friction and damping only take: what was gained came from the wall. */
  const double gained = 0.5 * mass * (b.v[0] * b.v[0] + b.v[2] * b.v[2]) +
                        0.5 * inertia * b.w[1] * b.w[1] - 0.5 * mass * (u[0] * u[0] + u[2] * u[2]);
  assert_true(report.work > gained);
  dem_destroy(dem);
}

/* On a turntable a sphere that rolls without slip circles with 2/7 of its rate, on a disc that is a
 * plane or is made of triangles. */
static void turntable(void **state) {
  (void)state;
  const double rate = 7.0, r = 0.01, v = 0.05, g = 9.81, centre[3] = {0.02, -0.01, 0.0};
  const double at[3] = {0.0, 0.0, 0.0}, up[3] = {0.0, 0.0, 1.0};
  static double vertices[18 * 400];
  body end[2];
  for (int k = 0; k < 2; k++) {
    scene s = scene_default();
    dem_wall_params wall = k == 0 ? ground() : wall_of(DEM_WALL_TRIANGLES);
    memcpy(wall.centre, centre, sizeof centre);
    set(wall.rotation_axis, 0.0, 0.0, 1.0);
    wall.rotation_rate = rate;
    s.params.gravity[2] = -g;
    s.contact.friction = 1.0;
    s.contact.restitution = 0.1;
    const double depth = sphere_mass(s.density, r) * g / s.contact.normal_stiffness;
    /* Spin such that the contact point goes with the table: r w x up = v - rate x (x - centre). */
    const double x[3] = {0.05, 0.0, r - depth}, u[3] = {0.0, v, 0.0};
    const double table[2] = {-rate * (x[1] - centre[1]), rate * (x[0] - centre[0])};
    dem_t *dem = scene_create(&s);
    add_sphere(dem, DEM_FREE, -1, x, r, u);
    OK(dem_add_wall(dem, "wall", &wall, k == 0 ? 0 : triangulated_square(at, up, 0.4, 20, vertices),
                    vertices));
    OK(dem_start(dem));
    part_store *store = dem_store(dem);
    const double arm = r - 0.5 * depth;
    for (int i = 0; i < store->local; i++) {
      double *w = part_field_double(store, DEM_FIELD_ANGULAR_VELOCITY) +
                  i * part_field_stride(store, DEM_FIELD_ANGULAR_VELOCITY);
      w[0] = (table[1] - u[1]) / arm;
      w[1] = -(table[0] - u[0]) / arm;
    }
    const double turn = 2.0 * PI / (2.0 / 7.0 * rate);
    advance(dem, turn / 100.0, 75);
    end[k] = find(dem, s.comm, 0);
    dem_destroy(dem);
    /* 3/4 of a circle of radius v/(2/7 rate) about x - v/(2/7 rate) along x. */
    const double radius = v / (2.0 / 7.0 * rate);
    CLOSE(end[k].x[0], x[0] - radius, 2e-3 * radius);
    CLOSE(end[k].x[1], x[1] - radius, 2e-3 * radius);
    CLOSE(end[k].v[0], v, 2e-3 * v);
  }
  for (int c = 0; c < 3; c++) {
    CLOSE(end[1].x[c], end[0].x[c], 1e-10);
    CLOSE(end[1].v[c], end[0].v[c], 1e-9);
  }
}

/* A sphere that stays on an oscillating floor: after the transient
 *   m x'' = -m g - k (x - y) - c (x' - y'),   y = A sin(w t)
 * has x - mean = A |H| sin(w t + arg H), H = (k + i w c)/(k - m w^2 + i w c). */
static void oscillating_floor(void **state) {
  (void)state;
  const double r = 0.01, g = 9.81, A = 2e-6, k = 1e4, e = 0.1;
  scene s = scene_default();
  dem_wall_params wall = ground();
  s.params.gravity[2] = -g;
  s.contact.normal_stiffness = k;
  s.contact.restitution = e;
  const double m = sphere_mass(s.density, r), zeta = -log(e) / sqrt(PI * PI + log(e) * log(e));
  const double c = 2.0 * zeta * sqrt(k * m), w = 0.2 * sqrt(k / m);
  const double x[3] = {0.0, 0.0, r - m * g / k};
  wall.oscillation_amplitude = A;
  wall.oscillation_frequency = w / (2.0 * PI);
  set(wall.oscillation_direction, 0.0, 0.0, 0.1);
  dem_t *dem = one_sphere(&s, &wall, 0, NULL, x, still);
  const double period = 2.0 * PI / w;
  /* The law takes the damping at the velocity after half a step of the contact force alone, which
   * lowers the place of rest by c h/(2 m) of the overlap. */
  int substeps;
  advance(dem, period / 16.0, 640);
  const double a = k - m * w * w, b = w * c; /* H = (k + i b)/(a + i b) */
  const double re = (k * a + b * b) / (a * a + b * b), im = (b * a - k * b) / (a * a + b * b);
  for (int n = 0; n < 16; n++) {
    OK(dem_advance(dem, period / 16.0, &substeps));
    const double rest = x[2] - m * g / k * c * (period / 16.0 / substeps) / (2.0 * m);
    const double t = dem_time(dem), sine = sin(w * t), cosine = cos(w * t);
    const body now = find(dem, s.comm, 0);
    /* The wall's velocity is the mean over the step before, w h/2 late: 0.006, times w c/k = 0.24.
     */
    CLOSE(now.x[2] - rest, A * (re * sine + im * cosine), 3e-3 * A);
    CLOSE(now.v[2], A * w * (re * cosine - im * sine), 3e-3 * A * w);
  }
  dem_destroy(dem);
}

/* Seen from a wall that translates nothing is different: positions but for U t. */
static void galilean(void **state) {
  (void)state;
  const double at[3] = {0.0, 0.0, 0.0}, normal[3] = {0.0, 0.6, 0.8}, U[3] = {0.7, -0.3, 0.5};
  static double vertices[18 * 900];
  body end[2];
  const int n = triangulated_square(at, normal, 0.3, 30, vertices);
  for (int k = 0; k < 2; k++) {
    scene s = scene_default();
    dem_wall_params wall = wall_of(DEM_WALL_TRIANGLES);
    s.params.gravity[1] = -9.81 * 0.6;
    s.params.gravity[2] = -9.81 * 0.8;
    s.contact.friction = 0.3;
    s.contact.restitution = 0.7;
    const double x[3] = {0.0, 0.006, 0.008}, v[3] = {0.3, -0.08, 0.06};
    double u[3];
    for (int c = 0; c < 3; c++) {
      wall.velocity[c] = k * U[c];
      u[c] = v[c] + k * U[c];
    }
    dem_t *dem = one_sphere(&s, &wall, n, vertices, x, u);
    advance(dem, 1e-3, 200);
    end[k] = find(dem, s.comm, 0);
    dem_destroy(dem);
  }
  for (int c = 0; c < 3; c++) {
    CLOSE(end[1].x[c] - 0.2 * U[c], end[0].x[c], 1e-9);
    CLOSE(end[1].v[c] - U[c], end[0].v[c], 1e-8);
    CLOSE(end[1].w[c], end[0].w[c], 1e-6);
  }
}

/* Start and stop: at rest before and after, in between and at the end where it should be. */
static void start_and_stop(void **state) {
  (void)state;
  scene s = scene_default();
  dem_wall_params wall = ground();
  dem_wall_report report;
  const double x[3] = {0.0, 0.0, 0.5};
  set(wall.velocity, 0.0, 0.0, -2.0);
  set(wall.rotation_axis, 0.0, 0.0, 1.0);
  wall.rotation_rate = 3.0;
  wall.start_time = 0.01;
  wall.stop_time = 0.03;
  dem_t *dem = one_sphere(&s, &wall, 0, NULL, x, still);
  const double place[] = {0.0, 0.0, -0.02, -0.04, -0.04}, spin[] = {0.0, 3.0, 3.0, 0.0, 0.0};
  for (int k = 0; k < 5; k++) {
    OK(dem_get_wall_report(dem, 0, &report));
    CLOSE(report.centre[2], place[k], 1e-15);
    CLOSE(report.spin[2], spin[k], 1e-15);
    CLOSE(report.velocity[2], -2.0 / 3.0 * spin[k], 1e-15);
    OK(dem_advance(dem, 0.01, NULL));
  }
  dem_destroy(dem);
}

/* One step until the piston arrives, and the answer of skip off. */
static void horizon(void **state) {
  (void)state;
  const double x[3] = {0.0, 0.0, 0.25};
  body end[2];
  dem_report report[2];
  for (int k = 0; k < 2; k++) {
    scene s = scene_default();
    dem_wall_params wall = ground();
    s.params.skip = k == 0;
    set(wall.velocity, 0.0, 0.0, 0.5);
    wall.oscillation_amplitude = 0.01;
    wall.oscillation_frequency = 5.0;
    set(wall.oscillation_direction, 1.0, 0.0, 0.0);
    dem_t *dem = one_sphere(&s, &wall, 0, NULL, x, still);
    advance(dem, 5e-3, 110);
    end[k] = find(dem, s.comm, 0);
    OK(dem_get_report(dem, &report[k]));
    dem_destroy(dem);
  }
  assert_true(end[0].v[2] > 0.9);
  for (int c = 0; c < 3; c++) {
    CLOSE(end[0].x[c], end[1].x[c], 1e-12);
    CLOSE(end[0].v[c], end[1].v[c], 1e-11);
  }
  assert_true(report[0].substeps < report[1].substeps / 10);
}

static void refused(const char *words, const dem_wall_params *wall, int periodic) {
  scene s = scene_default();
  for (int c = 0; c < 3; c++)
    s.box.periodic[c] = periodic >> c & 1;
  dem_t *dem = scene_create(&s);
  FAILS(PART_ERR_RANGE, words, dem_add_wall(dem, "side", wall, 0, NULL));
  dem_destroy(dem);
}

static void bad_motion(void **state) {
  (void)state;
  dem_wall_params w = ground();
  w.rotation_rate = 1.0;
  refused("rotationAxis", &w, 0);
  set(w.rotation_axis, 1.0, 0.0, 0.0);
  refused("only about its normal", &w, 0);
  w = wall_of(DEM_WALL_CYLINDER);
  w.radius = 0.1;
  set(w.axis, 0.0, 0.0, 1.0);
  set(w.rotation_axis, 1.0, 0.0, 0.0);
  w.rotation_rate = 1.0;
  refused("direction of its axis", &w, 0);
  w.length = 0.2;
  refused("periodic in z", &w, 4);
  w = ground();
  w.oscillation_amplitude = 0.1;
  refused("oscillationDirection", &w, 0);
  set(w.oscillation_direction, 1.0, 0.0, 0.0);
  refused("oscillationFrequency", &w, 0);
  w.oscillation_frequency = -1.0;
  refused("oscillationFrequency", &w, 0);
  w.oscillation_frequency = 1.0;
  w.oscillation_amplitude = -1.0;
  refused("oscillationAmplitude", &w, 0);
  w = ground();
  w.start_time = 2.0;
  w.stop_time = 1.0;
  refused("stopTime", &w, 0);
  set(w.velocity, 0.0, HUGE_VAL, 0.0);
  refused("velocity", &w, 0);
}

static void bad_report(void **state) {
  (void)state;
  scene s = scene_default();
  dem_wall_report report;
  const double x[3] = {0.0, 0.0, 0.25};
  const dem_wall_params wall = ground();
  dem_t *dem = scene_create(&s);
  add_sphere(dem, DEM_FREE, -1, x, 0.01, still);
  OK(dem_add_wall(dem, "wall", &wall, 0, NULL));
  FAILS(PART_ERR_STATE, "dem_start", dem_get_wall_report(dem, 0, &report));
  OK(dem_start(dem));
  FAILS(PART_ERR_RANGE, "wall 1", dem_get_wall_report(dem, 1, &report));
  FAILS(PART_ERR_STATE, "dem_start", dem_add_wall(dem, "other", &wall, 0, NULL));
  dem_destroy(dem);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(piston),        cmocka_unit_test(belt),
      cmocka_unit_test(rotating_pipe), cmocka_unit_test(rotating_drum),
      cmocka_unit_test(turntable),     cmocka_unit_test(oscillating_floor),
      cmocka_unit_test(galilean),      cmocka_unit_test(start_and_stop),
      cmocka_unit_test(horizon),       cmocka_unit_test(bad_motion),
      cmocka_unit_test(bad_report),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
