/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ranks: 1 */
#include "common.h"

#include <stdlib.h>
#include <string.h>

static const part_box box = {{0, 0, 0}, {1, 1, 1}, {0}, {0}};

static part_store *store_of(int n) {
  part_store *store;
  uint64_t seed = 5;
  OK(part_store_create(&test_layout, &store));
  fill_random(store, n, 0, &box, 0.1, 0.2, &seed);
  return store;
}

static void grows_and_keeps(void **state) {
  (void)state;
  part_store *store;
  OK(part_store_create(&test_layout, &store));
  assert_int_equal(store->local, 0);
  for (int k = 0; k < 1000; k++) {
    int first;
    const double x[3] = {k, 2.0 * k, 3.0 * k};
    OK(part_store_append(store, 1, &first));
    assert_int_equal(first, k);
    fill_particle(store, first, k, x, 0.5);
    for (int r = 0; r < test_layout.record_count; r++)
      assert_int_equal((uintptr_t)store->record[r] % 64, 0);
  }
  for (int k = 0; k < 1000; k++) {
    assert_int_equal(*id_of(store, k), k);
    assert_true(position(store, k)[2] == 3.0 * k && intact(store, k));
  }
  /* Loads past the end stay inside the memory (valgrind) and are numbers. */
  double sum = 0.0;
  for (int k = 4 * store->capacity; k < 4 * (store->capacity + 16); k++)
    sum += part_record_double(store, REC_XR)[k];
  assert_true(sum == 0.0);
  part_store_destroy(store);
}

static void append_zeroes_and_drops_ghosts(void **state) {
  (void)state;
  part_store *store = store_of(10);
  memset(part_record_double(store, REC_F), 0xff, 10 * 3 * 8);
  store->local = 5; /* what comes after holds old values now */
  store->ghost = 3;
  int first;
  OK(part_store_append(store, 4, &first));
  assert_int_equal(store->ghost, 0);
  for (int i = first; i < first + 4; i++) {
    assert_int_equal(*id_of(store, i), 0);
    assert_true(*radius(store, i) == 0.0 && part_field_double(store, F_FORCE)[3 * i] == 0.0);
  }
  OK(part_store_append(store, 0, &first));
  assert_int_equal(store->local, 9);
  FAILS(PART_ERR_ARGUMENT, "more particles", part_store_append(store, -1, &first));
  part_store_destroy(store);
}

static void compact_keeps_order(void **state) {
  (void)state;
  part_store *store = store_of(100);
  unsigned char keep[100];
  for (int k = 0; k < 100; k++)
    keep[k] = k % 3 == 1;
  store->ghost = 1;
  OK(part_store_compact(store, keep));
  assert_int_equal(store->local, 33);
  assert_int_equal(store->ghost, 0);
  for (int k = 0; k < 33; k++) {
    assert_int_equal(*id_of(store, k), 3 * k + 1);
    assert_true(intact(store, k));
  }
  memset(keep, 0, sizeof keep);
  OK(part_store_compact(store, keep));
  assert_int_equal(store->local, 0);
  OK(part_store_compact(store, keep));
  part_store_destroy(store);
}

static void permute(void **state) {
  (void)state;
  part_store *store = store_of(100);
  int order[100];
  for (int k = 0; k < 100; k++)
    order[k] = (k * 37 + 11) % 100;
  OK(part_store_permute(store, order));
  for (int k = 0; k < 100; k++) {
    assert_int_equal(*id_of(store, k), order[k]);
    assert_true(intact(store, k));
  }
  order[7] = order[8];
  FAILS(PART_ERR_ARGUMENT, "not a permutation", part_store_permute(store, order));
  order[7] = 100;
  FAILS(PART_ERR_ARGUMENT, "not a permutation", part_store_permute(store, order));
  store->local = 0;
  OK(part_store_permute(store, order));
  part_store_destroy(store);
}

static void pack_and_unpack(void **state) {
  (void)state;
  part_store *a = store_of(50), *b = store_of(0);
  const int index[3] = {49, 0, 17};
  int first;
  const size_t size = part_store_item_size(a, PART_MOVES);
  assert_int_equal(size, (4 + 4 + 1 + 2) * 8); /* all records but the force */
  assert_int_equal(part_store_item_size(a, PART_GHOST), (4 + 4) * 8);
  unsigned char *buffer = malloc(3 * size);
  part_store_pack(a, PART_MOVES, 3, index, buffer);
  OK(part_store_append(b, 5, &first));
  part_store_unpack(b, PART_MOVES, 1, 3, buffer);
  for (int k = 0; k < 3; k++) {
    assert_int_equal(*id_of(b, k + 1), index[k]);
    assert_true(intact(b, k + 1));
    assert_memory_equal(position(b, k + 1), position(a, index[k]), 32);
  }
  assert_int_equal(*id_of(b, 4), 0);
  free(buffer);
  part_store_destroy(a);
  part_store_destroy(b);
}

