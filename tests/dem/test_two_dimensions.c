/* ranks: 1 2 3 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Discs in a plane of constant z: mass, inertia, contact, walls, and nothing out of the plane. */
#include "common.h"

#include "../../libdem/src/fast.h"

static const double depth = 0.02, level = 0.3;

static scene flat_scene(void) {
  scene s = scene_default();
  s.params.dimensions = 2;
  s.params.depth = depth;
  return s;
}

static double disc_mass(double density, double r) {
  return density * PI * r * r * depth;
}

static void add_disc(dem_t *dem, double x, double y, double r, double vx, double vy) {
  const double at[3] = {x, y, level}, v[3] = {vx, vy, 0.0};
  add_sphere(dem, DEM_FREE, -1, at, r, v);
}

/* Two unequal discs meet head-on: masses rho pi r^2 depth, momentum, restitution. */
static void head_on(void **state) {
  (void)state;
  scene s = flat_scene();
  s.contact.restitution = 0.7;
  dem_t *dem = scene_create(&s);
  dem_report report;
  add_disc(dem, -0.1, 0.0, 0.01, 1.0, 0.0);
  add_disc(dem, -0.06, 0.0, 0.02, 0.0, 0.0);
  OK(dem_start(dem));
  OK(dem_get_report(dem, &report));
  const double m1 = disc_mass(s.density, 0.01), m2 = disc_mass(s.density, 0.02);
  CLOSE(report.momentum[0], m1, 1e-15 * m1);
  OK(dem_advance(dem, 0.05, NULL));
  /* tc/50: 1e-3, the bar of restitution for spheres. */
  const double v1 = (m1 - 0.7 * m2) / (m1 + m2), v2 = 1.7 * m1 / (m1 + m2);
  CLOSE(find(dem, s.comm, 0).v[0], v1, 1e-3);
  CLOSE(find(dem, s.comm, 1).v[0], v2, 1e-3);
  OK(dem_get_report(dem, &report));
  CLOSE(report.budget_error, 0.0, 1e-13);
  dem_destroy(dem);
}

/* The step follows the tangential mass 1/3 m_eff where that contact time is the shorter one. */
static void stable_step(void **state) {
  (void)state;
  scene s = flat_scene();
  s.contact.friction = 0.5;
  s.contact.tangential_ratio = 1.0;
  dem_t *dem = scene_create(&s);
  add_disc(dem, -0.1, 0.0, 0.01, 0.0, 0.0);
  add_disc(dem, 0.1, 0.0, 0.01, 0.0, 0.0);
  OK(dem_start(dem));
  const double m_eff = 0.5 * disc_mass(s.density, 0.01);
  const double t = PI * sqrt(m_eff / 3.0 / s.contact.normal_stiffness);
  CLOSE(dem_stable_step(dem), s.params.time_step_fraction * t, 1e-15 * t);
  dem_destroy(dem);
}

/* A cylinder that rolls down without sliding: 2/3 g sin a (a sphere: 5/7). */
static void rolling(void **state) {
  (void)state;
  const double at[3] = {0.0, 0.0, 0.0}, r = 0.01, angle = 0.3, g = 9.81;
  const double normal[3] = {sin(angle), cos(angle), 0.0};
  scene s = flat_scene();
  s.contact.friction = 0.8;
  s.contact.restitution = 0.3;
  s.params.gravity[1] = -g;
  dem_t *dem = scene_create(&s);
  OK(dem_add_plane(dem, "slope", 0, at, normal));
  const double sink = disc_mass(s.density, r) * g * cos(angle) / s.contact.normal_stiffness;
  add_disc(dem, (r - sink) * normal[0], (r - sink) * normal[1], r, 0.0, 0.0);
  OK(dem_start(dem));
  OK(dem_advance(dem, 0.1, NULL));
  const body one = find(dem, s.comm, 0), *now = &one;
  OK(dem_advance(dem, 0.2, NULL));
  const body two = find(dem, s.comm, 0);
  const double v1 = now->v[0] * cos(angle) - now->v[1] * sin(angle);
  const double v2 = two.v[0] * cos(angle) - two.v[1] * sin(angle);
  /* The tangential spring swings about its rest at first: 1e-3 after a hundred damped periods. */
  CLOSE((v2 - v1) / 0.2, 2.0 / 3.0 * g * sin(angle), 1e-3 * g);
  CLOSE(-two.w[2] * r, v2, 1e-3 * v2);
  dem_destroy(dem);
}

