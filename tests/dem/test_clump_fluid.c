/* ranks: 1 2 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Clumps under fluid forces and kicks, over a periodic border, and bad insertions. */
#include "clump_scenes.h"

static const double nowhere[3] = {0.0, 0.0, 0.0};

/* Equal drag on both spheres of a rod along x that spins about z: translation is the closed form
 * of a particle, the spin decays with D/I = 2 Sp r^2/(1.4 m r^2), whatever the stiffness. */
static void drag_of_rod(void **state) {
  (void)state;
  const double r = 0.005, dt = 1e-3, spin[3] = {0.0, 0.0, 0.7}, v0[3] = {0.03, -0.01, 0.0};
  const double su[3] = {1e-5, 0.0, 3e-5};
  for (double stiff = 1e-6; stiff < 2e6; stiff *= 100.0) {
    scene s = scene_default();
    s.params.gravity[2] = -9.81;
    dem_t *dem = scene_create(&s);
    dem_insert insert = one_clump(rod_shape(), nowhere, v0, spin);
    OK(dem_insert_particles(dem, &insert, -1, NULL));
    OK(dem_start(dem));
    const double m = 2.0 * sphere_mass(s.density, r), sp = stiff * m / 2.0 / dt;
    double impulse[3] = {0.0, 0.0, 0.0}, scale = 0.0;
    const int steps = 20;
    for (int n = 0; n < steps; n++) {
      body end[2];
      set_fluid(dem, su, sp);
      OK(dem_advance(dem, dt, NULL));
      find_all(dem, s.comm, 2, end);
      for (int c = 0; c < 3; c++)
        impulse[c] += end[0].impulse[c] + end[1].impulse[c];
    }
    dem_clump_report a;
    OK(dem_clump_state(dem, 0, &a));
    const double t = steps * dt, b = 2.0 * sp * t / m;
    for (int c = 0; c < 3; c++) {
      const double f = 2.0 * su[c] + m * s.params.gravity[c];
      scale = fabs(f) / m * t + 0.03;
      CLOSE(a.velocity[c], v0[c] * exp(-b) - f * t / m * expm1(-b) / b, 1e-13 * scale);
      CLOSE(m * (a.velocity[c] - v0[c]), m * s.params.gravity[c] * t + impulse[c],
            1e-13 * m * scale); /* m is known to the accuracy of the union */
    }
    CLOSE(a.angular_velocity[2], 0.7 * exp(-2.0 * sp * t / (1.4 * m)), 1e-13);
    dem_report report;
    OK(dem_get_report(dem, &report));
    CLOSE(report.budget_error, 0.0, 1e-13);
    dem_destroy(dem);
  }
}

/* Uneven drag and force on a body without symmetry, in a shear flow Su = Sp (y, 0, 0) rate. */
static void uneven_fluid(dem_t *dem, double sp, double rate) {
  const part_store *store = dem_store(dem);
  const int64_t *id = part_field_int64(store, DEM_FIELD_ID);
  const double *x = part_field_double(store, DEM_FIELD_POSITION);
  double *fluid = part_field_double(store, DEM_FIELD_FLUID_SU);
  for (int i = 0; i < store->local; i++) {
    double *f = fluid + 8 * i;
    f[3] = sp * (1.0 + 0.5 * cos((double)id[4 * i]));
    f[0] = f[3] * rate * x[4 * i + 1];
    f[1] = f[2] = 0.0;
  }
}

static dem_clump_report in_shear(double sp, double dt, int steps) {
  scene s = scene_default();
  dem_t *dem = scene_create(&s);
  const double v[3] = {0.01, 0.02, 0.03}, w[3] = {1.0, 2.0, -3.0};
  dem_insert insert = one_clump(ell_shape(), nowhere, v, w);
  OK(dem_insert_particles(dem, &insert, -1, NULL));
  OK(dem_start(dem));
  for (int n = 0; n < steps; n++) {
    uneven_fluid(dem, sp, 0.0);
    OK(dem_advance(dem, dt, NULL));
  }
  dem_clump_report a;
  dem_report report;
  OK(dem_clump_state(dem, 0, &a));
  OK(dem_get_report(dem, &report));
  CLOSE(report.budget_error, 0.0, 1e-12);
  dem_destroy(dem);
  return a;
}

