/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cells.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "memory.h"
#include "particle/status.h"

/* Two points closer than `edge` must land in the same or in adjacent cells. Round-off of the cell
 * number is below 4 x 2^-53 x CELLS_MAX_SIDE = 5e-10; the slack covers it. */
enum { CELLS_MAX_SIDE = 1 << 20 };
static const double EDGE_SLACK = 1.0 + 1e-9;

static void bounds(int n, const double *x, int stride, double lo[3], double hi[3]) {
  for (int d = 0; d < 3; d++) {
    lo[d] = n > 0 ? x[d] : 0.0;
    hi[d] = lo[d];
  }
  for (int k = 1; k < n; k++)
    for (int d = 0; d < 3; d++) {
      const double v = x[(size_t)k * (size_t)stride + (size_t)d];
      lo[d] = v < lo[d] ? v : lo[d];
      hi[d] = v > hi[d] ? v : hi[d];
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

/* Grid: smallest allowed edge with about as many cells as points. */
static void choose_grid(part_cells *cells, int n, const double lo[3], const double hi[3],
                        double edge) {
  double extent[3], side[3];
  const double most = 4.0 * n + 64.0;
  edge *= EDGE_SLACK;
  for (int d = 0; d < 3; d++) {
    extent[d] = hi[d] - lo[d];
    edge = fmax(edge, extent[d] / (CELLS_MAX_SIDE - 1));
  }
  while (sides(extent, edge, side) > most)
    edge *= 1.25;
  cells->per_length = 1.0 / edge;
  for (int d = 0; d < 3; d++) {
    cells->lo[d] = lo[d];
    cells->n[d] = (int)side[d];
  }
}

static int make_room(part_cells *cells, size_t count, size_t n) {
  PART_TRY(part_grow(count + 1, sizeof *cells->start, &cells->cells_room, &cells->start));
  PART_TRY(part_grow(n, sizeof *cells->member, &cells->member_room, &cells->member));
  PART_TRY(part_grow(n, sizeof *cells->cell, &cells->cell_room, &cells->cell));
  PART_TRY(part_grow(n, sizeof *cells->x, &cells->room[0], &cells->x));
  PART_TRY(part_grow(n, sizeof *cells->y, &cells->room[1], &cells->y));
  PART_TRY(part_grow(n, sizeof *cells->z, &cells->room[2], &cells->z));
  PART_TRY(part_grow(n, sizeof *cells->r, &cells->room[3], &cells->r));
  return PART_OK;
}

int part_cells_build(part_cells *cells, int n, const double *x, int stride, double edge) {
  double lo[3], hi[3];
  bounds(n, x, stride, lo, hi);
  choose_grid(cells, n, lo, hi, edge);
  const size_t count = (size_t)cells->n[0] * (size_t)cells->n[1] * (size_t)cells->n[2];
  PART_TRY(make_room(cells, count, (size_t)n));
  int *start = cells->start;
  memset(start, 0, (count + 1) * sizeof *start);
  for (int k = 0; k < n; k++) {
    const double *p = x + (size_t)k * (size_t)stride;
    const int ix = part_cells_index(cells, 0, p[0]), iy = part_cells_index(cells, 1, p[1]),
              iz = part_cells_index(cells, 2, p[2]);
    cells->cell[k] = (iz * cells->n[1] + iy) * cells->n[0] + ix;
    start[cells->cell[k]]++;
  }
  int sum = 0;
  for (size_t c = 0; c <= count; c++) {
    const int here = start[c];
    start[c] = sum;
    sum += here;
  }
  for (int k = 0; k < n; k++) {
    const double *p = x + (size_t)k * (size_t)stride;
    const int at = start[cells->cell[k]]++;
    cells->member[at] = k;
    cells->x[at] = p[0];
    cells->y[at] = p[1];
    cells->z[at] = p[2];
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
