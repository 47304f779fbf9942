/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "records.h"

#include <string.h>

void part_records_flagged(const part_layout *layout, unsigned flag, unsigned char *take) {
  memset(take, 0, PART_RECORDS_MAX);
  for (int f = 0; f < layout->field_count; f++)
    if (layout->fields[f].flags & flag)
      take[layout->fields[f].record] = 1;
}

static size_t width_bytes(const part_layout *layout, int record) {
  return (size_t)layout->records[record].width * 8;
}

size_t part_records_size(const part_layout *layout, const unsigned char *take) {
  size_t size = 0;
  for (int r = 0; r < layout->record_count; r++)
    if (take[r])
      size += width_bytes(layout, r);
  return size;
}

void part_records_pack(const part_store *store, const unsigned char *take, int n, const int *index,
                       void *buffer) {
  const part_layout *layout = store->layout;
  const size_t item = part_records_size(layout, take);
  size_t offset = 0;
  for (int r = 0; r < layout->record_count; r++) {
    if (!take[r])
      continue;
    const size_t bytes = width_bytes(layout, r);
    const unsigned char *from = (const unsigned char *)store->record[r];
    unsigned char *to = (unsigned char *)buffer + offset;
    for (int k = 0; k < n; k++, to += item)
      memcpy(to, from + (size_t)(index != NULL ? index[k] : k) * bytes, bytes);
    offset += bytes;
  }
}

void part_records_unpack(part_store *store, const unsigned char *take, int first, int n,
                         const void *buffer) {
  const part_layout *layout = store->layout;
  const size_t item = part_records_size(layout, take);
  size_t offset = 0;
  for (int r = 0; r < layout->record_count; r++) {
    if (!take[r])
      continue;
    const size_t bytes = width_bytes(layout, r);
    unsigned char *to = (unsigned char *)store->record[r] + (size_t)first * bytes;
    const unsigned char *from = (const unsigned char *)buffer + offset;
    for (int k = 0; k < n; k++, to += bytes, from += item)
      memcpy(to, from, bytes);
    offset += bytes;
  }
}

void part_records_zero(part_store *store, int first, int n) {
  for (int r = 0; r < store->layout->record_count; r++) {
    const size_t bytes = width_bytes(store->layout, r);
    memset((unsigned char *)store->record[r] + (size_t)first * bytes, 0, (size_t)n * bytes);
  }
}
