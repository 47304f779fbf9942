/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Particle storage: aligned records that grow, compact and permute together. */
#include "particle/store.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "memory.h"
#include "particle/status.h"
#include "records.h"

enum { ALIGNMENT = 64, PADDING = 16 };

static int check_field(const part_layout *layout, int f) {
  const part_field *field = &layout->fields[f];
  if (field->record < 0 || field->record >= layout->record_count)
    return part_fail(PART_ERR_ARGUMENT, "field %s: record %d does not exist", field->name,
                     field->record);
  const part_record *record = &layout->records[field->record];
  if (field->comps < 1 || field->offset < 0 || field->offset + field->comps > record->width)
    return part_fail(PART_ERR_ARGUMENT, "field %s: components %d to %d are not in record %s of %d",
                     field->name, field->offset, field->offset + field->comps - 1, record->name,
                     record->width);
  return PART_OK;
}

static int check_layout(const part_layout *layout) {
  if (layout == NULL || layout->record_count < 1 || layout->record_count > PART_RECORDS_MAX)
    return part_fail(PART_ERR_ARGUMENT, "a layout has 1 to %d records", PART_RECORDS_MAX);
  for (int r = 0; r < layout->record_count; r++)
    if (layout->records[r].width < 1)
      return part_fail(PART_ERR_ARGUMENT, "record %s: width %d", layout->records[r].name,
                       layout->records[r].width);
  if (layout->records[0].type != PART_DOUBLE || layout->records[0].width < 3)
    return part_fail(PART_ERR_ARGUMENT, "record %s: the first record begins with x, y, z",
                     layout->records[0].name);
  for (int f = 0; f < layout->field_count; f++)
    PART_TRY(check_field(layout, f));
  const int id = layout->id_field;
  if (id < 0 || id >= layout->field_count || layout->fields[id].comps != 1 ||
      layout->records[layout->fields[id].record].type != PART_INT64)
    return part_fail(PART_ERR_ARGUMENT, "id_field %d is not an int64 field of one component", id);
  return PART_OK;
}

/* Bytes of one record for n particles: padded, and a multiple of the alignment for aligned_alloc.
 * 0 when it does not fit into size_t. */
