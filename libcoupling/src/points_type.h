/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What cpl_points_t keeps between calls, for the files that implement points.h. */
#ifndef COUPLING_POINTS_TYPE_H
#define COUPLING_POINTS_TYPE_H

#include "coupling/points.h"
#include "disturbance.h"
#include "memory.h"
#include "particle/exchange.h"
#include "points_table.h"

enum cpl_points_stage { POINTS_LOCATE, POINTS_POROSITY, POINTS_FORCE, POINTS_REACTION, POINTS_STAGES };

/* A sphere, or an image of one, as seen from a rank with points in its reach. */
typedef struct cpl_points_visit {
  double x[3], radius, diameter; /* m; diameter: of the drag law */
} cpl_points_visit;

enum { POINTS_GROUPS = 3 }; /* directions of planes */

struct cpl_points_t {
  MPI_Comm comm;
  int size, rank;
  part_box box;
  cpl_points_params params;
  cpl_fluid fluid;
  cpl_points_kernel kernel;
  int groups, in_group[POINTS_GROUPS];
  cpl_points_plane plane[POINTS_GROUPS][2];
  cpl_points_table_data table;
  part_timers *timers;
  int stage[POINTS_STAGES];

  /* as located: own particles and their visits, to all ranks */
  int count, located, sent, received; /* located: 1 pairs, 2 eps too */
  double reach;
  CPL_ARRAY(int64_t) id;
  CPL_ARRAY(double) volume;   /* [count] m3 */
  CPL_ARRAY(int) particle;    /* [sent] */
  CPL_ARRAY(int) destination; /* [sent] */
  CPL_ARRAY(cpl_points_visit) sent_visit, visit;
  part_exchange *plan;
  CPL_ARRAY(double) bounds; /* [size][6] of the points of each rank */
  CPL_ARRAY(double) send_buffer, receive_buffer;

  /* points of this rank, and pairs in rows of received visits */
  int points;
  CPL_ARRAY(int) order;   /* [points] bin order -> caller's */
  CPL_ARRAY(double) place; /* [points][3] in bin order */
  CPL_ARRAY(size_t) start; /* [received + 1] */
  CPL_ARRAY(int) partner;  /* caller's index of the point */
  CPL_ARRAY(double) weight; /* K_ia, 1/m3 */
  CPL_ARRAY(int) bin_start;
  CPL_ARRAY(int) bin_of;
  CPL_ARRAY(double) solid;   /* [points] sum_i V_i K_ia */
  CPL_ARRAY(double) by_size; /* [points] sum_i V_i K_ia/d_i, when the law needs sizes */
  CPL_ARRAY(double) eps;     /* [points] */
  CPL_ARRAY(double) share;   /* [points] V_a of the last force */

  /* of the last force, in that order of particles */
  int force_count;
  int64_t outside;
  double drag_rate; /* 1/s, largest of own particles */
  CPL_ARRAY(double) sum; /* [count] S_i */
  CPL_ARRAY(double) sampled_eps, velocity, wet;
  /* form pairwise: p at each particle, sum of its pair forces; what visits carry; place of each point as located */
  CPL_ARRAY(double) pressure, paired, carried, place_at;
  CPL_ARRAY(double) work, work2;
  CPL_ARRAY(int64_t) id_work;
  cpl_budget budget;
  int has_budget;
  CPL_ARRAY(cpl_disturbance) wake; /* [1] with self_disturbance */
  double variance;                 /* m2, of the kernel W per axis */
};

static inline double points_sphere_volume(double r) {
  return 4.0 / 3.0 * 3.14159265358979323846 * r * r * r;
}

static inline const double *points_at(const double *base, int stride, int i) {
  return base + (size_t)i * (size_t)stride;
}

/* points_visits.c */
int points_check_planes(cpl_points_t *p, int planes, const cpl_points_plane *plane);
int points_make_visits(cpl_points_t *p, const cpl_particles *particles); /* local */
int points_send_visits(cpl_points_t *p);                                /* collective */
/* Collective. value[count][n] of own particles -> [received][n]; and back, summed: value is written. */
int points_forward(cpl_points_t *p, int n, const double *value, double **received);
int points_back(cpl_points_t *p, int n, double *received, double *value);
/* points_gradient.c: gradient of eps into the view, after eps. Local. */
void points_eps_gradient(const cpl_points_t *p, cpl_fluid_points *fluid);
/* points_pairwise.c. Collective, after Sp, wet, S and p of each particle: adds its pair forces to Su. */
int points_pairwise_force(cpl_points_t *p, const cpl_particles *particles, const cpl_fluid_points *fluid);
/* Local. Their opposites to the points, whose velocity and pressure are as they were. */
void points_pairwise_react(const cpl_points_t *p, cpl_fluid_points *fluid);
/* points_wake.c */
int points_wake_make(cpl_points_t *p);
/* u[3], the velocity at particle i, without its own disturbance, and eps without its own volume; after its eps. */
double points_wake_eps(const cpl_points_t *p, int i, double radius);
void points_wake_subtract(const cpl_points_t *p, const cpl_particles *particles, int i, double *u);
void points_wake_remember(const cpl_points_t *p, const cpl_particles *particles, double dt);
/* points_pairs.c */
int points_make_pairs(cpl_points_t *p, const cpl_fluid_points *fluid); /* local */
static inline int points_uses_sizes(const cpl_points_t *p) {
  return cpl_drag_needs_sizes(p->params.drag);
}

/* Share of the kernel about x that is inside walls. */
static inline double points_inside(const cpl_points_t *p, const double *x) {
  const double gamma = p->kernel.gamma ? p->kernel.gamma(p->kernel.context, x) : 1.0;
  return gamma > 1e-3 ? gamma : 1e-3;
}

#endif
