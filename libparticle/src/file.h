/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files about particle files share. */
#ifndef PART_FILE_H
#define PART_FILE_H

#include <hdf5.h>

#include "particle/vtkhdf.h"

struct part_file {
  MPI_Comm comm;
  int size, rank;
  int writing;
  hid_t file, transfer; /* transfer: property list for reading and writing by all ranks together */
  char *path, *temporary; /* temporary: NULL when reading */
  double time;
  int64_t total, *per_rank; /* particles in the file, and per rank that wrote: [writers] */
  int writers;
  H5E_auto2_t report; /* of HDF5, as found: it is silenced while a file is open */
  void *report_data;
};

/* The dataset /VTKHDF/... of a field; Points for the position. */
enum { PART_FILE_NAME_SIZE = 300 };
void part_file_field_path(const part_layout *layout, int field, char path[PART_FILE_NAME_SIZE]);
int part_file_is_position(const part_field *field);

/* part_fail(ERR_IO) with the name of the file. */
int part_file_fail(const part_file *file, const char *what, const char *name);
int part_file_agree(const part_file *file, int status);
/* A name that a dataset can have. */
int part_file_check_name(const part_file *file, const char *name);

/* A new handle without an open file; path is copied. Collective. */
int part_file_begin(MPI_Comm comm, const char *path, int writing, part_file **file);
/* Open (create = 0) or create the HDF5 file `path`, with MPI-IO on more than one rank. */
hid_t part_file_hdf5(const part_file *file, const char *path, int create);
/* Rows start .. start+count-1 of the first direction of a file's dataspace; nothing for count 0. */
int part_file_select(hid_t space, hsize_t start, hsize_t count);

/* Enter a file in a series index, drop what is at or after its time. On one rank. */
int part_series_enter(const char *series, const char *path, double time);

#endif
