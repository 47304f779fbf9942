/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "links.h"
#include <math.h>
#include <string.h>

void cpl_face_area(const cpl_mesh *mesh, int f, double area[3]) {
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
  cpl_face_area(mesh, f, area);
  for (int d = 0; d < 3; d++) {
    const double x = nei[d] - own[d];
    along += area[d] * x;
    length2 += x * x;
  }
  return length2 > 0.0 ? fmax(along / length2, 0.0) : 0.0;
}

static int count_links(cpl_links *l) {
  const cpl_mesh *mesh = l->mesh;
  const size_t cells = (size_t)mesh->cells;
  PART_TRY(CPL_RESERVE(l->start, cells + 1));
  int *start = l->start.data;
  memset(start, 0, (cells + 1) * sizeof *start);
  for (int f = 0; f < mesh->internal; f++) {
    start[mesh->owner[f] + 1]++;
    start[mesh->neighbour[f] + 1]++;
  }
  for (int k = 0; k < l->halo; k++)
    start[mesh->coupled->cell[k] + 1]++;
  for (size_t c = 0; c < cells; c++)
    start[c + 1] += start[c];
  PART_TRY(CPL_RESERVE(l->link, start[cells]));
  return CPL_RESERVE(l->conductance, start[cells]);
}

static void add_link(cpl_links *l, int *at, int cell, int other, double value) {
  l->link.data[at[cell]] = other;
  l->conductance.data[at[cell]++] = value;
}

int cpl_links_make(const cpl_mesh *mesh, cpl_links *l) {
  l->mesh = mesh;
  l->halo = mesh->coupled ? mesh->coupled->count : 0;
  PART_TRY(count_links(l));
  CPL_ARRAY(int) at = {NULL, 0};
  PART_TRY(CPL_RESERVE(at, mesh->cells));
  memcpy(at.data, l->start.data, (size_t)mesh->cells * sizeof *at.data);
  for (int f = 0; f < mesh->internal; f++) {
    const double value = conductance(mesh, f);
    add_link(l, at.data, mesh->owner[f], mesh->neighbour[f], value);
    add_link(l, at.data, mesh->neighbour[f], mesh->owner[f], value);
  }
  for (int k = 0; k < l->halo; k++)
    add_link(l, at.data, mesh->coupled->cell[k], mesh->cells + k, mesh->coupled->conductance[k]);
  CPL_FREE(at);
  return PART_OK;
}

void cpl_links_free(cpl_links *l) {
  CPL_FREE(l->start);
  CPL_FREE(l->link);
  CPL_FREE(l->conductance);
  CPL_FREE(l->sent);
}

int cpl_links_exchange(cpl_links *l, int n, const double *cell, double *other) {
  const cpl_coupled_faces *coupled = l->mesh->coupled;
  if (!coupled)
    return PART_OK;
  const size_t width = (size_t)n;
  PART_TRY(CPL_RESERVE(l->sent, (size_t)l->halo * width));
  for (int k = 0; k < l->halo; k++)
    memcpy(l->sent.data + (size_t)k * width, cell + (size_t)coupled->cell[k] * width,
           width * sizeof *cell);
  return coupled->exchange(coupled->context, n, l->sent.data, other);
}