/* Second order in the step where it resolves the drag; stable, and at rest, where it does not. */
static void uneven_drag(void **state) {
  (void)state;
  dem_clump_report a[4];
  for (int k = 0; k < 4; k++)
    a[k] = in_shear(0.02, 0.02 / (1 << k), 16 << k); /* m/Sp about 0.03 s */
  for (int c = 0; c < 3; c++) {
    const double coarse = a[1].angular_velocity[c] - a[2].angular_velocity[c];
    const double fine = a[2].angular_velocity[c] - a[3].angular_velocity[c];
    CLOSE(coarse / fine, 4.0, 0.3);
    const double slow = a[1].velocity[c] - a[2].velocity[c];
    CLOSE(slow / (a[2].velocity[c] - a[3].velocity[c]), 4.0, 0.3);
  }
  for (double sp = 1.0; sp < 1e7; sp *= 100.0) {
    const dem_clump_report b = in_shear(sp, 0.02, 50);
    for (int c = 0; c < 3; c++) {
      CLOSE(b.velocity[c], 0.0, 1e-6);
      CLOSE(b.angular_velocity[c], 0.0, 1e-4);
    }
  }
}

/* In a shear a stiff body without freedom to slip turns as the flow does: the rod along the flow
 * gradient at the rate of the shear, v = rate y. */
static void turned_by_shear(void **state) {
  (void)state;
  scene s = scene_default();
  dem_t *dem = scene_create(&s);
  dem_insert insert = one_clump(rod_shape(), nowhere, nowhere, nowhere);
  insert.method = DEM_INSERT_FILE; /* quarter turn about z: rod along y */
  strcpy(insert.file, write_clump_file("places", "0 0.3 0 0 0 0 0 1 0 0 1\n"));
  OK(dem_insert_particles(dem, &insert, -1, NULL));
  OK(dem_start(dem));
  uneven_fluid(dem, 1e3, 5.0);
  OK(dem_advance(dem, 1e-3, NULL));
  dem_clump_report a;
  OK(dem_clump_state(dem, 0, &a));
  /* Drags Sp (1 + cos(id)/2) on two spheres with two velocities: both go with the flow. */
  CLOSE(a.velocity[0], 5.0 * 0.3, 1e-3);
  CLOSE(a.angular_velocity[2], -5.0, 0.05);
  dem_destroy(dem);
}

static void kicks(void **state) {
  (void)state;
  scene s = scene_default();
  dem_t *dem = scene_create(&s);
  dem_insert insert = one_clump(rod_shape(), nowhere, nowhere, nowhere);
  OK(dem_insert_particles(dem, &insert, -1, NULL));
  OK(dem_start(dem));
  const part_store *store = dem_store(dem);
  const int64_t *id = part_field_int64(store, DEM_FIELD_ID);
  double impulse[6] = {0.0};
  for (int i = 0; i < store->local; i++)
    impulse[3 * i + 1] = id[4 * i] == 1 ? 1e-4 : 0.0; /* the right one, along y */
  OK(dem_kick(dem, impulse));
  dem_clump_report a;
  OK(dem_clump_state(dem, 0, &a));
  const double r = 0.005, m = 2.0 * sphere_mass(s.density, r);
  CLOSE(a.velocity[1], 1e-4 / m, 1e-12 / m);
  CLOSE(a.angular_velocity[2], 1e-4 * r / (1.4 * m * r * r), 1e-8);
  const body right = find(dem, s.comm, 1);
  CLOSE(right.v[1], a.velocity[1] + r * a.angular_velocity[2], 1e-12);
  dem_report report;
  OK(dem_get_report(dem, &report));
  CLOSE(report.budget_error, 0.0, 1e-14);
  FAILS(PART_ERR_RANGE, "clump 1", dem_clump_state(dem, 1, &a));
  dem_destroy(dem);
}

