/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ranks: 1 2 3 4 */
#include "common.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const part_box free_box = {{-1, 0, 2}, {1, 0.5, 3}, {0, 0, 0}, {0, 0, 0}};
static const part_box periodic_box = {{-1, 0, 2}, {1, 0.5, 3}, {1, 1, 1}, {0, 0, 0}};

static long long sum_over_ranks(long long value) {
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_LONG_LONG, MPI_SUM, MPI_COMM_WORLD);
  return value;
}

/* Domain with n particles in all, made on rank 0 (scattered = 0) or on all, balanced, migrated. */
static void set_up(const part_box *box, int n, int scattered, part_domain **domain,
                   part_store **store) {
  uint64_t seed = 11 + (uint64_t)world_rank();
  OK(part_domain_create(MPI_COMM_WORLD, box, domain));
  OK(part_store_create(&test_layout, store));
  const int each = n / world_size(), rest = n - each * (world_size() - 1);
  int mine = scattered ? each : 0;
  if (world_rank() == 0)
    mine = scattered ? rest : n;
  const int64_t first = world_rank() == 0 ? 0 : rest + (int64_t)each * (world_rank() - 1);
  fill_random(*store, mine, first, box, 0.01, 0.02, &seed);
  OK(part_domain_balance(*domain, *store, NULL));
  OK(part_domain_migrate(*domain, *store, 0, NULL, NULL));
}

static void tear_down(part_domain *domain, part_store *store) {
  part_store_destroy(store);
  part_domain_destroy(domain);
}

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

/* All own particles of all ranks, on every rank: x, y, z, r, id as five doubles. */
static double *everything(const part_store *store, int *n) {
  const int mine = 5 * store->local, size = world_size();
  int *count = calloc(2 * (size_t)size, sizeof *count), *start = count + size;
  double *own = calloc((size_t)mine + 1, sizeof *own);
  for (int i = 0; i < store->local; i++) {
    memcpy(own + 5 * i, position(store, i), 4 * sizeof *own);
    own[5 * i + 4] = (double)*id_of(store, i);
  }
  MPI_Allgather(&mine, 1, MPI_INT, count, 1, MPI_INT, MPI_COMM_WORLD);
  *n = 0;
  for (int r = 0; r < size; r++) {
    start[r] = *n;
    *n += count[r];
  }
  double *all = calloc((size_t)*n + 1, sizeof *all);
  MPI_Allgatherv(own, mine, MPI_DOUBLE, all, count, start, MPI_DOUBLE, MPI_COMM_WORLD);
  *n /= 5;
  free(own);
  free(count);
  return all;
}

static void balance_and_migrate(void **state) {
  (void)state;
  for (int scattered = 0; scattered < 2; scattered++) {
    part_domain *domain;
    part_store *store;
    double ratio;
    set_up(&free_box, 2000, scattered, &domain, &store);
    check_all_there(store, 2000);
    OK(part_domain_imbalance(domain, store, &ratio));
    assert_true(ratio < 1.02);
    /* Nothing moves any more. */
    const int local = store->local;
    const int64_t first = local > 0 ? *id_of(store, 0) : 0;
    OK(part_domain_migrate(domain, store, 0, NULL, NULL));
    assert_int_equal(store->local, local);
    assert_true(local == 0 || *id_of(store, 0) == first);
    tear_down(domain, store);
  }
}

static void weights_count(void **state) {
  (void)state;
  part_domain *domain;
  part_store *store;
  set_up(&free_box, 3000, 1, &domain, &store);
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
  tear_down(domain, store);
}

static void few_and_coincident(void **state) {
  (void)state;
  /* None, one, fewer than ranks: every call works, nobody is lost. */
  for (int n = 0; n < 4; n++) {
    part_domain *domain;
    part_store *store;
    double ratio;
    set_up(&periodic_box, n, 0, &domain, &store);
    if (n > 0)
      check_all_there(store, n);
    OK(part_domain_imbalance(domain, store, &ratio));
    assert_true(ratio >= 1.0);
    OK(part_domain_ghosts(domain, store, 0.05));
    OK(part_domain_update_ghosts(domain, store));
    tear_down(domain, store);
  }
  /* All at one point: they stay together. */
  part_domain *domain;
  part_store *store;
  set_up(&free_box, 100, 1, &domain, &store);
  for (int i = 0; i < store->local; i++)
    position(store, i)[0] = position(store, i)[1] = position(store, i)[2] = 0.25;
  OK(part_domain_balance(domain, store, NULL));
  OK(part_domain_migrate(domain, store, 0, NULL, NULL));
  check_all_there(store, 100);
  assert_true(store->local == 100 || store->local == 0);
  tear_down(domain, store);
}

