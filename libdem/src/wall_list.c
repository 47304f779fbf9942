/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The list of elements near each particle, and history of wall contacts in the payload. */
#include "internal.h"

static int add_near(dem_walls *walls, size_t *used, int element, int shift) {
  PART_TRY(dem_grow(*used + 1, sizeof *walls->near, &walls->near_capacity, &walls->near));
  walls->near[(*used)++] = (dem_near){.element = element, .shift = shift};
  return PART_OK;
}

/* Does the box have this shift? */
static int box_has(const dem_t *dem, int shift) {
  const int *periodic = dem->box.periodic;
  const int s[3] = {shift % 3 - 1, shift / 3 % 3 - 1, shift / 9 - 1};
  return (s[0] == 0 || periodic[0]) && (s[1] == 0 || periodic[1]) && (s[2] == 0 || periodic[2]);
}

/* Is an element seen again with this shift? What has no end along it is not. */
static int seen_again(const dem_element *e, int shift) {
  const int s[3] = {shift % 3 - 1, shift / 3 % 3 - 1, shift / 9 - 1};
  if (shift == DEM_NO_SHIFT)
    return 1;
  if (e->shape == DEM_SHAPE_PLANE)
    return 0;
  for (int c = 0; c < 3; c++)
    if (s[c] != 0 && e->length == 0.0 && fabs(e->n[c]) > 1e-12)
      return 0;
  return 1;
}

/* Distance of a plane or cylinder, or of the nearest image of it. */
double dem_wall_gap(const dem_t *dem, int element, const double x[3]) {
  double least = HUGE_VAL, p[3], n[3], distance;
  for (int shift = 0; shift < DEM_SHIFTS; shift++) {
    if (!box_has(dem, shift) || !seen_again(&dem->walls.element[element], shift))
      continue;
    dem_wall_nearest(dem, element, shift, x, p, n, &distance);
    least = fmin(least, distance);
  }
  return least;
}

/* Elements within reach of x, seen with one shift. */
static int near_elements(dem_t *dem, const double x[3], double reach, int shift, size_t *used) {
  dem_walls *walls = &dem->walls;
  double p[3], n[3], distance, seen[3];
  for (int w = 0; w < walls->count; w++) {
    const int first = walls->wall[w].first;
    const dem_element *e = &walls->element[first];
    if (e->shape == DEM_SHAPE_TRIANGLE || !seen_again(e, shift))
      continue;
    dem_wall_nearest(dem, first, shift, x, p, n, &distance);
    if (distance < reach)
      PART_TRY(add_near(walls, used, first, shift));
  }
  for (int g = 0; g < walls->groups; g++) {
    const dem_bins *bins = &walls->bins[g];
    dem_wall_see(dem, &walls->wall[bins->wall], shift, x, seen);
    const int bin = dem_bins_find(bins, seen);
    for (int k = bin < 0 ? 0 : bins->start[bin]; bin >= 0 && k < bins->start[bin + 1]; k++) {
      dem_element_nearest(&walls->element[bins->item[k]], seen, p, n, &distance);
      if (distance < reach)
        PART_TRY(add_near(walls, used, bins->item[k], shift));
    }
  }
  return PART_OK;
}

/* Put history back; what is not near any more stays listed, so that a neighbour may take it over.
 */
static int restore(dem_walls *walls, size_t first, size_t *used, int count,
                   const dem_entry *entry) {
  for (int k = 0; k < count; k++) {
    if (entry[k].key >= 0)
      continue;
    const int64_t m = (-1 - entry[k].key) / 3;
    const int part = (int)((-1 - entry[k].key) % 3);
    const int element = (int)(m / DEM_SHIFTS), shift = (int)(m % DEM_SHIFTS);
    size_t at = first;
    while (at < *used && (walls->near[at].element != element || walls->near[at].shift != shift))
      at++;
    if (at == *used)
      PART_TRY(add_near(walls, used, element, shift));
    dem_near *near = &walls->near[at];
    memcpy(part == 0   ? near->spring
           : part == 1 ? near->n
                       : near->roll,
           entry[k].value, sizeof entry[k].value);
  }
  return PART_OK;
}

static int list_particle(dem_t *dem, int i, size_t *used) {
  const double *x = dem_xr(dem) + DEM_XR * (size_t)i;
  const double reach = x[3] + dem->skin + dem->walls.margin;
  for (int shift = 0; shift < DEM_SHIFTS; shift++)
    if (box_has(dem, shift))
      PART_TRY(near_elements(dem, x, reach, shift, used));
  return PART_OK;
}

