/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cylinders against closed forms: where they touch, and how spheres move in and on them. */
#include "common.h"

static const double still[3] = {0.0, 0.0, 0.0};

static void set(double to[3], double x, double y, double z) {
  to[0] = x;
  to[1] = y;
  to[2] = z;
}

/* Cylinder about the line through (0.1 0 0) along (0.6 0 0.8). */
static dem_wall_params cylinder(int side, double radius, double length) {
  dem_wall_params wall = wall_of(DEM_WALL_CYLINDER);
  wall.side = side;
  wall.radius = radius;
  wall.length = length;
  set(wall.point, 0.1, 0.0, 0.0);
  set(wall.axis, 1.2, 0.0, 1.6);
  return wall;
}

/* Force on a sphere with r = 1 cm whose centre is at height z along the axis and rho across, along
 * the axis, across, and along the third direction (0). */
static void force_at(const dem_wall_params *wall, double z, double rho, double force[3]) {
  const double axis[3] = {0.6, 0.0, 0.8}, out[3] = {0.8, 0.0, -0.6};
  scene s = scene_default();
  double x[3];
  s.params.max_overlap = 1.0;
  for (int c = 0; c < 3; c++)
    x[c] = wall->point[c] + z * axis[c] + rho * out[c];
  dem_t *dem = scene_create(&s);
  add_sphere(dem, DEM_FREE, -1, x, 0.01, still);
  OK(dem_add_wall(dem, "wall", wall, 0, NULL));
  OK(dem_start(dem));
  const body b = find(dem, s.comm, 0);
  dem_destroy(dem);
  force[0] = b.force[0] * axis[0] + b.force[2] * axis[2];
  force[1] = b.force[0] * out[0] + b.force[2] * out[2];
  force[2] = b.force[1];
}

/* k_n delta n with the nearest point of every part: sides, ends, rim. */
static void places(void **state) {
  (void)state;
  const double k = 1e5, r = 0.01, d = 1e-4, R = 0.05, L = 0.2, diagonal = (r - d) / sqrt(2.0);
  const dem_wall_params pipe = cylinder(DEM_WALL_INSIDE, R, 0.0);
  const dem_wall_params pillar = cylinder(DEM_WALL_OUTSIDE, R, 0.0);
  const dem_wall_params tube = cylinder(DEM_WALL_INSIDE, R, L);
  const dem_wall_params rod = cylinder(DEM_WALL_OUTSIDE, R, L);
  const struct {
    const dem_wall_params *wall;
    double z, rho, along, across; /* m, delta n */
  } cases[] = {
      {&pipe, -0.3, R - r + d, 0.0, -d},
      {&pipe, 0.3, R - r - d, 0.0, 0.0},
      {&pipe, 0.1, 0.0, 0.0, 0.0},
      {&pipe, 0.1, R - 0.1 * r, 0.0, -0.9 * r},
      {&pillar, -0.3, R + r - d, 0.0, d},
      {&pillar, 0.3, R + r + d, 0.0, 0.0},
      {&tube, 0.1, R - r + d, 0.0, -d},
      {&tube, 0.1, R + r - d, 0.0, d},
      {&tube, L + r - d, R, d, 0.0}, /* over the rim */
      {&tube, -r + d, R, -d, 0.0},
      {&tube, L + diagonal, R + diagonal, d / sqrt(2.0), d / sqrt(2.0)},
      {&tube, -diagonal, R - diagonal, -d / sqrt(2.0), -d / sqrt(2.0)},
      {&tube, L + 1e-3, 0.01, 0.0, 0.0}, /* open */
      {&rod, 0.1, R + r - d, 0.0, d},
      {&rod, L + r - d, 0.02, d, 0.0}, /* flat ends */
      {&rod, -r + d, 0.0, -d, 0.0},
      {&rod, L + r + d, 0.02, 0.0, 0.0},
      {&rod, L + diagonal, R + diagonal, d / sqrt(2.0), d / sqrt(2.0)},
  };
  for (size_t m = 0; m < sizeof cases / sizeof cases[0]; m++) {
    double force[3];
    force_at(cases[m].wall, cases[m].z, cases[m].rho, force);
    CLOSE(force[0], k * cases[m].along, 1e-8);
    CLOSE(force[1], k * cases[m].across, 1e-8);
    CLOSE(force[2], 0.0, 1e-8);
  }
}

/* Rolling without slip at the bottom of a pipe: the period of a pendulum of length 7/5 (R - r).
 * Amplitude 0.03: 1/16 of its square is 6e-5; overlap and step give less. */
