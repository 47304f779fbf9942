/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "overlaps.h"

#include "particle/status.h"

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
