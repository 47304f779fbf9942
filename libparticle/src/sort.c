/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Own particles in the canonical order: by level, by cell of a grid that depends on the box alone,
 * then by id. Whatever the order before, the result is the same, so a restart can repeat a run
 * exactly. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "memory.h"
#include "particle/neighbours.h"
#include "particle/status.h"

enum { SIDE_MAX = 1 << 20, DIGIT_BITS = 11, DIGITS = 1 << DIGIT_BITS };

typedef struct sort_item {
  uint64_t cell; /* within the level */
  int64_t id;
  int index;
} sort_item;

static int by_id(const void *a, const void *b) {
  const sort_item *x = (const sort_item *)a, *y = (const sort_item *)b;
  return (x->id > y->id) - (x->id < y->id);
}

/* Radix sort by cell, least significant digit first; *items and *other may change places. */
static void sort_cells(size_t n, uint64_t cells, sort_item **items, sort_item **other) {
  for (int shift = 0; shift < 64 && (cells - 1) >> shift > 0; shift += DIGIT_BITS) {
    size_t start[DIGITS + 1] = {0};
    for (size_t k = 0; k < n; k++)
      start[((*items)[k].cell >> shift) % DIGITS + 1]++;
    for (int d = 0; d < DIGITS; d++)
      start[d + 1] += start[d];
    for (size_t k = 0; k < n; k++)
      (*other)[start[((*items)[k].cell >> shift) % DIGITS]++] = (*items)[k];
    sort_item *swap = *items;
    *items = *other;
    *other = swap;
  }
}

/* Cells hold few points. */
static void insert_ids(size_t n, sort_item *items) {
  for (size_t k = 1; k < n; k++) {
    const sort_item one = items[k];
    size_t at = k;
    for (; at > 0 && items[at - 1].id > one.id; at--)
      items[at] = items[at - 1];
    items[at] = one;
  }
}

static void sort_ids(size_t n, sort_item *items) {
  for (size_t k = 0, end; k < n; k = end) {
    for (end = k + 1; end < n && items[end].cell == items[k].cell;)
      end++;
    if (end - k > 16)
      qsort(items + k, end - k, sizeof *items, by_id);
    else
      insert_ids(end - k, items + k);
  }
}

/* Cell of a coordinate, 0 .. n-1; outside the box: the nearest. NaN: 0. */
static uint64_t cell_of(double x, double lo, double per_length, int n) {
  const double c = (x - lo) * per_length;
  return c >= n ? (uint64_t)(n - 1) : c > 0.0 ? (uint64_t)c : 0;
}

/* Cells of a level in each direction. ERR_RANGE: no length. */
static int grid_of(const part_box *box, double cell, int n[3]) {
  if (!(cell > 0.0))
    return part_fail(PART_ERR_RANGE, "cell of %g m is not in (0, inf)", cell);
  for (int d = 0; d < 3; d++) {
    if (!(box->hi[d] > box->lo[d]))
      return part_fail(PART_ERR_RANGE, "box from %g to %g m", box->lo[d], box->hi[d]);
    n[d] = (int)fmin(fmax(floor((box->hi[d] - box->lo[d]) / cell), 1.0), SIDE_MAX);
  }
  return PART_OK;
}

static int level_of(const part_store *store, int radius_field, const part_levels *levels, int i) {
  const double *r = part_field_double(store, radius_field);
  return part_level_of(levels,
                       r[(size_t)i * (size_t)part_field_stride(store, radius_field)]);
}

/* Items grouped by level; start[k]: first of level k. */
static void fill_items(const part_store *store, int radius_field, const part_levels *levels,
                       size_t start[PART_LEVELS_MAX + 1], sort_item *items) {
  const int64_t *id = part_field_int64(store, store->layout->id_field);
  const size_t stride = (size_t)part_field_stride(store, store->layout->id_field);
  size_t at[PART_LEVELS_MAX];
  for (int i = 0; i < store->local; i++)
    start[level_of(store, radius_field, levels, i) + 1]++;
  for (int k = 0; k < levels->count; k++) {
    start[k + 1] += start[k];
    at[k] = start[k];
  }
  for (int i = 0; i < store->local; i++)
    items[at[level_of(store, radius_field, levels, i)]++] =
        (sort_item){0, id[(size_t)i * stride], i};
}

static void set_cells(const part_store *store, const part_box *box, const int n[3], size_t count,
                      sort_item *items) {
  const size_t stride = (size_t)store->layout->records[0].width;
  for (size_t k = 0; k < count; k++) {
    const double *x = part_record_double(store, 0) + (size_t)items[k].index * stride;
    uint64_t cell = 0;
    for (int d = 2; d >= 0; d--)
      cell = cell * (uint64_t)n[d] +
             cell_of(x[d], box->lo[d], n[d] / (box->hi[d] - box->lo[d]), n[d]);
    items[k].cell = cell;
  }
}

/* Level by level; what is done with lies in *items or *other, so the order is taken at once. */
static int sort_levels(const part_store *store, const part_box *box, const part_levels *levels,
                       double skin, const size_t *start, sort_item *items, sort_item *other,
                       int *order) {
  for (int level = 0; level < levels->count; level++) {
    const size_t first = start[level], count = start[level + 1] - first;
    sort_item *a = items + first, *b = other;
    int n[3] = {1, 1, 1};
    PART_TRY(grid_of(box, 2.0 * levels->top[level] + skin, n));
    set_cells(store, box, n, count, a);
    sort_cells(count, (uint64_t)n[0] * (uint64_t)n[1] * (uint64_t)n[2], &a, &b);
    sort_ids(count, a);
    for (size_t k = 0; k < count; k++)
      order[first + k] = a[k].index;
  }
  return PART_OK;
}

int part_sort_order(const part_store *store, const part_box *box, int radius_field,
                    const part_levels *levels, double skin, int *order) {
  const size_t count = (size_t)store->local;
  size_t start[PART_LEVELS_MAX + 1] = {0};
  sort_item *items = NULL, *other = NULL;
  int status = part_allocate(count, sizeof *items, &items);
  if (status == PART_OK)
    status = part_allocate(count, sizeof *other, &other);
  if (status == PART_OK) {
    fill_items(store, radius_field, levels, start, items);
    status = sort_levels(store, box, levels, skin, start, items, other, order);
  }
  free(items);
  free(other);
  return status;
}

int part_sort(part_store *store, const part_box *box, int radius_field, const part_levels *levels,
              double skin) {
  int *order = NULL;
  int status = part_allocate((size_t)store->local, sizeof *order, &order);
  if (status == PART_OK)
    status = part_sort_order(store, box, radius_field, levels, skin, order);
  if (status == PART_OK)
    status = part_store_permute(store, order);
  free(order);
  return status;
}
