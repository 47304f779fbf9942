/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files about pair lists share. */
#ifndef PART_PAIRS_H
#define PART_PAIRS_H

#include <stddef.h>

#include "cells.h"
#include "particle/levels.h"
#include "particle/neighbours.h"

/* A pair found from its second end. */
typedef struct late_pair {
  int row, partner;
} late_pair;

/* The public part comes first: a part_pairs is the beginning of one of these. */
typedef struct pair_list {
  part_pairs pairs;
  size_t start_room, partner_room, data_room, order_room, late_room; /* allocated items */
  part_cells level[PART_LEVELS_MAX]; /* this and what follows: kept for their memory */
  int *order;                        /* particles by level */
  late_pair *late;
} pair_list;

/* Positions and radii of a store, as the builders read them. */
typedef struct pair_view {
  part_points points;
  int own, all;
  double r_min, r_max;
} pair_view;

/* Check the arguments and the numbers (ERR_NUMERIC: position or radius not finite, or r < 0). */
int part_pairs_view(const part_store *store, int radius_field, double skin, pair_view *view);
/* Room for rows + 1 starts; the list is empty afterwards. */
int part_pairs_begin(pair_list *list, int rows, double skin);
/* Room for n partners in all. ERR_RANGE: more than an int counts. */
int part_pairs_room(pair_list *list, size_t n);
/* All rows are in: zeroed data. */
int part_pairs_end(pair_list *list);

#endif
