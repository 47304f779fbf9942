/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which cell of this rank holds a point, and which may touch a box. Geometry only: knows no
 * particles, ranks or fluid. */
#ifndef COUPLING_SEARCH_H
#define COUPLING_SEARCH_H

#include "coupling/coupling.h"

typedef struct cpl_search cpl_search; /* bins, box cells, face planes of one mesh */

int cpl_search_create(const cpl_mesh *mesh, cpl_search **search);
void cpl_search_destroy(cpl_search *search);
/* Bounding box of the mesh of this rank; lo > hi when it has no cells. */
void cpl_search_bounds(const cpl_search *search, double lo[3], double hi[3]);
/* Mark the bins of a global coarse grid (n[3] bins from lo, edges bin[3]) that cells touch. */
void cpl_search_mark(const cpl_search *search, const double lo[3], const double bin[3],
                     const int n[3], unsigned char *mark);

/* Reach of the method kernel, over the radius. */
void cpl_search_set_reach(cpl_search *search, double reach);

/* Cell of this rank that contains x, -1 if none; hint: a cell to try first, or -1. Ties on faces
 * go to the lowest cell number. */
int cpl_search_cell(cpl_search *search, const double x[3], int hint);

#endif
