/* ranks: 1 2 3 4 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decomposition: balancing by cost while particles cross ranks at speed with springs in their
 * contacts, ids beyond 2^31, few particles, and what is said of a particle that is lost. */
#include "common.h"

enum { N = 400 };
static const int64_t large_id = ((int64_t)1 << 40) + 5;

/* A heap in one corner of a box that is periodic sideways, thrown along the floor: of two sizes,
 * with friction, soft enough that many are in contact at any time. */
static dem_t *heap(MPI_Comm comm, int64_t first_id, int with_particles) {
  scene s = scene_default();
  const double lo[3] = {-0.1, -0.1, -0.1}, floor_at[3] = {0.0, 0.0, -0.1}, up[3] = {0.0, 0.0, 1.0};
  s.comm = comm;
  for (int c = 0; c < 3; c++) {
    s.box.lo[c] = -0.1;
    s.box.hi[c] = 0.1;
    s.box.periodic[c] = c < 2;
  }
  s.params.gravity[2] = -200.0;
  s.params.first_id = first_id;
  s.params.balance_ratio = 1.02;
  s.contact.normal_stiffness = 2e3;
  s.contact.friction = 0.5;
  s.contact.restitution = 0.6;
  double vertices[18 * 16];
  dem_t *dem = scene_create(&s);
  OK(dem_add_triangles(dem, "floor", 0, triangulated_square(floor_at, up, 0.2, 4, vertices),
                       vertices));
  if (with_particles) {
    dem_insert insert = random_spheres(N / 10, 0.014, 0.016, lo, 0.07, 3);
    insert.velocity[0] = 3.0;
    insert.velocity[1] = 1.0;
    OK(dem_insert_particles(dem, &insert, -1, NULL));
    insert.number = N - N / 10;
    insert.diameter = 0.004;
    insert.diameter_max = 0.008;
    OK(dem_insert_particles(dem, &insert, -1, NULL));
  }
  return dem;
}

/* x, v, omega and rank of every particle by id - first_id; each id once. */
typedef struct state {
  double x[3], v[3], w[3], rank, times;
} state;

static void gather(dem_t *dem, MPI_Comm comm, int64_t first_id, int n, state *all) {
  const part_store *store = dem_store(dem);
  const int64_t *id = part_field_int64(store, DEM_FIELD_ID);
  int rank;
  MPI_Comm_rank(comm, &rank);
  memset(all, 0, (size_t)n * sizeof *all);
  for (int i = 0; i < store->local; i++) {
    const int64_t k = id[4 * (size_t)i] - first_id;
    assert_in_range(k, 0, n - 1);
    memcpy(all[k].x, part_field_double(store, DEM_FIELD_POSITION) + 4 * (size_t)i, 24);
    memcpy(all[k].v, part_field_double(store, DEM_FIELD_VELOCITY) + 8 * (size_t)i, 24);
    memcpy(all[k].w, part_field_double(store, DEM_FIELD_ANGULAR_VELOCITY) + 8 * (size_t)i, 24);
    all[k].rank = rank;
    all[k].times = 1.0;
  }
  MPI_Allreduce(MPI_IN_PLACE, all, (int)(sizeof *all / sizeof(double)) * n, MPI_DOUBLE, MPI_SUM,
                comm);
  for (int k = 0; k < n; k++)
    assert_true(all[k].times == 1.0);
}

static double apart(const state *a, const state *b, const double length[3]) {
  double most = 0.0;
  for (int c = 0; c < 3; c++) {
    double d = a->x[c] - b->x[c];
    if (length[c] > 0.0)
      d -= length[c] * floor(d / length[c] + 0.5);
    most = fmax(most, fabs(d));
  }
  return most;
}

/* Velocities changed in their last bit. */
static void disturb(dem_t *dem) {
  const part_store *store = dem_store(dem);
  const double *w = part_field_double(store, DEM_FIELD_INVERSE_MASS);
  double *impulse = calloc(3 * (size_t)store->local + 1, sizeof *impulse);
  for (int i = 0; i < 3 * store->local; i++)
    impulse[i] = (i % 2 == 0 ? 4.5e-16 : -4.5e-16) / w[8 * (size_t)(i / 3)];
  OK(dem_kick(dem, impulse));
  free(impulse);
}

