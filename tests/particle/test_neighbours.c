/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ranks: 1 2 3 4 */
#include "common.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../libparticle/src/pairs_near.h"
#include "particle/neighbours.h"

static const part_box free_box = {{0, 0, 0}, {1, 1, 1}, {0}, {0}};
static const part_box periodic_box = {{0, 0, 0}, {1, 1, 1}, {1, 1, 1}, {0}};

static void check_same(const part_pairs *a, const part_pairs *b) {
  assert_int_equal(a->rows, b->rows);
  assert_memory_equal(a->start, b->start, ((size_t)a->rows + 1) * sizeof(int));
  assert_memory_equal(a->partner, b->partner, (size_t)a->start[a->rows] * sizeof(int));
}

static void check_rows(const part_pairs *pairs, const part_store *store) {
  assert_int_equal(pairs->rows, store->local);
  assert_int_equal(pairs->start[0], 0);
  for (int i = 0; i < pairs->rows; i++)
    for (int k = pairs->start[i]; k < pairs->start[i + 1]; k++) {
      assert_in_range(pairs->partner[k], i + 1, store->local + store->ghost - 1);
      assert_true(k == pairs->start[i] || pairs->partner[k] > pairs->partner[k - 1]);
    }
}

/* Fast list against all pairs; returns the number of pairs. */
static int compare_levels(const part_store *store, const part_levels *levels, double skin) {
  part_pairs *fast, *naive;
  OK(part_pairs_create(0, &fast));
  OK(part_pairs_create(0, &naive));
  OK(part_pairs_build(fast, store, F_R, levels, skin));
  OK(part_pairs_build_naive(naive, store, F_R, skin));
  check_rows(fast, store);
  check_same(fast, naive);
  assert_true(fast->skin == skin);
  const int n = fast->start[fast->rows];
  part_pairs_destroy(fast);
  part_pairs_destroy(naive);
  return n;
}

static int compare(const part_store *store, double skin) {
  return compare_levels(store, NULL, skin);
}

static void fast_is_naive(void **state) {
  (void)state;
  for (int which = 0; which < 6; which++) {
    part_domain *domain;
    part_store *store;
    const part_box *box = which % 2 == 0 ? &free_box : &periodic_box;
    const double r0 = which < 2 ? 0.03 : 0.002, r1 = which < 4 ? 0.03 : 0.1; /* ratio 1, 15, 50 */
    const double skin = 0.005;
    each_domain(box, 400, r0, r1, &domain, &store);
    OK(part_domain_ghosts(domain, store, 2 * r1 + skin));
    assert_true(compare(store, skin) > 0);
    assert_true(compare(store, 0.0) > 0);
    part_store_destroy(store);
    part_domain_destroy(domain);
  }
}

/* Power law of sizes, number ~ d^-3 between 1 and ratio, half of the particles in a cluster. */
static void power_law(part_store *store, double r1, double ratio) {
  uint64_t seed = 77 + (uint64_t)world_rank();
  for (int i = 0; i < store->local; i++) {
    const double low = 1.0 / (ratio * ratio), u = low + (1.0 - low) * uniform(&seed);
    *radius(store, i) = r1 / ratio / sqrt(u);
    for (int d = 0; i % 2 == 0 && d < 3; d++)
      position(store, i)[d] = 0.05 + 0.15 * uniform(&seed);
  }
}

/* Of each row the number of partners, and a sum over their ids and places that does not depend on
 * their order. */
static uint64_t *row_sums(const part_store *store, double skin) {
  part_pairs *pairs;
  uint64_t *sum = calloc(2 * (size_t)store->local + 1, sizeof *sum);
  OK(part_pairs_create(0, &pairs));
  OK(part_pairs_build(pairs, store, F_R, NULL, skin));
  for (int i = 0; i < pairs->rows; i++)
    for (int k = pairs->start[i]; k < pairs->start[i + 1]; k++) {
      uint64_t bits = 0, x;
      for (int d = 0; d < 3; d++) {
        memcpy(&x, position(store, pairs->partner[k]) + d, sizeof x);
        bits = bits * 31 + x;
      }
      sum[2 * i]++;
      sum[2 * i + 1] += (bits ^ (uint64_t)*id_of(store, pairs->partner[k])) * 0x9e3779b97f4a7c15u;
    }
  part_pairs_destroy(pairs);
  return sum;
}

