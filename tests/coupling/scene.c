/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void must(int ok, const char *what) {
  if (ok)
    return;
  fprintf(stderr, "scene: %s: %s\n", what, part_last_error());
  MPI_Abort(MPI_COMM_WORLD, 1);
}

const mesh_options scene_meshes[2] = {
    {.kind = MESH_HEX, .n = {5, 4, 3}, .hi = {1, 0.8, 0.6}, .periodic = {1, 0, 0}},
    {.kind = MESH_POLY, .n = {3, 3, 3}, .hi = {1, 0.8, 0.6}, .warp = 0.1, .seed = 8},
};

cpl_params scene_params(void) {
  cpl_params p;
  part_params_default(&cpl_params_table, &p);
  must(part_params_set(&cpl_params_table, "drag", NULL, "diFelice", &p) == PART_OK, "drag");
  return p;
}

cpl_fluid scene_water(void) {
  return (cpl_fluid){1000.0, 1e-3, {0.3, -0.2, -9.81}};
}

void scene_mesh(scene *s, MPI_Comm comm, const mesh_options *options, int random_cells) {
  memset(s, 0, sizeof *s);
  s->comm = comm;
  MPI_Comm_rank(comm, &s->rank);
  MPI_Comm_size(comm, &s->size);
  mesh_make(options, &s->whole);
  const int cells = s->whole.view.cells;
  int *owner = mesh_alloc((size_t)cells, sizeof *owner);
  if (random_cells)
    mesh_part_random(&s->whole, s->size, 5, owner);
  else
    mesh_part_blocks(&s->whole, s->size, owner);
  mesh_split(&s->whole, owner, s->rank, &s->mesh);
  free(owner);
  const size_t n = (size_t)s->mesh.view.cells;
  s->eps = mesh_alloc(n, sizeof(double));
  s->solid_velocity = mesh_alloc(3 * n, sizeof(double));
  s->superficial = mesh_alloc(3 * n, sizeof(double));
  s->pressure_gradient = mesh_alloc(3 * n, sizeof(double));
  s->stress_divergence = mesh_alloc(3 * n, sizeof(double));
  s->coefficient = mesh_alloc(n, sizeof(double));
  s->explicit_part = mesh_alloc(3 * n, sizeof(double));
  s->cells = (cpl_cells){.eps = s->eps,
                         .solid_velocity = s->solid_velocity,
                         .superficial = s->superficial,
                         .pressure_gradient = s->pressure_gradient,
                         .stress_divergence = s->stress_divergence,
                         .drag_coefficient = s->coefficient,
                         .drag_explicit = s->explicit_part};
}

int scene_start(scene *s, const cpl_params *params, const cpl_fluid *fluid) {
  s->params = *params;
  s->fluid = *fluid;
  return cpl_create(s->comm, &s->mesh.view, &s->mesh.box, params, fluid, &s->cpl);
}

void scene_make(scene *s, MPI_Comm comm, const mesh_options *options, int random_cells,
                int method) {
  const cpl_fluid fluid = scene_water();
  cpl_params params = scene_params();
  params.void_fraction = method;
  scene_mesh(s, comm, options, random_cells);
  must(scene_start(s, &params, &fluid) == PART_OK, "start");
}

double scene_volume(const particle *p) {
  return 4.0 / 3.0 * 3.14159265358979323846 * p->r * p->r * p->r;
}

static void add_particle(scene *s, int id, const particle *p) {
  const int i = s->view.count++;
  double *row = s->row + (size_t)i * ROW_WIDTH;
  memcpy(row + ROW_X, p->x, sizeof p->x);
  memcpy(row + ROW_V, p->v, sizeof p->v);
  row[ROW_R] = p->r;
  row[ROW_IMASS] = 1.0 / (p->density * scene_volume(p));
  s->number[2 * i] = id;
  s->number[2 * i + 1] = p->kind;
}

