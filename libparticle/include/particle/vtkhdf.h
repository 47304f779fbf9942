/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Particle files: one HDF5 file per written time in VTKHDF layout (UnstructuredGrid of vertices,
 * version 1.0, which VTK 9.1 and later and ParaView read), written by all ranks together. Each
 * field with PART_WRITTEN is a PointData array with attributes `unit` and `meaning`. Beside the
 * VTKHDF group, a group /Restart holds what is needed to go on bit for bit: the numbers of
 * particles per rank, named blobs per rank (decomposition, contact history) and named scalars.
 * Files are written under a temporary name and renamed when complete, so that a killed run leaves
 * the last good one. A `.vtkhdf.series` index (JSON) is kept for ParaView. */
#ifndef PARTICLE_VTKHDF_H
#define PARTICLE_VTKHDF_H

#include <mpi.h>
#include "particle/store.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct part_file part_file;

/* Collective. time in s. ERR_IO: the text names the file. Nothing existing is touched before
 * part_file_commit. */
int part_file_create(MPI_Comm comm, const char *path, double time, part_file **file);
/* Collective. Own particles and their PART_WRITTEN fields. */
int part_file_write_store(part_file *file, const part_store *store);
/* Collective. One double array with a name, the same on all ranks (root's is written). */
int part_file_write_values(part_file *file, const char *name, int n, const double *values);
/* Collective. Bytes per rank under a name. */
int part_file_write_blob(part_file *file, const char *name, size_t size, const void *bytes);
/* Collective. Close, rename into place, and enter it in the series index `series` (NULL: none).
 * Entries of the index at or after this time are dropped first, as after a restart, and those whose
 * file is gone. The handle is gone afterwards, also on failure. */
int part_file_commit(part_file *file, const char *series);

/* Collective. ERR_FORMAT: not such a file. */
int part_file_open(MPI_Comm comm, const char *path, double *time, part_file **file);
/* Collective. Appends own particles: with as many ranks as wrote, those that this rank wrote, in
 * order; otherwise a contiguous share. */
int part_file_read_store(part_file *file, part_store *store);
/* *n in: capacity; out: number read. ERR_FORMAT when absent. */
int part_file_read_values(part_file *file, const char *name, int *n, double *values);
/* This rank's bytes (caller frees). *size = 0 and *bytes = NULL where the number of ranks differs
 * from that of the file. For history, which must survive a change of ranks, use
 * part_file_read_all_blobs. */
int part_file_read_blob(part_file *file, const char *name, size_t *size, void **bytes);
/* The bytes of all ranks one after the other, on every rank. */
int part_file_read_all_blobs(part_file *file, const char *name, size_t *size, void **bytes);
void part_file_close(part_file *file); /* also after a failed write: the temporary is removed */

#ifdef __cplusplus
}
#endif
#endif
