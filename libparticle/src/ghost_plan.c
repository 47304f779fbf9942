/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The messages that refresh ghosts. What a rank gets from another lies together among its ghosts,
 * so messages arrive in place, one for each record; copies within a rank go from particle to
 * particle. So a copy for another rank is touched twice, when it is packed and by MPI. */
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "domain.h"
#include "memory.h"
#include "particle/status.h"

enum { GHOST_TAG = 7302, TRIM_TAG };

void part_ghost_plan_free(ghost_plan *plan) {
  free(plan->item);
  free(plan->image);
  free(plan->shift);
  free(plan->to);
  free(plan->from);
  free(plan->request);
  free(plan->send);
  memset(plan, 0, sizeof *plan);
}

/* Peers from the ranks of n items, in increasing order. */
static int find_peers(int self, int n, const int *rank, ghost_peer *own, ghost_peer **peers,
                      int *n_peers, int *widest) {
  int changes = 0;
  for (int k = 0; k < n; k++)
    changes += k == 0 || rank[k] != rank[k - 1];
  *own = (ghost_peer){self, 0, 0};
  PART_TRY(part_allocate((size_t)changes, sizeof **peers, peers));
  for (int k = 0, end; k < n; k = end) {
    for (end = k + 1; end < n && rank[end] == rank[k];)
      end++;
    const ghost_peer peer = {rank[k], end - k, k};
    *widest = peer.count > *widest ? peer.count : *widest;
    if (peer.rank == self)
      *own = peer;
    else
      (*peers)[(*n_peers)++] = peer;
  }
  return PART_OK;
}

/* The ranks that copies come from. One rank asks itself only. */
static int find_sources(part_domain *domain, const int *destination) {
  ghost_plan *plan = &domain->ghosts;
  part_exchange *exchange = NULL;
  if (domain->size == 1) {
    plan->ghosts = plan->count;
    return find_peers(0, plan->count, destination, &plan->own_from, &plan->from, &plan->n_from,
                      &plan->widest);
  }
  PART_TRY(part_exchange_create(domain->comm, plan->count, destination, &exchange));
  plan->ghosts = part_exchange_receive_count(exchange);
  const int status = find_peers(domain->rank, plan->ghosts, part_exchange_source(exchange),
                                &plan->own_from, &plan->from, &plan->n_from, &plan->widest);
  part_exchange_destroy(exchange);
  return status;
}

int part_ghost_plan_make(part_domain *domain, int count, const int *destination, int images,
                         const double *shift) {
  ghost_plan *plan = &domain->ghosts;
  free(plan->shift);
  free(plan->to);
  free(plan->from);
  plan->shift = NULL;
  plan->to = plan->from = NULL;
  plan->n_to = plan->n_from = plan->widest = 0;
  plan->count = count;
  int status = part_allocate(3 * (size_t)images, sizeof *plan->shift, &plan->shift);
  if (status == PART_OK && images > 0)
    memcpy(plan->shift, shift, 3 * (size_t)images * sizeof *shift);
  if (status == PART_OK)
    status = find_peers(domain->rank, count, destination, &plan->own_to, &plan->to, &plan->n_to,
                        &plan->widest);
  PART_TRY(part_domain_agree(domain, status));
  PART_TRY(part_domain_agree(domain, find_sources(domain, destination)));
  plan->made = 1;
  return PART_OK;
}

int part_ghost_room(part_domain *domain, size_t room, int arrays) {
  ghost_plan *plan = &domain->ghosts;
  const size_t requests = (size_t)(plan->n_to + plan->n_from) * (size_t)arrays;
  if (room % 8 != 0)
    return part_fail(PART_ERR_ARGUMENT, "%zu bytes for each ghost: must be a multiple of 8", room);
  if ((size_t)plan->widest * (room / 8) > INT_MAX)
    return part_fail(PART_ERR_RANGE, "%d ghosts of %zu bytes from or to one rank", plan->widest,
                     room);
  PART_TRY(part_grow((size_t)(plan->count - plan->own_to.count) * room, 1, &plan->send_room,
                     &plan->send));
  return part_grow(requests, sizeof *plan->request, &plan->request_room, &plan->request);
}