/* Few ghosts by radii list the same pairs as all that are within the longest reach. */
static void ghosts_of_what_is_needed(void **state) {
  (void)state;
  const double ratio[] = {1.0, 3.0, 20.0, 100.0};
  long long few = 0, all = 0;
  for (int which = 0; which < 8; which++) {
    part_domain *domain;
    part_store *store;
    part_levels levels;
    const double r1 = 0.1, q = ratio[which / 2], skin = 0.004;
    each_domain(which % 2 == 0 ? &free_box : &periodic_box, 600, r1 / q, r1, &domain, &store);
    power_law(store, r1, q);
    OK(part_domain_balance(domain, store, NULL));
    OK(part_domain_migrate(domain, store, 0, NULL, NULL));
    part_levels_set(&levels, r1 / q, r1);
    OK(part_domain_ghosts(domain, store, 2 * r1 + skin));
    all += which > 3 ? store->ghost : 0;
    uint64_t *wanted = row_sums(store, skin);
    OK(part_domain_sphere_ghosts(domain, store, F_R, &levels, skin));
    few += which > 3 ? store->ghost : 0;
    uint64_t *found = row_sums(store, skin);
    assert_memory_equal(found, wanted, 2 * (size_t)store->local * sizeof *wanted);
    OK(part_domain_update_ghosts(domain, store));
    uint64_t *again = row_sums(store, skin);
    assert_memory_equal(again, wanted, 2 * (size_t)store->local * sizeof *wanted);
    free(wanted);
    free(found);
    free(again);
    part_store_destroy(store);
    part_domain_destroy(domain);
  }
  print_message("ghosts of wide distributions on this rank: %lld of %lld\n", few, all);
  assert_true(2 * few < all);
}

/* Ghosts in no pair go; the others keep everything, and are kept up to date. */
static void trimmed_ghosts(void **state) {
  (void)state;
  long long kept = 0, made = 0;
  for (int which = 0; which < 4; which++) {
    part_domain *domain;
    part_store *store;
    part_pairs *pairs;
    part_levels levels;
    const double r1 = 0.05, q = which < 2 ? 1.0 : 10.0, skin = 0.004;
    each_domain(which % 2 == 0 ? &free_box : &periodic_box, 300, r1 / q, r1, &domain, &store);
    part_levels_set(&levels, r1 / q, r1);
    OK(part_domain_sphere_ghosts(domain, store, F_R, &levels, skin));
    made += store->ghost;
    uint64_t *wanted = row_sums(store, skin);
    OK(part_pairs_create(0, &pairs));
    OK(part_pairs_build(pairs, store, F_R, &levels, skin));
    OK(part_pairs_trim_ghosts(pairs, domain, store));
    kept += store->ghost;
    check_rows(pairs, store);
    compare(store, skin);
    unsigned char *used = calloc((size_t)store->ghost + 1, 1);
    for (int k = 0; k < pairs->start[pairs->rows]; k++)
      if (pairs->partner[k] >= store->local)
        used[pairs->partner[k] - store->local] = 1;
    int64_t *ids = calloc((size_t)store->ghost + 1, sizeof *ids);
    int64_t *own = calloc((size_t)store->local + 1, sizeof *own);
    for (int i = 0; i < store->local; i++)
      own[i] = *id_of(store, i);
    OK(part_domain_copy_to_ghosts(domain, store, sizeof *own, own, ids));
    for (int g = 0; g < store->ghost; g++) {
      assert_int_equal(used[g], 1);
      assert_int_equal(ids[g], *id_of(store, store->local + g));
      position(store, store->local + g)[0] = NAN;
    }
    OK(part_domain_update_ghosts(domain, store));
    uint64_t *found = row_sums(store, skin);
    assert_memory_equal(found, wanted, 2 * (size_t)store->local * sizeof *wanted);
    free(wanted);
    free(found);
    free(used);
    free(ids);
    free(own);
    part_pairs_destroy(pairs);
    part_store_destroy(store);
    part_domain_destroy(domain);
  }
  print_message("ghosts in pairs on this rank: %lld of %lld\n", kept, made);
  assert_true(kept > 0 && kept < made);
}

