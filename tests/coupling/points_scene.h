/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Spheres and fluid points spread over the ranks without regard to where they are, and the same on one rank. */
#ifndef TEST_POINTS_SCENE_H
#define TEST_POINTS_SCENE_H

#include <stdint.h>
#include "coupling/points.h"

enum { PX = 0, PU = 3, PV = 6, PRHO = 7, PA = 8, PEPS = 11, PF = 12, PP = 15, POINT_WIDTH = 16 };
enum { SX = 0, SR = 3, SV = 4, SIM = 7, SSU = 8, SSP = 11, SJ = 12, SPHERE_WIDTH = 16 };

typedef struct points_scene {
  MPI_Comm comm;
  int rank, size;
  part_box box;
  cpl_points_params params;
  cpl_fluid fluid;
  cpl_points_kernel kernel;
  double h; /* m, of the kernel: Wendland C2 with support 2 h */
  cpl_points_t *points;
  cpl_fluid_points fluid_view;
  cpl_particles view;
  double *point, *sphere; /* own rows */
  int64_t *point_id, *number; /* of own points; id, kind of own spheres */
} points_scene;

/* Unit box, periodic or not, in water; defaults with diFelice. */
void points_scene_init(points_scene *s, MPI_Comm comm, double h, int periodic);
int points_scene_start(points_scene *s, int planes, const cpl_points_plane *plane);
/* Rows of the whole scene: item k goes to rank (k * 7 + shift) % size. */
void points_scene_spheres(points_scene *s, int count, const double *rows, int shift);
void points_scene_points(points_scene *s, int count, const double *rows, int shift);
void points_scene_free(points_scene *s);
/* [0, 1) */
double points_random(uint64_t *state);
/* n^3 cells of the box; rows zero but for place and volume. Returns count; caller frees. */
int points_lattice(const part_box *box, int n, double jitter, double **rows);
int spheres_lattice(const part_box *box, int n, double radius, double **rows);
/* Collective. Own values of `width` at offset `from` of rows of `stride` into all[count][width] by number k. */
void points_gather(const points_scene *s, int count, int own, const int64_t *id, int id_stride,
                   const double *rows, int stride, int from, int width, double *all);

#define assert_near(a, b, tolerance)                                                               \
  do {                                                                                             \
    const double near_a = (a), near_b = (b);                                                       \
    if (!(fabs(near_a - near_b) <= (tolerance)))                                                   \
      fail_msg("%s = %.17g, not %.17g (difference %g)", #a, near_a, near_b, near_a - near_b);      \
  } while (0)
#endif
