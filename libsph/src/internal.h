/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of libsph share. */
#ifndef SPH_INTERNAL_H
#define SPH_INTERNAL_H

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "pair_loops.h"
#include "particle/neighbours.h"
#include "sph/sph.h"
#include "particle/sum.h"
#include "walls.h"

enum { SPH_MASS = 4, SPH_RATE = 4, SPH_FORCE = 8, SPH_SEEN = 1, SPH_META = 2 };
enum { SPH_FOLLOW = 7 }; /* of the sums of the density: factor of S.27 */ /* widths of records */

/* What the scene needs, worked out by sph_start and when eps is set. */
typedef struct sph_plan {
  int walls;     /* there are some */
  int fixed;     /* walls of fixed points */
  int pushed;    /* walls that push along their normal, without points */
  int diffusion; /* densityDiffusion > 0 */
  int xsph, summation, shifting, correction;
  int variable;    /* a smoothing length for each particle (S.26) */
  int viscous;     /* viscosity > 0 */
  int hydrostatic; /* gravity along a direction that is not periodic */
  int balance;     /* forces differ from particle to particle: S.5 with that of both */
  int porous;      /* eps below 1 somewhere */
  int forces;      /* a force of others somewhere */
  int eps_moves;   /* a rate of eps somewhere */
  int seen;        /* porous, and p from the eps that the divergence sees (S.27) */
} sph_plan;

enum sph_stage {
  SPH_STAGE_DENSITY,
  SPH_STAGE_FORCE,
  SPH_STAGE_WALLS,
  SPH_STAGE_MOVE,
  SPH_STAGE_NEIGHBOURS,
  SPH_STAGE_GHOSTS,
  SPH_STAGE_COUNT
};

/* Full lists: row i has all partners of i, padded with i itself to whole blocks. */
typedef struct sph_lists {
  int rows;
  int *start, *partner;
  size_t start_room, partner_room;
  long long listed; /* directed pairs, without padding */
} sph_lists;

struct sph_t {
  MPI_Comm comm;
  int rank, ranks;
  sph_params params;
  part_domain *domain;
  part_box box;
  part_store *store;
  part_pairs *pairs; /* half lists, from which the full ones are made */
  part_timers *timers;
  int stage[SPH_STAGE_COUNT];

  double reach, skin;    /* m, radius of the support */
  double unit_norm;      /* norm h^d, over depth with two dimensions */
  double norm;           /* 1/m3: W = norm shape(r/h), over depth with two dimensions */
  double cell;           /* m3, spacing^dim */
  double plane;          /* m, z of all particles with two dimensions */
  double hydrostatic[3]; /* Pa/m */
  double common[3];      /* m/s2, that all particles get of FORCE along periodic directions */
  double monaghan;       /* alpha of S.9 */
  sph_plan plan;
  sph_walls walls;

  int started, restored, restored_elsewhere;
  int has_seen;  /* SEEN is that of the step before */
  int eps_ahead; /* EPS is that of the end of the next advance */
  int64_t total;
  double time, least_eps;
  sph_lists lists;
  const sph_loops *loops;
  int width_limit;
  double *sum; /* [own][SPH_SUMS] */
  size_t sum_room;
  double *shift; /* [own][SPH_SHIFTS] */
  size_t shift_room;
  double *shade; /* [own] sum of V W over ghost points: 1 - Gamma (S.6) */
  size_t shade_room;
  double *factor; /* [all] of S.22 */
  size_t factor_room;
  double *balance; /* [all][SPH_BALANCE] Pa/m of S.5 */
  size_t balance_room;
  double *lens; /* [all][2] 1/h, 1/Omega of S.26 */
  size_t lens_room;
  double least_support; /* m, of all particles when lists were made */
  double *saved; /* [own][8] x v rho_bar when a step of the predictor-corrector began */
  size_t saved_room;

  double travel;        /* m, bound of the way of any particle since the lists were built */
  double wall_force[3]; /* N, on own particles now */
  double own_mass;      /* kg */
  part_sum gravity_impulse, wall_impulse, force_impulse;
  double initial_momentum[3];
  long long generation, steps, rebuilds;
  double imbalance;
};

/* ---- access
 * -------------------------------------------------------------------------------------- */
static inline double *sph_xv(const sph_t *sph) {
  return part_record_double(sph->store, SPH_RECORD_XV);
}
static inline double *sph_mass(const sph_t *sph) {
  return part_record_double(sph->store, SPH_RECORD_MASS);
}
static inline double *sph_rate(const sph_t *sph) {
  return part_record_double(sph->store, SPH_RECORD_RATE);
}
static inline double *sph_force(const sph_t *sph) {
  return part_record_double(sph->store, SPH_RECORD_FORCE);
}
static inline double *sph_seen(const sph_t *sph) {
  return part_record_double(sph->store, SPH_RECORD_SEEN);
}
static inline int64_t sph_id(const sph_t *sph, int i) {
  return part_record_int64(sph->store, SPH_RECORD_META)[SPH_META * (size_t)i];
}
/* Smoothing length of own particle i, and the factor of W = norm shape(r/h) with it. */
static inline double sph_length(const sph_t *sph, int i) {
  return sph->plan.variable ? 1.0 / sph->lens[2 * (size_t)i] : sph->params.smoothing_length;
}
static inline double sph_norm_at(const sph_t *sph, double h) {
  return !sph->plan.variable          ? sph->norm
         : sph->params.dimensions == 2 ? sph->unit_norm / (h * h)
                                       : sph->unit_norm / (h * h * h);
}

