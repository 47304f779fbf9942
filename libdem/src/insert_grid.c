/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Linked cells of spheres that grow one by one, for overlap tests at insertion: a grid for each level
 * of radii, so that small spheres are not in the cells of large ones. */
#include "internal.h"

typedef struct grid_level {
  double edge[3], r_max; /* largest radius so far */
  int cells[3];
  int64_t *head; /* first sphere of a cell, -1: none; NULL: no sphere in this level yet */
} grid_level;

struct dem_grid {
  part_box box;
  part_levels levels;
  grid_level level[PART_LEVELS_MAX];
  int64_t *next;  /* next sphere of the same cell; -1: end */
  double *sphere; /* [count][4] x y z r */
  size_t next_capacity, sphere_capacity;
  int64_t count, expected;
};

int dem_grid_create(const part_box *box, double r_min, double r_max, int64_t expected,
                    dem_grid **grid) {
  *grid = NULL;
  PART_TRY(dem_allocate(1, sizeof **grid, grid));
  (*grid)->box = *box;
  (*grid)->expected = expected;
  part_levels_set(&(*grid)->levels, r_min, r_max);
  return PART_OK;
}

void dem_grid_destroy(dem_grid *grid) {
  if (grid == NULL)
    return;
  for (int k = 0; k < PART_LEVELS_MAX; k++)
    free(grid->level[k].head);
  free(grid->next);
  free(grid->sphere);
  free(grid);
}

/* Cells of one diameter; larger where the box is mostly empty, so that memory stays of the order of
 * the spheres. */
static int make_level(const dem_grid *grid, int number, grid_level *level) {
  const double most = 2.0 * (double)grid->expected + 27.0;
  double shortest = 2.0 * grid->levels.top[number], cells;
  do {
    cells = 1.0;
    for (int c = 0; c < 3; c++) {
      const double length = grid->box.hi[c] - grid->box.lo[c], n = floor(length / shortest);
      level->cells[c] = n < 1.0 ? 1 : n > 1e6 ? 1000000 : (int)n;
      level->edge[c] = length / level->cells[c];
      cells *= level->cells[c];
    }
    shortest *= 1.3;
  } while (cells > most);
  PART_TRY(dem_allocate((size_t)cells, sizeof *level->head, &level->head));
  for (size_t k = 0; k < (size_t)cells; k++)
    level->head[k] = -1;
  return PART_OK;
}

static size_t cell_number(const grid_level *level, int x, int y, int z) {
  return ((size_t)z * (size_t)level->cells[1] + (size_t)y) * (size_t)level->cells[0] + (size_t)x;
}

static int cell_of(const grid_level *level, double x, double lo, int c) {
  const double k = floor((x - lo) / level->edge[c]);
  return k < 0.0 ? 0 : k >= level->cells[c] ? level->cells[c] - 1 : (int)k;
}

int dem_grid_add(dem_grid *grid, const double x[3], double r) {
  const int number = part_level_of(&grid->levels, r);
  grid_level *level = &grid->level[number];
  const size_t k = (size_t)grid->count;
  double wrapped[3] = {x[0], x[1], x[2]};
  int cell[3];
  PART_TRY(dem_grow(k + 1, sizeof *grid->next, &grid->next_capacity, &grid->next));
  PART_TRY(dem_grow(4 * (k + 1), sizeof *grid->sphere, &grid->sphere_capacity, &grid->sphere));
  if (level->head == NULL)
    PART_TRY(make_level(grid, number, level));
  memcpy(&grid->sphere[4 * k], x, 3 * sizeof(double));
  grid->sphere[4 * k + 3] = r;
  level->r_max = fmax(level->r_max, r);
  part_box_wrap(&grid->box, wrapped, NULL);
  for (int c = 0; c < 3; c++)
    cell[c] = cell_of(level, wrapped[c], grid->box.lo[c], c);
  const size_t place = cell_number(level, cell[0], cell[1], cell[2]);
  grid->next[k] = level->head[place];
  level->head[place] = grid->count++;
  return PART_OK;
}

/* Cells of a level within reach of a place, each once. */
typedef struct cell_block {
  int first[3], count[3];
} cell_block;

/* In one direction; cells go on modulo their number in a periodic one. */
static void cells_near(const dem_grid *grid, const grid_level *level, int c, double x, double reach,
                       int *first, int *count) {
  const double lo = grid->box.lo[c];
  const int n = level->cells[c];
  if (!grid->box.periodic[c]) {
    *first = cell_of(level, x - reach, lo, c);
    *count = cell_of(level, x + reach, lo, c) - *first + 1;
    return;
  }
  const double a = floor((x - reach - lo) / level->edge[c]),
               b = floor((x + reach - lo) / level->edge[c]);
  *count = b - a + 1.0 >= n ? n : (int)(b - a) + 1;
  *first = (int)(a - n * floor(a / n));
  if (*first >= n) /* rounding */
    *first = 0;
}

static cell_block block_near(const dem_grid *grid, const grid_level *level, const double x[3],
                             double reach) {
  cell_block block;
  for (int c = 0; c < 3; c++) /* a little more, for rounding */
    cells_near(grid, level, c, x[c], reach * (1.0 + 1e-9), &block.first[c], &block.count[c]);
  return block;
}

static int64_t cells_of(const cell_block *block) {
  return (int64_t)block->count[0] * block->count[1] * block->count[2];
}

/* First sphere of cell number n of a block. */
static int64_t head_of(const grid_level *level, const cell_block *block, int64_t n) {
  const int *count = block->count, *first = block->first;
  const int x = (int)(n % count[0]), y = (int)(n / count[0] % count[1]),
            z = (int)(n / count[0] / count[1]);
  return level->head[cell_number(level, (first[0] + x) % level->cells[0],
                                 (first[1] + y) % level->cells[1],
                                 (first[2] + z) % level->cells[2])];
}

static int64_t search_cell(const dem_grid *grid, int64_t head, const double x[3], double r,
                           double allowed, double *overlap) {
  for (int64_t k = head; k >= 0; k = grid->next[k]) {
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

int64_t dem_grid_overlap(const dem_grid *grid, const double x[3], double r, double allowed,
                         double *overlap) {
  for (int k = grid->levels.count - 1; k >= 0; k--) { /* a place is most often in a large one */
    const grid_level *level = &grid->level[k];
    if (level->head == NULL)
      continue;
    const cell_block block = block_near(grid, level, x, r + level->r_max);
    for (int64_t n = 0; n < cells_of(&block); n++) {
      const int64_t found =
          search_cell(grid, head_of(level, &block, n), x, r, allowed, overlap);
      if (found >= 0)
        return found;
    }
  }
  return -1;
}

static int near_in_cell(const dem_grid *grid, int64_t head, const double x[3], double r,
                        double fraction, size_t *capacity, int64_t **found, size_t *count) {
  for (int64_t k = head; k >= 0; k = grid->next[k]) {
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
  *number = 0;
  for (int k = 0; k < grid->levels.count; k++) {
    const grid_level *level = &grid->level[k];
    if (level->head == NULL)
      continue;
    const double reach = r + level->r_max + fraction * fmin(r, level->r_max);
    const cell_block block = block_near(grid, level, x, reach);
    for (int64_t n = 0; n < cells_of(&block); n++)
      PART_TRY(near_in_cell(grid, head_of(level, &block, n), x, r, fraction, capacity, found,
                            number));
  }
  if (*number > 1)
    qsort(*found, *number, sizeof **found, by_number);
  return PART_OK;
}
