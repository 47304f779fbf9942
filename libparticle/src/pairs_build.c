/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Verlet lists by hierarchical grids: linked cells for each level of radii. A sphere looks through
 * the cells of its own level and of the coarser ones, so that a large sphere is found by its many
 * small partners and never looks through their cells itself.
 *
 * Row i holds partners j > i. Small spheres come first in the order of part_sort_order, so a pair of
 * two levels is in the row of the small one, where it is found; rows stay short. The others (a small
 * ghost and a large own sphere; any pair when particles are in another order) are found from the
 * wrong end: they are kept aside and merged into their rows. */
#include "pairs.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "memory.h"
#include "pairs_near.h"
#include "particle/status.h"

typedef struct search {
  pair_list *list;
  const pair_view *view;
  const part_levels *levels;
  part_near_function *near;
  part_found found; /* the rows so far */
  double skin;
  int late; /* pairs kept aside */
} search;

/* Rows are short, and already in increasing runs. */
static void sort_row(int *row, int n) {
  for (int k = 1; k < n; k++) {
    const int value = row[k];
    int at = k;
    for (; at > 0 && row[at - 1] > value; at--)
      row[at] = row[at - 1];
    row[at] = value;
  }
}

static int by_value(const void *a, const void *b) {
  const int x = *(const int *)a, y = *(const int *)b;
  return (x > y) - (x < y);
}

static void order_row(int *row, int n) {
  if (n > 32)
    qsort(row, (size_t)n, sizeof *row, by_value);
  else
    sort_row(row, n);
}

static int keep_aside(search *s, int row, int partner) {
  pair_list *list = s->list;
  if (s->late == INT_MAX)
    return part_fail(PART_ERR_RANGE, "more than %d pairs on one rank", INT_MAX);
  const size_t n = (size_t)s->late + 1;
  PART_TRY(part_grow(n, sizeof *list->late, &list->late_room, &list->late));
  list->late[s->late++] = (late_pair){row, partner};
  return PART_OK;
}

/* Partners of i in coarser levels: those after it stay in its row, for an own i; to the rows of own
 * ones before it i is a partner. */
static int look_up(search *s, int i, int level, const double xi[4]) {
  part_found *found = &s->found;
  const int first = found->count, own = i < s->view->own;
  int kept = first;
  for (int k = level + 1; k < s->levels->count; k++)
    PART_TRY(part_cells_near(&s->list->level[k], s->near, xi, s->skin, -1, found));
  for (int k = first; k < found->count; k++) {
    const int j = found->item[k];
    if (own && j > i)
      found->item[kept++] = j;
    else if (j < i && j < s->view->own)
      PART_TRY(keep_aside(s, j, i));
  }
  found->count = kept;
  return PART_OK;
}

static int look_around(search *s, int i) {
  const pair_view *v = s->view;
  const double *x = v->points.x + (size_t)i * (size_t)v->points.x_stride;
  const double xi[4] = {x[0], x[1], x[2], v->points.r[(size_t)i * (size_t)v->points.r_stride]};
  const int level = part_level_of(s->levels, xi[3]);
  if (i < v->own)
    PART_TRY(part_cells_near(&s->list->level[level], s->near, xi, s->skin, i, &s->found));
  return look_up(s, i, level, xi);
}

/* Members of each level, in increasing order; order NULL: all are in one. */
static int fill_levels(search *s) {
  const pair_view *v = s->view;
  const part_levels *levels = s->levels;
  pair_list *list = s->list;
  int start[PART_LEVELS_MAX + 1] = {0}, at[PART_LEVELS_MAX];
  for (int i = 0; i < v->all; i++)
    start[part_level_of(levels, v->points.r[(size_t)i * (size_t)v->points.r_stride]) + 1]++;
  for (int k = 0; k < levels->count; k++) {
    start[k + 1] += start[k];
    at[k] = start[k];
  }
  PART_TRY(part_grow((size_t)v->all, sizeof *list->order, &list->order_room, &list->order));
  for (int i = 0; levels->count > 1 && i < v->all; i++)
    list->order[at[part_level_of(levels, v->points.r[(size_t)i * (size_t)v->points.r_stride])]++] =
        i;
  for (int k = 0; k < levels->count; k++) {
    const double edge = 2.0 * levels->top[k] + s->skin;
    list->level[k].count = 0;
    if (start[k + 1] > start[k])
      PART_TRY(part_cells_build(&list->level[k], &v->points, start[k + 1] - start[k],
                                levels->count > 1 ? list->order + start[k] : NULL, edge));
  }
  return PART_OK;
}

