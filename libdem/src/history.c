/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tangential history as a payload of the particles: what sorting, migration and restart carry.
 * Entries are those of part_pairs_gather; wall contacts have negative keys (walls.h). */
#include "internal.h"

static int wall_entries(const dem_near *near) {
  return near->n[0] != 0.0 || near->n[1] != 0.0 || near->n[2] != 0.0 ? 2 : 0;
}

static void count_walls(const dem_walls *walls, int *count) {
  for (int row = 0; row < walls->rows; row++)
    for (int k = walls->start[row]; k < walls->start[row + 1]; k++)
      count[walls->particle[row]] += wall_entries(&walls->near[k]);
}

static dem_entry *put_wall(const dem_walls *walls, int row, dem_entry *entry) {
  for (int k = walls->start[row]; k < walls->start[row + 1]; k++) {
    const dem_near *near = &walls->near[k];
    const int64_t m = (int64_t)near->element * DEM_SHIFTS + near->shift;
    if (wall_entries(near) == 0)
      continue;
    entry->key = -1 - 2 * m;
    memcpy(entry++->value, near->spring, sizeof near->spring);
    entry->key = -2 - 2 * m;
    memcpy(entry++->value, near->n, sizeof near->n);
  }
  return entry;
}

static int by_key(const void *a, const void *b) {
  const dem_entry *x = a, *y = b;
  return (x->key > y->key) - (x->key < y->key);
}

/* Join the entries of pairs (NULL: none) and walls, particle by particle, sorted by key so that
 * nothing depends on the order of rows. */
static int join(const dem_t *dem, const int *pair_count, const dem_entry *pair, int *count,
                dem_entry **entries) {
  const dem_walls *walls = &dem->walls;
  const int n = dem->store->local;
  size_t total = 0;
  int row = 0;
  count_walls(walls, count);
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
    if (row < walls->rows && walls->particle[row] == i)
      to = put_wall(walls, row++, to);
    if (to - first > 1)
      qsort(first, (size_t)(to - first), sizeof *first, by_key);
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

typedef struct place {
  int64_t id;
  size_t first; /* entry */
  int count;
} place;

static int by_id(const void *a, const void *b) {
  const place *x = a, *y = b;
  return (x->id > y->id) - (x->id < y->id);
}

/* Where the entries of each particle are, sorted by id. */
static int find_places(const dem_t *dem, const int *count, place **places) {
  size_t first = 0;
  PART_TRY(dem_allocate((size_t)dem->store->local, sizeof **places, places));
  for (int i = 0; i < dem->store->local; i++) {
    (*places)[i] = (place){dem_id(dem, i), first, count[i]};
    first += (size_t)count[i];
  }
  qsort(*places, (size_t)dem->store->local, sizeof **places, by_id);
  return PART_OK;
}

int dem_history_sort(dem_t *dem, double cell, int *count, void *payload) {
  place *places = NULL;
  dem_entry *entries = payload, *copy = NULL;
  size_t total = 0;
  for (int i = 0; i < dem->store->local; i++)
    total += (size_t)count[i];
  int status = find_places(dem, count, &places);
  if (status == PART_OK)
    status = dem_allocate(total, sizeof *copy, &copy);
  if (status == PART_OK) {
    memcpy(copy, entries, total * sizeof *copy);
    status = part_sort_by_cell(dem->store, &dem->box, cell);
  }
  for (int i = 0; status == PART_OK && i < dem->store->local; i++) {
    const place key = {dem_id(dem, i), 0, 0};
    const place *found = bsearch(&key, places, (size_t)dem->store->local, sizeof *places, by_id);
    count[i] = found->count;
    memcpy(entries, copy + found->first, (size_t)found->count * sizeof *entries);
    entries += found->count;
  }
  free(places);
  free(copy);
  return status;
}
