/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A row of a .def file of libcoupling as a part_param; the file that includes it sets CPL_STRUCT to
 * the struct that the rows describe. All quantities are dimensionless. */
#ifndef COUPLING_PARAM_ROWS_H
#define COUPLING_PARAM_ROWS_H

#include <stddef.h>
#include "particle/params.h"

#define CPL_CHOICE(entry, member_, list, need, value, text)                                        \
  {.name = #entry,                                                                                 \
   .type = PART_PARAM_CHOICE,                                                                      \
   .offset = offsetof(CPL_STRUCT, member_),                                                        \
   .required = need,                                                                               \
   .def = {value},                                                                                 \
   .choices = list,                                                                                \
   .meaning = text},
#define CPL_INT(entry, member_, value, from, to, text)                                             \
  {.name = #entry,                                                                                 \
   .type = PART_PARAM_INT,                                                                         \
   .offset = offsetof(CPL_STRUCT, member_),                                                        \
   .def = {value},                                                                                 \
   .low = from,                                                                                    \
   .high = to,                                                                                     \
   .meaning = text},
#define CPL_SCALAR(entry, member_, value, from, from_open, to, to_open, text)                      \
  {.name = #entry,                                                                                 \
   .type = PART_PARAM_SCALAR,                                                                      \
   .offset = offsetof(CPL_STRUCT, member_),                                                        \
   .def = {value},                                                                                 \
   .low = from,                                                                                    \
   .low_open = from_open,                                                                          \
   .high = to,                                                                                     \
   .high_open = to_open,                                                                           \
   .meaning = text},
#define CPL_BOOL(entry, member_, value, text)                                                      \
  {.name = #entry,                                                                                 \
   .type = PART_PARAM_BOOL,                                                                        \
   .offset = offsetof(CPL_STRUCT, member_),                                                        \
   .def = {value},                                                                                 \
   .high = 1,                                                                                      \
   .meaning = text},

#endif
