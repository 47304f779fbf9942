/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ranks: 1 2 3 4 */
#include "common.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "particle/neighbours.h"

/* Any order before gives the same order after. */
static void sort_is_canonical(void **state) {
  (void)state;
  enum { N = 3000 };
  const part_box box = {{-1, 0, 0}, {1, 0.5, 2}, {0}, {0}};
  const part_levels one_level = {1, {0.02}}, tiny = {1, {0.0}};
  part_store *a, *b;
  uint64_t seed = 4;
  OK(part_store_create(&test_layout, &a));
  OK(part_store_create(&test_layout, &b));
  fill_random(a, N, 0, &box, 0.01, 0.02, &seed);
  for (int i = 0; i < 40; i++) /* outside the box, and many in one cell */
    position(a, i)[i % 3] += i % 2 == 0 ? 5.0 : -5.0;
  for (int i = 40; i < 100; i++)
    position(a, i)[0] = position(a, i)[1] = position(a, i)[2] = 0.2;
  int first, order[N];
  OK(part_store_append(b, N, &first));
  memcpy(b->record[REC_XR], a->record[REC_XR], (size_t)N * 32);
  memcpy(b->record[REC_V], a->record[REC_V], (size_t)N * 32);
  memcpy(b->record[REC_ID], a->record[REC_ID], (size_t)N * 8);
  memcpy(b->record[REC_CODE], a->record[REC_CODE], (size_t)N * 16);
  for (int k = 0; k < N; k++)
    order[k] = k;
  for (int k = N - 1; k > 0; k--) {
    const int other = below(&seed, k + 1), swap = order[k];
    order[k] = order[other];
    order[other] = swap;
  }
  OK(part_store_permute(b, order));
  OK(part_sort(a, &box, F_R, &one_level, 0.02));
  OK(part_sort(b, &box, F_R, &one_level, 0.02));
  assert_memory_equal(a->record[REC_ID], b->record[REC_ID], (size_t)N * 8);
  assert_memory_equal(a->record[REC_XR], b->record[REC_XR], (size_t)N * 32);
  const int n[3] = {33, 8, 33};
  int last = -1;
  for (int i = 0; i < N; i++) {
    int cell = 0;
    assert_true(intact(a, i));
    for (int d = 2; d >= 0; d--) {
      const double at = (position(a, i)[d] - box.lo[d]) / (box.hi[d] - box.lo[d]) * n[d];
      cell = cell * n[d] + (int)fmin(fmax(floor(at), 0.0), n[d] - 1);
    }
    assert_true(cell >= last);
    assert_true(cell > last || *id_of(a, i) > *id_of(a, i - 1));
    last = cell;
  }
  /* Tiny and huge cells; nobody. */
  OK(part_sort(a, &box, F_R, &tiny, 1e-12));
  OK(part_sort(b, &box, F_R, &tiny, 1e-12));
  assert_memory_equal(a->record[REC_ID], b->record[REC_ID], (size_t)N * 8);
  OK(part_sort(a, &box, F_R, &tiny, 1e12));
  for (int i = 0; i < N; i++)
    assert_int_equal(*id_of(a, i), i);
  a->local = 0;
  OK(part_sort(a, &box, F_R, &tiny, 0.1));
  part_store_destroy(a);
  part_store_destroy(b);
}

static const struct CMUnitTest tests[] = {
    cmocka_unit_test(sort_is_canonical),
};
RUN_WITH_MPI(tests)