/* Points exactly on the planes where a lattice is cut have one owner. */
static void lattice_on_cuts(void **state) {
  (void)state;
  part_domain *domain;
  part_store *store;
  set_up(&free_box, 512, 1, &domain, &store);
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
  tear_down(domain, store);
}

/* payload: id repeated id % 4 times, as int64. */
static void payload_travels(void **state) {
  (void)state;
  part_domain *domain;
  part_store *store;
  set_up(&periodic_box, 1000, 1, &domain, &store);
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
  tear_down(domain, store);
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
  set_up(&periodic_box, N, 1, &domain, &store);
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
  tear_down(domain, store);
}

/* Data of own particles arrives at all their copies. */
static void data_to_ghosts(void **state) {
  (void)state;
  part_domain *domain;
  part_store *store;
  set_up(&periodic_box, 500, 1, &domain, &store);
  OK(part_domain_ghosts(domain, store, 0.1));
  assert_true(sum_over_ranks(store->ghost) > 100);
  int64_t *own = calloc(2 * (size_t)store->local + 1, sizeof *own);
  int64_t *ghosts = calloc(2 * (size_t)store->ghost + 1, sizeof *ghosts);
  for (int i = 0; i < store->local; i++) {
    own[2 * i] = *id_of(store, i);
    own[2 * i + 1] = -3 * *id_of(store, i);
  }
  OK(part_domain_copy_to_ghosts(domain, store, 2 * sizeof *own, own, ghosts));
  for (int k = 0; k < store->ghost; k++) {
    assert_int_equal(ghosts[2 * k], *id_of(store, store->local + k));
    assert_int_equal(ghosts[2 * k + 1], -3 * *id_of(store, store->local + k));
  }
  free(own);
  free(ghosts);
  tear_down(domain, store);
}

static void bad_positions(void **state) {
  (void)state;
  part_box box = free_box;
  box.bounded[1] = 1;
  part_domain *domain;
  part_store *store;
  set_up(&box, 200, 1, &domain, &store);
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
  tear_down(domain, store);
}

/* Every image of every particle that is within reach of an own particle must be among the ghosts
 * (once), every ghost must be an image of a particle. */
static void check_ghosts(const part_store *store, const part_box *box, double reach) {
  int n;
  double *all = everything(store, &n);
  unsigned char *used = calloc((size_t)store->ghost + 1, 1);
  int found = 0, m[3];
  for (int d = 0; d < 3; d++)
    m[d] = box->periodic[d];
  for (int k = 0; k < n; k++)
    for (int s = 0; s < 27; s++) {
      const int turn[3] = {s % 3 - 1, s / 3 % 3 - 1, s / 9 - 1};
      double x[3];
      int skip = 0, near = 0, mine = 0;
      for (int d = 0; d < 3; d++) {
        skip += turn[d] != 0 && !m[d];
        x[d] = all[5 * k + d] + turn[d] * (box->hi[d] - box->lo[d]);
      }
      for (int i = 0; i < store->local && !skip; i++) {
        double d2 = 0.0;
        for (int d = 0; d < 3; d++)
          d2 += (position(store, i)[d] - x[d]) * (position(store, i)[d] - x[d]);
        near |= d2 < reach * reach;
        mine |= s == 13 && *id_of(store, i) == (int64_t)all[5 * k + 4];
      }
      if (skip || mine)
        continue;
      int copies = 0;
      for (int g = store->local; g < store->local + store->ghost; g++) {
        double d2 = 0.0;
        for (int d = 0; d < 3; d++)
          d2 += (position(store, g)[d] - x[d]) * (position(store, g)[d] - x[d]);
        if (*id_of(store, g) != (int64_t)all[5 * k + 4] || d2 > 1e-24)
          continue;
        assert_false(used[g - store->local]);
        used[g - store->local] = 1;
        assert_true(*radius(store, g) == all[5 * k + 3]);
        copies++;
      }
      assert_true(copies <= 1);
      assert_true(!near || copies == 1);
      found += copies;
    }
  assert_int_equal(found, store->ghost);
  free(all);
  free(used);
}

static void ghosts_complete(void **state) {
  (void)state;
  for (int which = 0; which < 4; which++) {
    part_box box = which == 0 ? free_box : periodic_box;
    if (which == 2)
      box.periodic[1] = 0;
    part_domain *domain;
    part_store *store;
    set_up(&box, 300, 1, &domain, &store);
    uint64_t seed = 31 + (uint64_t)world_rank();
    /* Since migration particles have moved a little, out of parts and box too. */
    for (int i = 0; which == 3 && i < store->local; i++)
      for (int d = 0; d < 3; d++)
        position(store, i)[d] += 0.1 * (uniform(&seed) - 0.5);
    const double reach = which == 1 ? 0.25 : 0.1; /* 0.25: exactly half the shortest side */
    OK(part_domain_ghosts(domain, store, reach));
    check_ghosts(store, &box, reach);
    if (which > 0 || world_size() > 1)
      assert_true(sum_over_ranks(store->ghost) > 0);
    else
      assert_int_equal(store->ghost, 0);
    tear_down(domain, store);
  }
}

