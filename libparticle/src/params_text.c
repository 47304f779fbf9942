/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Units, ranges and choices of parameters as text, and the nearest of several names. */
#include "params_text.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "particle/params.h"

void part_text_add(size_t size, char *text, const char *format, ...) {
  const size_t used = strlen(text);
  if (used + 1 >= size)
    return;
  va_list args;
  va_start(args, format);
  vsnprintf(text + used, size - used, format, args);
  va_end(args);
}

/* Units with a positive exponent (sign 1) or a negative one (sign -1), separated by spaces. */
static int add_units(const signed char dims[7], int sign, size_t size, char *text) {
  static const char *const units[7] = {"kg", "m", "s", "K", "mol", "A", "cd"};
  int count = 0;
  for (int u = 0; u < 7; u++) {
    const int power = sign * dims[u];
    if (power <= 0)
      continue;
    part_text_add(size, text, power == 1 ? "%s%s" : "%s%s^%d", count > 0 ? " " : "", units[u],
                  power);
    count++;
  }
  return count;
}

char *part_param_unit_text(const signed char dims[7], size_t size, char *text) {
  if (size == 0)
    return text;
  int below = 0;
  for (int u = 0; u < 7; u++)
    below += dims[u] < 0;
  text[0] = '\0';
  const int above = add_units(dims, 1, size, text);
  if (below > 0) {
    part_text_add(size, text, "%s%s", above > 0 ? "/" : "1/", below > 1 ? "(" : "");
    add_units(dims, -1, size, text);
    if (below > 1)
      part_text_add(size, text, ")");
  }
  return text;
}

static void add_interval(const part_param *row, size_t size, char *text) {
  char unit[64];
  const int from_inf = isinf(row->low), to_inf = isinf(row->high);
  part_text_add(size, text, "%c%.10g, %.10g%c", row->low_open || from_inf ? '(' : '[', row->low,
                row->high, row->high_open || to_inf ? ')' : ']');
  part_param_unit_text(row->dims, sizeof unit, unit);
  if (unit[0] != '\0')
    part_text_add(size, text, " %s", unit);
}

char *part_param_range_text(const part_param *row, size_t size, char *text) {
  if (size == 0)
    return text;
  text[0] = '\0';
  switch (row->type) {
  case PART_PARAM_SCALAR:
  case PART_PARAM_VECTOR:
    add_interval(row, size, text);
    break;
  case PART_PARAM_INT:
    add_interval(row, size, text);
    part_text_add(size, text, ", a whole number");
    break;
  case PART_PARAM_BOOL:
    part_text_add(size, text, "true or false");
    break;
  case PART_PARAM_CHOICE:
    for (int c = 0; row->choices[c] != NULL; c++)
      part_text_add(size, text, "%s%s", c > 0 ? ", " : "one of ", row->choices[c]);
    break;
  case PART_PARAM_WORD:
    part_text_add(size, text, "a word of at most %d characters", PART_PARAM_WORD_LENGTH - 1);
    break;
  }
  return text;
}

enum { NAME_MAX_LENGTH = 255 };

static int least(int a, int b) {
  return a < b ? a : b;
}

/* Optimal string alignment distance: insert, delete, change, swap of neighbours cost 1 each. */
static int edit_distance(const char *a, const char *b) {
  int row[3][NAME_MAX_LENGTH + 1];
  const int na = (int)strlen(a), nb = (int)strlen(b);
  for (int j = 0; j <= nb; j++)
    row[0][j] = j;
  for (int i = 1; i <= na; i++) {
    int *now = row[i % 3];
    const int *last = row[(i + 2) % 3], *before = row[(i + 1) % 3];
    now[0] = i;
    for (int j = 1; j <= nb; j++) {
      now[j] = least(least(last[j], now[j - 1]) + 1, last[j - 1] + (a[i - 1] != b[j - 1]));
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        now[j] = least(now[j], before[j - 2] + 1);
    }
  }
  return row[na % 3][nb];
}

/* The closer of `best` (at *distance) and `candidate`, for the name sought. */
static const char *closer(const char *name, const char *candidate, const char *best,
                          int *distance) {
  if (strlen(candidate) > NAME_MAX_LENGTH)
    return best;
  const int d = edit_distance(name, candidate);
  if (d >= *distance || 2 * d > (int)strlen(name))
    return best;
  *distance = d;
  return candidate;
}

const char *part_nearest_name(const char *name, int count, const char *const *names) {
  const char *best = NULL;
  int distance = NAME_MAX_LENGTH + 1;
  for (int k = 0; k < count && strlen(name) <= NAME_MAX_LENGTH; k++)
    best = closer(name, names[k], best, &distance);
  return best;
}

const char *part_params_nearest(const part_param_table *table, const char *name) {
  const char *best = NULL;
  int distance = NAME_MAX_LENGTH + 1;
  for (int k = 0; k < table->count && strlen(name) <= NAME_MAX_LENGTH; k++)
    best = closer(name, table->rows[k].name, best, &distance);
  return best;
}
