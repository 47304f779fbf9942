/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Neighbour search: linked cells (counting sort) and Verlet lists with a skin. The list is a half
 * list in rows: pair k of row i has partner j > i among own particles, or a ghost j >= local (then
 * the mirror pair lives on the partner's rank or is the mirror image's row). Data that belongs to
 * a pair (tangential history) is kept in pair order and carried over when lists are rebuilt and
 * when particles migrate, found again by the ids of the two. */
#ifndef PARTICLE_NEIGHBOURS_H
#define PARTICLE_NEIGHBOURS_H

#include "particle/domain.h"
#include "particle/levels.h"
#include "particle/store.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct part_pairs {
  int rows;       /* own particles when the list was built */
  int *start;     /* [rows+1] */
  int *partner;   /* [start[rows]] index of j */
  int data_width; /* doubles per pair, 0: none */
  double *data;   /* [start[rows]][data_width]; zero for a pair that is new */
  double skin;    /* m, added to the sum of radii */
} part_pairs;

int part_pairs_create(int data_width, part_pairs **pairs);
void part_pairs_destroy(part_pairs *pairs);

/* The canonical order of own particles: by level of radius, the small ones first; in a level by cell
 * of a grid over the box of edge >= 2 top + skin (m; x fastest); in a cell by id. It is the same
 * whatever the order before. order[k] is the present index of what becomes particle k,
 * [store->local]: for part_store_permute and for what comes along. radius_field: index of the
 * radius. ERR_RANGE: a cell without length. */
int part_sort_order(const part_store *store, const part_box *box, int radius_field,
                    const part_levels *levels, double skin, int *order);
/* Own particles in that order; pairs and ghosts are dropped. */
int part_sort(part_store *store, const part_box *box, int radius_field, const part_levels *levels,
              double skin);

/* List all pairs with |x_i - x_j| < r_i + r_j + skin between own particles and between own and
 * ghost ones (part_domain_sphere_ghosts with the same radii, levels and skin). Partners are in
 * increasing order in each row. levels (NULL: from the radii present): any give the same list; in
 * the order of part_sort with the same levels it takes least time, and a large sphere's many pairs
 * are in the rows of its small partners. */
int part_pairs_build(part_pairs *pairs, const part_store *store, int radius_field,
                     const part_levels *levels, double skin);

/* Collective. Drops the ghosts that are in no pair; pairs keep their places, partners get their new
 * numbers. The box around a rank's spheres, which decides what is copied, has room between them: of
 * a bed a fifth to a third of the copies are in no pair. */
int part_pairs_trim_ghosts(part_pairs *pairs, part_domain *domain, part_store *store);

/* The same pairs by brute force over all, for tests. */
int part_pairs_build_naive(part_pairs *pairs, const part_store *store, int radius_field,
                           double skin);

/* Pair data as a payload per own particle, for sorting, migration, rebuilding and files: every
 * pair with any non-zero data appears at both its own ends, with the sign flipped at j's end
 * (data is odd under exchange of i and j). entry: partner id, then data_width doubles. */
int part_pairs_gather(const part_pairs *pairs, const part_store *store, int **count, void **entry);
size_t part_pairs_entry_size(const part_pairs *pairs);
/* Put the entries back into a freshly built list. Entries whose pair is not listed any more are
 * dropped. */
int part_pairs_scatter(part_pairs *pairs, const part_store *store, const int *count,
                       const void *entry);

#ifdef __cplusplus
}
#endif
#endif