/* Whole cache lines and halves of them, which the compiler copies in registers, or any size. */
static void copy_plain(int n, const int *item, size_t bytes, const unsigned char *from,
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

static void shift_copies(int n, const int *image, const double *shift, size_t bytes,
                         unsigned char *to) {
  for (int k = 0; k < n; k++, to += bytes) {
    double x[3];
    memcpy(x, to, sizeof x);
    for (int d = 0; d < 3; d++)
      x[d] += shift[3 * (size_t)image[k] + (size_t)d];
    memcpy(to, x, sizeof x);
  }
}

static void copy_items(const ghost_plan *plan, const ghost_peer *peer, size_t bytes, int shifted,
                       const void *own, unsigned char *to) {
  copy_plain(peer->count, plan->item + peer->first, bytes, (const unsigned char *)own, to);
  if (shifted)
    shift_copies(peer->count, plan->image + peer->first, plan->shift, bytes, to);
}

int part_ghost_begin(part_domain *domain, size_t size, int shifted, const void *own, void *copies) {
  ghost_plan *plan = &domain->ghosts;
  unsigned char *to = (unsigned char *)copies;
  int ok = 1;
  for (int p = 0; p < plan->n_from && ok; p++) {
    const ghost_peer *from = &plan->from[p];
    ok = MPI_Irecv(to + (size_t)from->first * size, from->count * (int)(size / 8), MPI_INT64_T,
                   from->rank, GHOST_TAG, domain->comm,
                   &plan->request[plan->pending++]) == MPI_SUCCESS;
  }
  for (int p = 0; p < plan->n_to && ok; p++) {
    const ghost_peer *peer = &plan->to[p];
    unsigned char *send = plan->send + plan->sent;
    copy_items(plan, peer, size, shifted, own, send);
    ok = MPI_Isend(send, peer->count * (int)(size / 8), MPI_INT64_T, peer->rank, GHOST_TAG,
                   domain->comm, &plan->request[plan->pending++]) == MPI_SUCCESS;
    plan->sent += (size_t)peer->count * size;
  }
  copy_items(plan, &plan->own_to, size, shifted, own, to + (size_t)plan->own_from.first * size);
  return ok ? PART_OK : part_fail(PART_ERR_MPI, "MPI_Isend or MPI_Irecv failed");
}

int part_ghost_end(part_domain *domain) {
  ghost_plan *plan = &domain->ghosts;
  const int n = plan->pending;
  plan->pending = 0;
  plan->sent = 0;
  if (n > 0 && MPI_Waitall(n, plan->request, MPI_STATUSES_IGNORE) != MPI_SUCCESS)
    return part_fail(PART_ERR_MPI, "MPI_Waitall failed");
  return PART_OK;
}

/* ---- ghosts that nobody needs -----------------------------------------------------------------
 */

/* Which copies that this rank gives are needed, from those who get them. */
static int tell_needed(part_domain *domain, const unsigned char *needed, unsigned char *wanted) {
  ghost_plan *plan = &domain->ghosts;
  int n = 0, ok = 1;
  for (int p = 0; p < plan->n_to && ok; p++)
    ok = MPI_Irecv(wanted + plan->to[p].first, plan->to[p].count, MPI_BYTE, plan->to[p].rank,
                   TRIM_TAG, domain->comm, &plan->request[n++]) == MPI_SUCCESS;
  for (int p = 0; p < plan->n_from && ok; p++)
    ok = MPI_Isend(needed + plan->from[p].first, plan->from[p].count, MPI_BYTE, plan->from[p].rank,
                   TRIM_TAG, domain->comm, &plan->request[n++]) == MPI_SUCCESS;
  if (plan->own_to.count > 0)
    memcpy(wanted + plan->own_to.first, needed + plan->own_from.first, (size_t)plan->own_to.count);
  ok = ok && (n == 0 || MPI_Waitall(n, plan->request, MPI_STATUSES_IGNORE) == MPI_SUCCESS);
  return ok ? PART_OK : part_fail(PART_ERR_MPI, "ghosts that are needed: a message failed");
}

/* place[k]: kept ones before k. */
static void find_places(int n, const unsigned char *keep, int *place) {
  place[0] = 0;
  for (int k = 0; k < n; k++)
    place[k + 1] = place[k] + (keep[k] != 0);
}

static void trim_peers(const int *place, ghost_peer *own, ghost_peer *peers, int *n_peers) {
  const int n = *n_peers;
  *n_peers = 0;
  for (int p = -1; p < n; p++) {
    ghost_peer *old = p < 0 ? own : &peers[p];
    const int first = place[old->first], count = place[old->first + old->count] - first;
    const ghost_peer now = {old->rank, count, first};
    if (p < 0)
      *own = now;
    else if (count > 0)
      peers[(*n_peers)++] = now;
  }
}

static void trim_items(ghost_plan *plan, const unsigned char *wanted, const int *place) {
  for (int k = 0; k < plan->count; k++)
    if (wanted[k]) {
      plan->item[place[k]] = plan->item[k];
      plan->image[place[k]] = plan->image[k];
    }
  trim_peers(place, &plan->own_to, plan->to, &plan->n_to);
  plan->count = place[plan->count];
}

static void trim_copies(const part_store *store, const unsigned char *needed, const int *place) {
  for (int r = 0; r < store->layout->record_count; r++) {
    const size_t bytes = (size_t)store->layout->records[r].width * 8;
    unsigned char *ghosts = (unsigned char *)store->record[r] + (size_t)store->local * bytes;
    for (int g = 0; g < store->ghost; g++)
      if (needed[g] && place[g] < g)
        memcpy(ghosts + (size_t)place[g] * bytes, ghosts + (size_t)g * bytes, bytes);
  }
}

int part_ghost_trim(part_domain *domain, part_store *store, const unsigned char *needed,
                    int *place) {
  ghost_plan *plan = &domain->ghosts;
  unsigned char *wanted = NULL;
  int *item_place = NULL;
  int status = part_allocate((size_t)plan->count, 1, &wanted);
  if (status == PART_OK)
    status = part_allocate((size_t)plan->count + 1, sizeof *item_place, &item_place);
  status = part_domain_agree(domain, status);
  if (status == PART_OK)
    status = tell_needed(domain, needed, wanted);
  if (status == PART_OK) {
    find_places(plan->count, wanted, item_place);
    trim_items(plan, wanted, item_place);
    find_places(plan->ghosts, needed, place);
    trim_copies(store, needed, place);
    trim_peers(place, &plan->own_from, plan->from, &plan->n_from);
    store->ghost = plan->ghosts = place[plan->ghosts];
  }
  free(wanted);
  free(item_place);
  return status;
}
