/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parameters by table: defaults, checked setting, and the check that all are there. */
#include "particle/params.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "params_text.h"
#include "particle/status.h"

enum { TEXT_SIZE = 400 };

/* Values are copied byte by byte: a struct seen as characters has no alignment to rely on. */
static void put(const part_param *row, void *values, const void *value, size_t size) {
  memcpy((unsigned char *)values + row->offset, value, size);
}

static void get(const part_param *row, const void *values, void *value, size_t size) {
  memcpy(value, (const unsigned char *)values + row->offset, size);
}

static int components(const part_param *row) {
  return row->type == PART_PARAM_VECTOR ? 3 : 1;
}

static void put_double(const part_param *row, void *values, const double *numbers) {
  put(row, values, numbers, sizeof(double) * (size_t)components(row));
}

static void put_int64(const part_param *row, void *values, int64_t number) {
  put(row, values, &number, sizeof number);
}

static void put_int(const part_param *row, void *values, int number) {
  put(row, values, &number, sizeof number);
}

static void put_word(const part_param *row, void *values, const char *word) {
  char text[PART_PARAM_WORD_LENGTH] = "";
  if (word != NULL)
    strncpy(text, word, sizeof text - 1);
  put(row, values, text, sizeof text);
}

void part_params_default(const part_param_table *table, void *values) {
  const double unset[3] = {(double)NAN, (double)NAN, (double)NAN};
  for (int k = 0; k < table->count; k++) {
    const part_param *row = &table->rows[k];
    switch (row->type) {
    case PART_PARAM_SCALAR:
    case PART_PARAM_VECTOR:
      put_double(row, values, row->required ? unset : row->def);
      break;
    case PART_PARAM_INT:
      put_int64(row, values, row->required ? INT64_MIN : (int64_t)row->def[0]);
      break;
    case PART_PARAM_BOOL:
    case PART_PARAM_CHOICE:
      put_int(row, values, row->required ? -1 : (int)row->def[0]);
      break;
    case PART_PARAM_WORD:
      put_word(row, values, row->required ? "" : row->def_word);
      break;
    }
  }
}

const part_param *part_params_find(const part_param_table *table, const char *name) {
  for (int k = 0; k < table->count; k++)
    if (strcmp(table->rows[k].name, name) == 0)
      return &table->rows[k];
  return NULL;
}

static int in_range(const part_param *row, double value) {
  const int above = row->low_open ? value > row->low : value >= row->low;
  const int below = row->high_open ? value < row->high : value <= row->high;
  return above && below;
}

/* "entry e of dictionary d: value 3 m/s is not allowed; allowed is [0, 1] m/s" */
static int refuse_numbers(const part_param_table *table, const part_param *row,
                          const double *numbers) {
  char value[TEXT_SIZE] = "", unit[64], range[TEXT_SIZE];
  const int n = components(row);
  for (int c = 0; c < n; c++)
    part_text_add(sizeof value, value, "%s%.10g", c > 0 ? " " : n > 1 ? "(" : "", numbers[c]);
  part_text_add(sizeof value, value, "%s", n > 1 ? ")" : "");
  if (row->type != PART_PARAM_BOOL) {
    part_param_unit_text(row->dims, sizeof unit, unit);
    part_text_add(sizeof value, value, "%s%s", unit[0] != '\0' ? " " : "", unit);
  }
  part_param_range_text(row, sizeof range, range);
  return part_fail(PART_ERR_RANGE, "%s: entry %s: %s is not allowed; allowed: %s%s", table->name,
                   row->name, value, range, n > 1 ? " for every component" : "");
}

static int refuse_word(const part_param_table *table, const part_param *row, const char *word) {
  char range[TEXT_SIZE];
  const char *near = NULL;
  if (row->type == PART_PARAM_CHOICE) {
    int count = 0;
    while (row->choices[count] != NULL)
      count++;
    near = part_nearest_name(word, count, row->choices);
  }
  part_param_range_text(row, sizeof range, range);
  return part_fail(PART_ERR_RANGE, "%s: entry %s: '%.60s' is not allowed; allowed: %s%s%s%s",
                   table->name, row->name, word, range, near != NULL ? "; did you mean '" : "",
                   near != NULL ? near : "", near != NULL ? "'?" : "");
}

