/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A coarse grid over the whole mesh; each bin lists the ranks whose cells may touch it. */
#ifndef COUPLING_RENDEZVOUS_BINS_H
#define COUPLING_RENDEZVOUS_BINS_H

#include "search.h"

typedef struct cpl_bins {
  double lo[3], hi[3]; /* bounds of the whole mesh, widened by round-off, m */
  double edge[3];
  int n[3];
  int *start; /* [n[0] n[1] n[2] + 1] into rank; NULL with one rank */
  int *rank;
  int *alone; /* [bins] the only rank of a bin and of the seven behind it in x, y, z; -1: others */
} cpl_bins;

/* Collective. ERR_ARGUMENT: no rank has cells. */
int cpl_bins_create(MPI_Comm comm, int cells, const cpl_search *search, cpl_bins *bins);
void cpl_bins_free(cpl_bins *bins);

#endif