void scene_particles(scene *s, int count, const particle *all, int shift, int reverse) {
  free(s->row);
  free(s->number);
  s->row = mesh_alloc((size_t)count * ROW_WIDTH + 1, sizeof *s->row);
  s->number = mesh_alloc((size_t)count * 2 + 1, sizeof *s->number);
  s->view.count = 0;
  for (int k = 0; k < count; k++) {
    const int i = reverse ? count - 1 - k : k;
    if ((i * 7 + shift) % s->size == s->rank)
      add_particle(s, i, &all[i]);
  }
  double *row = s->row;
  s->view = (cpl_particles){.count = s->view.count,
                            .position = row + ROW_X,
                            .position_stride = ROW_WIDTH,
                            .radius = row + ROW_R,
                            .radius_stride = ROW_WIDTH,
                            .velocity = row + ROW_V,
                            .velocity_stride = ROW_WIDTH,
                            .inverse_mass = row + ROW_IMASS,
                            .inverse_mass_stride = ROW_WIDTH,
                            .id = s->number,
                            .id_stride = 2,
                            .kind = s->number + 1,
                            .kind_stride = 2,
                            .fluid_su = row + ROW_SU,
                            .fluid_su_stride = ROW_WIDTH,
                            .fluid_sp = row + ROW_SP,
                            .fluid_sp_stride = ROW_WIDTH,
                            .fluid_impulse = row + ROW_J,
                            .fluid_impulse_stride = ROW_WIDTH};
}

double scene_fill(scene *s, int count, const particle *all) {
  double error;
  scene_particles(s, count, all, 0, 0);
  must(cpl_locate(s->cpl, &s->view) == PART_OK, "locate");
  must(cpl_void_fraction(s->cpl, &s->view, &s->cells, &error) == PART_OK, "void fraction");
  return error;
}

double scene_solid(const scene *s, int c) {
  return (1.0 - s->eps[c]) * s->mesh.volume[c];
}

void scene_free(scene *s) {
  cpl_destroy(s->cpl);
  mesh_free(&s->whole);
  mesh_free(&s->mesh);
  free(s->row);
  free(s->number);
  free(s->eps);
  free(s->solid_velocity);
  free(s->superficial);
  free(s->pressure_gradient);
  free(s->stress_divergence);
  free(s->coefficient);
  free(s->explicit_part);
}

void scene_random(const mesh_options *options, int count, double r_min, double r_max, uint64_t seed,
                  particle *all) {
  for (int i = 0; i < count; i++) {
    particle *p = &all[i];
    p->r = r_min + (r_max - r_min) * mesh_random(&seed);
    for (int k = 0; k < 3; k++) {
      p->x[k] = options->lo[k] + (options->hi[k] - options->lo[k]) * mesh_random(&seed);
      p->v[k] = 0.2 * (mesh_random(&seed) - 0.5);
    }
    p->density = 500.0 + 3000.0 * mesh_random(&seed);
    p->kind = mesh_random(&seed) < 0.2;
  }
}

int scene_global(const scene *s, int c) {
  return s->mesh.global_cell ? s->mesh.global_cell[c] : c;
}

void scene_fluid(scene *s) {
  for (int c = 0; c < s->mesh.view.cells; c++) {
    const double *x = s->mesh.view.cell_centre + 3 * c;
    for (int k = 0; k < 3; k++) {
      s->superficial[3 * c + k] = 0.1 * sin(3.0 * x[(k + 1) % 3] + k) + 0.05 * x[k];
      s->pressure_gradient[3 * c + k] = 300.0 * cos(2.0 * x[k] + k);
      s->stress_divergence[3 * c + k] = 40.0 * sin(x[(k + 2) % 3]);
    }
  }
}

double sum_over(MPI_Comm comm, double value) {
  double sum;
  MPI_Allreduce(&value, &sum, 1, MPI_DOUBLE, MPI_SUM, comm);
  return sum;
}

double max_over(MPI_Comm comm, double value) {
  double largest;
  MPI_Allreduce(&value, &largest, 1, MPI_DOUBLE, MPI_MAX, comm);
  return largest;
}

double number_of(uint64_t key) {
  uint64_t state = key * UINT64_C(0x9e3779b97f4a7c15) + 12345;
  return 2.0 * mesh_random(&state) - 1.0;
}

double scene_row_volume(const double *row) {
  return 4.0 / 3.0 * 3.14159265358979323846 * row[ROW_R] * row[ROW_R] * row[ROW_R];
}

void scene_receive(scene *s, double dt) {
  for (int i = 0; i < s->view.count; i++) {
    double *row = s->row + i * ROW_WIDTH;
    const double x = row[ROW_SP] * row[ROW_IMASS] * dt;
    const double f = s->number[2 * i + 1] == 1 ? 1.0 : -expm1(-x) / x;
    for (int d = 0; d < 3; d++)
      row[ROW_J + d] = f * dt * (row[ROW_SU + d] - row[ROW_SP] * row[ROW_V + d]);
  }
}