static double worst_apart(const state *a, const state *b) {
  const double length[3] = {0.2, 0.2, 0.0};
  double most = 0.0;
  for (int k = 0; k < N; k++)
    most = fmax(most, apart(&a[k], &b[k], length));
  return most;
}

/* The same heap alone on one rank, and on all. How much rounding grows over the contacts of such a
 * heap, a third run shows that begins with velocities changed in their last bit: ranks may not
 * differ by more, or than every step's rounding of positions (box of 0.2 m) adds up to. */
static void thrown_heap(void **unused) {
  (void)unused;
  static state one[N], all[N], before[N], other[N];
  dem_t *run[3];
  dem_report report, single;
  int moved = 0;
  for (int k = 0; k < 3; k++) {
    run[k] = heap(k == 0 ? MPI_COMM_WORLD : MPI_COMM_SELF, 0, 1);
    OK(dem_start(run[k]));
  }
  disturb(run[2]);
  gather(run[0], MPI_COMM_WORLD, 0, N, before);
  for (int k = 0; k < 20; k++) {
    for (int r = 0; r < 3; r++)
      OK(dem_advance(run[r], 1e-3, NULL));
    OK(dem_get_report(run[0], &report));
    OK(dem_get_report(run[1], &single));
    assert_int_equal(report.particles, N);
    assert_int_equal(report.contacts, single.contacts);
    assert_int_equal(report.wall_contacts, single.wall_contacts);
    CLOSE(report.budget_error, 0.0, 1e-12);
  }
  assert_true(report.contacts > 50);
  gather(run[0], MPI_COMM_WORLD, 0, N, all);
  gather(run[1], MPI_COMM_SELF, 0, N, one);
  gather(run[2], MPI_COMM_SELF, 0, N, other);
  const double grown = worst_apart(one, other);
  assert_true(grown > 0.0 && grown < 1e-8);
  CLOSE(worst_apart(one, all), 0.0, fmax(grown, (double)report.substeps * 1.1e-16 * 0.2));
  for (int k = 0; k < N; k++)
    moved += all[k].rank != before[k].rank;
  print_message("load ratio %.3f, %d changed ranks, ranks differ by %.2g m, last bits by %.2g m\n",
                report.load_ratio, moved, worst_apart(one, all), grown);
  if (world_size() > 1) {
    assert_true(moved > N / 10); /* across ranks, some over the periodic border */
    assert_true(report.load_ratio >= 1.0 && report.load_ratio < 1.3);
  }
  for (int k = 0; k < 3; k++)
    dem_destroy(run[k]);
}

static const char *path_of(const char *name) {
  static char path[300];
  const char *folder = getenv("TMPDIR");
  snprintf(path, sizeof path, "%s/dem-%s-%d.vtkhdf", folder != NULL ? folder : "/tmp", name,
           world_size());
  return path;
}

/* Through migration, ghosts, springs, files and restart: the same bits as with small ids. */
static void ids_beyond_2_31(void **unused) {
  (void)unused;
  static state small[N], large[N];
  const char *path = path_of("ids");
  dem_t *a = heap(MPI_COMM_WORLD, 0, 1), *b = heap(MPI_COMM_WORLD, large_id, 1);
  OK(dem_start(a));
  OK(dem_start(b));
  for (int k = 0; k < 8; k++) {
    OK(dem_advance(a, 1e-3, NULL));
    OK(dem_advance(b, 1e-3, NULL));
  }
  OK(dem_write(a, path, NULL)); /* puts a into the order that b gets */
  OK(dem_write(b, path, NULL));
  dem_destroy(b);
  b = heap(MPI_COMM_WORLD, 0, 0);
  OK(dem_read(b, path));
  OK(dem_start(b));
  for (int k = 0; k < 8; k++) {
    OK(dem_advance(a, 1e-3, NULL));
    OK(dem_advance(b, 1e-3, NULL));
  }
  dem_report report;
  OK(dem_get_report(b, &report));
  assert_true(report.contacts > 20);
  gather(a, MPI_COMM_WORLD, 0, N, small);
  gather(b, MPI_COMM_WORLD, large_id, N, large);
  assert_memory_equal(small, large, sizeof small);
  dem_destroy(a);
  dem_destroy(b);
  MPI_Barrier(MPI_COMM_WORLD);
  if (world_rank() == 0)
    remove(path);
}

