/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Links from the payload and back, when lists are built. */
#include "internal.h"

enum { REST, RULE, SPRING, ORIENTATION = REST };

static int64_t key_of(int64_t id, int part) {
  return DEM_KEY(DEM_KEY_BOND, id * 256 + part);
}
static int is_bond(const dem_entry *entry) {
  return entry->key >= 0 && DEM_KEY_KIND(entry->key) == DEM_KEY_BOND;
}

int dem_bonds_check(const dem_t *dem, const int *count, const void *payload) {
  const dem_entry *entry = payload;
  for (int i = 0; count != NULL && i < dem->store->local; i++)
    for (int k = 0; k < count[i]; k++, entry++) {
      if (!is_bond(entry) || DEM_KEY_NUMBER(entry->key) / 256 == dem_id(dem, i))
        continue;
      if (dem->bonds.rules == 0)
        return part_fail(PART_ERR_FORMAT,
                         "the file has bonds (of particle %lld), but no rule of bonds is given",
                         (long long)dem_id(dem, i));
      if (DEM_KEY_NUMBER(entry->key) % 256 == RULE &&
          !(entry->value[0] >= 0.0 && entry->value[0] < dem->bonds.rules))
        return part_fail(PART_ERR_FORMAT,
                         "the file has bonds of rule %g (of particle %lld), but %d are given",
                         entry->value[0], (long long)dem_id(dem, i), dem->bonds.rules);
    }
  return PART_OK;
}

/* ---- orientations ---------------------------------------------------------------------------- */
static int take_orientations(dem_t *dem, const int *count, const dem_entry *entry) {
  const size_t all = (size_t)dem->store->local + (size_t)dem->store->ghost;
  free(dem->bonds.q);
  dem->bonds.q = NULL;
  PART_TRY(dem_allocate(4 * all, sizeof *dem->bonds.q, &dem->bonds.q));
  for (size_t i = 0; i < all; i++)
    dem->bonds.q[4 * i] = 1.0;
  for (int i = 0; entry != NULL && i < dem->store->local; i++)
    for (int k = 0; k < count[i]; k++, entry++) {
      double *q = dem->bonds.q + 4 * (size_t)i;
      if (entry->key == key_of(dem_id(dem, i), ORIENTATION))
        memcpy(q, entry->value, 3 * sizeof *q);
      else if (entry->key == key_of(dem_id(dem, i), ORIENTATION + 1))
        q[3] = entry->value[0];
    }
  return PART_OK;
}

int dem_bonds_orient(dem_t *dem, const int *count, const void *payload) {
  PART_TRY(part_agree(dem->comm, take_orientations(dem, count, payload)));
  const size_t width = 4 * sizeof(double);
  double *q = dem->bonds.q;
  return part_domain_copy_to_ghosts(dem->domain, dem->store, width, q,
                                    q + 4 * (size_t)dem->store->local);
}

/* ---- particles by id: a table of chains, since ghosts may be copies of the same particle --------
 */
typedef struct finder {
  size_t mask;
  int *head, *next;
} finder;

static size_t place_of(const finder *f, int64_t id) {
  return (size_t)(((uint64_t)id * UINT64_C(0x9e3779b97f4a7c15)) >> 32) & f->mask;
}

static int make_finder(const dem_t *dem, finder *f) {
  const int all = dem->store->local + dem->store->ghost;
  size_t size = 16;
  while (size < 2 * (size_t)all)
    size *= 2;
  f->mask = size - 1;
  PART_TRY(dem_allocate(size, sizeof *f->head, &f->head));
  PART_TRY(dem_allocate((size_t)all, sizeof *f->next, &f->next));
  for (int i = all - 1; i >= 0; i--) { /* indices + 1; 0 ends a chain */
    int *head = &f->head[place_of(f, dem_id(dem, i))];
    f->next[i] = *head;
    *head = i + 1;
  }
  return PART_OK;
}