static void rolls_in_pipe(void **state) {
  (void)state;
  const double R = 0.1, r = 0.01, g = 9.81, start = 0.03;
  scene s = scene_default();
  dem_wall_params pipe = wall_of(DEM_WALL_CYLINDER);
  pipe.radius = R;
  set(pipe.axis, 0.0, 1.0, 0.0);
  s.params.gravity[2] = -g;
  s.contact.friction = 1.0;
  s.contact.restitution = 0.2;
  const double depth = sphere_mass(s.density, r) * g / s.contact.normal_stiffness;
  const double l = R - r + depth, x[3] = {l * sin(start), 0.0, -l * cos(start)};
  const double period = 2.0 * PI * sqrt(1.4 * l / g);
  dem_t *dem = scene_create(&s);
  add_sphere(dem, DEM_FREE, -1, x, r, still);
  OK(dem_add_wall(dem, "pipe", &pipe, 0, NULL));
  OK(dem_start(dem));
  double crossed[8], last = x[0];
  int n = 0;
  for (int k = 1; n < 8 && k < 20000; k++) {
    OK(dem_advance(dem, 1e-3, NULL));
    const double now = find(dem, s.comm, 0).x[0];
    if (now * last < 0.0)
      crossed[n++] = 1e-3 * (k - now / (now - last));
    last = now;
  }
  assert_int_equal(n, 8);
  CLOSE((crossed[7] - crossed[1]) / 3.0, period, 2e-3 * period);
  dem_destroy(dem);
}

/* A sphere that rolls off the top of a pillar without slip leaves it where cos = 10/17 cos start,
 * and flies on with the horizontal velocity it has there. */
static void leaves_pillar(void **state) {
  (void)state;
  const double R = 0.2, r = 0.01, g = 9.81, start = 0.2;
  scene s = scene_default();
  dem_wall_params pillar = wall_of(DEM_WALL_CYLINDER);
  pillar.radius = R;
  pillar.side = DEM_WALL_OUTSIDE;
  set(pillar.axis, 0.0, 1.0, 0.0);
  s.params.gravity[2] = -g;
  s.contact.normal_stiffness = 1e6;
  s.contact.friction = 50.0;
  s.contact.restitution = 0.1;
  const double l = R + r, x[3] = {l * sin(start), 0.0, l * cos(start)};
  dem_t *dem = scene_create(&s);
  dem_report report;
  add_sphere(dem, DEM_FREE, -1, x, r, still);
  OK(dem_add_wall(dem, "pillar", &pillar, 0, NULL));
  OK(dem_start(dem));
  OK(dem_advance(dem, 1e-2, NULL));
  do {
    OK(dem_advance(dem, 1e-3, NULL));
    OK(dem_get_report(dem, &report));
  } while (report.wall_contacts > 0);
  const body b = find(dem, s.comm, 0);
  const double cosine = 10.0 / 17.0 * cos(start);
  CLOSE(b.v[0], cosine * sqrt(g * l * cosine), 5e-3 * b.v[0]);
  CLOSE(b.w[1] * r, sqrt(g * l * cosine), 5e-3 * b.w[1] * r);
  dem_destroy(dem);
}

/* Billiards: between bounces inside a pipe a sphere without friction turns by 2 acos(b/(R - r))
 * about the axis; its angular momentum about the axis stays to round-off. */
static void billiards(void **state) {
  (void)state;
  const double R = 0.1, r = 0.01, b = 0.05, v = 1.0;
  scene s = scene_default();
  dem_wall_params pipe = wall_of(DEM_WALL_CYLINDER);
  const double x[3] = {0.0, b, 0.1}, u[3] = {v, 0.0, 0.0};
  pipe.radius = R;
  set(pipe.axis, 0.0, 0.0, -3.0);
  s.contact.normal_stiffness = 1e7;
  dem_t *dem = scene_create(&s);
  add_sphere(dem, DEM_FREE, -1, x, r, u);
  OK(dem_add_wall(dem, "pipe", &pipe, 0, NULL));
  OK(dem_start(dem));
  const double chord = 2.0 * sqrt((R - r) * (R - r) - b * b);
  const int bounces = 10;
  OK(dem_advance(dem, bounces * chord / v, NULL));
  const body end = find(dem, s.comm, 0);
  CLOSE(end.x[0] * end.v[1] - end.x[1] * end.v[0], -b * v,
        1e-11); /* rounding of 2000 steps in contact */
  CLOSE(sqrt(end.v[0] * end.v[0] + end.v[1] * end.v[1]), v, 1e-4 * v);
  /* Direction after 10 reflections, each by pi - 2 asin(b/(R - r)), clockwise. */
  const double turned = atan2(end.v[1], end.v[0]);
  const double wanted = -bounces * (PI - 2.0 * asin(b / (R - r)));
  CLOSE(cos(turned - wanted), 1.0, 3e-5); /* contacts last t_c: 6e-4 rad each */
  assert_true(sin(turned - wanted) < 0.01);
  CLOSE(end.x[2], 0.1, 0.0);
  dem_destroy(dem);
}