static size_t record_bytes(const part_record *record, int n) {
  const size_t width = (size_t)record->width * 8;
  const size_t items = (size_t)n + PADDING;
  if (items > (SIZE_MAX - ALIGNMENT) / width)
    return 0;
  return (items * width + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
}

int part_store_create(const part_layout *layout, part_store **store) {
  *store = NULL;
  PART_TRY(check_layout(layout));
  part_store *made;
  PART_TRY(part_allocate(1, sizeof *made, &made));
  made->layout = layout;
  int status = part_allocate((size_t)layout->record_count, sizeof *made->record, &made->record);
  if (status == PART_OK)
    status = part_store_reserve(made, PADDING);
  if (status != PART_OK) {
    part_store_destroy(made);
    return status;
  }
  *store = made;
  return PART_OK;
}

void part_store_destroy(part_store *store) {
  if (store == NULL)
    return;
  for (int r = 0; store->record != NULL && r < store->layout->record_count; r++)
    free(store->record[r]);
  free(store->record);
  free(store);
}

int part_store_reserve(part_store *store, int n) {
  const part_layout *layout = store->layout;
  if (n < 0)
    return part_fail(PART_ERR_ARGUMENT, "room for %d particles", n);
  if (n <= store->capacity)
    return PART_OK;
  const int half_more = store->capacity < INT_MAX / 2 ? store->capacity + store->capacity / 2 : n;
  const int capacity = n > half_more ? n : half_more;
  void *fresh[PART_RECORDS_MAX] = {NULL};
  for (int r = 0; r < layout->record_count; r++) {
    const size_t bytes = record_bytes(&layout->records[r], capacity);
    fresh[r] = bytes > 0 ? aligned_alloc(ALIGNMENT, bytes) : NULL;
    if (fresh[r] == NULL) {
      for (int k = 0; k < r; k++)
        free(fresh[k]);
      return part_fail(PART_ERR_MEMORY, "no memory for %d particles (record %s, %d x 8 bytes each)",
                       capacity, layout->records[r].name, layout->records[r].width);
    }
  }
  const size_t used = (size_t)(store->local + store->ghost);
  for (int r = 0; r < layout->record_count; r++) {
    const size_t bytes = record_bytes(&layout->records[r], capacity);
    const size_t kept = used * (size_t)layout->records[r].width * 8;
    if (kept > 0)
      memcpy(fresh[r], store->record[r], kept);
    memset((unsigned char *)fresh[r] + kept, 0, bytes - kept);
    free(store->record[r]);
    store->record[r] = fresh[r];
  }
  store->capacity = capacity;
  return PART_OK;
}

int part_store_append(part_store *store, int n, int *first) {
  if (n < 0 || n > INT_MAX - store->local)
    return part_fail(PART_ERR_ARGUMENT, "%d more particles on %d", n, store->local);
  store->ghost = 0;
  PART_TRY(part_store_reserve(store, store->local + n));
  part_records_zero(store, store->local, n);
  if (first != NULL)
    *first = store->local;
  store->local += n;
  return PART_OK;
}

int part_store_compact(part_store *store, const unsigned char *keep) {
  int kept = 0;
  for (int r = 0; r < store->layout->record_count; r++) {
    const size_t bytes = (size_t)store->layout->records[r].width * 8;
    unsigned char *record = (unsigned char *)store->record[r];
    kept = 0;
    for (int i = 0; i < store->local; i++) {
      if (!keep[i])
        continue;
      if (kept != i)
        memcpy(record + (size_t)kept * bytes, record + (size_t)i * bytes, bytes);
      kept++;
    }
  }
  store->ghost = 0;
  store->local = kept;
  return PART_OK;
}

/* order must hold each of 0 .. n-1 once. */
static int check_order(int n, const int *order) {
  unsigned char *seen;
  PART_TRY(part_allocate((size_t)n, 1, &seen));
  int status = PART_OK;
  for (int k = 0; k < n && status == PART_OK; k++) {
    if (order[k] < 0 || order[k] >= n || seen[order[k]])
      status = part_fail(PART_ERR_ARGUMENT, "order[%d] = %d is not a permutation of 0 to %d", k,
                         order[k], n - 1);
    else
      seen[order[k]] = 1;
  }
  free(seen);
  return status;
}

int part_store_permute(part_store *store, const int *order) {
  const part_layout *layout = store->layout;
  const size_t n = (size_t)store->local;
  PART_TRY(check_order(store->local, order));
  size_t widest = 0;
  for (int r = 0; r < layout->record_count; r++)
    if ((size_t)layout->records[r].width > widest)
      widest = (size_t)layout->records[r].width;
  unsigned char *old;
  PART_TRY(part_allocate(n, widest * 8, &old));
  for (int r = 0; r < layout->record_count; r++) {
    const size_t bytes = (size_t)layout->records[r].width * 8;
    unsigned char *record = (unsigned char *)store->record[r];
    memcpy(old, record, n * bytes);
    for (size_t k = 0; k < n; k++)
      memcpy(record + k * bytes, old + (size_t)order[k] * bytes, bytes);
  }
  free(old);
  store->ghost = 0;
  return PART_OK;
}

size_t part_store_item_size(const part_store *store, unsigned flag) {
  unsigned char take[PART_RECORDS_MAX];
  part_records_flagged(store->layout, flag, take);
  return part_records_size(store->layout, take);
}

void part_store_pack(const part_store *store, unsigned flag, int n, const int *index,
                     void *buffer) {
  unsigned char take[PART_RECORDS_MAX];
  part_records_flagged(store->layout, flag, take);
  part_records_pack(store, take, n, index, buffer);
}

void part_store_unpack(part_store *store, unsigned flag, int first, int n, const void *buffer) {
  unsigned char take[PART_RECORDS_MAX];
  part_records_flagged(store->layout, flag, take);
  part_records_unpack(store, take, first, n, buffer);
}
