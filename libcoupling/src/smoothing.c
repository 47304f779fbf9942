/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "smoothing.h"
#include <math.h>
#include <string.h>
#include "memory.h"

/* Part of its content that a cell may give away in one pass: <= 1 keeps everything positive, and
 * below 1 neighbours do not merely swap (with 0.7 that mode decays by 0.4 a pass). */
static const double GIVEN = 0.7;
static const double MOST_PASSES = 100000.0;

struct cpl_smoother {
  MPI_Comm comm;
  int size, passes;
  const cpl_mesh *mesh;
  CPL_ARRAY(int) start;       /* [cells+1] into link */
  CPL_ARRAY(int) link;        /* neighbour cells; cells + k: coupled face k */
  CPL_ARRAY(double) share;    /* of the difference to that neighbour taken in one pass */
  CPL_ARRAY(double) variance; /* [cells] m2 */
  CPL_ARRAY(double) now;
  CPL_ARRAY(double) next;
  CPL_ARRAY(double) sent;
};

/* ---- links ---------------------------------------------------------------------------------- */
/* Area vector of a face: triangles about its centre, m2. */
static void face_area(const cpl_mesh *mesh, int f, double area[3]) {
  const double *apex = mesh->face_centre + 3 * (size_t)f;
  area[0] = area[1] = area[2] = 0.0;
  const int first = mesh->face_start[f], end = mesh->face_start[f + 1];
  for (int k = first; k < end; k++) {
    const int next = k + 1 < end ? k + 1 : first;
    double a[3], b[3];
    for (int d = 0; d < 3; d++) {
      a[d] = mesh->point[3 * (size_t)mesh->face_point[k] + (size_t)d] - apex[d];
      b[d] = mesh->point[3 * (size_t)mesh->face_point[next] + (size_t)d] - apex[d];
    }
    area[0] += 0.5 * (a[1] * b[2] - a[2] * b[1]);
    area[1] += 0.5 * (a[2] * b[0] - a[0] * b[2]);
    area[2] += 0.5 * (a[0] * b[1] - a[1] * b[0]);
  }
}

/* (S.d)/|d|^2, m; a face that looks the wrong way conducts nothing. */
static double conductance(const cpl_mesh *mesh, int f) {
  const double *own = mesh->cell_centre + 3 * (size_t)mesh->owner[f];
  const double *nei = mesh->cell_centre + 3 * (size_t)mesh->neighbour[f];
  double area[3], along = 0.0, length2 = 0.0;
  face_area(mesh, f, area);
  for (int d = 0; d < 3; d++) {
    const double x = nei[d] - own[d];
    along += area[d] * x;
    length2 += x * x;
  }
  return length2 > 0.0 ? fmax(along / length2, 0.0) : 0.0;
}

static double cell_variance(const cpl_mesh *mesh, int c, double variance, double cells) {
  const double h = cells * cbrt(mesh->volume[c]);
  return fmax(variance, h * h);
}

static int count_links(cpl_smoother *s) {
  const cpl_mesh *mesh = s->mesh;
  const size_t cells = (size_t)mesh->cells;
  PART_TRY(CPL_RESERVE(s->start, cells + 1));
  int *start = s->start.data;
  memset(start, 0, (cells + 1) * sizeof *start);
  for (int f = 0; f < mesh->internal; f++) {
    start[mesh->owner[f] + 1]++;
    start[mesh->neighbour[f] + 1]++;
  }
  for (int k = 0; mesh->coupled && k < mesh->coupled->count; k++)
    start[mesh->coupled->cell[k] + 1]++;
  for (size_t c = 0; c < cells; c++)
    start[c + 1] += start[c];
  PART_TRY(CPL_RESERVE(s->link, start[cells]));
  return CPL_RESERVE(s->share, start[cells]);
}

static void add_link(cpl_smoother *s, int *at, int cell, int other, double value) {
  s->link.data[at[cell]] = other;
  s->share.data[at[cell]++] = value;
}

/* share = G_f sigma_f^2/2 so far. at[cells]: where the next link of a cell goes. */
static void make_links(cpl_smoother *s, int *at, const double *other_variance) {
  const cpl_mesh *mesh = s->mesh;
  const double *variance = s->variance.data;
  memcpy(at, s->start.data, (size_t)mesh->cells * sizeof *at);
  for (int f = 0; f < mesh->internal; f++) {
    const int own = mesh->owner[f], nei = mesh->neighbour[f];
    const double value = 0.25 * conductance(mesh, f) * (variance[own] + variance[nei]);
    add_link(s, at, own, nei, value);
    add_link(s, at, nei, own, value);
  }
  for (int k = 0; mesh->coupled && k < mesh->coupled->count; k++) {
    const int own = mesh->coupled->cell[k];
    add_link(s, at, own, mesh->cells + k,
             0.25 * mesh->coupled->conductance[k] * (variance[own] + other_variance[k]));
  }
}

