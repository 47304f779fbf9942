/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ghosts by the boxes around other ranks' spheres (ghosts.h). */
#include "ghosts.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "memory.h"
#include "particle/status.h"

void part_ghost_choice_free(ghost_choice *choice) {
  free(choice->boxes);
  free(choice->target);
  free(choice->item);
}

int part_ghost_choice_add(ghost_choice *choice, int particle, int target) {
  const size_t n = (size_t)choice->items + 1;
  PART_TRY(part_grow(n, sizeof *choice->item, &choice->item_room, &choice->item));
  choice->item[choice->items].particle = particle;
  choice->item[choice->items++].target = target;
  return PART_OK;
}

static void surround(ghost_choice *c) {
  const part_region nothing = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
  level_box *own = c->boxes + c->domain->rank * c->levels.count;
  for (int k = 0; k < c->levels.count; k++)
    own[k] = (level_box){nothing, 0.0};
  for (int i = 0; i < c->store->local; i++) {
    const double *x = part_ghost_place(c, i), r = part_ghost_radius(c, i);
    level_box *b = &own[part_level_of(&c->levels, r)];
    b->r = r > b->r ? r : b->r;
    for (int d = 0; d < 3; d++) {
      b->box.lo[d] = x[d] < b->box.lo[d] ? x[d] : b->box.lo[d];
      b->box.hi[d] = x[d] > b->box.hi[d] ? x[d] : b->box.hi[d];
    }
  }
}

static int share_boxes(ghost_choice *c) {
  const int size = c->domain->size, bytes = (int)sizeof *c->boxes * c->levels.count;
  PART_TRY(part_domain_agree(c->domain, part_allocate((size_t)(size * c->levels.count),
                                                      sizeof *c->boxes, &c->boxes)));
  surround(c);
  if (size > 1 && MPI_Allgather(MPI_IN_PLACE, 0, MPI_DATATYPE_NULL, c->boxes, bytes, MPI_BYTE,
                                c->domain->comm) != MPI_SUCCESS)
    return part_fail(PART_ERR_MPI, "MPI_Allgather failed");
  return PART_OK;
}

/* The same on every rank, so it needs no agreement. */
static int check_length(const ghost_choice *c) {
  const part_box *box = &c->domain->box;
  double r = 0.0;
  for (int k = 0; k < c->domain->size * c->levels.count; k++)
    r = fmax(r, c->boxes[k].r);
  const double reach = 2.0 * r + c->skin;
  for (int d = 0; d < 3; d++)
    if (box->periodic[d] && box->hi[d] - box->lo[d] < 2.0 * reach)
      return part_fail(PART_ERR_RANGE,
                       "periodic direction %c is %g m long; it must be at least two reaches of "
                       "%g m, or a pair would meet twice",
                       "xyz"[d], box->hi[d] - box->lo[d], reach);
  return PART_OK;
}

/* Positions that are shifted round off; a copy more does no harm, one too few would. */
static void widen(ghost_choice *c) {
  double largest = 0.0, reach = c->skin;
  for (int d = 0; d < 3; d++)
    largest = fmax(largest, fmax(fabs(c->domain->box.lo[d]), fabs(c->domain->box.hi[d])));
  for (int k = 0; k < c->domain->size * c->levels.count; k++) {
    const level_box *b = &c->boxes[k];
    reach = fmax(reach, 2.0 * b->r + c->skin);
    for (int d = 0; d < 3 && b->box.lo[d] <= b->box.hi[d]; d++)
      largest = fmax(largest, fmax(fabs(b->box.lo[d]), fabs(b->box.hi[d])));
  }
  c->skin += 8.0 * DBL_EPSILON * (reach + largest);
}

/* Do two boxes, the first one shifted, come within reach of each other? */
static int meets(const level_box *own, const double shift[3], const level_box *other, double skin) {
  const double reach = own->r + other->r + skin;
  for (int d = 0; d < 3; d++)
    if (!(own->box.lo[d] + shift[d] <= other->box.hi[d] + reach &&
          own->box.hi[d] + shift[d] >= other->box.lo[d] - reach))
      return 0;
  return 1;
}

/* Does any own level meet any level of that rank? */
static int is_target(const ghost_choice *c, const ghost_target *t) {
  const level_box *own = c->boxes + c->domain->rank * c->levels.count;
  const level_box *other = c->boxes + t->rank * c->levels.count;
  for (int a = 0; a < c->levels.count; a++)
    for (int b = 0; b < c->levels.count; b++)
      if (meets(&own[a], t->shift, &other[b], c->skin))
        return 1;
  return 0;
}

static int find_targets(ghost_choice *c) {
  const part_box *box = &c->domain->box;
  int most[3];
  for (int d = 0; d < 3; d++)
    most[d] = box->periodic[d] ? 1 : 0;
  for (int r = 0; r < c->domain->size; r++)
    for (int z = -most[2]; z <= most[2]; z++)
      for (int y = -most[1]; y <= most[1]; y++)
        for (int x = -most[0]; x <= most[0]; x++) {
          const ghost_target t = {r,
                                  {x * (box->hi[0] - box->lo[0]), y * (box->hi[1] - box->lo[1]),
                                   z * (box->hi[2] - box->lo[2])}};
          const int itself = r == c->domain->rank && x == 0 && y == 0 && z == 0;
          if (itself || !is_target(c, &t))
            continue;
          PART_TRY(part_grow((size_t)c->targets + 1, sizeof *c->target, &c->target_room,
                             &c->target));
          c->target[c->targets++] = t;
        }
  return PART_OK;
}

