/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "memory.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "particle/status.h"

static int too_much(size_t count, size_t size) {
  return part_fail(PART_ERR_MEMORY, "no memory for %zu items of %zu bytes", count, size);
}

int part_allocate(size_t count, size_t size, void *pointer_to_pointer) {
  void *memory = calloc(count > 0 ? count : 1, size > 0 ? size : 1);
  if (memory == NULL)
    return too_much(count, size);
  memcpy(pointer_to_pointer, &memory, sizeof memory);
  return PART_OK;
}

int part_grow(size_t count, size_t size, size_t *capacity, void *pointer_to_pointer) {
  void *memory;
  memcpy(&memory, pointer_to_pointer, sizeof memory);
  if (memory != NULL && count <= *capacity)
    return PART_OK;
  size_t wanted = count + count / 4 + 16;
  if (wanted < count || wanted > SIZE_MAX / (size > 0 ? size : 1))
    return too_much(count, size);
  memory = realloc(memory, wanted * size);
  if (memory == NULL)
    return too_much(count, size);
  *capacity = wanted;
  memcpy(pointer_to_pointer, &memory, sizeof memory);
  return PART_OK;
}
