/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "weights.h"
#include <math.h>
#include <string.h>
#include "memory.h"
#include "overlap_methods.h"
#include "rendezvous.h"
#include "smoothing.h"
#include "sphere.h"
#include "void_fractions.h"

/* Overlaps below this part of the sphere are round-off of the geometry (measured <= 1e-14): such a
 * cell would get a momentum exchange that is nothing but noise. */
static const double NOISE = 1e-14;

struct cpl_weights {
  MPI_Comm comm;
  int size;
  const cpl_mesh *mesh;
  cpl_search *search;
  int method, sub_cells;
  cpl_rendezvous *rendezvous;
  int count;            /* own particles */
  int rows;             /* received visits */
  cpl_overlaps list;    /* volumes, then weights, of all rows */
  CPL_ARRAY(int) start; /* [rows] into list */
  CPL_ARRAY(int) length;
  CPL_ARRAY(int) hint;
  int hints;
  CPL_ARRAY(double) row_value; /* of received visits */
  CPL_ARRAY(double) own_value; /* of own visits */
  CPL_ARRAY(double) total;     /* [count] volume in all cells */
  CPL_ARRAY(int) winner;       /* [count] own visit that keeps a tied centre */
};

int cpl_weights_create(MPI_Comm comm, const cpl_mesh *mesh, cpl_search *search, const part_box *box,
                       const cpl_params *params, cpl_weights **weights) {
  cpl_weights *w = calloc(1, sizeof *w);
  int status = w ? PART_OK : part_fail(PART_ERR_MEMORY, "coupling: no memory for the weights");
  PART_TRY(part_agree(comm, status));
  w->comm = comm;
  MPI_Comm_size(comm, &w->size);
  w->mesh = mesh;
  w->search = search;
  w->method = params->void_fraction;
  w->sub_cells = (int)params->sub_cells;
  const double reach =
      w->method == CPL_VOID_FRACTION_kernel ? cpl_kernel_reach(params->bandwidth) : 1.0;
  cpl_search_set_reach(search, reach);
  status = cpl_rendezvous_create(comm, mesh->cells, search, box, fmax(reach, 1.0), &w->rendezvous);
  if (status != PART_OK) {
    cpl_weights_destroy(w);
    return status;
  }
  *weights = w;
  return PART_OK;
}

void cpl_weights_destroy(cpl_weights *w) {
  if (!w)
    return;
  cpl_rendezvous_destroy(w->rendezvous);
  cpl_overlaps_free(&w->list);
  CPL_FREE(w->start);
  CPL_FREE(w->length);
  CPL_FREE(w->hint);
  CPL_FREE(w->row_value);
  CPL_FREE(w->own_value);
  CPL_FREE(w->total);
  CPL_FREE(w->winner);
  free(w);
}

static int agree(const cpl_weights *w, int status) {
  return w->size > 1 ? part_agree(w->comm, status) : status;
}

/* ---- rows ----------------------------------------------------------------------------------- */
/* Row k by a method, appended to the list; its volume to row_value[k * stride]. */
static int make_row(cpl_weights *w, int method, int k, int stride) {
  const double *sphere = cpl_rendezvous_spheres(w->rendezvous) + 4 * (size_t)k;
  /* a bell has no edges that round-off could move */
  const double smallest =
      method == CPL_VOID_FRACTION_kernel ? 0.0 : NOISE * cpl_sphere_volume(sphere[3]);
  const int first = w->list.count;
  w->start.data[k] = first;
  w->length.data[k] = 0;
  w->row_value.data[(size_t)k * (size_t)stride] = 0.0;
  if (w->mesh->cells == 0)
    return PART_OK;
  PART_TRY(
      cpl_overlap(method, w->search, w->sub_cells, sphere, sphere[3], &w->hint.data[k], &w->list));
  double sum = 0.0;
  int n = first;
  for (int j = first; j < w->list.count; j++) {
    if (!(w->list.volume[j] > smallest))
      continue;
    w->list.cell[n] = w->list.cell[j];
    w->list.volume[n++] = w->list.volume[j];
    sum += w->list.volume[j];
  }
  w->list.count = n;
  w->length.data[k] = n - first;
  w->row_value.data[(size_t)k * (size_t)stride] = sum;
  return PART_OK;
}

