/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rendezvous: the only code that knows that particles and cells may be on different ranks.
 *
 * Every rank marks the bins of a coarse grid over the whole mesh that its cells touch, once. A
 * particle then makes one visit to each (rank, periodic image) whose bins its sphere may touch. A
 * visit carries the sphere, shifted to the image, to the rank of the cells; values go the same way,
 * and sums come back to the owner, who adds them in the order of its visits. Received visits are
 * ordered by source rank and there by the sender's order, so nothing depends on message timing.
 * With one rank nothing is sent or copied: a visit is an index into the caller's arrays. */
#ifndef COUPLING_RENDEZVOUS_H
#define COUPLING_RENDEZVOUS_H

#include "coupling/coupling.h"
#include "overlap.h"

typedef struct cpl_rendezvous cpl_rendezvous;

/* Collective. cells: of this rank. comm is used, not duplicated. ERR_ARGUMENT: no rank has cells;
 * ERR_RANGE: a periodic direction without length. */
int cpl_rendezvous_create(MPI_Comm comm, int cells, const cpl_search *search, const part_box *box,
                          cpl_rendezvous **rendezvous);
void cpl_rendezvous_destroy(cpl_rendezvous *rendezvous);

/* Local. The visits of own particles and, with one rank, the received visits too. ERR_NUMERIC: a
 * position or radius that is not finite; ERR_RANGE: a radius that is not positive, or a sphere that
 * meets its own periodic image. */
int cpl_rendezvous_visits(cpl_rendezvous *rendezvous, const cpl_particles *particles);
/* Collective. Send them. */
int cpl_rendezvous_send(cpl_rendezvous *rendezvous);

int cpl_rendezvous_sent(const cpl_rendezvous *rendezvous);
const int *cpl_rendezvous_particle(const cpl_rendezvous *rendezvous); /* of each sent visit */
int cpl_rendezvous_received(const cpl_rendezvous *rendezvous);
const double *cpl_rendezvous_spheres(const cpl_rendezvous *rendezvous); /* [received][4]: x, r */

/* Collective. value[count][n] of own particles as seen by the received visits: that of visit k is
 * at[(index ? index[k] : k)*n]. Valid until the next call. */
int cpl_rendezvous_forward(cpl_rendezvous *rendezvous, int n, const double *value,
                           const double **at, const int **index);
/* The way back, in two calls. begin: where the received visit k adds its n values (zeroed); end,
 * collective: value[count][n] = sums over the visits of each particle, in visit order. */
int cpl_rendezvous_begin(cpl_rendezvous *rendezvous, int n, int count, double *value, double **at,
                         const int **index);
int cpl_rendezvous_end(cpl_rendezvous *rendezvous, int n, double *value);

/* Collective. n doubles per visit rather than per particle. */
int cpl_rendezvous_reverse_visits(cpl_rendezvous *rendezvous, int n, const double *received,
                                  double *sent);
int cpl_rendezvous_forward_visits(cpl_rendezvous *rendezvous, int n, const double *sent,
                                  double *received);
/* Collective. Forget the visits with keep == 0 at the sender and, the same, keep_received == 0 at
 * the receiver, if so many go that a new plan pays. *dropped: whether it was done. */
int cpl_rendezvous_drop(cpl_rendezvous *rendezvous, const double *keep, const double *keep_received,
                        int *dropped);

/* Bytes this rank has sent to other ranks so far. */
long long cpl_rendezvous_bytes(const cpl_rendezvous *rendezvous);

#endif
