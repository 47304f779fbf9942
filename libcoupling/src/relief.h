/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where solids would leave less than minimumEps of a cell, what is too much moves to its neighbours:
 *
 *   q_c <- q_c + (1/V_c) sum_f K_f max(s_c, s_N) (q_N - q_c),    pass after pass,
 *
 * with 0 <= s <= 1 growing as the cell fills up, until all cells have room. K_f is the largest for
 * which no cell gives away more than it has. Each pass is symmetric in the inner product of the
 * volumes, positive, and keeps sums; the passes found for the volume of the solids are then made for
 * everything that is deposited, and in the reverse order for what is sampled, so that forces go
 * where the volume went. Nothing is clipped. */
#ifndef COUPLING_RELIEF_H
#define COUPLING_RELIEF_H

#include "coupling/coupling.h"

typedef struct cpl_relief cpl_relief;

int cpl_relief_create(MPI_Comm comm, const cpl_mesh *mesh, cpl_relief **relief); /* collective */
void cpl_relief_destroy(cpl_relief *relief);
/* Forget the passes. */
void cpl_relief_reset(cpl_relief *relief);
/* Collective. fill[cells]: solid fraction, changed by the passes that make it <= most everywhere.
 * ERR_RANGE: not even CPL_RELIEF_PASSES do. */
enum { CPL_RELIEF_PASSES = 200 };
int cpl_relief_find(cpl_relief *relief, double most, double *fill);
int cpl_relief_passes(const cpl_relief *relief);
/* Collective. The passes on density[cells][n], n <= 16; backwards for sampling. */
int cpl_relief_apply(cpl_relief *relief, int n, int backwards, double *density);

/* Of the last cpl_relief_find, all ranks: cells that were too full, and the volume that left them. */
void cpl_relief_report(const cpl_relief *relief, long long *cells, double *volume);

#endif