/* Room for the rows and, per visit, `width` doubles on both sides. Cells found for the rows of the
 * last time are kept as hints: particles move little between two calls. */
static int reserve(cpl_weights *w, int width) {
  const int sent = cpl_rendezvous_sent(w->rendezvous);
  w->rows = cpl_rendezvous_received(w->rendezvous);
  w->list.count = 0;
  PART_TRY(CPL_RESERVE(w->start, w->rows));
  PART_TRY(CPL_RESERVE(w->length, w->rows));
  PART_TRY(CPL_RESERVE(w->hint, w->rows));
  PART_TRY(CPL_RESERVE(w->row_value, (size_t)w->rows * (size_t)width));
  PART_TRY(CPL_RESERVE(w->own_value, (size_t)sent * (size_t)width));
  PART_TRY(CPL_RESERVE(w->total, w->count));
  for (; w->hints < w->rows; w->hints++)
    w->hint.data[w->hints] = -1;
  return PART_OK;
}

/* total[i] = volume of particle i in all cells, from one volume per own visit. *lost: particles of
 * all ranks that have none. */
static int add_volumes(cpl_weights *w, const double *volume, int stride, long long *lost) {
  const int *particle = cpl_rendezvous_particle(w->rendezvous);
  const int sent = cpl_rendezvous_sent(w->rendezvous);
  for (int i = 0; i < w->count; i++)
    w->total.data[i] = 0.0;
  for (int k = 0; k < sent; k++)
    w->total.data[particle[k]] += volume[(size_t)k * (size_t)stride];
  *lost = 0;
  for (int i = 0; i < w->count; i++)
    *lost += w->total.data[i] <= 0.0;
  if (w->size > 1) {
    const long long mine = *lost;
    MPI_Allreduce(&mine, lost, 1, MPI_LONG_LONG, MPI_SUM, w->comm);
  }
  return PART_OK;
}

/* ---- the method centre: one cell only ------------------------------------------------------- */
/* (z, y, x) of cell centres: the order of cell numbers in a block mesh, and the same on any
 * decomposition. */
static int before(const double *a, const double *b) {
  for (int k = 2; k >= 0; k--)
    if (a[k] < b[k] || a[k] > b[k])
      return a[k] < b[k];
  return 0;
}

/* A centre exactly on a face between two ranks, or on a periodic border, is found on both sides:
 * keep the first cell in the order above. item[visit]: volume, cell centre. */
static int break_ties(cpl_weights *w, double *item) {
  const int *particle = cpl_rendezvous_particle(w->rendezvous);
  const int sent = cpl_rendezvous_sent(w->rendezvous);
  PART_TRY(CPL_RESERVE(w->winner, w->count));
  for (int i = 0; i < w->count; i++)
    w->winner.data[i] = -1;
  for (int k = 0; k < sent; k++) {
    double *mine = item + 4 * (size_t)k;
    if (mine[0] <= 0.0)
      continue;
    int *winner = &w->winner.data[particle[k]];
    if (*winner >= 0) {
      double *other = item + 4 * (size_t)*winner;
      if (!before(mine + 1, other + 1)) {
        mine[0] = 0.0;
        continue;
      }
      other[0] = 0.0;
    }
    *winner = k;
  }
  return PART_OK;
}

static void add_cell_centres(cpl_weights *w) {
  for (int k = 0; k < w->rows; k++) {
    double *item = w->row_value.data + 4 * (size_t)k;
    item[1] = item[2] = item[3] = 0.0;
    if (w->length.data[k] > 0)
      memcpy(item + 1, w->mesh->cell_centre + 3 * (size_t)w->list.cell[w->start.data[k]],
             3 * sizeof *item);
  }
}

