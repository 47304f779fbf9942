/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "rendezvous_bins.h"
#include <float.h>
#include <math.h>
#include "memory.h"

enum { MAX_BINS = 1 << 15 }; /* 4 KiB of marks per rank */

/* Bounds over all ranks; one reduction: minima of lo and of -hi. */
static int bounds(MPI_Comm comm, int cells, const cpl_search *search, cpl_bins *bins,
                  double *total_cells) {
  double mine[6], all[6];
  for (int k = 0; k < 6; k++)
    mine[k] = DBL_MAX;
  if (cells > 0) {
    double lo[3], hi[3];
    cpl_search_bounds(search, lo, hi);
    for (int k = 0; k < 3; k++) {
      mine[k] = lo[k];
      mine[3 + k] = -hi[k];
    }
  }
  const double number = cells;
  MPI_Allreduce(mine, all, 6, MPI_DOUBLE, MPI_MIN, comm);
  MPI_Allreduce(&number, total_cells, 1, MPI_DOUBLE, MPI_SUM, comm);
  if (*total_cells < 1.0)
    return part_fail(PART_ERR_ARGUMENT, "coupling: the mesh has no cells on any rank");
  double extent = 0.0;
  for (int k = 0; k < 3; k++)
    extent = fmax(extent, -all[3 + k] - all[k]);
  for (int k = 0; k < 3; k++) {
    bins->lo[k] = all[k] - 1e-9 * extent;
    bins->hi[k] = -all[3 + k] + 1e-9 * extent;
  }
  return PART_OK;
}

/* About one bin per cell, as nearly cubic as the bounds allow, at most MAX_BINS. */
static void choose(double total_cells, cpl_bins *bins) {
  const double target = fmin(fmax(total_cells, 1.0), MAX_BINS);
  double volume = 1.0;
  for (int k = 0; k < 3; k++)
    volume *= bins->hi[k] - bins->lo[k];
  double edge = cbrt(volume / target);
  for (;;) {
    double product = 1.0;
    for (int k = 0; k < 3; k++)
      product *= fmax(1.0, ceil((bins->hi[k] - bins->lo[k]) / edge));
    if (product <= MAX_BINS)
      break;
    edge *= 1.1;
  }
  for (int k = 0; k < 3; k++) {
    bins->n[k] = (int)fmax(1.0, ceil((bins->hi[k] - bins->lo[k]) / edge));
    bins->edge[k] = (bins->hi[k] - bins->lo[k]) / bins->n[k];
  }
}

/* The marks of every rank as ranks per bin, in ascending order. */
static int invert(int size, size_t count, size_t bytes, const unsigned char *bits, cpl_bins *bins) {
  bins->start = calloc(count + 1, sizeof *bins->start);
  if (!bins->start)
    return part_fail(PART_ERR_MEMORY, "coupling: no memory for %zu bins", count);
  int total = 0;
  for (size_t b = 0; b < count; b++) {
    bins->start[b] = total;
    for (int r = 0; r < size; r++)
      total += bits[(size_t)r * bytes + b / 8] >> (b % 8) & 1;
  }
  bins->start[count] = total;
  bins->rank = malloc(((size_t)total + 1) * sizeof *bins->rank);
  if (!bins->rank)
    return part_fail(PART_ERR_MEMORY, "coupling: no memory for the ranks of %zu bins", count);
  for (size_t b = 0, k = 0; b < count; b++)
    for (int r = 0; r < size; r++)
      if (bits[(size_t)r * bytes + b / 8] >> (b % 8) & 1)
        bins->rank[k++] = r;
  return PART_OK;
}

/* Is rank r the only one of bin (x, y, z), or is nobody there? Bins beyond the last have nobody. */
static int only(const cpl_bins *bins, int x, int y, int z, int r) {
  if (x >= bins->n[0] || y >= bins->n[1] || z >= bins->n[2])
    return 1;
  const int b = (z * bins->n[1] + y) * bins->n[0] + x, n = bins->start[b + 1] - bins->start[b];
  return n == 0 || (n == 1 && bins->rank[bins->start[b]] == r);
}

/* Most spheres touch bins of one rank only: then one look tells, instead of eight. Instructions of
 * cpl_rendezvous_visits for a sphere, 30 x 30 x 30 cells on two ranks: 480 to 300 (one rank: 255). */
static int find_alone(cpl_bins *bins) {
  const int n[3] = {bins->n[0], bins->n[1], bins->n[2]};
  bins->alone = malloc((size_t)n[0] * (size_t)n[1] * (size_t)n[2] * sizeof *bins->alone);
  if (!bins->alone)
    return part_fail(PART_ERR_MEMORY, "coupling: no memory for %d x %d x %d bins", n[0], n[1],
                     n[2]);
  for (int z = 0, b = 0; z < n[2]; z++)
    for (int y = 0; y < n[1]; y++)
      for (int x = 0; x < n[0]; x++, b++) {
        int alone = bins->start[b + 1] - bins->start[b] == 1;
        const int r = alone ? bins->rank[bins->start[b]] : -1;
        for (int k = 0; k < 8 && alone; k++)
          alone = only(bins, x + k % 2, y + k / 2 % 2, z + k / 4, r);
        bins->alone[b] = alone ? r : -1;
      }
  return PART_OK;
}

static int gather(MPI_Comm comm, int size, int cells, const cpl_search *search, cpl_bins *bins) {
  const size_t count = (size_t)bins->n[0] * (size_t)bins->n[1] * (size_t)bins->n[2];
  const size_t bytes = (count + 7) / 8;
  unsigned char *mark = calloc(count, 1);
  unsigned char *bits = calloc(bytes, 1);
  unsigned char *all = malloc(bytes * (size_t)size);
  int status = PART_OK;
  if (!mark || !bits || !all)
    status = part_fail(PART_ERR_MEMORY, "coupling: no memory for %zu bins", count);
  status = part_agree(comm, status);
  if (status == PART_OK) {
    if (cells > 0)
      cpl_search_mark(search, bins->lo, bins->edge, bins->n, mark);
    for (size_t b = 0; b < count; b++)
      bits[b / 8] |= (unsigned char)((mark[b] != 0) << (b % 8));
    MPI_Allgather(bits, (int)bytes, MPI_BYTE, all, (int)bytes, MPI_BYTE, comm);
    status = part_agree(comm, invert(size, count, bytes, all, bins));
    if (status == PART_OK)
      status = part_agree(comm, find_alone(bins));
  }
  free(mark);
  free(bits);
  free(all);
  return status;
}

int cpl_bins_create(MPI_Comm comm, int cells, const cpl_search *search, cpl_bins *bins) {
  int size;
  double total_cells;
  MPI_Comm_size(comm, &size);
  PART_TRY(bounds(comm, cells, search, bins, &total_cells));
  choose(total_cells, bins);
  return size > 1 ? gather(comm, size, cells, search, bins) : PART_OK;
}

void cpl_bins_free(cpl_bins *bins) {
  free(bins->start);
  free(bins->rank);
  free(bins->alone);
  bins->start = bins->rank = bins->alone = NULL;
}
