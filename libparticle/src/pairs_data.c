/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Data of pairs as a payload of the particles, found again by the partner's id. */
#include "pairs.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "memory.h"
#include "particle/status.h"

size_t part_pairs_entry_size(const part_pairs *pairs) {
  return sizeof(int64_t) + (size_t)pairs->data_width * sizeof(double);
}

static int64_t id_of(const part_store *store, int i) {
  const int field = store->layout->id_field;
  return part_field_int64(store, field)[(size_t)i * (size_t)part_field_stride(store, field)];
}

static int has_data(const part_pairs *pairs, int pair) {
  const double *data = pairs->data + (size_t)pair * (size_t)pairs->data_width;
  for (int w = 0; w < pairs->data_width; w++)
    if (data[w] != 0.0)
      return 1;
  return 0;
}

/* One entry: partner's id, then the data times sign. */
static void put_entry(unsigned char *entry, int64_t id, const double *data, int width,
                      double sign) {
  memcpy(entry, &id, sizeof id);
  for (int w = 0; w < width; w++) {
    const double value = sign * data[w];
    memcpy(entry + sizeof id + (size_t)w * sizeof value, &value, sizeof value);
  }
}

/* count[i]: entries of own particle i. */
static void count_entries(const part_pairs *pairs, int *count) {
  for (int i = 0; i < pairs->rows; i++)
    for (int k = pairs->start[i]; k < pairs->start[i + 1]; k++)
      if (has_data(pairs, k)) {
        count[i]++;
        if (pairs->partner[k] < pairs->rows)
          count[pairs->partner[k]]++;
      }
}

static void put_entries(const part_pairs *pairs, const part_store *store, size_t *at,
                        unsigned char *entries) {
  const size_t size = part_pairs_entry_size(pairs);
  const int width = pairs->data_width;
  for (int i = 0; i < pairs->rows; i++)
    for (int k = pairs->start[i]; k < pairs->start[i + 1]; k++) {
      if (!has_data(pairs, k))
        continue;
      const int j = pairs->partner[k];
      const double *data = pairs->data + (size_t)k * (size_t)width;
      put_entry(entries + size * at[i]++, id_of(store, j), data, width, 1.0);
      if (j < pairs->rows)
        put_entry(entries + size * at[j]++, id_of(store, i), data, width, -1.0);
    }
}

int part_pairs_gather(const part_pairs *pairs, const part_store *store, int **count, void **entry) {
  *count = NULL;
  *entry = NULL;
  if (pairs->rows != store->local)
    return part_fail(PART_ERR_STATE, "the list has %d rows and the store %d own particles",
                     pairs->rows, store->local);
  size_t *at = NULL;
  const size_t rows = (size_t)pairs->rows;
  int status = part_allocate(rows, sizeof **count, count);
  if (status == PART_OK)
    status = part_allocate(rows, sizeof *at, &at);
  if (status == PART_OK) {
    size_t total = 0;
    count_entries(pairs, *count);
    for (size_t i = 0; i < rows; i++) {
      at[i] = total;
      total += (size_t)(*count)[i];
    }
    status = part_allocate(total, part_pairs_entry_size(pairs), entry);
  }
  if (status == PART_OK) {
    put_entries(pairs, store, at, (unsigned char *)*entry);
  } else {
    free(*count);
    *count = NULL;
  }
  free(at);
  return status;
}

static int by_id(const void *a, const void *b) {
  int64_t x, y;
  memcpy(&x, a, sizeof x);
  memcpy(&y, b, sizeof y);
  return (x > y) - (x < y);
}

/* Data of the pairs of row i from its n entries. Short rows are searched straight through, long
 * ones (a large sphere among small ones) by bisection in a sorted copy. */
static int scatter_row(part_pairs *pairs, const part_store *store, int i, int n,
                       const unsigned char *entries) {
  const size_t size = part_pairs_entry_size(pairs), data = size - sizeof(int64_t);
  unsigned char *sorted = NULL;
  if (n > 16) {
    PART_TRY(part_allocate((size_t)n, size, &sorted));
    memcpy(sorted, entries, (size_t)n * size);
    qsort(sorted, (size_t)n, size, by_id);
  }
  for (int k = pairs->start[i]; n > 0 && k < pairs->start[i + 1]; k++) {
    const int64_t id = id_of(store, pairs->partner[k]);
    const unsigned char *found = NULL;
    if (sorted != NULL)
      found = (const unsigned char *)bsearch(&id, sorted, (size_t)n, size, by_id);
    for (int e = 0; sorted == NULL && found == NULL && e < n; e++)
      if (by_id(&id, entries + (size_t)e * size) == 0)
        found = entries + (size_t)e * size;
    if (found != NULL && data > 0)
      memcpy(pairs->data + (size_t)k * (size_t)pairs->data_width, found + sizeof id, data);
  }
  free(sorted);
  return PART_OK;
}

int part_pairs_scatter(part_pairs *pairs, const part_store *store, const int *count,
                       const void *entry) {
  const unsigned char *entries = (const unsigned char *)entry;
  const size_t size = part_pairs_entry_size(pairs);
  if (pairs->rows != store->local)
    return part_fail(PART_ERR_STATE, "the list has %d rows and the store %d own particles",
                     pairs->rows, store->local);
  for (int i = 0; i < pairs->rows; i++) {
    PART_TRY(scatter_row(pairs, store, i, count[i], entries));
    entries += (size_t)count[i] * size;
  }
  return PART_OK;
}