/* Nearest copy of a particle to own particle i, -1: there is none here. */
static int nearest(const dem_t *dem, const finder *f, int i, int64_t id) {
  const double *x = dem_xr(dem) + DEM_XR * (size_t)i;
  double least = HUGE_VAL;
  int best = -1;
  for (int at = f->head[place_of(f, id)]; at > 0; at = f->next[at - 1]) {
    const double *y = dem_xr(dem) + DEM_XR * (size_t)(at - 1);
    const double d[3] = {y[0] - x[0], y[1] - x[1], y[2] - x[2]};
    if (dem_id(dem, at - 1) == id && dem_dot(d, d) < least) {
      least = dem_dot(d, d);
      best = at - 1;
    }
  }
  return best;
}

/* ---- links ------------------------------------------------------------------------------------
 */
static int new_link(dem_t *dem, int i, int j) {
  dem_bonds *bonds = &dem->bonds;
  const int first = dem_id(dem, i) < dem_id(dem, j) ? i : j;
  PART_TRY(
      dem_grow((size_t)bonds->links + 1, sizeof *bonds->link, &bonds->link_room, &bonds->link));
  dem_link *link = &bonds->link[bonds->links++];
  *link = (dem_link){.end = {first, first == i ? j : i}};
  return PART_OK;
}

/* Data of one bond of own particle i: its parts come one after the other. A bond of two own
 * particles is taken at its lower id. */
static int take_bond(dem_t *dem, const finder *f, int i, int parts, const dem_entry *entry) {
  const int64_t id = DEM_KEY_NUMBER(entry->key) / 256;
  const int j = nearest(dem, f, i, id);
  if (j < 0)
    return part_fail(PART_ERR_OUTSIDE,
                     "particle %lld at (%g %g %g) m is bonded to particle %lld, which is farther "
                     "away than ghosts reach",
                     (long long)dem_id(dem, i), dem_xr(dem)[DEM_XR * (size_t)i],
                     dem_xr(dem)[DEM_XR * (size_t)i + 1], dem_xr(dem)[DEM_XR * (size_t)i + 2],
                     (long long)id);
  if (j < dem->store->local && id < dem_id(dem, i))
    return PART_OK;
  PART_TRY(new_link(dem, i, j));
  dem_link *link = &dem->bonds.link[dem->bonds.links - 1];
  for (int k = 0; k < parts; k++) {
    const int part = (int)(DEM_KEY_NUMBER(entry[k].key) % 256);
    if (part == REST)
      memcpy(link->rest, entry[k].value, sizeof link->rest);
    if (part == RULE) {
      link->rule = (int)entry[k].value[0];
      link->state = (int)entry[k].value[1];
    }
    if (part == SPRING)
      memcpy(link->spring, entry[k].value, sizeof link->spring);
  }
  dem_link_coefs(dem, link);
  return PART_OK;
}

static int take_bonds(dem_t *dem, const finder *f, const int *count, const dem_entry *entry) {
  for (int i = 0; entry != NULL && i < dem->store->local; i++) {
    const dem_entry *end = entry + count[i];
    while (entry < end) {
      int parts = 1;
      const int64_t whose = entry->key >= 0 ? DEM_KEY_NUMBER(entry->key) / 256 : -1;
      while (is_bond(entry) && entry + parts < end && is_bond(entry + parts) &&
             DEM_KEY_NUMBER(entry[parts].key) / 256 == whose)
        parts++;
      if (is_bond(entry) && whose != dem_id(dem, i))
        PART_TRY(take_bond(dem, f, i, parts, entry));
      entry += parts;
    }
  }
  return PART_OK;
}

