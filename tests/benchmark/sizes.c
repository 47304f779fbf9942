/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cost of wide size distributions. Used by tests/benchmark/sizes.
 *
 *   sizes make bed|gas RATIO FILE       a start state: x y z d vx vy vz, one particle a line
 *   sizes run bed|gas RATIO FILE REPEATS STEPS [WIDTH]
 *
 * 100,000 spheres of diameters 1 to RATIO mm, each doubling of size with the same solid volume
 * (number ~ d^-4). 2500 kg/m3; linear spring and dashpot, k_n = 1000 N/m, k_t = 2/7 k_n, e = 0.9,
 * mu = 0.5. gas: periodic cube of solid fraction 0.3, speeds up to 0.5 m/s whatever the size. bed:
 * settled on a plane, periodic sideways, under three times gravity (less takes longer, under more
 * the large ones sink into the springs).
 * make needs minutes. run prints "steps <particles> <substeps> <rebuilds> <listed pairs a particle>
 * <contacts a particle> <ghosts> <seconds>" for every repeat; WIDTH as in dem.c. On several ranks
 * the seconds are the largest of a rank. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "../../libdem/src/internal.h"

static const double d_min = 1e-3, density = 2500.0, k_n = 1000.0, pi = 3.14159265358979323846;
enum { NUMBER = 100000, CLASSES_MOST = 64 };

static void check(int status) {
  if (status == PART_OK)
    return;
  fprintf(stderr, "sizes: %s\n", part_last_error());
  MPI_Abort(MPI_COMM_WORLD, 1);
}

typedef struct distribution {
  double ratio, volume; /* m3 of all */
  int classes;
  double from[CLASSES_MOST], to[CLASSES_MOST]; /* m */
  int64_t number[CLASSES_MOST];
} distribution;

/* Spheres larger than d: those of d^-4 between 1 and ratio. */
static double larger_than(double d, double ratio) {
  const double end = pow(ratio, -3.0);
  return NUMBER * (pow(d / d_min, -3.0) - end) / (1.0 - end);
}

/* Classes a quarter of a doubling wide, the largest first, with whole numbers that add up. */
static distribution distribute(double ratio) {
  distribution s = {.ratio = ratio, .classes = ratio > 1.0 ? (int)ceil(4.0 * log2(ratio)) : 1};
  int64_t done = 0;
  for (int k = 0; k < s.classes; k++) {
    s.to[k] = d_min * pow(ratio, 1.0 - (double)k / s.classes);
    s.from[k] = d_min * pow(ratio, 1.0 - (double)(k + 1) / s.classes);
    const int64_t so_far = k == s.classes - 1 ? NUMBER : llround(larger_than(s.from[k], ratio));
    s.number[k] = so_far > done ? so_far - done : k == 0; /* at least one of the largest */
    done += s.number[k];
    const double a = s.from[k], b = s.to[k];
    s.volume += (double)s.number[k] * pi / 24.0 * (a + b) * (a * a + b * b);
  }
  return s;
}

static int is_bed(const char *scene) {
  return strcmp(scene, "bed") == 0;
}

/* gas: a cube of solid fraction 0.3; bed: as wide as the bed is about high, and higher at the start,
 * where it is about as dense as random insertion makes it. */
static part_box box_of(const distribution *s, int bed) {
  const double cube = cbrt(s->volume / (bed ? 0.6 : 0.3));
  const double side = bed ? fmax(cube, 2.06 * s->ratio * d_min) : cube;
  const double high = bed ? s->volume / (side * side) / (s->ratio > 1.0 ? 0.45 : 0.3) : cube;
  const part_box box = {{0.0, 0.0, 0.0}, {side, side, high}, {1, 1, !bed}, {0, 0, 0}};
  return box;
}

/* t_c/50 of the smallest, as in dem.c. */
static double step(void) {
  const double m_eff = 0.5 * density * pi / 6.0 * d_min * d_min * d_min, log_e = log(0.9);
  const double zeta = -log_e / sqrt(pi * pi + log_e * log_e);
  return pi / sqrt(k_n / m_eff * (1.0 - zeta * zeta)) / 50.0;
}

static dem_t *create(const distribution *s, int bed) {
  dem_t *dem;
  dem_params params;
  dem_contact contact;
  dem_material glass;
  const double floor_at[3] = {0.0, 0.0, 0.0}, up[3] = {0.0, 0.0, 1.0};
  const part_box box = box_of(s, bed);
  part_params_default(&dem_params_table, &params);
  part_params_default(&dem_contact_table, &contact);
  part_params_default(&dem_material_table, &glass);
  strcpy(glass.name, "glass");
  glass.density = density;
  params.gravity[2] = bed ? -29.43 : 0.0;
  params.max_overlap = 1.0; /* large spheres of a bed rest on soft springs */
  contact.normal_stiffness = k_n;
  contact.restitution = 0.9;
  contact.friction = 0.5;
  params.time_step_fraction = 0.02002;
  check(dem_create(MPI_COMM_WORLD, &box, &params, &dem));
  check(dem_add_material(dem, &glass, NULL));
  check(dem_set_contact(dem, -1, -1, &contact));
  if (bed)
    check(dem_add_plane(dem, "floor", 0, floor_at, up));
  return dem;
}

