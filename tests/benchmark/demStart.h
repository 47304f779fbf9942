/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The scenes of dem.c and their start states. */
#ifndef BENCHMARK_DEM_START_H
#define BENCHMARK_DEM_START_H

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../libdem/src/internal.h"

static const double density = 2500.0, k_n = 1000.0, pi = 3.14159265358979323846;
static const double drum_radius = 0.05, drum_length = 0.02;
enum { NUMBER = 10000, DRUM_SIDES = 96, DRUM_RINGS = 4 };
typedef enum { BED, GAS, DRUM, FALL, FLY, SCENES } scene;
static const char *const names[SCENES] = {"bed", "gas", "drum", "fall", "fly"};

static void check(int status) {
  if (status == PART_OK)
    return;
  fprintf(stderr, "dem: %s\n", part_last_error());
  MPI_Abort(MPI_COMM_WORLD, 1);
}

static double random_01(void) {
  static uint64_t state = 7;
  state = state * 6364136223846793005u + 1442695040888963407u;
  return (double)(state >> 11) * 0x1p-53;
}

static double diameter(scene what) {
  return what == DRUM ? 2e-3 : 1e-3;
}

/* Of one tile. */
static part_box box_of(scene what) {
  const double d = diameter(what), rim = drum_radius + 0.003, gap = 5e-4;
  const double cube = what == GAS ? cbrt(NUMBER * pi / 6.0 * d * d * d / 0.3) : 0.1;
  const part_box boxes[SCENES] = {
      {{0.0, 0.0, 0.0}, {20.0 * d, 20.0 * d, 60.0 * d}, {1, 1, 0}, {0, 0, 0}},
      {{0.0, 0.0, 0.0}, {cube, cube, cube}, {1, 1, 1}, {0, 0, 0}},
      {{-rim, -gap, -rim}, {rim, drum_length + gap, rim}, {0, 0, 0}, {0, 0, 0}},
      {{0.0, 0.0, 0.0}, {cube, cube, cube}, {1, 1, 0}, {0, 0, 0}},
      {{0.0, 0.0, 0.0}, {cube, cube, cube}, {1, 1, 1}, {0, 0, 0}}};
  return boxes[what];
}

/* Substep: t_c/50 with t_c = pi/sqrt(k_n/m_eff (1 - zeta^2)). */
static double step(scene what) {
  const double m_eff = 0.5 * density * pi / 6.0 * pow(diameter(what), 3.0), log_e = log(0.9);
  const double zeta = -log_e / sqrt(pi * pi + log_e * log_e);
  return pi / sqrt(k_n / m_eff * (1.0 - zeta * zeta)) / 50.0;
}

static void add_drum(dem_t *dem, const char *mesh) {
  dem_wall_params barrel;
  const double ends[2][3] = {{0.0, 0.0, 0.0}, {0.0, drum_length, 0.0}};
  const double in[2][3] = {{0.0, 1.0, 0.0}, {0.0, -1.0, 0.0}};
  part_params_default(&dem_wall_table, &barrel);
  barrel.type = DEM_WALL_STL;
  barrel.open = 1;
  strcpy(barrel.material, "glass");
  snprintf(barrel.file, sizeof barrel.file, "%s", mesh);
  for (int c = 0; c < 3; c++) {
    barrel.centre[c] = 0.0;
    barrel.rotation_axis[c] = c == 1;
  }
  barrel.rotation_rate = 2.0 * pi;
  check(dem_add_wall(dem, "barrel", &barrel, 0, NULL));
  check(dem_add_plane(dem, "front", 0, ends[0], in[0]));
  check(dem_add_plane(dem, "back", 0, ends[1], in[1]));
}

/* file: the start state, to which the mesh of the drum belongs. */
static dem_t *create(MPI_Comm comm, scene what, const char *file, int nx, int ny, int skip) {
  dem_t *dem;
  dem_params params;
  dem_contact contact;
  dem_material glass;
  char mesh[PART_PARAM_WORD_LENGTH];
  const double floor_at[3] = {0.0, 0.0, 0.0}, up[3] = {0.0, 0.0, 1.0};
  part_box box = box_of(what);
  box.hi[0] = box.lo[0] + nx * (box.hi[0] - box.lo[0]);
  box.hi[1] = box.lo[1] + ny * (box.hi[1] - box.lo[1]);
  part_params_default(&dem_params_table, &params);
  part_params_default(&dem_contact_table, &contact);
  part_params_default(&dem_material_table, &glass);
  strcpy(glass.name, "glass");
  glass.density = density;
  params.gravity[2] = what == GAS || what == FLY ? 0.0 : -9.81;
  params.skip = skip;
  params.first_id = 0;
  params.max_overlap = what == DRUM ? 0.05 : 0.01; /* of a start state */
  contact.normal_stiffness = k_n;
  contact.restitution = 0.9;
  contact.friction = 0.5;
  params.time_step_fraction = 0.02002; /* of the half period without damping, so 1/50 of t_c */
  check(dem_create(comm, &box, &params, &dem));
  check(dem_add_material(dem, &glass, NULL));
  check(dem_set_contact(dem, -1, -1, &contact));
  if (what == BED || what == FALL)
    check(dem_add_plane(dem, "floor", 0, floor_at, up));
  snprintf(mesh, sizeof mesh, "%s.stl", file);
  if (what == DRUM)
    add_drum(dem, mesh);
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

static void write_line(FILE *file, const double x[3], double d, const double v[3]) {
  fprintf(file, "%.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", x[0], x[1], x[2], d, v[0], v[1],
          v[2]);
}

/* Sites of a cubic lattice with random offsets that leave no overlap, random velocities. */
static void lattice(FILE *file, scene what) {
  const int bed = what == BED, side = bed ? 19 : 22;
  const double d = diameter(what), a = box_of(what).hi[0] / side, room = 0.475 * (a - d);
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
      write_line(file, x, d, v);
  }
}