enum { N = 300 };

/* Walls of a box as triangles; front and back are left out. */
static void add_box(dem_t *dem, double length) {
  const double lo = 0.0, hi = length, z0 = level - depth, z1 = level + depth;
  const double corner[8][3] = {{lo, lo, z0}, {hi, lo, z0}, {hi, hi, z0}, {lo, hi, z0},
                               {lo, lo, z1}, {hi, lo, z1}, {hi, hi, z1}, {lo, hi, z1}};
  static const int quad[6][4] = {{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6},
                                 {3, 0, 4, 7}, {0, 1, 2, 3}, {4, 5, 6, 7}};
  double vertices[12 * 9], *to = vertices;
  for (int q = 0; q < 6; q++) {
    static const int fan[6] = {0, 1, 2, 0, 2, 3};
    for (int k = 0; k < 6; k++, to += 3)
      memcpy(to, corner[quad[q][fan[k]]], 3 * sizeof *to);
  }
  OK(dem_add_triangles(dem, "box", 0, 12, vertices));
}

static dem_t *gas_without_particles(double friction, double restitution, double length) {
  scene s = flat_scene();
  for (int c = 0; c < 2; c++) {
    s.box.lo[c] = -0.01;
    s.box.hi[c] = length + 0.01;
  }
  s.box.lo[2] = level - depth;
  s.box.hi[2] = level + depth;
  s.contact.friction = friction;
  s.contact.restitution = restitution;
  s.contact.normal_stiffness = 2e4;
  dem_t *dem = scene_create(&s);
  add_box(dem, length);
  return dem;
}

static double gas_length(void) {
  return sqrt(N * PI * 0.005 * 0.005 / 0.35);
}

static dem_t *gas(double friction, double restitution, int width) {
  const double length = gas_length(), from[3] = {0.0, 0.0, level};
  dem_t *dem = gas_without_particles(friction, restitution, length);
  dem_insert insert = random_spheres(N, 0.008, 0.011, from, length, 5);
  insert.extent[2] = 0.0;
  OK(dem_insert_particles(dem, &insert, -1, NULL));
  OK(dem_fast_limit(dem, width));
  OK(dem_start(dem));
  part_store *store = dem_store(dem);
  double *v = part_field_double(store, DEM_FIELD_VELOCITY);
  const int64_t *id = part_field_int64(store, DEM_FIELD_ID);
  for (int i = 0; i < store->local; i++) {
    const double phase = (double)id[i * part_field_stride(store, DEM_FIELD_ID)];
    double *vi = v + i * part_field_stride(store, DEM_FIELD_VELOCITY);
    vi[0] = sin(12.9898 * phase * phase);
    vi[1] = sin(78.233 * phase * phase + 1.0);
  }
  return dem;
}

