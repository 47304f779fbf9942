/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which cells of this rank a sphere touches, and how much of its volume is in each. */
#ifndef COUPLING_OVERLAP_H
#define COUPLING_OVERLAP_H

#include "overlaps.h"
#include "search.h"

/* By the method of a row of void_fractions.def, see overlap_methods.h. ERR_ARGUMENT: no such row.
 */
int cpl_overlap(int method, cpl_search *search, int sub_cells, const double centre[3],
                double radius, int *hint, cpl_overlaps *list);

#endif
