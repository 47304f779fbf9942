/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ranks: 1 2 3 */
/* With arguments --write N PATH: only write a file of N particles, for the reader's test. */
#define _XOPEN_SOURCE 700
#include "common.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "particle/vtkhdf.h"

static const part_box box = {{0, 0, 0}, {1, 1, 1}, {0}, {0}};
static char folder[200];

/* A file in the test's own folder. */
static const char *in_folder(const char *name) {
  static char path[4][300];
  static int next;
  next = (next + 1) % 4;
  snprintf(path[next], sizeof path[next], "%s/%s", folder, name);
  return path[next];
}

static int make_folder(void **state) {
  (void)state;
  if (world_rank() == 0) {
    snprintf(folder, sizeof folder, "/tmp/test_vtkhdf_XXXXXX");
    if (mkdtemp(folder) == NULL)
      return -1;
  }
  MPI_Bcast(folder, sizeof folder, MPI_CHAR, 0, MPI_COMM_WORLD);
  return 0;
}

static int remove_folder(void **state) {
  (void)state;
  MPI_Barrier(MPI_COMM_WORLD);
  return world_rank() == 0 ? rmdir(folder) : 0; /* tests take their files away */
}

static void remove_file(const char *path) {
  MPI_Barrier(MPI_COMM_WORLD);
  if (world_rank() == 0)
    assert_int_equal(remove(path), 0);
  MPI_Barrier(MPI_COMM_WORLD);
}

static int exists(const char *path) {
  MPI_Barrier(MPI_COMM_WORLD);
  const int there = access(path, F_OK) == 0;
  MPI_Barrier(MPI_COMM_WORLD);
  return there;
}

/* each + rank particles; ids run on over the ranks of comm. */
static part_store *make_store(MPI_Comm comm, int each) {
  part_store *store;
  int rank;
  MPI_Comm_rank(comm, &rank);
  uint64_t seed = 17 + (uint64_t)rank;
  OK(part_store_create(&test_layout, &store));
  fill_random(store, each > 0 ? each + rank : 0, (int64_t)each * rank + rank * (rank - 1) / 2, &box,
              0.1, 0.2, &seed);
  for (int i = 0; i < store->local; i++) { /* what is not written must not come back */
    part_field_double(store, F_FORCE)[3 * i] = 5.0;
    velocity(store, i)[3] = 6.0;
  }
  if (store->local > 2) { /* values that text would lose */
    velocity(store, 0)[0] = 0.1 + 0x1p-55;
    velocity(store, 1)[1] = -0.0;
    velocity(store, 2)[2] = (double)NAN;
    *id_of(store, 1) += INT64_C(1) << 60;
  }
  return store;
}

static void write_file(MPI_Comm comm, const char *path, double time, const part_store *store,
                       const char *series) {
  part_file *file;
  int rank;
  unsigned char bytes[200];
  const double values[3] = {0.1, 2.5, -1e300};
  MPI_Comm_rank(comm, &rank);
  for (int k = 0; k < 200; k++)
    bytes[k] = (unsigned char)(100 * rank + k);
  OK(part_file_create(comm, path, time, &file));
  OK(part_file_write_store(file, store));
  OK(part_file_write_values(file, "gravity", 3, values));
  OK(part_file_write_values(file, "none", 0, NULL));
  OK(part_file_write_blob(file, "history", (size_t)(10 * rank + 3), bytes));
  OK(part_file_write_blob(file, "nothing", 0, NULL));
  OK(part_file_commit(file, series));
}

static void check_fields(const part_store *got, const part_store *want, int at, int n) {
  for (int i = 0; i < n; i++) {
    assert_memory_equal(position(got, i), position(want, at + i), 4 * sizeof(double));
    assert_memory_equal(velocity(got, i), velocity(want, at + i), 3 * sizeof(double));
    assert_int_equal(*id_of(got, i), *id_of(want, at + i));
    assert_int_equal(*code_of(got, i), *code_of(want, at + i));
    assert_true(part_field_double(got, F_FORCE)[3 * i] == 0.0 && velocity(got, i)[3] == 0.0);
  }
}

