/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The vector path of the contact loop, for scenes of free particles (dem_fast_wanted); any other
 * scene, processor or compiler takes the plain loop of contact.c, which gives the same to
 * round-off.
 *
 * - The list is flat, in chunks of rows, and padded to whole blocks of 8 pairs; springs are kept
 *   beside it, component by component, in its order. It holds the pairs that may touch soon
 *   (fast_list.c).
 * - A block loads whole records of 8 (or 4) pairs and transposes them. Forces go back by adding
 *   whole records, so that pairs of one block may share a particle.
 * - During an advance (dem->fast.spins) the records hold u = r omega and torque/r instead: the
 *   surface velocity is then u_i + u_j times one factor, and both ends get the same torque/r.
 * - Integration follows the contact loop in chunks: a row is complete once its own pairs are done,
 *   because j > i and ghosts are copies. */
#ifndef DEM_FAST_H
#define DEM_FAST_H

#include <stddef.h>

enum { DEM_BLOCK_PAIRS = 8, DEM_CHUNK_PAIRS = 256, DEM_FETCH_AHEAD = 64 };

struct dem_coefs;

/* What a kernel works on. Kernels do not know dem_t. */
typedef struct dem_lanes {
  const double *xr, *vm;
  double *ft;
  unsigned *i, *j;    /* [pairs, padded with i = j = 0] 8 times the numbers: fast_lanes.h */
  double *history[6]; /* [pairs, padded] m; springs of sliding, then of rolling */
  unsigned char *was; /* [blocks] sparse only: pairs whose history may not be zero */
  const struct dem_coefs *coefs;
  int materials;
  int equal;      /* one material and one radius: what follows from them is known beforehand */
  double reach;   /* m, sum of radii; equal only */
  double inverse; /* 1/kg, sum of inverse masses; equal only */
  int fetch_to;   /* below this pair, fetch the records of the pair DEM_FETCH_AHEAD farther on */
  double dt;
} dem_lanes;

/* Full step of particles: kick by dt, then drift by dt, and force to zero. */
typedef struct dem_motion {
  double *xr, *vm, *ft;
  const double *kick; /* [materials][4] m/s, gravity times dt */
  int materials, tangential;
  double spin; /* m r^2/I */
  double dt;
  double most[3]; /* m2/s2, largest squares of velocity components, gathered */
} dem_motion;

typedef void (*dem_pairs_kernel)(const dem_lanes *lanes, int from, int to);

typedef struct dem_kernels {
  int width;
  /* [law][parts (law.h)] Pairs from .. to-1, multiples of 8. dense: every block goes through the
   * law with lanes masked; sparse: at most a chunk; pairs that touch are packed first. */
  const dem_pairs_kernel (*dense)[8], (*sparse)[8];
  void (*move)(dem_motion *motion, int from, int to);
} dem_kernels;

/* NULL when the compiler or the processor cannot. */
const dem_kernels *dem_kernels_avx512(void);
const dem_kernels *dem_kernels_avx2(void);

typedef struct dem_fast {
  int limit;                  /* widest vector allowed, 0: any */
  const dem_kernels *kernels; /* NULL: plain loop */
  int law;
  int equal; /* see dem_lanes; the same on every rank */
  int spins; /* records hold r omega and torque/r */
  int sparse;
  int pairs; /* padded */
  unsigned *i, *j;
  int *slot;            /* [pairs] place in the neighbour list, -1: padding */
  int *complete;        /* [chunks] rows whose pairs are all in this chunk and those before */
  double inner;         /* m, every pair with a smaller gap was taken into the list */
  double way, last_way; /* m, bound of any particle's way since then; in the last step */
  double *history[6], *kick;
  unsigned char *was;
  size_t room;
} dem_fast;

struct dem_t;
/* Collective, after dem_make_plan: choose the kernels, the same on every rank. */
void dem_fast_choose(struct dem_t *dem);
/* Collective. Widest vector allowed from now on, 1: plain loop, 0: any; for tests and benchmarks.
 */
int dem_fast_limit(struct dem_t *dem, int width);

/* Inner list from the pairs just built, and springs back into the pairs before they are read. */
int dem_fast_list(struct dem_t *dem);
void dem_fast_return(const struct dem_t *dem);
/* A good width of the inner skin (m) when particles move by `way` (m) in a substep. */
double dem_fast_inner(const struct dem_t *dem, double way);
/* Before forces: make the list again when others may touch by now. */
void dem_fast_update(struct dem_t *dem);
/* Every particle has moved by at most `way` (m; infinite: not known). */
void dem_fast_moved(struct dem_t *dem, double way);
/* Records to r omega and torque/r, and back. */
void dem_fast_enter(struct dem_t *dem);
void dem_fast_leave(struct dem_t *dem);
/* Contact forces of pairs, added to what is in the force record. */
void dem_fast_forces(struct dem_t *dem, double dt);
/* The same, then the whole step of every particle from t to t + h; *way: bound of the largest
 * displacement (m). */
void dem_fast_step(struct dem_t *dem, double t, double h, double *way);
void dem_fast_free(dem_fast *fast);

#endif
