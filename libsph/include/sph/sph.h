/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libsph: smoothed particle hydrodynamics. An sph_t holds the particles of a weakly compressible
 * fluid and its walls, and advances them under gravity and a force that whoever couples puts in. The
 * equations are those of a fluid averaged over the solids in it (Robinson et al. 2014; Markauskas et
 * al. 2017): doc/equations.md, S.1 to S.28.
 *
 * SI units. Status returns as in particle/status.h. Calls marked collective are made by all ranks
 * of the communicator together; the others are local. */
#ifndef SPH_SPH_H
#define SPH_SPH_H

#include <mpi.h>
#include <stdint.h>
#include "particle/domain.h"
#include "particle/params.h"
#include "particle/status.h"
#include "particle/store.h"
#include "particle/timers.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- particle quantities: rows in sph/particle_fields.def ------------------------------------ */
enum sph_record {
#define SPH_RECORD(name, type, width) SPH_RECORD_##name,
#define SPH_FIELD(name, key, record, offset, comps, flags, unit, meaning)
#include "sph/particle_fields.def"
#undef SPH_RECORD
#undef SPH_FIELD
  SPH_RECORD_COUNT
};
enum sph_field {
#define SPH_RECORD(name, type, width)
#define SPH_FIELD(name, key, record, offset, comps, flags, unit, meaning) SPH_FIELD_##name,
#include "sph/particle_fields.def"
#undef SPH_RECORD
#undef SPH_FIELD
  SPH_FIELD_COUNT
};
extern const part_layout sph_layout;

/* ---- kernels: rows in sph/kernels.def ---------------------------------------------------------- */
enum sph_kernel_number {
#define SPH_KERNEL(name, key, support, meaning) SPH_KERNEL_##name,
#include "sph/kernels.def"
#undef SPH_KERNEL
  SPH_KERNEL_COUNT
};
/* For a kernel number, dimensions 2 or 3 and h (m). W in 1/m^dim; slope is (1/r) dW/dr in
 * 1/m^(dim+2), so that grad W = slope r_ab. support: radius over h. */
double sph_kernel_support(int kernel);
double sph_kernel_value(int kernel, int dimensions, double h, double r);
double sph_kernel_slope(int kernel, int dimensions, double h, double r);
/* Integral of W over the side of a plane that the particle is on, at a distance psi h (negative:
 * behind it): Gamma of Markauskas et al. 2017, eq. 17, for any kernel, in two and three dimensions. */
double sph_kernel_gamma(int kernel, int dimensions, double psi);

/* ---- parameters: rows in sph/<name>_params.def ------------------------------------------------- */
typedef enum { SPH_CONTINUITY, SPH_SUMMATION } sph_density_scheme;
typedef enum { SPH_MORRIS, SPH_MONAGHAN } sph_viscosity_model;
typedef enum { SPH_SYMPLECTIC, SPH_PREDICTOR_CORRECTOR } sph_time_scheme;
typedef struct sph_params {
  double spacing, smoothing_length; /* m */
  int variable_smoothing;           /* S.26 */
  double largest_smoothing;         /* over smoothing_length */
  int kernel;                       /* row of sph/kernels.def */
  int64_t dimensions;               /* 3, or 2 in a plane of constant z */
  double depth;                     /* m, along z, with two dimensions */
  double density, viscosity;        /* kg/m3, Pa s */
  double sound_speed, gamma;        /* m/s, 1 */
  double background_pressure;       /* Pa */
  double gravity[3];                /* m/s2 */
  int density_scheme;
  double density_diffusion;
  int viscosity_model;
  double artificial_viscosity, xsph;
  double shifting, artificial_pressure, anti_clump; /* S.19, S.20, S.21 */
  int gradient_correction; /* S.22 */
  int consistent_porosity; /* S.27 */
  int time_scheme;
  double courant, viscous_fraction, force_fraction;
  double skin_fraction; /* of the radius of the support */
  double balance_ratio;
  int64_t first_id;
  int skip; /* 1: leave out what the scene does not need (scene plan) */
} sph_params;
extern const part_param_table sph_params_table;

typedef struct sph_insert {
  double origin[3], extent[3]; /* m */
  double velocity[3];          /* m/s */
  int hydrostatic;
  double surface[3]; /* m */
} sph_insert;
extern const part_param_table sph_insert_table;

