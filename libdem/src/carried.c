/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Vectors that particles carry for others (dem_carry): in the payload they are sorted, migrate, are
 * written and read; between rebuilds they are an array in the order of the own particles. */
#include "internal.h"

int dem_carry(dem_t *dem, int vectors) {
  if (dem->started)
    return part_fail(PART_ERR_STATE, "dem_carry: call it before dem_start or dem_read");
  if (vectors < 0 || vectors > 1000)
    return part_fail(PART_ERR_RANGE, "dem_carry: %d vectors; 0 to 1000", vectors);
  dem->carried.vectors = vectors;
  return PART_OK;
}

double *dem_carried(dem_t *dem) {
  return dem->carried.value;
}

static int carried_active(const dem_t *dem) {
  return dem->carried.vectors > 0;
}

static void count_carried(const dem_t *dem, int *count) {
  for (int i = 0; dem->carried.value != NULL && i < dem->carried.count; i++)
    count[i] += dem->carried.vectors;
}

static dem_entry *put_carried(const dem_t *dem, int i, dem_entry *to) {
  const int vectors = dem->carried.vectors;
  if (dem->carried.value == NULL || i >= dem->carried.count)
    return to; /* inserted since: zeros need no entry */
  const double *from = dem->carried.value + 3 * (size_t)vectors * (size_t)i;
  for (int k = 0; k < vectors; k++, to++, from += 3) {
    to->key = DEM_KEY(DEM_KEY_CARRIED, k);
    memcpy(to->value, from, sizeof to->value);
  }
  return to;
}

const dem_carrier dem_carried_carrier = {carried_active, count_carried, put_carried};

int dem_carried_list(dem_t *dem, const int *count, const void *payload) {
  const dem_entry *entry = payload;
  const size_t width = 3 * (size_t)dem->carried.vectors;
  const int n = dem->store->local;
  double *value = NULL;
  PART_TRY(dem_allocate((size_t)n * width, sizeof *value, &value));
  memset(value, 0, (size_t)n * width * sizeof *value);
  for (int i = 0; payload != NULL && i < n; i++)
    for (int k = 0; k < count[i]; k++, entry++) {
      if (entry->key < 0 || DEM_KEY_KIND(entry->key) != DEM_KEY_CARRIED)
        continue;
      const int64_t at = DEM_KEY_NUMBER(entry->key);
      if (at < dem->carried.vectors)
        memcpy(value + width * (size_t)i + 3 * (size_t)at, entry->value, sizeof entry->value);
    }
  free(dem->carried.value);
  dem->carried.value = value;
  dem->carried.count = n;
  return PART_OK;
}