static int set_numbers(const part_param_table *table, const part_param *row, const double *numbers,
                       void *values) {
  if (numbers == NULL)
    return part_fail(PART_ERR_ARGUMENT, "%s: entry %s: needs %s", table->name, row->name,
                     row->type == PART_PARAM_BOOL     ? "true or false"
                     : row->type == PART_PARAM_VECTOR ? "three numbers"
                                                      : "a number");
  for (int c = 0; c < components(row); c++)
    if (!isfinite(numbers[c]) || (row->type != PART_PARAM_BOOL && !in_range(row, numbers[c])))
      return refuse_numbers(table, row, numbers);
  if (row->type == PART_PARAM_INT) {
    /* Beyond 2^53 a double does not hold every whole number. */
    if (numbers[0] != floor(numbers[0]) || fabs(numbers[0]) > 9007199254740992.0)
      return refuse_numbers(table, row, numbers);
    put_int64(row, values, (int64_t)numbers[0]);
  } else if (row->type == PART_PARAM_BOOL) {
    if (numbers[0] != 0.0 && numbers[0] != 1.0)
      return refuse_numbers(table, row, numbers);
    put_int(row, values, numbers[0] != 0.0);
  } else {
    put_double(row, values, numbers);
  }
  return PART_OK;
}

static int set_word(const part_param_table *table, const part_param *row, const char *word,
                    void *values) {
  if (word == NULL)
    return part_fail(PART_ERR_ARGUMENT, "%s: entry %s: needs a word", table->name, row->name);
  if (row->type == PART_PARAM_WORD) {
    if (strlen(word) >= PART_PARAM_WORD_LENGTH)
      return refuse_word(table, row, word);
    put_word(row, values, word);
    return PART_OK;
  }
  for (int c = 0; row->choices[c] != NULL; c++)
    if (strcmp(row->choices[c], word) == 0) {
      put_int(row, values, c);
      return PART_OK;
    }
  return refuse_word(table, row, word);
}

int part_params_set(const part_param_table *table, const char *name, const double *numbers,
                    const char *word, void *values) {
  const part_param *row = part_params_find(table, name);
  if (row == NULL) {
    const char *near = part_params_nearest(table, name);
    return part_fail(PART_ERR_ARGUMENT, "%s: unknown entry '%.60s'%s%s%s", table->name, name,
                     near != NULL ? "; did you mean '" : "", near != NULL ? near : "",
                     near != NULL ? "'?" : "");
  }
  if (row->type == PART_PARAM_CHOICE || row->type == PART_PARAM_WORD)
    return set_word(table, row, word, values);
  return set_numbers(table, row, numbers, values);
}

static int missing(const part_param_table *table, const part_param *row) {
  char range[TEXT_SIZE];
  part_param_range_text(row, sizeof range, range);
  return part_fail(PART_ERR_ARGUMENT, "%s: entry %s is missing (%s); allowed: %s", table->name,
                   row->name, row->meaning, range);
}

static int check_doubles(const part_param_table *table, const part_param *row, const void *values) {
  double numbers[3];
  get(row, values, numbers, sizeof(double) * (size_t)components(row));
  for (int c = 0; c < components(row); c++) {
    if (row->required && isnan(numbers[c]))
      return missing(table, row);
    if (isnan(row->def[c]) && isnan(numbers[c])) /* optional, not given; NaN is not compared: traps */
      continue;
    /* An infinite value can only be a default: "no limit". */
    const int finite = isfinite(numbers[c]) || numbers[c] == row->def[c];
    if (!finite || !in_range(row, numbers[c]))
      return refuse_numbers(table, row, numbers);
  }
  return PART_OK;
}

static int check_integer(const part_param_table *table, const part_param *row, const void *values) {
  int64_t number;
  get(row, values, &number, sizeof number);
  if (row->required && number == INT64_MIN)
    return missing(table, row);
  const double as_double = (double)number;
  return in_range(row, as_double) ? PART_OK : refuse_numbers(table, row, &as_double);
}

static int check_index(const part_param_table *table, const part_param *row, const void *values) {
  int number, count = 2;
  get(row, values, &number, sizeof number);
  if (row->required && number == -1)
    return missing(table, row);
  if (row->type == PART_PARAM_CHOICE)
    for (count = 0; row->choices[count] != NULL;)
      count++;
  const double as_double = (double)number;
  return number >= 0 && number < count ? PART_OK : refuse_numbers(table, row, &as_double);
}

static int check_word(const part_param_table *table, const part_param *row, const void *values) {
  char word[PART_PARAM_WORD_LENGTH];
  get(row, values, word, sizeof word);
  return row->required && word[0] == '\0' ? missing(table, row) : PART_OK;
}

int part_params_check(const part_param_table *table, const void *values) {
  static int (*const check[])(const part_param_table *, const part_param *, const void *) = {
      [PART_PARAM_SCALAR] = check_doubles, [PART_PARAM_VECTOR] = check_doubles,
      [PART_PARAM_INT] = check_integer,    [PART_PARAM_BOOL] = check_index,
      [PART_PARAM_CHOICE] = check_index,   [PART_PARAM_WORD] = check_word,
  };
  for (int k = 0; k < table->count; k++)
    PART_TRY(check[table->rows[k].type](table, &table->rows[k], values));
  return PART_OK;
}
