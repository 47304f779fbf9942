/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The ways to share a sphere among cells: cpl_overlap_<name> for each row of void_fractions.def,
 * each in a file of its own. */
#ifndef COUPLING_OVERLAP_METHODS_H
#define COUPLING_OVERLAP_METHODS_H

#include "overlaps.h"
#include "search.h"

/* Append the cells of this rank that the sphere touches and its volume in each (m3). The sphere may
 * lie partly or wholly outside this rank's cells; volumes that do not add up to that of the sphere
 * are normalised by the caller, and a sphere for which nothing was appended on any rank is divided
 * exactly. *hint: as in cpl_search_cell, updated. */
#define CPL_VOID_FRACTION(name, meaning)                                                           \
  int cpl_overlap_##name(cpl_search *search, int sub_cells, const double centre[3], double radius, \
                         int *hint, cpl_overlaps *list);
#include "coupling/void_fractions.def"
#undef CPL_VOID_FRACTION

/* Method kernel: how far it reaches, over the radius of the sphere. */
double cpl_kernel_reach(double bandwidth);

/* For tests of subCell: mark[i + n (j + n k)] = 1 for the sub-cells of one cell that count, else 0;
 * and the centres of all its sub-cells, point[n^3][3] (those of a polyhedron may be outside of it).
 */
int cpl_sub_cell_marks(cpl_search *search, int n, int cell, const double centre[3], double radius,
                       unsigned char *mark);
int cpl_sub_cell_points(cpl_search *search, int n, int cell, double *point);

#endif
