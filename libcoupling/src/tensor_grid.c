/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Recognising a tensor grid and finding its cells, see tensor_grid.h. */
#include "tensor_grid.h"

#include <stdlib.h>

/* ---- planes ---------------------------------------------------------------------------------- */

typedef struct {
  double *x;
  size_t count, capacity;
} plane_list;

static int compare(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Ascending, those closer than tie to the one before dropped. */
static void sort_unique(plane_list *p, double tie) {
  size_t kept = 0;
  if (p->count > 0)
    qsort(p->x, p->count, sizeof *p->x, compare);
  for (size_t i = 0; i < p->count; i++)
    if (kept == 0 || p->x[i] - p->x[kept - 1] > tie)
      p->x[kept++] = p->x[i];
  p->count = kept;
}

static int add_plane(plane_list *p, double x, double tie) {
  if (p->count == p->capacity)
    sort_unique(p, tie);
  if (2 * p->count >= p->capacity) { /* sort rarely: only when half of it is new */
    const size_t capacity = 2 * p->capacity + 1024;
    double *grown = realloc(p->x, capacity * sizeof *grown);
    if (grown == NULL)
      return part_fail(PART_ERR_MEMORY, "search: no memory for %zu planes", capacity);
    p->x = grown;
    p->capacity = capacity;
  }
  p->x[p->count++] = x;
  return PART_OK;
}

static int find_planes(const cpl_search *s, int d, plane_list *p) {
  for (int c = 0; c < s->mesh->cells; c++) {
    PART_TRY(add_plane(p, s->bound[c][d], s->round_off));
    PART_TRY(add_plane(p, s->bound[c][3 + d], s->round_off));
  }
  sort_unique(p, s->round_off);
  return PART_OK;
}

/* ---- index ----------------------------------------------------------------------------------- */

int cpl_tensor_slab(const cpl_tensor *t, int d, double v) {
  const double *x = t->x[d];
  const int n = t->n[d];
  if (!(v >= x[0]))
    return -1;
  if (v >= x[n])
    return n;
  const int slot = (int)((v - x[0]) * t->inverse[d]);
  int i = t->start[d][slot < n ? slot : n - 1];
  while (x[i + 1] <= v)
    i++;
  while (x[i] > v)
    i--;
  return i;
}

static int index_axis(cpl_tensor *t, int d) {
  const int n = t->n[d];
  const double *x = t->x[d];
  t->start[d] = malloc((size_t)n * sizeof *t->start[d]);
  if (t->start[d] == NULL)
    return part_fail(PART_ERR_MEMORY, "search: no memory for %d slabs", n);
  t->inverse[d] = n / (x[n] - x[0]);
  for (int i = 0, at = 0; i < n; i++) {
    while (at + 1 < n && (x[at + 1] - x[0]) * t->inverse[d] <= i)
      at++;
    t->start[d][i] = at;
  }
  return PART_OK;
}

/* 1: every cell is one slot of its own. */
static int place_cells(const cpl_search *s, cpl_tensor *t) {
  for (int c = 0; c < s->mesh->cells; c++) {
    size_t at = 0;
    for (int d = 2; d >= 0; d--) {
      const int i = cpl_tensor_slab(t, d, 0.5 * (s->bound[c][d] + s->bound[c][3 + d]));
      if (i < 0 || i >= t->n[d] || t->x[d][i + 1] - s->bound[c][3 + d] < -s->round_off ||
          t->x[d][i] > s->bound[c][d] + s->round_off ||
          t->x[d][i] < s->bound[c][d] - s->round_off ||
          t->x[d][i + 1] > s->bound[c][3 + d] + s->round_off)
        return 0;
      at = at * (size_t)t->n[d] + (size_t)i;
    }
    if (t->cell[at] >= 0)
      return 0;
    t->cell[at] = c;
  }
  return 1;
}

int cpl_tensor_create(const cpl_search *s, cpl_tensor **tensor) {
  *tensor = NULL;
  for (int c = 0; c < s->mesh->cells; c++)
    if (!s->is_box[c])
      return PART_OK;
  if (s->mesh->cells == 0)
    return PART_OK;
  cpl_tensor *t = calloc(1, sizeof *t);
  int status = t != NULL ? PART_OK : part_fail(PART_ERR_MEMORY, "search: no memory");
  double slots = 1.0;
  for (int d = 0; d < 3 && status == PART_OK; d++) {
    plane_list p = {0};
    status = find_planes(s, d, &p);
    t->x[d] = p.x;
    t->n[d] = (int)p.count - 1;
    slots *= t->n[d];
  }
  /* boxes of many sizes, or few of a large grid, would waste the table: then it is no grid to us */
  int grid = status == PART_OK && slots >= 1.0 && slots <= 8.0 * s->mesh->cells + 4096.0;
  for (int d = 0; d < 3 && grid && status == PART_OK; d++)
    status = index_axis(t, d);
  if (grid && status == PART_OK) {
    t->cell = malloc((size_t)slots * sizeof *t->cell);
    if (t->cell == NULL)
      status = part_fail(PART_ERR_MEMORY, "search: no memory for a grid of %g cells", slots);
    for (size_t i = 0; t->cell != NULL && i < (size_t)slots; i++)
      t->cell[i] = -1;
    grid = t->cell != NULL && place_cells(s, t);
  }
  if (grid && status == PART_OK)
    *tensor = t;
  else
    cpl_tensor_destroy(t);
  return status;
}

void cpl_tensor_destroy(cpl_tensor *t) {
  for (int d = 0; d < 3 && t != NULL; d++) {
    free(t->x[d]);
    free(t->start[d]);
  }
  if (t != NULL) {
    free(t->cell);
    free(t->work);
  }
  free(t);
}

int cpl_tensor_cell(const cpl_tensor *t, const double x[3], double tie) {
  int from[3], to[3], found = -1; /* two slabs when x is on the plane between them */
  for (int d = 0; d < 3; d++) {
    const int i = cpl_tensor_slab(t, d, x[d]), n = t->n[d];
    from[d] = i >= 0 && x[d] - t->x[d][i] <= tie ? i - 1 : i;
    to[d] = i < n && t->x[d][i + 1] - x[d] <= tie ? i + 1 : i;
    from[d] = from[d] > 0 ? from[d] : 0;
    to[d] = to[d] < n - 1 ? to[d] : n - 1;
  }
  for (int k = from[2]; k <= to[2]; k++)
    for (int j = from[1]; j <= to[1]; j++)
      for (int i = from[0]; i <= to[0]; i++) {
        const int c =
            t->cell[(size_t)i + (size_t)t->n[0] * ((size_t)j + (size_t)t->n[1] * (size_t)k)];
        if (c >= 0 && (found < 0 || c < found))
          found = c;
      }
  return found;
}