static void round_trip(void **state) {
  (void)state;
  for (int each = 0; each <= 50; each += 25) {
    const char *path = in_folder("a.vtkhdf");
    part_store *store = make_store(MPI_COMM_WORLD, each), *back;
    part_file *file;
    double time, values[5];
    int n = 5;
    size_t size;
    void *bytes;
    write_file(MPI_COMM_WORLD, path, 0.3, store, NULL);
    assert_false(exists(in_folder("a.vtkhdf.part")));
    OK(part_store_create(&test_layout, &back));
    OK(part_file_open(MPI_COMM_WORLD, path, &time, &file));
    assert_true(time == 0.3);
    OK(part_file_read_store(file, back));
    assert_int_equal(back->local, store->local);
    check_fields(back, store, 0, store->local);
    OK(part_file_read_store(file, back)); /* appends */
    assert_int_equal(back->local, 2 * store->local);
    OK(part_file_read_values(file, "gravity", &n, values));
    assert_true(n == 3 && values[0] == 0.1 && values[1] == 2.5 && values[2] == -1e300);
    n = 0;
    OK(part_file_read_values(file, "none", &n, values));
    assert_int_equal(n, 0);
    n = 2;
    FAILS(PART_ERR_FORMAT, "room for 2", part_file_read_values(file, "gravity", &n, values));
    FAILS(PART_ERR_FORMAT, "gravy is missing", part_file_read_values(file, "gravy", &n, values));
    OK(part_file_read_blob(file, "history", &size, &bytes));
    assert_int_equal(size, 10 * world_rank() + 3);
    for (size_t k = 0; k < size; k++)
      assert_int_equal(((unsigned char *)bytes)[k], (unsigned char)(100 * world_rank() + (int)k));
    free(bytes);
    OK(part_file_read_blob(file, "nothing", &size, &bytes));
    assert_true(size == 0);
    free(bytes);
    part_file_close(file);
    remove_file(path);
    part_store_destroy(store);
    part_store_destroy(back);
  }
}