/* Kinetic energy and that of the springs of all contacts. */
static double energy(dem_t *dem) {
  static body bodies[N];
  dem_report report;
  double total = 0.0, r[N];
  const part_store *store = dem_store(dem);
  const int64_t *id = part_field_int64(store, DEM_FIELD_ID);
  const double *radius = part_field_double(store, DEM_FIELD_RADIUS);
  OK(dem_get_report(dem, &report));
  find_all(dem, MPI_COMM_WORLD, N, bodies);
  memset(r, 0, sizeof r);
  for (int i = 0; i < store->local; i++)
    r[id[i * part_field_stride(store, DEM_FIELD_ID)]] =
        radius[i * part_field_stride(store, DEM_FIELD_RADIUS)];
  MPI_Allreduce(MPI_IN_PLACE, r, N, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  for (int k = 0; k < N; k++) {
    const double *x = bodies[k].x, end = gas_length();
    const double gap[4] = {x[0], end - x[0], x[1], end - x[1]};
    for (int w = 0; w < 4; w++)
      total += 0.5 * 2e4 * pow(fmax(r[k] - gap[w], 0.0), 2.0);
    for (int m = 0; m < k; m++)
      total +=
          0.5 * 2e4 *
          pow(fmax(r[k] + r[m] - hypot(x[0] - bodies[m].x[0], x[1] - bodies[m].x[1]), 0.0), 2.0);
  }
  return report.kinetic_energy + total;
}

/* An elastic gas keeps its energy, and stays in the plane to the last bit. */
static void elastic_gas(void **state) {
  (void)state;
  static body bodies[N];
  dem_report report;
  dem_t *dem = gas(0.0, 1.0, 0);
  const double before = energy(dem);
  OK(dem_advance(dem, 4000.0 * dem_stable_step(dem), NULL));
  OK(dem_get_report(dem, &report));
  assert_true(report.contacts + report.wall_contacts > 5);
  /* Velocity Verlet at tc/50 keeps it to (omega dt)^2/8 = 5e-4 within contacts. */
  CLOSE(energy(dem) / before, 1.0, 5e-4);
  find_all(dem, MPI_COMM_WORLD, N, bodies);
  for (int k = 0; k < N; k++) {
    assert_true(bodies[k].x[2] == level);
    assert_true(bodies[k].v[2] == 0.0);
    assert_true(bodies[k].x[0] > 0.0 && bodies[k].x[0] < gas_length());
    assert_true(bodies[k].x[1] > 0.0 && bodies[k].x[1] < gas_length());
  }
  dem_destroy(dem);
}

/* With friction: spins about z only; the vector path is the plain one. */
static void vector_path(void **state) {
  (void)state;
  static body plain[N], fast[N];
  static const int width[3] = {1, 4, 8};
  for (int k = 0; k < 3; k++) {
    dem_t *dem = gas(0.5, 0.8, width[k]);
    OK(dem_advance(dem, 300.0 * dem_stable_step(dem), NULL));
    find_all(dem, MPI_COMM_WORLD, N, k == 0 ? plain : fast);
    dem_destroy(dem);
    double spin = 0.0;
    for (int i = 0; k > 0 && i < N; i++) {
      for (int c = 0; c < 3; c++) {
        CLOSE(fast[i].x[c], plain[i].x[c], 1e-11);
        CLOSE(fast[i].v[c], plain[i].v[c], 1e-8);
        CLOSE(fast[i].w[c], plain[i].w[c], 1e-5);
      }
      assert_true(fast[i].x[2] == level && fast[i].v[2] == 0.0);
      assert_true(fast[i].w[0] == 0.0 && fast[i].w[1] == 0.0);
      spin = fmax(spin, fabs(fast[i].w[2]));
    }
    assert_true(k == 0 || spin > 1.0);
  }
}

static void restart(void **state) {
  (void)state;
  static body here[N], there[N];
  char path[300];
  const char *folder = getenv("TMPDIR");
  snprintf(path, sizeof path, "%s/dem-flat-%d.vtkhdf", folder != NULL ? folder : "/tmp",
           world_size());
  dem_t *one = gas(0.5, 0.8, 0);
  OK(dem_advance(one, 300.0 * dem_stable_step(one), NULL));
  OK(dem_write(one, path, NULL));
  dem_t *two = gas_without_particles(0.5, 0.8, gas_length());
  OK(dem_read(two, path));
  OK(dem_start(two));
  OK(dem_advance(one, 200.0 * dem_stable_step(one), NULL));
  OK(dem_advance(two, 200.0 * dem_stable_step(two), NULL));
  find_all(one, MPI_COMM_WORLD, N, here);
  find_all(two, MPI_COMM_WORLD, N, there);
  assert_memory_equal(here, there, sizeof here);
  dem_destroy(one);
  dem_destroy(two);
  scene s = scene_default();
  dem_t *three = scene_create(&s);
  const double at[3] = {0.0, 0.0, 0.0}, up[3] = {0.0, 0.0, 1.0};
  double vertices[8 * 9];
  OK(dem_add_triangles(three, "box", 0, triangulated_square(at, up, 1.0, 2, vertices), vertices));
  FAILS(PART_ERR_FORMAT, "depth of 0.02 m", dem_read(three, path));
  dem_destroy(three);
  MPI_Barrier(MPI_COMM_WORLD);
  if (world_rank() == 0)
    remove(path);
}

static int create(const scene *s) {
  dem_t *dem;
  const int status = dem_create(s->comm, &s->box, &s->params, &dem);
  dem_destroy(dem);
  return status;
}

static void bad_scenes(void **state) {
  (void)state;
  scene s = scene_default();
  s.params.dimensions = 4;
  FAILS(PART_ERR_RANGE, "entry dimensions: 4", create(&s));
  s = scene_default();
  s.params.depth = 0.1;
  FAILS(PART_ERR_RANGE, "depth is not allowed with dimensions 3", create(&s));
  s = flat_scene();
  s.params.depth = 0.0;
  FAILS(PART_ERR_RANGE, "depth must be given", create(&s));
  s = flat_scene();
  s.params.gravity[2] = -9.81;
  FAILS(PART_ERR_RANGE, "entry gravity: its z component", create(&s));
  s = flat_scene();
  s.box.periodic[2] = 1;
  FAILS(PART_ERR_RANGE, "periodic in z", create(&s));
}

static void bad_contacts(void **state) {
  (void)state;
  scene s = flat_scene();
  dem_t *dem = scene_create(&s);
  dem_contact contact = s.contact;
  contact.normal_stiffness = (double)NAN;
  FAILS(PART_ERR_RANGE, "normalStiffness must be given", dem_set_contact(dem, 0, 0, &contact));
  OK(part_params_set(&dem_contact_table, "law", NULL, "hertzMindlin", &contact));
  FAILS(PART_ERR_RANGE, "must be linearSpringDashpot", dem_set_contact(dem, 0, 0, &contact));
  contact = s.contact;
  contact.work_of_adhesion = 0.1;
  FAILS(PART_ERR_RANGE, "entry workOfAdhesion", dem_set_contact(dem, 0, 0, &contact));
  dem_destroy(dem);
}

static void bad_insertion(void **state) {
  (void)state;
  scene s = flat_scene();
  const double at[3] = {0.0, 0.0, level}, up[3] = {0.0, 0.1, 0.9};
  double vertices[2 * 9];
  dem_t *dem = scene_create(&s);
  dem_insert insert = lattice(DEM_FREE, 0.01, at, 0.02, 2, 2, 2);
  FAILS(PART_ERR_RANGE, "all centres have the same z",
        dem_insert_particles(dem, &insert, -1, NULL));
  insert.count[2] = 1.0;
  insert.velocity[2] = 1.0;
  FAILS(PART_ERR_RANGE, "1 m/s along z", dem_insert_particles(dem, &insert, -1, NULL));
  insert = random_spheres(10, 0.01, 0.01, at, 0.3, 1);
  FAILS(PART_ERR_RANGE, "entry extent: 0.3 m in z", dem_insert_particles(dem, &insert, -1, NULL));
  insert.extent[2] = 0.0;
  insert.number = 1000;
  FAILS(PART_ERR_RANGE, "1000 discs would fill 0.873",
        dem_insert_particles(dem, &insert, -1, NULL));
  FAILS(PART_ERR_RANGE, "normal has a z component", dem_add_plane(dem, "tilted", 0, at, up));
  const double unit[3] = {0.0, 0.6, 0.8}, z[3] = {0.0, 0.0, 1.0};
  triangulated_square(at, unit, 0.1, 1, vertices);
  FAILS(PART_ERR_RANGE, "inclined", dem_add_triangles(dem, "tilted", 0, 2, vertices));
  triangulated_square(at, z, 0.1, 1, vertices);
  FAILS(PART_ERR_RANGE, "no triangle stands", dem_add_triangles(dem, "front", 0, 2, vertices));
  dem_destroy(dem);
}

static void bad_forces(void **state) {
  (void)state;
  scene s = flat_scene();
  const double su[3] = {0.0, 0.0, 1.0};
  dem_t *dem = scene_create(&s);
  double impulse[3] = {0.0, 0.0, 1.0};
  add_disc(dem, 0.0, 0.0, 0.01, 0.0, 0.0);
  OK(dem_start(dem));
  FAILS(PART_ERR_RANGE, "z component", dem_kick(dem, impulse));
  set_fluid(dem, su, 0.0);
  FAILS(PART_ERR_RANGE, "z component", dem_advance(dem, 1e-3, NULL));
  dem_destroy(dem);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(head_on),      cmocka_unit_test(stable_step),   cmocka_unit_test(rolling),
      cmocka_unit_test(elastic_gas),  cmocka_unit_test(vector_path),   cmocka_unit_test(restart),
      cmocka_unit_test(bad_scenes),   cmocka_unit_test(bad_insertion), cmocka_unit_test(bad_forces),
      cmocka_unit_test(bad_contacts),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
