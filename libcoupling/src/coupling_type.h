/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What cpl_t keeps between calls, for the files that implement coupling.h. */
#ifndef COUPLING_TYPE_H
#define COUPLING_TYPE_H

#include "coupling/coupling.h"
#include "disturbance.h"
#include "memory.h"
#include "relief.h"
#include "search.h"
#include "smoothing.h"
#include "weights.h"

enum cpl_stage { CPL_LOCATE, CPL_VOID, CPL_SAMPLE, CPL_FORCE, CPL_SOURCE, CPL_REACT, CPL_STAGES };

/* Of one particle, from cpl_fluid_force; a row of doubles, so that it can follow its particle. */
enum cpl_force_state {
  CPL_FORCE_SP = 0,       /* beta, kg/s */
  CPL_FORCE_EPS = 1,      /* eps at the particle */
  CPL_FORCE_U = 2,        /* [3] superficial velocity, m/s */
  CPL_FORCE_CONSTANT = 5, /* [3] part of Su that is not drag, N */
  CPL_FORCE_EXTRA = 8,    /* [3] lift, virtual mass by the fluid's acceleration; in Su too, N */
  CPL_FORCE_WIDTH = 11
};

struct cpl_t {
  MPI_Comm comm;
  int size;
  cpl_mesh mesh;
  cpl_params params;
  cpl_fluid fluid;
  cpl_search *search;
  cpl_weights *weights;
  cpl_smoother *smoother; /* NULL: smoothing off, or no particle seen yet */
  cpl_relief *relief;     /* NULL: a cell that is too full is an error */
  double smoothed_radius; /* m, that its bandwidth was made for */
  part_timers *timers;
  int stage[CPL_STAGES];

  /* as located: own particles in that order */
  int count;
  long long stamp; /* number of the weights; 0: none */
  CPL_ARRAY(int64_t) id;
  CPL_ARRAY(double) sphere; /* [count][4] */
  CPL_ARRAY(double) volume; /* [count] of the spheres */

  /* what was made with which weights */
  long long solid_stamp, sample_stamp, source_stamp, spread_stamp;
  cpl_disturbance *wake;          /* NULL: selfDisturbance off */
  CPL_ARRAY(double) solid;        /* [cells] deposited sphere volume, m3 */
  CPL_ARRAY(double) share;        /* [cells] sum_i w_ic b_i, kg/s: D V_c (B: D eps V_c) */
  CPL_ARRAY(double) implicit;     /* [count] b_i, kg/s (model B: b_i over sum_c w_ic/eps_c) */
  CPL_ARRAY(double) inverse_eps;  /* [count] sum_c w_ic/eps_c, model B only */
  CPL_ARRAY(double) reps;         /* [cells] 1/eps_c, model B only */
  CPL_ARRAY(double) eps;          /* [count] sampled */
  CPL_ARRAY(double) superficial;  /* [count][3] sampled */
  CPL_ARRAY(double) cell_flow;    /* [cells][3] what superficial was sampled from; unresolvedDrag off */
  CPL_ARRAY(double) resampled;    /* [count][3] that, where the particles are after the advance */
  CPL_ARRAY(double) curl;         /* [count][3] sampled, 1/s; lift, turning */
  CPL_ARRAY(double) acceleration; /* [count][3] sampled Du/Dt, m/s2; virtualMass */
  CPL_ARRAY(double) turning;      /* [count][4] see cpl_turning */
  CPL_ARRAY(double) told;         /* [count][3] N, drag and extra forces that the cells were told */
  CPL_ARRAY(double) extra;     /* [count][3] N, the part of told that is no drag; selfDisturbance */
  CPL_ARRAY(double) cell_told; /* [cells][3] N, their deposit */
  CPL_ARRAY(double) constant;  /* [count][3] grad p and div tau forces, N */
  CPL_ARRAY(double) spread;    /* [count][2] m2, wake.h; selfDisturbance */
  CPL_ARRAY(double) disturbance; /* [count][3] m/s; selfDisturbance */
  CPL_ARRAY(double) mean_d;      /* [count] m, Sauter mean diameter around; drag that needs it */
  int64_t outside;               /* particles outside the range of the drag law */

  /* of the last cpl_fluid_force, in the order of then */
  int force_count; /* -1: none yet */
  CPL_ARRAY(int64_t) force_id;
  CPL_ARRAY(double) force; /* [force_count][CPL_FORCE_WIDTH] */

  /* work space */
  CPL_ARRAY(double) smooth_work;
  CPL_ARRAY(double) cell_work;
  CPL_ARRAY(double) particle_work;
  CPL_ARRAY(double) particle_work2;
  CPL_ARRAY(int64_t) id_work;

  long long locates, reused;
  cpl_budget budget;
  int has_budget;
};

/* cpl_particles.kind */
enum { CPL_FREE_SPHERE = 0, CPL_FIXED_SPHERE = 1, CPL_BLOCK_MEMBER = 2 };

/* The largest status of all ranks; nothing with one rank. */
static inline int cpl_agree(const cpl_t *cpl, int status) {
  return cpl->size > 1 ? part_agree(cpl->comm, status) : status;
}
/* Local. ERR_STATE unless the particles are those of the last cpl_locate, in that order. */
int cpl_check_order(const cpl_t *cpl, const cpl_particles *particles, const char *caller);

/* Address of component 0 of particle i in a view. */
static inline const double *cpl_at(const double *base, int stride, int i) {
  return base + (size_t)i * (size_t)stride;
}

#endif
