/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ranks: 1 3 */
#include "common.h"

#include <stdio.h>
#include <string.h>

static void messages(void **state) {
  (void)state;
  assert_int_equal(part_fail(PART_ERR_RANGE, "value %d of %s", 7, "skin"), PART_ERR_RANGE);
  assert_string_equal(part_last_error(), "value 7 of skin");
  assert_int_equal(part_fail_context(PART_ERR_RANGE, "file %s", "a.txt"), PART_ERR_RANGE);
  assert_string_equal(part_last_error(), "file a.txt: value 7 of skin");
  /* Its own message as an argument must not be overwritten while it is read. */
  part_fail(PART_ERR_IO, "again: %s", part_last_error());
  assert_string_equal(part_last_error(), "again: file a.txt: value 7 of skin");
}

static void long_messages_are_cut(void **state) {
  (void)state;
  char text[3000];
  memset(text, 'x', sizeof text - 1);
  text[sizeof text - 1] = '\0';
  part_fail(PART_ERR_IO, "%s", text);
  assert_int_equal(strlen(part_last_error()), 1023);
  part_fail_context(PART_ERR_IO, "%s", "where");
  assert_int_equal(strlen(part_last_error()), 1023);
  assert_memory_equal(part_last_error(), "where: xxx", 10);
  part_fail_context(PART_ERR_IO, "%s", text);
  assert_int_equal(strlen(part_last_error()), 1023);
}

static void names(void **state) {
  (void)state;
  assert_string_equal(part_status_name(PART_OK), "OK");
  assert_string_equal(part_status_name(PART_ERR_OUTSIDE), "ERR_OUTSIDE");
  assert_string_equal(part_status_text(PART_ERR_MEMORY), "out of memory");
  assert_string_equal(part_status_name(-3), "unknown status");
  assert_string_equal(part_status_text(PART_STATUS_COUNT), "unknown status");
}

static int tries(int status) {
  PART_TRY(status);
  return 1000;
}

static void try_returns_early(void **state) {
  (void)state;
  assert_int_equal(tries(PART_ERR_IO), PART_ERR_IO);
  assert_int_equal(tries(PART_OK), 1000);
}

static void ranks_agree(void **state) {
  (void)state;
  const int size = world_size(), rank = world_rank();
  assert_int_equal(part_agree(MPI_COMM_WORLD, PART_OK), PART_OK);
  int mine = PART_OK;
  if (rank == size - 1)
    mine = part_fail(PART_ERR_NUMERIC, "rank %d", rank);
  assert_int_equal(part_agree(MPI_COMM_WORLD, mine), PART_ERR_NUMERIC);
  char text[20];
  snprintf(text, sizeof text, "rank %d", size - 1);
  assert_string_equal(part_last_error(), text);
  /* The lowest of those with the largest status speaks. */
  part_fail(0, "rank %d", rank);
  assert_int_equal(part_agree(MPI_COMM_WORLD, PART_ERR_IO), PART_ERR_IO);
  assert_string_equal(part_last_error(), "rank 0");
}

static const struct CMUnitTest tests[] = {
    cmocka_unit_test(messages),    cmocka_unit_test(long_messages_are_cut),
    cmocka_unit_test(names),       cmocka_unit_test(try_returns_early),
    cmocka_unit_test(ranks_agree),
};
RUN_WITH_MPI(tests)
