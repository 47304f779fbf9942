/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "match.h"
#include <stdlib.h>
#include <string.h>
#include "memory.h"
#include "particle/exchange.h"

struct cpl_match {
  MPI_Comm comm;
  int size, identical;
  int n_from, n_to;
  int *partner; /* [n_to] index into from, -1: on another rank */
  int away_from, away_to;
  int *from_away, *to_away;           /* indices of the particles without partner here */
  part_exchange *plan_from, *plan_to; /* to the directory; NULL when nothing is away anywhere */
  int *join;                          /* directory: item of plan_from for each item of plan_to */
};

void cpl_match_destroy(cpl_match *m) {
  if (!m)
    return;
  part_exchange_destroy(m->plan_from);
  part_exchange_destroy(m->plan_to);
  free(m->partner);
  free(m->from_away);
  free(m->to_away);
  free(m->join);
  free(m);
}

int cpl_match_identical(const cpl_match *m) {
  return m->identical;
}

/* ---- one rank: open addressing, load <= 1/2 ---------------------------------------------------
 */
static size_t slot_of(int64_t id, size_t mask) {
  uint64_t h = (uint64_t)id * UINT64_C(0x9e3779b97f4a7c15);
  return (size_t)(h ^ h >> 32) & mask;
}

/* partner[j] = i with from[i] == to[j], or -1. */
static int join_ids(int n_from, const int64_t *from, int n_to, const int64_t *to, int *partner) {
  size_t slots = 16;
  while (slots < 2 * (size_t)n_from)
    slots *= 2;
  int *table = malloc(slots * sizeof *table);
  if (!table)
    return part_fail(PART_ERR_MEMORY, "coupling: no memory to match %d particles", n_from);
  memset(table, 0xff, slots * sizeof *table); /* -1 */
  int status = PART_OK;
  for (int i = 0; i < n_from && status == PART_OK; i++) {
    size_t s = slot_of(from[i], slots - 1);
    for (; table[s] >= 0 && from[table[s]] != from[i]; s = (s + 1) & (slots - 1))
      ;
    if (table[s] >= 0)
      status = part_fail(PART_ERR_ARGUMENT, "coupling: particle id %lld is there twice",
                         (long long)from[i]);
    table[s] = i;
  }
  for (int j = 0; j < n_to && status == PART_OK; j++) {
    size_t s = slot_of(to[j], slots - 1);
    for (; table[s] >= 0 && from[table[s]] != to[j]; s = (s + 1) & (slots - 1))
      ;
    partner[j] = table[s];
  }
  free(table);
  return status;
}

/* Lists of the particles without partner on this rank. */
static int find_away(cpl_match *m) {
  unsigned char *used = calloc((size_t)m->n_from + 1, 1);
  m->from_away = malloc(((size_t)m->n_from + 1) * sizeof *m->from_away);
  m->to_away = malloc(((size_t)m->n_to + 1) * sizeof *m->to_away);
  int status = PART_OK;
  if (!used || !m->from_away || !m->to_away) {
    status = part_fail(PART_ERR_MEMORY, "coupling: no memory to match %d particles", m->n_from);
  } else {
    for (int j = 0; j < m->n_to; j++)
      if (m->partner[j] < 0)
        m->to_away[m->away_to++] = j;
      else
        used[m->partner[j]] = 1;
    for (int i = 0; i < m->n_from; i++)
      if (!used[i])
        m->from_away[m->away_from++] = i;
  }
  free(used);
  return status;
}

/* ---- directory ------------------------------------------------------------------------------ */
static int post(const cpl_match *m, int n, const int *index, const int64_t *id,
                part_exchange **plan, int64_t **posted) {
  int *destination = malloc(((size_t)n + 1) * sizeof *destination);
  int64_t *mine = malloc(((size_t)n + 1) * sizeof *mine);
  int status = PART_OK;
  if (!destination || !mine)
    status = part_fail(PART_ERR_MEMORY, "coupling: no memory to match %d particles", n);
  for (int k = 0; status == PART_OK && k < n; k++) {
    mine[k] = id[index[k]];
    destination[k] = (int)((uint64_t)mine[k] % (uint64_t)m->size);
  }
  status = part_agree(m->comm, status);
  if (status == PART_OK)
    status = part_exchange_create(m->comm, n, destination, plan);
  if (status == PART_OK) {
    *posted = malloc(((size_t)part_exchange_receive_count(*plan) + 1) * sizeof **posted);
    if (!*posted)
      status = part_fail(PART_ERR_MEMORY, "coupling: no memory for the directory of particles");
    status = part_agree(m->comm, status);
  }
  if (status == PART_OK)
    status = part_exchange_forward(*plan, sizeof **posted, mine, *posted);
  free(destination);
  free(mine);
  return status;
}

