/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Walls as they are given, and the list of elements near each particle. */
#include "internal.h"

void dem_walls_free(dem_walls *walls) {
  free(walls->wall);
  free(walls->element);
  free(walls->bins.start);
  free(walls->bins.item);
  free(walls->particle);
  free(walls->start);
  free(walls->near);
  free(walls->scratch);
}

static int add_wall(dem_t *dem, const char *name, int material, int count, dem_element **element) {
  dem_walls *walls = &dem->walls;
  if (dem->started)
    return part_fail(PART_ERR_STATE, "walls are added before dem_start");
  if (name == NULL || name[0] == '\0' || strlen(name) >= sizeof walls->wall->name)
    return part_fail(PART_ERR_ARGUMENT, "a wall needs a name of 1 to 255 characters");
  for (int w = 0; w < walls->count; w++)
    if (strcmp(walls->wall[w].name, name) == 0)
      return part_fail(PART_ERR_ARGUMENT, "wall %s is given twice", name);
  if (material < 0 || material >= dem->materials)
    return part_fail(PART_ERR_RANGE, "wall %s: material %d is not one of 0 to %d", name, material,
                     dem->materials - 1);
  PART_TRY(dem_grow((size_t)walls->count + 1, sizeof *walls->wall, &walls->capacity, &walls->wall));
  PART_TRY(dem_grow(walls->elements + (size_t)count, sizeof *walls->element,
                    &walls->element_capacity, &walls->element));
  dem_wall *wall = &walls->wall[walls->count];
  memset(wall, 0, sizeof *wall);
  strcpy(wall->name, name);
  wall->material = material;
  wall->first = (int)walls->elements;
  wall->count = count;
  *element = &walls->element[walls->elements];
  for (int k = 0; k < count; k++)
    (*element)[k] = (dem_element){.wall = walls->count, .material = material};
  return PART_OK;
}

int dem_add_plane(dem_t *dem, const char *name, int material, const double point[3],
                  const double normal[3]) {
  dem_element *e;
  const double length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
  if (!(length > 0.0) || !isfinite(length) || !isfinite(point[0] + point[1] + point[2]))
    return part_fail(PART_ERR_RANGE, "plane %s: point must be finite, normal not zero", name);
  for (int c = 0; c < 3; c++)
    if (dem->box.periodic[c] && fabs(normal[c]) > 1e-12 * length)
      return part_fail(PART_ERR_RANGE,
                       "plane %s: its normal has a component along %c, in which the domain is "
                       "periodic",
                       name, "xyz"[c]);
  if (dem->shape.flat && normal[2] != 0.0)
    return part_fail(PART_ERR_RANGE,
                     "plane %s: its normal has a z component; with dimensions 2 walls stand on the "
                     "plane of the particles",
                     name);
  PART_TRY(add_wall(dem, name, material, 1, &e));
  e->plane = 1;
  for (int c = 0; c < 3; c++) {
    e->a[c] = point[c];
    e->n[c] = normal[c] / length;
  }
  dem->walls.elements++;
  dem->walls.count++;
  return PART_OK;
}

/* Corners and unit normal; ERR_RANGE for a triangle without area. */
static int set_triangle(dem_element *e, const char *name, int k, const double *v) {
  double ab[3], ac[3], longest = 0.0;
  memcpy(e->a, v, sizeof e->a);
  memcpy(e->b, v + 3, sizeof e->b);
  memcpy(e->c, v + 6, sizeof e->c);
  for (int c = 0; c < 3; c++) {
    ab[c] = e->b[c] - e->a[c];
    ac[c] = e->c[c] - e->a[c];
    longest = fmax(longest, fmax(fabs(ab[c]), fabs(ac[c])));
  }
  const double n[3] = {ab[1] * ac[2] - ab[2] * ac[1], ab[2] * ac[0] - ab[0] * ac[2],
                       ab[0] * ac[1] - ab[1] * ac[0]};
  const double area = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  if (!(area > 1e-12 * longest * longest) || !isfinite(area))
    return part_fail(PART_ERR_RANGE,
                     "wall %s: triangle %d at (%g %g %g) m has no area or is not finite", name, k,
                     v[0], v[1], v[2]);
  for (int c = 0; c < 3; c++)
    e->n[c] = n[c] / area;
  return PART_OK;
}

/* In two dimensions: triangles parallel to the plane only bound the depth and are left out; others
 * must be at right angles to it. Single precision of STL files is allowed for. */
static int stand_up(const char *name, dem_element *e, int count, int *kept) {
  *kept = 0;
  for (int k = 0; k < count; k++) {
    if (fabs(e[k].n[2]) > 1.0 - 1e-6)
      continue;
    if (fabs(e[k].n[2]) > 1e-5)
      return part_fail(PART_ERR_RANGE,
                       "wall %s: triangle %d at (%g %g %g) m is inclined to the plane of the "
                       "particles; with dimensions 2 walls stand on it",
                       name, k, e[k].a[0], e[k].a[1], e[k].a[2]);
    e[(*kept)++] = e[k];
  }
  if (*kept == 0)
    return part_fail(PART_ERR_RANGE,
                     "wall %s: no triangle stands on the plane of the particles (dimensions 2)",
                     name);
  return PART_OK;
}

int dem_add_triangles(dem_t *dem, const char *name, int material, int count,
                      const double *vertices) {
  dem_element *e;
  if (count < 1)
    return part_fail(PART_ERR_RANGE, "wall %s has no triangles", name);
  PART_TRY(add_wall(dem, name, material, count, &e));
  for (int k = 0; k < count; k++)
    PART_TRY(set_triangle(&e[k], name, k, vertices + 9 * (size_t)k));
  if (dem->shape.flat)
    PART_TRY(stand_up(name, e, count, &count));
  dem->walls.wall[dem->walls.count].count = count;
  dem->walls.elements += (size_t)count;
  dem->walls.count++;
  return PART_OK;
}

