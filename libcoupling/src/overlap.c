/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "overlap.h"

#include "overlap_methods.h"
#include "void_fractions.h"

int cpl_overlap(int method, cpl_search *search, int sub_cells, const double centre[3],
                double radius, int *hint, cpl_overlaps *list) {
  static int (*const row[])(cpl_search *, int, const double *, double, int *, cpl_overlaps *) = {
#define CPL_VOID_FRACTION(name, meaning) cpl_overlap_##name,
#include "coupling/void_fractions.def"
#undef CPL_VOID_FRACTION
  };
  if (method < 0 || method >= CPL_VOID_FRACTION_COUNT)
    return part_fail(PART_ERR_ARGUMENT, "overlap: no void fraction method %d, allowed 0 .. %d",
                     method, CPL_VOID_FRACTION_COUNT - 1);
  return row[method](search, sub_cells, centre, radius, hint, list);
}
