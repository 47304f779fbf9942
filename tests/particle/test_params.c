/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ranks: 1 */
#include "common.h"

#include <math.h>
#include <string.h>

#include "particle/params.h"

typedef struct values {
  double restitution, stiffness, gravity[3], limit;
  int64_t number;
  int rolling, law, skip;
  char name[PART_PARAM_WORD_LENGTH], file[PART_PARAM_WORD_LENGTH];
} values;

static const char *const laws[] = {"linear", "hertz", "none", NULL};

static const part_param rows[] = {
    {.name = "restitution",
     .type = PART_PARAM_SCALAR,
     .offset = offsetof(values, restitution),
     .def = {0.9},
     .low = 0,
     .high = 1,
     .low_open = 1,
     .meaning = "of a head-on impact"},
    {.name = "stiffness",
     .type = PART_PARAM_SCALAR,
     .offset = offsetof(values, stiffness),
     .dims = {1, 0, -2},
     .required = 1,
     .low = 0,
     .high = INFINITY,
     .low_open = 1,
     .meaning = "normal spring"},
    {.name = "gravity",
     .type = PART_PARAM_VECTOR,
     .offset = offsetof(values, gravity),
     .dims = {0, 1, -2},
     .def = {0, 0, -9.81},
     .low = -100,
     .high = 100,
     .meaning = "acceleration"},
    {.name = "limit",
     .type = PART_PARAM_SCALAR,
     .offset = offsetof(values, limit),
     .def = {INFINITY},
     .low = 0,
     .high = INFINITY,
     .meaning = "no limit"},
    {.name = "number",
     .type = PART_PARAM_INT,
     .offset = offsetof(values, number),
     .required = 1,
     .low = 1,
     .high = 1e15,
     .meaning = "of particles"},
    {.name = "rolling",
     .type = PART_PARAM_BOOL,
     .offset = offsetof(values, rolling),
     .def = {1},
     .meaning = "rolling friction"},
    {.name = "skip",
     .type = PART_PARAM_BOOL,
     .offset = offsetof(values, skip),
     .required = 1,
     .meaning = "leave out"},
    {.name = "law",
     .type = PART_PARAM_CHOICE,
     .offset = offsetof(values, law),
     .choices = laws,
     .required = 1,
     .meaning = "of contact"},
    {.name = "name",
     .type = PART_PARAM_WORD,
     .offset = offsetof(values, name),
     .def_word = "glass",
     .meaning = "of the material"},
    {.name = "file",
     .type = PART_PARAM_WORD,
     .offset = offsetof(values, file),
     .required = 1,
     .meaning = "of particles"},
};
static const part_param_table table = {"demProperties", (int)(sizeof rows / sizeof rows[0]), rows};

static int set1(const char *name, double number, values *v) {
  return part_params_set(&table, name, &number, NULL, v);
}

static void defaults(void **state) {
  (void)state;
  values v;
  memset(&v, 0x55, sizeof v);
  part_params_default(&table, &v);
  assert_true(v.restitution == 0.9 && isnan(v.stiffness) && isinf(v.limit));
  assert_true(v.gravity[0] == 0.0 && v.gravity[2] == -9.81);
  assert_true(v.number == INT64_MIN && v.rolling == 1 && v.skip == -1 && v.law == -1);
  assert_string_equal(v.name, "glass");
  assert_string_equal(v.file, "");
}

static void set_and_check(void **state) {
  (void)state;
  values v;
  part_params_default(&table, &v);
  FAILS(PART_ERR_ARGUMENT,
        "demProperties: entry stiffness is missing (normal spring); allowed: "
        "(0, inf) kg/s^2",
        part_params_check(&table, &v));
  OK(set1("stiffness", 1e5, &v));
  FAILS(PART_ERR_ARGUMENT, "entry number is missing", part_params_check(&table, &v));
  OK(set1("number", 1e15, &v));
  FAILS(PART_ERR_ARGUMENT, "entry skip is missing", part_params_check(&table, &v));
  OK(set1("skip", 0, &v));
  FAILS(PART_ERR_ARGUMENT, "entry law is missing (of contact); allowed: one of linear, hertz, none",
        part_params_check(&table, &v));
  OK(part_params_set(&table, "law", NULL, "hertz", &v));
  FAILS(PART_ERR_ARGUMENT, "entry file is missing", part_params_check(&table, &v));
  OK(part_params_set(&table, "file", NULL, "a.txt", &v));
  OK(part_params_check(&table, &v));
  assert_true(v.stiffness == 1e5 && v.number == 1000000000000000 && v.law == 1 && v.skip == 0);
  assert_string_equal(v.file, "a.txt");
  const double g[3] = {1, -2, 100};
  OK(part_params_set(&table, "gravity", g, NULL, &v));
  assert_memory_equal(v.gravity, g, sizeof g);
  v.restitution = 1.5; /* written past the table */
  FAILS(PART_ERR_RANGE, "restitution", part_params_check(&table, &v));
  v.restitution = INFINITY;
  FAILS(PART_ERR_RANGE, "restitution", part_params_check(&table, &v));
  v.restitution = 1.0;
  v.law = 3;
  FAILS(PART_ERR_RANGE, "law", part_params_check(&table, &v));
}