/* ---- locate --------------------------------------------------------------------------------- */
/* Rows by the chosen method; own_value[visit][width] = its volume first. */
static int first_rows(cpl_weights *w, int width) {
  int status = reserve(w, width);
  for (int k = 0; status == PART_OK && k < w->rows; k++)
    status = make_row(w, w->method, k, width);
  PART_TRY(agree(w, status));
  if (width == 4)
    add_cell_centres(w);
  PART_TRY(
      cpl_rendezvous_reverse_visits(w->rendezvous, width, w->row_value.data, w->own_value.data));
  if (width == 4)
    PART_TRY(agree(w, break_ties(w, w->own_value.data)));
  for (int k = 1; width > 1 && k < cpl_rendezvous_sent(w->rendezvous); k++)
    w->own_value.data[k] = w->own_value.data[(size_t)k * (size_t)width];
  return PART_OK;
}

/* Spheres that the chosen method finds in no cell (no sub-cell centre inside a tiny sphere; a
 * centre on a wall or a little beyond it) are divided exactly. */
static int rescue(cpl_weights *w) {
  const int *particle = cpl_rendezvous_particle(w->rendezvous);
  for (int k = 0; k < cpl_rendezvous_sent(w->rendezvous); k++)
    w->own_value.data[k] = w->total.data[particle[k]] <= 0.0 ? -1.0 : w->own_value.data[k];
  PART_TRY(cpl_rendezvous_forward_visits(w->rendezvous, 1, w->own_value.data, w->row_value.data));
  int status = PART_OK;
  for (int k = 0; status == PART_OK && k < w->rows; k++)
    if (w->row_value.data[k] < 0.0)
      status = make_row(w, CPL_VOID_FRACTION_exact, k, 1);
  PART_TRY(agree(w, status));
  return cpl_rendezvous_reverse_visits(w->rendezvous, 1, w->row_value.data, w->own_value.data);
}

static int outside(const cpl_weights *w, const cpl_particles *p) {
  for (int i = 0; i < w->count; i++) {
    if (w->total.data[i] > 0.0)
      continue;
    const double *x = p->position + (size_t)i * (size_t)p->position_stride;
    return part_fail(PART_ERR_OUTSIDE,
                     "coupling: particle %lld at (%g %g %g) m with radius %g m is in no cell of "
                     "the mesh",
                     (long long)p->id[(size_t)i * (size_t)p->id_stride], x[0], x[1], x[2],
                     p->radius[(size_t)i * (size_t)p->radius_stride]);
  }
  return PART_OK;
}

/* Divide every row by the volume of its particle; own_value[visit] = volume of the visit. Then
 * forget the visits that found nothing. */
static int normalise(cpl_weights *w) {
  const int *particle = cpl_rendezvous_particle(w->rendezvous);
  for (int k = 0; k < cpl_rendezvous_sent(w->rendezvous); k++)
    w->own_value.data[k] = w->own_value.data[k] > 0.0 ? 1.0 / w->total.data[particle[k]] : 0.0;
  PART_TRY(cpl_rendezvous_forward_visits(w->rendezvous, 1, w->own_value.data, w->row_value.data));
  for (int k = 0; k < w->rows; k++) {
    const double scale = w->row_value.data[k];
    if (scale == 0.0)
      w->length.data[k] = 0;
    for (int j = 0; j < w->length.data[k]; j++)
      w->list.volume[w->start.data[k] + j] *= scale;
  }
  int dropped;
  PART_TRY(cpl_rendezvous_drop(w->rendezvous, w->own_value.data, w->row_value.data, &dropped));
  if (!dropped)
    return PART_OK;
  const int rows = w->rows;
  w->rows = cpl_rendezvous_own(w->rendezvous); /* rows of own visits stay, empty or not */
  for (int k = w->rows; k < rows; k++)
    if (w->row_value.data[k] != 0.0) {
      w->start.data[w->rows] = w->start.data[k];
      w->length.data[w->rows++] = w->length.data[k];
    }
  return PART_OK;
}

int cpl_weights_locate(cpl_weights *w, const cpl_particles *p) {
  w->rows = 0;
  w->count = p->count;
  PART_TRY(agree(w, cpl_rendezvous_visits(w->rendezvous, p)));
  PART_TRY(cpl_rendezvous_send(w->rendezvous));
  PART_TRY(first_rows(w, w->method == CPL_VOID_FRACTION_centre ? 4 : 1));
  long long lost;
  PART_TRY(add_volumes(w, w->own_value.data, 1, &lost));
  if (lost > 0) {
    PART_TRY(rescue(w));
    PART_TRY(add_volumes(w, w->own_value.data, 1, &lost));
  }
  PART_TRY(lost > 0 ? agree(w, outside(w, p)) : PART_OK);
  return normalise(w);
}

