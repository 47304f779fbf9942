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

/* The ghost exchange that update repeats. */
typedef struct ghost_plan {
  part_exchange *exchange; /* NULL on one rank */
  int count, local;        /* copies this rank sends; own particles when it was made */
  int *item, *destination; /* [count] own particle, rank of the copy */
  double *shift;           /* [count][3] added to the position, m */
  size_t item_room, destination_room, shift_room;
  unsigned char take[PART_RECORDS_MAX]; /* records that update refreshes */
  unsigned char *send, *received;
  size_t send_room, received_room;
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
/* One more copy: own particle i to a rank. */
int part_ghost_plan_add(ghost_plan *plan, int i, int rank, const double shift[3]);

#endif