static void refused(void **state) {
  (void)state;
  values v;
  part_params_default(&table, &v);
  FAILS(PART_ERR_RANGE, "demProperties: entry restitution: 0 is not allowed; allowed: (0, 1]",
        set1("restitution", 0.0, &v));
  OK(set1("restitution", 1.0, &v));
  FAILS(PART_ERR_RANGE, "entry stiffness: -3 kg/s^2 is not allowed; allowed: (0, inf) kg/s^2",
        set1("stiffness", -3.0, &v));
  FAILS(PART_ERR_RANGE, "nan", set1("stiffness", (double)NAN, &v));
  FAILS(PART_ERR_RANGE, "inf", set1("stiffness", (double)INFINITY, &v));
  FAILS(PART_ERR_RANGE, "inf", set1("limit", (double)INFINITY, &v));
  const double g[3] = {1, -101, 0};
  FAILS(PART_ERR_RANGE, "(1 -101 0) m/s^2 is not allowed; allowed: [-100, 100] m/s^2 for every",
        part_params_set(&table, "gravity", g, NULL, &v));
  assert_true(v.gravity[2] == -9.81); /* untouched */
  FAILS(PART_ERR_RANGE, "whole number", set1("number", 2.5, &v));
  FAILS(PART_ERR_RANGE, "whole number", set1("number", 0, &v));
  FAILS(PART_ERR_RANGE, "true or false", set1("rolling", 2, &v));
  FAILS(PART_ERR_RANGE,
        "'hert' is not allowed; allowed: one of linear, hertz, none; did you mean "
        "'hertz'?",
        part_params_set(&table, "law", NULL, "hert", &v));
  FAILS(PART_ERR_ARGUMENT, "needs a word", set1("law", 1, &v));
  FAILS(PART_ERR_ARGUMENT, "needs a number",
        part_params_set(&table, "stiffness", NULL, "stiff", &v));
  FAILS(PART_ERR_ARGUMENT, "unknown entry 'stifness'; did you mean 'stiffness'?",
        set1("stifness", 1, &v));
  char text[400];
  memset(text, 'a', sizeof text - 1);
  text[sizeof text - 1] = '\0';
  FAILS(PART_ERR_ARGUMENT, "unknown entry", set1(text, 1, &v));
  FAILS(PART_ERR_RANGE, "at most 255 characters", part_params_set(&table, "file", NULL, text, &v));
  text[255] = '\0';
  OK(part_params_set(&table, "file", NULL, text, &v));
  assert_int_equal(strlen(v.file), 255);
}

static void nearest(void **state) {
  (void)state;
  static const char *const names[] = {"youngsModulus", "poissonRatio", "density", "e"};
  assert_string_equal(part_nearest_name("youngModulus", 4, names), "youngsModulus");
  assert_string_equal(part_nearest_name("desnity", 4, names), "density");
  assert_string_equal(part_nearest_name("density", 4, names), "density");
  assert_null(part_nearest_name("viscosity", 4, names));
  assert_null(part_nearest_name("x", 4, names));
  assert_null(part_nearest_name("", 4, names));
  assert_null(part_nearest_name("density", 0, names));
  assert_string_equal(part_params_nearest(&table, "gravty"), "gravity");
  assert_null(part_params_nearest(&table, "temperature"));
  assert_ptr_equal(part_params_find(&table, "law"), &rows[7]);
  assert_null(part_params_find(&table, "laws"));
}

static void check_unit(const char *want, const signed char dims[7]) {
  char text[64];
  assert_string_equal(part_param_unit_text(dims, sizeof text, text), want);
}

static void texts(void **state) {
  (void)state;
  check_unit("kg/m^3", (const signed char[7]){1, -3});
  check_unit("", (const signed char[7]){0});
  check_unit("1/s", (const signed char[7]){0, 0, -1});
  check_unit("kg/(m s^2)", (const signed char[7]){1, -1, -2});
  check_unit("kg m^2/(s^2 K)", (const signed char[7]){1, 2, -2, -1});
  check_unit("1/(mol A)", (const signed char[7]){0, 0, 0, 0, -1, -1});
  check_unit("m", (const signed char[7]){0, 1});
  char text[64], small[8];
  part_param row = {.type = PART_PARAM_SCALAR, .low = 0, .high = 1, .dims = {0, 1, -1}};
  assert_string_equal(part_param_range_text(&row, sizeof text, text), "[0, 1] m/s");
  row.high_open = 1;
  assert_string_equal(part_param_range_text(&row, sizeof text, text), "[0, 1) m/s");
  row.low = -INFINITY;
  assert_string_equal(part_param_range_text(&row, sizeof text, text), "(-inf, 1) m/s");
  assert_string_equal(part_param_range_text(&row, sizeof small, small), "(-inf, ");
}

static const struct CMUnitTest tests[] = {
    cmocka_unit_test(defaults), cmocka_unit_test(set_and_check), cmocka_unit_test(refused),
    cmocka_unit_test(nearest),  cmocka_unit_test(texts),
};
RUN_WITH_MPI(tests)
