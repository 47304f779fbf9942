/* ranks: 1 2 3 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Wear of walls and impact energy (Gao and Sun 2011, eq. 12 and 13) against closed forms. */
#include "common.h"

static const double still[3] = {0.0, 0.0, 0.0};

static void set(double to[3], double x, double y, double z) {
  to[0] = x;
  to[1] = y;
  to[2] = z;
}

/* Two triangles, x < 0 and x > 0, in the order given: right, left. */
static void two_triangles(double v[18]) {
  set(v, 0.0, -0.5, 0.0);
  set(v + 3, 0.5, 0.0, 0.0);
  set(v + 6, 0.0, 0.5, 0.0);
  set(v + 9, 0.0, -0.5, 0.0);
  set(v + 12, 0.0, 0.5, 0.0);
  set(v + 15, -0.5, 0.0, 0.0);
}

/* An impact at an angle that slides throughout: with the impulse m (1 + e) v_n friction takes
 * 7/2 mu (1 + e) v_n off the slip v_t, and m_t/2 (v_t^2 - v_t'^2) off the energy, m_t = 2/7 m.
 * e = 1, because below it the normal force pulls at the end, where there is no friction. The wall
 * may move. */
static void one_impact(void **state) {
  (void)state;
  const double angles[] = {0.2, 0.5, 0.8}, speed = 0.8, mu = 0.1, e = 1.0, r = 0.01;
  for (int k = 0; k < 6; k++) {
    scene s = scene_default();
    dem_wall_params wall = wall_of(DEM_WALL_TRIANGLES);
    double vertices[18], shear[2], volume[2], area[2];
    dem_impact impact;
    const double v_t = speed * cos(angles[k % 3]), v_n = speed * sin(angles[k % 3]);
    const double x[3] = {-0.1, 0.02, 0.012}, moves = k < 3 ? 0.0 : 0.3;
    const double v[3] = {0.8 * v_t, 0.6 * v_t, -v_n + moves};
    two_triangles(vertices);
    set(wall.velocity, 0.0, 0.0, moves);
    s.contact.friction = mu;
    s.contact.restitution = e;
    s.contact.normal_stiffness = 1e7; /* the arm is delta/2 less than r: 1e-3 */
    s.contact.wear_coefficient = 3e-9;
    s.breakage = 0.02;
    dem_t *dem = scene_create(&s);
    add_sphere(dem, DEM_FREE, -1, x, r, v);
    OK(dem_add_wall(dem, "wall", &wall, 2, vertices));
    OK(dem_start(dem));
    for (int n = 0; n < 20; n++)
      OK(dem_advance(dem, 1e-3, NULL));
    const double m = sphere_mass(s.density, r), after = v_t - 3.5 * mu * (1.0 + e) * v_n;
    const double energy = m / 7.0 * (v_t * v_t - after * after), hit = 0.5 * m * v_n * v_n;
    int counted[2];
    dem_wear_counted(dem, &counted[0], &counted[1]);
    assert_true(after > 0.0 && counted[0] && counted[1]);
    assert_string_equal(dem_material_name(dem, 0), "glass");
    assert_int_equal(dem_material_count(dem), 1);
    OK(dem_get_wear(dem, 0, shear, volume, area));
    CLOSE(shear[0], 0.0, 0.0);
    CLOSE(shear[1], energy, 1e-3 * energy);
    CLOSE(volume[1], 3e-9 * shear[1], 1e-15 * volume[1]);
    CLOSE(area[0], 0.25, 1e-15);
    OK(dem_get_impact(dem, 0, &impact));
    CLOSE(impact.energy, hit, 1e-12 * hit);
    CLOSE(impact.mass, m, 1e-14 * m);
    CLOSE(impact.breakage, 0.02 * hit / m, 1e-12);
    dem_destroy(dem);
  }
}

/* Rolling over many triangles is one impact and wears nothing more than the slip before it cost. */
static void rolling(void **state) {
  (void)state;
  static double vertices[18 * 3600];
  const double up[3] = {0.0, 0.0, 1.0}, r = 0.01, g = 9.81, v0 = 0.35, fall = 1e-4;
  scene s = scene_default();
  const int n = triangulated_square(still, up, 0.3, 60, vertices);
  const double x[3] = {-0.1, 0.0, r + fall}, v[3] = {v0, 0.0, 0.0};
  double *shear = malloc((size_t)n * sizeof *shear), sum = 0.0;
  dem_impact impact;
  int worn = 0;
  s.params.gravity[2] = -g;
  s.contact.friction = 0.3;
  s.contact.restitution = 0.05;
  s.contact.wear_coefficient = 1.0;
  s.breakage = 1.0;
  dem_t *dem = scene_create(&s);
  add_sphere(dem, DEM_FREE, -1, x, r, v);
  OK(dem_add_triangles(dem, "wall", 0, n, vertices));
  OK(dem_start(dem));
  for (int k = 0; k < 500; k++)
    OK(dem_advance(dem, 1e-3, NULL));
  const double m = sphere_mass(s.density, r), slid = m / 7.0 * v0 * v0;
  OK(dem_get_wear(dem, 0, shear, NULL, NULL));
  for (int k = 0; k < n; k++) {
    sum += shear[k];
    worn += shear[k] != 0.0;
  }
  assert_true(worn > 10);
  CLOSE(sum, slid, 2e-3 * slid);
  OK(dem_get_impact(dem, 0, &impact));
  CLOSE(impact.energy, m * g * fall, 0.01 * m * g * fall); /* bounces add e^2 */
  free(shear);
  dem_destroy(dem);
}