/* Which links each own particle has, and who turns. */
static int index_links(dem_t *dem) {
  dem_bonds *bonds = &dem->bonds;
  const int local = dem->store->local, all = local + dem->store->ghost;
  free(bonds->start);
  bonds->start = NULL;
  PART_TRY(dem_allocate((size_t)all + 1, sizeof *bonds->start, &bonds->start));
  for (int m = 0; m < bonds->links; m++)
    for (int k = 0; k < 2; k++)
      bonds->start[bonds->link[m].end[k] + 1]++;
  bonds->turning = 0;
  PART_TRY(dem_grow((size_t)all, sizeof *bonds->turns, &bonds->turn_room, &bonds->turns));
  for (int i = 0; i < all; i++) {
    if (bonds->start[i + 1] > 0)
      bonds->turns[bonds->turning++] = i;
    bonds->start[i + 1] += bonds->start[i];
  }
  PART_TRY(
      dem_grow((size_t)bonds->start[all], sizeof *bonds->item, &bonds->item_room, &bonds->item));
  for (int m = 0; m < bonds->links; m++)
    for (int k = 0; k < 2; k++)
      bonds->item[bonds->start[bonds->link[m].end[k]]++] = m;
  for (int i = all; i > 0; i--)
    bonds->start[i] = bonds->start[i - 1];
  bonds->start[0] = 0;
  return PART_OK;
}

int dem_bonds_list(dem_t *dem, const int *count, const void *payload) {
  finder f = {0, NULL, NULL};
  dem->bonds.links = 0;
  dem->bonds.stale = 0;
  int status = make_finder(dem, &f);
  if (status == PART_OK)
    status = take_bonds(dem, &f, count, payload);
  free(f.head);
  free(f.next);
  return status == PART_OK ? index_links(dem) : status;
}

int dem_bonds_join(const dem_t *dem, int i, int j) {
  const dem_bonds *bonds = &dem->bonds;
  const int64_t id = bonds->start[i] < bonds->start[i + 1] ? dem_id(dem, j) : -1;
  for (int k = bonds->start[i]; k < bonds->start[i + 1]; k++) {
    const dem_link *link = &bonds->link[bonds->item[k]];
    if (dem_id(dem, link->end[link->end[0] == i]) == id)
      return 1;
  }
  return 0;
}

/* ---- into the payload --------------------------------------------------------------------------
 */
static int active(const dem_t *dem) {
  return dem->plan.bonds;
}

static int entries_of(const dem_link *link) {
  return link->state == DEM_LINK_GONE ? 0 : link->state == DEM_LINK_PRESSED ? 3 : 2;
}

static void count_bonds(const dem_t *dem, int *count) {
  const dem_bonds *bonds = &dem->bonds;
  for (int i = 0; bonds->start != NULL && i < dem->store->local; i++) {
    int n = 0;
    for (int k = bonds->start[i]; k < bonds->start[i + 1]; k++)
      n += entries_of(&bonds->link[bonds->item[k]]);
    count[i] += n > 0 ? n + 2 : 0;
  }
}

static dem_entry *put_bonds(const dem_t *dem, int i, dem_entry *entry) {
  const dem_bonds *bonds = &dem->bonds;
  const dem_entry *first = entry;
  for (int k = bonds->start != NULL ? bonds->start[i] : 0;
       bonds->start != NULL && k < bonds->start[i + 1]; k++) {
    const dem_link *link = &bonds->link[bonds->item[k]];
    const int64_t id = dem_id(dem, link->end[link->end[0] == i]);
    const int n = entries_of(link);
    if (n == 0)
      continue;
    *entry = (dem_entry){.key = key_of(id, REST)};
    memcpy(entry++->value, link->rest, sizeof link->rest);
    *entry++ = (dem_entry){key_of(id, RULE), {link->rule, link->state, 0.0}};
    if (n < 3)
      continue;
    *entry = (dem_entry){.key = key_of(id, SPRING)};
    memcpy(entry++->value, link->spring, sizeof link->spring);
  }
  if (entry == first)
    return entry;
  const double *q = bonds->q + 4 * (size_t)i;
  *entry++ = (dem_entry){key_of(dem_id(dem, i), ORIENTATION), {q[0], q[1], q[2]}};
  *entry++ = (dem_entry){key_of(dem_id(dem, i), ORIENTATION + 1), {q[3], 0.0, 0.0}};
  return entry;
}

const dem_carrier dem_bonds_carrier = {active, count_bonds, put_bonds};
