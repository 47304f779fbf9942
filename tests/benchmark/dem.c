/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Contact loop: particle-steps a second of three scenes on one core. Used by tests/benchmark/dem.
 *
 *   dem make bed|gas FILE              a start state: x y z d vx vy vz, one particle a line
 *   dem run bed|gas FILE REPEATS STEPS [WIDTH [TILE_X TILE_Y]]
 *
 * Spheres of d = 1 mm, 2500 kg/m3; linear spring and dashpot, k_n = 1000 N/m, k_t = 2/7 k_n,
 * e = 0.9, mu = 0.5; step t_c/50. bed: 10,000 settled on a plane of 20 d x 20 d, periodic
 * sideways; TILE copies of it in x and y. gas: 10,000 in a periodic cube, solid fraction 0.3.
 * run prints "steps <particles> <substeps> <rebuilds> <seconds>" for every repeat; WIDTH limits the
 * vectors (8, 4; 1: plain loop; 0: what the processor has). */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "../../libdem/src/fast.h"
#include "dem/dem.h"

static const double d = 1e-3, density = 2500.0, k_n = 1000.0, pi = 3.14159265358979323846;
enum { NUMBER = 10000 };

static void check(int status) {
  if (status == PART_OK)
    return;
  fprintf(stderr, "dem: %s\n", part_last_error());
  exit(1);
}

static double random_01(void) {
  static uint64_t state = 7;
  state = state * 6364136223846793005u + 1442695040888963407u;
  return (double)(state >> 11) * 0x1p-53;
}

static int is_bed(const char *scene) {
  return strcmp(scene, "bed") == 0;
}

static double edge(int bed) {
  return bed ? 20.0 * d : cbrt(NUMBER * pi / 6.0 * d * d * d / 0.3);
}

/* Substep: t_c/50 with t_c = pi/sqrt(k_n/m_eff (1 - zeta^2)). */
static double step(void) {
  const double m_eff = 0.5 * density * pi / 6.0 * d * d * d, log_e = log(0.9);
  const double zeta = -log_e / sqrt(pi * pi + log_e * log_e);
  return pi / sqrt(k_n / m_eff * (1.0 - zeta * zeta)) / 50.0;
}

static dem_t *create(int bed, double friction, double width_x, double width_y) {
  dem_t *dem;
  dem_params params;
  dem_contact contact;
  dem_material glass = {.name = "glass", .density = density};
  const double floor_at[3] = {0.0, 0.0, 0.0}, up[3] = {0.0, 0.0, 1.0};
  const part_box box = {
      {0.0, 0.0, 0.0}, {width_x, width_y, bed ? 60.0 * d : width_x}, {1, 1, !bed}, {0, 0, 0}};
  part_params_default(&dem_params_table, &params);
  part_params_default(&dem_contact_table, &contact);
  params.gravity[2] = bed ? -9.81 : 0.0;
  contact.normal_stiffness = k_n;
  contact.restitution = 0.9;
  contact.friction = friction;
  params.time_step_fraction = 0.02002; /* of the half period without damping, so 1/50 of t_c */
  check(dem_create(MPI_COMM_SELF, &box, &params, &dem));
  check(dem_add_material(dem, &glass, NULL));
  check(dem_set_contact(dem, -1, -1, &contact));
  if (bed)
    check(dem_add_plane(dem, "floor", 0, floor_at, up));
  return dem;
}

static void insert_file(dem_t *dem, const char *path) {
  dem_insert insert;
  part_params_default(&dem_insert_table, &insert);
  insert.method = DEM_INSERT_FILE;
  strcpy(insert.material, "glass");
  snprintf(insert.file, sizeof insert.file, "%s", path);
  check(dem_insert_particles(dem, &insert, -1, NULL));
}

static void write_line(FILE *file, const double x[3], const double v[3]) {
  fprintf(file, "%.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", x[0], x[1], x[2], d, v[0], v[1],
          v[2]);
}

/* Sites of a cubic lattice with random offsets that leave no overlap, random velocities. */
static void lattice(FILE *file, int bed) {
  const double length = edge(bed);
  const int side = bed ? 19 : 22;
  const double a = length / side, room = 0.475 * (a - d);
  int left = NUMBER, sites = bed ? NUMBER : side * side * side;
  for (int k = 0; k < sites; k++) {
    double x[3], v[3], v2 = 0.0;
    const int at[3] = {k % side, k / side % side, k / side / side};
    const int taken = random_01() * (sites - k) < left;
    for (int c = 0; c < 3; c++) {
      x[c] = (at[c] + 0.5) * a + room * (2.0 * random_01() - 1.0);
      v[c] = 2.0 * random_01() - 1.0;
      v2 += v[c] * v[c];
    }
    const double speed = bed ? 0.1 : (0.1 + 0.4 * random_01()) / sqrt(v2);
    for (int c = 0; c < 3; c++)
      v[c] *= speed;
    left -= taken;
    if (taken)
      write_line(file, x, v);
  }
}