/* A rod over the border of a periodic box meets a sphere at the other end of the box, as it would
 * in the middle. */
static void over_the_border(void **state) {
  (void)state;
  body end[2][3];
  for (int shifted = 0; shifted < 2; shifted++) {
    scene s = scene_default();
    for (int c = 0; c < 3; c++) {
      s.box.lo[c] = -0.05;
      s.box.hi[c] = 0.05;
      s.box.periodic[c] = 1;
    }
    s.contact.friction = 0.3;
    s.contact.restitution = 0.6;
    dem_t *dem = scene_create(&s);
    const double shift = shifted ? 0.049 : 0.0, v[3] = {0.3, 0.0, 0.0}, w[3] = {0.0, 0.0, 3.0};
    const double at[3] = {shift, shift, 0.0},
                 ball[3] = {shift + 0.018 - 0.1 * shifted, shift + 0.003, 0.0};
    dem_insert insert = one_clump(rod_shape(), at, v, w);
    OK(dem_insert_particles(dem, &insert, -1, NULL));
    add_sphere(dem, DEM_FREE, -1,
               (double[3]){ball[0], ball[1] > 0.05 ? ball[1] - 0.1 : ball[1], ball[2]}, 0.005,
               nowhere);
    OK(dem_start(dem));
    for (int n = 0; n < 100; n++)
      OK(dem_advance(dem, 2e-3, NULL));
    find_all(dem, s.comm, 3, end[shifted]);
    dem_destroy(dem);
  }
  assert_true(fabs(end[0][2].v[0]) > 0.01); /* they met */
  for (int k = 0; k < 3; k++)
    for (int c = 0; c < 3; c++) {
      double d = end[1][k].x[c] - end[0][k].x[c] - (c < 2 ? 0.049 : 0.0);
      d -= 0.1 * floor(d / 0.1 + 0.5);
      CLOSE(d, 0.0, 1e-12);
      CLOSE(end[1][k].v[c], end[0][k].v[c], 1e-11);
      CLOSE(end[1][k].w[c], end[0][k].w[c], 1e-8);
    }
}

