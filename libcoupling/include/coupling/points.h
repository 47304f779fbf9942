/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libcoupling: the exchange between particles and points of a fluid without a mesh (smoothed particles).
 * It stores neither; both are views. Points and particles may be on different ranks.
 *
 * Particle i and point a share the weight w_ia = V_a K_ia / S_i, S_i = sum_a V_a K_ia, with V_a the
 * volume of the point and K_ia the mean over sphere i of a kernel about the point (doc/equations.md, P.1):
 *   eps_a = 1 - sum_i V_i K_ia            porosity
 *   q_i   = sum_a w_ia q_a                sampled quantity
 *   f_a   = - sum_i w_ia J_i/dt           force on the point from the impulse J_i of a particle
 * so sum_a f_a = - sum_i J_i/dt whatever the points are.
 *
 * SI units. Status returns as in particle/status.h. */
#ifndef COUPLING_POINTS_H
#define COUPLING_POINTS_H

#include "coupling/coupling.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The points of this rank, in any order. Strides in doubles. */
/* clang-format off */
typedef struct cpl_fluid_points {
  int count;
  const double *position;     int position_stride;     /* m */
  const double *velocity;     int velocity_stride;     /* m/s, interstitial */
  const double *volume;       int volume_stride;       /* m3, of fluid and solids */
  const double *density;      int density_stride;      /* kg/m3, superficial; form gradient only */
  const double *acceleration; int acceleration_stride; /* m/s2, of pressure and viscosity; form gradient only */
  const double *pressure;     int pressure_stride;     /* Pa; form pairwise only */
  double *eps;                int eps_stride;          /* out of cpl_points_porosity */
  double *eps_gradient;       int eps_gradient_stride; /* 1/m, out of cpl_points_porosity; NULL: not wanted */
  double *force;              int force_stride;        /* N, out of cpl_points_reaction */
} cpl_fluid_points;
/* clang-format on */

/* Kernel W of the exchange, in three dimensions. */
typedef struct cpl_points_kernel {
  double support;                                     /* m, radius beyond which W = 0 */
  double (*value)(const void *context, double r);     /* W, 1/m3 */
  double (*gamma)(const void *context, const double x[3]); /* share of the integral of W about x that is
                                                         inside walls; NULL: 1 (none, or planes below) */
  const void *context;
} cpl_points_kernel;

/* Plane walls at which spheres are mirrored, so that eps is right beside them and in their corners, no solid
 * volume is lost behind them, and beside a wall the fluid gets its part of the drag as elsewhere: whole planes, at right angles to each other or parallel (two at most),
 * not across a periodic direction. */
typedef struct cpl_points_plane {
  double point[3], normal[3]; /* m; 1, to the fluid */
} cpl_points_plane;

typedef enum { CPL_POINTS_COMBINED, CPL_POINTS_GRADIENT, CPL_POINTS_PAIRWISE } cpl_points_form;
typedef enum { CPL_POINTS_EXACT, CPL_POINTS_CENTRE } cpl_points_porosity_method;
typedef struct cpl_points_params {
  int form, porosity;
  double coupling_length; /* for whoever makes the kernel */
  double minimum_eps, drag_fraction;
  int drag;    /* row of coupling/drag_laws.def, not in the table */
  int two_way; /* 0: the points get neither eps nor force; not in the table */
  int self_disturbance; /* drag without the flow that the sphere's own drag has made (P.11); particles have
                           memory; form combined; not in the table */
  double still[3]; /* m/s2, part of the fluid's gravity that drives it not, because its pressure is that
                      beyond the one it has at rest (P.10); 0: none; not in the table */
} cpl_points_params;
extern const part_param_table cpl_points_table;

typedef struct cpl_points_t cpl_points_t;

/* Collective. Form pairwise has no planes (ERR_ARGUMENT). Duplicates comm, copies all else (the kernel's context must stay). fluid->gravity: all that
 * drives the fluid; its reaction is the buoyancy of form combined. ERR_RANGE, ERR_ARGUMENT: an entry, or a
 * plane that is not as above. */
int cpl_points_create(MPI_Comm comm, const part_box *box, const cpl_points_params *params,
                      const cpl_fluid *fluid, const cpl_points_kernel *kernel, int planes,
                      const cpl_points_plane *plane, cpl_points_t **points);
void cpl_points_destroy(cpl_points_t *points);
part_timers *cpl_points_timers(cpl_points_t *points);

/* Collective. Pairs of particles and points where both are now, and their kernels. position of the points may
 * be where they will be. ERR_RANGE: a sphere's reach is longer than a periodic direction. */
int cpl_points_locate(cpl_points_t *points, const cpl_particles *particles, const cpl_fluid_points *fluid);
/* Collective. eps of the points as located, and its gradient (P.12); into the view with two-way coupling. ERR_RANGE: below
 * minimumEps, the text names the place. */
int cpl_points_porosity(cpl_points_t *points, cpl_fluid_points *fluid);
/* Collective. F = Su - Sp v into the particle view, from fluid velocity and eps sampled at the particles. The
 * order of both is that of cpl_points_locate (ERR_STATE). */
int cpl_points_force(cpl_points_t *points, cpl_particles *particles, const cpl_fluid_points *fluid);
/* Collective. After the particles' own steps over dt: force on the points (order of cpl_points_force) from
 * the impulses that the particles, in any order now, really received. One-way coupling: leaves the view. */
int cpl_points_reaction(cpl_points_t *points, const cpl_particles *particles, cpl_fluid_points *fluid,
                        double dt);

/* Collective. Longest step (s) over which drag of the last cpl_points_force may be constant; HUGE_VAL: any. */
int cpl_points_stable_step(const cpl_points_t *points, double *step);
/* Of the last cpl_points_force, [count], [count][3], [count]: eps and fluid velocity at the particles, and the
 * share of each that is wet (1 but near a free surface). */
const double *cpl_points_sampled_eps(const cpl_points_t *points);
const double *cpl_points_sampled_velocity(const cpl_points_t *points);
const double *cpl_points_wet(const cpl_points_t *points);
/* Own particles of the last cpl_points_force where the drag law was outside its range. */
int64_t cpl_points_outside_range(const cpl_points_t *points);
/* Impulses (N s) of the last cpl_points_reaction: error is |sum| over the sum of magnitudes. */
int cpl_points_budget(const cpl_points_t *points, cpl_budget *budget);
/* Pairs of particles and points of this rank. */
long long cpl_points_pairs(const cpl_points_t *points);
/* Mean over a sphere of radius R (m) of the kernel about a point at the distance s (m) from its centre,
 * from the table; for tests. After cpl_points_locate. */
double cpl_points_sphere_kernel(const cpl_points_t *points, double s, double radius);

#ifdef __cplusplus
}
#endif
#endif
