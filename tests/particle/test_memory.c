/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ranks: 1 */
/* Memory that runs out: every allocation of a scene fails once, and each time the call says so,
 * leaks nothing, and leaves particles and lists that still work. */
#include "common.h"

#include <stdlib.h>
#include <string.h>

#include "particle/exchange.h"
#include "particle/neighbours.h"
#include "particle/timers.h"

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define SANITIZED 1
#endif
#endif
#if defined(__SANITIZE_ADDRESS__)
#define SANITIZED 1
#endif

static int armed, countdown, failures;
static long live;

#if defined(__GLIBC__) && !defined(SANITIZED)
#define INTERPOSED 1
/* In front of the C library's, for this program and the libraries it loads. */
void *__libc_calloc(size_t n, size_t size);
void *__libc_realloc(void *old, size_t size);
void *__libc_memalign(size_t alignment, size_t size);
void __libc_free(void *memory);

static int fails(void) {
  if (armed && --countdown == 0) {
    failures++;
    return 1;
  }
  return 0;
}
void *calloc(size_t n, size_t size) {
  if (fails())
    return NULL;
  live += armed;
  return __libc_calloc(n, size);
}
void *realloc(void *old, size_t size) {
  if (fails())
    return NULL;
  live += armed && old == NULL;
  return __libc_realloc(old, size);
}
void *aligned_alloc(size_t alignment, size_t size) {
  if (fails())
    return NULL;
  live += armed;
  return __libc_memalign(alignment, size);
}
void free(void *memory) {
  live -= armed && memory != NULL;
  __libc_free(memory);
}
#endif

static const part_box box = {{0, 0, 0}, {1, 1, 1}, {1, 1, 1}, {0}};

typedef struct scene {
  part_domain *domain;
  part_store *store;
  part_pairs *pairs;
  part_exchange *plan;
  part_timers *timers;
  int *count;
  void *entry;
} scene;

static int run(scene *s) {
  const int destination[3] = {0, 0, 0};
  int first;
  uint64_t seed = 6;
  PART_TRY(part_timers_create(&s->timers));
  PART_TRY(part_exchange_create(MPI_COMM_SELF, 3, destination, &s->plan));
  PART_TRY(part_store_create(&test_layout, &s->store));
  PART_TRY(part_store_append(s->store, 200, &first));
  for (int i = 0; i < 200; i++) {
    const double x[3] = {uniform(&seed), uniform(&seed), uniform(&seed)};
    fill_particle(s->store, i, i, x, 0.05);
  }
  PART_TRY(part_sort(s->store, &box, F_R, &(part_levels){1, {0.05}}, 0.01));
  PART_TRY(part_domain_ghosts(s->domain, s->store, 0.11));
  PART_TRY(part_pairs_create(3, &s->pairs));
  PART_TRY(part_pairs_build(s->pairs, s->store, F_R, NULL, 0.01));
  for (int k = 0; k < 3 * s->pairs->start[s->pairs->rows]; k++)
    s->pairs->data[k] = 1.0;
  PART_TRY(part_pairs_gather(s->pairs, s->store, &s->count, &s->entry));
  PART_TRY(part_domain_migrate(s->domain, s->store, part_pairs_entry_size(s->pairs), &s->count,
                               &s->entry));
  PART_TRY(part_domain_ghosts(s->domain, s->store, 0.11));
  PART_TRY(part_pairs_build_naive(s->pairs, s->store, F_R, 0.01));
  PART_TRY(part_pairs_scatter(s->pairs, s->store, s->count, s->entry));
  return PART_OK;
}

static void release(scene *s) {
  part_timers_destroy(s->timers);
  part_exchange_destroy(s->plan);
  part_store_destroy(s->store);
  part_pairs_destroy(s->pairs);
  free(s->count);
  free(s->entry);
}

static void every_allocation_fails_once(void **state) {
  (void)state;
#ifndef INTERPOSED
  skip();
#endif
  int status = PART_ERR_MEMORY, k;
  for (k = 1; status == PART_ERR_MEMORY && k < 1000; k++) {
    scene s = {0};
    OK(part_domain_create(MPI_COMM_SELF, &box, &s.domain));
    failures = 0;
    live = 0;
    countdown = k;
    armed = 1;
    status = run(&s);
    /* The ghost plan belongs to the domain, whose MPI calls are not part of this. */
    release(&s);
    armed = 0;
    const long kept = live;
    part_domain_destroy(s.domain);
    assert_int_equal(status, failures > 0 ? PART_ERR_MEMORY : PART_OK);
    assert_true(failures == 0 || strstr(part_last_error(), "no memory for") != NULL);
    assert_in_range(kept, 0, 7); /* items, images, shifts, two lists of ranks, requests, buffer */
  }
  assert_int_equal(status, PART_OK);
  assert_true(k > 50); /* so many there were */
}

/* A failed growth keeps particles and list usable. */
static void survivors_work(void **state) {
  (void)state;
#ifndef INTERPOSED
  skip();
#endif
  part_store *store;
  part_pairs *pairs;
  uint64_t seed = 2;
  int first;
  OK(part_store_create(&test_layout, &store));
  fill_random(store, 100, 0, &box, 0.05, 0.1, &seed);
  OK(part_pairs_create(2, &pairs));
  OK(part_pairs_build(pairs, store, F_R, NULL, 0.01));
  for (int k = 1; k <= 5; k++) {
    countdown = k;
    armed = 1;
    const int status = part_store_append(store, 1000, &first);
    armed = 0;
    assert_int_equal(status, PART_ERR_MEMORY);
    assert_int_equal(store->local, 100);
    for (int i = 0; i < 100; i++)
      assert_true(*id_of(store, i) == i && intact(store, i));
  }
  OK(part_store_append(store, 1000, &first));
  countdown = 1;
  armed = 1;
  const int status = part_pairs_build(pairs, store, F_R, NULL, 0.01);
  armed = 0;
  assert_int_equal(status, PART_ERR_MEMORY);
  assert_int_equal(pairs->rows, 0);
  OK(part_pairs_build(pairs, store, F_R, NULL, 0.01));
  assert_int_equal(pairs->rows, 1100);
  part_pairs_destroy(pairs);
  part_store_destroy(store);
}

static const struct CMUnitTest tests[] = {
    cmocka_unit_test(every_allocation_fails_once),
    cmocka_unit_test(survivors_work),
};
RUN_WITH_MPI(tests)
