/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ranks: 1 2 3 4 */
#include "common.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "particle/neighbours.h"

enum { WIDTH = 3 };

static const part_box free_box = {{0, 0, 0}, {1, 1, 1}, {0}, {0}};
static const part_box periodic_box = {{0, 0, 0}, {1, 1, 1}, {1, 1, 1}, {0}};

/* Data of a pair made from the two ids, odd under exchange; a third of the pairs has none. */
static void pair_value(int64_t i, int64_t j, double data[WIDTH]) {
  const int64_t low = i < j ? i : j, high = i < j ? j : i;
  const double sign = i < j ? 1.0 : -1.0;
  for (int w = 0; w < WIDTH; w++)
    data[w] = (low + high) % 3 == 0 ? 0.0 : sign * (double)(low * 1000 + high + w);
}

static void put_values(part_pairs *pairs, const part_store *store) {
  for (int i = 0; i < pairs->rows; i++)
    for (int k = pairs->start[i]; k < pairs->start[i + 1]; k++)
      pair_value(*id_of(store, i), *id_of(store, pairs->partner[k]), pairs->data + WIDTH * k);
}

/* Every listed pair that was there before has its data again; returns how many had some. */
static int check_values(const part_pairs *pairs, const part_store *store, int all_known) {
  int with_data = 0;
  for (int i = 0; i < pairs->rows; i++)
    for (int k = pairs->start[i]; k < pairs->start[i + 1]; k++) {
      const double *data = pairs->data + WIDTH * (size_t)k;
      double want[WIDTH];
      pair_value(*id_of(store, i), *id_of(store, pairs->partner[k]), want);
      const int blank = data[0] == 0.0 && data[1] == 0.0 && data[2] == 0.0;
      for (int w = 0; w < WIDTH; w++)
        assert_true(data[w] == want[w] || (!all_known && blank));
      with_data += !blank;
    }
  return with_data;
}

static void history_through_everything(void **state) {
  (void)state;
  for (int which = 0; which < 2; which++) {
    const part_box *box = which == 0 ? &free_box : &periodic_box;
    const double r = 0.04, skin = 0.01;
    part_domain *domain;
    part_store *store;
    part_pairs *pairs;
    each_domain(box, 500, r, r, &domain, &store);
    OK(part_pairs_create(WIDTH, &pairs));
    OK(part_domain_ghosts(domain, store, 2 * r + skin));
    OK(part_pairs_build(pairs, store, F_R, NULL, skin));
    for (int k = 0; k < WIDTH * pairs->start[pairs->rows]; k++)
      assert_true(pairs->data[k] == 0.0);
    put_values(pairs, store);
    long long with_data = check_values(pairs, store, 1), again;
    MPI_Allreduce(MPI_IN_PLACE, &with_data, 1, MPI_LONG_LONG, MPI_SUM, MPI_COMM_WORLD);
    assert_true(with_data > 100);
    for (int round = 0; round < 3; round++) {
      /* Other parts (weights), migration with the data, sorting, new ghosts, new list. */
      int *count;
      void *entry;
      OK(part_pairs_gather(pairs, store, &count, &entry));
      double *weight = calloc((size_t)store->local + 1, sizeof *weight);
      for (int i = 0; i < store->local; i++)
        weight[i] = 1.0 + (double)round * 5.0 * position(store, i)[round % 3];
      OK(part_domain_balance(domain, store, weight));
      free(weight);
      OK(part_domain_migrate(domain, store, part_pairs_entry_size(pairs), &count, &entry));
      OK(part_domain_ghosts(domain, store, 2 * r + skin));
      OK(part_pairs_build(pairs, store, F_R, NULL, skin));
      OK(part_pairs_scatter(pairs, store, count, entry));
      free(count);
      free(entry);
      again = check_values(pairs, store, 1);
      MPI_Allreduce(MPI_IN_PLACE, &again, 1, MPI_LONG_LONG, MPI_SUM, MPI_COMM_WORLD);
      if (world_size() == 1)
        assert_true(again == with_data);
      assert_true(again > 100);
    }
    /* Pairs part and new ones come: those have zeros. */
    int *count;
    void *entry;
    OK(part_pairs_gather(pairs, store, &count, &entry));
    for (int i = 0; i < store->local; i++)
      position(store, i)[0] += 0.01 * sin(7.0 * (double)*id_of(store, i));
    OK(part_domain_migrate(domain, store, part_pairs_entry_size(pairs), &count, &entry));
    OK(part_domain_ghosts(domain, store, 2 * r + skin));
    OK(part_pairs_build(pairs, store, F_R, NULL, skin));
    OK(part_pairs_scatter(pairs, store, count, entry));
    again = check_values(pairs, store, 0);
    assert_true(again < pairs->start[pairs->rows] || pairs->rows == 0);
    free(count);
    free(entry);
    part_pairs_destroy(pairs);
    part_store_destroy(store);
    part_domain_destroy(domain);
  }
}

/* One large sphere with more partners than the short search is made for. */
static void history_of_long_rows(void **state) {
  (void)state;
  part_store *store;
  part_pairs *pairs;
  uint64_t seed = 21;
  int *count;
  void *entry;
  OK(part_store_create(&test_layout, &store));
  fill_random(store, 500, 0, &free_box, 0.01, 0.01, &seed);
  *radius(store, 250) = 0.4;
  position(store, 250)[0] = position(store, 250)[1] = position(store, 250)[2] = 0.5;
  OK(part_pairs_create(WIDTH, &pairs));
  OK(part_pairs_build(pairs, store, F_R, NULL, 0.0));
  put_values(pairs, store);
  const int with_data = check_values(pairs, store, 1);
  OK(part_pairs_gather(pairs, store, &count, &entry));
  assert_true(count[250] > 50);
  OK(part_pairs_build(pairs, store, F_R, NULL, 0.001));
  OK(part_pairs_scatter(pairs, store, count, entry));
  assert_int_equal(check_values(pairs, store, 0), with_data);
  store->local = 499;
  FAILS(PART_ERR_STATE, "rows", part_pairs_scatter(pairs, store, count, entry));
  free(count);
  free(entry);
  FAILS(PART_ERR_STATE, "rows", part_pairs_gather(pairs, store, &count, &entry));
  part_pairs_destroy(pairs);
  part_store_destroy(store);
}

static const struct CMUnitTest tests[] = {
    cmocka_unit_test(history_through_everything),
    cmocka_unit_test(history_of_long_rows),
};
RUN_WITH_MPI(tests)