/* A target's box as seen from own unshifted particles of one level. */
typedef struct wanted {
  part_region box;
  double reach; /* m, but for the particle's own radius */
  int target;
} wanted;

/* What own spheres of a level may be wanted for. */
static int find_wanted(const ghost_choice *c, int level, wanted *want) {
  const level_box *own = c->boxes + c->domain->rank * c->levels.count + level;
  int n = 0;
  for (int k = 0; k < c->targets; k++)
    for (int b = 0; b <= level; b++) {
      const ghost_target *t = &c->target[k];
      const level_box *other = &c->boxes[t->rank * c->levels.count + b];
      if (!meets(own, t->shift, other, c->skin))
        continue;
      want[n] = (wanted){other->box, other->r + c->skin, k};
      for (int d = 0; d < 3; d++) {
        want[n].box.lo[d] -= t->shift[d];
        want[n].box.hi[d] -= t->shift[d];
      }
      n++;
    }
  return n;
}

/* A box of own particles that nobody can want, so that most are passed by with one look: for every
 * box wanted the core gives way on the side where it loses least. */
static part_region find_core(const level_box *own, const wanted *want, int n) {
  part_region core = own->box;
  for (int k = 0; k < n; k++) {
    double least = INFINITY, new_lo = 0.0, new_hi = 0.0;
    int side = 0;
    for (int d = 0; d < 3; d++) {
      const double length = core.hi[d] - core.lo[d];
      if (!(length > 0.0))
        continue; /* all in one plane: this side can not give way */
      const double from = want[k].box.lo[d] - want[k].reach - own->r,
                   to = want[k].box.hi[d] + want[k].reach + own->r;
      const double lost_high = fmax(core.hi[d] - from, 0.0) / length;
      const double lost_low = fmax(to - core.lo[d], 0.0) / length;
      if (lost_high < least) {
        least = lost_high;
        side = d;
        new_lo = core.lo[d];
        new_hi = fmin(core.hi[d], from);
      }
      if (lost_low < least) {
        least = lost_low;
        side = d;
        new_lo = fmax(core.lo[d], to);
        new_hi = core.hi[d];
      }
    }
    if (!(least < 1.0)) { /* nothing is left, or the own box is flat */
      core.lo[0] = INFINITY;
      return core;
    }
    core.lo[side] = new_lo;
    core.hi[side] = new_hi;
  }
  return core;
}

static int inside(const part_region *core, const double x[3]) {
  return x[0] > core->lo[0] && x[0] < core->hi[0] && x[1] > core->lo[1] && x[1] < core->hi[1] &&
         x[2] > core->lo[2] && x[2] < core->hi[2];
}

/* Is x within reach of the box? */
static int near_box(const part_region *box, const double x[3], double reach) {
  double sum = 0.0;
  for (int d = 0; d < 3; d++) {
    const double out = x[d] < box->lo[d]   ? box->lo[d] - x[d]
                       : x[d] > box->hi[d] ? x[d] - box->hi[d]
                                           : 0;
    sum += out * out;
  }
  return sum <= reach * reach;
}

/* What is wanted of one level. */
typedef struct level_wanted {
  wanted *want;
  int n;
  part_region core;
} level_wanted;

static int choose_items(ghost_choice *c, const level_wanted *of) {
  for (int i = 0; i < c->store->local; i++) {
    const double *x = part_ghost_place(c, i), r = part_ghost_radius(c, i);
    const level_wanted *w = &of[part_level_of(&c->levels, r)];
    int last = -1;
    if (w->n == 0 || inside(&w->core, x))
      continue;
    for (int k = 0; k < w->n; k++)
      if (w->want[k].target != last && near_box(&w->want[k].box, x, r + w->want[k].reach)) {
        last = w->want[k].target;
        PART_TRY(part_ghost_choice_add(c, i, last));
      }
  }
  return PART_OK;
}

static int choose(ghost_choice *c) {
  level_wanted of[PART_LEVELS_MAX];
  wanted *want = NULL;
  const int levels = c->levels.count;
  PART_TRY(find_targets(c));
  const size_t each = (size_t)c->targets * (size_t)levels;
  PART_TRY(part_allocate(each * (size_t)levels, sizeof *want, &want));
  for (int k = 0; k < levels; k++) {
    of[k].want = want + (size_t)k * each;
    of[k].n = find_wanted(c, k, of[k].want);
    of[k].core = find_core(&c->boxes[c->domain->rank * levels + k], of[k].want, of[k].n);
  }
  const int status = choose_items(c, of);
  free(want);
  return status;
}

int part_ghost_boxes(ghost_choice *choice) {
  PART_TRY(share_boxes(choice));
  PART_TRY(check_length(choice));
  widen(choice);
  return part_domain_agree(choice->domain, choose(choice));
}