/* Pairs kept aside into their rows. They come by increasing partner; rows are sorted. */
static int merge(search *s) {
  pair_list *list = s->list;
  part_pairs *pairs = &list->pairs;
  const size_t rows = (size_t)pairs->rows, late = (size_t)s->late;
  const size_t total = late + (size_t)pairs->start[rows];
  int *begin, *partner;
  PART_TRY(part_pairs_room(list, total));
  PART_TRY(part_allocate(rows + 1 + late, sizeof *begin, &begin));
  partner = begin + rows + 1;
  for (size_t k = 0; k < late; k++)
    begin[list->late[k].row + 1]++;
  for (size_t i = 0; i < rows; i++)
    begin[i + 1] += begin[i];
  for (size_t k = 0; k < late; k++)
    partner[begin[list->late[k].row]++] = list->late[k].partner;
  memmove(begin + 1, begin, rows * sizeof *begin);
  begin[0] = 0;
  /* From the last row down, so that rows can move up in place. */
  size_t to = total;
  for (size_t i = rows; i-- > 0;) {
    int a = pairs->start[i + 1], b = begin[i + 1];
    const int a0 = pairs->start[i], b0 = begin[i];
    pairs->start[i + 1] = (int)to;
    while (a > a0 || b > b0)
      pairs->partner[--to] = b == b0 || (a > a0 && pairs->partner[a - 1] > partner[b - 1])
                                 ? pairs->partner[--a]
                                 : partner[--b];
  }
  free(begin);
  return PART_OK;
}

static int fill_rows(search *s) {
  part_pairs *pairs = &s->list->pairs;
  for (int i = 0; i < s->view->own; i++) {
    PART_TRY(look_around(s, i));
    pairs->start[i + 1] = s->found.count;
    order_row(s->found.item + pairs->start[i], pairs->start[i + 1] - pairs->start[i]);
  }
  for (int i = s->view->own; s->levels->count > 1 && i < s->view->all; i++)
    PART_TRY(look_around(s, i));
  return PART_OK;
}

/* The list's own memory is lent to the search. */
static int run(search *s) {
  pair_list *list = s->list;
  PART_TRY(fill_levels(s));
  s->found = (part_found){0, list->pairs.partner, list->partner_room};
  const int status = fill_rows(s);
  list->pairs.partner = s->found.item;
  list->partner_room = s->found.room;
  PART_TRY(status);
  return s->late > 0 ? merge(s) : PART_OK;
}

static int build(pair_list *list, const part_store *store, int radius_field,
                 const part_levels *levels, double skin) {
  pair_view v;
  part_levels own;
  PART_TRY(part_pairs_view(store, radius_field, skin, &v));
  PART_TRY(part_pairs_begin(list, v.own, skin));
  if (levels == NULL)
    part_levels_set(&own, v.r_min, v.r_max);
  search s = {list, &v, levels != NULL ? levels : &own, part_near_choose(),
              {0, NULL, 0}, skin, 0};
  if (v.all > 0 && 2.0 * v.r_max + skin > 0.0) /* else nothing can be near anything */
    PART_TRY(run(&s));
  return part_pairs_end(list);
}

int part_pairs_build(part_pairs *pairs, const part_store *store, int radius_field,
                     const part_levels *levels, double skin) {
  const int status = build((pair_list *)pairs, store, radius_field, levels, skin);
  if (status != PART_OK)
    pairs->rows = 0;
  return status;
}
