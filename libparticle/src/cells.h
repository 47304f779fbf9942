/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Linked cells by counting sort: points of a cell are contiguous and in increasing order of index.
 * Cells run with x fastest, so that cells in a row along x are one contiguous run. */
#ifndef PART_CELLS_H
#define PART_CELLS_H

#include <stddef.h>

/* The points: component d of point k is x[k*x_stride + d], its radius r[k*r_stride]. */
typedef struct part_points {
  const double *x, *r;
  int x_stride, r_stride;
} part_points;

typedef struct part_cells {
  int count;                     /* points */
  double lo[3], hi[3];           /* around the points */
  double r_max;                  /* largest radius */
  double per_length, slack;      /* cells per m; m, bound of the rounding of a place */
  int n[3];
  int *start;            /* [n0*n1*n2 + 1] */
  int *member;           /* [count] index of the point */
  double *x, *y, *z, *r; /* [count, padded by CELLS_PADDING] in the order of member */
  int *cell;             /* [count] cell of each point, in the order given */
  size_t cells_room, member_room, cell_room, room[4]; /* allocated */
} part_cells;

enum { CELLS_PADDING = 8 }; /* vectors may read that far beyond the last point */

/* Sort n points, index[0 .. n-1] (NULL: 0 .. n-1; all finite), into cells of edge >= `edge` > 0. The
 * grid covers the points; cells are made larger where that would give many more cells than points.
 */
int part_cells_build(part_cells *cells, const part_points *points, int n, const int *index,
                     double edge);
void part_cells_free(part_cells *cells);

/* Range of cells [0] .. [1] in each direction that may hold points within reach of x; returns 0 when
 * there are none. */
static inline int part_cells_range(const part_cells *cells, const double x[3], double reach,
                                   int range[3][2]) {
  reach += cells->slack;
  for (int d = 0; d < 3; d++) {
    const double from = x[d] - reach, to = x[d] + reach;
    if (from > cells->hi[d] || to < cells->lo[d])
      return 0;
    const double a = (from - cells->lo[d]) * cells->per_length,
                 b = (to - cells->lo[d]) * cells->per_length;
    const double last = cells->n[d] - 1;
    range[d][0] = a > 0.0 ? (int)(a < last ? a : last) : 0;
    range[d][1] = b < last ? (int)b : (int)last;
  }
  return cells->count > 0;
}

#endif
