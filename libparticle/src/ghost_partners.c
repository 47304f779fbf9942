/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Small own spheres that meet copies of large ones: their copies go to the owners of those. */
#include <stdlib.h>
#include <string.h>

#include "ghosts.h"
#include "memory.h"
#include "pairs_near.h"
#include "particle/exchange.h"
#include "particle/status.h"

/* The copy of a large sphere, as it is here. */
typedef struct large_copy {
  double x[3], r, shift[3]; /* shift is in x */
} large_copy;
enum { COPY_STRIDE = sizeof(large_copy) / sizeof(double) };

typedef struct partner_search {
  int copies;
  large_copy *copy;
  int *back; /* [copies] target that is the way back to its owner */
  part_cells level[PART_LEVELS_MAX];
  int *stamp; /* [targets] particle that goes there for sure, + 1 */
  part_found found;
  struct ghost_item *old; /* items by boxes, while new ones are made */
} partner_search;

static void search_free(partner_search *s) {
  free(s->copy);
  free(s->back);
  free(s->stamp);
  free(s->found.item);
  free(s->old);
  for (int k = 0; k < PART_LEVELS_MAX; k++)
    part_cells_free(&s->level[k]);
}

static int is_large(const ghost_choice *c, int item) {
  return part_level_of(&c->levels, part_ghost_radius(c, c->item[item].particle)) > 0;
}

/* Copies that this rank sends; destination[k] is the rank, rank_shift[k] what the receiver has to
 * undo. */
static int pack_large(const ghost_choice *c, int *n, int **destination, large_copy **copy) {
  *n = 0;
  for (int k = 0; k < c->items; k++)
    *n += is_large(c, k);
  PART_TRY(part_allocate((size_t)*n, sizeof **destination, destination));
  PART_TRY(part_allocate((size_t)*n, sizeof **copy, copy));
  int at = 0;
  for (int k = 0; k < c->items; k++) {
    if (!is_large(c, k))
      continue;
    const ghost_target *t = &c->target[c->item[k].target];
    const double *x = part_ghost_place(c, c->item[k].particle);
    large_copy *to = &(*copy)[at];
    for (int d = 0; d < 3; d++)
      to->x[d] = x[d] + t->shift[d];
    to->r = part_ghost_radius(c, c->item[k].particle);
    memcpy(to->shift, t->shift, sizeof to->shift);
    (*destination)[at++] = t->rank;
  }
  return PART_OK;
}

static int find_back(const ghost_choice *c, int rank, const double shift[3], int *back) {
  for (int k = 0; k < c->targets; k++) {
    const ghost_target *t = &c->target[k];
    if (t->rank == rank && t->shift[0] == -shift[0] && t->shift[1] == -shift[1] &&
        t->shift[2] == -shift[2]) {
      *back = k;
      return PART_OK;
    }
  }
  return part_fail(PART_ERR_STATE, "there is no way back for the copy of a sphere of rank %d",
                   rank);
}

static int receive(const ghost_choice *c, partner_search *s, part_exchange *plan,
                   const large_copy *sent) {
  s->copies = part_exchange_receive_count(plan);
  int status = part_allocate((size_t)s->copies, sizeof *s->copy, &s->copy);
  if (status == PART_OK)
    status = part_allocate((size_t)s->copies, sizeof *s->back, &s->back);
  PART_TRY(part_domain_agree(c->domain, status));
  PART_TRY(part_exchange_forward(plan, sizeof *sent, sent, s->copy));
  const int *source = part_exchange_source(plan);
  for (int k = 0; k < s->copies; k++)
    PART_TRY(find_back(c, source[k], s->copy[k].shift, &s->back[k]));
  return PART_OK;
}

static int exchange(const ghost_choice *c, partner_search *s) {
  int n = 0, *destination = NULL;
  large_copy *copy = NULL;
  part_exchange *plan = NULL;
  int status = part_domain_agree(c->domain, pack_large(c, &n, &destination, &copy));
  if (status == PART_OK)
    status = part_exchange_create(c->domain->comm, n, destination, &plan);
  if (status == PART_OK)
    status = receive(c, s, plan, copy);
  part_exchange_destroy(plan);
  free(destination);
  free(copy);
  return part_domain_agree(c->domain, status);
}

/* Cells of the copies of each level. */
static int fill_cells(const ghost_choice *c, partner_search *s) {
  int *index, status = PART_OK;
  const part_points points = {(const double *)s->copy, (const double *)s->copy + 3, COPY_STRIDE,
                              COPY_STRIDE};
  PART_TRY(part_allocate((size_t)s->copies, sizeof *index, &index));
  for (int level = 1; level < c->levels.count && status == PART_OK; level++) {
    int n = 0;
    for (int k = 0; k < s->copies; k++)
      if (part_level_of(&c->levels, s->copy[k].r) == level)
        index[n++] = k;
    if (n > 0)
      status = part_cells_build(&s->level[level], &points, n, index,
                                2.0 * c->levels.top[level] + c->skin);
  }
  free(index);
  return status;
}

/* Targets of particle i: those it had (from *at on), and those of large copies it meets. */
static int add_targets(ghost_choice *c, partner_search *s, part_near_function *near, int i,
                       int *at, int before) {
  const double *x = part_ghost_place(c, i);
  const double xi[4] = {x[0], x[1], x[2], part_ghost_radius(c, i)};
  const int first = c->items;
  for (; *at < before && s->old[*at].particle == i; ++*at) {
    s->stamp[s->old[*at].target] = i + 1;
    PART_TRY(part_ghost_choice_add(c, i, s->old[*at].target));
  }
  s->found.count = 0;
  for (int level = part_level_of(&c->levels, xi[3]) + 1; level < c->levels.count; level++)
    if (s->level[level].count > 0)
      PART_TRY(part_cells_near(&s->level[level], near, xi, c->skin, -1, &s->found));
  for (int k = 0; k < s->found.count; k++) {
    const int target = s->back[s->found.item[k]];
    if (s->stamp[target] == i + 1)
      continue;
    s->stamp[target] = i + 1;
    PART_TRY(part_ghost_choice_add(c, i, target));
    for (int m = c->items - 1; m > first && c->item[m - 1].target > target; m--) {
      c->item[m] = c->item[m - 1];
      c->item[m - 1].target = target;
    }
  }
  return PART_OK;
}

static int add_all(ghost_choice *c, partner_search *s) {
  part_near_function *near = part_near_choose();
  const int before = c->items;
  int at = 0;
  PART_TRY(part_allocate((size_t)c->targets, sizeof *s->stamp, &s->stamp));
  PART_TRY(fill_cells(c, s));
  s->old = c->item;
  c->item = NULL;
  c->items = 0;
  c->item_room = 0;
  for (int i = 0; i < c->store->local; i++)
    PART_TRY(add_targets(c, s, near, i, &at, before));
  return PART_OK;
}

int part_ghost_partners(ghost_choice *choice) {
  partner_search s;
  if (choice->levels.count == 1)
    return PART_OK;
  memset(&s, 0, sizeof s);
  int status = exchange(choice, &s);
  if (status == PART_OK)
    status = part_domain_agree(choice->domain, add_all(choice, &s));
  search_free(&s);
  return status;
}
