/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The list of touched cells, and the choice of a method by its row in void_fractions.def. */
#include "search.h"

#include <stdlib.h>

void cpl_overlaps_free(cpl_overlaps *list) {
  free(list->cell);
  free(list->volume);
  *list = (cpl_overlaps){0};
}

int cpl_overlaps_add(cpl_overlaps *list, int cell, double volume) {
  if (list->count == list->capacity) {
    const int capacity = 2 * list->capacity + 64;
    int *cells = realloc(list->cell, (size_t)capacity * sizeof *cells);
    if (cells != NULL)
      list->cell = cells;
    double *volumes = realloc(list->volume, (size_t)capacity * sizeof *volumes);
    if (volumes != NULL)
      list->volume = volumes;
    if (cells == NULL || volumes == NULL)
      return part_fail(PART_ERR_MEMORY, "overlap: no memory for %d cells", capacity);
    list->capacity = capacity;
  }
  list->cell[list->count] = cell;
  list->volume[list->count++] = volume;
  return PART_OK;
}

int cpl_overlap_centre(cpl_search *search, const double centre[3], double radius, int *hint,
                       cpl_overlaps *list) {
  *hint = cpl_search_cell(search, centre, *hint);
  if (*hint < 0)
    return PART_OK;
  return cpl_overlaps_add(list, *hint, 4.18879020478639098 * radius * radius * radius);
}

/* One signature for all rows: n is of use to subCell only. */
static int overlap_exact(cpl_search *s, int n, const double x[3], double r, int *hint,
                         cpl_overlaps *list) {
  (void)n;
  return cpl_overlap_exact(s, x, r, hint, list);
}

static int overlap_subCell(cpl_search *s, int n, const double x[3], double r, int *hint,
                           cpl_overlaps *list) {
  return cpl_overlap_sub_cell(s, n, x, r, hint, list);
}

static int overlap_centre(cpl_search *s, int n, const double x[3], double r, int *hint,
                          cpl_overlaps *list) {
  (void)n;
  return cpl_overlap_centre(s, x, r, hint, list);
}

int cpl_overlap(int method, cpl_search *search, int n, const double centre[3], double radius,
                int *hint, cpl_overlaps *list) {
  static int (*const row[])(cpl_search *, int, const double *, double, int *, cpl_overlaps *) = {
#define CPL_VOID_FRACTION(name, meaning) overlap_##name,
#include "coupling/void_fractions.def"
#undef CPL_VOID_FRACTION
  };
  const int rows = (int)(sizeof row / sizeof *row);
  if (method < 0 || method >= rows)
    return part_fail(PART_ERR_ARGUMENT, "overlap: no void fraction method %d, allowed 0 .. %d",
                     method, rows - 1);
  return row[method](search, n, centre, radius, hint, list);
}
