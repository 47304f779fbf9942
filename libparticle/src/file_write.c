/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writing particle files: VTKHDF UnstructuredGrid 1.0 of vertices in one piece, and /Restart. */
#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "file.h"
#include "memory.h"
#include "particle/status.h"

enum { VTK_VERTEX = 1 };

static int add_group(part_file *file, const char *path) {
  const hid_t group = H5Gcreate2(file->file, path, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  if (group < 0)
    return part_file_fail(file, "make group", path);
  H5Gclose(group);
  return PART_OK;
}

/* A string attribute of fixed length, as VTK wants it. */
static int add_text(part_file *file, const char *object, const char *name, const char *text) {
  const hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
  hid_t attribute = -1;
  const size_t length = strlen(text);
  int failed =
      H5Tset_size(type, length > 0 ? length : 1) < 0 || H5Tset_strpad(type, H5T_STR_NULLPAD) < 0;
  if (!failed)
    attribute = H5Acreate_by_name(file->file, object, name, type, space, H5P_DEFAULT, H5P_DEFAULT,
                                  H5P_DEFAULT);
  failed = attribute < 0 || H5Awrite(attribute, type, length > 0 ? text : "\0") < 0;
  if (attribute >= 0)
    H5Aclose(attribute);
  H5Tclose(type);
  H5Sclose(space);
  return failed ? part_file_fail(file, "write attribute", name) : PART_OK;
}

static int add_version(part_file *file) {
  const int version[2] = {1, 0};
  const hsize_t n = 2;
  const hid_t space = H5Screate_simple(1, &n, NULL);
  const hid_t attribute = H5Acreate_by_name(file->file, "/VTKHDF", "Version", H5T_STD_I32LE, space,
                                            H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  const int failed = attribute < 0 || H5Awrite(attribute, H5T_NATIVE_INT, version) < 0;
  if (attribute >= 0)
    H5Aclose(attribute);
  H5Sclose(space);
  return failed ? part_file_fail(file, "write attribute", "Version") : PART_OK;
}

/* An array of which every rank writes its rows start .. start+count-1; comps 1: one direction. */
typedef struct slab {
  hid_t file_type, memory_type;
  hsize_t total, start, count, comps;
  const void *data;
} slab;

/* Collective. Every rank comes this far with its data in hand: nothing here fails on one alone but
 * for the disk. */
static int add_array(part_file *file, const char *path, slab s) {
  const hsize_t in_file[2] = {s.total, s.comps}, in_memory[2] = {s.count, s.comps};
  const int rank = s.comps > 1 ? 2 : 1;
  const hid_t space = H5Screate_simple(rank, in_file, NULL);
  const hid_t memory = H5Screate_simple(rank, in_memory, NULL);
  const hid_t array =
      H5Dcreate2(file->file, path, s.file_type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  int failed = space < 0 || memory < 0 || array < 0;
  if (!failed && s.total > 0) {
    failed = part_file_select(space, s.start, s.count) < 0;
    if (s.count == 0)
      H5Sselect_none(memory);
    failed = H5Dwrite(array, s.memory_type, memory, space, file->transfer, s.data) < 0 || failed;
  }
  if (array >= 0)
    failed = H5Dclose(array) < 0 || failed;
  if (memory >= 0)
    H5Sclose(memory);
  if (space >= 0)
    H5Sclose(space);
  return part_file_agree(file, failed ? part_file_fail(file, "write", path) : PART_OK);
}

/* Numbers that every rank knows; the root writes them. */
static int add_numbers(part_file *file, const char *path, hid_t file_type, hid_t memory_type, int n,
                       const void *data) {
  const hsize_t total = (hsize_t)n;
  const slab s = {file_type, memory_type, total, 0, file->rank == 0 ? total : 0, 1, data};
  return add_array(file, path, s);
}

static int add_frame(part_file *file) {
  static const char *const groups[] = {
      "/VTKHDF",  "/VTKHDF/PointData", "/VTKHDF/CellData", "/VTKHDF/FieldData",
      "/Restart", "/Restart/Values",   "/Restart/Blobs",
  };
  for (size_t g = 0; g < sizeof groups / sizeof groups[0]; g++)
    PART_TRY(add_group(file, groups[g]));
  PART_TRY(add_version(file));
  return add_text(file, "/VTKHDF", "Type", "UnstructuredGrid");
}

/* A plain file first: it fails with the system's reason, such as a folder that is not there. */
static int touch(const part_file *file) {
  if (file->rank != 0)
    return PART_OK;
  FILE *plain = fopen(file->temporary, "wb");
  if (plain == NULL)
    return part_fail(PART_ERR_IO, "%s: cannot create: %s", file->path, strerror(errno));
  fclose(plain);
  return PART_OK;
}

int part_file_create(MPI_Comm comm, const char *path, double time, part_file **file) {
  part_file *made;
  *file = NULL;
  PART_TRY(part_file_begin(comm, path, 1, &made));
  made->time = time;
  int status = part_file_agree(made, touch(made));
  if (status == PART_OK) {
    made->file = part_file_hdf5(made, made->temporary, 1);
    status = made->file >= 0 ? add_frame(made) : part_file_fail(made, "create", "the file");
    status = part_file_agree(made, status);
  }
  if (status == PART_OK)
    status = add_numbers(made, "/VTKHDF/FieldData/TimeValue", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, 1,
                         &time);
  if (status == PART_OK)
    status = add_text(made, "/VTKHDF/FieldData/TimeValue", "unit", "s");
  if (status != PART_OK) {
    part_file_close(made);
    return status;
  }
  *file = made;
  return PART_OK;
}

/* Particles of every rank, on every rank; this rank's are rows *start and on. */
static int count_particles(part_file *file, const part_store *store, hsize_t *start) {
  const int64_t mine = store->local;
  int status = file->per_rank == NULL
                   ? part_allocate((size_t)file->size, sizeof mine, &file->per_rank)
                   : part_fail(PART_ERR_STATE, "%s: has its particles already", file->path);
  PART_TRY(part_file_agree(file, status));
  if (file->size == 1)
    file->per_rank[0] = mine;
  else if (MPI_Allgather(&mine, 1, MPI_INT64_T, file->per_rank, 1, MPI_INT64_T, file->comm) !=
           MPI_SUCCESS)
    return part_fail(PART_ERR_MPI, "MPI_Allgather failed");
  file->writers = file->size;
  file->total = 0;
  *start = 0;
  for (int r = 0; r < file->size; r++) {
    if (r == file->rank)
      *start = (hsize_t)file->total;
    file->total += file->per_rank[r];
  }
  return PART_OK;
}

/* Cells: vertex k is point k, so Connectivity and Offsets count, the latter with one more. */
static int add_cells(part_file *file, hsize_t start, hsize_t count, int64_t *numbers) {
  const hsize_t total = (hsize_t)file->total;
  const int last = file->rank == file->size - 1;
  const int64_t n = file->total;
  for (hsize_t k = 0; k <= count; k++)
    numbers[k] = (int64_t)(start + k);
  const hid_t in_file = H5T_STD_I64LE, in_memory = H5T_NATIVE_INT64;
  PART_TRY(add_numbers(file, "/VTKHDF/NumberOfPoints", in_file, in_memory, 1, &n));
  PART_TRY(add_numbers(file, "/VTKHDF/NumberOfCells", in_file, in_memory, 1, &n));
  PART_TRY(add_numbers(file, "/VTKHDF/NumberOfConnectivityIds", in_file, in_memory, 1, &n));
  PART_TRY(add_array(file, "/VTKHDF/Connectivity",
                     (slab){in_file, in_memory, total, start, count, 1, numbers}));
  PART_TRY(
      add_array(file, "/VTKHDF/Offsets",
                (slab){in_file, in_memory, total + 1, start, count + (hsize_t)last, 1, numbers}));
  memset(numbers, VTK_VERTEX, count);
  return add_array(file, "/VTKHDF/Types",
                   (slab){H5T_STD_U8LE, H5T_NATIVE_UCHAR, total, start, count, 1, numbers});
}

/* Components offset .. offset+comps-1 of a record without gaps. */
static void collect(const part_store *store, int record, int offset, int comps, void *buffer) {
  const size_t width = (size_t)store->layout->records[record].width * 8, bytes = (size_t)comps * 8;
  const unsigned char *from = (const unsigned char *)store->record[record] + (size_t)offset * 8;
  unsigned char *to = (unsigned char *)buffer;
  for (int i = 0; i < store->local; i++, from += width, to += bytes)
    memcpy(to, from, bytes);
}

static int add_record(part_file *file, const part_store *store, const char *path, int record,
                      int offset, int comps, hsize_t start, void *buffer) {
  const int real = store->layout->records[record].type == PART_DOUBLE;
  collect(store, record, offset, comps, buffer);
  const slab s = {real ? H5T_IEEE_F64LE : H5T_STD_I64LE,
                  real ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT64,
                  (hsize_t)file->total,
                  start,
                  (hsize_t)store->local,
                  (hsize_t)comps,
                  buffer};
  return add_array(file, path, s);
}

static int add_fields(part_file *file, const part_store *store, hsize_t start, void *buffer) {
  const part_layout *layout = store->layout;
  char path[PART_FILE_NAME_SIZE];
  PART_TRY(add_record(file, store, "/VTKHDF/Points", 0, 0, 3, start, buffer));
  for (int f = 0; f < layout->field_count; f++) {
    const part_field *field = &layout->fields[f];
    if (!(field->flags & PART_WRITTEN))
      continue;
    part_file_field_path(layout, f, path);
    if (!part_file_is_position(field))
      PART_TRY(
          add_record(file, store, path, field->record, field->offset, field->comps, start, buffer));
    PART_TRY(add_text(file, path, "unit", field->unit));
    PART_TRY(add_text(file, path, "meaning", field->meaning));
  }
  return PART_OK;
}

int part_file_write_store(part_file *file, const part_store *store) {
  const part_layout *layout = store->layout;
  hsize_t start = 0;
  void *buffer = NULL;
  int widest = 3;
  if (!file->writing)
    return part_fail(PART_ERR_STATE, "%s: is open for reading", file->path);
  PART_TRY(count_particles(file, store, &start));
  for (int f = 0; f < layout->field_count; f++)
    if (layout->fields[f].comps > widest)
      widest = layout->fields[f].comps;
  int status = part_allocate((size_t)store->local + 1, (size_t)widest * 8, &buffer);
  status = part_file_agree(file, status);
  if (status == PART_OK)
    status = add_cells(file, start, (hsize_t)store->local, (int64_t *)buffer);
  if (status == PART_OK)
    status = add_fields(file, store, start, buffer);
  if (status == PART_OK)
    status = add_numbers(file, "/Restart/NumberOfParticles", H5T_STD_I64LE, H5T_NATIVE_INT64,
                         file->size, file->per_rank);
  free(buffer);
  return status;
}

int part_file_write_values(part_file *file, const char *name, int n, const double *values) {
  char path[PART_FILE_NAME_SIZE];
  if (!file->writing)
    return part_fail(PART_ERR_STATE, "%s: is open for reading", file->path);
  if (n < 0)
    return part_fail(PART_ERR_ARGUMENT, "%s: %d values of %s", file->path, n, name);
  PART_TRY(part_file_check_name(file, name));
  snprintf(path, sizeof path, "/Restart/Values/%s", name);
  return add_numbers(file, path, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, n, values);
}

static int add_blob(part_file *file, const char *name, size_t size, const void *bytes,
                    int64_t *sizes) {
  char path[PART_FILE_NAME_SIZE];
  const int64_t mine = (int64_t)size;
  hsize_t start = 0, total = 0;
  if (file->size == 1)
    sizes[0] = mine;
  else if (MPI_Allgather(&mine, 1, MPI_INT64_T, sizes, 1, MPI_INT64_T, file->comm) != MPI_SUCCESS)
    return part_fail(PART_ERR_MPI, "MPI_Allgather failed");
  for (int r = 0; r < file->size; r++) {
    start += r < file->rank ? (hsize_t)sizes[r] : 0;
    total += (hsize_t)sizes[r];
  }
  snprintf(path, sizeof path, "/Restart/Blobs/%s", name);
  PART_TRY(part_file_agree(file, add_group(file, path)));
  snprintf(path, sizeof path, "/Restart/Blobs/%s/sizes", name);
  PART_TRY(add_numbers(file, path, H5T_STD_I64LE, H5T_NATIVE_INT64, file->size, sizes));
  snprintf(path, sizeof path, "/Restart/Blobs/%s/bytes", name);
  return add_array(file, path,
                   (slab){H5T_STD_U8LE, H5T_NATIVE_UCHAR, total, start, size, 1, bytes});
}

int part_file_write_blob(part_file *file, const char *name, size_t size, const void *bytes) {
  int64_t *sizes = NULL;
  if (!file->writing)
    return part_fail(PART_ERR_STATE, "%s: is open for reading", file->path);
  PART_TRY(part_file_check_name(file, name));
  int status = part_allocate((size_t)file->size, sizeof *sizes, &sizes);
  status = part_file_agree(file, status);
  if (status == PART_OK)
    status = add_blob(file, name, size, bytes, sizes);
  free(sizes);
  return status;
}

/* On the root: into place, then into the index. */
static int put_in_place(part_file *file, const char *series) {
  if (file->rank != 0)
    return PART_OK;
  if (rename(file->temporary, file->path) != 0)
    return part_fail(PART_ERR_IO, "%s: cannot rename into place: %s", file->path, strerror(errno));
  return series != NULL ? part_series_enter(series, file->path, file->time) : PART_OK;
}

int part_file_commit(part_file *file, const char *series) {
  int status =
      file->writing ? PART_OK : part_fail(PART_ERR_STATE, "%s: is open for reading", file->path);
  if (status == PART_OK) {
    if (H5Fclose(file->file) < 0)
      status = part_file_fail(file, "complete", "the file");
    file->file = -1;
    status = part_file_agree(file, status);
  }
  if (status == PART_OK)
    status = part_file_agree(file, put_in_place(file, series));
  part_file_close(file);
  return status;
}
