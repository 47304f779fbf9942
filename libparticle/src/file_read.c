/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reading particle files. What does not fit the expected is ERR_FORMAT and named. */
#include <errno.h>
#include <limits.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "file.h"
#include "memory.h"
#include "particle/status.h"

static int wrong(const part_file *file, const char *path, const char *why) {
  return part_fail(PART_ERR_FORMAT, "%s: %s %s", file->path, path, why);
}

/* A dataset of doubles, of 64-bit integers or of bytes, with its lengths (0 where it has none). */
static int open_array(const part_file *file, const char *path, H5T_class_t kind, size_t item,
                      hid_t *array, hsize_t dims[2]) {
  *array = H5Dopen2(file->file, path, H5P_DEFAULT);
  if (*array < 0)
    return wrong(file, path, "is missing");
  const hid_t space = H5Dget_space(*array), type = H5Dget_type(*array);
  const int rank = H5Sget_simple_extent_ndims(space);
  dims[0] = dims[1] = 0;
  int fits = rank >= 1 && rank <= 2 && H5Tget_class(type) == kind && H5Tget_size(type) == item;
  fits = fits && H5Sget_simple_extent_dims(space, dims, NULL) >= 0;
  H5Tclose(type);
  H5Sclose(space);
  if (fits)
    return PART_OK;
  H5Dclose(*array);
  *array = -1;
  return wrong(file, path, "has another type");
}

/* Rows start .. start+count-1 into data, each rank on its own or (collective) all together. */
static int read_rows(const part_file *file, const char *path, hid_t array, hid_t type,
                     hsize_t start, hsize_t count, int collective, void *data) {
  const hid_t space = H5Dget_space(array);
  hsize_t dims[2] = {0, 0};
  const int rank = H5Sget_simple_extent_dims(space, dims, NULL);
  int failed = rank < 1;
  if (!failed && dims[0] > 0) {
    dims[0] = count;
    const hid_t memory = H5Screate_simple(rank, dims, NULL);
    failed = part_file_select(space, start, count) < 0;
    if (count == 0)
      H5Sselect_none(memory);
    failed =
        H5Dread(array, type, memory, space, collective ? file->transfer : H5P_DEFAULT, data) < 0 ||
        failed;
    H5Sclose(memory);
  }
  H5Sclose(space);
  return failed ? part_file_fail(file, "read", path) : PART_OK;
}

/* A whole one-dimensional array, allocated here. */
static int read_whole(const part_file *file, const char *path, H5T_class_t kind, hid_t type,
                      size_t item, size_t *n, void *pointer_to_pointer) {
  hid_t array;
  hsize_t dims[2];
  void *data = NULL;
  PART_TRY(open_array(file, path, kind, item, &array, dims));
  int status =
      dims[1] != 0 ? wrong(file, path, "has two directions") : part_allocate(dims[0], item, &data);
  if (status == PART_OK)
    status = read_rows(file, path, array, type, 0, dims[0], 0, data);
  H5Dclose(array);
  if (status != PART_OK) {
    free(data);
    return status;
  }
  *n = dims[0];
  memcpy(pointer_to_pointer, &data, sizeof data);
  return PART_OK;
}

static int read_head(part_file *file) {
  double *time;
  size_t n;
  PART_TRY(
      read_whole(file, "/VTKHDF/FieldData/TimeValue", H5T_FLOAT, H5T_NATIVE_DOUBLE, 8, &n, &time));
  file->time = n > 0 ? time[0] : 0.0;
  free(time);
  if (n != 1)
    return wrong(file, "/VTKHDF/FieldData/TimeValue", "is not one number");
  /* Absent when no particles were written. */
  if (H5Lexists(file->file, "/Restart/NumberOfParticles", H5P_DEFAULT) <= 0)
    return PART_OK;
  PART_TRY(read_whole(file, "/Restart/NumberOfParticles", H5T_INTEGER, H5T_NATIVE_INT64, 8, &n,
                      &file->per_rank));
  file->writers = (int)n;
  for (size_t r = 0; r < n; r++) {
    if (file->per_rank[r] < 0)
      return wrong(file, "/Restart/NumberOfParticles", "is negative");
    file->total += file->per_rank[r];
  }
  return PART_OK;
}

