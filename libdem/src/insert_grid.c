/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Linked cells of spheres that grow one by one, for overlap tests at insertion. */
#include "internal.h"

struct dem_grid {
  part_box box;
  double edge[3];
  int cells[3];
  int64_t *head, *next; /* first sphere of a cell, next sphere of the same cell; -1: end */
  double *sphere;       /* [count][4] x y z r */
  size_t next_capacity, sphere_capacity;
  int64_t count;
};

int dem_grid_create(const part_box *box, double r_max, int64_t expected, dem_grid **result) {
  dem_grid *grid;
  const double most = 2.0 * (double)expected + 27.0;
  double shortest = 2.0 * r_max, cells;
  *result = NULL;
  PART_TRY(dem_allocate(1, sizeof *grid, &grid));
  grid->box = *box;
  /* Larger cells where the box is mostly empty: memory stays of the order of the spheres. */
  do {
    cells = 1.0;
    for (int c = 0; c < 3; c++) {
      const double length = box->hi[c] - box->lo[c], n = floor(length / shortest);
      grid->cells[c] = n < 1.0 ? 1 : n > 1e6 ? 1000000 : (int)n;
      grid->edge[c] = length / grid->cells[c];
      cells *= grid->cells[c];
    }
    shortest *= 1.3;
  } while (cells > most);
  const int status = dem_allocate((size_t)cells, sizeof *grid->head, &grid->head);
  if (status != PART_OK) {
    dem_grid_destroy(grid);
    return status;
  }
  for (size_t k = 0; k < (size_t)cells; k++)
    grid->head[k] = -1;
  *result = grid;
  return PART_OK;
}

void dem_grid_destroy(dem_grid *grid) {
  if (grid == NULL)
    return;
  free(grid->head);
  free(grid->next);
  free(grid->sphere);
  free(grid);
}

static void cell_of(const dem_grid *grid, const double x[3], int cell[3]) {
  double wrapped[3] = {x[0], x[1], x[2]};
  part_box_wrap(&grid->box, wrapped, NULL);
  for (int c = 0; c < 3; c++) {
    const int k = (int)floor((wrapped[c] - grid->box.lo[c]) / grid->edge[c]);
    cell[c] = k < 0 ? 0 : k >= grid->cells[c] ? grid->cells[c] - 1 : k;
  }
}

static size_t cell_number(const dem_grid *grid, const int cell[3]) {
  return ((size_t)cell[2] * (size_t)grid->cells[1] + (size_t)cell[1]) * (size_t)grid->cells[0] +
         (size_t)cell[0];
}

int dem_grid_add(dem_grid *grid, const double x[3], double r) {
  int cell[3];
  const size_t k = (size_t)grid->count;
  PART_TRY(dem_grow(k + 1, sizeof *grid->next, &grid->next_capacity, &grid->next));
  PART_TRY(dem_grow(4 * (k + 1), sizeof *grid->sphere, &grid->sphere_capacity, &grid->sphere));
  memcpy(&grid->sphere[4 * k], x, 3 * sizeof(double));
  grid->sphere[4 * k + 3] = r;
  cell_of(grid, x, cell);
  const size_t place = cell_number(grid, cell);
  grid->next[k] = grid->head[place];
  grid->head[place] = grid->count++;
  return PART_OK;
}

/* Cells next to c in one direction, each once; returns how many. */
static int neighbours(const dem_grid *grid, int direction, int c, int near[3]) {
  const int n = grid->cells[direction], periodic = grid->box.periodic[direction];
  int count = 0;
  for (int s = -1; s <= 1; s++) {
    int k = c + s, seen = 0;
    if (periodic)
      k = (k + n) % n;
    if (k < 0 || k >= n)
      continue;
    for (int m = 0; m < count; m++)
      seen |= near[m] == k;
    if (!seen)
      near[count++] = k;
  }
  return count;
}

static int64_t search_cell(const dem_grid *grid, size_t cell, const double x[3], double r,
                           double allowed, double *overlap) {
  for (int64_t k = grid->head[cell]; k >= 0; k = grid->next[k]) {
    const double *s = &grid->sphere[4 * k];
    double d[3];
    part_box_difference(&grid->box, x, s, d);
    const double reach = r + s[3], smaller = r < s[3] ? r : s[3];
    const double d2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    if (d2 < reach * reach && reach - sqrt(d2) > allowed * smaller) {
      *overlap = reach - sqrt(d2);
      return k;
    }
  }
  return -1;
}

static int near_in_cell(const dem_grid *grid, size_t cell, const double x[3], double r,
                        double fraction, size_t *capacity, int64_t **found, size_t *count) {
  for (int64_t k = grid->head[cell]; k >= 0; k = grid->next[k]) {
    const double *s = &grid->sphere[4 * k];
    double d[3];
    part_box_difference(&grid->box, x, s, d);
    const double reach = r + s[3] + fraction * fmin(r, s[3]);
    if (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] > reach * reach)
      continue;
    PART_TRY(dem_grow(*count + 1, sizeof **found, capacity, found));
    (*found)[(*count)++] = k;
  }
  return PART_OK;
}

static int by_number(const void *a, const void *b) {
  const int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
  return (x > y) - (x < y);
}

int dem_grid_near(const dem_grid *grid, const double x[3], double r, double fraction,
                  size_t *capacity, int64_t **found, size_t *number) {
  int cell[3], near[3][3], count[3];
  *number = 0;
  cell_of(grid, x, cell);
  for (int c = 0; c < 3; c++)
    count[c] = neighbours(grid, c, cell[c], near[c]);
  for (int k = 0; k < count[2]; k++)
    for (int j = 0; j < count[1]; j++)
      for (int i = 0; i < count[0]; i++) {
        const int at[3] = {near[0][i], near[1][j], near[2][k]};
        PART_TRY(
            near_in_cell(grid, cell_number(grid, at), x, r, fraction, capacity, found, number));
      }
  if (*number > 1)
    qsort(*found, *number, sizeof **found, by_number);
  return PART_OK;
}

int64_t dem_grid_overlap(const dem_grid *grid, const double x[3], double r, double allowed,
                         double *overlap) {
  int cell[3], near[3][3], count[3];
  cell_of(grid, x, cell);
  for (int c = 0; c < 3; c++)
    count[c] = neighbours(grid, c, cell[c], near[c]);
  for (int k = 0; k < count[2]; k++)
    for (int j = 0; j < count[1]; j++)
      for (int i = 0; i < count[0]; i++) {
        const int at[3] = {near[0][i], near[1][j], near[2][k]};
        const int64_t found = search_cell(grid, cell_number(grid, at), x, r, allowed, overlap);
        if (found >= 0)
          return found;
      }
  return -1;
}
