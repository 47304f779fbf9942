/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parameters described by a table: name, dimensions, allowed range, default, meaning. A library
 * states its parameters once as such rows; whoever reads a dictionary (foamBridge, a C program, a
 * test) walks the rows, so that every entry is checked in one place and documents itself. */
#ifndef PARTICLE_PARAMS_H
#define PARTICLE_PARAMS_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum {
  PART_PARAM_SCALAR, /* double */
  PART_PARAM_VECTOR, /* double[3] */
  PART_PARAM_INT,    /* int64_t */
  PART_PARAM_BOOL,   /* int, 0 or 1 */
  PART_PARAM_CHOICE, /* int, index into choices */
  PART_PARAM_WORD    /* char[PART_PARAM_WORD_LENGTH], zero terminated: a name or a file */
} part_param_type;

enum { PART_PARAM_WORD_LENGTH = 256 };

/* One parameter. dims are the exponents of (kg m s K mol A cd), as in an OpenFOAM dimensionSet.
 * The range [low, high] holds for SCALAR, INT and every component of VECTOR; low_open/high_open
 * exclude the end itself. required: no default exists and the entry must be given. The default NaN
 * of a SCALAR says that it may be left out and then has no value. */
typedef struct part_param {
  const char *name;
  part_param_type type;
  size_t offset; /* of the value in the struct that the table describes */
  signed char dims[7];
  int required;
  double def[3];
  double low, high;
  int low_open, high_open;
  const char *const *choices; /* NULL-terminated list of names for CHOICE */
  const char *def_word;       /* default of WORD */
  const char *meaning;
} part_param;

typedef struct part_param_table {
  const char *name; /* of the dictionary it describes, for messages */
  int count;
  const part_param *rows;
} part_param_table;

/* For the libraries that state their tables in .def files: a row of the struct PART_PARAM_STRUCT,
 * which whoever includes the .def sets; see lib<name>/src/params.c. */
#define PART_PARAM_DIMS(kg, m, s)                                                                  \
  { kg, m, s, 0, 0, 0, 0 }
#define PART_PARAM_THREE(a, b, c)                                                                  \
  { a, b, c }
#define PART_PARAM_ROW(key, type, member, dims, required, def, low, high, low_open, high_open,     \
                       choices, word, meaning)                                                     \
  {key,                                                                                            \
   PART_PARAM_##type,                                                                              \
   offsetof(struct PART_PARAM_STRUCT, member),                                                     \
   dims,                                                                                           \
   required,                                                                                       \
   def,                                                                                            \
   low,                                                                                            \
   high,                                                                                           \
   low_open,                                                                                       \
   high_open,                                                                                      \
   choices,                                                                                        \
   word,                                                                                           \
   meaning},
#define PART_PARAM_TABLE(name, rows)                                                               \
  { name, (int)(sizeof rows / sizeof rows[0]), rows }

/* Set every value of the struct to its default; required ones to NaN, INT64_MIN, -1 or "". */
void part_params_default(const part_param_table *table, void *values);

/* Row of that name, or NULL. */
const part_param *part_params_find(const part_param_table *table, const char *name);

/* Nearest name in a list of count names by edit distance; NULL when none is close (> 1/2 of its
 * length). part_params_nearest does it over the rows of a table. */
const char *part_nearest_name(const char *name, int count, const char *const *names);
const char *part_params_nearest(const part_param_table *table, const char *name);

/* Store one value after checking type, finiteness and range (ERR_RANGE: the text names the entry,
 * the value, the allowed range with unit). numbers: 1 (SCALAR, INT, BOOL) or 3 (VECTOR) values;
 * word: for CHOICE and WORD. */
int part_params_set(const part_param_table *table, const char *name, const double *numbers,
                    const char *word, void *values);

/* Check that every required value was set and every value is in range. */
int part_params_check(const part_param_table *table, const void *values);

/* "[0, 1)" with unit, or the list of choices, into text; returns text. */
char *part_param_range_text(const part_param *row, size_t size, char *text);
/* "kg/m^3" from dims; returns text. */
char *part_param_unit_text(const signed char dims[7], size_t size, char *text);

#ifdef __cplusplus
}
#endif
#endif
