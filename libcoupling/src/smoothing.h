/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Smoothing of cell fields by conservative diffusion on the mesh (Sun and Xiao 2015): with the
 * conductance G_f = (S.d)/|d|^2 of the faces and the variance sigma^2 of the kernel,
 *
 *   q <- q + (sigma^2/(2 m V_c)) sum_f G_f (q_N - q),   m times.
 *
 * G_f makes the second moment of the kernel grow by exactly sigma^2 per axis in the mean over the
 * cells of any mesh, also where two-point differences are not consistent, since sum_f S.(x_f - x_P)
 * = 3 V. m is the least for which no cell gives away more than GIVEN of its content, so the
 * operator S is a product of symmetric stochastic matrices (in the inner product of the volumes):
 *
 *   S 1 = 1,  sum_c V_c (S q)_c = sum_c V_c q_c,  (a, S b) = (S a, b),  q >= 0 => S q >= 0,
 *
 * all to round-off, which an iterative solution of the implicit equation has only to its
 * tolerance: the momentum budget needs them. */
#ifndef COUPLING_SMOOTHING_H
#define COUPLING_SMOOTHING_H

#include "coupling/coupling.h"

typedef struct cpl_smoother cpl_smoother;

/* Collective. mesh is used, not copied. variance: that of the kernel per axis (m2, >= 0) where it
 * is larger than (cells h)^2 with h = cube root of the cell's volume, else the latter; a face takes
 * the mean of its two cells. */
int cpl_smoother_create(MPI_Comm comm, const cpl_mesh *mesh, double variance, double cells,
                        cpl_smoother **smoother);
void cpl_smoother_destroy(cpl_smoother *smoother);
/* m, the same on all ranks. */
int cpl_smoother_passes(const cpl_smoother *smoother);
/* Collective. shape[cells][CPL_SHAPE] of the kernel of each cell, found at the first call: way from
 * the cell's centre to that of the kernel (m), the variance per axis asked for (m2), and that of
 * the Gaussian as dense as the kernel is, the cube root of the determinant of the moments that it
 * has (m2). The two differ where the ways to the neighbours of a cell do not cancel. */
enum { CPL_SHAPE = 5 };
int cpl_smoother_shape(cpl_smoother *smoother, const double **shape);
/* Collective. density[cells][n] <- S density. */
int cpl_smoother_apply(cpl_smoother *smoother, int n, double *density);

#endif