/* Two spheres meet head on: m_eff v^2/2, half to each; unequal masses, two materials. */
static void pair(void **state) {
  (void)state;
  scene s = scene_default();
  const double x[3] = {-0.1, 0.0, 0.0}, y[3] = {0.1, 0.0, 0.0};
  const double u[3] = {1.0, 0.0, 0.0}, w[3] = {-0.5, 0.0, 0.0};
  dem_material steel = {.name = "steel", .density = 7800.0, .breakage_coefficient = 0.5};
  dem_impact impact;
  int number;
  s.breakage = 0.1;
  dem_t *dem = scene_create(&s);
  OK(dem_add_material(dem, &steel, &number));
  add_sphere(dem, DEM_FREE, -1, x, 0.01, u);
  dem_insert other = lattice(DEM_FREE, 0.03, y, 0.0, 1, 1, 1);
  strcpy(other.material, "steel");
  memcpy(other.velocity, w, sizeof w);
  OK(dem_insert_particles(dem, &other, -1, NULL));
  OK(dem_start(dem));
  for (int k = 0; k < 400; k++)
    OK(dem_advance(dem, 1e-3, NULL));
  const double a = sphere_mass(2500.0, 0.01), b = sphere_mass(7800.0, 0.015);
  const double energy = 0.5 * a * b / (a + b) * 1.5 * 1.5;
  OK(dem_get_impact(dem, 0, &impact));
  CLOSE(impact.energy, 0.5 * energy, 1e-12 * energy);
  CLOSE(impact.breakage, 0.1 * 0.5 * energy / a, 1e-10);
  OK(dem_get_impact(dem, number, &impact));
  CLOSE(impact.energy, 0.5 * energy, 1e-12 * energy);
  CLOSE(impact.breakage, 0.5 * 0.5 * energy / b, 1e-10);
  dem_destroy(dem);
}

/* ---- many particles ----------------------------------------------------------------------------
 */
enum { N = 120, TRIANGLES = 32 };

static dem_t *shaken_without_particles(MPI_Comm comm) {
  static double vertices[18 * TRIANGLES];
  const double at[3] = {0.0, 0.0, -0.05}, up[3] = {0.0, 0.0, 1.0};
  scene s = scene_default();
  dem_wall_params wall = wall_of(DEM_WALL_TRIANGLES);
  s.comm = comm;
  for (int c = 0; c < 3; c++) {
    s.box.lo[c] = -0.05;
    s.box.hi[c] = 0.05;
    s.box.periodic[c] = c < 2;
  }
  s.params.gravity[2] = -9.81;
  s.contact.normal_stiffness = 2e3;
  s.contact.friction = 0.5;
  s.contact.restitution = 0.6;
  s.contact.wear_coefficient = 1e-9;
  s.breakage = 0.01;
  wall.oscillation_amplitude = 1e-3;
  wall.oscillation_frequency = 30.0;
  set(wall.oscillation_direction, 1.0, 0.0, 1.0);
  dem_t *dem = scene_create(&s);
  OK(dem_add_wall(dem, "floor", &wall, triangulated_square(at, up, 0.1, 4, vertices), vertices));
  return dem;
}

static dem_t *shaken(MPI_Comm comm) {
  dem_t *dem = shaken_without_particles(comm);
  const double from[3] = {-0.05, -0.05, -0.048};
  dem_insert insert = random_spheres(N, 0.008, 0.011, from, 0.1, 3);
  insert.extent[2] = 0.04;
  OK(dem_insert_particles(dem, &insert, -1, NULL));
  OK(dem_start(dem));
  stir(dem, 0.3);
  return dem;
}

static void run(dem_t *dem, int steps) {
  for (int k = 0; k < steps; k++)
    OK(dem_advance(dem, 1e-3, NULL));
}

/* Sums over ranks are those of one rank; a restart goes on with the same bits, on other ranks with
 * the same sums. */