static int add_near(dem_walls *walls, size_t *used, int element, int shift) {
  PART_TRY(dem_grow(*used + 1, sizeof *walls->near, &walls->near_capacity, &walls->near));
  walls->near[(*used)++] = (dem_near){.element = element, .shift = shift};
  return PART_OK;
}

/* Elements within r + skin of x, seen with one shift; planes with no shift only. */
static int near_elements(dem_t *dem, const double x[3], double reach, int shift, size_t *used) {
  dem_walls *walls = &dem->walls;
  double p[3], n[3], distance;
  if (shift == DEM_NO_SHIFT)
    for (int w = 0; w < walls->count; w++) {
      const int first = walls->wall[w].first;
      if (!walls->element[first].plane)
        continue;
      dem_element_nearest(&walls->element[first], x, p, n, &distance);
      if (distance < reach)
        PART_TRY(add_near(walls, used, first, shift));
    }
  const int bin = dem_bins_find(&walls->bins, x);
  for (int k = bin < 0 ? 0 : walls->bins.start[bin]; bin >= 0 && k < walls->bins.start[bin + 1];
       k++) {
    dem_element_nearest(&walls->element[walls->bins.item[k]], x, p, n, &distance);
    if (distance < reach)
      PART_TRY(add_near(walls, used, walls->bins.item[k], shift));
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
    const int64_t m = (-1 - entry[k].key) / 2;
    const int element = (int)(m / DEM_SHIFTS), shift = (int)(m % DEM_SHIFTS);
    size_t at = first;
    while (at < *used && (walls->near[at].element != element || walls->near[at].shift != shift))
      at++;
    if (at == *used)
      PART_TRY(add_near(walls, used, element, shift));
    memcpy((-1 - entry[k].key) % 2 == 0 ? walls->near[at].spring : walls->near[at].n,
           entry[k].value, sizeof entry[k].value);
  }
  return PART_OK;
}

static int list_particle(dem_t *dem, int i, size_t *used) {
  const double *x = dem_xr(dem) + DEM_XR * (size_t)i;
  const double length[3] = {dem->box.hi[0] - dem->box.lo[0], dem->box.hi[1] - dem->box.lo[1],
                            dem->box.hi[2] - dem->box.lo[2]};
  for (int shift = 0; shift < DEM_SHIFTS; shift++) {
    const int s[3] = {shift % 3 - 1, shift / 3 % 3 - 1, shift / 9 - 1};
    double seen[3];
    if ((s[0] && !dem->box.periodic[0]) || (s[1] && !dem->box.periodic[1]) ||
        (s[2] && !dem->box.periodic[2]))
      continue;
    dem_shift_position(length, shift, x, seen);
    PART_TRY(near_elements(dem, seen, x[3] + dem->skin, shift, used));
  }
  return PART_OK;
}

int dem_walls_list(dem_t *dem, const int *count, const void *payload) {
  dem_walls *walls = &dem->walls;
  const dem_entry *entry = payload;
  size_t used = 0, longest = 0;
  walls->rows = 0;
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
    longest = used - first > longest ? used - first : longest;
  }
  return dem_grow(longest, sizeof *walls->scratch, &walls->scratch_capacity, &walls->scratch);
}

int dem_walls_check(dem_t *dem) {
  const dem_walls *walls = &dem->walls;
  for (int row = 0; row < walls->rows; row++) {
    const int i = walls->particle[row];
    const double *x = dem_xr(dem) + DEM_XR * (size_t)i;
    for (int k = walls->start[row]; k < walls->start[row + 1]; k++) {
      const dem_element *e = &walls->element[walls->near[k].element];
      double p[3], n[3], distance, seen[3];
      const double length[3] = {dem->box.hi[0] - dem->box.lo[0], dem->box.hi[1] - dem->box.lo[1],
                                dem->box.hi[2] - dem->box.lo[2]};
      dem_shift_position(length, walls->near[k].shift, x, seen);
      dem_element_nearest(e, seen, p, n, &distance);
      if (x[3] - distance > dem->params.max_overlap * x[3])
        return part_fail(PART_ERR_OVERLAP,
                         "particle %lld at (%g %g %g) m overlaps wall %s by %g m; allowed is "
                         "maxOverlap = %g of its radius",
                         (long long)dem_id(dem, i), x[0], x[1], x[2], walls->wall[e->wall].name,
                         x[3] - distance, dem->params.max_overlap);
    }
  }
  return PART_OK;
}

/* ---- history of wall contacts in the payload -------------------------------------------------- */
static int wall_entries(const dem_near *near) {
  return near->n[0] != 0.0 || near->n[1] != 0.0 || near->n[2] != 0.0 ? 2 : 0;
}

static int walls_active(const dem_t *dem) {
  return dem->plan.tangential && dem->plan.walls;
}

static void count_walls(const dem_t *dem, int *count) {
  const dem_walls *walls = &dem->walls;
  for (int row = 0; row < walls->rows; row++)
    for (int k = walls->start[row]; k < walls->start[row + 1]; k++)
      count[walls->particle[row]] += wall_entries(&walls->near[k]);
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
    if (wall_entries(near) == 0)
      continue;
    entry->key = -1 - 2 * m;
    memcpy(entry++->value, near->spring, sizeof near->spring);
    entry->key = -2 - 2 * m;
    memcpy(entry++->value, near->n, sizeof near->n);
  }
  return entry;
}

const dem_carrier dem_walls_carrier = {walls_active, count_walls, put_walls};
