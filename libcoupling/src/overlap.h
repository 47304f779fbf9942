/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which cells of this rank a sphere touches, and how much of its volume is in each. Geometry only:
 * knows no particles, ranks or fluid. */
#ifndef COUPLING_OVERLAP_H
#define COUPLING_OVERLAP_H

#include "coupling/coupling.h"

typedef struct cpl_search cpl_search; /* bins, box cells, face planes of one mesh */

int cpl_search_create(const cpl_mesh *mesh, cpl_search **search);
void cpl_search_destroy(cpl_search *search);
/* Bounding box of the mesh of this rank; lo > hi when it has no cells. */
void cpl_search_bounds(const cpl_search *search, double lo[3], double hi[3]);
/* Mark the bins of a global coarse grid (n[3] bins from lo, edges bin[3]) that cells touch. */
void cpl_search_mark(const cpl_search *search, const double lo[3], const double bin[3],
                     const int n[3], unsigned char *mark);

/* Cell of this rank that contains x, -1 if none; hint: a cell to try first, or -1. Ties on faces
 * go to the lowest cell number. */
int cpl_search_cell(cpl_search *search, const double x[3], int hint);

/* Touched cells of this rank and the sphere's volume in each (m3), appended to a growing list. The
 * sphere may lie partly or wholly outside this rank's cells. *hint as above, updated. */
typedef struct cpl_overlaps {
  int count, capacity;
  int *cell;
  double *volume;
} cpl_overlaps;
void cpl_overlaps_free(cpl_overlaps *list);
int cpl_overlap_exact(cpl_search *search, const double centre[3], double radius, int *hint,
                      cpl_overlaps *list);
/* Cells divided into n^3 sub-cells; a cell gets the volume of those whose centre is inside. Boxes
 * and hexahedra: equal parts of the cell's trilinear coordinates. Other cells: the parts of an n^3
 * grid over the cell's bound whose centres are in the cell. The volumes add up to about that of the
 * sphere only: normalise. When no centre at all is inside, all goes to the cell of the sphere's
 * centre. ERR_RANGE: n < 1. */
int cpl_overlap_sub_cell(cpl_search *search, int n, const double centre[3], double radius,
                         int *hint, cpl_overlaps *list);
/* For tests: mark[i + n (j + n k)] = 1 for the sub-cells of one cell that count, else 0; and the
 * centres of all its sub-cells, point[n^3][3] (those of a polyhedron may be outside of it). */
int cpl_sub_cell_marks(cpl_search *search, int n, int cell, const double centre[3], double radius,
                       unsigned char *mark);
int cpl_sub_cell_points(cpl_search *search, int n, int cell, double *point);
/* All volume in the cell of the centre. */
int cpl_overlap_centre(cpl_search *search, const double centre[3], double radius, int *hint,
                       cpl_overlaps *list);

/* The method of a row of void_fractions.def (n: of subCell). ERR_ARGUMENT: no such row. */
int cpl_overlap(int method, cpl_search *search, int n, const double centre[3], double radius,
                int *hint, cpl_overlaps *list);

#endif
