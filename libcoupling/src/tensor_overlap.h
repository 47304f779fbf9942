/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef COUPLING_TENSOR_OVERLAP_H
#define COUPLING_TENSOR_OVERLAP_H

#include "overlaps.h"
#include "tensor_grid.h"

/* As cpl_overlap_exact, the centre's cell aside. */
int cpl_tensor_overlap(cpl_tensor *t, const double *cell_volume, const double centre[3],
                       double radius, cpl_overlaps *list);

#endif
