/* SPDX-License-Identifier: GPL-3.0-or-later */
/* All volume in the cell of the centre. */
#include "overlap_methods.h"
#include "sphere.h"

int cpl_overlap_centre(cpl_search *search, int sub_cells, const double centre[3], double radius,
                       int *hint, cpl_overlaps *list) {
  (void)sub_cells;
  *hint = cpl_search_cell(search, centre, *hint);
  return *hint < 0 ? PART_OK : cpl_overlaps_add(list, *hint, cpl_sphere_volume(radius));
}
