/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libcoupling: the exchange between particles and the cells of a finite volume mesh. It stores
 * neither: it works on views, so that it is tested without a flow solver.
 *
 *   cells --sample--> particles --substeps--> particles --deposit--> cells
 *
 * Particle i has in cell c the weight w_ic = (its volume there) / (its volume in all cells), so
 * sum_c w_ic = 1. The same weights carry volume, forces and sampled fluid quantities:
 *   eps_c   = 1 - sum_i w_ic V_i / V_c           void fraction
 *   q_i     = sum_c w_ic q_c                     sampled quantity
 *   Q_c     = sum_i w_ic Q_i                     deposited quantity
 * so sample and deposit are adjoint and every exchange is conservative. With smoothing, both go
 * through the same symmetric kernel on the mesh as well (src/smoothing.h), and stay so.
 *
 * SI units; rho_f is the fluid density. Status returns as in particle/status.h. */
#ifndef COUPLING_COUPLING_H
#define COUPLING_COUPLING_H

#include <mpi.h>
#include <stdint.h>
#include "particle/domain.h"
#include "particle/params.h"
#include "particle/status.h"
#include "particle/timers.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- views ---------------------------------------------------------------------------------- */
/* Boundary faces with a cell on the other side: cyclic, or another rank. */
typedef struct cpl_coupled_faces {
  int count;
  const int *cell;           /* [count] on this side */
  const double *conductance; /* [count] (S.d)/|d|^2 with d from centre to centre, m */
  const double *way;         /* [count][3] d, m */
  /* Collective. other[count][n] = own[count][n] of the same face seen from there. */
  int (*exchange)(void *context, int n, const double *own, double *other);
  void *context;
} cpl_coupled_faces;

/* The cells of this rank, as an OpenFOAM mesh stores them. Faces point from owner to neighbour
 * (outwards on the boundary); faces internal .. faces-1 are boundary faces of any kind. Not copied:
 * the arrays must stay until cpl_destroy. */
typedef struct cpl_mesh {
  int points, faces, internal, cells;
  const double *point;              /* [points][3], m */
  const int *face_start;            /* [faces+1] into face_point */
  const int *face_point;            /* corner points of each face, in order */
  const int *owner;                 /* [faces] */
  const int *neighbour;             /* [internal] */
  const double *face_centre;        /* [faces][3], m: apex of the triangle fan of a warped face */
  const double *cell_centre;        /* [cells][3], m */
  const double *volume;             /* [cells], m3 */
  const cpl_coupled_faces *coupled; /* NULL: none, or smoothing is off */
} cpl_mesh;

/* selfDisturbance: vectors (m/s2 kg, forces) that the caller keeps for each particle, zero at
 * first. cpl_reaction renews them, cpl_fluid_force reads them. */
enum { CPL_MEMORY_VECTORS = 8 };

/* Own particles of this rank, which need not be where the cells of this rank are. Strides in
 * doubles (int64 for id, kind). fluid_* are written by cpl_fluid_force. */
/* clang-format off */
typedef struct cpl_particles {
  int count;
  const double *position;     int position_stride;
  const double *radius;       int radius_stride;
  const double *drag_radius;  int drag_radius_stride; /* NULL: radius; see cpl_fluid_force */
  const double *velocity;     int velocity_stride;
  const double *velocity_before; int velocity_before_stride; /* virtualMass, two-way only: at the
                                          end of the last advance, without the kick after it */
  const double *angular_velocity; int angular_velocity_stride; /* magnusLift, rotationalDrag only */
  const double *inverse_mass; int inverse_mass_stride; /* virtualMass: of m + m_a */
  const int64_t *id;          int id_stride;
  const int64_t *kind;        int kind_stride; /* NULL: free; else as dem.h: 0 free, 1 fixed, 2 block */
  double *fluid_su;           int fluid_su_stride; /* N, 3 components */
  double *fluid_sp;           int fluid_sp_stride; /* kg/s */
  const double *fluid_impulse; int fluid_impulse_stride; /* N s received over the last advance */
  double *memory;            int memory_stride; /* CPL_MEMORY_VECTORS * 3; selfDisturbance only */
} cpl_particles;
/* clang-format on */

/* Fluid quantities of this rank's cells, in and out. NULL where a scene does not need one. */
typedef struct cpl_cells {
  double *eps;               /* [cells] void fraction: out of cpl_void_fraction, in elsewhere */
  double *solid_velocity;    /* [cells][3] out: volume-weighted mean particle velocity, m/s */
  const double *superficial; /* [cells][3] in: U = eps u, m/s */
  const double *pressure_gradient; /* [cells][3] in: grad p without the hydrostatic part, Pa/m */
  const double *stress_divergence; /* [cells][3] in: div tau, Pa/m */
  const double *curl; /* [cells][3] in: curl u of the interstitial velocity, 1/s; lift, turning */
  const double *acceleration; /* [cells][3] in: Du/Dt of the interstitial velocity, m/s2; virtualMass */
  double *drag_coefficient; /* [cells] out: D, kg/(m3 s): drag on the fluid per mixture volume
                               is -(D U - G) with U superficial */
  double *drag_explicit;    /* [cells][3] out: G, N/m3 */
} cpl_cells;

