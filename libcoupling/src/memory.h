/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef COUPLING_MEMORY_H
#define COUPLING_MEMORY_H

#include <stdlib.h>
#include <string.h>
#include "particle/status.h"

/* Room for n items of size bytes in *(T **)array, whose capacity in items is *capacity; contents
 * stay. Grows by half, so that repeated small growth costs little. */
static inline int cpl_reserve(void *array, size_t *capacity, size_t n, size_t size) {
  void *old;
  memcpy(&old, array, sizeof old); /* any object pointer type: no aliasing through void ** */
  if (n <= *capacity && old)
    return PART_OK;
  const size_t room = n + n / 2 + 16;
  void *grown = realloc(old, room * size);
  if (!grown)
    return part_fail(PART_ERR_MEMORY, "coupling: no memory for %zu items of %zu bytes", room, size);
  memcpy(array, &grown, sizeof grown);
  *capacity = room;
  return PART_OK;
}

/* A growing array of one type; .data may move in CPL_RESERVE. */
#define CPL_ARRAY(type)                                                                            \
  struct {                                                                                         \
    type *data;                                                                                    \
    size_t capacity;                                                                               \
  }
#define CPL_RESERVE(array, n)                                                                      \
  cpl_reserve(&(array).data, &(array).capacity, (size_t)(n), sizeof *(array).data)
#define CPL_FREE(array)                                                                            \
  do {                                                                                             \
    free((array).data);                                                                            \
    (array).data = NULL;                                                                           \
    (array).capacity = 0;                                                                          \
  } while (0)

#endif
