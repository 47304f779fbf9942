/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Exchange on plain messages between the ranks that have something to say to each other. */
#include "particle/exchange.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "memory.h"
#include "particle/status.h"

enum { TAG = 7301 };

/* The items to or from one rank: `count` of them, the first is number `first` of the side. */
typedef struct peer {
  int rank, count, first;
} peer;

struct part_exchange {
  MPI_Comm comm;
  int size, rank;
  int n_send, n_receive;
  int *order;  /* [n_send] sender's item of each packed one: by rank, then by item; NULL: identity,
                * items travel from and to the caller's arrays without being packed */
  int *source; /* [n_receive] */
  peer *to, *from; /* other ranks only, in increasing order */
  int n_to, n_from;
  peer own_to, own_from;
  MPI_Request *request;  /* [n_to + n_from] */
  unsigned char *packed; /* buffer of the send side */
  size_t packed_room;
  long long bytes;
};

static int mpi_failed(const char *call) {
  return part_fail(PART_ERR_MPI, "%s failed", call);
}

/* One rank agrees with itself without asking MPI. */
static int agree(const part_exchange *plan, int status) {
  return plan->size == 1 ? status : part_agree(plan->comm, status);
}

/* Peers from the number of items per rank. */
static int make_peers(const part_exchange *plan, const int *count, peer **peers, int *n_peers,
                      peer *own, int *total) {
  long long sum = 0;
  int n = 0;
  for (int r = 0; r < plan->size; r++)
    n += count[r] > 0 && r != plan->rank;
  PART_TRY(part_allocate((size_t)n, sizeof **peers, peers));
  *n_peers = 0;
  for (int r = 0; r < plan->size; r++) {
    const peer p = {r, count[r], (int)sum};
    if (r == plan->rank)
      *own = p;
    else if (count[r] > 0)
      (*peers)[(*n_peers)++] = p;
    sum += count[r];
    if (sum > INT_MAX)
      return part_fail(PART_ERR_RANGE, "rank %d would receive more than %d items", plan->rank,
                       INT_MAX);
  }
  *total = (int)sum;
  return PART_OK;
}

/* Counting sort of the items by destination; stable, so the sender's order stays. */
static int make_order(part_exchange *plan, const int *destination, const int *count) {
  int *next, first = 0, sorted = 1;
  for (int k = 1; k < plan->n_send && sorted; k++)
    sorted = destination[k - 1] <= destination[k];
  if (sorted)
    return PART_OK;
  PART_TRY(part_allocate((size_t)plan->n_send, sizeof *plan->order, &plan->order));
  PART_TRY(part_allocate((size_t)plan->size, sizeof *next, &next));
  for (int r = 0; r < plan->size; r++) {
    next[r] = first;
    first += count[r];
  }
  for (int k = 0; k < plan->n_send; k++)
    plan->order[next[destination[k]]++] = k;
  free(next);
  return PART_OK;
}

static int make_source(part_exchange *plan) {
  PART_TRY(part_allocate((size_t)plan->n_receive, sizeof *plan->source, &plan->source));
  for (int k = 0; k < plan->own_from.count; k++)
    plan->source[plan->own_from.first + k] = plan->rank;
  for (int p = 0; p < plan->n_from; p++)
    for (int k = 0; k < plan->from[p].count; k++)
      plan->source[plan->from[p].first + k] = plan->from[p].rank;
  return PART_OK;
}

/* The local work before ranks must agree: counts per destination, and the order. */
static int prepare(part_exchange *plan, const int *destination, int *count) {
  for (int k = 0; k < plan->n_send; k++) {
    if (destination[k] < 0 || destination[k] >= plan->size)
      return part_fail(PART_ERR_RANGE, "item %d goes to rank %d, ranks are 0 to %d", k,
                       destination[k], plan->size - 1);
    count[destination[k]]++;
  }
  if (plan->size > 1)
    PART_TRY(make_order(plan, destination, count));
  return make_peers(plan, count, &plan->to, &plan->n_to, &plan->own_to, &plan->n_send);
}

