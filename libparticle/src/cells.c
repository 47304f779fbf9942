/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cells.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "memory.h"
#include "particle/status.h"

/* Round-off of a cell number is below 4 x 2^-53 x CELLS_MAX_SIDE = 5e-10 of an edge; the slack of
 * ranges covers it. CELLS_EACH bounds the cells per point: a scene that fills a small part of its
 * box must not get cells much larger than its particles. */
enum { CELLS_MAX_SIDE = 1 << 20, CELLS_EACH = 8 };

static const double *place(const part_points *p, const int *index, int k) {
  return p->x + (size_t)(index != NULL ? index[k] : k) * (size_t)p->x_stride;
}

static void bounds(part_cells *cells, const part_points *p, const int *index) {
  cells->r_max = 0.0;
  for (int d = 0; d < 3; d++) {
    cells->lo[d] = cells->count > 0 ? INFINITY : 0.0;
    cells->hi[d] = cells->count > 0 ? -INFINITY : 0.0;
  }
  for (int k = 0; k < cells->count; k++) {
    const double *x = place(p, index, k);
    const double r = p->r[(size_t)(index != NULL ? index[k] : k) * (size_t)p->r_stride];
    cells->r_max = r > cells->r_max ? r : cells->r_max;
    for (int d = 0; d < 3; d++) {
      cells->lo[d] = x[d] < cells->lo[d] ? x[d] : cells->lo[d];
      cells->hi[d] = x[d] > cells->hi[d] ? x[d] : cells->hi[d];
    }
  }
}

static double sides(const double extent[3], double edge, double side[3]) {
  double product = 1.0;
  for (int d = 0; d < 3; d++) {
    side[d] = floor(extent[d] / edge) + 1.0;
    product *= side[d];
  }
  return product;
}

/* Grid: smallest allowed edge with not many more cells than points. */
static void choose_grid(part_cells *cells, double edge) {
  double extent[3], side[3], largest = 0.0;
  const double most = CELLS_EACH * (double)cells->count + 64.0;
  for (int d = 0; d < 3; d++) {
    extent[d] = cells->hi[d] - cells->lo[d];
    edge = fmax(edge, extent[d] / (CELLS_MAX_SIDE - 1));
    largest = fmax(largest, fmax(fabs(cells->lo[d]), fabs(cells->hi[d])));
  }
  while (sides(extent, edge, side) > most)
    edge *= 1.25;
  cells->per_length = 1.0 / edge;
  cells->slack = 1e-9 * edge + 4.0 * DBL_EPSILON * largest;
  for (int d = 0; d < 3; d++)
    cells->n[d] = (int)side[d];
}

static int make_room(part_cells *cells, size_t count, size_t n) {
  PART_TRY(part_grow(count + 1, sizeof *cells->start, &cells->cells_room, &cells->start));
  PART_TRY(part_grow(n, sizeof *cells->cell, &cells->cell_room, &cells->cell));
  n += CELLS_PADDING;
  PART_TRY(part_grow(n, sizeof *cells->member, &cells->member_room, &cells->member));
  PART_TRY(part_grow(n, sizeof *cells->x, &cells->room[0], &cells->x));
  PART_TRY(part_grow(n, sizeof *cells->y, &cells->room[1], &cells->y));
  PART_TRY(part_grow(n, sizeof *cells->z, &cells->room[2], &cells->z));
  PART_TRY(part_grow(n, sizeof *cells->r, &cells->room[3], &cells->r));
  for (size_t k = n - CELLS_PADDING; k < n; k++) {
    cells->x[k] = cells->y[k] = cells->z[k] = cells->r[k] = 0.0;
    cells->member[k] = 0;
  }
  return PART_OK;
}

static int cell_in(const part_cells *cells, int d, double x) {
  const int k = (int)((x - cells->lo[d]) * cells->per_length);
  return k < cells->n[d] ? k : cells->n[d] - 1;
}

static void count_members(part_cells *cells, const part_points *points, const int *index,
                          size_t count) {
  int *start = cells->start, sum = 0;
  memset(start, 0, (count + 1) * sizeof *start);
  for (int k = 0; k < cells->count; k++) {
    const double *p = place(points, index, k);
    const int ix = cell_in(cells, 0, p[0]), iy = cell_in(cells, 1, p[1]),
              iz = cell_in(cells, 2, p[2]);
    cells->cell[k] = (iz * cells->n[1] + iy) * cells->n[0] + ix;
    start[cells->cell[k]]++;
  }
  for (size_t c = 0; c <= count; c++) {
    const int here = start[c];
    start[c] = sum;
    sum += here;
  }
}

int part_cells_build(part_cells *cells, const part_points *points, int n, const int *index,
                     double edge) {
  cells->count = n;
  bounds(cells, points, index);
  choose_grid(cells, edge);
  const size_t count = (size_t)cells->n[0] * (size_t)cells->n[1] * (size_t)cells->n[2];
  PART_TRY(make_room(cells, count, (size_t)n));
  count_members(cells, points, index, count);
  int *start = cells->start;
  for (int k = 0; k < n; k++) {
    const int point = index != NULL ? index[k] : k, at = start[cells->cell[k]]++;
    const double *p = place(points, index, k);
    cells->member[at] = point;
    cells->x[at] = p[0];
    cells->y[at] = p[1];
    cells->z[at] = p[2];
    cells->r[at] = points->r[(size_t)point * (size_t)points->r_stride];
  }
  memmove(start + 1, start, count * sizeof *start);
  start[0] = 0;
  return PART_OK;
}

void part_cells_free(part_cells *cells) {
  free(cells->start);
  free(cells->member);
  free(cells->cell);
  free(cells->x);
  free(cells->y);
  free(cells->z);
  free(cells->r);
  memset(cells, 0, sizeof *cells);
}