/* ---- memory.c: ERR_MEMORY; items are zero
 * -------------------------------------------------------- */
int sph_grow(size_t count, size_t size, size_t *capacity, void *pointer_to_pointer);

/* ---- kernel.c
 * ------------------------------------------------------------------------------------ */
double sph_shape(int kernel, double q);
double sph_slope(int kernel, double q); /* (1/q) d shape/dq */
double sph_kernel_norm(int kernel, int dimensions);
double sph_kernel_monaghan(int kernel, int dimensions);

/* ---- insert.c
 * ------------------------------------------------------------------------------------ */
/* Density of the fluid at a pressure (S.3), 0 where there is none. */
double sph_density_at(const sph_params *params, double pressure);

/* ---- state.c
 * ------------------------------------------------------------------------------------- */
/* Volume and pressure of own particle i from its mass, density and eps (S.1, S.3). */
void sph_set_state(sph_t *sph, int i);
void sph_set_states(sph_t *sph);
/* Collective. Copies of volume, velocity, pressure, position (and eps) to the ghosts. */
int sph_refresh_ghosts(sph_t *sph);
/* Rates of density into the sums and RATE; positions, velocities and pressures of ghosts are there.
 */
int sph_density_rates(sph_t *sph);
/* Collective. Factors of S.22 of own particles and ghosts, from the sums of the density. */
int sph_make_factors(sph_t *sph);
/* Densities as sums (S.6). */
void sph_density_sums(sph_t *sph);
/* Accelerations into RATE, and the force on the walls. */
int sph_accelerations(sph_t *sph);
/* Collective. ERR_NUMERIC, ERR_OUTSIDE. */
int sph_check_state(sph_t *sph);
/* Collective. Longest step and largest speed. */
int sph_limits(sph_t *sph, double *step, double *speed);

/* Sums of S.19 into sph->shift. */
int sph_shift_sums(sph_t *sph);

/* ---- balance.c (S.5)
 * ------------------------------------------------------------------------------------ */
/* Collective. Whether it is needed, and what all particles get alike, from FORCE and eps. */
int sph_plan_balance(sph_t *sph);
/* Room for own particles and ghosts. */
int sph_grow_balance(sph_t *sph);
/* Collective. Of own particles and ghosts, from volumes, eps and FORCE. */
int sph_make_balance(sph_t *sph);

/* ---- shift.c
 * ------------------------------------------------------------------------------------ */
/* Most of its way in a step by which a particle is shifted besides. */
double sph_shift_room(const sph_t *sph);
/* 0 at a free surface to 1 inside, of the sum -sum V x.grad W/d. */
double sph_share_inside(double moment);
/* Particle i, with the sums of its place, moved on for a step h from the given place. */
void sph_shift_one(const sph_t *sph, int i, double h, double x[3], double *density, double *eps);
void sph_shift(sph_t *sph, double h);
/* The same by factor times a way, without a change of pressure (S.11). */
void sph_carry(const sph_t *sph, int i, double factor, const double way[3], double x[3],
               double *density, double *eps);
/* eps + change, held in (0, 1]. */
double sph_moved_eps(double eps, double change);

/* ---- lengths.c (S.26)
 * ------------------------------------------------------------------------------------ */
/* 1/h of own particles from their volumes. */
void sph_set_lengths(sph_t *sph);
/* Collective. 1/h and 1/Omega of ghosts. */
int sph_copy_lengths(sph_t *sph);
/* 1/Omega from the sums of variable_density and walls, for S.4. */
void sph_set_omegas(sph_t *sph);
void sph_set_omega(sph_t *sph, int i, double omega);
/* Volume of a particle with the length h, over h^d. */
double sph_unit_volume(const sph_t *sph);
/* ERR_RANGE: a length above largestSmoothing. */
int sph_check_lengths(const sph_t *sph);
/* Collective. Have the lengths outgrown the lists of some rank? */
int sph_outgrown(const sph_t *sph, int *is);
/* Collective. Half supports for lists that hold until lengths have grown by a margin, and their range. */
int sph_list_supports(sph_t *sph, double range[2]);
/* Collective. Shortest length. */
int sph_least_length(const sph_t *sph, double *h);

/* ---- solve_lengths.c (S.26)
 * ------------------------------------------------------------------------------------ */
/* Collective. h, Omega and density together, for S.6. */
int sph_solve_lengths(sph_t *sph);
/* Collective. Lists anew where a length has outgrown them; ghosts are up to date afterwards. ERR_RANGE: a length
 * above largestSmoothing. */
int sph_hold_lengths(sph_t *sph);

/* ---- lists.c
 * ------------------------------------------------------------------------------------- */
/* Collective. Migrate, sort, ghosts, lists. */
int sph_rebuild(sph_t *sph, int balance);
/* Collective. Widest loops that all ranks have. */
int sph_choose_loops(sph_t *sph);
/* What the pair loops work on. */
sph_lanes sph_lanes_of(const sph_t *sph);

/* ---- plan.c
 * -------------------------------------------------------------------------------------- */
/* Collective. porous, forces and least eps from the fields. */
int sph_plan_fields(sph_t *sph);
void sph_make_plan(sph_t *sph);

/* ---- report.c
 * ------------------------------------------------------------------------------------ */
/* Momentum of own particles; size: sum of m |v| (NULL: not). */
void sph_own_momentum(const sph_t *sph, double momentum[3], double *size);
/* Collective. Sum of n doubles over ranks in rank order: the same bits on every rank. */
int sph_rank_sum(const sph_t *sph, int n, double *values);

#endif
