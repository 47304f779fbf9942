/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ranks: 1 2 3 4 */
#include "common.h"

#include <stdlib.h>
#include <string.h>

#include "particle/exchange.h"

typedef struct item {
  int source, number, destination;
  double value;
} item;

/* n items to random ranks, filled so that the receiver can check them. */
static void make_items(int n, uint64_t *seed, int *destination, item *items) {
  for (int k = 0; k < n; k++) {
    destination[k] = below(seed, world_size());
    items[k] = (item){world_rank(), k, destination[k], uniform(seed)};
  }
}

static void check_received(const part_exchange *plan, const item *got) {
  const int n = part_exchange_receive_count(plan);
  for (int k = 0; k < n; k++) {
    assert_int_equal(got[k].destination, world_rank());
    assert_int_equal(got[k].source, part_exchange_source(plan)[k]);
    if (k > 0 && got[k].source == got[k - 1].source)
      assert_true(got[k].number > got[k - 1].number);
    else if (k > 0)
      assert_true(got[k].source > got[k - 1].source);
  }
}

static void round_trip(int n, uint64_t seed) {
  int *destination = calloc((size_t)n + 1, sizeof *destination);
  item *items = calloc((size_t)n + 1, sizeof *items), *back = calloc((size_t)n + 1, sizeof *back);
  make_items(n, &seed, destination, items);
  part_exchange *plan;
  OK(part_exchange_create(MPI_COMM_WORLD, n, destination, &plan));
  assert_int_equal(part_exchange_send_count(plan), n);
  const int m = part_exchange_receive_count(plan);
  long long sums[2] = {n, m};
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_LONG_LONG, MPI_SUM, MPI_COMM_WORLD);
  assert_true(sums[0] == sums[1]);
  item *got = calloc((size_t)m + 1, sizeof *got);
  for (int repeat = 0; repeat < 2; repeat++) {
    memset(got, 0, (size_t)m * sizeof *got);
    memset(back, 0, (size_t)n * sizeof *back);
    OK(part_exchange_forward(plan, sizeof *items, items, got));
    check_received(plan, got);
    OK(part_exchange_reverse(plan, sizeof *items, got, back));
    assert_memory_equal(back, items, (size_t)n * sizeof *items);
  }
  long long others = 0;
  for (int k = 0; k < n; k++)
    others += destination[k] != world_rank();
  for (int k = 0; k < m; k++)
    others += part_exchange_source(plan)[k] != world_rank();
  assert_true(part_exchange_bytes(plan) == 2 * others * (long long)sizeof(item));
  part_exchange_destroy(plan);
  free(destination);
  free(items);
  free(back);
  free(got);
}

static void reverse_of_forward(void **state) {
  (void)state;
  for (int k = 0; k < 20; k++) {
    uint64_t seed = (uint64_t)(1000 * k + world_rank());
    /* Some ranks with nothing to send. */
    round_trip(k % 3 == world_rank() % 3 ? 0 : below(&seed, 200), seed);
  }
  round_trip(0, 1);
}

static void variable_sizes(void **state) {
  (void)state;
  enum { N = 100 };
  uint64_t seed = 77 + (uint64_t)world_rank();
  int destination[N], count[N], number[N], total = 0;
  for (int k = 0; k < N; k++) {
    destination[k] = below(&seed, world_size());
    count[k] = below(&seed, 5);
    number[k] = k;
    total += count[k];
  }
  double *values = calloc((size_t)total + 1, sizeof *values);
  for (int k = 0, at = 0; k < N; k++)
    for (int e = 0; e < count[k]; e++)
      values[at++] = 1e6 * world_rank() + 10 * k + e;
  part_exchange *plan;
  OK(part_exchange_create(MPI_COMM_WORLD, N, destination, &plan));
  int *got_number = calloc((size_t)part_exchange_receive_count(plan) + 1, sizeof(int));
  OK(part_exchange_forward(plan, sizeof(int), number, got_number));
  int *got_count;
  void *got;
  OK(part_exchange_forward_variable(plan, sizeof *values, count, values, &got_count, &got));
  const double *v = (const double *)got;
  for (int k = 0, at = 0; k < part_exchange_receive_count(plan); k++)
    for (int e = 0; e < got_count[k]; e++)
      assert_true(v[at++] == 1e6 * part_exchange_source(plan)[k] + 10 * got_number[k] + e);
  long long sums[2] = {total, 0};
  for (int k = 0; k < part_exchange_receive_count(plan); k++)
    sums[1] += got_count[k];
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_LONG_LONG, MPI_SUM, MPI_COMM_WORLD);
  assert_true(sums[0] == sums[1]);
  part_exchange_destroy(plan);
  free(values);
  free(got_number);
  free(got_count);
  free(got);
}

static void wrong_destination(void **state) {
  (void)state;
  part_exchange *plan;
  int destination[2] = {0, world_rank() == world_size() - 1 ? world_size() : 0};
  /* Every rank hears of the mistake of the last. */
  FAILS(PART_ERR_RANGE, "item 1 goes to rank",
        part_exchange_create(MPI_COMM_WORLD, 2, destination, &plan));
  assert_null(plan);
  destination[1] = -1;
  FAILS(PART_ERR_RANGE, "goes to rank -1",
        part_exchange_create(MPI_COMM_WORLD, 2, destination, &plan));
}

/* Calls into MPI are counted here, in front of the library's own. */
static int mpi_calls;
int MPI_Comm_size(MPI_Comm comm, int *size) {
  mpi_calls++;
  return PMPI_Comm_size(comm, size);
}
int MPI_Waitall(int n, MPI_Request request[], MPI_Status status[]) {
  mpi_calls++;
  return PMPI_Waitall(n, request, status);
}
int MPI_Type_contiguous(int n, MPI_Datatype type, MPI_Datatype *made) {
  mpi_calls++;
  return PMPI_Type_contiguous(n, type, made);
}
int MPI_Allreduce(const void *send, void *received, int n, MPI_Datatype type, MPI_Op op,
                  MPI_Comm comm) {
  mpi_calls++;
  return PMPI_Allreduce(send, received, n, type, op, comm);
}

static void alone_no_message(void **state) {
  (void)state;
  part_exchange *plan;
  const int destination[3] = {0, 0, 0};
  const double send[3] = {1.0, 2.0, 3.0};
  double got[3] = {0}, back[3] = {0};
  OK(part_exchange_create(MPI_COMM_SELF, 3, destination, &plan));
  const int before = mpi_calls;
  OK(part_exchange_forward(plan, sizeof *send, send, got));
  OK(part_exchange_reverse(plan, sizeof *send, got, back));
  assert_int_equal(mpi_calls, before);
  assert_memory_equal(send, got, sizeof send);
  assert_memory_equal(send, back, sizeof send);
  assert_true(part_exchange_bytes(plan) == 0);
  part_exchange_destroy(plan);
}

static const struct CMUnitTest tests[] = {
    cmocka_unit_test(reverse_of_forward),
    cmocka_unit_test(variable_sizes),
    cmocka_unit_test(wrong_destination),
    cmocka_unit_test(alone_no_message),
};
RUN_WITH_MPI(tests)