static int look(const part_file *file) {
  if (file->rank != 0)
    return PART_OK;
  FILE *plain = fopen(file->path, "rb");
  if (plain == NULL)
    return part_fail(PART_ERR_IO, "%s: cannot open: %s", file->path, strerror(errno));
  fclose(plain);
  if (H5Fis_hdf5(file->path) <= 0)
    return part_fail(PART_ERR_FORMAT, "%s: is not an HDF5 file", file->path);
  return PART_OK;
}

int part_file_open(MPI_Comm comm, const char *path, double *time, part_file **file) {
  part_file *made;
  *file = NULL;
  PART_TRY(part_file_begin(comm, path, 0, &made));
  int status = part_file_agree(made, look(made));
  if (status == PART_OK) {
    made->file = part_file_hdf5(made, path, 0);
    status = made->file >= 0 ? read_head(made) : part_file_fail(made, "open", "the file");
    status = part_file_agree(made, status);
  }
  if (status != PART_OK) {
    part_file_close(made);
    return status;
  }
  if (time != NULL)
    *time = made->time;
  *file = made;
  return PART_OK;
}

/* This rank's rows: its own when as many ranks wrote, else a contiguous share. */
static void share(const part_file *file, int64_t *start, int64_t *count) {
  *start = 0;
  if (file->writers == file->size) {
    for (int r = 0; r < file->rank; r++)
      *start += file->per_rank[r];
    *count = file->per_rank[file->rank];
    return;
  }
  const int64_t each = file->total / file->size, more = file->total % file->size;
  *start = each * file->rank + (file->rank < more ? file->rank : more);
  *count = each + (file->rank < more ? 1 : 0);
}

/* Collective. Components offset .. offset+comps-1 of a record of particles first, first+1, ... */
static int read_record(const part_file *file, part_store *store, const char *path, int record,
                       int offset, int comps, int first, int64_t start, void *buffer) {
  const int real = store->layout->records[record].type == PART_DOUBLE;
  const size_t width = (size_t)store->layout->records[record].width * 8, bytes = (size_t)comps * 8;
  const size_t count = (size_t)(store->local - first);
  hid_t array;
  hsize_t dims[2];
  int status = open_array(file, path, real ? H5T_FLOAT : H5T_INTEGER, 8, &array, dims);
  if (status == PART_OK &&
      (dims[0] != (hsize_t)file->total || dims[1] != (comps > 1 ? (hsize_t)comps : 0)))
    status = wrong(file, path, "has another number of particles or components");
  status = part_file_agree(file, status);
  if (status == PART_OK)
    status = part_file_agree(file, read_rows(file, path, array,
                                             real ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT64,
                                             (hsize_t)start, count, 1, buffer));
  if (array >= 0)
    H5Dclose(array);
  PART_TRY(status);
  unsigned char *to =
      (unsigned char *)store->record[record] + (size_t)first * width + (size_t)offset * 8;
  const unsigned char *from = (const unsigned char *)buffer;
  for (size_t k = 0; k < count; k++, to += width, from += bytes)
    memcpy(to, from, bytes);
  return PART_OK;
}

static int read_fields(const part_file *file, part_store *store, int first, int64_t start,
                       void *buffer) {
  const part_layout *layout = store->layout;
  char path[PART_FILE_NAME_SIZE];
  PART_TRY(read_record(file, store, "/VTKHDF/Points", 0, 0, 3, first, start, buffer));
  for (int f = 0; f < layout->field_count; f++) {
    const part_field *field = &layout->fields[f];
    if (!(field->flags & PART_WRITTEN) || part_file_is_position(field))
      continue;
    part_file_field_path(layout, f, path);
    PART_TRY(read_record(file, store, path, field->record, field->offset, field->comps, first,
                         start, buffer));
  }
  return PART_OK;
}

