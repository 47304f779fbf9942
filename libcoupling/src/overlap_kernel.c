/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A bell around the centre of the sphere, K(xi) = (1 - xi^2)^4 with xi = r/w, at the centres of the
 * cells (Gao and Sun 2011, eq. 24): close to exp(-(r/(0.45 w))^2), so w = b/0.45 for the bandwidth b.
 * Each cell gets K times its volume of it; the caller divides by the sum over all cells, so that
 * every sphere leaves exactly its volume. (Their eq. 23 divides by the sum over particles, which does
 * not conserve volume.) A sphere with no centre of a cell within w is divided exactly. */
#include "overlap_methods.h"
#include "search_type.h"

double cpl_kernel_reach(double bandwidth) {
  return 2.0 * bandwidth / 0.45; /* w over the radius; b is given in diameters */
}

int cpl_overlap_kernel(cpl_search *search, int sub_cells, const double centre[3], double radius,
                       int *hint, cpl_overlaps *list) {
  (void)sub_cells;
  (void)hint;
  const double w = search->kernel_reach * radius;
  int status = PART_OK;
  cpl_search_queue_touching(search, centre, w, 0);
  for (int q = 0; q < search->queued && status == PART_OK; q++) {
    const int cell = search->queue[q];
    const double *x = search->mesh->cell_centre + 3 * (size_t)cell;
    double xi2 = 0.0;
    for (int d = 0; d < 3; d++)
      xi2 += (x[d] - centre[d]) * (x[d] - centre[d]) / (w * w);
    if (xi2 >= 1.0)
      continue;
    const double k = (1.0 - xi2) * (1.0 - xi2);
    status = cpl_overlaps_add(list, cell, k * k * search->mesh->volume[cell]);
  }
  cpl_search_done(search);
  return status;
}
