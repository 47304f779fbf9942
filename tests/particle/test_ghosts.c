/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ranks: 1 2 3 4 */
#include "common.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const part_box free_box = {{-1, 0, 2}, {1, 0.5, 3}, {0, 0, 0}, {0, 0, 0}};
static const part_box periodic_box = {{-1, 0, 2}, {1, 0.5, 3}, {1, 1, 1}, {0, 0, 0}};

static void data_to_ghosts(void **state) {
  (void)state;
  part_domain *domain;
  part_store *store;
  shared_domain(&periodic_box, 500, 1, &domain, &store);
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
  drop_domain(domain, store);
}

/* Every image of every particle that is within reach of an own particle must be among the ghosts
 * (once), every ghost must be an image of a particle. */
static void check_ghosts(const part_store *store, const part_box *box, double reach) {
  int n;
  double *all = all_particles(store, &n);
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
    shared_domain(&box, 300, 1, &domain, &store);
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
    drop_domain(domain, store);
  }
}

static void ghosts_follow(void **state) {
  (void)state;
  part_domain *domain;
  part_store *store;
  shared_domain(&periodic_box, 300, 1, &domain, &store);
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
  drop_domain(domain, store);
}

static void reach_is_checked(void **state) {
  (void)state;
  part_domain *domain;
  part_store *store;
  shared_domain(&periodic_box, 100, 1, &domain, &store);
  FAILS(PART_ERR_RANGE, "direction y", part_domain_ghosts(domain, store, 0.2501));
  assert_int_equal(store->ghost, 0);
  FAILS(PART_ERR_RANGE, "reach", part_domain_ghosts(domain, store, -1.0));
  FAILS(PART_ERR_RANGE, "reach", part_domain_ghosts(domain, store, (double)NAN));
  OK(part_domain_ghosts(domain, store, 0.0));
  drop_domain(domain, store);
  const part_box bad = {{0, 0, 0}, {1, 0, 1}, {0}, {0}};
  FAILS(PART_ERR_RANGE, "direction y", part_domain_create(MPI_COMM_WORLD, &bad, &domain));
  assert_null(domain);
}

static const struct CMUnitTest tests[] = {
    cmocka_unit_test(data_to_ghosts),
    cmocka_unit_test(ghosts_complete),
    cmocka_unit_test(ghosts_follow),
    cmocka_unit_test(reach_is_checked),
};
RUN_WITH_MPI(tests)
