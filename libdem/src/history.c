/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What particles carry along when they are sorted, migrate or are written: the payload. Entries of
 * pairs are those of part_pairs_gather; the others come from the carriers. */
#include "internal.h"

static const dem_carrier *const carriers[] = {&dem_walls_carrier, &dem_bonds_carrier,
                                              &dem_clumps_carrier};
enum { CARRIERS = sizeof carriers / sizeof carriers[0] };

int dem_history_needed(const dem_t *dem) {
  int needed = dem->plan.tangential;
  for (int k = 0; k < CARRIERS && !needed; k++)
    needed = carriers[k]->active(dem);
  return needed;
}

static int by_key(const void *a, const void *b) {
  const dem_entry *x = a, *y = b;
  return (x->key > y->key) - (x->key < y->key);
}

static void sort_entries(dem_entry *entry, ptrdiff_t n) {
  if (n > 32)
    qsort(entry, (size_t)n, sizeof *entry, by_key);
  for (ptrdiff_t k = 1; n <= 32 && k < n; k++) {
    const dem_entry one = entry[k];
    ptrdiff_t at = k;
    for (; at > 0 && entry[at - 1].key > one.key; at--)
      entry[at] = entry[at - 1];
    entry[at] = one;
  }
}

/* Join the entries of pairs (NULL: none) and of the carriers, particle by particle, sorted by key
 * so that nothing depends on the order of rows. */
static int join(const dem_t *dem, const int *pair_count, const dem_entry *pair, int *count,
                dem_entry **entries) {
  const int n = dem->store->local;
  size_t total = 0;
  for (int k = 0; k < CARRIERS; k++)
    if (carriers[k]->active(dem))
      carriers[k]->count(dem, count);
  for (int i = 0; i < n; i++) {
    count[i] += pair_count != NULL ? pair_count[i] : 0;
    total += (size_t)count[i];
  }
  PART_TRY(dem_allocate(total, sizeof **entries, entries));
  dem_entry *to = *entries;
  for (int i = 0; i < n; i++) {
    dem_entry *first = to;
    if (pair_count != NULL) {
      memcpy(to, pair, (size_t)pair_count[i] * sizeof *to);
      to += pair_count[i];
      pair += pair_count[i];
    }
    for (int k = 0; k < CARRIERS; k++)
      if (carriers[k]->active(dem))
        to = carriers[k]->put(dem, i, to);
    sort_entries(first, to - first);
  }
  return PART_OK;
}

int dem_history_gather(const dem_t *dem, int **count, void **payload) {
  int *pair_count = NULL, status = PART_OK;
  void *pair = NULL;
  dem_entry *entries = NULL;
  *count = NULL;
  *payload = NULL;
  if (dem->pairs != NULL && dem->pairs->data_width > 0 && dem->pairs->rows == dem->store->local) {
    dem_fast_return(dem);
    status = part_pairs_gather(dem->pairs, dem->store, &pair_count, &pair);
  }
  if (status == PART_OK)
    status = dem_allocate((size_t)dem->store->local, sizeof **count, count);
  if (status == PART_OK)
    status = join(dem, pair_count, pair, *count, &entries);
  *payload = entries;
  free(pair_count);
  free(pair);
  return status;
}

/* Entries in the order of the particles after the sort; first[i]: those of old particle i. */
static void reorder(int n, const int *order, const size_t *first, const dem_entry *old, int *count,
                    dem_entry *entry) {
  for (int i = 0; i < n; i++) {
    const size_t from = first[order[i]], to = first[order[i] + 1];
    count[i] = (int)(to - from);
    for (size_t k = from; k < to; k++)
      *entry++ = old[k];
  }
}

int dem_history_sort(dem_t *dem, int *count, void *payload) {
  const int n = dem->store->local;
  int *order = NULL;
  size_t *first = NULL;
  dem_entry *copy = NULL;
  int status = dem_allocate((size_t)n, sizeof *order, &order);
  if (status == PART_OK)
    status = dem_allocate((size_t)n + 1, sizeof *first, &first);
  for (int i = 0; status == PART_OK && i < n; i++)
    first[i + 1] = first[i] + (size_t)count[i];
  if (status == PART_OK)
    status = dem_allocate(first[n], sizeof *copy, &copy);
  if (status == PART_OK)
    status =
        part_sort_order(dem->store, &dem->box, DEM_FIELD_RADIUS, &dem->levels, dem->skin, order);
  if (status == PART_OK)
    status = part_store_permute(dem->store, order);
  if (status == PART_OK) {
    memcpy(copy, payload, first[n] * sizeof *copy);
    reorder(n, order, first, copy, count, payload);
  }
  free(order);
  free(first);
  free(copy);
  return status;
}