/* Two particles that rub on one another, on any number of ranks: some have none. */
static void more_ranks_than_particles(void **unused) {
  (void)unused;
  state one[2], all[2];
  const double length[3] = {0.0, 0.0, 0.0};
  for (int parallel = 0; parallel < 2; parallel++) {
    scene s = scene_default();
    s.comm = parallel ? MPI_COMM_WORLD : MPI_COMM_SELF;
    s.contact.friction = 0.4;
    dem_t *dem = scene_create(&s);
    const double x[2][3] = {{0.0, 0.0, 0.0}, {0.11, 0.03, 0.0}};
    const double v[2][3] = {{2.0, 0.0, 0.0}, {-1.0, 0.0, 0.3}};
    for (int k = 0; k < 2; k++)
      add_sphere(dem, DEM_FREE, -1, x[k], k == 0 ? 0.05 : 0.03, v[k]);
    OK(dem_start(dem));
    for (int k = 0; k < 10; k++)
      OK(dem_advance(dem, 5e-3, NULL));
    gather(dem, s.comm, 0, 2, parallel ? all : one);
    dem_destroy(dem);
  }
  for (int k = 0; k < 2; k++) {
    CLOSE(apart(&one[k], &all[k], length), 0.0, 1e-15);
    assert_true(fabs(all[k].w[2]) > 0.1);
    for (int c = 0; c < 3; c++)
      CLOSE(all[k].w[c], one[k].w[c], 1e-11);
  }
}

/* Id, place, time and step of a particle that leaves a box which it must not leave. */
static void lost_particle(void **unused) {
  (void)unused;
  scene s = scene_default();
  const double x[3] = {0.9, 0.0, 0.0}, other[3] = {-0.5, 0.0, 0.0}, v[3] = {10.0, 0.0, 0.0};
  const double zero[3] = {0.0, 0.0, 0.0};
  s.box.bounded[0] = 1;
  s.params.first_id = large_id;
  dem_t *dem = scene_create(&s);
  add_sphere(dem, DEM_FREE, -1, other, 0.05, zero);
  add_sphere(dem, DEM_FREE, -1, x, 0.05, v);
  OK(dem_start(dem));
  int status = PART_OK;
  for (int k = 0; k < 100 && status == PART_OK; k++)
    status = dem_advance(dem, 1e-3, NULL);
  FAILS(PART_ERR_OUTSIDE, "particle 1099511627782 at (1.0", status);
  FAILS(PART_ERR_OUTSIDE, "left the domain", status);
  FAILS(PART_ERR_OUTSIDE, "time 0.01", status);
  FAILS(PART_ERR_OUTSIDE, "step ", status);
  dem_destroy(dem);
}

/* Overlaps are told with the ids that particles will have. */
static void overlap_says_ids(void **unused) {
  (void)unused;
  scene s = scene_default();
  s.params.first_id = 1000;
  dem_t *dem = scene_create(&s);
  dem_insert insert = lattice(DEM_FREE, 0.1, (double[3]){0.0, 0.0, 0.0}, 0.09, 2, 1, 1);
  FAILS(PART_ERR_OVERLAP, "particles 1000 and 1001", dem_insert_particles(dem, &insert, -1, NULL));
  dem_destroy(dem);
  s.params.first_id = -1;
  FAILS(PART_ERR_RANGE, "firstId", dem_create(s.comm, &s.box, &s.params, &dem));
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(thrown_heap),
      cmocka_unit_test(ids_beyond_2_31),
      cmocka_unit_test(more_ranks_than_particles),
      cmocka_unit_test(lost_particle),
      cmocka_unit_test(overlap_says_ids),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
