/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cyclic_mesh.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "particle/status.h"

static int swap(void *context, int n, const double *own, double *other) {
  const cyclic_mesh *c = context;
  for (int k = 0; k < c->coupled.count; k++)
    memcpy(other + (size_t)k * (size_t)n, own + (size_t)c->partner[k] * (size_t)n,
           (size_t)n * sizeof *own);
  return PART_OK;
}

void cyclic_make(cyclic_mesh *c, int n) {
  const mesh_options options = MESH_UNIT(MESH_HEX, n, n, n);
  mesh_make(&options, &c->mesh);
  const cpl_mesh *m = &c->mesh.view;
  const int count = m->faces - m->internal;
  c->cell = mesh_alloc((size_t)count, sizeof *c->cell);
  c->partner = mesh_alloc((size_t)count, sizeof *c->partner);
  c->conductance = mesh_alloc((size_t)count, sizeof *c->conductance);
  c->way = mesh_alloc(3 * (size_t)count, sizeof *c->way);
  for (int k = 0; k < count; k++) {
    const double *x = m->face_centre + 3 * (size_t)(m->internal + k);
    c->cell[k] = m->owner[m->internal + k];
    c->conductance[k] = 1.0 / n;
    for (int d = 0; d < 3; d++) /* twice the way from the cell to the face */
      c->way[3 * k + d] = 2.0 * (x[d] - m->cell_centre[3 * (size_t)c->cell[k] + (size_t)d]);
    for (int l = 0; l < count; l++) {
      const double *y = m->face_centre + 3 * (size_t)(m->internal + l);
      double apart = 0.0;
      for (int d = 0; d < 3; d++)
        apart += fabs(fabs(x[d] - y[d]) - (fabs(x[d] - 0.5) > 0.5 - 1e-9 ? 1.0 : 0.0));
      if (apart < 1e-9)
        c->partner[k] = l;
    }
  }
  c->coupled = (cpl_coupled_faces){count, c->cell, c->conductance, c->way, swap, c};
  c->mesh.view.coupled = &c->coupled;
}

void cyclic_free(cyclic_mesh *c) {
  free(c->cell);
  free(c->partner);
  free(c->conductance);
  free(c->way);
  mesh_free(&c->mesh);
}