/* A wall and its motion, which is that of particle/motion.h: a function of time alone. */
typedef enum { SPH_PLANE, SPH_TRIANGLES } sph_wall_type;
typedef enum { SPH_NO_SLIP, SPH_FREE_SLIP } sph_wall_slip;
enum sph_wall_model { /* rows of sph/wall_models.def */
#define SPH_WALL_POINTS(name, key, meaning) SPH_WALL_##name,
#define SPH_WALL_PUSH(name, key, meaning) SPH_WALL_##name,
#include "sph/wall_models.def"
#undef SPH_WALL_POINTS
#undef SPH_WALL_PUSH
  SPH_WALL_MODEL_COUNT
};
typedef struct sph_wall_params {
  int type, slip, model;
  double point[3], normal[3]; /* m, 1 */
  double velocity[3], centre[3];                          /* m/s, m */
  double rotation_axis[3], rotation_rate;                 /* 1, rad/s */
  double oscillation_amplitude, oscillation_frequency;    /* m, Hz */
  double oscillation_direction[3], start_time, stop_time; /* 1, s */
  int64_t layers;                /* of fixedPoints */
  double stiffness, restitution; /* N/m, 1: of springDashpot */
} sph_wall_params;
extern const part_param_table sph_wall_table;

/* ---- life --------------------------------------------------------------------------------------- */
typedef struct sph_t sph_t;

/* Collective. Copies params and box, duplicates comm. */
int sph_create(MPI_Comm comm, const part_box *box, const sph_params *params, sph_t **sph);
void sph_destroy(sph_t *sph);

/* A wall, known by its name; the same on every rank, before sph_start. Triangles [count][3][3] (m)
 * for type triangles, 0 and NULL otherwise; together they are a closed surface, or one whose rim is
 * farther than the kernel's support from all fluid. Walls do not go on through periodic borders by
 * themselves: a plane has no component of its normal along one, triangles are given as far as the
 * support beyond it. */
int sph_add_wall(sph_t *sph, const char *name, const sph_wall_params *params, int count,
                 const double *vertices);

/* Collective. Fill a box with particles; the same arguments on every rank. ids go on from the largest
 * so far, x fastest. ERR_OUTSIDE: the box leaves the domain. */
int sph_insert_box(sph_t *sph, const sph_insert *insert, int64_t *inserted);
/* Collective. Own points of this rank, anywhere: position[count][3] (m), velocity[count][3] (m/s,
 * NULL: 0), volume[count] (m3, NULL: spacing^dim), pressure[count] (Pa, NULL: background). ids go on
 * by rank and order. ERR_OUTSIDE, ERR_NUMERIC, ERR_RANGE: the text names the point. */
int sph_insert_points(sph_t *sph, int count, const double *position, const double *velocity,
                      const double *volume, const double *pressure, int64_t *inserted);

/* Collective. Once after all of the above: distributes, sorts, lists, first forces. */
int sph_start(sph_t *sph);

/* Collective, after sph_start and before the first sph_advance. Solids put into the fluid that is
 * there: eps[own] (0 < eps <= 1) of own particles, with mass and superficial density in proportion, so
 * that pressures stay. In a run under way eps changes by the field EPS alone. */
int sph_displace(sph_t *sph, const double *eps);

/* ---- running ------------------------------------------------------------------------------------ */
/* Collective. Advance by dt (s) in steps no longer than the limits allow (S.15), worked out again for
 * each. The order of own particles may change: ask sph_store and its records again. *steps may be
 * NULL. ERR_NUMERIC, ERR_OUTSIDE: the text names id, place and time of a particle that is not finite,
 * is faster than sound, has lost or doubled its density, or is behind a wall. */
int sph_advance(sph_t *sph, double dt, int *steps);

/* From now on EPS is that of the places to which the fluid takes particles by the end of the next advance, which is one
 * step (P.9): on ways besides (S.11, S.19) it changes by EPS_GRADIENT, on the fluid's own it does not, and EPS_RATE is
 * not used. 0, as to begin with: EPS is that of where they are. */
void sph_set_eps_ahead(sph_t *sph, int ahead);

/* The particles. Whoever couples sets the fields EPS (0 < eps <= 1) and FORCE (N) of own particles
 * before sph_advance; FORCE is constant over it. With EPS_RATE and EPS_GRADIENT eps follows the
 * particles through the steps of an advance (S.18), which it should where eps varies. */