typedef struct cpl_fluid {
  double density;    /* kg/m3 */
  double viscosity;  /* Pa s, dynamic, molecular */
  double gravity[3]; /* m/s2 */
} cpl_fluid;

/* ---- parameters ----------------------------------------------------------------------------- */
typedef enum {
  CPL_MODEL_A,
  CPL_MODEL_B,
  CPL_MODEL_BFULL /* set I of Zhou et al. 2010: another grouping of A's terms, run as A (C.8) */
} cpl_model;      /* Feng and Yu 2004; momentum scheme (2), (9) */

enum { CPL_OVERFULL_SPREAD, CPL_OVERFULL_ERROR };

typedef struct cpl_params {
  int model;              /* A | B | Bfull */
  int void_fraction;      /* row of coupling/void_fractions.def: exact | subCell | centre */
  int64_t sub_cells;      /* N of subCell, default 40: N^3 per cell */
  double minimum_eps;     /* least void fraction of a cell; default 0.05 */
  int overfull;           /* what happens below it: spread | error */
  int smoothing;          /* off | diffusion, of everything exchanged */
  double bandwidth;       /* b of its kernel exp(-r^2/b^2), in diameters of the largest sphere */
  double bandwidth_cells; /* b is at least so many cells (cube root of the volume) */
  int unresolved_drag;    /* 1: drag on the velocity of a cell beyond the mean over the weights of each sphere (C.11) */
  int self_disturbance;   /* 1: drag on the velocity without what own drag has added to it */
  int drag;               /* row of coupling/drag_laws.def */
  int pressure_gradient;  /* 1: force -V grad p (A, Bfull; in B it is part of the drag) */
  int viscous_stress;     /* 1: force V div tau */
  int saffman_lift;       /* 1: lift by shear, Saffman-Mei */
  int magnus_lift;        /* 1: lift by spin */
  int rotational_drag;    /* 1: torque of the fluid, cpl_turning */
  int virtual_mass;       /* 1: force m_a (Du/Dt - dv/dt), m_a = virtual_mass_coefficient rho_f V */
  double virtual_mass_coefficient;
  int two_way;            /* 0: the fluid does not feel the particles (eps = 1, no source) */
} cpl_params;
extern const part_param_table cpl_params_table;

/* Drag law by row: force on one sphere F = beta u_rel (N), u_rel = u - v interstitial (m/s).
 * beta (kg/s) from |u_rel|, diameter d, eps, rho_f, mu_f, and the Sauter mean diameter of the
 * spheres around (m; d where all have one size). */
typedef double (*cpl_drag_law)(double slip, double d, double eps, double rho, double mu,
                               double mean_d);
/* Where its source says that a law holds; Re = eps |u - v| d rho/mu. */
typedef struct cpl_drag_range {
  double re_low, re_high, eps_low, eps_high;
} cpl_drag_range;
int cpl_drag_count(void);
const char *cpl_drag_name(int law);
cpl_drag_law cpl_drag_function(int law);
int cpl_drag_needs_sizes(int law);                /* 1: the law takes the mean diameter around */
const cpl_drag_range *cpl_drag_range_of(int law); /* NULL: no such row */

/* ---- life ----------------------------------------------------------------------------------- */
typedef struct cpl_t cpl_t;
/* Collective. box: periodic directions of the domain (the mesh is cyclic there). */
int cpl_create(MPI_Comm comm, const cpl_mesh *mesh, const part_box *box, const cpl_params *params,
               const cpl_fluid *fluid, cpl_t **cpl);
void cpl_destroy(cpl_t *cpl);
part_timers *cpl_timers(cpl_t *cpl);
/* Collective, between steps; cpl_void_fraction must follow before the next cpl_reaction. Only drag,
 * minimumEps and overfull may differ from what they are: ERR_ARGUMENT names another entry that
 * does, and nothing has changed then. */
int cpl_change_params(cpl_t *cpl, const cpl_params *params);
int cpl_may_change(const char *entry); /* 1: cpl_change_params takes another value of it */
/* 1: the values of a row of cpl_params_table differ. */
int cpl_param_differs(const part_param *row, const cpl_params *a, const cpl_params *b);
/* Scene plan lines "what | why | saves". */
int cpl_plan_text(const cpl_t *cpl, size_t size, char *text);

