/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Own particles to the ranks that own their places. Those that stay keep their order and come
 * first; those that arrive follow by source rank and the order they had there. */
#include "domain.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "memory.h"
#include "particle/status.h"

/* What migrate holds while it works. */
typedef struct migration {
  int leaving, arriving;
  unsigned char *keep;      /* [local] */
  int *index, *destination; /* [leaving] */
  unsigned char *send, *received;
  size_t element;                          /* bytes of a payload element */
  int *leave_count, *arrive_count, *count; /* payload elements per particle: sent, received, new */
  unsigned char *leave_payload, *payload;
  void *arrive_payload;
  part_exchange *plan;
} migration;

static void migration_free(migration *m) {
  free(m->keep);
  free(m->index);
  free(m->destination);
  free(m->send);
  free(m->received);
  free(m->leave_count);
  free(m->arrive_count);
  free(m->count);
  free(m->leave_payload);
  free(m->payload);
  free(m->arrive_payload);
  part_exchange_destroy(m->plan);
}

static int check_positions(const part_domain *domain, const part_store *store) {
  const part_box *box = &domain->box;
  const double *x = part_record_double(store, 0);
  const size_t width = (size_t)store->layout->records[0].width;
  for (int i = 0; i < store->local; i++)
    for (int d = 0; d < 3; d++) {
      const double v = x[(size_t)i * width + (size_t)d];
      if (!isfinite(v))
        return part_domain_fail_at(store, i, PART_ERR_OUTSIDE, "is not at a finite place");
      if (box->bounded[d] && !box->periodic[d] && (v < box->lo[d] || v > box->hi[d])) {
        part_domain_fail_at(store, i, PART_ERR_OUTSIDE, "left the domain");
        return part_fail(PART_ERR_OUTSIDE, "%s, which is from %.10g to %.10g m in direction %c",
                         part_last_error(), box->lo[d], box->hi[d], "xyz"[d]);
      }
    }
  return PART_OK;
}

/* Wrap homes, and shift positions as their homes are. */
static void wrap_homes(const part_domain *domain, part_store *store, double *home) {
  double *x = part_record_double(store, 0);
  const size_t width = (size_t)store->layout->records[0].width;
  for (size_t i = 0; i < (size_t)store->local; i++) {
    const double before[3] = {home[3 * i], home[3 * i + 1], home[3 * i + 2]};
    part_box_wrap(&domain->box, home + 3 * i, NULL);
    for (size_t d = 0; d < 3; d++) { /* at home without rounding */
      const double shift = home[3 * i + d] - before[d];
      x[i * width + d] = x[i * width + d] == before[d] ? home[3 * i + d] : x[i * width + d] + shift;
    }
  }
}

static void wrap_positions(const part_domain *domain, part_store *store, double *home) {
  const part_box *box = &domain->box;
  double *x = part_record_double(store, 0);
  const size_t width = (size_t)store->layout->records[0].width;
  if (!box->periodic[0] && !box->periodic[1] && !box->periodic[2])
    return;
  if (home != NULL)
    wrap_homes(domain, store, home);
  else
    for (int i = 0; i < store->local; i++)
      part_box_wrap(box, x + (size_t)i * width, NULL);
}

static int find_leaving(const part_domain *domain, const part_store *store, const double *home,
                        migration *m) {
  const double *x = part_record_double(store, 0);
  const size_t width = (size_t)store->layout->records[0].width, n = (size_t)store->local;
  PART_TRY(part_allocate(n, 1, &m->keep));
  PART_TRY(part_allocate(n, sizeof *m->index, &m->index));
  PART_TRY(part_allocate(n, sizeof *m->destination, &m->destination));
  for (int i = 0; i < store->local; i++) {
    const int owner =
        part_domain_owner(domain, home != NULL ? home + 3 * (size_t)i : x + (size_t)i * width);
    if (owner < 0)
      return part_domain_fail_at(store, i, PART_ERR_STATE, "is in no rank's part");
    m->keep[i] = owner == domain->rank;
    if (m->keep[i])
      continue;
    m->index[m->leaving] = i;
    m->destination[m->leaving++] = owner;
  }
  return PART_OK;
}

/* Payload of the leaving into a buffer of its own. */
static int pack_payload(const part_store *store, migration *m, const int *count,
                        const unsigned char *payload) {
  size_t total = 0;
  PART_TRY(part_allocate((size_t)m->leaving, sizeof *m->leave_count, &m->leave_count));
  for (int k = 0; k < m->leaving; k++) {
    m->leave_count[k] = count[m->index[k]];
    total += (size_t)m->leave_count[k];
  }
  PART_TRY(part_allocate(total, m->element, &m->leave_payload));
  unsigned char *to = m->leave_payload;
  for (int i = 0; i < store->local; i++) {
    const size_t bytes = (size_t)count[i] * m->element;
    if (!m->keep[i] && bytes > 0) {
      memcpy(to, payload, bytes);
      to += bytes;
    }
    if (bytes > 0)
      payload += bytes;
  }
  return PART_OK;
}

