/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files about the domain share. */
#ifndef PART_DOMAIN_PRIVATE_H
#define PART_DOMAIN_PRIVATE_H

#include "particle/domain.h"
#include "particle/exchange.h"

#include "records.h"

/* A rank's part: lo < x <= hi in every direction; outer sides are infinite. Parts come from one
 * tree of cuts (point <= cut goes to the low side), so every point is in exactly one. A rank
 * without a part has lo = hi. */
typedef struct part_region {
  double lo[3], hi[3];
} part_region;

/* Copies to or from one rank: `count` of them from `first` on, an item of the plan or a ghost. */
typedef struct ghost_peer {
  int rank, count, first;
} ghost_peer;

/* The ghost exchange that update repeats. */
typedef struct ghost_plan {
  int made;
  int count, ghosts, local; /* copies this rank gives, gets; own particles when it was made */
  int *item, *image;        /* [count] own particle, row of shift; by rank, particle, image */
  double *shift;            /* [images][3] added to the position, m */
  ghost_peer own_to, own_from, *to, *from; /* the others by rank */
  int n_to, n_from;
  int widest;                           /* most copies to or from one rank */
  unsigned char take[PART_RECORDS_MAX]; /* records that update refreshes */
  MPI_Request *request;                 /* of `pending` messages that are under way */
  int pending;
  unsigned char *send; /* what they carry */
  size_t sent;         /* bytes of it */
  size_t item_room, image_room, request_room, send_room;
} ghost_plan;

struct part_domain {
  MPI_Comm comm;
  int size, rank;
  part_box box;
  part_region *part; /* [size] */
  ghost_plan ghosts;
};

/* Rank whose part holds x; -1: none (parts that do not belong together, or x not finite). */
int part_domain_owner(const part_domain *domain, const double x[3]);
/* Agreement that asks nobody on one rank. */
int part_domain_agree(const part_domain *domain, int status);
/* part_fail with id and position of own particle i. */
int part_domain_fail_at(const part_store *store, int i, int status, const char *what);
void part_ghost_plan_free(ghost_plan *plan);
/* Collective. The exchange of `count` copies: own particle item[k] to rank destination[k] (in
 * increasing order) with shift[3 image[k]]; item and image are in the plan, shift is copied. */
int part_ghost_plan_make(part_domain *domain, int count, const int *destination, int images,
                         const double *shift);
/* Local. Room for so many arrays with together so many bytes of a particle between begin and end;
 * ERR_MEMORY, ERR_ARGUMENT: not a multiple of 8, ERR_RANGE: more than a message holds. */
int part_ghost_room(part_domain *domain, size_t room, int arrays);
/* All ranks call. Puts `size` bytes of each particle ([local] in own) on the way to its copies
 * ([ghosts] in copies), and makes those that stay on this rank. shifted: they begin with a
 * position. Others may follow before part_ghost_end waits for all of them; own may change
 * meanwhile. */
int part_ghost_begin(part_domain *domain, size_t size, int shifted, const void *own, void *copies);
int part_ghost_end(part_domain *domain);
/* Collective; see part_domain_trim_ghosts. */
int part_ghost_trim(part_domain *domain, part_store *store, const unsigned char *needed,
                    int *place);

#endif