static FILE *open_file(const char *path) {
  FILE *file = fopen(path, "w");
  if (file == NULL) {
    fprintf(stderr, "dem: %s cannot be written\n", path);
    exit(1);
  }
  return file;
}

static void write_state(dem_t *dem, const char *path, const part_box *box) {
  const part_store *store = dem_store(dem);
  FILE *file = open_file(path);
  for (int i = 0; i < store->local; i++) {
    double x[3];
    memcpy(x, part_field_double(store, DEM_FIELD_POSITION) + 4 * (size_t)i, sizeof x);
    part_box_wrap(box, x, NULL);
    write_line(file, x, part_field_double(store, DEM_FIELD_VELOCITY) + 8 * (size_t)i);
  }
  fclose(file);
}

/* The bed falls 0.05 s in a viscous fluid, comes to rest in a thicker one, and loses that too. */
static void settle(const char *path) {
  const part_box box = {{0.0, 0.0, 0.0}, {edge(1), edge(1), 60.0 * d}, {1, 1, 0}, {0, 0, 0}};
  dem_t *dem = create(1, 0.5, edge(1), edge(1));
  insert_file(dem, path);
  check(dem_start(dem));
  for (int k = 0; k < 100; k++) {
    const part_store *store = dem_store(dem);
    double *drag = part_field_double(store, DEM_FIELD_FLUID_SP);
    for (int i = 0; i < store->local; i++)
      drag[8 * (size_t)i] = k < 50 ? 5e-5 : k < 90 ? 5e-4 : 0.0;
    check(dem_advance(dem, 1e-3, NULL));
  }
  write_state(dem, path, &box);
  dem_destroy(dem);
}

static void make(const char *scene, const char *path) {
  FILE *file = open_file(path);
  lattice(file, is_bed(scene));
  fclose(file);
  if (is_bed(scene))
    settle(path);
}

static double now(void) { /* of this process only: the machine may be shared */
  return (double)clock() / CLOCKS_PER_SEC;
}

/* The file nx x ny times side by side. */
static void tile(const char *from, const char *to, int nx, int ny) {
  FILE *in = fopen(from, "r"), *out = open_file(to);
  double x[3], v[3], size;
  if (in == NULL) {
    fprintf(stderr, "dem: %s cannot be read\n", from);
    exit(1);
  }
  while (fscanf(in, "%lf %lf %lf %lf %lf %lf %lf", x, x + 1, x + 2, &size, v, v + 1, v + 2) == 7)
    for (int k = 0; k < nx * ny; k++) {
      const double at[3] = {x[0] + k % nx * edge(1), x[1] + k / nx * edge(1), x[2]};
      write_line(out, at, v);
    }
  fclose(in);
  fclose(out);
}

static void run(int bed, const char *path, int repeats, int steps, int width, int nx, int ny) {
  dem_t *dem = create(bed, 0.5, nx * edge(bed), ny * edge(bed));
  check(dem_fast_limit(dem, width));
  insert_file(dem, path);
  check(dem_start(dem));
  check(dem_advance(dem, 200 * step(), NULL));
  for (int k = 0; k < repeats; k++) {
    dem_report before, after;
    check(dem_get_report(dem, &before));
    const double start = now();
    for (int s = 0; s < steps; s += 100)
      check(dem_advance(dem, 100 * step(), NULL));
    const double seconds = now() - start;
    check(dem_get_report(dem, &after));
    printf("steps %lld %lld %lld %.6f\n", (long long)after.particles,
           after.substeps - before.substeps, after.rebuilds - before.rebuilds, seconds);
    fflush(stdout);
  }
  char text[2000];
  check(part_timers_report(dem_timers(dem), MPI_COMM_SELF, sizeof text, text));
  fprintf(stderr, "%s", text);
  dem_destroy(dem);
}

int main(int argc, char **argv) {
  MPI_Init(&argc, &argv);
  if (argc == 4 && strcmp(argv[1], "make") == 0) {
    make(argv[2], argv[3]);
  } else if (argc == 6 && strcmp(argv[1], "tile") == 0) {
    tile(argv[2], argv[3], atoi(argv[4]), atoi(argv[5]));
  } else if (argc >= 6 && strcmp(argv[1], "run") == 0) {
    run(is_bed(argv[2]), argv[3], atoi(argv[4]), atoi(argv[5]), argc > 6 ? atoi(argv[6]) : 0,
        argc > 7 ? atoi(argv[7]) : 1, argc > 8 ? atoi(argv[8]) : 1);
  } else {
    fprintf(stderr, "usage: see the head of dem.c\n");
    return 2;
  }
  MPI_Finalize();
  return 0;
}
