/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <stdlib.h>
#include <string.h>

#include "domain.h"
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

int part_ghost_plan_add(ghost_plan *plan, int i, int rank, const double shift[3]) {
  const size_t n = (size_t)plan->count + 1;
  PART_TRY(part_grow(n, sizeof *plan->item, &plan->item_room, &plan->item));
  PART_TRY(part_grow(n, sizeof *plan->destination, &plan->destination_room, &plan->destination));
  PART_TRY(part_grow(3 * n, sizeof *plan->shift, &plan->shift_room, &plan->shift));
  plan->item[plan->count] = i;
  plan->destination[plan->count] = rank;
  memcpy(plan->shift + 3 * (n - 1), shift, 3 * sizeof *shift);
  plan->count++;
  return PART_OK;
}