/* Head-on restitution on a pillar and in a pipe is that of the law, whatever the curvature. */
static void restitution(void **state) {
  (void)state;
  for (int side = 0; side < 2; side++) {
    scene s = scene_default();
    dem_wall_params wall = wall_of(DEM_WALL_CYLINDER);
    wall.side = side;
    wall.radius = 0.05;
    set(wall.axis, 0.0, 1.0, 0.0);
    s.contact.restitution = 0.6;
    const double u[3] = {side == DEM_WALL_INSIDE ? 0.5 : -0.5, 0.0, 0.0};
    const double x[3] = {side == DEM_WALL_INSIDE ? 0.03 : 0.07, 0.0, 0.0};
    dem_t *dem = scene_create(&s);
    add_sphere(dem, DEM_FREE, -1, x, 0.01, u);
    OK(dem_add_wall(dem, "wall", &wall, 0, NULL));
    OK(dem_start(dem));
    OK(dem_advance(dem, 0.03, NULL));
    const body b = find(dem, s.comm, 0);
    CLOSE(b.v[0], -0.6 * u[0], 1e-3 * 0.6 * 0.5);
    CLOSE(b.v[2], 0.0, 1e-15);
    dem_destroy(dem);
  }
}

static void refused(int status, const char *words, const dem_wall_params *wall, int periodic) {
  scene s = scene_default();
  for (int c = 0; c < 3; c++)
    s.box.periodic[c] = periodic >> c & 1;
  dem_t *dem = scene_create(&s);
  FAILS(status, words, dem_add_wall(dem, "side", wall, 0, NULL));
  FAILS(status, "wall side", dem_add_wall(dem, "side", wall, 0, NULL));
  assert_int_equal(dem_wall_count(dem), 0);
  dem_destroy(dem);
}

static void bad_input(void **state) {
  (void)state;
  dem_wall_params w = wall_of(DEM_WALL_CYLINDER);
  refused(PART_ERR_RANGE, "axis", &w, 0);
  set(w.axis, 0.0, 0.0, 1.0);
  refused(PART_ERR_RANGE, "radius", &w, 0);
  w.radius = -1.0;
  refused(PART_ERR_RANGE, "radius", &w, 0);
  w.radius = 0.1;
  refused(PART_ERR_RANGE, "along x", &w, 1);
  w.side = DEM_WALL_OUTSIDE;
  set(w.axis, 0.0, 1.0, 1.0);
  refused(PART_ERR_RANGE, "right angles", &w, 4);
  w = wall_of(DEM_WALL_CYLINDER);
  set(w.axis, 0.0, 0.0, 1.0);
  w.radius = 0.1;
  w.length = -1.0;
  refused(PART_ERR_RANGE, "length", &w, 0);
  w.length = 0.0;
  set(w.normal, 0.0, 0.0, 1.0);
  refused(PART_ERR_ARGUMENT, "normal does not belong to type cylinder", &w, 0);
  w = wall_of(DEM_WALL_PLANE);
  refused(PART_ERR_RANGE, "normal", &w, 0);
  set(w.normal, 0.0, 0.0, 1.0);
  refused(PART_ERR_RANGE, "along z", &w, 4);
  w.radius = 0.1;
  refused(PART_ERR_ARGUMENT, "radius does not belong to type plane", &w, 0);
  w.radius = 0.0;
  w.open = 1;
  refused(PART_ERR_ARGUMENT, "open does not belong", &w, 0);
  w.open = 0;
  set(w.point, (double)NAN, 0.0, 0.0);
  refused(PART_ERR_RANGE, "point", &w, 0);
  set(w.point, 0.0, 0.0, 0.0);
  strcpy(w.material, "glas");
  refused(PART_ERR_ARGUMENT, "did you mean 'glass'", &w, 0);
  w.material[0] = '\0';
  refused(PART_ERR_ARGUMENT, "material is missing", &w, 0);
  w = wall_of(DEM_WALL_TRIANGLES);
  refused(PART_ERR_RANGE, "no triangles", &w, 0);
  w.type = 7;
  refused(PART_ERR_RANGE, "type", &w, 0);
  part_params_default(&dem_wall_table, &w);
  refused(PART_ERR_ARGUMENT, "type is missing", &w, 0);
}

static void too_narrow(void **state) {
  (void)state;
  scene s = scene_default();
  dem_wall_params pipe = wall_of(DEM_WALL_CYLINDER);
  set(pipe.axis, 0.0, 0.0, 1.0);
  pipe.radius = 0.009;
  dem_t *dem = scene_create(&s);
  int number = -1;
  add_sphere(dem, DEM_FREE, -1, still, 0.01, still);
  OK(dem_add_wall(dem, "pipe", &pipe, 0, NULL));
  OK(dem_find_wall(dem, "pipe", &number));
  assert_int_equal(number, 0);
  FAILS(PART_ERR_ARGUMENT, "did you mean 'pipe'", dem_find_wall(dem, "pie", &number));
  FAILS(PART_ERR_RANGE, "wall pipe: entry radius", dem_start(dem));
  dem_destroy(dem);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(places),        cmocka_unit_test(rolls_in_pipe),
      cmocka_unit_test(leaves_pillar), cmocka_unit_test(billiards),
      cmocka_unit_test(restitution),   cmocka_unit_test(bad_input),
      cmocka_unit_test(too_narrow),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
