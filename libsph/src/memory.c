/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Allocation with an error text. */
#include "internal.h"

int sph_grow(size_t count, size_t size, size_t *capacity, void *pointer_to_pointer) {
  void *p;
  if (count <= *capacity)
    return PART_OK;
  const size_t room = count > 2 * *capacity ? count : 2 * *capacity;
  memcpy(&p, pointer_to_pointer, sizeof p);
  p = realloc(p, room * size);
  if (p == NULL)
    return part_fail(PART_ERR_MEMORY, "no memory for %zu items of %zu bytes", room, size);
  memset((char *)p + *capacity * size, 0, (room - *capacity) * size);
  memcpy(pointer_to_pointer, &p, sizeof p);
  *capacity = room;
  return PART_OK;
}
