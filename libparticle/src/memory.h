/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Allocation with the error text of the library. */
#ifndef PART_MEMORY_H
#define PART_MEMORY_H

#include <stddef.h>

/* count * size bytes, zeroed; at least one byte, so that NULL always means failure. ERR_MEMORY. */
int part_allocate(size_t count, size_t size, void *pointer_to_pointer);

/* Grow *pointer to hold at least `count` items of `size` bytes; *capacity (items) follows. Content
 * is kept. ERR_MEMORY leaves both as they were. */
int part_grow(size_t count, size_t size, size_t *capacity, void *pointer_to_pointer);

#endif