static void ghosts_follow(void **state) {
  (void)state;
  part_domain *domain;
  part_store *store;
  set_up(&periodic_box, 300, 1, &domain, &store);
  OK(part_domain_ghosts(domain, store, 0.1));
  const int ghosts = store->ghost;
  double *before = calloc(4 * (size_t)ghosts + 1, sizeof *before);
  memcpy(before, position(store, store->local), (size_t)ghosts * 4 * sizeof *before);
  for (int round = 1; round < 4; round++) {
    for (int i = 0; i < store->local; i++)
      for (int d = 0; d < 3; d++) {
        position(store, i)[d] += 1e-3 * (double)(*id_of(store, i) % 7 - d);
        velocity(store, i)[d] = round + (double)*id_of(store, i);
      }
    OK(part_domain_update_ghosts(domain, store));
    assert_int_equal(store->ghost, ghosts);
    for (int g = 0; g < ghosts; g++) {
      const int i = store->local + g;
      for (int d = 0; d < 3; d++) {
        const double moved = round * 1e-3 * (double)(*id_of(store, i) % 7 - d);
        assert_true(fabs(position(store, i)[d] - before[4 * g + d] - moved) < 1e-14);
        assert_true(velocity(store, i)[d] == round + (double)*id_of(store, i));
      }
    }
  }
  free(before);
  int first;
  OK(part_store_append(store, 1, &first));
  FAILS(PART_ERR_STATE, "after a change", part_domain_update_ghosts(domain, store));
  tear_down(domain, store);
}

static void reach_is_checked(void **state) {
  (void)state;
  part_domain *domain;
  part_store *store;
  set_up(&periodic_box, 100, 1, &domain, &store);
  FAILS(PART_ERR_RANGE, "direction y", part_domain_ghosts(domain, store, 0.2501));
  assert_int_equal(store->ghost, 0);
  FAILS(PART_ERR_RANGE, "reach", part_domain_ghosts(domain, store, -1.0));
  FAILS(PART_ERR_RANGE, "reach", part_domain_ghosts(domain, store, (double)NAN));
  OK(part_domain_ghosts(domain, store, 0.0));
  tear_down(domain, store);
  const part_box bad = {{0, 0, 0}, {1, 0, 1}, {0}, {0}};
  FAILS(PART_ERR_RANGE, "direction y", part_domain_create(MPI_COMM_WORLD, &bad, &domain));
  assert_null(domain);
}

static void save_and_load(void **state) {
  (void)state;
  part_domain *a, *b;
  part_store *store;
  unsigned char *bytes;
  size_t size;
  set_up(&free_box, 500, 1, &a, &store);
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
  tear_down(a, store);
}

/* The same again gives the same, bit for bit and in the same order. */
static void repeatable(void **state) {
  (void)state;
  part_domain *a, *b;
  part_store *one, *two;
  set_up(&periodic_box, 700, 1, &a, &one);
  set_up(&periodic_box, 700, 1, &b, &two);
  OK(part_domain_ghosts(a, one, 0.1));
  OK(part_domain_ghosts(b, two, 0.1));
  assert_int_equal(one->local, two->local);
  assert_int_equal(one->ghost, two->ghost);
  const size_t n = (size_t)(one->local + one->ghost);
  assert_memory_equal(one->record[REC_XR], two->record[REC_XR], n * 32);
  assert_memory_equal(one->record[REC_ID], two->record[REC_ID], n * 8);
  tear_down(a, one);
  tear_down(b, two);
}

static const struct CMUnitTest tests[] = {
    cmocka_unit_test(balance_and_migrate), cmocka_unit_test(weights_count),
    cmocka_unit_test(few_and_coincident),  cmocka_unit_test(lattice_on_cuts),
    cmocka_unit_test(payload_travels),     cmocka_unit_test(homes),
    cmocka_unit_test(data_to_ghosts),      cmocka_unit_test(bad_positions),
    cmocka_unit_test(ghosts_complete),     cmocka_unit_test(ghosts_follow),
    cmocka_unit_test(reach_is_checked),    cmocka_unit_test(save_and_load),
    cmocka_unit_test(repeatable),
};
RUN_WITH_MPI(tests)