int dem_walls_list(dem_t *dem, const int *count, const void *payload) {
  dem_walls *walls = &dem->walls;
  const dem_entry *entry = payload;
  size_t used = 0, longest = 0;
  walls->margin = walls->moving ? dem->skin : 0.0;
  walls->rows = 0;
  dem_walls_listed(dem);
  for (int i = 0; i < dem->store->local; i++) {
    const size_t first = used;
    if (dem_kind_of(dem, i) != DEM_FIXED)
      PART_TRY(list_particle(dem, i, &used));
    if (entry != NULL) {
      PART_TRY(restore(walls, first, &used, count[i], entry));
      entry += count[i];
    }
    if (used == first)
      continue;
    const size_t row = (size_t)walls->rows++;
    PART_TRY(dem_grow(row + 1, sizeof *walls->particle, &walls->row_capacity, &walls->particle));
    PART_TRY(dem_grow(row + 2, sizeof *walls->start, &walls->start_capacity, &walls->start));
    walls->particle[row] = i;
    walls->start[row] = (int)first;
    walls->start[row + 1] = (int)used;
    PART_TRY(
        dem_grow(4 * (row + 1), sizeof *walls->checked, &walls->checked_capacity, &walls->checked));
    walls->checked[4 * row + 3] = -1.0;
    longest = used - first > longest ? used - first : longest;
  }
  return dem_grow(longest, sizeof *walls->scratch, &walls->scratch_capacity, &walls->scratch);
}

int dem_walls_relist(dem_t *dem) {
  const int n = dem->store->local;
  const double travel = dem->travel;
  int *count = NULL;
  dem_entry *entries = NULL;
  int status = PART_OK;
  if (dem_walls_carrier.active(dem)) {
    size_t total = 0;
    status = dem_allocate((size_t)n, sizeof *count, &count);
    if (status == PART_OK)
      dem_walls_carrier.count(dem, count);
    for (int i = 0; status == PART_OK && i < n; i++)
      total += (size_t)count[i];
    if (status == PART_OK)
      status = dem_allocate(total, sizeof *entries, &entries);
    dem_entry *to = entries;
    for (int i = 0; status == PART_OK && i < n; i++)
      to = dem_walls_carrier.put(dem, i, to);
  }
  if (status == PART_OK)
    status = dem_walls_list(dem, count, entries);
  dem->walls.particle_travel = travel;
  free(count);
  free(entries);
  return status;
}

int dem_walls_check(dem_t *dem) {
  const dem_walls *walls = &dem->walls;
  for (int row = 0; row < walls->rows; row++) {
    const int i = walls->particle[row];
    const double *x = dem_xr(dem) + DEM_XR * (size_t)i;
    for (int k = walls->start[row]; k < walls->start[row + 1]; k++) {
      const dem_near *near = &walls->near[k];
      double p[3], n[3], distance;
      dem_wall_nearest(dem, near->element, near->shift, x, p, n, &distance);
      if (x[3] - distance > dem->params.max_overlap * x[3])
        return part_fail(PART_ERR_OVERLAP,
                         "particle %lld at (%g %g %g) m overlaps wall %s by %g m; allowed is "
                         "maxOverlap = %g of its radius",
                         (long long)dem_id(dem, i), x[0], x[1], x[2],
                         walls->wall[walls->element[near->element].wall].name, x[3] - distance,
                         dem->params.max_overlap);
    }
  }
  return PART_OK;
}

/* ---- history of wall contacts in the payload --------------------------------------------------
 */
static int wall_entries(const dem_t *dem, const dem_near *near) {
  const int active = near->n[0] != 0.0 || near->n[1] != 0.0 || near->n[2] != 0.0;
  return !active ? 0 : dem->plan.rolling ? 3 : 2;
}

static int walls_active(const dem_t *dem) {
  return (dem->plan.tangential || dem->wear.impact_asked) && dem->plan.walls;
}

static void count_walls(const dem_t *dem, int *count) {
  const dem_walls *walls = &dem->walls;
  for (int row = 0; row < walls->rows; row++)
    for (int k = walls->start[row]; k < walls->start[row + 1]; k++)
      count[walls->particle[row]] += wall_entries(dem, &walls->near[k]);
}

/* Row of own particle i, -1: none; rows are in the order of particles. */
static int row_of(const dem_walls *walls, int i) {
  int low = 0, high = walls->rows;
  while (low < high) {
    const int middle = low + (high - low) / 2;
    if (walls->particle[middle] < i)
      low = middle + 1;
    else
      high = middle;
  }
  return low < walls->rows && walls->particle[low] == i ? low : -1;
}

static dem_entry *put_walls(const dem_t *dem, int i, dem_entry *entry) {
  const dem_walls *walls = &dem->walls;
  const int row = row_of(walls, i);
  for (int k = row < 0 ? 0 : walls->start[row]; row >= 0 && k < walls->start[row + 1]; k++) {
    const dem_near *near = &walls->near[k];
    const int64_t m = (int64_t)near->element * DEM_SHIFTS + near->shift;
    const int entries = wall_entries(dem, near);
    const double *value[3] = {near->spring, near->n, near->roll};
    for (int part = 0; part < entries; part++) {
      entry->key = -1 - part - 3 * m;
      memcpy(entry++->value, value[part], sizeof entry->value);
    }
  }
  return entry;
}

const dem_carrier dem_walls_carrier = {walls_active, count_walls, put_walls};
