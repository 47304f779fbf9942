/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ghost copies. Every rank tells the box around its own particles; whoever has a particle within
 * reach of that box, as it is or shifted over a periodic border, sends a copy. This holds for
 * particles that have moved out of their rank's part since they migrated, too. */
#include "domain.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "memory.h"
#include "particle/status.h"

void part_ghost_plan_free(ghost_plan *plan) {
  part_exchange_destroy(plan->exchange);
  free(plan->item);
  free(plan->destination);
  free(plan->shift);
  free(plan->send);
  free(plan->received);
  memset(plan, 0, sizeof *plan);
}

/* A rank and a periodic image of own particles that may be near it. */
typedef struct ghost_target {
  int rank;
  double shift[3];
  part_region box; /* around that rank's particles */
} ghost_target;

/* Empty: lo > hi. */
static part_region surround(const part_store *store) {
  const double *x = part_record_double(store, 0);
  const size_t width = (size_t)store->layout->records[0].width;
  part_region box = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
  for (int i = 0; i < store->local; i++)
    for (int d = 0; d < 3; d++) {
      const double v = x[(size_t)i * width + (size_t)d];
      box.lo[d] = v < box.lo[d] ? v : box.lo[d];
      box.hi[d] = v > box.hi[d] ? v : box.hi[d];
    }
  return box;
}

static int check_reach(const part_domain *domain, const part_store *store, double reach) {
  const part_box *box = &domain->box;
  const double *x = part_record_double(store, 0);
  const size_t width = (size_t)store->layout->records[0].width;
  if (!(reach >= 0.0 && reach < INFINITY))
    return part_fail(PART_ERR_RANGE, "reach %g m is not in [0, inf)", reach);
  for (int d = 0; d < 3; d++) {
    const double length = box->hi[d] - box->lo[d];
    if (box->periodic[d] && length < 2.0 * reach)
      return part_fail(PART_ERR_RANGE,
                       "periodic direction %c is %g m long; it must be at least two reaches of "
                       "%g m, or a pair would meet twice",
                       "xyz"[d], length, reach);
    /* Farther out, an image two periods away could be missed. */
    const double most = box->periodic[d] ? 0.25 * length : INFINITY;
    for (int i = 0; i < store->local; i++) {
      const double v = x[(size_t)i * width + (size_t)d];
      if (!isfinite(v) || v < box->lo[d] - most || v > box->hi[d] + most)
        return part_domain_fail_at(store, i, PART_ERR_OUTSIDE,
                                   "is not finite or far out of a periodic box: migrate first");
    }
  }
  return PART_OK;
}

/* Square of the distance from x + shift to the target's box. */
static double distance2(const ghost_target *t, const double x[3]) {
  double sum = 0.0;
  for (int d = 0; d < 3; d++) {
    const double v = x[d] + t->shift[d];
    const double out = v < t->box.lo[d]   ? t->box.lo[d] - v
                       : v > t->box.hi[d] ? v - t->box.hi[d]
                                          : 0;
    sum += out * out;
  }
  return sum;
}

/* Does own's box, shifted, come within reach of the target's? */
static int meets(const ghost_target *t, const part_region *own, double reach) {
  for (int d = 0; d < 3; d++)
    if (!(own->lo[d] + t->shift[d] <= t->box.hi[d] + reach &&
          own->hi[d] + t->shift[d] >= t->box.lo[d] - reach))
      return 0;
  return 1;
}

/* Targets in increasing order of rank, and of shift z, y, x. */
static int find_targets(const part_domain *domain, const part_region *boxes, double reach,
                        ghost_target **targets, int *count) {
  const part_box *box = &domain->box;
  size_t room = 0;
  int most[3];
  *count = 0;
  for (int d = 0; d < 3; d++)
    most[d] = box->periodic[d] ? 1 : 0;
  for (int r = 0; r < domain->size; r++)
    for (int z = -most[2]; z <= most[2]; z++)
      for (int y = -most[1]; y <= most[1]; y++)
        for (int x = -most[0]; x <= most[0]; x++) {
          const ghost_target t = {r,
                                  {x * (box->hi[0] - box->lo[0]), y * (box->hi[1] - box->lo[1]),
                                   z * (box->hi[2] - box->lo[2])},
                                  boxes[r]};
          const int itself = r == domain->rank && x == 0 && y == 0 && z == 0;
          if (itself || !meets(&t, &boxes[domain->rank], reach))
            continue;
          PART_TRY(part_grow((size_t)*count + 1, sizeof **targets, &room, targets));
          (*targets)[(*count)++] = t;
        }
  return PART_OK;
}

/* A box of own particles that no target can want, so that most are passed by with one look: for
 * every target the core gives way on the side where it loses least. */
