/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The cells that a sphere touches, a list that grows. */
#ifndef COUPLING_OVERLAPS_H
#define COUPLING_OVERLAPS_H

typedef struct cpl_overlaps {
  int count, capacity;
  int *cell;
  double *volume; /* of the sphere in the cell, m3 */
} cpl_overlaps;

/* Append. */
int cpl_overlaps_add(cpl_overlaps *list, int cell, double volume);
void cpl_overlaps_free(cpl_overlaps *list);

#endif
