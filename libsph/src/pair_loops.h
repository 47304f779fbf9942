/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The two loops over neighbours, S.4 to S.11: rates of the density where velocities are, then
 * forces. Lists are full (each end sums its own row), so that nothing is scattered and 8 partners
 * are taken at once; one record of 64 bytes holds all that is read of a partner. pair_kernel.h is
 * the code, compiled for 1, 4 and 8 lanes. */
#ifndef SPH_PAIR_LOOPS_H
#define SPH_PAIR_LOOPS_H

#include "sph/sph.h"

enum { SPH_BALANCE = 4, SPH_XV = 8, SPH_SUMS = 8, SPH_SHIFTS = 8, SPH_BLOCK = 8 };

/* What a loop works on. Loops do not know sph_t. */
typedef struct sph_lanes {
  const double *xv;   /* [all][8] x V v p */
  const double *mass; /* [own][4]: eps is [2]; of ghosts, too, when porous */
  const int *start;   /* [rows+1], multiples of 8 */
  const int *partner; /* padded with the particle itself, which adds nothing */
  int dimensions;
  double h, norm;               /* m, 1/m3: W = norm shape(r/h) */
  double density;               /* kg/m3 */
  double hydrostatic[3];        /* Pa/m, rho_0 g along directions that are not periodic (S.5) */
  const double *balance;        /* [all][4] Pa/m in its place, where forces differ; NULL: they do not */
  int diffuse, smooth, count;   /* the density loop also sums S.5, S.11, S.6 */
  int porous;                   /* eps is not 1 everywhere */
  int seen;                     /* the density loop sums S.27 */
  int correct;                  /* the density loop sums S.22, the force loop uses the next */
  const double *factor;         /* [all] of S.22 */
  double viscosity;             /* Pa s, of Morris, 0: none */
  double monaghan;              /* kg/(m2 s), rho_0 times alpha of S.9, 0: none */
  double sound_speed;           /* m/s */
  double artificial;            /* kg/(m s), rho_0 alpha c h of S.10, 0: none */
  double repulsion, anti_clump; /* factors of S.20 and S.21, 0: none */
  double per_shape;             /* 1/shape(dx/h) */
  const double *lens;           /* [all][2] 1/h, 1/Omega of S.26, where lengths differ */
  double unit_norm;             /* norm h^d */
} sph_lanes;

/* Sums of rows from .. to-1 into sum[row][SPH_SUMS]. density: [0] sum V u.grad W, [1] sum V (p_j -
 * p_i
 * - balance) slope, [2..4] sum V (v_j - v_i) W, [5] sum W without the own, [6] -sum V
 * x_ij.grad W, [7] sum V (1/eps_j - 1/eps_i) W. force: [0..2] force
 * over own volume. shift, into [row][SPH_SHIFTS]: [0..2] sum V grad W, [3..5] sum V (p_j - p_i)
 * grad W, [6] -sum V x_ij.grad W. Where a sum is not asked for it is not written.
 * variable_density: [0], [1] times the pair's h, [2..4], [6] as density, [5] as its [7], [7] sum V W without the own; number: [5] as
 * density, [6] -sum x_ij.grad W; variable_force: as force.
 */
typedef void (*sph_pair_loop)(const sph_lanes *lanes, int from, int to, double *sum);
typedef struct sph_loops {
  int width;
  sph_pair_loop density[SPH_KERNEL_COUNT], force[SPH_KERNEL_COUNT], shift[SPH_KERNEL_COUNT];
  sph_pair_loop variable_density[SPH_KERNEL_COUNT], number[SPH_KERNEL_COUNT],
      variable_force[SPH_KERNEL_COUNT];
} sph_loops;

const sph_loops *sph_loops_plain(void);
/* NULL when the compiler or the processor cannot. */
const sph_loops *sph_loops_avx2(void);
const sph_loops *sph_loops_avx512(void);

#endif
