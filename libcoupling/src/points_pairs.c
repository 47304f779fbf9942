/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pairs of spheres and points: points in bins, a row of points for each visit. */
#include <math.h>
#include "points_type.h"

typedef struct bin_grid {
  double lo[3], per[3]; /* m, 1/m */
  int n[3];
} bin_grid;

/* Bins about a fourth of the reach long, and no more than the points by far. */
static void make_grid(const cpl_points_t *p, bin_grid *grid) {
  const double *b = p->bounds.data + 6 * (size_t)p->rank;
  double edge = 0.25 * p->reach, bins;
  do {
    bins = 1.0;
    for (int c = 0; c < 3; c++) {
      const double cells = floor((b[3 + c] - b[c]) / edge) + 1.0;
      grid->lo[c] = b[c];
      grid->per[c] = 1.0 / edge;
      grid->n[c] = cells < 1e6 ? (int)cells : 1000000;
      bins *= cells;
    }
    edge *= 1.3;
  } while (bins > 8.0 * p->points + 64.0);
}

static int clamp_bin(double at, int n) {
  return at <= 0.0 ? 0 : at >= (double)n ? n - 1 : (int)at;
}

/* Counting sort; keeps the caller's order within a bin. */
static int sort_points(cpl_points_t *p, const cpl_fluid_points *fluid, const bin_grid *grid) {
  const size_t n = (size_t)p->points, bins = (size_t)grid->n[0] * (size_t)grid->n[1] * (size_t)grid->n[2];
  PART_TRY(CPL_RESERVE(p->bin_start, bins + 1));
  PART_TRY(CPL_RESERVE(p->bin_of, n));
  PART_TRY(CPL_RESERVE(p->order, n));
  PART_TRY(CPL_RESERVE(p->place, 3 * n));
  int *start = p->bin_start.data;
  memset(start, 0, (bins + 1) * sizeof *start);
  for (size_t a = 0; a < n; a++) {
    const double *x = points_at(fluid->position, fluid->position_stride, (int)a);
    int bin = 0;
    for (int c = 2; c >= 0; c--)
      bin = bin * grid->n[c] + clamp_bin((x[c] - grid->lo[c]) * grid->per[c], grid->n[c]);
    p->bin_of.data[a] = bin;
    start[bin + 1]++;
  }
  for (size_t b = 0; b < bins; b++)
    start[b + 1] += start[b];
  for (size_t a = n; a-- > 0;) {
    const int at = --start[p->bin_of.data[a] + 1];
    const double *x = points_at(fluid->position, fluid->position_stride, (int)a);
    p->order.data[at] = (int)a;
    memcpy(p->place.data + 3 * (size_t)at, x, 3 * sizeof *x);
  }
  /* start[b + 1] is now where bin b begins */
  memmove(start, start + 1, bins * sizeof *start);
  start[bins] = (int)n;
  return PART_OK;
}

/* Points of consecutive bins that the sphere reaches; room is there. */
static size_t add_range(cpl_points_t *p, const cpl_points_visit *v, double reach2, const double *row,
                        double share, int from, int to, size_t at) {
  int *partner = p->partner.data;
  double *weight = p->weight.data;
  for (int k = from; k < to; k++) {
    const double *x = p->place.data + 3 * (size_t)k;
    const double dx = x[0] - v->x[0], dy = x[1] - v->x[1], dz = x[2] - v->x[2];
    const double s2 = dx * dx + dy * dy + dz * dz;
    if (s2 >= reach2)
      continue;
    const double w = points_table_at(row, share, s2 * p->table.per_s2);
    if (!(w > 0.0))
      continue;
    partner[at] = p->order.data[k];
    weight[at++] = w;
  }
  return at;
}

static int add_row(cpl_points_t *p, const bin_grid *grid, const cpl_points_visit *v, size_t *at) {
  const double reach = p->kernel.support + (p->params.porosity == CPL_POINTS_EXACT ? v->radius : 0.0);
  int lo[3], hi[3];
  double share;
  const double *row = points_table_row(&p->table, v->radius, &share);
  for (int c = 0; c < 3; c++) {
    lo[c] = clamp_bin((v->x[c] - reach - grid->lo[c]) * grid->per[c], grid->n[c]);
    hi[c] = clamp_bin((v->x[c] + reach - grid->lo[c]) * grid->per[c], grid->n[c]);
  }
  for (int z = lo[2]; z <= hi[2]; z++)
    for (int y = lo[1]; y <= hi[1]; y++) {
      const int line = (z * grid->n[1] + y) * grid->n[0];
      const int from = p->bin_start.data[line + lo[0]], to = p->bin_start.data[line + hi[0] + 1];
      PART_TRY(CPL_RESERVE(p->partner, *at + (size_t)(to - from)));
      PART_TRY(CPL_RESERVE(p->weight, *at + (size_t)(to - from)));
      *at = add_range(p, v, reach * reach, row, share, from, to, *at);
    }
  return PART_OK;
}

static void add_solid(cpl_points_t *p, int k) {
  const cpl_points_visit *v = p->visit.data + k;
  const double volume = points_sphere_volume(v->radius), per_size = volume / v->diameter;
  const int sizes = points_uses_sizes(p);
  for (size_t q = p->start.data[k]; q < p->start.data[k + 1]; q++) {
    p->solid.data[p->partner.data[q]] += volume * p->weight.data[q];
    if (sizes)
      p->by_size.data[p->partner.data[q]] += per_size * p->weight.data[q];
  }
}

static int reserve(cpl_points_t *p) {
  const size_t n = (size_t)p->points;
  PART_TRY(CPL_RESERVE(p->solid, n));
  PART_TRY(CPL_RESERVE(p->start, (size_t)p->received + 1));
  memset(p->solid.data, 0, n * sizeof(double));
  if (!points_uses_sizes(p))
    return PART_OK;
  PART_TRY(CPL_RESERVE(p->by_size, n));
  memset(p->by_size.data, 0, n * sizeof(double));
  return PART_OK;
}

int points_make_pairs(cpl_points_t *p, const cpl_fluid_points *fluid) {
  bin_grid grid = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0, 0, 0}};
  size_t at = 0;
  PART_TRY(reserve(p));
  if (p->points > 0) {
    make_grid(p, &grid);
    PART_TRY(sort_points(p, fluid, &grid));
  }
  for (int k = 0; k < p->received; k++) {
    p->start.data[k] = at;
    if (p->points > 0)
      PART_TRY(add_row(p, &grid, p->visit.data + k, &at));
    p->start.data[k + 1] = at;
    add_solid(p, k);
  }
  p->start.data[p->received] = at;
  return PART_OK;
}