static void bad_insertions(void **state) {
  (void)state;
  scene s = scene_default();
  s.box.periodic[0] = 1;
  const char *shape = rod_shape();
  const double up[3] = {0.0, 0.0, 1.0}, out[3] = {0.0, 0.0, 1.5};
  dem_t *dem = scene_create(&s);
  dem_insert insert = one_clump("", nowhere, nowhere, nowhere);
  FAILS(PART_ERR_RANGE, "entry shape: must be given for kind clump",
        dem_insert_particles(dem, &insert, -1, NULL));
  insert = one_clump(shape, nowhere, nowhere, nowhere);
  insert.kind = DEM_FREE;
  insert.diameter = 0.1;
  FAILS(PART_ERR_RANGE, "entry shape", dem_insert_particles(dem, &insert, -1, NULL));
  insert.shape[0] = '\0';
  insert.kind = DEM_FIXED;
  insert.angular_velocity[2] = 1.0;
  FAILS(PART_ERR_RANGE, "angularVelocity", dem_insert_particles(dem, &insert, -1, NULL));
  insert = one_clump("/no/such/shape", nowhere, nowhere, nowhere);
  FAILS(PART_ERR_IO, "/no/such/shape: cannot be opened",
        dem_insert_particles(dem, &insert, -1, NULL));
  insert = one_clump(shape, out, nowhere, nowhere);
  FAILS(PART_ERR_OUTSIDE, "clump 0", dem_insert_particles(dem, &insert, -1, NULL));
  insert = one_clump(shape, nowhere, nowhere, nowhere);
  insert.diameter = 1.0;
  FAILS(PART_ERR_RANGE, "a quarter of the periodic length in x",
        dem_insert_particles(dem, &insert, -1, NULL));
  insert.diameter = -1.0;
  FAILS(PART_ERR_RANGE, "diameter", dem_insert_particles(dem, &insert, -1, NULL));
  insert = one_clump(shape, nowhere, nowhere, nowhere);
  OK(dem_insert_particles(dem, &insert, -1, NULL));
  insert.origin[1] = 0.009;
  FAILS(PART_ERR_OVERLAP, "particles 0 and 2 overlap by 0.001",
        dem_insert_particles(dem, &insert, -1, NULL));
  insert.origin[1] = 0.0101; /* bounding spheres overlap, spheres do not */
  OK(dem_insert_particles(dem, &insert, -1, NULL));
  insert = random_clumps(shape, 3, 0.0, 0.0, nowhere, 0.019, 1);
  FAILS(PART_ERR_RANGE, "does not hold", dem_insert_particles(dem, &insert, -1, NULL));
  insert = one_clump(shape, nowhere, nowhere, nowhere);
  insert.method = DEM_INSERT_FILE;
  const struct {
    const char *text, *words;
    int status;
  } bad[] = {
      {"0 0 0.5 0 1 2 3 1 0 0\n", "line 1: 10 numbers; must be 4, 7 or 11", PART_ERR_FORMAT},
      {"0 0 0.5 0\n0 0 0.6 0 0 0 0 0 0 0 0\n", "line 2: the quaternion must not be zero",
       PART_ERR_RANGE},
      {"0 0 0.5 -1\n", "line 1: diameter -1", PART_ERR_RANGE},
  };
  for (int k = 0; k < 3; k++) {
    strcpy(insert.file, write_clump_file("bad", bad[k].text));
    FAILS(bad[k].status, bad[k].words, dem_insert_particles(dem, &insert, -1, NULL));
  }
  OK(dem_add_plane(dem, "floor", 0, (double[3]){0.0, 0.0, -0.004}, up));
  FAILS(PART_ERR_OVERLAP, "overlaps wall floor", dem_start(dem));
  dem_destroy(dem);
  s.params.dimensions = 2;
  s.params.depth = 1.0;
  dem = scene_create(&s);
  insert = one_clump(shape, nowhere, nowhere, nowhere);
  FAILS(PART_ERR_RANGE, "clump is not allowed with dimensions 2",
        dem_insert_particles(dem, &insert, -1, NULL));
  dem_destroy(dem);
}

