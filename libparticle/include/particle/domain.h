/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The box that particles live in, its periodic directions, its decomposition over ranks (recursive
 * coordinate bisection by Zoltan), the migration of particles to their owners and the ghost copies
 * near a rank's border or across a periodic one. */
#ifndef PARTICLE_DOMAIN_H
#define PARTICLE_DOMAIN_H

#include <mpi.h>
#include "particle/levels.h"
#include "particle/store.h"

#ifdef __cplusplus
extern "C" {
#endif

/* lo, hi in m. A direction that is not periodic only bounds the grid of linked cells: particles
 * may be outside unless bounded[] asks for an error when one leaves. */
typedef struct part_box {
  double lo[3], hi[3];
  int periodic[3];
  int bounded[3];
} part_box;

/* Local. Whether the entries dimensions (2 or 3), depth (m) and gravity (m/s2) of the dictionary
 * `table` fit together and the box: ERR_RANGE names the entry. */
int part_box_check_dimensions(const part_box *box, const char *table, int64_t dimensions,
                              double depth, const double gravity[3]);
/* Bring x into a periodic box; image[3] (may be NULL) gets the shift in box lengths taken off. */
void part_box_wrap(const part_box *box, double x[3], int image[3]);
/* Shortest difference a - b over periodic images. */
void part_box_difference(const part_box *box, const double a[3], const double b[3], double d[3]);

typedef struct part_domain part_domain;

/* Collective. Duplicates comm. One part per rank; before the first balance all belongs to rank 0
 * unless there is one rank. ERR_RANGE: hi <= lo. */
int part_domain_create(MPI_Comm comm, const part_box *box, part_domain **domain);
void part_domain_destroy(part_domain *domain);
MPI_Comm part_domain_comm(const part_domain *domain);
const part_box *part_domain_box(const part_domain *domain);

/* Collective. New parts of equal weight (weight[i] per own particle, NULL: equal) from the own
 * particles of every rank. Does not move anything. */
int part_domain_balance(part_domain *domain, const part_store *store, const double *weight);
/* The same with a home per own particle ([local][3], m) in place of its position; see
 * part_domain_migrate_home. */
int part_domain_balance_home(part_domain *domain, const part_store *store, const double *home,
                             const double *weight);
/* Largest number of own particles of a rank over the mean; collective. */
int part_domain_imbalance(const part_domain *domain, const part_store *store, double *ratio);

/* Collective. Wrap positions into periodic directions and send every own particle to its owner,
 * with a variable payload per particle (payload_count[i] elements of payload_size bytes; NULL when
 * there is none) such as contact history. Drops ghosts. Those that stay keep their order and come
 * first, then those that arrive by source rank and the order they had there. ERR_OUTSIDE: a
 * particle is not finite or outside a bounded direction: the text names id, position. On return
 * *payload_count and *payload (caller frees; allocated with malloc or calloc) belong to the new own
 * particles. After a failure store and payload are as they were, but for wrapped positions. */
int part_domain_migrate(part_domain *domain, part_store *store, size_t payload_size,
                        int **payload_count, void **payload);

/* Collective. The same for particles that belong together, such as the spheres of one body: who owns
 * a particle follows from its home ([local][3], m; NULL: its position), and its position is shifted
 * over periodic borders as its home is, so it may stay outside the box. Particles with the same home
 * (bit for bit) stay on one rank. Homes are wrapped in place, in the old order. */
int part_domain_migrate_home(part_domain *domain, part_store *store, double *home,
                             size_t payload_size, int **payload_count, void **payload);

/* Collective. Ghost copies of all particles within `reach` (m) of the box around the own particles,
 * across periodic borders too (positions shifted), as an exchange that update repeats. So every
 * pair closer than reach is complete, also for particles that have moved out of their part since
 * they migrated. Copies come by source rank, then in the order of the originals there. They hold
 * the records with PART_GHOST, record 0 and the id; others are zero. A box that is not at least 2
 * reach long in a periodic direction is ERR_RANGE (a pair would meet twice); a particle more than a
 * quarter of its length outside is ERR_OUTSIDE. */
int part_domain_ghosts(part_domain *domain, part_store *store, double reach);
/* Collective. The same for spheres: every pair nearer than r_i + r_j + skin is complete on the rank
 * of each of the two, and little else is copied: of a level of radii a layer as thick as spheres of
 * that level are, and of the smaller ones those that are that near to a large sphere of the other
 * rank. The periodic box must be two longest reaches (2 r_max + skin) long. The same levels on
 * every rank. */
int part_domain_sphere_ghosts(part_domain *domain, part_store *store, int radius_field,
                              const part_levels *levels, double skin);
/* Collective. Refresh record 0 and the PART_GHOST records of the copies from their originals, shift
 * kept. ERR_STATE: own particles or ghosts are not those of the last part_domain_ghosts (on every
 * rank, or the others wait). */
int part_domain_update_ghosts(part_domain *domain, part_store *store);
/* Collective. The same in two calls: between them the copies are not valid, and other work and
 * messages may go on, but store and exchange must stay as they are. receive follows every send. */
int part_domain_send_ghosts(part_domain *domain, part_store *store);
int part_domain_receive_ghosts(part_domain *domain);

/* Collective. Drops the ghosts g with needed[g] == 0, [ghost]; nothing is sent for them any more, on
 * the ranks of the originals neither. The others keep their order: ghost g becomes place[g],
 * [ghost + 1], the number of those kept before it. ERR_STATE as update. */
int part_domain_trim_ghosts(part_domain *domain, part_store *store, const unsigned char *needed,
                            int *place);

/* Collective. Data of own particles ([local] of `size` bytes, a multiple of 8) to the ghosts'
 * ([ghost]), along the exchange of the last part_domain_ghosts; what no field holds, because few
 * scenes have it. */
int part_domain_copy_to_ghosts(part_domain *domain, const part_store *store, size_t size,
                               const void *own, void *ghosts);

/* The decomposition as bytes, for restart: the same cuts give the same ranks bit for bit. save is
 * local and allocates *bytes (caller frees): the part of this rank. load is collective, takes on
 * every rank what that rank saved, and needs the same number of ranks (ERR_FORMAT). */
int part_domain_save(part_domain *domain, size_t *size, unsigned char **bytes);
int part_domain_load(part_domain *domain, size_t size, const unsigned char *bytes);

#ifdef __cplusplus
}
#endif
#endif