static void insert_classes(dem_t *dem, const distribution *s, int bed) {
  const part_box box = box_of(s, bed);
  dem_insert insert;
  part_params_default(&dem_insert_table, &insert);
  insert.method = DEM_INSERT_RANDOM;
  strcpy(insert.material, "glass");
  for (int k = 0; k < s->classes; k++) {
    insert.diameter = s->from[k];
    insert.diameter_max = s->to[k];
    insert.number = s->number[k];
    insert.seed = 7 + k;
    memcpy(insert.extent, box.hi, sizeof insert.extent);
    if (insert.number > 0)
      check(dem_insert_particles(dem, &insert, -1, NULL));
  }
}

static double random_of(int64_t id, int c) {
  uint64_t z = (uint64_t)id * 3 + (uint64_t)c + UINT64_C(0x9e3779b97f4a7c15);
  z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
  z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
  return (double)((z ^ (z >> 31)) >> 11) * 0x1p-52 - 1.0;
}

static void write_state(dem_t *dem, const char *path, const part_box *box) {
  FILE *file = fopen(path, "w");
  if (file == NULL) {
    fprintf(stderr, "sizes: %s cannot be written\n", path);
    exit(1);
  }
  for (int i = 0; i < dem->store->local; i++) {
    double x[3];
    const double *xr = dem_xr(dem) + DEM_XR * (size_t)i, *v = dem_vm(dem) + DEM_VM * (size_t)i;
    memcpy(x, xr, sizeof x);
    part_box_wrap(box, x, NULL);
    fprintf(file, "%.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", x[0], x[1], x[2], 2.0 * xr[3],
            v[0], v[1], v[2]);
  }
  fclose(file);
}

/* Falls in a fluid that drags all sizes alike, then comes to rest in a thicker one. */
static void settle(dem_t *dem) {
  const int falls = 50, rests = 12, bare = 2; /* ms */
  for (int k = 0; k < falls + rests + bare; k++) {
    double *fluid = dem_fluid(dem);
    for (int i = 0; i < dem->store->local; i++)
      fluid[DEM_FLUID * (size_t)i + 3] =
          dem_own_mass(dem, i) * (k < falls ? 10.0 : k < falls + rests ? 1000.0 : 0.0);
    check(dem_advance(dem, 1e-3, NULL));
  }
}

static void make(int bed, double ratio, const char *path) {
  const distribution s = distribute(ratio);
  const part_box box = box_of(&s, bed);
  dem_t *dem = create(&s, bed);
  insert_classes(dem, &s, bed);
  check(dem_start(dem));
  for (int i = 0; i < dem->store->local; i++)
    for (int c = 0; c < 3; c++)
      dem_vm(dem)[DEM_VM * (size_t)i + (size_t)c] = bed ? 0.0 : 0.28 * random_of(dem_id(dem, i), c);
  if (bed)
    settle(dem);
  write_state(dem, path, &box);
  dem_destroy(dem);
}

static double now(void) { /* of this process only: the machine may be shared */
  return (double)clock() / CLOCKS_PER_SEC;
}

static void one_repeat(dem_t *dem, int steps) {
  dem_report before, after;
  check(dem_get_report(dem, &before));
  const double start = now();
  for (int s = 0; s < steps; s += 100)
    check(dem_advance(dem, 100 * step(), NULL));
  double seconds = now() - start;
  int64_t ghosts = dem->store->ghost;
  check(dem_get_report(dem, &after));
  MPI_Allreduce(MPI_IN_PLACE, &seconds, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
  MPI_Allreduce(MPI_IN_PLACE, &ghosts, 1, MPI_INT64_T, MPI_SUM, MPI_COMM_WORLD);
  if (dem->rank == 0)
    printf("steps %lld %lld %lld %.3f %.3f %lld %.6f\n", (long long)after.particles,
           after.substeps - before.substeps, after.rebuilds - before.rebuilds,
           (double)dem->listed / (double)after.particles,
           (double)after.contacts / (double)after.particles, (long long)ghosts, seconds);
  fflush(stdout);
}

static void run(int bed, double ratio, const char *path, int repeats, int steps, int width) {
  const distribution s = distribute(ratio);
  dem_t *dem = create(&s, bed);
  dem_insert insert;
  char text[2000];
  part_params_default(&dem_insert_table, &insert);
  insert.method = DEM_INSERT_FILE;
  strcpy(insert.material, "glass");
  snprintf(insert.file, sizeof insert.file, "%s", path);
  check(dem_insert_particles(dem, &insert, -1, NULL));
  check(dem_fast_limit(dem, width));
  check(dem_start(dem));
  check(dem_advance(dem, 400 * step(), NULL)); /* the skin finds its width */
  for (int k = 0; k < repeats; k++)
    one_repeat(dem, steps);
  check(part_timers_report(dem_timers(dem), MPI_COMM_WORLD, sizeof text, text));
  if (dem->rank == 0)
    fprintf(stderr, "%s", text);
  dem_destroy(dem);
}

int main(int argc, char **argv) {
  MPI_Init(&argc, &argv);
  if (argc == 5 && strcmp(argv[1], "make") == 0) {
    make(is_bed(argv[2]), atof(argv[3]), argv[4]);
  } else if (argc >= 7 && strcmp(argv[1], "run") == 0) {
    run(is_bed(argv[2]), atof(argv[3]), argv[4], atoi(argv[5]), atoi(argv[6]),
        argc > 7 ? atoi(argv[7]) : 0);
  } else {
    fprintf(stderr, "usage: see the head of sizes.c\n");
    return 2;
  }
  MPI_Finalize();
  return 0;
}
