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

/* The records taken on their way to the ghosts. */
static int begin_refresh(part_domain *domain, part_store *store, const unsigned char *take) {
  for (int r = 0; r < store->layout->record_count; r++) {
    const size_t bytes = (size_t)store->layout->records[r].width * 8;
    unsigned char *own = (unsigned char *)store->record[r];
    if (take[r])
      PART_TRY(part_ghost_begin(domain, bytes, r == 0, own, own + (size_t)store->local * bytes));
  }
  return PART_OK;
}

static int make_room(part_domain *domain, part_store *store, size_t size) {
  const int ghosts = domain->ghosts.ghosts;
  if (ghosts > 2147483647 - store->local)
    return part_fail(PART_ERR_RANGE, "%d particles and %d ghosts on one rank", store->local,
                     ghosts);
  PART_TRY(part_store_reserve(store, store->local + ghosts));
  return part_ghost_room(domain, size, store->layout->record_count);
}

/* The items in the order of the ranks they go to; those of one rank stay in order. */
static int order_items(ghost_plan *plan, const ghost_choice *choice, int *destination) {
  int *next;
  PART_TRY(part_allocate((size_t)choice->domain->size + 1, sizeof *next, &next));
  for (int k = 0; k < choice->items; k++)
    next[choice->target[choice->item[k].target].rank + 1]++;
  for (int r = 1; r < choice->domain->size; r++)
    next[r] += next[r - 1];
  for (int k = 0; k < choice->items; k++) {
    const int rank = choice->target[choice->item[k].target].rank, at = next[rank]++;
    plan->item[at] = choice->item[k].particle;
    plan->image[at] = choice->item[k].target;
    destination[at] = rank;
  }
  free(next);
  return PART_OK;
}

static int choice_arrays(ghost_plan *plan, const ghost_choice *choice, int **destination,
                         double **shift) {
  const size_t n = (size_t)choice->items;
  PART_TRY(part_grow(n, sizeof *plan->item, &plan->item_room, &plan->item));
  PART_TRY(part_grow(n, sizeof *plan->image, &plan->image_room, &plan->image));
  PART_TRY(part_allocate(n, sizeof **destination, destination));
  PART_TRY(part_allocate(3 * (size_t)choice->targets, sizeof **shift, shift));
  for (size_t k = 0; k < (size_t)choice->targets; k++)
    memcpy(*shift + 3 * k, choice->target[k].shift, 3 * sizeof **shift);
  return order_items(plan, choice, *destination);
}

/* The choice as an exchange. */
static int make_plan(part_domain *domain, const ghost_choice *choice) {
  int *destination = NULL;
  double *shift = NULL;
  int status =
      part_domain_agree(domain, choice_arrays(&domain->ghosts, choice, &destination, &shift));
  if (status == PART_OK)
    status = part_ghost_plan_make(domain, choice->items, destination, choice->targets, shift);
  free(destination);
  free(shift);
  return status;
}

/* First copies: position and id are on every one; what has PART_GHOST is kept up to date too. */
static int first_copies(part_domain *domain, part_store *store) {
  ghost_plan *plan = &domain->ghosts;
  unsigned char take[PART_RECORDS_MAX];
  part_records_flagged(store->layout, PART_GHOST, plan->take);
  plan->take[0] = 1;
  memcpy(take, plan->take, sizeof take);
  take[store->layout->fields[store->layout->id_field].record] = 1;
  PART_TRY(
      part_domain_agree(domain, make_room(domain, store, part_records_size(store->layout, take))));
  store->ghost = plan->ghosts;
  part_records_zero(store, store->local, plan->ghosts);
  PART_TRY(begin_refresh(domain, store, take));
  return part_ghost_end(domain);
}

static int make_ghosts(part_domain *domain, part_store *store, ghost_choice *choice) {
  ghost_plan *plan = &domain->ghosts;
  store->ghost = 0;
  plan->made = 0;
  plan->count = plan->ghosts = 0;
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
  if (plan->local != store->local || plan->ghosts != store->ghost)
    return part_fail(PART_ERR_STATE,
                     "%d particles with %d ghosts, but the exchange was made for %d with %d: call "
                     "part_domain_ghosts after a change",
                     store->local, store->ghost, plan->local, plan->ghosts);
  if (domain->size > 1 && !plan->made)
    return part_fail(PART_ERR_STATE, "part_domain_ghosts was not called");
  return PART_OK;
}

int part_domain_send_ghosts(part_domain *domain, part_store *store) {
  PART_TRY(check_plan(domain, store));
  return begin_refresh(domain, store, domain->ghosts.take);
}

int part_domain_receive_ghosts(part_domain *domain) {
  return part_ghost_end(domain);
}

int part_domain_update_ghosts(part_domain *domain, part_store *store) {
  PART_TRY(part_domain_send_ghosts(domain, store));
  return part_ghost_end(domain);
}

int part_domain_copy_to_ghosts(part_domain *domain, const part_store *store, size_t size,
                               const void *own, void *ghosts) {
  PART_TRY(check_plan(domain, store));
  PART_TRY(part_domain_agree(domain, part_ghost_room(domain, size, 1)));
  PART_TRY(part_ghost_begin(domain, size, 0, own, ghosts));
  return part_ghost_end(domain);
}

int part_domain_trim_ghosts(part_domain *domain, part_store *store, const unsigned char *needed,
                            int *place) {
  PART_TRY(check_plan(domain, store));
  return part_ghost_trim(domain, store, needed, place);
}