static void bad_layouts(void **state) {
  (void)state;
  part_store *store;
  part_record record[2] = {{"x", PART_DOUBLE, 3}, {"id", PART_INT64, 1}};
  part_field field[2] = {{"x", 0, 0, 3, 0, "m", ""}, {"id", 1, 0, 1, 0, "", ""}};
  part_layout layout = {2, record, 2, field, 1};
  OK(part_store_create(&layout, &store));
  part_store_destroy(store);
  field[0].comps = 4;
  FAILS(PART_ERR_ARGUMENT, "are not in record x of 3", part_store_create(&layout, &store));
  assert_null(store);
  field[0].comps = 3;
  layout.id_field = 0;
  FAILS(PART_ERR_ARGUMENT, "id_field", part_store_create(&layout, &store));
  layout.id_field = 1;
  record[0].type = PART_INT64;
  FAILS(PART_ERR_ARGUMENT, "begins with x, y, z", part_store_create(&layout, &store));
  record[0].type = PART_DOUBLE;
  field[1].record = 2;
  FAILS(PART_ERR_ARGUMENT, "record 2 does not exist", part_store_create(&layout, &store));
}

static void too_many(void **state) {
  (void)state;
  part_store *store = store_of(10);
  int first;
  /* Beyond what an int counts; what is there stays. */
  FAILS(PART_ERR_ARGUMENT, "more particles", part_store_append(store, 2147483647, &first));
  assert_int_equal(store->local, 10);
  for (int k = 0; k < 10; k++)
    assert_true(intact(store, k));
  part_store_destroy(store);
}

static void wrap(void **state) {
  (void)state;
  const part_box p = {{-1, 0, 0}, {1, 0.3, 1}, {1, 1, 0}, {0}};
  double x[3] = {3.5, -0.1, 7.0};
  int image[3];
  part_box_wrap(&p, x, image);
  assert_true(x[0] == -0.5 && image[0] == 2);
  assert_true(x[1] > 0.2 - 1e-15 && x[1] < 0.2 + 1e-15 && image[1] == -1);
  assert_true(x[2] == 7.0 && image[2] == 0);
  /* The ends: lo belongs to the box, hi does not, whatever the round-off. */
  double y[3] = {1.0, -1e-30, 0.5}, z[3] = {-1.0, 0.3, 0.5};
  part_box_wrap(&p, y, NULL);
  assert_true(y[0] == -1.0 && y[1] < 0.3 && y[1] > 0.29);
  part_box_wrap(&p, z, NULL);
  assert_true(z[0] == -1.0 && z[1] == 0.0);
  uint64_t seed = 3;
  for (int k = 0; k < 10000; k++) {
    double w[3] = {(uniform(&seed) - 0.5) * 100, (uniform(&seed) - 0.5) * 100, 0};
    const double before = w[1];
    part_box_wrap(&p, w, image);
    assert_true(w[0] >= -1 && w[0] < 1 && w[1] >= 0 && w[1] < 0.3);
    assert_true(w[1] + image[1] * 0.3 - before < 1e-13 && before - w[1] - image[1] * 0.3 < 1e-13);
  }
}

static void difference(void **state) {
  (void)state;
  const part_box p = {{0, 0, 0}, {1, 1, 1}, {1, 1, 0}, {0}};
  const double a[3] = {0.95, 0.1, 0.95}, b[3] = {0.05, 0.9, 0.05};
  double d[3];
  part_box_difference(&p, a, b, d);
  assert_true(d[0] > -0.1 - 1e-15 && d[0] < -0.1 + 1e-15);
  assert_true(d[1] > 0.2 - 1e-15 && d[1] < 0.2 + 1e-15);
  assert_true(d[2] == a[2] - b[2]);
}

static const struct CMUnitTest tests[] = {
    cmocka_unit_test(grows_and_keeps),
    cmocka_unit_test(append_zeroes_and_drops_ghosts),
    cmocka_unit_test(compact_keeps_order),
    cmocka_unit_test(permute),
    cmocka_unit_test(pack_and_unpack),
    cmocka_unit_test(bad_layouts),
    cmocka_unit_test(too_many),
    cmocka_unit_test(wrap),
    cmocka_unit_test(difference),
};
RUN_WITH_MPI(tests)
