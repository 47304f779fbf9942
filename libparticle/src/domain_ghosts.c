/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ghost copies: making the exchange, and repeating it. Who needs a copy of what: ghosts.h. */
#include "ghosts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "memory.h"
#include "particle/status.h"

/* Farther out of a periodic box than this, an image two periods away could be missed. */
static const double farthest_out = 0.25;

static int check_places(const part_domain *domain, const part_store *store) {
  const part_box *box = &domain->box;
  const double *x = part_record_double(store, 0);
  const size_t width = (size_t)store->layout->records[0].width;
  double lo[3], hi[3];
  for (int d = 0; d < 3; d++) {
    const double most = farthest_out * (box->hi[d] - box->lo[d]);
    lo[d] = box->periodic[d] ? box->lo[d] - most : -HUGE_VAL;
    hi[d] = box->periodic[d] ? box->hi[d] + most : HUGE_VAL;
  }
  for (int i = 0; i < store->local; i++)
    for (int d = 0; d < 3; d++) {
      const double v = x[(size_t)i * width + (size_t)d];
      if (!isfinite(v) || v < lo[d] || v > hi[d])
        return part_domain_fail_at(store, i, PART_ERR_OUTSIDE,
                                   "is not finite or far out of a periodic box: migrate first");
    }
  return PART_OK;
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

/* The choice as an exchange. */
static int make_plan(part_domain *domain, const ghost_choice *choice) {
  ghost_plan *plan = &domain->ghosts;
  int status = PART_OK;
  for (int k = 0; k < choice->items && status == PART_OK; k++) {
    const ghost_target *t = &choice->target[choice->item[k].target];
    status = part_ghost_plan_add(plan, choice->item[k].particle, t->rank, t->shift);
  }
  PART_TRY(part_domain_agree(domain, status));
  if (domain->size == 1)
    return PART_OK;
  return part_exchange_create(domain->comm, plan->count, plan->destination, &plan->exchange);
}

/* First copies: position and id are on every one; what has PART_GHOST is kept up to date as well. */
static int first_copies(part_domain *domain, part_store *store) {
  ghost_plan *plan = &domain->ghosts;
  unsigned char take[PART_RECORDS_MAX];
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

static int make_ghosts(part_domain *domain, part_store *store, ghost_choice *choice) {
  ghost_plan *plan = &domain->ghosts;
  store->ghost = 0;
  part_exchange_destroy(plan->exchange);
  plan->exchange = NULL;
  plan->count = 0;
  plan->local = store->local;
  int status = !(choice->skin >= 0.0 && choice->levels.top[0] < INFINITY)
                   ? part_fail(PART_ERR_RANGE, "reach or skin of ghosts is not in [0, inf)")
                   : check_places(domain, store);
  status = part_domain_agree(domain, status);
  choice->domain = domain;
  choice->store = store;
  choice->points.x = part_record_double(store, 0);
  choice->points.x_stride = store->layout->records[0].width;
  if (status == PART_OK)
    status = part_ghost_boxes(choice);
  if (status == PART_OK)
    status = part_ghost_partners(choice);
  if (status == PART_OK)
    status = make_plan(domain, choice);
  part_ghost_choice_free(choice);
  PART_TRY(status);
  return first_copies(domain, store);
}

int part_domain_ghosts(part_domain *domain, part_store *store, double reach) {
  const double r = 0.5 * reach; /* the same for all */
  ghost_choice choice = {.points = {.r = &r, .r_stride = 0}, .levels = {1, {r}}};
  choice.skin = reach >= 0.0 ? 0.0 : NAN;
  return make_ghosts(domain, store, &choice);
}

int part_domain_sphere_ghosts(part_domain *domain, part_store *store, int radius_field,
                              const part_levels *levels, double skin) {
  ghost_choice choice = {.levels = *levels, .skin = skin};
  choice.points.r = part_field_double(store, radius_field);
  choice.points.r_stride = part_field_stride(store, radius_field);
  return make_ghosts(domain, store, &choice);
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
