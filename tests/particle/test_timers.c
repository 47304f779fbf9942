/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ranks: 1 2 */
#include "common.h"

#include <stdio.h>
#include <string.h>

#include "particle/timers.h"

static void busy(double seconds) {
  const double until = MPI_Wtime() + seconds;
  while (MPI_Wtime() < until)
    ;
}

static void measures(void **state) {
  (void)state;
  part_timers *timers;
  int move, sort, again;
  OK(part_timers_create(&timers));
  OK(part_timers_stage(timers, "move", &move));
  OK(part_timers_stage(timers, "sort", &sort));
  OK(part_timers_stage(timers, "move", &again));
  assert_int_equal(move, again);
  assert_true(part_timers_seconds(timers, move) == 0.0);
  const double begin = MPI_Wtime();
  for (int k = 0; k < 3; k++) {
    part_timers_start(timers, move);
    busy(0.01);
    part_timers_stop(timers, move);
  }
  const double elapsed = MPI_Wtime() - begin, seconds = part_timers_seconds(timers, move);
  assert_true(seconds > 0.0299 && seconds < elapsed + 1e-4);
  assert_int_equal(part_timers_calls(timers, move), 3);
  assert_int_equal(part_timers_calls(timers, sort), 0);
  char text[1000], small[50];
  OK(part_timers_report(timers, MPI_COMM_WORLD, sizeof text, text));
  assert_non_null(strstr(text, "largest s"));
  assert_non_null(strstr(text, "move"));
  assert_non_null(strstr(text, "100.0%"));
  FAILS(PART_ERR_ARGUMENT, "more than 50 bytes",
        part_timers_report(timers, MPI_COMM_WORLD, sizeof small, small));
  part_timers_destroy(timers);
}

static void limits(void **state) {
  (void)state;
  part_timers *timers;
  int stage;
  char name[20], text[8000];
  OK(part_timers_create(&timers));
  OK(part_timers_report(timers, MPI_COMM_WORLD, sizeof text, text)); /* no stage yet */
  for (int k = 0; k < 64; k++) {
    snprintf(name, sizeof name, "stage%d", k);
    OK(part_timers_stage(timers, name, &stage));
    assert_int_equal(stage, k);
  }
  OK(part_timers_report(timers, MPI_COMM_WORLD, sizeof text, text));
  FAILS(PART_ERR_RANGE, "one more", part_timers_stage(timers, "last", &stage));
  FAILS(PART_ERR_RANGE, "longer than",
        part_timers_stage(timers, "a name that is much longer than any stage should have", &stage));
  part_timers_destroy(timers);
  if (world_size() > 1) {
    OK(part_timers_create(&timers));
    if (world_rank() == 0)
      OK(part_timers_stage(timers, "only here", &stage));
    FAILS(PART_ERR_STATE, "between 0 and 1",
          part_timers_report(timers, MPI_COMM_WORLD, sizeof text, text));
    part_timers_destroy(timers);
  }
}

static const struct CMUnitTest tests[] = {cmocka_unit_test(measures), cmocka_unit_test(limits)};
RUN_WITH_MPI(tests)