static void ranks_and_restart(void **state) {
  (void)state;
  char path[300];
  const char *folder = getenv("TMPDIR");
  double wear[4][TRIANGLES], sum = 0.0;
  dem_impact impact[4];
  snprintf(path, sizeof path, "%s/dem-wear-%d.vtkhdf", folder != NULL ? folder : "/tmp",
           world_size());
  dem_t *all = shaken(MPI_COMM_WORLD), *one = shaken(MPI_COMM_SELF);
  run(all, 8);
  run(one, 8);
  OK(dem_get_wear(all, 0, wear[0], NULL, NULL));
  OK(dem_get_wear(one, 0, wear[1], NULL, NULL));
  OK(dem_get_impact(all, 0, &impact[0]));
  OK(dem_get_impact(one, 0, &impact[1]));
  for (int k = 0; k < TRIANGLES; k++) {
    sum += wear[1][k];
    CLOSE(wear[0][k], wear[1][k], 1e-12);
  }
  assert_true(sum > 1e-5 && impact[1].energy > 1e-4);
  CLOSE(impact[0].energy, impact[1].energy, 1e-9 * impact[1].energy);
  dem_destroy(one);
  run(all, 10);
  OK(dem_write(all, path, NULL));
  dem_t *again = shaken_without_particles(MPI_COMM_WORLD);
  dem_t *elsewhere = shaken_without_particles(MPI_COMM_SELF);
  OK(dem_read(again, path));
  OK(dem_start(again));
  OK(dem_read(elsewhere, path));
  OK(dem_start(elsewhere));
  OK(dem_get_wear(all, 0, wear[0], NULL, NULL));
  OK(dem_get_wear(elsewhere, 0, wear[2], NULL, NULL));
  OK(dem_get_impact(all, 0, &impact[0]));
  OK(dem_get_impact(elsewhere, 0, &impact[2]));
  for (int k = 0; k < TRIANGLES; k++)
    CLOSE(wear[2][k], wear[0][k], 1e-16);
  CLOSE(impact[2].energy, impact[0].energy, 1e-14);
  run(all, 10);
  run(again, 10);
  OK(dem_get_wear(all, 0, wear[0], NULL, NULL));
  OK(dem_get_wear(again, 0, wear[3], NULL, NULL));
  assert_memory_equal(wear[0], wear[3], sizeof wear[0]);
  OK(dem_get_impact(all, 0, &impact[0]));
  OK(dem_get_impact(again, 0, &impact[3]));
  assert_memory_equal(&impact[0], &impact[3], sizeof impact[0]);
  dem_destroy(all);
  dem_destroy(again);
  dem_destroy(elsewhere);
  MPI_Barrier(MPI_COMM_WORLD);
  if (world_rank() == 0)
    remove(path);
}

static void bad_input(void **state) {
  (void)state;
  scene s = scene_default();
  const double up[3] = {0.0, 0.0, 1.0}, x[3] = {0.0, 0.0, 0.02};
  dem_material bad = {.name = "bad", .density = 1000.0, .breakage_coefficient = -1.0};
  dem_impact impact;
  dem_t *dem = scene_create(&s);
  FAILS(PART_ERR_RANGE, "breakageCoefficient", dem_add_material(dem, &bad, NULL));
  s.contact.wear_coefficient = -1e-9;
  FAILS(PART_ERR_RANGE, "wearCoefficient", dem_set_contact(dem, 0, 0, &s.contact));
  OK(dem_add_plane(dem, "floor", 0, still, up));
  add_sphere(dem, DEM_FREE, -1, x, 0.01, still);
  OK(dem_start(dem));
  FAILS(PART_ERR_STATE, "wearCoefficient", dem_get_wear(dem, 0, NULL, NULL, NULL));
  FAILS(PART_ERR_STATE, "breakageCoefficient", dem_get_impact(dem, 0, &impact));
  dem_destroy(dem);
  s.contact.wear_coefficient = 1e-9;
  s.breakage = 1.0;
  dem = scene_create(&s);
  OK(dem_add_plane(dem, "floor", 0, still, up));
  add_sphere(dem, DEM_FREE, -1, x, 0.01, still);
  OK(dem_start(dem));
  double area;
  OK(dem_get_wear(dem, 0, NULL, NULL, &area));
  assert_true(isinf(area));
  FAILS(PART_ERR_RANGE, "wall 1", dem_get_wear(dem, 1, NULL, NULL, NULL));
  FAILS(PART_ERR_RANGE, "material 1", dem_get_impact(dem, 1, &impact));
  dem_destroy(dem);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(one_impact),        cmocka_unit_test(rolling),   cmocka_unit_test(pair),
      cmocka_unit_test(ranks_and_restart), cmocka_unit_test(bad_input),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
