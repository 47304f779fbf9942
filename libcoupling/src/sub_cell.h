/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Corners of hexahedra and rows of sub-cells; internal to overlap_sub_cell.c and its parts. */
#ifndef COUPLING_SUB_CELL_H
#define COUPLING_SUB_CELL_H

#include <stdint.h>
#include "search_type.h"

/* Of cells that are not boxes, in the trilinear order: corner b at (b & 1, b >> 1 & 1, b >> 2). */
struct cpl_hexes {
  int (*corner)[8]; /* [cells]; corner[c][0] = -1: not a hexahedron */
  int squares;
  double *square; /* [2 squares] scratch of overlap_sub_cell.c */
  size_t words;   /* of bits */
  uint64_t *bits; /* rows of one polyhedron */
};
int cpl_hexes_create(cpl_search *s);
void cpl_hexes_destroy(cpl_hexes *hexes);

/* Bit i of row (j, k) of bits (words per row: (n + 63) / 64) says that sub-cell centre (i, j, k) of
 * the n^3 grid over the bound of a polyhedron is inside it; only rows from .. to are valid. */
int cpl_polyhedron_rows(cpl_search *s, int cell, int n, const int from[2], const int to[2]);

#endif
