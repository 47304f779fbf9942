/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pair lists: life, checks, and building by brute force. */
#include "pairs.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "memory.h"
#include "pairs_near.h"
#include "particle/status.h"

int part_pairs_create(int data_width, part_pairs **pairs) {
  *pairs = NULL;
  if (data_width < 0)
    return part_fail(PART_ERR_ARGUMENT, "pair data of %d doubles", data_width);
  pair_list *list;
  PART_TRY(part_allocate(1, sizeof *list, &list));
  list->pairs.data_width = data_width;
  int status = part_pairs_begin(list, 0, 0.0);
  if (status == PART_OK)
    status = part_pairs_end(list);
  if (status != PART_OK) {
    part_pairs_destroy(&list->pairs);
    return status;
  }
  *pairs = &list->pairs;
  return PART_OK;
}

void part_pairs_destroy(part_pairs *pairs) {
  if (pairs == NULL)
    return;
  pair_list *list = (pair_list *)pairs;
  free(pairs->start);
  free(pairs->partner);
  free(pairs->data);
  for (int k = 0; k < PART_LEVELS_MAX; k++)
    part_cells_free(&list->level[k]);
  free(list->order);
  free(list->late);
  free(list);
}

static int check_numbers(const part_store *store, pair_view *view) {
  const part_layout *layout = store->layout;
  view->r_min = HUGE_VAL;
  view->r_max = 0.0;
  for (int i = 0; i < view->all; i++) {
    const double *x = view->points.x + (size_t)i * (size_t)view->points.x_stride;
    const double r = view->points.r[(size_t)i * (size_t)view->points.r_stride];
    /* The sum is finite when all are, but for an overflow that no real position gives. */
    if (!isfinite(x[0] + x[1] + x[2]) || !(r >= 0.0 && r < INFINITY)) {
      const int64_t *id = part_field_int64(store, layout->id_field);
      const size_t stride = (size_t)part_field_stride(store, layout->id_field);
      return part_fail(PART_ERR_NUMERIC, "particle %lld at (%g %g %g) with radius %g",
                       (long long)id[(size_t)i * stride], x[0], x[1], x[2], r);
    }
    view->r_min = r < view->r_min ? r : view->r_min;
    view->r_max = r > view->r_max ? r : view->r_max;
  }
  return PART_OK;
}

int part_pairs_view(const part_store *store, int radius_field, double skin, pair_view *view) {
  const part_layout *layout = store->layout;
  if (radius_field < 0 || radius_field >= layout->field_count ||
      layout->records[layout->fields[radius_field].record].type != PART_DOUBLE)
    return part_fail(PART_ERR_ARGUMENT, "radius field %d is not a field of doubles", radius_field);
  if (!(skin >= 0.0 && skin < INFINITY))
    return part_fail(PART_ERR_RANGE, "skin %g m is not in [0, inf)", skin);
  view->points.x = part_record_double(store, 0);
  view->points.x_stride = layout->records[0].width;
  view->points.r = part_field_double(store, radius_field);
  view->points.r_stride = part_field_stride(store, radius_field);
  view->own = store->local;
  view->all = store->local + store->ghost;
  return check_numbers(store, view);
}

int part_pairs_begin(pair_list *list, int rows, double skin) {
  part_pairs *pairs = &list->pairs;
  pairs->rows = 0;
  PART_TRY(part_grow((size_t)rows + 1, sizeof *pairs->start, &list->start_room, &pairs->start));
  memset(pairs->start, 0, ((size_t)rows + 1) * sizeof *pairs->start);
  pairs->rows = rows;
  pairs->skin = skin;
  return PART_OK;
}

int part_pairs_room(pair_list *list, size_t n) {
  if (n > INT_MAX)
    return part_fail(PART_ERR_RANGE, "more than %d pairs on one rank", INT_MAX);
  return part_grow(n, sizeof *list->pairs.partner, &list->partner_room, &list->pairs.partner);
}

int part_pairs_end(pair_list *list) {
  part_pairs *pairs = &list->pairs;
  const size_t n = (size_t)pairs->start[pairs->rows] * (size_t)pairs->data_width;
  PART_TRY(part_pairs_room(list, (size_t)pairs->start[pairs->rows]));
  PART_TRY(part_grow(n, sizeof *pairs->data, &list->data_room, &pairs->data));
  memset(pairs->data, 0, n * sizeof *pairs->data);
  return PART_OK;
}

static int naive_row(pair_list *list, const pair_view *v, int i, double skin) {
  part_pairs *pairs = &list->pairs;
  const double *xi = v->points.x + (size_t)i * (size_t)v->points.x_stride;
  const double ri = v->points.r[(size_t)i * (size_t)v->points.r_stride];
  int count = pairs->start[i];
  PART_TRY(part_pairs_room(list, (size_t)count + (size_t)(v->all - i)));
  for (int j = i + 1; j < v->all; j++) {
    const double *xj = v->points.x + (size_t)j * (size_t)v->points.x_stride;
    const double rj = v->points.r[(size_t)j * (size_t)v->points.r_stride];
    if (part_pair_near(xj[0] - xi[0], xj[1] - xi[1], xj[2] - xi[2], ri, rj, skin))
      pairs->partner[count++] = j;
  }
  pairs->start[i + 1] = count;
  return PART_OK;
}

int part_pairs_build_naive(part_pairs *pairs, const part_store *store, int radius_field,
                           double skin) {
  pair_list *list = (pair_list *)pairs;
  pair_view view;
  int status = part_pairs_view(store, radius_field, skin, &view);
  if (status == PART_OK)
    status = part_pairs_begin(list, view.own, skin);
  for (int i = 0; i < view.own && status == PART_OK; i++)
    status = naive_row(list, &view, i, skin);
  if (status == PART_OK)
    status = part_pairs_end(list);
  if (status != PART_OK)
    pairs->rows = 0;
  return status;
}

static int trim_ghosts(part_pairs *pairs, part_domain *domain, part_store *store,
                       unsigned char *needed, int *place) {
  const int local = store->local, n = pairs->start[pairs->rows];
  for (int k = 0; k < n; k++)
    if (pairs->partner[k] >= local)
      needed[pairs->partner[k] - local] = 1;
  PART_TRY(part_domain_trim_ghosts(domain, store, needed, place));
  for (int k = 0; k < n; k++)
    if (pairs->partner[k] >= local)
      pairs->partner[k] = local + place[pairs->partner[k] - local];
  return PART_OK;
}

int part_pairs_trim_ghosts(part_pairs *pairs, part_domain *domain, part_store *store) {
  unsigned char *needed = NULL;
  int *place = NULL;
  int status = part_allocate((size_t)store->ghost, 1, &needed);
  if (status == PART_OK)
    status = part_allocate((size_t)store->ghost + 1, sizeof *place, &place);
  status = part_agree(part_domain_comm(domain), status);
  if (status == PART_OK)
    status = trim_ghosts(pairs, domain, store, needed, place);
  free(needed);
  free(place);
  return status;
}