/* Written by all, read by each alone; written by one, read by all. */
static void other_numbers_of_ranks(void **state) {
  (void)state;
  const int size = world_size(), rank = world_rank();
  const char *path = in_folder("b.vtkhdf");
  part_file *file;
  void *bytes;
  size_t n;
  part_store *store = make_store(MPI_COMM_WORLD, 20), *back;
  OK(part_store_create(&test_layout, &back));
  write_file(MPI_COMM_WORLD, path, 1.0, store, NULL);
  OK(part_file_open(MPI_COMM_SELF, path, NULL, &file));
  OK(part_file_read_store(file, back));
  assert_int_equal(back->local, 20 * size + size * (size - 1) / 2);
  part_store *mine; /* my part of it */
  OK(part_store_create(&test_layout, &mine));
  const int at = 20 * rank + rank * (rank - 1) / 2;
  int first;
  OK(part_store_append(mine, store->local, &first));
  for (int i = 0; i < store->local; i++) {
    memcpy(position(mine, i), position(back, at + i), 32);
    memcpy(velocity(mine, i), velocity(back, at + i), 24);
    *id_of(mine, i) = *id_of(back, at + i);
    *code_of(mine, i) = *code_of(back, at + i);
  }
  check_fields(mine, store, 0, store->local);
  OK(part_file_read_all_blobs(file, "history", &n, &bytes));
  assert_int_equal(n, 3 * size + 10 * (size * (size - 1) / 2));
  assert_int_equal(((unsigned char *)bytes)[2], 2);
  assert_int_equal(((unsigned char *)bytes)[n - 1], (unsigned char)(110 * (size - 1) + 2));
  free(bytes);
  OK(part_file_read_blob(file, "history", &n, &bytes));
  assert_true(size == 1 ? n == 3 : n == 0 && bytes == NULL);
  free(bytes);
  part_file_close(file);
  remove_file(path);
  part_store_destroy(store);
  part_store_destroy(mine);
  part_store_destroy(back);
  /* One writes, all read their share. */
  store = make_store(MPI_COMM_SELF, 20);
  if (rank == 0)
    write_file(MPI_COMM_SELF, path, 1.0, store, NULL);
  MPI_Barrier(MPI_COMM_WORLD);
  OK(part_store_create(&test_layout, &back));
  OK(part_file_open(MPI_COMM_WORLD, path, NULL, &file));
  OK(part_file_read_store(file, back));
  int before = 0, total = back->local;
  MPI_Exscan(&total, &before, 1, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
  MPI_Allreduce(MPI_IN_PLACE, &total, 1, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
  assert_int_equal(total, 20);
  assert_in_range(back->local, 20 / size, 20 / size + 1);
  check_fields(back, store, rank == 0 ? 0 : before, back->local);
  part_file_close(file);
  remove_file(path);
  part_store_destroy(store);
  part_store_destroy(back);
}

static void unfinished_leaves_the_old(void **state) {
  (void)state;
  const char *path = in_folder("c.vtkhdf");
  part_store *store = make_store(MPI_COMM_WORLD, 5);
  part_file *file;
  double time;
  write_file(MPI_COMM_WORLD, path, 1.0, store, NULL);
  OK(part_file_create(MPI_COMM_WORLD, path, 2.0, &file));
  assert_true(exists(in_folder("c.vtkhdf.part")));
  OK(part_file_write_store(file, store));
  FAILS(PART_ERR_STATE, "already", part_file_write_store(file, store));
  FAILS(PART_ERR_ARGUMENT, "not a name", part_file_write_blob(file, "a/b", 0, NULL));
  FAILS(PART_ERR_STATE, "being written", part_file_read_store(file, store));
  part_file_close(file);
  assert_false(exists(in_folder("c.vtkhdf.part")));
  OK(part_file_open(MPI_COMM_WORLD, path, &time, &file));
  assert_true(time == 1.0);
  FAILS(PART_ERR_STATE, "open for reading", part_file_write_store(file, store));
  part_file_close(file);
  write_file(MPI_COMM_WORLD, path, 3.0, store, NULL);
  OK(part_file_open(MPI_COMM_WORLD, path, &time, &file));
  assert_true(time == 3.0);
  part_file_close(file);
  remove_file(path);
  part_store_destroy(store);
}

static void text_file(const char *path, const char *text) {
  if (world_rank() == 0) {
    FILE *out = fopen(path, "wb");
    assert_non_null(out);
    fputs(text, out);
    fclose(out);
  }
  MPI_Barrier(MPI_COMM_WORLD);
}

static void bad_files(void **state) {
  (void)state;
  part_file *file;
  double time;
  FAILS(PART_ERR_IO, "/nowhere.vtkhdf: cannot open: No such file",
        part_file_open(MPI_COMM_WORLD, in_folder("nowhere.vtkhdf"), &time, &file));
  assert_null(file);
  FAILS(PART_ERR_IO, "/none/x.vtkhdf: cannot create: No such file",
        part_file_create(MPI_COMM_WORLD, in_folder("none/x.vtkhdf"), 0.0, &file));
  assert_null(file);
  const char *path = in_folder("d.vtkhdf");
  text_file(path, "not HDF5 at all");
  FAILS(PART_ERR_FORMAT, "is not an HDF5 file", part_file_open(MPI_COMM_WORLD, path, &time, &file));
  remove_file(path);
  /* A particle file without particles, and one with other fields. */
  OK(part_file_create(MPI_COMM_WORLD, path, 0.0, &file));
  OK(part_file_commit(file, NULL));
  part_store *store = make_store(MPI_COMM_WORLD, 4);
  const int local = store->local;
  OK(part_file_open(MPI_COMM_WORLD, path, &time, &file));
  FAILS(PART_ERR_FORMAT, "is missing", part_file_read_store(file, store));
  part_file_close(file);
  const part_record record[2] = {{"x", PART_DOUBLE, 3}, {"id", PART_INT64, 1}};
  const part_field field[3] = {{"position", 0, 0, 3, PART_WRITTEN, "m", ""},
                               {"radius", 1, 0, 1, PART_WRITTEN, "", ""},
                               {"id", 1, 0, 1, PART_WRITTEN, "", ""}};
  const part_layout layout = {2, record, 3, field, 2};
  part_store *other;
  OK(part_store_create(&layout, &other));
  OK(part_file_create(MPI_COMM_WORLD, path, 0.0, &file));
  OK(part_file_write_store(file, other));
  OK(part_file_commit(file, NULL));
  OK(part_file_open(MPI_COMM_WORLD, path, &time, &file));
  FAILS(PART_ERR_FORMAT, "/VTKHDF/PointData/radius has another type",
        part_file_read_store(file, store));
  assert_int_equal(store->local, local);
  part_file_close(file);
  write_file(MPI_COMM_WORLD, path, 0.0, store, NULL);
  OK(part_file_open(MPI_COMM_WORLD, path, &time, &file));
  FAILS(PART_ERR_FORMAT, "radius has another type", part_file_read_store(file, other));
  part_file_close(file);
  remove_file(path);
  part_store_destroy(other);
  part_store_destroy(store);
}

static void check_series(const char *path, const char *want) {
  char text[2000] = "";
  FILE *in = fopen(path, "rb");
  assert_non_null(in);
  assert_true(fread(text, 1, sizeof text - 1, in) > 0);
  fclose(in);
  assert_string_equal(text, want);
  MPI_Barrier(MPI_COMM_WORLD);
}

#define HEAD "{\n  \"file-series-version\" : \"1.0\",\n  \"files\" : [\n"
#define TAIL "\n  ]\n}\n"

static void series(void **state) {
  (void)state;
  part_store *store = make_store(MPI_COMM_WORLD, 0);
  char index[300];
  snprintf(index, sizeof index, "%s", in_folder("p.vtkhdf.series"));
  const double time[5] = {0.0, 0.1, 0.2, 0.3, 0.15};
  char name[20];
  for (int k = 0; k < 5; k++) { /* the last as after a restart at 0.1 */
    snprintf(name, sizeof name, "p%d.vtkhdf", k);
    write_file(MPI_COMM_WORLD, in_folder(name), time[k], store, index);
    if (k == 3)
      check_series(index,
                   HEAD "    { \"name\" : \"p0.vtkhdf\", \"time\" : 0 },\n"
                        "    { \"name\" : \"p1.vtkhdf\", \"time\" : 0.10000000000000001 },\n"
                        "    { \"name\" : \"p2.vtkhdf\", \"time\" : 0.20000000000000001 },\n"
                        "    { \"name\" : \"p3.vtkhdf\", \"time\" : 0.29999999999999999 }" TAIL);
  }
  check_series(index, HEAD "    { \"name\" : \"p0.vtkhdf\", \"time\" : 0 },\n"
                           "    { \"name\" : \"p1.vtkhdf\", \"time\" : 0.10000000000000001 },\n"
                           "    { \"name\" : \"p4.vtkhdf\", \"time\" : 0.14999999999999999 }" TAIL);
  /* Files that are gone, as after OpenFOAM's purgeWrite. */
  remove_file(in_folder("p1.vtkhdf"));
  write_file(MPI_COMM_WORLD, in_folder("p2.vtkhdf"), 0.2, store, index);
  check_series(index, HEAD "    { \"name\" : \"p0.vtkhdf\", \"time\" : 0 },\n"
                           "    { \"name\" : \"p4.vtkhdf\", \"time\" : 0.14999999999999999 },\n"
                           "    { \"name\" : \"p2.vtkhdf\", \"time\" : 0.20000000000000001 }" TAIL);
  /* What others wrote in another style, with awkward names. */
  text_file(in_folder("a } \" b"), "");
  text_file(index, "{\"files\":[{\"time\":-1,\"name\":\"a } \\\" b\"},{\"name\":\"c\",\"time\":7},"
                   "{\"name\":\"gone \\\" b\",\"time\":-2}]}");
  write_file(MPI_COMM_WORLD, in_folder("p0.vtkhdf"), 1.0, store, index);
  check_series(index, HEAD "    { \"name\" : \"a } \\\" b\", \"time\" : -1 },\n"
                           "    { \"name\" : \"p0.vtkhdf\", \"time\" : 1 }" TAIL);
  part_file *file;
  text_file(index, "{}");
  OK(part_file_create(MPI_COMM_WORLD, in_folder("p0.vtkhdf"), 9.0, &file));
  FAILS(PART_ERR_FORMAT, "not a series index", part_file_commit(file, index));
  for (int k = 0; k < 5; k++) {
    snprintf(name, sizeof name, "p%d.vtkhdf", k);
    if (k != 1)
      remove_file(in_folder(name));
  }
  remove_file(in_folder("a } \" b"));
  remove_file(index);
  part_store_destroy(store);
}

static int only_write(int each, const char *path) {
  part_store *store = make_store(MPI_COMM_WORLD, each);
  write_file(MPI_COMM_WORLD, path, 0.25, store, NULL);
  part_store_destroy(store);
  return 0;
}

static const struct CMUnitTest tests[] = {
    cmocka_unit_test(round_trip),
    cmocka_unit_test(other_numbers_of_ranks),
    cmocka_unit_test(unfinished_leaves_the_old),
    cmocka_unit_test(bad_files),
    cmocka_unit_test(series),
};

int main(int argc, char **argv) {
  int failed;
  MPI_Init(&argc, &argv);
  if (argc == 4 && strcmp(argv[1], "--write") == 0)
    failed = only_write(atoi(argv[2]), argv[3]);
  else
    failed = cmocka_run_group_tests(tests, make_folder, remove_folder);
  MPI_Finalize();
  return failed;
}
