/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Volume of a ball in a cell, computed in other ways than libcoupling, slowly and in long double.
 * Cells are bounded by fans of triangles about the face centres. Volumes are in radii cubed. */
#ifndef TEST_BALL_REFERENCE_H
#define TEST_BALL_REFERENCE_H

#include "coupling/coupling.h"

/* The cells of a mesh, each with its faces. Not copied: the mesh must stay. */
typedef struct ball_cells {
  const cpl_mesh *mesh;
  int *start, *face; /* faces of each cell, ~f when it is the neighbour */
  double *reach;     /* largest distance of a corner from the cell centre */
} ball_cells;
void ball_cells_create(const cpl_mesh *mesh, ball_cells *cells);
void ball_cells_free(ball_cells *cells);
/* 0: the ball is surely outside the cell. */
int ball_may_touch(const ball_cells *cells, int cell, const double centre[3], double radius);

/* V = sum over triangles of h/3 int min(1, |x|^-3) dA, in polar coordinates about the foot of the
 * normal, edge by edge: one primitive inside the circle, another outside. */
long double ball_by_edges(const ball_cells *cells, int cell, const double centre[3], double radius);

/* V = int A(z) dz, A the area of the disc in the slice of the cell, by tanh-sinh quadrature between
 * all heights where A is not smooth. Shares no formula with the others. About 10 ms. */
long double ball_by_slices(const ball_cells *cells, int cell, const double centre[3],
                           double radius);

/* Winding number of the surface of the cell about x: 1 inside, 0 outside. */
long double ball_winding(const ball_cells *cells, int cell, const double x[3]);

#endif
