/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Particle storage. A library describes its quantities once, as rows of a field table; storage,
 * sorting, migration, ghost packing, output attributes and documentation come from the rows.
 *
 * Storage is by records: a record is an aligned array of `width` doubles (or int64) per particle,
 * and a field is a run of components in a record. {x, y, z, r} in one record is one 32-byte load
 * in a contact loop; a quantity used alone gets a record of its own. */
#ifndef PARTICLE_STORE_H
#define PARTICLE_STORE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum { PART_DOUBLE, PART_INT64 } part_type; /* both 8 bytes */

enum {
  PART_MOVES = 1,   /* goes along when the particle changes rank */
  PART_GHOST = 2,   /* is kept up to date on ghost copies */
  PART_WRITTEN = 4, /* is written to VTKHDF files and read back on restart */
};

typedef struct part_record {
  const char *name;
  part_type type;
  int width; /* components per particle */
} part_record;

typedef struct part_field {
  const char *name; /* as written to files */
  int record;       /* index into the record table */
  int offset;       /* first component */
  int comps;        /* 1, 3, ... */
  unsigned flags;   /* PART_MOVES | ...; MOVES and GHOST hold for the whole record */
  const char *unit; /* "m/s" */
  const char *meaning;
} part_field;

/* What a library keeps per particle. Record 0 must be double and begin with x, y, z (m);
 * id names the field that holds the global particle number (int64, unique, >= 0). */
typedef struct part_layout {
  int record_count;
  const part_record *records;
  int field_count;
  const part_field *fields;
  int id_field;
} part_layout;

typedef struct part_store {
  const part_layout *layout;
  int local;     /* own particles: indices 0 .. local-1 */
  int ghost;     /* copies after them: local .. local+ghost-1 */
  int capacity;  /* allocated, in particles */
  void **record; /* [record_count], each 64-byte aligned, capacity * width * 8 bytes (+ padding of
                    16 particles, so that vector loads past the end stay inside) */
} part_store;

int part_store_create(const part_layout *layout, part_store **store);
void part_store_destroy(part_store *store);

/* Room for at least n particles, local and ghost together. Pointers into records become invalid. */
int part_store_reserve(part_store *store, int n);

/* n more own particles, all components zero; drops the ghosts. *first is the index of the first. */
int part_store_append(part_store *store, int n, int *first);

/* Keep only the own particles with keep[i] != 0, in order; drops the ghosts. */
int part_store_compact(part_store *store, const unsigned char *keep);

/* New order: particle k becomes the old order[k], for all own particles; drops the ghosts. */
int part_store_permute(part_store *store, const int *order);

/* Move records with a field flagged (PART_MOVES or PART_GHOST) in and out of a flat buffer,
 * particle by particle; bytes per particle. A flag of one field holds for its whole record. index
 * NULL: the first n. */
size_t part_store_item_size(const part_store *store, unsigned flag);
void part_store_pack(const part_store *store, unsigned flag, int n, const int *index, void *buffer);
void part_store_unpack(part_store *store, unsigned flag, int first, int n, const void *buffer);

/* Base of a record and of a field, and the stride of a field in doubles. */
static inline double *part_record_double(const part_store *store, int record) {
  return (double *)store->record[record];
}
static inline int64_t *part_record_int64(const part_store *store, int record) {
  return (int64_t *)store->record[record];
}
static inline double *part_field_double(const part_store *store, int field) {
  const part_field *f = &store->layout->fields[field];
  return (double *)store->record[f->record] + f->offset;
}
static inline int64_t *part_field_int64(const part_store *store, int field) {
  const part_field *f = &store->layout->fields[field];
  return (int64_t *)store->record[f->record] + f->offset;
}
static inline int part_field_stride(const part_store *store, int field) {
  return store->layout->records[store->layout->fields[field].record].width;
}

#ifdef __cplusplus
}
#endif
#endif
