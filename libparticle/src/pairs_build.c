/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Verlet lists by linked cells: row i looks through the 3 x 3 runs of three cells around it. */
#include "pairs.h"

#include <stdlib.h>
#include <string.h>

#include "particle/status.h"

static int by_value(const void *a, const void *b) {
  const int x = *(const int *)a, y = *(const int *)b;
  return (x > y) - (x < y);
}

/* Rows are short, and already in up to 27 increasing runs. */
static void sort_row(int *row, int n) {
  if (n > 32) {
    qsort(row, (size_t)n, sizeof *row, by_value);
    return;
  }
  for (int k = 1; k < n; k++) {
    const int value = row[k];
    int at = k;
    for (; at > 0 && row[at - 1] > value; at--)
      row[at] = row[at - 1];
    row[at] = value;
  }
}

/* Partners of i among members from .. to-1. Written without a branch on the outcome, which is not
 * predictable: every candidate is stored, and the counter moves on for a pair. */
static int look_through(const part_cells *c, int from, int to, int i, const double xi[4],
                        double skin, int *row) {
  int count = 0;
  for (int k = from; k < to; k++) {
    const int near =
        part_pair_near(c->x[k] - xi[0], c->y[k] - xi[1], c->z[k] - xi[2], xi[3], c->r[k], skin);
    row[count] = c->member[k];
    count += near & (c->member[k] > i);
  }
  return count;
}

static int fill_row(pair_list *list, const pair_view *v, int i, double skin) {
  const part_cells *c = &list->cells;
  part_pairs *pairs = &list->pairs;
  const double *x = v->x + (size_t)i * (size_t)v->x_stride;
  const double xi[4] = {x[0], x[1], x[2], v->r[(size_t)i * (size_t)v->r_stride]};
  const int nx = c->n[0], ny = c->n[1], nz = c->n[2], cell = c->cell[i];
  const int cx = cell % nx, cy = cell / nx % ny, cz = cell / nx / ny;
  const int x0 = cx > 0 ? cx - 1 : 0, x1 = cx < nx - 1 ? cx + 1 : cx;
  int count = pairs->start[i];
  for (int z = cz > 0 ? cz - 1 : 0; z <= cz + 1 && z < nz; z++)
    for (int y = cy > 0 ? cy - 1 : 0; y <= cy + 1 && y < ny; y++) {
      const int line = (z * ny + y) * nx;
      const int from = c->start[line + x0], to = c->start[line + x1 + 1];
      PART_TRY(part_pairs_room(list, (size_t)count + (size_t)(to - from)));
      count += look_through(c, from, to, i, xi, skin, pairs->partner + count);
    }
  sort_row(pairs->partner + pairs->start[i], count - pairs->start[i]);
  pairs->start[i + 1] = count;
  return PART_OK;
}

static int build(pair_list *list, const part_store *store, int radius_field, double skin) {
  pair_view v;
  PART_TRY(part_pairs_view(store, radius_field, skin, &v));
  PART_TRY(part_pairs_begin(list, v.own, skin));
  const double cutoff = 2.0 * v.r_max + skin;
  if (cutoff > 0.0) { /* else nothing can be near anything */
    PART_TRY(part_cells_build(&list->cells, v.all, v.x, v.x_stride, cutoff));
    for (int k = 0; k < v.all; k++)
      list->cells.r[k] = v.r[(size_t)list->cells.member[k] * (size_t)v.r_stride];
    for (int i = 0; i < v.own; i++)
      PART_TRY(fill_row(list, &v, i, skin));
  }
  return part_pairs_end(list);
}

int part_pairs_build(part_pairs *pairs, const part_store *store, int radius_field, double skin) {
  const int status = build((pair_list *)pairs, store, radius_field, skin);
  if (status != PART_OK)
    pairs->rows = 0;
  return status;
}