/* ---- a step --------------------------------------------------------------------------------- */
/* Collective. Which ranks and cells each particle touches, and its weights there. Needed whenever
 * particles moved or changed order. ERR_OUTSIDE: a particle has no volume in any cell (the text
 * names id and position). */
int cpl_locate(cpl_t *cpl, const cpl_particles *particles);
/* eps and solid velocity of the cells from the weights. ERR_RANGE: eps below minimum_eps.
 * volume_error (may be NULL, collective): |sum_c (1 - eps_c) V_c - sum_i V_i| / sum_i V_i. */
int cpl_void_fraction(cpl_t *cpl, const cpl_particles *particles, cpl_cells *cells,
                      double *volume_error);
/* Collective. Sample eps, U, grad p, div tau at the particles (kept inside until the next call). */
int cpl_sample_fluid(cpl_t *cpl, const cpl_particles *particles, const cpl_cells *cells);
/* Local. F = Su - Sp v into the particle view: drag, pressure gradient with buoyancy, stress. A
 * particle with a drag_radius is a part of a body of that radius: it has the share of the body's
 * drag that it has of its volume, (radius/drag_radius)^3. */
int cpl_fluid_force(cpl_t *cpl, cpl_particles *particles);
/* rotationalDrag: [count][4] of the last cpl_fluid_force, curl u/2 at the particle (1/s) and k (N m
 * s): the fluid turns it with the torque k (curl u/2 - omega). NULL: off. The couple on the fluid,
 * which has no momentum, is not given back. */
const double *cpl_turning(const cpl_t *cpl);
/* Of the last cpl_void_fraction, all ranks: cells that solids would have left less than minimumEps,
 * and the volume (m3) that was moved from them to their neighbours (overfull spread). */
void cpl_overfull_of(const cpl_t *cpl, long long *cells, double *volume);
/* Own particles of the last cpl_fluid_force where the drag law was outside its range. */
int64_t cpl_outside_range(const cpl_t *cpl);
/* Collective. D and G of the cells for a flow step dt, from the impulses that the particles really
 * received over their own steps, implicit in the new fluid velocity: a particle that would follow
 * the fluid within dt takes at most its momentum m du (factor (1 - exp(-Sp dt/m)) m/dt). Members of a
 * rigid block count as fixed: what the block answers is for the caller to find, who knows its mass
 * (cpl_foresee_kick). */
int cpl_momentum_source(cpl_t *cpl, const cpl_particles *particles, cpl_cells *cells, double dt);
/* Collective. After the flow step: drag_reaction[cells][3] and volume_reaction[cells][3] (N s) are
 * what the fluid really gave up in each cell as drag, and through pressure and stress. The first is
 * shared among the particles in proportion to their part of D, the second to their volume; kick[
 * count][3] (N s) gets what each is still owed beyond fluid_impulse. Sum over particles of
 * fluid_impulse + kick = sum over cells of reactions + buoyancy, to round-off. A cell without
 * particles must have no reaction (ERR_ARGUMENT). */
int cpl_reaction(cpl_t *cpl, const cpl_particles *particles, const double *drag_reaction,
                 const double *volume_reaction, double dt, double *kick);

/* Collective. The kick that cpl_reaction would give if the step ended here, after the first part (0 to 1] of dt,
 * with the reactions so far. Changes nothing: for those who iterate the flow step with the particles' answer. */
int cpl_foresee_kick(cpl_t *cpl, const cpl_particles *particles, const double *drag_reaction,
                     const double *volume_reaction, double dt, double part, double *kick);

typedef struct cpl_budget {
  double fluid[3];     /* N s given up by the fluid in the last step (reactions + buoyancy) */
  double particles[3]; /* N s received by the particles (impulses + kicks) */
  double error;        /* |fluid - particles| / largest sum of magnitudes */
} cpl_budget;
int cpl_get_budget(const cpl_t *cpl, cpl_budget *budget); /* after cpl_reaction */

/* ---- primitives, also for other forces and for tests ---------------------------------------- */
/* Collective. value[count][n] per particle -> added to cell[cells][n]. */
int cpl_deposit(cpl_t *cpl, int n, const double *value, double *cell);
/* Collective. cell[cells][n] -> value[count][n]. */
int cpl_sample(cpl_t *cpl, int n, const double *cell, double *value);
/* Velocity that its own drag has given to the fluid at each particle, [count][3], m/s: what the
 * last cpl_fluid_force took away. NULL: selfDisturbance off. */
const double *cpl_own_disturbance(const cpl_t *cpl);
/* Sampled values of the last cpl_sample_fluid, [count], [count][3]. */
const double *cpl_sampled_eps(const cpl_t *cpl);
const double *cpl_sampled_superficial(const cpl_t *cpl);

#ifdef __cplusplus
}
#endif
#endif
