/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rendezvous: the only code that knows that particles and cells may be on different ranks.
 *
 * Every rank marks the bins of a coarse grid over the whole mesh that its cells touch, once. A
 * particle then makes one visit to each (rank, periodic image) whose bins its sphere may touch. A
 * visit carries the sphere, shifted to the image, to the rank of the cells; values go the same way,
 * and sums come back to the owner, who adds them in the order of its visits.
 *
 * Visits to the own rank are neither sent nor copied: they index the caller's arrays. They come
 * first, in the order of particles; after them those of other ranks, by source rank and there in
 * the sender's order, so nothing depends on message timing. */
#ifndef COUPLING_RENDEZVOUS_H
#define COUPLING_RENDEZVOUS_H

#include "coupling/coupling.h"
#include "search.h"

typedef struct cpl_rendezvous cpl_rendezvous;

/* Collective. cells: of this rank; reach (>= 1): how far spheres are felt, over their radius. comm
 * is used, not duplicated. ERR_ARGUMENT: no rank has cells; ERR_RANGE: a periodic direction without
 * length. */
int cpl_rendezvous_create(MPI_Comm comm, int cells, const cpl_search *search, const part_box *box,
                          double reach, cpl_rendezvous **rendezvous);
void cpl_rendezvous_destroy(cpl_rendezvous *rendezvous);

/* Local. The visits of own particles. ERR_NUMERIC: a position or radius that is not finite;
 * ERR_RANGE: a radius that is not positive, or a sphere that meets its own periodic image. */
int cpl_rendezvous_visits(cpl_rendezvous *rendezvous, const cpl_particles *particles);
/* Collective. Send those to other ranks. */
int cpl_rendezvous_send(cpl_rendezvous *rendezvous);

int cpl_rendezvous_sent(const cpl_rendezvous *rendezvous); /* own ones included, as in received */
int cpl_rendezvous_own(const cpl_rendezvous *rendezvous);  /* of these, to the own rank */
const int *cpl_rendezvous_particle(const cpl_rendezvous *rendezvous); /* of each sent visit */
int cpl_rendezvous_received(const cpl_rendezvous *rendezvous);
const double *cpl_rendezvous_spheres(const cpl_rendezvous *rendezvous); /* [received][4]: x, r */

/* Values of received visits, n each: that of visit first + k is at[(index ? index[k] : k) * n]. */
typedef struct cpl_visit_range {
  int first, count;
  double *at;
  const int *index;
} cpl_visit_range;

/* Collective. value[particles][n] of own particles as seen by all received visits, in two ranges
 * (only read them). Valid until the next call. */
int cpl_rendezvous_forward(cpl_rendezvous *rendezvous, int n, const double *value,
                           cpl_visit_range range[2]);
/* The way back, in two calls. begin: where received visits add their n values, all zero now; end,
 * collective: value[particles][n] = sums over the visits of each particle. */
int cpl_rendezvous_begin(cpl_rendezvous *rendezvous, int n, int particles, double *value,
                         cpl_visit_range range[2]);
int cpl_rendezvous_end(cpl_rendezvous *rendezvous, int n, double *value);

/* Collective. n doubles per visit rather than per particle. */
int cpl_rendezvous_reverse_visits(cpl_rendezvous *rendezvous, int n, const double *received,
                                  double *sent);
int cpl_rendezvous_forward_visits(cpl_rendezvous *rendezvous, int n, const double *sent,
                                  double *received);
/* Collective. Forget the visits to other ranks with keep[sent] == 0 and, the same at the other end,
 * keep_received == 0, if so many go that a new plan pays. *dropped: whether it was done. */
int cpl_rendezvous_drop(cpl_rendezvous *rendezvous, const double *keep, const double *keep_received,
                        int *dropped);

#endif