/* The lowest sites of a lattice in the drum. */
static void drum_lattice(FILE *file) {
  const double d = diameter(DRUM), a[3] = {1.05 * d, drum_length / 9, 1.05 * d};
  const double inside = drum_radius * cos(pi / DRUM_SIDES) - 0.54 * d, v[3] = {0.0, 0.0, 0.0};
  const int half = (int)(inside / a[0]);
  int left = NUMBER;
  for (int k = 0; left > 0; k++) {
    const int side = 2 * half + 1;
    const int at[3] = {k % side - half, k / side % 9, k / side / 9 - half};
    double x[3] = {at[0] * a[0], (at[1] + 0.5) * a[1], at[2] * a[2]};
    if (hypot(x[0], x[2]) > inside)
      continue;
    for (int c = 0; c < 3; c++)
      x[c] += 0.475 * (1.05 * d - d) * (2.0 * random_01() - 1.0);
    write_line(file, x, d, v);
    left--;
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

static void write_facet(FILE *file, const double *a, const double *b, const double *c) {
  const double *corner[3] = {a, b, c};
  fprintf(file, "facet normal 0 0 0\nouter loop\n");
  for (int k = 0; k < 3; k++)
    fprintf(file, "vertex %.10g %.10g %.10g\n", corner[k][0], corner[k][1], corner[k][2]);
  fprintf(file, "endloop\nendfacet\n");
}

/* The barrel, 1 mm longer than the drum at both ends. */
static void write_mesh(const char *start) {
  char path[1000];
  snprintf(path, sizeof path, "%s.stl", start);
  FILE *file = open_file(path);
  fprintf(file, "solid drum\n");
  for (int k = 0; k < DRUM_SIDES * DRUM_RINGS; k++) {
    double x[2][2][3];
    for (int i = 0; i < 2; i++)
      for (int j = 0; j < 2; j++) {
        const double angle = 2.0 * pi * ((k % DRUM_SIDES + i) % DRUM_SIDES) / DRUM_SIDES;
        x[i][j][0] = drum_radius * cos(angle);
        x[i][j][1] = -1e-3 + (drum_length + 2e-3) * (k / DRUM_SIDES + j) / DRUM_RINGS;
        x[i][j][2] = drum_radius * sin(angle);
      }
    write_facet(file, x[0][0], x[1][0], x[1][1]);
    write_facet(file, x[0][0], x[1][1], x[0][1]);
  }
  fprintf(file, "endsolid drum\n");
  fclose(file);
}

static void write_state(dem_t *dem, const char *path, scene what) {
  const part_box box = box_of(what);
  const part_store *store = dem_store(dem);
  FILE *file = open_file(path);
  for (int i = 0; i < store->local; i++) {
    double x[3];
    memcpy(x, part_field_double(store, DEM_FIELD_POSITION) + 4 * (size_t)i, sizeof x);
    part_box_wrap(&box, x, NULL);
    write_line(file, x, diameter(what),
               part_field_double(store, DEM_FIELD_VELOCITY) + 8 * (size_t)i);
  }
  fclose(file);
}

/* The bed falls 0.05 s in a viscous fluid, comes to rest in a thicker one, and loses that too. The
 * drum falls and turns, then turns without the fluid; 30 of its 96 sides pass, so that it looks as
 * at the start. */
static void settle(const char *path, scene what) {
  const double turn = 30.0 / DRUM_SIDES, part = what == DRUM ? turn / 100.0 : 1e-3;
  const int free_from = what == DRUM ? 25 : 90;
  const double mass = density * pi / 6.0 * pow(diameter(what), 3.0);
  dem_t *dem = create(MPI_COMM_SELF, what, path, 1, 1, 1);
  insert_file(dem, path);
  check(dem_start(dem));
  for (int k = 0; k < 100; k++) {
    const part_store *store = dem_store(dem);
    double *drag = part_field_double(store, DEM_FIELD_FLUID_SP);
    for (int i = 0; i < store->local; i++)
      drag[8 * (size_t)i] = mass * (k >= free_from ? 0.0 : k < 50 ? 38.0 : 380.0);
    check(dem_advance(dem, part, NULL));
  }
  write_state(dem, path, what);
  dem_destroy(dem);
}

static void make(scene what, const char *path) {
  FILE *file = open_file(path);
  if (what == DRUM) {
    drum_lattice(file);
    write_mesh(path);
  } else {
    lattice(file, what);
  }
  fclose(file);
  if (what != GAS)
    settle(path, what);
}

#endif