static int make_room(part_store *store, int64_t count, int *first, void **buffer) {
  size_t widest = 3;
  for (int f = 0; f < store->layout->field_count; f++)
    if ((size_t)store->layout->fields[f].comps > widest)
      widest = (size_t)store->layout->fields[f].comps;
  if (count > INT_MAX)
    return part_fail(PART_ERR_RANGE, "%lld particles on one rank", (long long)count);
  PART_TRY(part_allocate((size_t)count, widest * 8, buffer));
  return part_store_append(store, (int)count, first);
}

int part_file_read_store(part_file *file, part_store *store) {
  const int before = store->local;
  int64_t start = 0, count = 0;
  int first = before;
  void *buffer = NULL;
  int status = file->writing ? part_fail(PART_ERR_STATE, "%s: is being written", file->path)
               : file->per_rank == NULL ? wrong(file, "/Restart/NumberOfParticles", "is missing")
                                        : PART_OK;
  PART_TRY(status); /* the same on all ranks */
  share(file, &start, &count);
  status = part_file_agree(file, make_room(store, count, &first, &buffer));
  if (status == PART_OK)
    status = read_fields(file, store, first, start, buffer);
  if (status != PART_OK)
    store->local = before;
  free(buffer);
  return status;
}

int part_file_read_values(part_file *file, const char *name, int *n, double *values) {
  char path[PART_FILE_NAME_SIZE];
  double *found;
  size_t count;
  PART_TRY(part_file_check_name(file, name));
  snprintf(path, sizeof path, "/Restart/Values/%s", name);
  PART_TRY(read_whole(file, path, H5T_FLOAT, H5T_NATIVE_DOUBLE, 8, &count, &found));
  const int fits = *n >= 0 && count <= (size_t)*n;
  if (fits) {
    memcpy(values, found, count * sizeof *values);
    *n = (int)count;
  }
  free(found);
  return fits ? PART_OK
              : part_fail(PART_ERR_FORMAT, "%s: %s has %zu values, there is room for %d",
                          file->path, path, count, *n);
}

int part_file_read_all_blobs(part_file *file, const char *name, size_t *size, void **bytes) {
  char path[PART_FILE_NAME_SIZE];
  *size = 0;
  *bytes = NULL;
  PART_TRY(part_file_check_name(file, name));
  snprintf(path, sizeof path, "/Restart/Blobs/%s/bytes", name);
  return read_whole(file, path, H5T_INTEGER, H5T_NATIVE_UCHAR, 1, size, bytes);
}

/* Bytes start .. start+size-1 of a blob. */
static int read_part(const part_file *file, const char *path, hsize_t start, size_t size,
                     void **bytes) {
  hid_t array;
  hsize_t dims[2];
  PART_TRY(open_array(file, path, H5T_INTEGER, 1, &array, dims));
  int status = dims[1] != 0 || start + size > dims[0] ? wrong(file, path, "is too short")
                                                      : part_allocate(size, 1, bytes);
  if (status == PART_OK)
    status = read_rows(file, path, array, H5T_NATIVE_UCHAR, start, size, 0, *bytes);
  H5Dclose(array);
  if (status != PART_OK) {
    free(*bytes);
    *bytes = NULL;
  }
  return status;
}

int part_file_read_blob(part_file *file, const char *name, size_t *size, void **bytes) {
  char path[PART_FILE_NAME_SIZE];
  int64_t *sizes;
  size_t n;
  *size = 0;
  *bytes = NULL;
  PART_TRY(part_file_check_name(file, name));
  snprintf(path, sizeof path, "/Restart/Blobs/%s/sizes", name);
  PART_TRY(read_whole(file, path, H5T_INTEGER, H5T_NATIVE_INT64, 8, &n, &sizes));
  hsize_t start = 0, mine = 0;
  const int same = n == (size_t)file->size;
  for (int r = 0; same && r <= file->rank; r++) {
    start += mine;
    mine = (hsize_t)sizes[r];
  }
  free(sizes);
  if (!same || mine == 0)
    return PART_OK;
  snprintf(path, sizeof path, "/Restart/Blobs/%s/bytes", name);
  PART_TRY(read_part(file, path, start, mine, bytes));
  *size = mine;
  return PART_OK;
}