static int finish(part_exchange *plan, const int *received) {
  PART_TRY(
      make_peers(plan, received, &plan->from, &plan->n_from, &plan->own_from, &plan->n_receive));
  PART_TRY(
      part_allocate((size_t)(plan->n_to + plan->n_from), sizeof *plan->request, &plan->request));
  return make_source(plan);
}

static int create(part_exchange *plan, const int *destination, int *count, int *received) {
  PART_TRY(agree(plan, prepare(plan, destination, count)));
  if (plan->size == 1)
    received[0] = count[0];
  else if (MPI_Alltoall(count, 1, MPI_INT, received, 1, MPI_INT, plan->comm) != MPI_SUCCESS)
    return mpi_failed("MPI_Alltoall");
  return agree(plan, finish(plan, received));
}

int part_exchange_create(MPI_Comm comm, int n_send, const int *destination, part_exchange **plan) {
  part_exchange *made = NULL;
  int *count = NULL, size = 1, rank = 0;
  *plan = NULL;
  if (MPI_Comm_size(comm, &size) != MPI_SUCCESS || MPI_Comm_rank(comm, &rank) != MPI_SUCCESS)
    return mpi_failed("MPI_Comm_size");
  int status = n_send < 0 ? part_fail(PART_ERR_ARGUMENT, "%d items to send", n_send) : PART_OK;
  if (status == PART_OK)
    status = part_allocate(1, sizeof *made, &made);
  if (status == PART_OK)
    status = part_allocate(2 * (size_t)size, sizeof *count, &count);
  status = part_agree(comm, status);
  if (status == PART_OK) {
    made->comm = comm;
    made->size = size;
    made->rank = rank;
    made->n_send = n_send;
    status = create(made, destination, count, count + size);
  }
  free(count);
  if (status != PART_OK) {
    part_exchange_destroy(made);
    return status;
  }
  *plan = made;
  return PART_OK;
}

void part_exchange_destroy(part_exchange *plan) {
  if (plan == NULL)
    return;
  free(plan->order);
  free(plan->source);
  free(plan->to);
  free(plan->from);
  free(plan->request);
  free(plan->packed);
  free(plan);
}

int part_exchange_send_count(const part_exchange *plan) {
  return plan->n_send;
}
int part_exchange_receive_count(const part_exchange *plan) {
  return plan->n_receive;
}
const int *part_exchange_source(const part_exchange *plan) {
  return plan->source;
}
long long part_exchange_bytes(const part_exchange *plan) {
  return plan->bytes;
}

/* An item as one datatype, so that counts are items: bytes may exceed an int. */
static int item_type(size_t item_size, MPI_Datatype *type) {
  if (item_size > INT_MAX)
    return part_fail(PART_ERR_RANGE, "an item of %zu bytes", item_size);
  if (MPI_Type_contiguous((int)item_size, MPI_BYTE, type) != MPI_SUCCESS)
    return mpi_failed("MPI_Type_contiguous");
  if (MPI_Type_commit(type) != MPI_SUCCESS)
    return mpi_failed("MPI_Type_commit");
  return PART_OK;
}

/* Messages from `send` to the peers `to`, and from the peers `from` into `received`; both are laid
 * out in the order of ranks. */
