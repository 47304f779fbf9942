/* ranks: 1 3 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Going on from a file is the same computation as going on in memory, bit for bit. */
#include "common.h"

enum { N = 12 * 10 * 9 };

/* Sloshing water between walls, periodic along x; every stored quantity is in use. */
static sph_t *scene_without_particles(const scene *s) {
  sph_t *sph = scene_create(s);
  for (int c = 1; c < 3; c++)
    if (!s->box.periodic[c])
      add_planes(sph, s, c, c == 1 ? SPH_NO_SLIP : SPH_FREE_SLIP);
  return sph;
}

static scene tank(int scheme) {
  const double length[3] = {0.12, 0.1, 0.14};
  scene s = scene_3d(length, 0.01);
  s.params.kernel = SPH_KERNEL_cubic_spline;
  s.params.smoothing_length = 0.013;
  s.params.skin_fraction = 0.05;
  s.box.periodic[0] = 1;
  s.params.gravity[2] = -9.81;
  s.params.gravity[0] = 1.0;
  s.params.viscosity = 0.5;
  s.params.artificial_viscosity = 0.05;
  s.params.xsph = 0.3;
  s.params.shifting = 1.0;
  s.params.artificial_pressure = 0.2;
  s.params.anti_clump = 0.01;
  s.params.gradient_correction = 1;
  s.params.time_scheme = scheme;
  return s;
}

/* A smoothing length for each particle in place of what does not go with it; extra 2: found from sums, nothing but periodic
 * sides. */
static scene variable_tank(int extra) {
  scene s = tank(SPH_SYMPLECTIC);
  s.params.variable_smoothing = 1;
  s.params.largest_smoothing = 1.1;
  s.params.shifting = s.params.artificial_pressure = s.params.anti_clump = 0.0;
  s.params.gradient_correction = 0;
  if (extra == 2) {
    s.params.density_scheme = SPH_SUMMATION;
    s.params.xsph = s.params.gravity[2] = 0.0;
    s.box.hi[2] = 0.09;
    s.box.periodic[1] = s.box.periodic[2] = 1;
  }
  return s;
}

static double eps_at(double z, double depth) {
  return 1.0 - depth * exp(-pow((z - 0.04) / 0.02, 2.0));
}

/* The porosity moves a little. */
static void run(sph_t *sph, int n) {
  sph_view view;
  for (int k = 0; k < n; k++) {
    OK(sph_get_view(sph, &view));
    for (int i = 0; i < view.own; i++) {
      view.force[view.force_stride * i] = 1e-3;
      view.eps_rate[view.force_stride * i] = -0.05;
      view.eps_gradient[view.force_stride * i + 2] = 0.7;
      view.eps[view.mass_stride * i] =
          eps_at(view.position[view.xv_stride * i + 2], 0.3 + 0.1 * sph_time(sph));
    }
    OK(sph_advance(sph, 2e-3, NULL));
  }
}

static sph_t *scene_with_particles(const scene *s) {
  double eps[N];
  sph_view view;
  sph_t *sph = scene_without_particles(s);
  fill_water(sph, s, 0.09, 2);
  stir(sph, s, 0.3);
  OK(sph_start(sph));
  OK(sph_get_view(sph, &view));
  for (int i = 0; i < view.own; i++)
    eps[i] = eps_at(view.position[view.xv_stride * i + 2], 0.3);
  OK(sph_displace(sph, eps));
  return sph;
}

static void same_records(sph_t *a, sph_t *b) {
  const part_store *s = sph_store(a), *t = sph_store(b);
  assert_int_equal(s->local, t->local);
  for (int r = 0; r < SPH_RECORD_COUNT; r++)
    assert_memory_equal(s->record[r], t->record[r],
                        (size_t)s->local * (size_t)sph_layout.records[r].width * 8);
}

static void bit_for_bit(void **state) {
  (void)state;
  const char *path = path_of("restart");
  for (int scheme = 0; scheme < 4; scheme++) {
    const scene s = scheme < 2 ? tank(scheme) : variable_tank(scheme - 1);
    sph_report here, there;
    double force[2][3], impulse[2][3];
    sph_t *one = scene_with_particles(&s);
    run(one, 3);
    OK(sph_write(one, path, NULL));
    sph_t *two = scene_without_particles(&s);
    OK(sph_read(two, path));
    OK(sph_start(two));
    CLOSE(sph_time(two), sph_time(one), 0.0);
    same_records(one, two);
    run(one, 4);
    run(two, 4);
    same_records(one, two);
    OK(sph_get_report(one, &here));
    OK(sph_get_report(two, &there));
    assert_memory_equal(&here, &there, sizeof here);
    assert_true(here.rebuilds > 2);
    CLOSE(there.budget_error, 0.0, 1e-12);
    for (int w = 0; w < sph_wall_count(one); w++) {
      OK(sph_get_wall_force(one, w, force[0], impulse[0]));
      OK(sph_get_wall_force(two, w, force[1], impulse[1]));
      assert_memory_equal(force[0], force[1], sizeof force[0]);
      assert_memory_equal(impulse[0], impulse[1], sizeof impulse[0]);
    }
    sph_destroy(one);
    sph_destroy(two);
    MPI_Barrier(MPI_COMM_WORLD);
  }
  if (world_rank() == 0)
    remove(path);
}

/* Written on all ranks, read on one: the same to round-off of sums, which 20 steps of moving water
 * multiply by less than 1000. */
static void other_ranks(void **state) {
  (void)state;
  const char *path = path_of("other");
  static body a[N], b[N];
  scene s = tank(SPH_SYMPLECTIC);
  sph_t *one = scene_with_particles(&s);
  run(one, 3);
  OK(sph_write(one, path, NULL));
  run(one, 2);
  find_all(one, MPI_COMM_WORLD, 0, N, a);
  sph_destroy(one);
  s.comm = MPI_COMM_SELF;
  sph_t *two = scene_without_particles(&s);
  OK(sph_read(two, path));
  OK(sph_start(two));
  run(two, 2);
  find_all(two, MPI_COMM_SELF, 0, N, b);
  for (int k = 0; k < N; k++)
    for (int c = 0; c < 3; c++)
      CLOSE(a[k].v[c], b[k].v[c], 1e-11);
  sph_report report;
  OK(sph_get_report(two, &report));
  CLOSE(report.budget_error, 0.0, 1e-12);
  sph_destroy(two);
  MPI_Barrier(MPI_COMM_WORLD);
  if (world_rank() == 0)
    remove(path);
}

static void bad_files(void **state) {
  (void)state;
  const char *path = path_of("bad");
  scene s = tank(SPH_SYMPLECTIC);
  sph_t *one = scene_with_particles(&s);
  FAILS(PART_ERR_STATE, "sph_start", sph_read(one, path));
  FAILS(PART_ERR_IO, "/no/such/folder", sph_write(one, "/no/such/folder/x.vtkhdf", NULL));
  OK(sph_write(one, path, NULL));
  sph_destroy(one);
  sph_t *two = scene_create(&s);
  FAILS(PART_ERR_FORMAT, "walls 4; now it is 0", sph_read(two, path));
  sph_destroy(two);
  s.params.smoothing_length = 0.014;
  two = scene_without_particles(&s);
  FAILS(PART_ERR_FORMAT, "smoothingLength", sph_read(two, path));
  sph_destroy(two);
  MPI_Barrier(MPI_COMM_WORLD);
  if (world_rank() == 0)
    remove(path);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(bit_for_bit),
      cmocka_unit_test(other_ranks),
      cmocka_unit_test(bad_files),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
