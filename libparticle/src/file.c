/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Life of a particle file, and what reading and writing share. */
#define _POSIX_C_SOURCE 200809L
#include "file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "memory.h"
#include "particle/status.h"

int part_file_is_position(const part_field *field) {
  return field->record == 0 && field->offset == 0 && field->comps == 3;
}

void part_file_field_path(const part_layout *layout, int field, char path[PART_FILE_NAME_SIZE]) {
  const part_field *f = &layout->fields[field];
  if (part_file_is_position(f))
    snprintf(path, PART_FILE_NAME_SIZE, "/VTKHDF/Points");
  else
    snprintf(path, PART_FILE_NAME_SIZE, "/VTKHDF/PointData/%s", f->name);
}

int part_file_fail(const part_file *file, const char *what, const char *name) {
  return part_fail(PART_ERR_IO, "%s: cannot %s %s", file->path, what, name);
}

int part_file_agree(const part_file *file, int status) {
  return file->size == 1 ? status : part_agree(file->comm, status);
}

int part_file_check_name(const part_file *file, const char *name) {
  if (name[0] == '\0' || name[0] == '.' || strchr(name, '/') != NULL ||
      strlen(name) > PART_FILE_NAME_SIZE - 60)
    return part_fail(PART_ERR_ARGUMENT, "%s: '%.60s' is not a name for an entry", file->path, name);
  return PART_OK;
}

static int copy_path(const char *path, const char *suffix, char **copy) {
  const size_t size = strlen(path) + strlen(suffix) + 1;
  PART_TRY(part_allocate(size, 1, copy));
  snprintf(*copy, size, "%s%s", path, suffix);
  return PART_OK;
}

static int fill(part_file *file, const char *path, int writing) {
  file->file = file->transfer = -1;
  file->writing = writing;
  PART_TRY(copy_path(path, "", &file->path));
  return writing ? copy_path(path, ".part", &file->temporary) : PART_OK;
}

int part_file_begin(MPI_Comm comm, const char *path, int writing, part_file **file) {
  part_file *made = NULL;
  *file = NULL;
  int status = part_allocate(1, sizeof *made, &made);
  if (status == PART_OK) {
    made->comm = MPI_COMM_NULL;
    status = fill(made, path, writing);
  }
  status = part_agree(comm, status);
  if (status == PART_OK && (MPI_Comm_dup(comm, &made->comm) != MPI_SUCCESS ||
                            MPI_Comm_size(comm, &made->size) != MPI_SUCCESS ||
                            MPI_Comm_rank(comm, &made->rank) != MPI_SUCCESS))
    status = part_fail(PART_ERR_MPI, "%s: MPI_Comm_dup failed", path);
  if (made != NULL) { /* libraries do not print: HDF5's own reports are off while we use it */
    H5Eget_auto2(H5E_DEFAULT, &made->report, &made->report_data);
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
  }
  if (status == PART_OK) {
    made->transfer = H5Pcreate(H5P_DATASET_XFER);
    if (made->transfer < 0 ||
        (made->size > 1 && H5Pset_dxpl_mpio(made->transfer, H5FD_MPIO_COLLECTIVE) < 0))
      status = part_file_fail(made, "set up", "HDF5");
    status = part_file_agree(made, status);
  }
  if (status != PART_OK) {
    part_file_close(made);
    return status;
  }
  *file = made;
  return PART_OK;
}

hid_t part_file_hdf5(const part_file *file, const char *path, int create) {
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  hid_t opened = -1;
  if (access < 0)
    return -1;
  if (file->size == 1 || H5Pset_fapl_mpio(access, file->comm, MPI_INFO_NULL) >= 0)
    opened = create ? H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, access)
                    : H5Fopen(path, H5F_ACC_RDONLY, access);
  H5Pclose(access);
  return opened;
}

int part_file_select(hid_t space, hsize_t start, hsize_t count) {
  hsize_t from[2] = {start, 0}, n[2] = {count, 0}, dims[2] = {0, 0};
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank < 1 || rank > 2 || H5Sget_simple_extent_dims(space, dims, NULL) < 0)
    return -1;
  if (count == 0)
    return H5Sselect_none(space);
  n[1] = dims[1];
  return H5Sselect_hyperslab(space, H5S_SELECT_SET, from, NULL, n, NULL);
}

void part_file_close(part_file *file) {
  if (file == NULL)
    return;
  if (file->transfer >= 0)
    H5Pclose(file->transfer);
  if (file->file >= 0)
    H5Fclose(file->file);
  if (file->temporary != NULL && file->rank == 0)
    remove(file->temporary);
  H5Eset_auto2(H5E_DEFAULT, file->report, file->report_data);
  if (file->comm != MPI_COMM_NULL)
    MPI_Comm_free(&file->comm);
  free(file->path);
  free(file->temporary);
  free(file->per_rank);
  free(file);
}