/* Small spheres on one side, one large on the other: only those that it touches are copied. */
static void small_ghosts_of_a_large_sphere(void **state) {
  (void)state;
  part_domain *domain;
  part_store *store;
  uint64_t seed = 5;
  part_levels levels;
  OK(part_domain_create(MPI_COMM_WORLD, &free_box, &domain));
  OK(part_store_create(&test_layout, &store));
  if (world_rank() == 0) {
    fill_random(store, 1000, 0, &free_box, 0.004, 0.004, &seed);
    const double x[3] = {0.5, 0.5, 0.5};
    fill_particle(store, 0, 0, x, 0.2);
  }
  OK(part_domain_balance(domain, store, NULL));
  OK(part_domain_migrate(domain, store, 0, NULL, NULL));
  part_levels_set(&levels, 0.004, 0.2);
  OK(part_domain_sphere_ghosts(domain, store, F_R, &levels, 0.01));
  double lo[3] = {9, 9, 9}, hi[3] = {-9, -9, -9}; /* around own small ones */
  for (int i = 0; i < store->local; i++)
    for (int d = 0; d < 3 && *id_of(store, i) != 0; d++) {
      lo[d] = fmin(lo[d], position(store, i)[d]);
      hi[d] = fmax(hi[d], position(store, i)[d]);
    }
  for (int g = store->local; g < store->local + store->ghost; g++) {
    double d2 = 0.0, out = 0.0;
    for (int d = 0; d < 3; d++) {
      const double x = position(store, g)[d];
      d2 += (x - 0.5) * (x - 0.5);
      out = fmax(out, fmax(lo[d] - x, x - hi[d]));
    }
    /* The large one itself, what touches it, or within reach of small ones over a cut. */
    assert_true(*id_of(store, g) == 0 || sqrt(d2) < 0.2141 || out < 0.0181);
  }
  FAILS(PART_ERR_RANGE, "skin", part_domain_sphere_ghosts(domain, store, F_R, &levels, -0.1));
  part_store_destroy(store);
  part_domain_destroy(domain);
}

static void wide_distributions(void **state) {
  (void)state;
  const double ratio[] = {1.0, 1.9, 2.1, 10.0, 50.0, 100.0};
  int pairs = 0;
  for (int which = 0; which < 12; which++) {
    part_domain *domain;
    part_store *store;
    part_levels levels, coarse = {2, {0.01, 0.1}};
    const double r1 = 0.1, q = ratio[which / 2], skin = 0.004;
    each_domain(which % 2 == 0 ? &free_box : &periodic_box, 300, r1 / q, r1, &domain, &store);
    power_law(store, r1, q);
    OK(part_domain_balance(domain, store, NULL));
    OK(part_domain_migrate(domain, store, 0, NULL, NULL));
    part_levels_set(&levels, r1 / q, r1);
    assert_true(levels.count <= 1 + (int)(log2(q) * (1.0 - 1e-9)));
    for (int sorted = 0; sorted < 2; sorted++) {
      OK(part_domain_ghosts(domain, store, 2 * r1 + skin));
      const int n = compare(store, skin);
      assert_int_equal(compare_levels(store, &levels, skin), n);
      assert_int_equal(compare_levels(store, &coarse, skin), n);
      pairs += n;
      OK(part_sort(store, part_domain_box(domain), F_R, &levels, skin));
      for (int i = 1; i < store->local; i++) /* small ones first */
        assert_true(part_level_of(&levels, *radius(store, i)) >=
                    part_level_of(&levels, *radius(store, i - 1)));
    }
    part_store_destroy(store);
    part_domain_destroy(domain);
  }
  assert_true(pairs > 1000);
}

static void levels_hold_radii(void **state) {
  (void)state;
  part_levels levels;
  part_levels_set(&levels, 0.3, 0.3);
  assert_int_equal(levels.count, 1);
  part_levels_set(&levels, 0.25, 1.0); /* just a power of two */
  assert_int_equal(levels.count, 2);
  assert_true(levels.top[1] == 1.0);
  assert_true(fabs(levels.top[0] - 0.5) < 1e-15);
  assert_int_equal(part_level_of(&levels, 0.25), 0);
  assert_int_equal(part_level_of(&levels, levels.top[0]), 0);
  assert_int_equal(part_level_of(&levels, 0.51), 1);
  assert_int_equal(part_level_of(&levels, 7.0), 1);
  assert_int_equal(part_level_of(&levels, 0.0), 0);
  part_levels_set(&levels, 0.02, 1.0);
  assert_int_equal(levels.count, 6);
  part_levels_set(&levels, 0.0, 1.0); /* points among spheres */
  assert_int_equal(levels.count, PART_LEVELS_MAX);
  part_levels_set(&levels, 0.0, 0.0);
  assert_int_equal(levels.count, 1);
}

