/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ranks: 1 2 3 4 */
#include "common.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const part_box free_box = {{-1, 0, 2}, {1, 0.5, 3}, {0, 0, 0}, {0, 0, 0}};
static const part_box periodic_box = {{-1, 0, 2}, {1, 0.5, 3}, {1, 1, 1}, {0, 0, 0}};

/* Each of the ids 0 .. n-1 on exactly one rank, all fields intact. */
static void check_all_there(const part_store *store, int n) {
  int *seen = calloc((size_t)n + 1, sizeof *seen);
  for (int i = 0; i < store->local; i++) {
    assert_in_range(*id_of(store, i), 0, n - 1);
    assert_true(intact(store, i));
    seen[*id_of(store, i)]++;
  }
  MPI_Allreduce(MPI_IN_PLACE, seen, n, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
  for (int k = 0; k < n; k++)
    assert_int_equal(seen[k], 1);
  free(seen);
}

static void balance_and_migrate(void **state) {
  (void)state;
  for (int scattered = 0; scattered < 2; scattered++) {
    part_domain *domain;
    part_store *store;
    double ratio;
    shared_domain(&free_box, 2000, scattered, &domain, &store);
    check_all_there(store, 2000);
    OK(part_domain_imbalance(domain, store, &ratio));
    assert_true(ratio < 1.02);
    /* Nothing moves any more. */
    const int local = store->local;
    const int64_t first = local > 0 ? *id_of(store, 0) : 0;
    OK(part_domain_migrate(domain, store, 0, NULL, NULL));
    assert_int_equal(store->local, local);
    assert_true(local == 0 || *id_of(store, 0) == first);
    drop_domain(domain, store);
  }
}

static void weights_count(void **state) {
  (void)state;
  part_domain *domain;
  part_store *store;
  shared_domain(&free_box, 3000, 1, &domain, &store);
  double *weight = calloc((size_t)store->local + 1, sizeof *weight), sum = 0.0, all, largest;
  for (int i = 0; i < store->local; i++)
    weight[i] = position(store, i)[0] < 0.0 ? 1.0 : 3.0;
  OK(part_domain_balance(domain, store, weight));
  OK(part_domain_migrate(domain, store, 0, NULL, NULL));
  check_all_there(store, 3000);
  for (int i = 0; i < store->local; i++)
    sum += position(store, i)[0] < 0.0 ? 1.0 : 3.0;
  MPI_Allreduce(&sum, &all, 1, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  MPI_Allreduce(&sum, &largest, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
  assert_true(largest * world_size() / all < 1.02);
  free(weight); /* no weight at all: as if equal */
  weight = calloc((size_t)store->local + 1, sizeof *weight);
  OK(part_domain_balance(domain, store, weight));
  OK(part_domain_migrate(domain, store, 0, NULL, NULL));
  double ratio;
  OK(part_domain_imbalance(domain, store, &ratio));
  assert_true(ratio < 1.02);
  free(weight);
  weight = calloc((size_t)store->local + 1, sizeof *weight);
  if (world_rank() == 0 && store->local > 0)
    weight[0] = -1.0;
  FAILS(PART_ERR_RANGE, "has a weight", part_domain_balance(domain, store, weight));
  free(weight);
  drop_domain(domain, store);
}

static void few_and_coincident(void **state) {
  (void)state;
  /* None, one, fewer than ranks: every call works, nobody is lost. */
  for (int n = 0; n < 4; n++) {
    part_domain *domain;
    part_store *store;
    double ratio;
    shared_domain(&periodic_box, n, 0, &domain, &store);
    if (n > 0)
      check_all_there(store, n);
    OK(part_domain_imbalance(domain, store, &ratio));
    assert_true(ratio >= 1.0);
    OK(part_domain_ghosts(domain, store, 0.05));
    OK(part_domain_update_ghosts(domain, store));
    drop_domain(domain, store);
  }
  /* All at one point: they stay together. */
  part_domain *domain;
  part_store *store;
  shared_domain(&free_box, 100, 1, &domain, &store);
  for (int i = 0; i < store->local; i++)
    position(store, i)[0] = position(store, i)[1] = position(store, i)[2] = 0.25;
  OK(part_domain_balance(domain, store, NULL));
  OK(part_domain_migrate(domain, store, 0, NULL, NULL));
  check_all_there(store, 100);
  assert_true(store->local == 100 || store->local == 0);
  drop_domain(domain, store);
}

/* Points exactly on the planes where a lattice is cut have one owner. */
static void lattice_on_cuts(void **state) {
  (void)state;
  part_domain *domain;
  part_store *store;
  shared_domain(&free_box, 512, 1, &domain, &store);
  for (int repeat = 0; repeat < 2; repeat++) {
    for (int i = 0; i < store->local; i++) {
      const int id = (int)*id_of(store, i);
      position(store, i)[0] = id % 8 * 0.125;
      position(store, i)[1] = id / 8 % 8 * 0.0625;
      position(store, i)[2] = 2.0 + id / 64 * 0.125;
    }
    OK(part_domain_balance(domain, store, NULL));
    OK(part_domain_migrate(domain, store, 0, NULL, NULL));
    check_all_there(store, 512);
    double ratio;
    OK(part_domain_imbalance(domain, store, &ratio));
    assert_true(ratio <= 2.0);
  }
  drop_domain(domain, store);
}

/* payload: id repeated id % 4 times, as int64. */
static void payload_travels(void **state) {
  (void)state;
  part_domain *domain;
  part_store *store;
  shared_domain(&periodic_box, 1000, 1, &domain, &store);
  uint64_t seed = 99 + (uint64_t)world_rank();
  for (int round = 0; round < 3; round++) {
    int *count = calloc((size_t)store->local + 1, sizeof *count), total = 0;
    int64_t *payload = calloc(4 * (size_t)store->local + 1, sizeof *payload);
    for (int i = 0; i < store->local; i++) {
      count[i] = (int)(*id_of(store, i) % 4);
      for (int k = 0; k < count[i]; k++)
        payload[total++] = *id_of(store, i) + 1000000 * k;
      for (int d = 0; d < 3; d++) /* far jumps, out of the box too */
        position(store, i)[d] += (uniform(&seed) - 0.5) * 1.5;
    }
    void *bytes = payload;
    OK(part_domain_migrate(domain, store, sizeof *payload, &count, &bytes));
    payload = (int64_t *)bytes;
    check_all_there(store, 1000);
    total = 0;
    for (int i = 0; i < store->local; i++) {
      assert_int_equal(count[i], *id_of(store, i) % 4);
      for (int k = 0; k < count[i]; k++)
        assert_int_equal(payload[total++], *id_of(store, i) + 1000000 * k);
      for (int d = 0; d < 3; d++)
        assert_true(position(store, i)[d] >= periodic_box.lo[d] &&
                    position(store, i)[d] < periodic_box.hi[d]);
    }
    free(count);
    free(payload);
  }
  drop_domain(domain, store);
}

/* Where the group of a particle is at home: far jumps with the round. */
static void home_of(int64_t group, int round, double home[3]) {
  for (int d = 0; d < 3; d++)
    home[d] = periodic_box.lo[d] + 1.3 * sin((double)(7 * group + 3 * d) + 2.1 * round);
}

static double offset_of(int64_t id, int d) {
  return 0.11 * sin((double)(5 * id + d));
}

/* Groups of eight with one home each: on one rank, shifted together, balanced by their homes. */
static void homes(void **state) {
  (void)state;
  enum { N = 800, GROUP = 8 };
  part_domain *domain;
  part_store *store;
  shared_domain(&periodic_box, N, 1, &domain, &store);
  for (int round = 0; round < 3; round++) {
    double *home = calloc(3 * (size_t)store->local + 1, sizeof *home);
    for (int i = 0; i < store->local; i++) {
      home_of(*id_of(store, i) / GROUP, round, home + 3 * i);
      for (int d = 0; d < 3; d++)
        position(store, i)[d] = home[3 * i + d] + offset_of(*id_of(store, i), d);
    }
    for (int i = 0; i < store->local; i++) /* the load counts where homes will be */
      part_box_wrap(&periodic_box, home + 3 * i, NULL);
    OK(part_domain_balance_home(domain, store, home, NULL));
    for (int i = 0; i < store->local; i++)
      home_of(*id_of(store, i) / GROUP, round, home + 3 * i);
    OK(part_domain_migrate_home(domain, store, home, 0, NULL, NULL));
    free(home);
    check_all_there(store, N);
    int members[N / GROUP] = {0};
    for (int i = 0; i < store->local; i++) {
      const int64_t group = *id_of(store, i) / GROUP;
      double wanted[3];
      members[group]++;
      home_of(group, round, wanted);
      part_box_wrap(&periodic_box, wanted, NULL);
      for (int d = 0; d < 3; d++)
        assert_true(fabs(position(store, i)[d] - wanted[d] - offset_of(*id_of(store, i), d)) <
                    1e-14);
    }
    for (int g = 0; g < N / GROUP; g++)
      assert_true(members[g] == 0 || members[g] == GROUP);
    double ratio;
    OK(part_domain_imbalance(domain, store, &ratio));
    /* Zoltan's tolerance, and a group more on each of two levels of cuts. */
    assert_true(ratio <= 1.1 + 2.0 * GROUP * world_size() / N);
  }
  double nowhere[3 * N];
  for (int k = 0; k < 3 * N; k++)
    nowhere[k] = NAN;
  FAILS(PART_ERR_OUTSIDE, "home that is not finite",
        part_domain_migrate_home(domain, store, nowhere, 0, NULL, NULL));
  drop_domain(domain, store);
}

/* Data of own particles arrives at all their copies. */
static void bad_positions(void **state) {
  (void)state;
  part_box box = free_box;
  box.bounded[1] = 1;
  part_domain *domain;
  part_store *store;
  shared_domain(&box, 200, 1, &domain, &store);
  double keep[3] = {0};
  const int last = world_rank() == world_size() - 1;
  assert_true(store->local > 0);
  memcpy(keep, position(store, 0), sizeof keep);
  position(store, 0)[0] = 55.0; /* not bounded there */
  OK(part_domain_migrate(domain, store, 0, NULL, NULL));
  check_all_there(store, 200);
  int i = 0;
  while (last && position(store, i)[0] == 55.0)
    i++;
  memcpy(keep, position(store, i), sizeof keep);
  if (last)
    position(store, i)[1] = 0.51;
  FAILS(PART_ERR_OUTSIDE, "from 0 to 0.5 m in direction y",
        part_domain_migrate(domain, store, 0, NULL, NULL));
  check_all_there(store, 200); /* nothing was lost by the failure */
  if (last)
    position(store, i)[1] = NAN;
  FAILS(PART_ERR_OUTSIDE, "not at a finite place",
        part_domain_migrate(domain, store, 0, NULL, NULL));
  FAILS(PART_ERR_OUTSIDE, "is not finite", part_domain_balance(domain, store, NULL));
  FAILS(PART_ERR_OUTSIDE, "is not finite", part_domain_ghosts(domain, store, 0.01));
  memcpy(position(store, i), keep, sizeof keep);
  OK(part_domain_migrate(domain, store, 0, NULL, NULL));
  drop_domain(domain, store);
}

static void save_and_load(void **state) {
  (void)state;
  part_domain *a, *b;
  part_store *store;
  unsigned char *bytes;
  size_t size;
  shared_domain(&free_box, 500, 1, &a, &store);
  OK(part_domain_save(a, &size, &bytes));
  OK(part_domain_create(MPI_COMM_WORLD, &free_box, &b));
  OK(part_domain_load(b, size, bytes));
  const int local = store->local;
  OK(part_domain_migrate(b, store, 0, NULL, NULL)); /* the same cuts: nothing moves */
  assert_int_equal(store->local, local);
  unsigned char *again;
  size_t size_again;
  OK(part_domain_save(b, &size_again, &again));
  assert_int_equal(size, size_again);
  assert_memory_equal(bytes, again, size);
  free(again);
  if (world_rank() == world_size() - 1)
    bytes[0] = '?';
  FAILS(PART_ERR_FORMAT, "not a saved decomposition", part_domain_load(b, size, bytes));
  FAILS(PART_ERR_FORMAT, "bytes", part_domain_load(b, size - 1, bytes));
  OK(part_domain_migrate(b, store, 0, NULL, NULL));
  assert_int_equal(store->local, local);
  free(bytes);
  part_domain_destroy(b);
  drop_domain(a, store);
}

/* The same again gives the same, bit for bit and in the same order. */
static void repeatable(void **state) {
  (void)state;
  part_domain *a, *b;
  part_store *one, *two;
  shared_domain(&periodic_box, 700, 1, &a, &one);
  shared_domain(&periodic_box, 700, 1, &b, &two);
  OK(part_domain_ghosts(a, one, 0.1));
  OK(part_domain_ghosts(b, two, 0.1));
  assert_int_equal(one->local, two->local);
  assert_int_equal(one->ghost, two->ghost);
  const size_t n = (size_t)(one->local + one->ghost);
  assert_memory_equal(one->record[REC_XR], two->record[REC_XR], n * 32);
  assert_memory_equal(one->record[REC_ID], two->record[REC_ID], n * 8);
  drop_domain(a, one);
  drop_domain(b, two);
}

static const struct CMUnitTest tests[] = {
    cmocka_unit_test(balance_and_migrate), cmocka_unit_test(weights_count),
    cmocka_unit_test(few_and_coincident),  cmocka_unit_test(lattice_on_cuts),
    cmocka_unit_test(payload_travels),     cmocka_unit_test(homes),
    cmocka_unit_test(bad_positions),       cmocka_unit_test(save_and_load),
    cmocka_unit_test(repeatable),
};
RUN_WITH_MPI(tests)
