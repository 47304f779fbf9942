/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Weights w_ic = (volume of sphere i in cell c) / (its volume in all cells), kept where the cells
 * are: one row per visit (rendezvous.h). A sphere partly in a wall gives all of its volume to the
 * cells it touches: sum_c w_ic = 1 always. */
#ifndef COUPLING_WEIGHTS_H
#define COUPLING_WEIGHTS_H

#include "coupling/coupling.h"
#include "overlap.h"

typedef struct cpl_weights cpl_weights;

/* Collective. comm, mesh and search are used, not copied. */
int cpl_weights_create(MPI_Comm comm, const cpl_mesh *mesh, cpl_search *search, const part_box *box,
                       const cpl_params *params, cpl_weights **weights);
void cpl_weights_destroy(cpl_weights *weights);

/* Collective. ERR_OUTSIDE: a particle without volume in any cell; and those of
 * cpl_rendezvous_visits. After an error there are no weights. */
int cpl_weights_locate(cpl_weights *weights, const cpl_particles *particles);

/* Collective. Q_c += sum_i w_ic Q_i; value[count][n], cell[cells][n]. */
int cpl_weights_deposit(cpl_weights *weights, int n, const double *value, double *cell);
/* Collective. q_i = sum_c w_ic q_c; cell[cells][n], value[count][n]. */
int cpl_weights_sample(cpl_weights *weights, int n, const double *cell, double *value);
/* Collective. moment[count][CPL_MOMENTS] of the weights of each particle, with y the way from its
 * centre to that of the kernel of the cell: sum_c w_ic y (m), sum_c w_ic |y|^2 (m2), and the two
 * variances of the shape[cells][CPL_SHAPE] (smoothing.h), sum_c w_ic v_c (m2). */
enum { CPL_MOMENTS = 6 };
int cpl_weights_moments(cpl_weights *weights, const double *shape, double *moment);

#endif
