/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Linked cells by counting sort: points of a cell are contiguous and in increasing order of index.
 * Cells run with x fastest, so that three cells in a row along x are one contiguous run. */
#ifndef PART_CELLS_H
#define PART_CELLS_H

#include <stddef.h>

typedef struct part_cells {
  double lo[3], per_length; /* cell of x: (x - lo) * per_length, cut to 0 .. n-1 */
  int n[3];
  int *start;            /* [n0*n1*n2 + 1] */
  int *member;           /* [points] index of the point */
  double *x, *y, *z, *r; /* [points] in the order of member; r is filled by the caller */
  int *cell;             /* [points] cell of each point, in the points' own order */
  size_t cells_room, member_room, cell_room, room[4]; /* allocated */
} part_cells;

/* Sort n points (x[k*stride + 0..2], all finite) into cells of edge >= `edge` > 0. The grid covers
 * the points; cells are made larger where that would give many more cells than points. */
int part_cells_build(part_cells *cells, int n, const double *x, int stride, double edge);
void part_cells_free(part_cells *cells);

static inline int part_cells_index(const part_cells *cells, int d, double x) {
  const double c = (x - cells->lo[d]) * cells->per_length;
  const int k = (int)c;
  return k < cells->n[d] ? k : cells->n[d] - 1;
}

#endif