/* Passes from the cell that gives most; then share = part of a difference that moves in one. */
static int choose_passes(cpl_smoother *s) {
  const cpl_mesh *mesh = s->mesh;
  double most = 0.0;
  for (int c = 0; c < mesh->cells; c++) {
    double sum = 0.0;
    for (int k = s->start.data[c]; k < s->start.data[c + 1]; k++)
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
    for (int k = s->start.data[c]; k < s->start.data[c + 1]; k++)
      s->share.data[k] /= fmax(passes, 1.0) * mesh->volume[c];
  return PART_OK;
}

static int exchange(cpl_smoother *s, int n, const double *cell, double *other) {
  const cpl_coupled_faces *coupled = s->mesh->coupled;
  if (!coupled)
    return PART_OK;
  const size_t width = (size_t)n;
  for (int k = 0; k < coupled->count; k++)
    memcpy(s->sent.data + (size_t)k * width, cell + (size_t)coupled->cell[k] * width,
           width * sizeof *cell);
  return coupled->exchange(coupled->context, n, s->sent.data, other);
}

static int reserve_work(cpl_smoother *s, size_t n) {
  const size_t faces = s->mesh->coupled ? (size_t)s->mesh->coupled->count : 0;
  const size_t all = (size_t)s->mesh->cells + faces;
  PART_TRY(CPL_RESERVE(s->now, all * n));
  PART_TRY(CPL_RESERVE(s->next, all * n));
  return CPL_RESERVE(s->sent, faces * n);
}

static int build(cpl_smoother *s, double variance, double cells) {
  const size_t n = (size_t)s->mesh->cells;
  int status = count_links(s);
  if (status == PART_OK)
    status = reserve_work(s, 1);
  if (status == PART_OK)
    status = CPL_RESERVE(s->variance, n);
  CPL_ARRAY(int) at = {NULL, 0};
  if (status == PART_OK)
    status = CPL_RESERVE(at, n);
  status = part_agree(s->comm, status);
  if (status == PART_OK) {
    for (size_t c = 0; c < n; c++)
      s->variance.data[c] = cell_variance(s->mesh, (int)c, variance, cells);
    status = exchange(s, 1, s->variance.data, s->now.data);
  }
  if (status == PART_OK) {
    make_links(s, at.data, s->now.data);
    status = choose_passes(s);
  }
  CPL_FREE(at);
  return part_agree(s->comm, status);
}

int cpl_smoother_create(MPI_Comm comm, const cpl_mesh *mesh, double variance, double cells,
                        cpl_smoother **smoother) {
  cpl_smoother *s = calloc(1, sizeof *s);
  PART_TRY(part_agree(
      comm, s ? PART_OK : part_fail(PART_ERR_MEMORY, "coupling: no memory for the smoothing")));
  s->comm = comm;
  MPI_Comm_size(comm, &s->size);
  s->mesh = mesh;
  const int status = build(s, variance, cells);
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
  CPL_FREE(s->start);
  CPL_FREE(s->link);
  CPL_FREE(s->share);
  CPL_FREE(s->variance);
  CPL_FREE(s->now);
  CPL_FREE(s->next);
  CPL_FREE(s->sent);
  free(s);
}

int cpl_smoother_passes(const cpl_smoother *s) {
  return s->passes;
}

const double *cpl_smoother_variance(const cpl_smoother *s) {
  return s->variance.data;
}

/* ---- apply ---------------------------------------------------------------------------------- */
static inline __attribute__((always_inline)) void
pass(const cpl_smoother *s, size_t n, const double *restrict now, double *restrict next) {
  const int *start = s->start.data, *link = s->link.data;
  const double *share = s->share.data;
  for (size_t c = 0; c < (size_t)s->mesh->cells; c++) {
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
  const size_t width = (size_t)n, own = (size_t)s->mesh->cells * width;
  int status = n <= 16 ? reserve_work(s, width)
                       : part_fail(PART_ERR_ARGUMENT, "coupling: smoothing of %d components", n);
  if (s->size > 1)
    status = part_agree(s->comm, status);
  PART_TRY(status);
  if (own > 0)
    memcpy(s->now.data, density, own * sizeof *density);
  double *now = s->now.data, *next = s->next.data;
  for (int k = 0; k < s->passes; k++) {
    PART_TRY(exchange(s, n, now, now + own));
    pass_n(s, width, now, next);
    double *swap = now;
    now = next;
    next = swap;
  }
  if (own > 0)
    memcpy(density, now, own * sizeof *density);
  return PART_OK;
}