static int messages(part_exchange *plan, size_t item_size, const peer *to, int n_to,
                    const unsigned char *send, const peer *from, int n_from,
                    unsigned char *received) {
  MPI_Datatype type;
  int n = 0, status = PART_OK;
  if (n_to + n_from == 0 || item_size == 0)
    return PART_OK;
  PART_TRY(item_type(item_size, &type));
  for (int p = 0; p < n_from && status == PART_OK; p++)
    if (MPI_Irecv(received + (size_t)from[p].first * item_size, from[p].count, type, from[p].rank,
                  TAG, plan->comm, &plan->request[n++]) != MPI_SUCCESS)
      status = mpi_failed("MPI_Irecv");
  for (int p = 0; p < n_to && status == PART_OK; p++) {
    if (MPI_Isend(send + (size_t)to[p].first * item_size, to[p].count, type, to[p].rank, TAG,
                  plan->comm, &plan->request[n++]) != MPI_SUCCESS)
      status = mpi_failed("MPI_Isend");
    plan->bytes += (long long)to[p].count * (long long)item_size;
  }
  if (status == PART_OK && MPI_Waitall(n, plan->request, MPI_STATUSES_IGNORE) != MPI_SUCCESS)
    status = mpi_failed("MPI_Waitall");
  MPI_Type_free(&type);
  return status;
}

static void copy(void *to, const void *from, size_t bytes) {
  if (bytes > 0)
    memcpy(to, from, bytes);
}

/* The items in the order of the plan. */
static int pack(part_exchange *plan, size_t item_size, const unsigned char *items,
                const unsigned char **packed) {
  *packed = items;
  if (plan->order == NULL)
    return PART_OK;
  PART_TRY(part_grow((size_t)plan->n_send * item_size, 1, &plan->packed_room, &plan->packed));
  for (size_t k = 0; k < (size_t)plan->n_send; k++)
    memcpy(plan->packed + k * item_size, items + (size_t)plan->order[k] * item_size, item_size);
  *packed = plan->packed;
  return PART_OK;
}

int part_exchange_forward(part_exchange *plan, size_t item_size, const void *send, void *received) {
  const unsigned char *packed;
  PART_TRY(pack(plan, item_size, (const unsigned char *)send, &packed));
  if (plan->own_to.count > 0)
    copy((unsigned char *)received + (size_t)plan->own_from.first * item_size,
         packed + (size_t)plan->own_to.first * item_size, (size_t)plan->own_to.count * item_size);
  return messages(plan, item_size, plan->to, plan->n_to, packed, plan->from, plan->n_from,
                  (unsigned char *)received);
}

int part_exchange_reverse(part_exchange *plan, size_t item_size, const void *send, void *received) {
  unsigned char *items = (unsigned char *)received, *packed = items;
  if (plan->order != NULL) {
    PART_TRY(part_grow((size_t)plan->n_send * item_size, 1, &plan->packed_room, &plan->packed));
    packed = plan->packed;
  }
  if (plan->own_to.count > 0)
    copy(packed + (size_t)plan->own_to.first * item_size,
         (const unsigned char *)send + (size_t)plan->own_from.first * item_size,
         (size_t)plan->own_to.count * item_size);
  PART_TRY(messages(plan, item_size, plan->from, plan->n_from, (const unsigned char *)send,
                    plan->to, plan->n_to, packed));
  for (size_t k = 0; plan->order != NULL && k < (size_t)plan->n_send; k++)
    memcpy(items + (size_t)plan->order[k] * item_size, packed + k * item_size, item_size);
  return PART_OK;
}

/* Peers measured in elements instead of items. */
static int element_peers(const peer *peers, int n_peers, const peer *own, const int *count,
                         peer **elements, peer *own_elements, size_t *total) {
  PART_TRY(part_allocate((size_t)n_peers, sizeof **elements, elements));
  size_t sum = 0;
  int own_done = 0;
  for (int p = 0; p <= n_peers; p++) {
    /* The own rank takes its place between the others. */
    const int own_now = !own_done && (p == n_peers || peers[p].rank > own->rank);
    const peer *items = own_now ? own : &peers[p];
    if (!own_now && p == n_peers)
      break;
    size_t here = 0;
    for (int k = 0; k < items->count; k++)
      here += (size_t)count[items->first + k];
    if (sum + here > INT_MAX)
      return part_fail(PART_ERR_RANGE, "more than %d elements in one exchange", INT_MAX);
    const peer e = {items->rank, (int)here, (int)sum};
    sum += here;
    if (own_now) {
      *own_elements = e;
      own_done = 1;
      p--;
    } else {
      (*elements)[p] = e;
    }
  }
  *total = sum;
  return PART_OK;
}

