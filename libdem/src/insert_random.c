/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random insertion: one sphere after the other at a place that is free (random sequential
 * addition). Every rank draws the same sequence. */
#include "internal.h"

enum { TRIES = 20000 }; /* per sphere, before the fraction is called out of reach */

/* SplitMix64 (Steele, Lea and Flood 2014): next number of the sequence in [0, 1). */
double dem_draw(uint64_t *state) {
  uint64_t z = *state += UINT64_C(0x9e3779b97f4a7c15);
  z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
  z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
  return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

/* Volume (m3, area m2 in two dimensions) of all, on average over the sizes. */
static double all_volume(const dem_insert *insert, double d_max, int flat) {
  const double pi = 3.14159265358979323846, n = (double)insert->number;
  /* means of d^2 and d^3 over [a, b]: (a^2 + a b + b^2)/3 and (a + b)(a^2 + b^2)/4 */
  const double a = insert->diameter, b = d_max;
  return flat ? n * pi / 12.0 * (a * a + a * b + b * b) : n * pi / 24.0 * (a + b) * (a * a + b * b);
}

static double region(const dem_insert *insert, int flat) {
  return insert->extent[0] * insert->extent[1] * (flat ? 1.0 : insert->extent[2]);
}

static int check(const dem_insert *insert, double d_max, int flat) {
  const char *table = dem_insert_table.name;
  const int directions = flat ? 2 : 3;
  if (insert->number < 1)
    return part_fail(PART_ERR_RANGE, "%s: entry number: zero particles requested", table);
  if (!(insert->diameter > 0.0))
    return part_fail(PART_ERR_RANGE, "%s: entry diameter: %g m is not allowed; must be positive",
                     table, insert->diameter);
  if (d_max < insert->diameter)
    return part_fail(PART_ERR_RANGE, "%s: entry diameterMax: %g m is below diameter %g m", table,
                     d_max, insert->diameter);
  if (flat && insert->extent[2] != 0.0)
    return part_fail(PART_ERR_RANGE, "%s: entry extent: %g m in z; must be 0 with dimensions 2",
                     table, insert->extent[2]);
  for (int c = 0; c < directions; c++)
    if (insert->extent[c] < d_max)
      return part_fail(PART_ERR_RANGE,
                       "%s: entry extent: %g m in %c does not hold a sphere of %g m", table,
                       insert->extent[c], "xyz"[c], d_max);
  const double part = all_volume(insert, d_max, flat) / region(insert, flat);
  const double most = d_max > 2.0 * insert->diameter ? 0.9 : flat ? 0.84 : 0.64;
  if (part > most)
    return part_fail(PART_ERR_RANGE,
                     "%s: entry number: %lld %s would fill %.3g of the region; random "
                     "placing reaches about %s",
                     table, (long long)insert->number, flat ? "discs" : "spheres", part,
                     flat ? "0.54, random packing 0.84" : "0.38, random packing 0.64");
  return PART_OK;
}

/* A free place for seed, or ERR_RANGE after TRIES. */
static int place(const dem_insert *insert, int flat, const dem_grid *grid, uint64_t *state,
                 dem_seed *seed) {
  double overlap;
  seed->x[2] = insert->origin[2];
  for (int t = 0; t < TRIES; t++) {
    for (int c = 0; c < (flat ? 2 : 3); c++)
      seed->x[c] =
          insert->origin[c] + seed->r + dem_draw(state) * (insert->extent[c] - 2.0 * seed->r);
    if (dem_grid_overlap(grid, seed->x, seed->r, 0.0, &overlap) < 0)
      return PART_OK;
  }
  return PART_ERR_RANGE;
}

static int larger_first(const void *a, const void *b) {
  const double *x = a, *y = b;
  return (*x < *y) - (*x > *y);
}

/* Large ones first: they find no room among the small ones, which find room between them. */
static void draw_radii(const dem_insert *insert, double d_max, uint64_t *state, double *r) {
  for (int64_t k = 0; k < insert->number; k++)
    r[k] = 0.5 * (insert->diameter + dem_draw(state) * (d_max - insert->diameter));
  if (d_max > insert->diameter)
    qsort(r, (size_t)insert->number, sizeof *r, larger_first);
}

/* How far it came, and what can be done. */
static int out_of_room(const dem_insert *insert, int flat, const dem_seed *seed, int64_t k) {
  double volume = 0.0;
  for (int64_t m = 0; m < k; m++)
    volume += 3.14159265358979323846 * seed[m].r * seed[m].r * (flat ? 1.0 : 4.0 / 3.0 * seed[m].r);
  return part_fail(PART_ERR_RANGE,
                   "%s: entry number: only %lld of %lld %s (%s fraction %.3g, largest first) found "
                   "a free place in %d tries each, the next has diameter %g m; ask for fewer or a "
                   "larger extent, and let the particles settle to a denser bed",
                   dem_insert_table.name, (long long)k, (long long)insert->number,
                   flat ? "discs" : "spheres", flat ? "area" : "volume",
                   volume / region(insert, flat), TRIES, 2.0 * seed[k].r);
}

static int fill(const dem_t *dem, const dem_insert *insert, double d_max, dem_grid *grid, double *r,
                dem_seed *seed) {
  uint64_t state = (uint64_t)insert->seed;
  const int flat = dem->shape.flat;
  for (int64_t k = 0; k < dem->seeds; k++)
    PART_TRY(dem_grid_add(grid, dem->seed[k].x, dem->seed[k].r));
  draw_radii(insert, d_max, &state, r);
  for (int64_t k = 0; k < insert->number; k++) {
    seed[k].r = r[k];
    memcpy(seed[k].v, insert->velocity, sizeof seed[k].v);
    if (place(insert, flat, grid, &state, &seed[k]) != PART_OK)
      return out_of_room(insert, flat, seed, k);
    PART_TRY(dem_grid_add(grid, seed[k].x, seed[k].r));
  }
  return PART_OK;
}

int dem_insert_random(const dem_t *dem, const dem_insert *insert, dem_seed **seed, int64_t *count) {
  const double d_max = insert->diameter_max > 0.0 ? insert->diameter_max : insert->diameter;
  double r_min = 0.5 * insert->diameter, r_max = 0.5 * d_max, *r;
  dem_grid *grid = NULL;
  PART_TRY(check(insert, d_max, dem->shape.flat));
  for (int64_t k = 0; k < dem->seeds; k++) {
    r_min = fmin(r_min, dem->seed[k].r);
    r_max = fmax(r_max, dem->seed[k].r);
  }
  PART_TRY(dem_allocate((size_t)insert->number, sizeof **seed, seed));
  PART_TRY(dem_allocate((size_t)insert->number, sizeof *r, &r));
  int status = dem_grid_create(&dem->box, r_min, r_max, dem->seeds + insert->number, &grid);
  if (status == PART_OK)
    status = fill(dem, insert, d_max, grid, r, *seed);
  dem_grid_destroy(grid);
  free(r);
  *count = insert->number;
  return status;
}