static int pack(const part_store *store, migration *m, const int *count,
                const unsigned char *payload) {
  PART_TRY(part_allocate((size_t)m->leaving, part_store_item_size(store, PART_MOVES), &m->send));
  part_store_pack(store, PART_MOVES, m->leaving, m->index, m->send);
  return count != NULL ? pack_payload(store, m, count, payload) : PART_OK;
}

/* Payload of those that stay, then of those that arrived. */
static int join_payload(const part_store *store, migration *m, const int *count,
                        const unsigned char *payload) {
  const size_t n = (size_t)(store->local - m->leaving + m->arriving);
  size_t stay = 0, arrive = 0, at = 0;
  for (int i = 0; i < store->local; i++)
    stay += m->keep[i] ? (size_t)count[i] : 0;
  for (int k = 0; k < m->arriving; k++)
    arrive += (size_t)m->arrive_count[k];
  PART_TRY(part_allocate(n, sizeof *m->count, &m->count));
  PART_TRY(part_allocate(stay + arrive, m->element, &m->payload));
  unsigned char *to = m->payload;
  for (int i = 0; i < store->local; i++) {
    const size_t bytes = (size_t)count[i] * m->element;
    if (m->keep[i]) {
      m->count[at++] = count[i];
      if (bytes > 0)
        memcpy(to, payload, bytes);
      to += bytes;
    }
    if (bytes > 0)
      payload += bytes;
  }
  for (int k = 0; k < m->arriving; k++)
    m->count[at++] = m->arrive_count[k];
  if (arrive > 0)
    memcpy(to, m->arrive_payload, arrive * m->element);
  return PART_OK;
}

static int receive_room(part_store *store, migration *m) {
  const long long n = (long long)store->local + m->arriving;
  if (n > 2147483647)
    return part_fail(PART_ERR_RANGE, "%lld particles on one rank", n);
  PART_TRY(part_store_reserve(store, (int)n)); /* unpacking cannot fail after this */
  return part_allocate((size_t)m->arriving, part_store_item_size(store, PART_MOVES), &m->received);
}

/* Everything that can fail; the store keeps its particles. */
static int exchange(part_domain *domain, part_store *store, const double *home, migration *m,
                    const int *count, const unsigned char *payload) {
  int status = find_leaving(domain, store, home, m);
  if (status == PART_OK)
    status = pack(store, m, count, payload);
  PART_TRY(part_agree(domain->comm, status));
  PART_TRY(part_exchange_create(domain->comm, m->leaving, m->destination, &m->plan));
  m->arriving = part_exchange_receive_count(m->plan);
  PART_TRY(part_agree(domain->comm, receive_room(store, m)));
  PART_TRY(part_exchange_forward(m->plan, part_store_item_size(store, PART_MOVES), m->send,
                                 m->received));
  if (m->element == 0)
    return PART_OK;
  PART_TRY(part_exchange_forward_variable(m->plan, m->element, m->leave_count, m->leave_payload,
                                          &m->arrive_count, &m->arrive_payload));
  return part_agree(domain->comm, join_payload(store, m, count, payload));
}

/* Every home must be a place too: a NaN is in no part. */
static int check_homes(const part_store *store, const double *home) {
  for (int i = 0; home != NULL && i < store->local; i++)
    if (!isfinite(home[3 * i]) || !isfinite(home[3 * i + 1]) || !isfinite(home[3 * i + 2]))
      return part_domain_fail_at(store, i, PART_ERR_OUTSIDE, "has a home that is not finite");
  return PART_OK;
}

static int check(const part_domain *domain, const part_store *store, const double *home) {
  PART_TRY(check_positions(domain, store));
  return check_homes(store, home);
}

int part_domain_migrate(part_domain *domain, part_store *store, size_t payload_size,
                        int **payload_count, void **payload) {
  return part_domain_migrate_home(domain, store, NULL, payload_size, payload_count, payload);
}

int part_domain_migrate_home(part_domain *domain, part_store *store, double *home,
                             size_t payload_size, int **payload_count, void **payload) {
  const int has_payload = payload_count != NULL && payload != NULL && payload_size > 0;
  PART_TRY(part_domain_agree(domain, check(domain, store, home)));
  wrap_positions(domain, store, home);
  store->ghost = 0;
  if (domain->size == 1)
    return PART_OK;
  migration m = {.element = has_payload ? payload_size : 0};
  const int status = exchange(domain, store, home, &m, has_payload ? *payload_count : NULL,
                              has_payload ? (const unsigned char *)*payload : NULL);
  if (status == PART_OK) {
    part_store_compact(store, m.keep);
    int first;
    part_store_append(store, m.arriving, &first);
    part_store_unpack(store, PART_MOVES, first, m.arriving, m.received);
    if (has_payload) {
      int *old_count = *payload_count;
      unsigned char *old = (unsigned char *)*payload;
      *payload_count = m.count;
      *payload = m.payload;
      m.count = old_count; /* freed below */
      m.payload = old;
    }
  }
  migration_free(&m);
  return status;
}
