/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What particles carry along when they are sorted, migrate or are written: the payload. Entries of
 * pairs are those of part_pairs_gather, each cut in two where pairs have six values; the others
 * come from the carriers. */
#include "internal.h"

static const dem_carrier *const carriers[] = {&dem_walls_carrier, &dem_bonds_carrier,
                                              &dem_clumps_carrier, &dem_carried_carrier};
enum { CARRIERS = sizeof carriers / sizeof carriers[0] };

int dem_history_needed(const dem_t *dem) {
  int needed = dem->plan.tangential;
  for (int k = 0; k < CARRIERS && !needed; k++)
    needed = carriers[k]->active(dem);
  return needed;
}

/* Entries that a pair needs. */
static int pair_entries(const dem_t *dem) {
  return dem->pairs->data_width / DEM_SPRING;
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

/* n entries of part_pairs_gather in this form; returns the end. */
static dem_entry *put_pairs(const dem_t *dem, const unsigned char *pair, int n, dem_entry *to) {
  const size_t size = part_pairs_entry_size(dem->pairs);
  for (int k = 0; k < n; k++, pair += size)
    for (int half = 0; half < pair_entries(dem); half++, to++) {
      int64_t id;
      memcpy(&id, pair, sizeof id);
      to->key = DEM_KEY(half == 0 ? DEM_KEY_PAIR : DEM_KEY_ROLL, id);
      memcpy(to->value, pair + sizeof id + (size_t)half * sizeof to->value, sizeof to->value);
    }
  return to;
}

/* Join the entries of pairs (NULL: none) and of the carriers, particle by particle, sorted by key
 * so that nothing depends on the order of rows. */
static int join(const dem_t *dem, const int *pair_count, const unsigned char *pair, int *count,
                dem_entry **entries) {
  const int n = dem->store->local;
  size_t total = 0;
  for (int k = 0; k < CARRIERS; k++)
    if (carriers[k]->active(dem))
      carriers[k]->count(dem, count);
  for (int i = 0; i < n; i++) {
    count[i] += pair_count != NULL ? pair_count[i] * pair_entries(dem) : 0;
    total += (size_t)count[i];
  }
  PART_TRY(dem_allocate(total, sizeof **entries, entries));
  dem_entry *to = *entries;
  for (int i = 0; i < n; i++) {
    dem_entry *first = to;
    if (pair_count != NULL) {
      to = put_pairs(dem, pair, pair_count[i], to);
      pair += (size_t)pair_count[i] * part_pairs_entry_size(dem->pairs);
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

/* Halves of one particle's n entries, sorted by key, put together; returns how many pairs. */
static int join_halves(const dem_entry *entry, int n, unsigned char *pair, size_t size) {
  int pairs = 0;
  for (int k = 0, roll = 0; k < n; k++) {
    if (entry[k].key < 0 || DEM_KEY_KIND(entry[k].key) != DEM_KEY_PAIR)
      continue;
    const int64_t other = DEM_KEY(DEM_KEY_ROLL, DEM_KEY_NUMBER(entry[k].key));
    while (roll < n && entry[roll].key < other)
      roll++;
    unsigned char *to = pair + size * (size_t)pairs++;
    memcpy(to, &entry[k].key, sizeof entry[k].key);
    memcpy(to + sizeof entry[k].key, entry[k].value, sizeof entry[k].value);
    if (roll < n && entry[roll].key == other)
      memcpy(to + sizeof(dem_entry), entry[roll].value, sizeof entry[roll].value);
  }
  return pairs;
}

int dem_history_scatter(dem_t *dem, const int *count, const void *payload) {
  const size_t size = part_pairs_entry_size(dem->pairs);
  const dem_entry *entry = payload;
  size_t total = 0, used = 0;
  int *pairs = NULL, status;
  unsigned char *joined = NULL;
  if (pair_entries(dem) == 1) /* keys of pairs are their ids; others are not found */
    return part_pairs_scatter(dem->pairs, dem->store, count, payload);
  for (int i = 0; i < dem->store->local; i++)
    total += (size_t)count[i];
  status = dem_allocate((size_t)dem->store->local, sizeof *pairs, &pairs);
  if (status == PART_OK)
    status = dem_allocate(total, size, &joined);
  for (int i = 0; status == PART_OK && i < dem->store->local; i++) {
    pairs[i] = join_halves(entry, count[i], joined + used * size, size);
    used += (size_t)pairs[i];
    entry += count[i];
  }
  if (status == PART_OK)
    status = part_pairs_scatter(dem->pairs, dem->store, pairs, joined);
  free(pairs);
  free(joined);
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