/* ---- deposit and sample: stamped for the numbers of components in use ------------------------ */
static inline __attribute__((always_inline)) void
deposit_rows(const cpl_weights *w, size_t n, const cpl_visit_range *range, double *cell) {
  for (int k = 0; k < range->count; k++) {
    const double *value = range->at + (size_t)(range->index ? range->index[k] : k) * n;
    const int first = w->start.data[range->first + k], length = w->length.data[range->first + k];
    for (int j = first; j < first + length; j++)
      for (size_t d = 0; d < n; d++)
        cell[(size_t)w->list.cell[j] * n + d] += w->list.volume[j] * value[d];
  }
}

static inline __attribute__((always_inline)) void
sample_rows(const cpl_weights *w, size_t n, const double *cell, const cpl_visit_range *range) {
  for (int k = 0; k < range->count; k++) {
    double *sum = range->at + (size_t)(range->index ? range->index[k] : k) * n;
    const int first = w->start.data[range->first + k], length = w->length.data[range->first + k];
    for (int j = first; j < first + length; j++)
      for (size_t d = 0; d < n; d++)
        sum[d] += w->list.volume[j] * cell[(size_t)w->list.cell[j] * n + d];
  }
}

static void moment_rows(const cpl_weights *w, const double *shape, const cpl_visit_range *range) {
  for (int k = 0; k < range->count; k++) {
    double *sum = range->at + (size_t)(range->index ? range->index[k] : k) * CPL_MOMENTS;
    const double *x = cpl_rendezvous_spheres(w->rendezvous) + 4 * (size_t)(range->first + k);
    const int first = w->start.data[range->first + k], length = w->length.data[range->first + k];
    for (int j = first; j < first + length; j++) {
      const double *c = w->mesh->cell_centre + 3 * (size_t)w->list.cell[j];
      const double *kernel = shape + CPL_SHAPE * (size_t)w->list.cell[j];
      const double weight = w->list.volume[j];
      for (int d = 0; d < 3; d++) {
        const double y = c[d] + kernel[d] - x[d];
        sum[d] += weight * y;
        sum[3] += weight * y * y;
      }
      sum[4] += weight * kernel[3];
      sum[5] += weight * kernel[4];
    }
  }
}

int cpl_weights_moments(cpl_weights *w, const double *shape, double *moment) {
  cpl_visit_range range[2];
  PART_TRY(cpl_rendezvous_begin(w->rendezvous, CPL_MOMENTS, w->count, moment, range));
  for (int k = 0; k < 2; k++)
    moment_rows(w, shape, &range[k]);
  return cpl_rendezvous_end(w->rendezvous, CPL_MOMENTS, moment);
}

/* ROW with a constant width, so that its innermost loop is unrolled. */
#define STAMPED(width)                                                                             \
  case width:                                                                                      \
    ROW(width);                                                                                    \
    break;
#define STAMPED_WIDTHS STAMPED(1) STAMPED(3) STAMPED(4) STAMPED(6) STAMPED(7) STAMPED(10)

int cpl_weights_deposit(cpl_weights *w, int n, const double *value, double *cell) {
  cpl_visit_range range[2];
  PART_TRY(cpl_rendezvous_forward(w->rendezvous, n, value, range));
#define ROW(width) deposit_rows(w, (size_t)(width), &range[k], cell)
  for (int k = 0; k < 2; k++)
    switch (n) {
      STAMPED_WIDTHS
    default:
      ROW(n);
    }
#undef ROW
  return PART_OK;
}

int cpl_weights_sample(cpl_weights *w, int n, const double *cell, double *value) {
  cpl_visit_range range[2];
  PART_TRY(cpl_rendezvous_begin(w->rendezvous, n, w->count, value, range));
#define ROW(width) sample_rows(w, (size_t)(width), cell, &range[k])
  for (int k = 0; k < 2; k++)
    switch (n) {
      STAMPED_WIDTHS
    default:
      ROW(n);
    }
#undef ROW
  return cpl_rendezvous_end(w->rendezvous, n, value);
}