/* Size by equal volume, attitude by the file, by seed and by the line. */
static void placed_as_asked(void **state) {
  (void)state;
  scene s = scene_default();
  dem_t *dem = scene_create(&s);
  dem_insert insert = one_clump(rod_shape(), nowhere, nowhere, nowhere);
  dem_clump_report a;
  insert.diameter = 0.1;
  OK(dem_insert_particles(dem, &insert, -1, NULL));
  insert.method = DEM_INSERT_FILE;
  strcpy(insert.file, write_clump_file("places", "0 0.5 0 0 0 0 0 1 0 0 1 # about z\n"
                                                 "0 -0.5 0 0.02\n"));
  OK(dem_insert_particles(dem, &insert, -1, NULL));
  OK(dem_start(dem));
  OK(dem_clump_state(dem, 0, &a));
  CLOSE(a.mass, sphere_mass(s.density, 0.05), 1e-9 * a.mass);
  body all[6];
  find_all(dem, s.comm, 6, all);
  CLOSE(all[1].x[0] - all[0].x[0], 0.1 / cbrt(2.0), 1e-10);
  CLOSE(all[3].x[1] - all[2].x[1], 0.01, 1e-12);
  CLOSE(all[3].x[0], 0.0, 1e-12);
  CLOSE(all[5].x[0] - all[4].x[0], 0.02 / cbrt(2.0), 1e-11);
  dem_destroy(dem);
  /* Random attitudes: the mean of many axes is small, and they are those of the seed. */
  double mean[2][3] = {{0.0}};
  for (int k = 0; k < 2; k++) {
    enum { MANY = 400 };
    static body each[2 * MANY];
    dem = scene_create(&s);
    insert = random_clumps(rod_shape(), MANY, 0.0, 0.0, (double[3]){-1.0, -1.0, -1.0}, 2.0, 7);
    OK(dem_insert_particles(dem, &insert, -1, NULL));
    OK(dem_start(dem));
    find_all(dem, s.comm, 2 * MANY, each);
    double second[3] = {0.0, 0.0, 0.0};
    for (int m = 0; m < MANY; m++)
      for (int c = 0; c < 3; c++) {
        const double n = (each[2 * m + 1].x[c] - each[2 * m].x[c]) / 0.01;
        mean[k][c] += n / MANY;
        second[c] += n * n / MANY;
      }
    for (int c = 0; c < 3; c++) { /* three standard deviations of 400: 0.087 and 0.045 */
      CLOSE(mean[k][c], 0.0, 0.087);
      CLOSE(second[c], 1.0 / 3.0, 0.045);
    }
    dem_destroy(dem);
  }
  assert_memory_equal(mean[0], mean[1], sizeof mean[0]);
}

/* What the fluid sees of members takes up the volume of the union, of any size; a free sphere is as
 * it is. */
static void volume_for_the_fluid(void **state) {
  (void)state;
  enum { CLUMPS = 6, SPHERES = 5 * CLUMPS + 1 };
  const double pi = 3.14159265358979323846, x[3] = {0.5, 0.0, 0.0};
  const char *shape = ell_shape();
  scene s = scene_default();
  dem_clump_shape_report form;
  dem_t *dem = scene_create(&s);
  OK(dem_get_clump_shape(dem, shape, &form));
  dem_insert insert = random_clumps(shape, CLUMPS, 0.0, 0.0, (double[3]){-0.1, -0.1, -0.1}, 0.2, 3);
  double r[SPHERES], whole[SPHERES];
  FAILS(PART_ERR_STATE, "dem_start", dem_fluid_spheres(dem, r, whole));
  OK(dem_insert_particles(dem, &insert, -1, NULL));
  add_sphere(dem, DEM_FREE, -1, x, 0.01, nowhere);
  OK(dem_start(dem));
  const part_store *store = dem_store(dem);
  const int64_t *kind = part_field_int64(store, DEM_FIELD_KIND);
  double sum[2] = {0.0, 0.0}; /* of members, of free ones */
  assert_true(store->local <= SPHERES);
  OK(dem_fluid_spheres(dem, r, whole));
  for (int i = 0; i < store->local; i++) {
    const int is_free = kind[i * part_field_stride(store, DEM_FIELD_KIND)] == DEM_FREE;
    sum[is_free] += 4.0 / 3.0 * pi * r[i] * r[i] * r[i];
    CLOSE(whole[i], is_free ? 0.01 : cbrt(form.volume * 3.0 / (4.0 * pi)), 1e-15);
  }
  MPI_Allreduce(MPI_IN_PLACE, sum, 2, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  CLOSE(sum[0], CLUMPS * form.volume, 1e-12 * sum[0]);
  CLOSE(sum[1], 4.0 / 3.0 * pi * 1e-6, 1e-12 * sum[1]);
  dem_destroy(dem);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(drag_of_rod),     cmocka_unit_test(uneven_drag),
      cmocka_unit_test(turned_by_shear), cmocka_unit_test(kicks),
      cmocka_unit_test(over_the_border), cmocka_unit_test(placed_as_asked),
      cmocka_unit_test(bad_insertions),  cmocka_unit_test(volume_for_the_fluid),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, remove_clump_files);
  MPI_Finalize();
  return failed;
}
