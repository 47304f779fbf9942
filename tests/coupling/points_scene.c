/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "points_scene.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

static double wendland(const void *context, double r) {
  const double h = *(const double *)context, q = r / h, t = 1.0 - 0.5 * q;
  return q < 2.0 ? 21.0 / (16.0 * PI * h * h * h) * t * t * t * t * (2.0 * q + 1.0) : 0.0;
}

void points_scene_init(points_scene *s, MPI_Comm comm, double h, int periodic) {
  memset(s, 0, sizeof *s);
  s->comm = comm;
  MPI_Comm_rank(comm, &s->rank);
  MPI_Comm_size(comm, &s->size);
  for (int c = 0; c < 3; c++) {
    s->box.hi[c] = 1.0;
    s->box.periodic[c] = periodic;
  }
  part_params_default(&cpl_points_table, &s->params);
  for (int k = 0; k < cpl_drag_count(); k++)
    if (strcmp(cpl_drag_name(k), "diFelice") == 0)
      s->params.drag = k;
  s->params.two_way = 1;
  s->fluid = (cpl_fluid){1000.0, 1e-3, {0.0, 0.0, -9.81}};
  s->h = h;
  s->kernel = (cpl_points_kernel){2.0 * h, wendland, NULL, &s->h};
}

int points_scene_start(points_scene *s, int planes, const cpl_points_plane *plane) {
  return cpl_points_create(s->comm, &s->box, &s->params, &s->fluid, &s->kernel, planes, plane, &s->points);
}

static int share(const points_scene *s, int count, const double *rows, int width, int shift, double **own,
                 int64_t **number, int number_width) {
  int n = 0;
  *own = realloc(*own, ((size_t)count + 1) * (size_t)width * sizeof **own);
  *number = realloc(*number, ((size_t)count + 1) * (size_t)number_width * sizeof **number);
  if (!*own || !*number)
    abort();
  for (int k = 0; k < count; k++)
    if ((k * 7 + shift) % s->size == s->rank) {
      memcpy(*own + (size_t)n * (size_t)width, rows + (size_t)k * (size_t)width,
             (size_t)width * sizeof **own);
      memset(*number + n * number_width, 0, (size_t)number_width * sizeof **number);
      (*number)[n++ * number_width] = k;
    }
  return n;
}

void points_scene_spheres(points_scene *s, int count, const double *rows, int shift) {
  const int n = share(s, count, rows, SPHERE_WIDTH, shift, &s->sphere, &s->number, 2);
  double *r = s->sphere;
  s->view = (cpl_particles){.count = n,
                            .position = r + SX,
                            .position_stride = SPHERE_WIDTH,
                            .radius = r + SR,
                            .radius_stride = SPHERE_WIDTH,
                            .velocity = r + SV,
                            .velocity_stride = SPHERE_WIDTH,
                            .inverse_mass = r + SIM,
                            .inverse_mass_stride = SPHERE_WIDTH,
                            .id = s->number,
                            .id_stride = 2,
                            .kind = s->number + 1,
                            .kind_stride = 2,
                            .fluid_su = r + SSU,
                            .fluid_su_stride = SPHERE_WIDTH,
                            .fluid_sp = r + SSP,
                            .fluid_sp_stride = SPHERE_WIDTH,
                            .fluid_impulse = r + SJ,
                            .fluid_impulse_stride = SPHERE_WIDTH};
}

void points_scene_points(points_scene *s, int count, const double *rows, int shift) {
  const int n = share(s, count, rows, POINT_WIDTH, shift, &s->point, &s->point_id, 1);
  double *r = s->point;
  s->fluid_view = (cpl_fluid_points){.count = n,
                                     .position = r + PX,
                                     .position_stride = POINT_WIDTH,
                                     .velocity = r + PU,
                                     .velocity_stride = POINT_WIDTH,
                                     .volume = r + PV,
                                     .volume_stride = POINT_WIDTH,
                                     .density = r + PRHO,
                                     .density_stride = POINT_WIDTH,
                                     .acceleration = r + PA,
                                     .acceleration_stride = POINT_WIDTH,
                                     .pressure = r + PP,
                                     .pressure_stride = POINT_WIDTH,
                                     .eps = r + PEPS,
                                     .eps_stride = POINT_WIDTH,
                                     .force = r + PF,
                                     .force_stride = POINT_WIDTH};
}

void points_scene_free(points_scene *s) {
  cpl_points_destroy(s->points);
  free(s->point);
  free(s->sphere);
  free(s->point_id);
  free(s->number);
  memset(s, 0, sizeof *s);
}

double points_random(uint64_t *state) {
  *state = *state * 6364136223846793005u + 1442695040888963407u;
  return (double)(*state >> 11) / 9007199254740992.0;
}

static int lattice(const part_box *box, int n, int width, double jitter, double **rows) {
  uint64_t seed = 5;
  *rows = calloc((size_t)(n * n * n * width), sizeof **rows);
  if (!*rows)
    abort();
  for (int k = 0; k < n * n * n; k++) {
    const int at[3] = {k % n, k / n % n, k / (n * n)};
    for (int c = 0; c < 3; c++)
      (*rows)[k * width + c] =
          box->lo[c] + (box->hi[c] - box->lo[c]) / n * (at[c] + 0.5 + jitter * (points_random(&seed) - 0.5));
  }
  return n * n * n;
}

int points_lattice(const part_box *box, int n, double jitter, double **rows) {
  const int count = lattice(box, n, POINT_WIDTH, jitter, rows);
  for (int k = 0; k < count; k++) {
    (*rows)[k * POINT_WIDTH + PV] =
        (box->hi[0] - box->lo[0]) * (box->hi[1] - box->lo[1]) * (box->hi[2] - box->lo[2]) / count;
    (*rows)[k * POINT_WIDTH + PRHO] = 1000.0;
  }
  return count;
}

int spheres_lattice(const part_box *box, int n, double radius, double **rows) {
  const int count = lattice(box, n, SPHERE_WIDTH, 0.0, rows);
  for (int k = 0; k < count; k++) {
    (*rows)[k * SPHERE_WIDTH + SR] = radius;
    (*rows)[k * SPHERE_WIDTH + SIM] = 1.0 / (2500.0 * 4.0 / 3.0 * PI * radius * radius * radius);
  }
  return count;
}

void points_gather(const points_scene *s, int count, int own, const int64_t *id, int id_stride,
                   const double *rows, int stride, int from, int width, double *all) {
  memset(all, 0, (size_t)(count * width) * sizeof *all);
  for (int k = 0; k < own; k++)
    memcpy(all + id[k * id_stride] * width, rows + (size_t)k * (size_t)stride + from,
           (size_t)width * sizeof *all);
  if (s->size > 1)
    MPI_Allreduce(MPI_IN_PLACE, all, count * width, MPI_DOUBLE, MPI_SUM, s->comm);
}
