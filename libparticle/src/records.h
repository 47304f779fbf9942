/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whole records of a store in and out of flat buffers. A flag of any field holds for its whole
 * record, so that components between fields (padding) travel too and copies are bit for bit. */
#ifndef PART_RECORDS_H
#define PART_RECORDS_H

#include "particle/store.h"

enum { PART_RECORDS_MAX = 64 };

/* take[record] = 1 for records that have a field with the flag. */
void part_records_flagged(const part_layout *layout, unsigned flag, unsigned char *take);
/* Bytes per particle of the records taken. */
size_t part_records_size(const part_layout *layout, const unsigned char *take);
/* Particles index[0..n-1] (NULL: 0..n-1) into buffer, particle by particle. */
void part_records_pack(const part_store *store, const unsigned char *take, int n, const int *index,
                       void *buffer);
/* The buffer into particles first .. first+n-1; records not taken stay as they are. */
void part_records_unpack(part_store *store, const unsigned char *take, int first, int n,
                         const void *buffer);
/* All components of particles first .. first+n-1 to zero. */
void part_records_zero(part_store *store, int first, int n);

#endif
