/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "relief.h"
#include <math.h>
#include <string.h>
#include "links.h"

static const double GIVEN = 0.7;   /* of its content, at most, in one pass; see smoothing.c */
static const double MARGIN = 0.02; /* s goes from 0 to 1 over this part of the limit, below it */

struct cpl_relief {
  MPI_Comm comm;
  int size, passes, made;
  cpl_links links;
  CPL_ARRAY(double) share;    /* K_f */
  CPL_ARRAY(double) strength; /* [passes][cells + halo] */
  CPL_ARRAY(double) now;
  CPL_ARRAY(double) next;
  long long cells;
  double volume;
};

int cpl_relief_create(MPI_Comm comm, const cpl_mesh *mesh, cpl_relief **relief) {
  cpl_relief *r = calloc(1, sizeof *r);
  PART_TRY(part_agree(
      comm, r ? PART_OK : part_fail(PART_ERR_MEMORY, "coupling: no memory for overfull cells")));
  r->comm = comm;
  MPI_Comm_size(comm, &r->size);
  r->links.mesh = mesh;
  *relief = r;
  return PART_OK;
}

void cpl_relief_destroy(cpl_relief *r) {
  if (!r)
    return;
  cpl_links_free(&r->links);
  CPL_FREE(r->share);
  CPL_FREE(r->strength);
  CPL_FREE(r->now);
  CPL_FREE(r->next);
  free(r);
}

void cpl_relief_reset(cpl_relief *r) {
  r->passes = 0;
  r->cells = 0;
  r->volume = 0.0;
}

int cpl_relief_passes(const cpl_relief *r) {
  return r->passes;
}

void cpl_relief_report(const cpl_relief *r, long long *cells, double *volume) {
  *cells = r->cells;
  *volume = r->volume;
}

static size_t width_of(const cpl_relief *r) {
  return (size_t)r->links.mesh->cells + (size_t)r->links.halo;
}

/* K_f = GIVEN G_f min over its two cells of V/sum G. Made when the first cell is too full. */
static int make(cpl_relief *r) {
  const cpl_mesh *mesh = r->links.mesh;
  const size_t cells = (size_t)mesh->cells;
  int status = cpl_links_make(mesh, &r->links);
  const int *start = r->links.start.data;
  if (status == PART_OK)
    status = CPL_RESERVE(r->now, width_of(r));
  if (status == PART_OK)
    status = CPL_RESERVE(r->share, start[cells]);
  PART_TRY(part_agree(r->comm, status));
  for (size_t c = 0; c < cells; c++) {
    double sum = 0.0;
    for (int k = start[c]; k < start[c + 1]; k++)
      sum += r->links.conductance.data[k];
    r->now.data[c] = sum > 0.0 ? GIVEN * mesh->volume[c] / sum : 0.0;
  }
  PART_TRY(cpl_links_exchange(&r->links, 1, r->now.data, r->now.data + cells));
  for (size_t c = 0; c < cells; c++)
    for (int k = start[c]; k < start[c + 1]; k++)
      r->share.data[k] =
          r->links.conductance.data[k] * fmin(r->now.data[c], r->now.data[r->links.link.data[k]]);
  r->made = 1;
  return PART_OK;
}

static void pass(const cpl_relief *r, const double *strength, size_t n, const double *now,
                 double *next) {
  const cpl_mesh *mesh = r->links.mesh;
  for (size_t c = 0; c < (size_t)mesh->cells; c++) {
    double sum[16] = {0.0};
    for (int k = r->links.start.data[c]; k < r->links.start.data[c + 1]; k++) {
      const size_t other = (size_t)r->links.link.data[k];
      const double part = r->share.data[k] * fmax(strength[c], strength[other]);
      for (size_t d = 0; part > 0.0 && d < n; d++)
        sum[d] += part * (now[other * n + d] - now[c * n + d]);
    }
    for (size_t d = 0; d < n; d++)
      next[c * n + d] = now[c * n + d] + sum[d] / mesh->volume[c];
  }
}

static int one_pass(cpl_relief *r, const double *strength, size_t n, double *density) {
  const size_t own = (size_t)r->links.mesh->cells * n;
  memcpy(r->now.data, density, own * sizeof *density);
  PART_TRY(cpl_links_exchange(&r->links, (int)n, r->now.data, r->now.data + own));
  pass(r, strength, n, r->now.data, density);
  return PART_OK;
}

/* Largest fill of all ranks, and what is over the limit. */
static double measure(cpl_relief *r, double most, const double *fill, double over[2]) {
  double largest = 0.0;
  over[0] = over[1] = 0.0;
  for (int c = 0; c < r->links.mesh->cells; c++) {
    largest = fmax(largest, fill[c]);
    over[0] += fill[c] > most;
    over[1] += fmax(fill[c] - most, 0.0) * r->links.mesh->volume[c];
  }
  if (r->size > 1) {
    MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, r->comm);
    MPI_Allreduce(MPI_IN_PLACE, over, 2, MPI_DOUBLE, MPI_SUM, r->comm);
  }
  return largest;
}

static int add_pass(cpl_relief *r, double most, double *fill) {
  const size_t cells = (size_t)r->links.mesh->cells, width = width_of(r);
  int status = CPL_RESERVE(r->strength, ((size_t)r->passes + 1) * width);
  if (status == PART_OK)
    status = CPL_RESERVE(r->now, width);
  if (r->size > 1)
    status = part_agree(r->comm, status);
  PART_TRY(status);
  double *strength = r->strength.data + (size_t)r->passes * width;
  for (size_t c = 0; c < cells; c++)
    strength[c] = fmin(fmax(1.0 - (most - fill[c]) / (MARGIN * most), 0.0), 1.0);
  PART_TRY(cpl_links_exchange(&r->links, 1, strength, strength + cells));
  r->passes++;
  return one_pass(r, strength, 1, fill);
}

int cpl_relief_find(cpl_relief *r, double most, double *fill) {
  double over[2];
  cpl_relief_reset(r);
  if (measure(r, most, fill, over) <= most)
    return PART_OK;
  r->cells = (long long)over[0];
  r->volume = over[1];
  if (!r->made)
    PART_TRY(make(r));
  do {
    if (r->passes == CPL_RELIEF_PASSES)
      return part_fail(PART_ERR_RANGE,
                       "coupling: %lld cells have a void fraction below minimumEps, and the cells "
                       "around have no room for the %g m3 of solids that are too much",
                       r->cells, r->volume);
    PART_TRY(add_pass(r, most, fill));
  } while (measure(r, most, fill, over) > most);
  return PART_OK;
}

int cpl_relief_apply(cpl_relief *r, int n, int backwards, double *density) {
  if (r->passes == 0)
    return PART_OK;
  int status = n <= 16 ? CPL_RESERVE(r->now, width_of(r) * (size_t)n)
                       : part_fail(PART_ERR_ARGUMENT, "coupling: %d components", n);
  if (r->size > 1)
    status = part_agree(r->comm, status);
  PART_TRY(status);
  for (int k = 0; k < r->passes; k++) {
    const int p = backwards ? r->passes - 1 - k : k;
    PART_TRY(one_pass(r, r->strength.data + (size_t)p * width_of(r), (size_t)n, density));
  }
  return PART_OK;
}