/* The vector loops give the same as the plain one, whatever the length and the end of a run. */
static void near_variants(void **state) {
  (void)state;
  enum { N = 61 };
  part_cells cells;
  double x[4 * N];
  uint64_t seed = 3;
  int found[2][N + CELLS_PADDING];
  for (int k = 0; k < 4 * N; k++)
    x[k] = k % 4 == 3 ? 0.1 + 0.2 * uniform(&seed) : uniform(&seed);
  memset(&cells, 0, sizeof cells);
  const part_points points = {x, x + 3, 4, 4};
  OK(part_cells_build(&cells, &points, N, NULL, 1.0));
  for (int k = 0; k < 3; k++) {
    part_near_function *near = part_near_variant(k);
    for (int from = 0; near != NULL && from < 12; from++)
      for (int to = from; to <= N; to++) {
        const int n = near(&cells, from, to, x + 4 * from, 0.05, from / 2, found[0]);
        const int m =
            part_near_variant(0)(&cells, from, to, x + 4 * from, 0.05, from / 2, found[1]);
        assert_int_equal(n, m);
        assert_memory_equal(found[0], found[1], (size_t)n * sizeof(int));
        assert_true(to < N || n > 0);
      }
  }
  assert_null(part_near_variant(3));
  part_cells_free(&cells);
}

static void unusual_places(void **state) {
  (void)state;
  part_store *store;
  uint64_t seed = 8;
  OK(part_store_create(&test_layout, &store));
  assert_int_equal(compare(store, 0.1), 0); /* nobody */
  const double x[3] = {0.3, 0.3, 0.3};
  int first;
  OK(part_store_append(store, 1, &first));
  fill_particle(store, first, 0, x, 0.1);
  assert_int_equal(compare(store, 0.1), 0); /* alone */
  OK(part_store_append(store, 19, &first));
  for (int i = 0; i < 20; i++)
    fill_particle(store, i, i, x, 0.1);
  assert_int_equal(compare(store, 0.0), 190); /* all at one point */
  for (int i = 0; i < 20; i++)
    *radius(store, i) = 0.0;
  assert_int_equal(compare(store, 0.0), 0); /* points touch nobody */
  assert_int_equal(compare(store, 1e-9), 190);
  /* A lattice whose spacing is the reach: not near, "<" is strict. */
  for (int i = 0; i < 20; i++)
    position(store, i)[0] = 0.25 * i;
  assert_int_equal(compare(store, 0.25), 0);
  assert_int_equal(compare(store, 0.2500001), 19);
  /* Far apart, so that cells of the reach would be too many. */
  for (int i = 0; i < 20; i++)
    for (int d = 0; d < 3; d++)
      position(store, i)[d] = (i % 2 == 0 ? 1e9 : -1e9) * uniform(&seed);
  position(store, 3)[0] = position(store, 4)[0] + 1e-7;
  position(store, 3)[1] = position(store, 4)[1];
  position(store, 3)[2] = position(store, 4)[2];
  assert_int_equal(compare(store, 1e-3), 1);
  part_store_destroy(store);
}

static void bad_input(void **state) {
  (void)state;
  part_store *store;
  part_pairs *pairs;
  uint64_t seed = 8;
  OK(part_store_create(&test_layout, &store));
  fill_random(store, 10, 500, &free_box, 0.1, 0.1, &seed);
  OK(part_pairs_create(1, &pairs));
  FAILS(PART_ERR_RANGE, "skin", part_pairs_build(pairs, store, F_R, NULL, -1.0));
  FAILS(PART_ERR_RANGE, "skin", part_pairs_build(pairs, store, F_R, NULL, (double)NAN));
  FAILS(PART_ERR_ARGUMENT, "radius field", part_pairs_build(pairs, store, F_ID, NULL, 0.1));
  FAILS(PART_ERR_ARGUMENT, "radius field", part_pairs_build(pairs, store, 77, NULL, 0.1));
  *radius(store, 3) = -0.5;
  FAILS(PART_ERR_NUMERIC, "particle 503", part_pairs_build(pairs, store, F_R, NULL, 0.1));
  *radius(store, 3) = 0.5;
  position(store, 4)[1] = NAN;
  FAILS(PART_ERR_NUMERIC, "particle 504", part_pairs_build(pairs, store, F_R, NULL, 0.1));
  assert_int_equal(pairs->rows, 0);
  const part_levels nothing = {1, {0.0}};
  FAILS(PART_ERR_RANGE, "cell", part_sort(store, &free_box, F_R, &nothing, 0.0));
  part_pairs_destroy(pairs);
  FAILS(PART_ERR_ARGUMENT, "-1", part_pairs_create(-1, &pairs));
  part_store_destroy(store);
}

static const struct CMUnitTest tests[] = {
    cmocka_unit_test(fast_is_naive),
    cmocka_unit_test(wide_distributions),
    cmocka_unit_test(ghosts_of_what_is_needed),
    cmocka_unit_test(trimmed_ghosts),
    cmocka_unit_test(small_ghosts_of_a_large_sphere),
    cmocka_unit_test(levels_hold_radii),
    cmocka_unit_test(near_variants),
    cmocka_unit_test(unusual_places),
    cmocka_unit_test(bad_input),
};
RUN_WITH_MPI(tests)
