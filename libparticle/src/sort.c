/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Own particles in the canonical order: by cell of a grid that depends on the box alone, then by
 * id. Whatever the order before, the result is the same, so a restart can repeat a run exactly. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "memory.h"
#include "particle/neighbours.h"
#include "particle/status.h"

enum { SIDE_MAX = 1 << 20, DIGIT_BITS = 11, DIGITS = 1 << DIGIT_BITS };

typedef struct sort_item {
  uint64_t cell;
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

static void fill_items(const part_store *store, const part_box *box, const int n[3],
                       sort_item *items) {
  const int stride = store->layout->records[0].width, id_field = store->layout->id_field;
  const double *x = part_record_double(store, 0);
  const int64_t *id = part_field_int64(store, id_field);
  const int id_stride = part_field_stride(store, id_field);
  for (int i = 0; i < store->local; i++) {
    uint64_t cell = 0;
    for (int d = 2; d >= 0; d--)
      cell = cell * (uint64_t)n[d] + cell_of(x[(size_t)i * (size_t)stride + (size_t)d], box->lo[d],
                                             n[d] / (box->hi[d] - box->lo[d]), n[d]);
    items[i] = (sort_item){cell, id[(size_t)i * (size_t)id_stride], i};
  }
}

int part_sort_order(const part_store *store, const part_box *box, double cell, int *order) {
  const size_t count = (size_t)store->local;
  int n[3];
  sort_item *items = NULL, *other = NULL;
  if (!(cell > 0.0))
    return part_fail(PART_ERR_RANGE, "cell of %g m is not in (0, inf)", cell);
  for (int d = 0; d < 3; d++) {
    if (!(box->hi[d] > box->lo[d]))
      return part_fail(PART_ERR_RANGE, "box from %g to %g m", box->lo[d], box->hi[d]);
    n[d] = (int)fmin(fmax(floor((box->hi[d] - box->lo[d]) / cell), 1.0), SIDE_MAX);
  }
  int status = part_allocate(count, sizeof *items, &items);
  if (status == PART_OK)
    status = part_allocate(count, sizeof *other, &other);
  if (status == PART_OK) {
    fill_items(store, box, n, items);
    sort_cells(count, (uint64_t)n[0] * (uint64_t)n[1] * (uint64_t)n[2], &items, &other);
    sort_ids(count, items);
    for (size_t k = 0; k < count; k++)
      order[k] = items[k].index;
  }
  free(items);
  free(other);
  return status;
}

int part_sort_by_cell(part_store *store, const part_box *box, double cell) {
  int *order = NULL;
  int status = part_allocate((size_t)store->local, sizeof *order, &order);
  if (status == PART_OK)
    status = part_sort_order(store, box, cell, order);
  if (status == PART_OK)
    status = part_store_permute(store, order);
  free(order);
  return status;
}
