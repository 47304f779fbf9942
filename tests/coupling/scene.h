/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A mesh split over the ranks and particles spread over them without regard to where they are, so
 * that most visits cross ranks; and the same on one rank (MPI_COMM_SELF) to compare with. Any
 * failure of the set-up aborts: these are tests. */
#ifndef TEST_SCENE_H
#define TEST_SCENE_H

#include "../../libcoupling/src/void_fractions.h"
#include "coupling/coupling.h"
#include "mesh_maker.h"

typedef struct scene {
  MPI_Comm comm;
  int rank, size;
  made_mesh whole, mesh; /* mesh: cells of this rank */
  cpl_params params;
  cpl_fluid fluid;
  cpl_t *cpl;
  /* own particles: packed rows of 20 doubles, laid out as a store would */
  cpl_particles view;
  double *row;
  int64_t *number; /* id, kind */
  /* fields of the cells of this rank */
  cpl_cells cells;
  double *eps, *solid_velocity, *superficial, *pressure_gradient, *stress_divergence, *coefficient,
      *explicit_part;
} scene;

enum {
  ROW_X = 0,
  ROW_R = 3,
  ROW_V = 4,
  ROW_IMASS = 7,
  ROW_SU = 8,
  ROW_SP = 11,
  ROW_J = 12,
  ROW_WIDTH = 16
};

/* One particle of the whole scene by id. */
typedef struct particle {
  double x[3], r, v[3], density;
  int kind;
} particle;

/* Hexahedra, periodic in x, and warped polyhedra, in the same box. */
extern const mesh_options scene_meshes[2];

cpl_params scene_params(void); /* defaults with drag diFelice */
cpl_fluid scene_water(void);

/* random_cells: cells to ranks at random rather than in blocks. comm MPI_COMM_SELF: all here. */
void scene_mesh(scene *s, MPI_Comm comm, const mesh_options *options, int random_cells);
/* cpl_create; returns its status. */
int scene_start(scene *s, const cpl_params *params, const cpl_fluid *fluid);
/* Both at once: defaults and water, by the row `method` of void_fractions.def. */
void scene_make(scene *s, MPI_Comm comm, const mesh_options *options, int random_cells, int method);
/* Particle i goes to rank (i * 7 + shift) % size, in the order of i or, reverse, from the end. */
void scene_particles(scene *s, int count, const particle *all, int shift, int reverse);
/* scene_particles (shift 0), located, and their void fraction; returns its volume error. */
double scene_fill(scene *s, int count, const particle *all);
void scene_free(scene *s);

/* count spheres of radius r_min..r_max anywhere in the box (partly outside it too), velocities and
 * densities at random. */
void scene_random(const mesh_options *options, int count, double r_min, double r_max, uint64_t seed,
                  particle *all);
double scene_volume(const particle *p); /* of the sphere, m3 */
double scene_row_volume(const double *row);
/* The impulse that implicit steps would give: m (v1 - v0) of m dv/dt = Su - Sp v, m of ROW_IMASS;
 * fixed: F dt. */
void scene_receive(scene *s, double dt);
/* What the void fraction leaves to solids in cell c of this rank, m3. */
double scene_solid(const scene *s, int c);
/* Whole-mesh number of cell c of this rank. */
int scene_global(const scene *s, int c);
/* Smooth velocity, pressure gradient, stress of the cells; eps from the coupling. */
void scene_fluid(scene *s);

/* |a - b| <= tolerance, and neither is NaN. */
#define assert_near(a, b, tolerance)                                                               \
  do {                                                                                             \
    const double near_a = (a), near_b = (b);                                                       \
    if (!(fabs(near_a - near_b) <= (tolerance)))                                                   \
      fail_msg("%s = %.17g, not %.17g (difference %g)", #a, near_a, near_b, near_a - near_b);      \
  } while (0)

double sum_over(MPI_Comm comm, double value);
double max_over(MPI_Comm comm, double value);
/* A number in (-1, 1) from an integer: the same on every rank. */
double number_of(uint64_t key);

#endif