/* On this rank of the directory: every id posted by one side must be posted by the other. */
static int join_posted(cpl_match *m, const int64_t *from, const int64_t *to, const char *what) {
  const int n_from = part_exchange_receive_count(m->plan_from);
  const int n_to = part_exchange_receive_count(m->plan_to);
  unsigned char *used = calloc((size_t)n_from + 1, 1);
  m->join = malloc(((size_t)n_to + 1) * sizeof *m->join);
  int status = PART_OK;
  if (!m->join || !used)
    status = part_fail(PART_ERR_MEMORY, "coupling: no memory for the directory of particles");
  if (status == PART_OK)
    status = join_ids(n_from, from, n_to, to, m->join);
  const int64_t *odd = NULL;
  for (int j = 0; status == PART_OK && j < n_to; j++)
    if (m->join[j] < 0)
      odd = to + j;
    else
      used[m->join[j]] = 1;
  for (int i = 0; status == PART_OK && i < n_from; i++)
    if (!used[i])
      odd = from + i;
  if (odd)
    status = part_fail(PART_ERR_STATE,
                       "coupling: the set of particles has changed %s: %lld was "
                       "added or removed",
                       what, (long long)*odd);
  free(used);
  return status;
}

static int through_directory(cpl_match *m, const int64_t *from, const int64_t *to,
                             const char *what) {
  int64_t *posted_from = NULL, *posted_to = NULL;
  int status = post(m, m->away_from, m->from_away, from, &m->plan_from, &posted_from);
  if (status == PART_OK)
    status = post(m, m->away_to, m->to_away, to, &m->plan_to, &posted_to);
  if (status == PART_OK)
    status = part_agree(m->comm, join_posted(m, posted_from, posted_to, what));
  free(posted_from);
  free(posted_to);
  return status;
}

/* ---- creation ------------------------------------------------------------------------------- */
static int build(cpl_match *m, const int64_t *from, const int64_t *to, const char *what) {
  m->partner = malloc(((size_t)m->n_to + 1) * sizeof *m->partner);
  int status =
      m->partner ? PART_OK
                 : part_fail(PART_ERR_MEMORY, "coupling: no memory to match %d particles", m->n_to);
  if (status == PART_OK)
    status = join_ids(m->n_from, from, m->n_to, to, m->partner);
  if (status == PART_OK)
    status = find_away(m);
  PART_TRY(m->size > 1 ? part_agree(m->comm, status) : status);
  long long mine = m->away_from + m->away_to, all = mine;
  if (m->size > 1)
    MPI_Allreduce(&mine, &all, 1, MPI_LONG_LONG, MPI_SUM, m->comm);
  return all > 0 ? through_directory(m, from, to, what) : PART_OK;
}

int cpl_match_create(MPI_Comm comm, int n_from, const int64_t *from, int n_to, const int64_t *to,
                     const char *what, cpl_match **match) {
  cpl_match *m = calloc(1, sizeof *m);
  int status = m ? PART_OK : part_fail(PART_ERR_MEMORY, "coupling: no memory to match particles");
  PART_TRY(part_agree(comm, status));
  m->comm = comm;
  MPI_Comm_size(comm, &m->size);
  m->n_from = n_from;
  m->n_to = n_to;
  int same = n_from == n_to && (n_to == 0 || memcmp(from, to, (size_t)n_to * sizeof *to) == 0);
  m->identical = same;
  if (m->size > 1)
    MPI_Allreduce(&same, &m->identical, 1, MPI_INT, MPI_MIN, comm);
  status = m->identical ? PART_OK : build(m, from, to, what);
  if (status != PART_OK) {
    cpl_match_destroy(m);
    return status;
  }
  *match = m;
  return PART_OK;
}

/* ---- data ----------------------------------------------------------------------------------- */
static void copy(size_t n, const double *from, double *to) {
  memcpy(to, from, n * sizeof *to);
}

/* Particles that changed rank: to the directory, joined there, and on to who asked. */
static int move_away(cpl_match *m, size_t n, const double *from, double *to) {
  const size_t away = (size_t)(m->away_from > m->away_to ? m->away_from : m->away_to);
  const int posted = part_exchange_receive_count(m->plan_from);
  double *mine = malloc((away * n + 1) * sizeof *mine);
  double *there = malloc(((size_t)posted * n + 1) * sizeof *there);
  double *joined = malloc(((size_t)posted * n + 1) * sizeof *joined);
  int status = PART_OK;
  if (!mine || !there || !joined)
    status = part_fail(PART_ERR_MEMORY, "coupling: no memory to move %zu particles", away);
  status = part_agree(m->comm, status);
  for (int k = 0; status == PART_OK && k < m->away_from; k++)
    copy(n, from + (size_t)m->from_away[k] * n, mine + (size_t)k * n);
  if (status == PART_OK)
    status = part_exchange_forward(m->plan_from, n * sizeof *mine, mine, there);
  for (int j = 0; status == PART_OK && j < posted; j++)
    copy(n, there + (size_t)m->join[j] * n, joined + (size_t)j * n);
  if (status == PART_OK)
    status = part_exchange_reverse(m->plan_to, n * sizeof *mine, joined, mine);
  for (int k = 0; status == PART_OK && k < m->away_to; k++)
    copy(n, mine + (size_t)k * n, to + (size_t)m->to_away[k] * n);
  free(mine);
  free(there);
  free(joined);
  return status;
}

int cpl_match_move(cpl_match *m, int n, const double *from, double *to) {
  const size_t width = (size_t)n;
  if (m->identical) {
    if (m->n_to > 0)
      copy((size_t)m->n_to * width, from, to);
    return PART_OK;
  }
  for (int j = 0; j < m->n_to; j++)
    if (m->partner[j] >= 0)
      copy(width, from + (size_t)m->partner[j] * width, to + (size_t)j * width);
  return m->plan_from ? move_away(m, width, from, to) : PART_OK;
}
