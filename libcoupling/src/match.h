/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The same particles in two orders. dem_advance may sort particles and move them to other ranks;
 * what was computed for them before has then to find them by id.
 *
 * On one rank a hash finds the partner. Only particles that changed rank go through a directory:
 * both sides send the id to rank (id mod ranks), which joins them; their data takes the same way.
 */
#ifndef COUPLING_MATCH_H
#define COUPLING_MATCH_H

#include <mpi.h>
#include <stdint.h>

typedef struct cpl_match cpl_match;

/* Collective. The sets of ids over all ranks must be equal: ERR_STATE names one that is in only one
 * of them, ERR_ARGUMENT one that is there twice. what: for the message, "since cpl_locate". */
int cpl_match_create(MPI_Comm comm, int n_from, const int64_t *from, int n_to, const int64_t *to,
                     const char *what, cpl_match **match);
void cpl_match_destroy(cpl_match *match);

/* Collective. n doubles per particle, from[n_from][n] -> to[n_to][n]. */
int cpl_match_move(cpl_match *match, int n, const double *from, double *to);

#endif