part_store *sph_store(sph_t *sph);
/* Counts calls that changed the order of own particles, for caches outside. */
long long sph_generation(const sph_t *sph);
double sph_time(const sph_t *sph);
void sph_set_time(sph_t *sph, double time);
/* Collective. The longest step that the limits allow now (s). */
int sph_stable_step(sph_t *sph, double *step);

/* What libcoupling needs of the particles, as pointers and strides in doubles; valid until the next
 * collective call. own: particles that this rank moves; all: with ghosts, whose position, volume,
 * velocity and pressure are up to date. */
typedef struct sph_view {
  int own, all;
  const double *position, *velocity, *volume, *pressure; /* [all], stride xv_stride */
  int xv_stride;
  double *eps;           /* [own], stride mass_stride; may be written */
  const double *mass;    /* [own], stride mass_stride */
  const double *density; /* [own], stride mass_stride: superficial */
  int mass_stride;
  const double *acceleration; /* [own][3], stride rate_stride: grad and viscous terms (S.7 to S.10)
                                 with walls, m/s2; times rho_bar it is theta of Robinson et al. 2014,
                                 eq. 25 */
  int rate_stride;
  double *force;        /* [own][3], stride force_stride; may be written */
  double *eps_rate;     /* [own], stride force_stride, 1/s: at a fixed place; may be written */
  double *eps_gradient; /* [own][3], stride force_stride, 1/m; may be written */
  int force_stride;
  int kernel, dimensions;
  const double *lens; /* [own][2] 1/h (1/m) and 1/Omega (S.26) of the last sums, NULL with one h for all */
  double h, depth; /* m; W per volume is that of sph_kernel_value over depth with two dimensions */
} sph_view;
int sph_get_view(sph_t *sph, sph_view *view);
/* Distance (m) of a point from the nearest wall, negative behind it; infinite without walls. */
double sph_wall_distance(const sph_t *sph, const double x[3]);
/* Gamma (S.17) at a point, by the nearest wall. */
double sph_wall_gamma(const sph_t *sph, const double x[3]);

typedef struct sph_report {
  int64_t particles;
  double max_speed, kinetic_energy; /* m/s, J */
  double least_density, most_density; /* kg/m3, of the fluid: rho_bar/eps */
  double volume; /* m3 */
  double momentum[3]; /* kg m/s */
  /* impulses since the start (N s); momentum - initial momentum is their sum, to round-off */
  double gravity_impulse[3], wall_impulse[3], force_impulse[3];
  double budget_error; /* |difference| over the largest of them and of sum m|v| */
  long long steps, rebuilds, listed; /* listed: directed pairs in the lists of all ranks */
} sph_report;
/* Collective. */
int sph_get_report(sph_t *sph, sph_report *report);

int sph_wall_count(const sph_t *sph); /* numbers 0, 1, ... in the order they were added */
const char *sph_wall_name(const sph_t *sph, int wall); /* NULL: no such wall */
/* Collective. Force of the fluid on a wall now (N) and its impulse since the start (N s). */
int sph_get_wall_force(sph_t *sph, int wall, double force[3], double impulse[3]);
typedef struct sph_wall_report {
  double force[3], impulse[3]; /* of the fluid on it: N; N s since the start */
  double torque[3];            /* N m, about its centre now */
  double power, work;          /* of the wall on the fluid by its motion: W; J since the start */
  double centre[3], velocity[3], angle; /* m, m/s, rad: of its motion now */
} sph_wall_report;
/* Collective. */
int sph_get_wall_report(sph_t *sph, int wall, sph_wall_report *report);

/* The scene plan as text lines "what | why | saves". Local. */
int sph_plan_text(const sph_t *sph, size_t size, char *text);
part_timers *sph_timers(sph_t *sph);
/* Collective. Widest vector of the pair loops from now on: 8, 4, 1 (plain), 0: any; for tests and
 * benchmarks. */
int sph_limit_width(sph_t *sph, int width);
int sph_width(const sph_t *sph); /* in use */

/* ---- files -------------------------------------------------------------------------------------- */
/* Collective. Write the particles (VTKHDF, with everything restart needs). The state in memory is
 * brought into the canonical form a restart would find, so that going on and restarting are the same
 * computation bit for bit. series: see part_file_commit. */
int sph_write(sph_t *sph, const char *path, const char *series);
/* Collective. In place of insertion, before sph_start; the walls are given again. */
int sph_read(sph_t *sph, const char *path);

#ifdef __cplusplus
}
#endif
#endif