/* The elements of all items in the order of the plan, and their counts in that order. */
static int pack_variable(const part_exchange *plan, size_t element_size, const int *count,
                         const unsigned char *send, int **packed_count, unsigned char **packed) {
  size_t total = 0, *begin;
  const size_t n = (size_t)plan->n_send;
  PART_TRY(part_allocate(n, sizeof *begin, &begin));
  int status = part_allocate(n, sizeof **packed_count, packed_count);
  for (size_t k = 0; k < n && status == PART_OK; k++) {
    if (count[k] < 0)
      status = part_fail(PART_ERR_ARGUMENT, "item %zu has %d elements", k, count[k]);
    begin[k] = total;
    total += (size_t)(count[k] > 0 ? count[k] : 0);
  }
  if (status == PART_OK)
    status = part_allocate(total, element_size, packed);
  unsigned char *to = *packed;
  for (size_t k = 0; k < n && status == PART_OK; k++) {
    const size_t item = plan->order != NULL ? (size_t)plan->order[k] : k;
    const size_t bytes = (size_t)count[item] * element_size;
    (*packed_count)[k] = count[item];
    copy(to, send + begin[item] * element_size, bytes);
    to += bytes;
  }
  free(begin);
  return status;
}

/* What forward_variable holds while it works. */
typedef struct variable {
  int *packed_count, *received_count;
  unsigned char *packed, *received;
  peer *to, *from, own_to, own_from;
} variable;

static int variable_buffers(const part_exchange *plan, size_t element_size, variable *v) {
  size_t send_total, receive_total;
  PART_TRY(element_peers(plan->to, plan->n_to, &plan->own_to, v->packed_count, &v->to, &v->own_to,
                         &send_total));
  PART_TRY(element_peers(plan->from, plan->n_from, &plan->own_from, v->received_count, &v->from,
                         &v->own_from, &receive_total));
  return part_allocate(receive_total, element_size, &v->received);
}

static int forward_counts(part_exchange *plan, variable *v) {
  const size_t size = sizeof(int);
  copy(v->received_count + plan->own_from.first, v->packed_count + plan->own_to.first,
       (size_t)plan->own_to.count * size);
  return messages(plan, size, plan->to, plan->n_to, (const unsigned char *)v->packed_count,
                  plan->from, plan->n_from, (unsigned char *)v->received_count);
}

static int forward_elements(part_exchange *plan, size_t element_size, const int *count,
                            const void *send, variable *v) {
  int status = pack_variable(plan, element_size, count, (const unsigned char *)send,
                             &v->packed_count, &v->packed);
  if (status == PART_OK)
    status = part_allocate((size_t)plan->n_receive, sizeof(int), &v->received_count);
  PART_TRY(agree(plan, status));
  PART_TRY(forward_counts(plan, v));
  PART_TRY(agree(plan, variable_buffers(plan, element_size, v)));
  copy(v->received + (size_t)v->own_from.first * element_size,
       v->packed + (size_t)v->own_to.first * element_size, (size_t)v->own_to.count * element_size);
  return messages(plan, element_size, v->to, plan->n_to, v->packed, v->from, plan->n_from,
                  v->received);
}

int part_exchange_forward_variable(part_exchange *plan, size_t element_size, const int *count,
                                   const void *send, int **received_count, void **received) {
  variable v = {0};
  const int status = forward_elements(plan, element_size, count, send, &v);
  free(v.packed_count);
  free(v.packed);
  free(v.to);
  free(v.from);
  *received_count = status == PART_OK ? v.received_count : NULL;
  *received = status == PART_OK ? v.received : NULL;
  if (status != PART_OK) {
    free(v.received_count);
    free(v.received);
  }
  return status;
}
