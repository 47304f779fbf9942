/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "exchange.h"
#include <math.h>
#include <string.h>

int cpl_update_smoothing(cpl_t *cpl) {
  if (!cpl->params.smoothing)
    return PART_OK;
  double radius = 0.0;
  for (size_t i = 0; i < (size_t)cpl->count; i++)
    radius = fmax(radius, cpl->sphere.data[4 * i + 3]);
  if (cpl->size > 1)
    MPI_Allreduce(MPI_IN_PLACE, &radius, 1, MPI_DOUBLE, MPI_MAX, cpl->comm);
  if (cpl->smoother && !(radius > cpl->smoothed_radius || radius < cpl->smoothed_radius))
    return PART_OK;
  cpl_smoother_destroy(cpl->smoother);
  cpl->smoother = NULL;
  cpl->smoothed_radius = radius;
  /* kernel exp(-r^2/b^2): variance b^2/2 per axis */
  const double b = cpl->params.bandwidth * 2.0 * radius;
  const double cells = cpl->params.bandwidth_cells * sqrt(0.5);
  return cpl_smoother_create(cpl->comm, &cpl->mesh, 0.5 * b * b, cells, &cpl->smoother);
}

static int relieved(const cpl_t *cpl) {
  return cpl->relief && cpl_relief_passes(cpl->relief) > 0;
}

/* R S of density[cells][n]; backwards: S R^T. */
static int kernel(cpl_t *cpl, int n, int backwards, double *density) {
  if (relieved(cpl) && backwards)
    PART_TRY(cpl_relief_apply(cpl->relief, n, 1, density));
  if (cpl->smoother)
    PART_TRY(cpl_smoother_apply(cpl->smoother, n, density));
  return relieved(cpl) && !backwards ? cpl_relief_apply(cpl->relief, n, 0, density) : PART_OK;
}

int cpl_spread(cpl_t *cpl, int n, const double *value, double *cell) {
  if (!cpl->smoother && !relieved(cpl))
    return cpl_weights_deposit(cpl->weights, n, value, cell);
  const size_t cells = (size_t)cpl->mesh.cells, width = (size_t)n;
  PART_TRY(cpl_agree(cpl, CPL_RESERVE(cpl->smooth_work, cells * width)));
  double *density = cpl->smooth_work.data;
  memset(density, 0, cells * width * sizeof *density);
  PART_TRY(cpl_weights_deposit(cpl->weights, n, value, density));
  for (size_t c = 0; c < cells; c++)
    for (size_t d = 0; d < width; d++)
      density[c * width + d] /= cpl->mesh.volume[c];
  PART_TRY(kernel(cpl, n, 0, density));
  for (size_t c = 0; c < cells; c++)
    for (size_t d = 0; d < width; d++)
      cell[c * width + d] += cpl->mesh.volume[c] * density[c * width + d];
  return PART_OK;
}

int cpl_gather(cpl_t *cpl, int n, const double *cell, double *value) {
  if (!cpl->smoother && !relieved(cpl))
    return cpl_weights_sample(cpl->weights, n, cell, value);
  const size_t size = (size_t)cpl->mesh.cells * (size_t)n;
  PART_TRY(cpl_agree(cpl, CPL_RESERVE(cpl->smooth_work, size)));
  if (size > 0)
    memcpy(cpl->smooth_work.data, cell, size * sizeof *cell);
  PART_TRY(kernel(cpl, n, 1, cpl->smooth_work.data));
  return cpl_weights_sample(cpl->weights, n, cpl->smooth_work.data, value);
}

int cpl_relieve(cpl_t *cpl, double *solid) {
  if (!cpl->relief)
    return PART_OK;
  const size_t cells = (size_t)cpl->mesh.cells;
  PART_TRY(cpl_agree(cpl, CPL_RESERVE(cpl->smooth_work, cells)));
  double *fill = cpl->smooth_work.data;
  for (size_t c = 0; c < cells; c++)
    fill[c] = solid[c] / cpl->mesh.volume[c];
  PART_TRY(cpl_relief_find(cpl->relief, 1.0 - cpl->params.minimum_eps, fill));
  for (size_t c = 0; relieved(cpl) && c < cells; c++)
    solid[c] = cpl->mesh.volume[c] * fill[c];
  return PART_OK;
}
