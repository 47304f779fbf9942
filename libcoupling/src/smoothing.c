/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <string.h>
#include "smoothing_type.h"

/* Part of its content that a cell may give away in one pass: <= 1 keeps everything positive, and
 * below 1 neighbours do not merely swap (with 0.7 that mode decays by 0.4 a pass). */
static const double GIVEN = 0.7;
static const double MOST_PASSES = 100000.0;

/* ---- build ---------------------------------------------------------------------------------- */
static double cell_variance(const cpl_mesh *mesh, int c, double variance, double cells) {
  const double h = cells * cbrt(mesh->volume[c]);
  return fmax(variance, h * h);
}

/* share = G_f sigma_f^2/2 so far. */
static void first_shares(cpl_smoother *s, const double *other_variance) {
  const double *variance = s->variance.data;
  const int cells = s->links.mesh->cells;
  for (int c = 0; c < cells; c++)
    for (int k = s->links.start.data[c]; k < s->links.start.data[c + 1]; k++) {
      const int other = s->links.link.data[k];
      const double v = other < cells ? variance[other] : other_variance[other - cells];
      s->share.data[k] = 0.25 * s->links.conductance.data[k] * (variance[c] + v);
    }
}

/* Passes from the cell that gives most; then share = part of a difference that moves in one. */
static int choose_passes(cpl_smoother *s) {
  const cpl_mesh *mesh = s->links.mesh;
  double most = 0.0;
  for (int c = 0; c < mesh->cells; c++) {
    double sum = 0.0;
    for (int k = s->links.start.data[c]; k < s->links.start.data[c + 1]; k++)
      sum += s->share.data[k];
    most = fmax(most, sum / mesh->volume[c]);
  }
  if (s->size > 1)
    MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_DOUBLE, MPI_MAX, s->comm);
  const double passes = ceil(most / GIVEN);
  if (!(passes <= MOST_PASSES))
    return part_fail(
        PART_ERR_RANGE,
        "coupling: smoothing over the bandwidth would need %g passes on this mesh, "
        "whose smallest cells are far below it; at most %g: make the bandwidth smaller",
        passes, MOST_PASSES);
  s->passes = (int)passes;
  for (int c = 0; c < mesh->cells; c++)
    for (int k = s->links.start.data[c]; k < s->links.start.data[c + 1]; k++)
      s->share.data[k] /= fmax(passes, 1.0) * mesh->volume[c];
  return PART_OK;
}

static int reserve_work(cpl_smoother *s, size_t n) {
  const size_t all = (size_t)s->links.mesh->cells + (size_t)s->links.halo;
  PART_TRY(CPL_RESERVE(s->now, all * n));
  return CPL_RESERVE(s->next, all * n);
}

static int build(cpl_smoother *s, const cpl_mesh *mesh, double variance, double cells) {
  const size_t n = (size_t)mesh->cells;
  int status = cpl_links_make(mesh, &s->links);
  if (status == PART_OK)
    status = reserve_work(s, 1);
  if (status == PART_OK)
    status = CPL_RESERVE(s->variance, n);
  if (status == PART_OK)
    status = CPL_RESERVE(s->share, s->links.start.data[n]);
  PART_TRY(part_agree(s->comm, status));
  for (size_t c = 0; c < n; c++)
    s->variance.data[c] = cell_variance(mesh, (int)c, variance, cells);
  status = cpl_links_exchange(&s->links, 1, s->variance.data, s->now.data);
  if (status == PART_OK) {
    first_shares(s, s->now.data);
    status = choose_passes(s);
  }
  return part_agree(s->comm, status);
}

int cpl_smoother_create(MPI_Comm comm, const cpl_mesh *mesh, double variance, double cells,
                        cpl_smoother **smoother) {
  cpl_smoother *s = calloc(1, sizeof *s);
  PART_TRY(part_agree(
      comm, s ? PART_OK : part_fail(PART_ERR_MEMORY, "coupling: no memory for the smoothing")));
  s->comm = comm;
  MPI_Comm_size(comm, &s->size);
  const int status = build(s, mesh, variance, cells);
  if (status != PART_OK) {
    cpl_smoother_destroy(s);
    return status;
  }
  *smoother = s;
  return PART_OK;
}

void cpl_smoother_destroy(cpl_smoother *s) {
  if (!s)
    return;
  cpl_links_free(&s->links);
  CPL_FREE(s->share);
  CPL_FREE(s->variance);
  CPL_FREE(s->shape);
  CPL_FREE(s->now);
  CPL_FREE(s->next);
  free(s);
}

int cpl_smoother_passes(const cpl_smoother *s) {
  return s->passes;
}

/* ---- apply ---------------------------------------------------------------------------------- */
static inline __attribute__((always_inline)) void
pass(const cpl_smoother *s, size_t n, const double *restrict now, double *restrict next) {
  const int *start = s->links.start.data, *link = s->links.link.data;
  const double *share = s->share.data;
  for (size_t c = 0; c < (size_t)s->links.mesh->cells; c++) {
    double sum[16];
    for (size_t d = 0; d < n; d++)
      sum[d] = 0.0;
    for (int k = start[c]; k < start[c + 1]; k++) {
      const double *other = now + (size_t)link[k] * n;
      for (size_t d = 0; d < n; d++)
        sum[d] += share[k] * (other[d] - now[c * n + d]);
    }
    for (size_t d = 0; d < n; d++)
      next[c * n + d] = now[c * n + d] + sum[d];
  }
}

/* n <= 16; the numbers of components in use with a constant width. */
static void pass_n(const cpl_smoother *s, size_t n, const double *now, double *next) {
  switch (n) {
  case 1:
    pass(s, 1, now, next);
    break;
  case 3:
    pass(s, 3, now, next);
    break;
  case 4:
    pass(s, 4, now, next);
    break;
  case 6:
    pass(s, 6, now, next);
    break;
  case 7:
    pass(s, 7, now, next);
    break;
  default:
    pass(s, n, now, next);
  }
}

int cpl_smoother_apply(cpl_smoother *s, int n, double *density) {
  if (s->passes == 0)
    return PART_OK;
  const size_t width = (size_t)n, own = (size_t)s->links.mesh->cells * width;
  int status = n <= 16 ? reserve_work(s, width)
                       : part_fail(PART_ERR_ARGUMENT, "coupling: smoothing of %d components", n);
  if (s->size > 1)
    status = part_agree(s->comm, status);
  PART_TRY(status);
  if (own > 0)
    memcpy(s->now.data, density, own * sizeof *density);
  double *now = s->now.data, *next = s->next.data;
  for (int k = 0; k < s->passes; k++) {
    PART_TRY(cpl_links_exchange(&s->links, n, now, now + own));
    pass_n(s, width, now, next);
    double *swap = now;
    now = next;
    next = swap;
  }
  if (own > 0)
    memcpy(density, now, own * sizeof *density);
  return PART_OK;
}
