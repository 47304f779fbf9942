/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The inner loop of neighbour search. */
#ifndef PART_PAIRS_NEAR_H
#define PART_PAIRS_NEAR_H

#include "cells.h"

/* The condition of a listed pair, in one place so that all builders round alike. */
static inline int part_pair_near(double dx, double dy, double dz, double ri, double rj,
                                 double skin) {
  const double reach = ri + rj + skin;
  return dx * dx + dy * dy + dz * dz < reach * reach;
}

/* Members from .. to-1 of the cells that are near the sphere at xi[0..2] with radius xi[3] and have
 * an index above `above`, in that order, into found; returns how many. Up to to - from +
 * CELLS_PADDING items of found may be written over. */
typedef int part_near_function(const part_cells *cells, int from, int to, const double xi[4],
                               double skin, int above, int *found);

/* The quickest one that the processor can; all give the same. */
part_near_function *part_near_choose(void);
/* Number k of those there are (0: plain loop), NULL beyond them or where the processor can not. */
part_near_function *part_near_variant(int k);

/* What a search found; item is freed by whoever owns it. */
typedef struct part_found {
  int count;
  int *item;
  size_t room;
} part_found;

/* Add the members of all cells that are near the sphere xi and above an index. ERR_RANGE: more than
 * an int counts. */
int part_cells_near(const part_cells *cells, part_near_function *near, const double xi[4],
                    double skin, int above, part_found *found);

#endif
