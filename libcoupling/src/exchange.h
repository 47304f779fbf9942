/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The two directions of the exchange with the kernel of the case: weights, then smoothing S.
 *
 *   deposit  Q_c = V_c (S (sum_i w_ic Q_i / V))_c        sample  q_i = sum_c w_ic (S q)_c
 *
 * and, where cells would be too full, the passes R of relief.h after (deposit) and before (sample) S.
 * S and each pass of R are symmetric in the inner product of the volumes, so the two stay adjoint: sum_c Q_c q_c =
 * sum_i Q_i q_i for any Q and q. All of libcoupling goes through these. */
#ifndef COUPLING_EXCHANGE_H
#define COUPLING_EXCHANGE_H

#include "coupling_type.h"

/* Collective. Q_c += deposit; value[count][n], cell[cells][n]. */
int cpl_spread(cpl_t *cpl, int n, const double *value, double *cell);
/* Collective. cell[cells][n], value[count][n]. */
int cpl_gather(cpl_t *cpl, int n, const double *cell, double *value);

/* Collective. solid[cells] as deposited without relief -> the passes that give all cells room, and
 * solid after them. */
int cpl_relieve(cpl_t *cpl, double *solid);

/* Collective. The smoother for the particles as located: its bandwidth follows the largest sphere.
 */
int cpl_update_smoothing(cpl_t *cpl);

#endif
