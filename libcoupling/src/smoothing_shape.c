/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Moments of the kernel of each cell. A pass is a step of a random walk from cell to cell, so the
 * moments after k + 1 passes are those after k passes from each neighbour, moved by the way to it:
 * nine numbers a cell through the passes, and no kernel has to be written down. */
#include <math.h>
#include <string.h>
#include "smoothing_type.h"

static const double PI = 3.14159265358979323846;

enum { MOMENTS = 9 }; /* <x>, <xx> <yy> <zz> <xy> <xz> <yz> of the way x from the cell */
static const int FIRST[6] = {0, 1, 2, 0, 0, 1}, SECOND[6] = {0, 1, 2, 1, 2, 2};

static void way_to(const cpl_mesh *mesh, int c, int other, double d[3]) {
  const double *from = mesh->cell_centre + 3 * (size_t)c;
  for (int a = 0; a < 3; a++)
    d[a] = other < mesh->cells ? mesh->cell_centre[3 * (size_t)other + (size_t)a] - from[a]
                               : mesh->coupled->way[3 * (size_t)(other - mesh->cells) + (size_t)a];
}

static void step(const cpl_smoother *s, const double *now, double *next) {
  const cpl_mesh *mesh = s->links.mesh;
  for (int c = 0; c < mesh->cells; c++) {
    const double *mine = now + MOMENTS * (size_t)c;
    double *sum = next + MOMENTS * (size_t)c, d[3];
    memcpy(sum, mine, MOMENTS * sizeof *sum);
    for (int k = s->links.start.data[c]; k < s->links.start.data[c + 1]; k++) {
      const int other = s->links.link.data[k];
      const double *there = now + MOMENTS * (size_t)other, share = s->share.data[k];
      way_to(mesh, c, other, d);
      for (int a = 0; a < 3; a++)
        sum[a] += share * (there[a] + d[a] - mine[a]);
      for (int p = 0; p < 6; p++) {
        const int a = FIRST[p], b = SECOND[p];
        sum[3 + p] +=
            share * (there[3 + p] + d[a] * there[b] + there[a] * d[b] + d[a] * d[b] - mine[3 + p]);
      }
    }
  }
}

/* extent[cells][3]: what of a box of this volume and these areas would be its edges. */
static void add_areas(const cpl_mesh *mesh, double *extent) {
  memset(extent, 0, 3 * (size_t)mesh->cells * sizeof *extent);
  for (int f = 0; f < mesh->faces; f++) {
    double area[3];
    cpl_face_area(mesh, f, area);
    for (size_t a = 0; a < 3; a++) {
      extent[3 * (size_t)mesh->owner[f] + a] += 0.5 * fabs(area[a]);
      if (f < mesh->internal)
        extent[3 * (size_t)mesh->neighbour[f] + a] += 0.5 * fabs(area[a]);
    }
  }
  for (size_t c = 0; c < (size_t)mesh->cells; c++)
    for (size_t a = 0; a < 3; a++)
      extent[3 * c + a] = mesh->volume[c] / extent[3 * c + a];
}

/* Where the kernel is narrower along an axis than its cell (a mesh one cell thick), the density is
 * 1/extent: that of a Gaussian with itself for the variance extent^2/(4 pi). */
static double mean_variance(const double *m, const double extent[3]) {
  double v[6];
  for (int p = 0; p < 6; p++)
    v[p] = m[3 + p] - m[FIRST[p]] * m[SECOND[p]];
  for (int a = 0; a < 3; a++)
    v[a] = fmax(v[a], extent[a] * extent[a] / (4.0 * PI));
  const double det = v[0] * (v[1] * v[2] - v[5] * v[5]) - v[3] * (v[3] * v[2] - v[5] * v[4]) +
                     v[4] * (v[3] * v[5] - v[1] * v[4]);
  return cbrt(fmax(det, 0.0));
}

int cpl_smoother_shape(cpl_smoother *s, const double **shape) {
  const size_t cells = (size_t)s->links.mesh->cells;
  const size_t all = cells + (size_t)s->links.halo;
  if (s->shape.data) {
    *shape = s->shape.data;
    return PART_OK;
  }
  CPL_ARRAY(double) extent = {NULL, 0};
  int status = CPL_RESERVE(s->now, MOMENTS * all);
  if (status == PART_OK)
    status = CPL_RESERVE(s->next, MOMENTS * all);
  if (status == PART_OK)
    status = CPL_RESERVE(s->shape, CPL_SHAPE * cells + 1);
  if (status == PART_OK)
    status = CPL_RESERVE(extent, 3 * cells);
  status = part_agree(s->comm, status);
  double *now = s->now.data, *next = s->next.data;
  if (status == PART_OK)
    memset(now, 0, MOMENTS * all * sizeof *now);
  for (int k = 0; k < s->passes && status == PART_OK; k++) {
    status = cpl_links_exchange(&s->links, MOMENTS, now, now + MOMENTS * cells);
    step(s, now, next);
    double *swap = now;
    now = next;
    next = swap;
  }
  if (status == PART_OK) {
    add_areas(s->links.mesh, extent.data);
    for (size_t c = 0; c < cells; c++) {
      double *to = s->shape.data + CPL_SHAPE * c;
      memcpy(to, now + MOMENTS * c, 3 * sizeof *to);
      to[3] = s->variance.data[c];
      to[4] = mean_variance(now + MOMENTS * c, extent.data + 3 * c);
    }
    *shape = s->shape.data;
  } else {
    CPL_FREE(s->shape);
  }
  CPL_FREE(extent);
  return status;
}