static part_region find_core(const part_region *own, const ghost_target *targets, int count,
                             double reach) {
  part_region core = *own;
  for (int k = 0; k < count; k++) {
    const ghost_target *t = &targets[k];
    double least = INFINITY, new_lo = 0.0, new_hi = 0.0;
    int side = 0;
    for (int d = 0; d < 3; d++) {
      const double length = core.hi[d] - core.lo[d];
      if (!(length > 0.0))
        continue; /* all in one plane: this side can not give way */
      const double from = t->box.lo[d] - reach - t->shift[d],
                   to = t->box.hi[d] + reach - t->shift[d];
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

static int add_item(ghost_plan *plan, int i, const ghost_target *t) {
  const size_t n = (size_t)plan->count + 1;
  PART_TRY(part_grow(n, sizeof *plan->item, &plan->item_room, &plan->item));
  PART_TRY(part_grow(n, sizeof *plan->destination, &plan->destination_room, &plan->destination));
  PART_TRY(part_grow(3 * n, sizeof *plan->shift, &plan->shift_room, &plan->shift));
  plan->item[plan->count] = i;
  plan->destination[plan->count] = t->rank;
  memcpy(plan->shift + 3 * (n - 1), t->shift, sizeof t->shift);
  plan->count++;
  return PART_OK;
}

static int choose_items(ghost_plan *plan, const part_store *store, const part_region *own,
                        const ghost_target *targets, int count, double reach) {
  const double *x = part_record_double(store, 0);
  const size_t width = (size_t)store->layout->records[0].width;
  const part_region core = find_core(own, targets, count, reach);
  for (int i = 0; i < store->local && count > 0; i++) {
    const double *p = x + (size_t)i * width;
    if (inside(&core, p))
      continue;
    for (int k = 0; k < count; k++)
      if (distance2(&targets[k], p) <= reach * reach)
        PART_TRY(add_item(plan, i, &targets[k]));
  }
  return PART_OK;
}

/* Positions that are shifted round off; a copy more does no harm, one too few would. */
static double with_slack(const part_domain *domain, const part_region *own, double reach) {
  double largest = 0.0;
  for (int d = 0; d < 3; d++) {
    largest = fmax(largest, fmax(fabs(domain->box.lo[d]), fabs(domain->box.hi[d])));
    if (own->lo[d] <= own->hi[d])
      largest = fmax(largest, fmax(fabs(own->lo[d]), fabs(own->hi[d])));
  }
  return reach + 8.0 * DBL_EPSILON * (reach + largest);
}

static int choose(part_domain *domain, const part_store *store, const part_region *boxes,
                  double reach) {
  ghost_plan *plan = &domain->ghosts;
  const part_region *own = &boxes[domain->rank];
  const double wide = with_slack(domain, own, reach);
  ghost_target *targets = NULL;
  int count = 0;
  plan->count = 0;
  plan->local = store->local;
  int status = find_targets(domain, boxes, wide, &targets, &count);
  if (status == PART_OK)
    status = choose_items(plan, store, own, targets, count, wide);
  free(targets);
  return status;
}

/* Whole cache lines and halves of them, which the compiler copies in registers, or any size. */
static void copy_items(int n, const int *item, size_t bytes, const unsigned char *from,
                       unsigned char *to) {
  if (bytes == 64)
    for (int k = 0; k < n; k++, to += 64)
      memcpy(to, from + (size_t)item[k] * 64, 64);
  else if (bytes == 32)
    for (int k = 0; k < n; k++, to += 32)
      memcpy(to, from + (size_t)item[k] * 32, 32);
  else
    for (int k = 0; k < n; k++, to += bytes)
      memcpy(to, from + (size_t)item[k] * bytes, bytes);
}

/* Copies of the records taken, from the originals into the ghosts. On one rank straight from
 * particle to particle. */
static int refresh(part_domain *domain, part_store *store, const unsigned char *take) {
  ghost_plan *plan = &domain->ghosts;
  const part_layout *layout = store->layout;
  const size_t size = part_records_size(layout, take);
  if (domain->size > 1) {
    part_records_pack(store, take, plan->count, plan->item, plan->send);
    for (size_t k = 0; k < (size_t)plan->count; k++) { /* an item begins with x, y, z */
      double x[3];
      memcpy(x, plan->send + k * size, sizeof x);
      for (int d = 0; d < 3; d++)
        x[d] += plan->shift[3 * k + (size_t)d];
      memcpy(plan->send + k * size, x, sizeof x);
    }
    PART_TRY(part_exchange_forward(plan->exchange, size, plan->send, plan->received));
    part_records_unpack(store, take, store->local, store->ghost, plan->received);
    return PART_OK;
  }
  for (int r = 0; r < layout->record_count; r++) {
    if (!take[r])
      continue;
    const size_t bytes = (size_t)layout->records[r].width * 8;
    unsigned char *from = (unsigned char *)store->record[r];
    unsigned char *to = from + (size_t)store->local * bytes;
    copy_items(plan->count, plan->item, bytes, from, to);
  }
  const size_t width = (size_t)layout->records[0].width;
  double *ghost = part_record_double(store, 0) + (size_t)store->local * width;
  for (size_t k = 0; k < (size_t)plan->count; k++)
    for (size_t d = 0; d < 3; d++)
      ghost[k * width + d] += plan->shift[3 * k + d];
  return PART_OK;
}

static int make_room(part_domain *domain, part_store *store, int ghosts, size_t size) {
  ghost_plan *plan = &domain->ghosts;
  if (ghosts > 2147483647 - store->local)
    return part_fail(PART_ERR_RANGE, "%d particles and %d ghosts on one rank", store->local,
                     ghosts);
  PART_TRY(part_store_reserve(store, store->local + ghosts));
  if (domain->size == 1)
    return PART_OK;
  PART_TRY(part_grow((size_t)plan->count * size, 1, &plan->send_room, &plan->send));
  return part_grow((size_t)ghosts * size, 1, &plan->received_room, &plan->received);
}

static int make_plan(part_domain *domain, part_store *store, part_region *boxes, double reach) {
  ghost_plan *plan = &domain->ghosts;
  if (domain->size == 1)
    return choose(domain, store, boxes, reach);
  if (MPI_Allgather(MPI_IN_PLACE, 0, MPI_DATATYPE_NULL, boxes, sizeof *boxes, MPI_BYTE,
                    domain->comm) != MPI_SUCCESS)
    return part_fail(PART_ERR_MPI, "MPI_Allgather failed");
  PART_TRY(part_agree(domain->comm, choose(domain, store, boxes, reach)));
  return part_exchange_create(domain->comm, plan->count, plan->destination, &plan->exchange);
}

int part_domain_ghosts(part_domain *domain, part_store *store, double reach) {
  ghost_plan *plan = &domain->ghosts;
  part_region *boxes = NULL;
  unsigned char take[PART_RECORDS_MAX];
  store->ghost = 0;
  part_exchange_destroy(plan->exchange);
  plan->exchange = NULL;
  plan->count = 0;
  int status = check_reach(domain, store, reach);
  if (status == PART_OK)
    status = part_allocate((size_t)domain->size, sizeof *boxes, &boxes);
  status = part_domain_agree(domain, status);
  if (status == PART_OK) {
    boxes[domain->rank] = surround(store);
    status = make_plan(domain, store, boxes, reach);
  }
  free(boxes);
  PART_TRY(status);
  /* Position and id are on every copy; what has PART_GHOST is kept up to date as well. */
  part_records_flagged(store->layout, PART_GHOST, plan->take);
  plan->take[0] = 1;
  memcpy(take, plan->take, sizeof take);
  take[store->layout->fields[store->layout->id_field].record] = 1;
  const int ghosts =
      plan->exchange != NULL ? part_exchange_receive_count(plan->exchange) : plan->count;
  PART_TRY(part_domain_agree(
      domain, make_room(domain, store, ghosts, part_records_size(store->layout, take))));
  store->ghost = ghosts;
  part_records_zero(store, store->local, ghosts);
  return refresh(domain, store, take);
}

/* Is the exchange that of the particles and ghosts in the store? */
static int check_plan(const part_domain *domain, const part_store *store) {
  const ghost_plan *plan = &domain->ghosts;
  const int ghosts =
      plan->exchange != NULL ? part_exchange_receive_count(plan->exchange) : plan->count;
  if (plan->local != store->local || ghosts != store->ghost)
    return part_fail(PART_ERR_STATE,
                     "%d particles with %d ghosts, but the exchange was made for %d with %d: call "
                     "part_domain_ghosts after a change",
                     store->local, store->ghost, plan->local, ghosts);
  if (domain->size > 1 && plan->exchange == NULL)
    return part_fail(PART_ERR_STATE, "part_domain_ghosts was not called");
  return PART_OK;
}

int part_domain_update_ghosts(part_domain *domain, part_store *store) {
  PART_TRY(check_plan(domain, store));
  return refresh(domain, store, domain->ghosts.take);
}

int part_domain_copy_to_ghosts(part_domain *domain, const part_store *store, size_t size,
                               const void *own, void *ghosts) {
  ghost_plan *plan = &domain->ghosts;
  PART_TRY(check_plan(domain, store));
  if (domain->size == 1) {
    copy_items(plan->count, plan->item, size, own, ghosts);
    return PART_OK;
  }
  PART_TRY(part_domain_agree(
      domain, part_grow((size_t)plan->count * size, 1, &plan->send_room, &plan->send)));
  copy_items(plan->count, plan->item, size, own, plan->send);
  return part_exchange_forward(plan->exchange, size, plan->send, ghosts);
}
