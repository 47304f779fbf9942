/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cells that are the boxes between three lists of planes (uniform or graded; some may be missing,
 * as on a rank of a decomposed mesh): cells are found by index, overlaps in closed form. */
#ifndef COUPLING_TENSOR_GRID_H
#define COUPLING_TENSOR_GRID_H

#include "search_type.h"

struct cpl_tensor {
  int n[3];      /* slabs */
  double *x[3];  /* [n + 1] planes, ascending */
  int *start[3]; /* [n] slab that contains the beginning of the i-th n-th of the length */
  double inverse[3];
  int *cell;    /* [n2][n1][n0], -1: none */
  double *work; /* tables of a sphere that cuts many planes */
  size_t work_size;
};

/* *tensor = NULL when the cells are not such a grid. Needs s->bound and s->is_box. */
int cpl_tensor_create(const cpl_search *s, cpl_tensor **tensor);
void cpl_tensor_destroy(cpl_tensor *tensor);

/* Slab i with x[i] <= v < x[i + 1] of direction d; -1 below all, n above. */
int cpl_tensor_slab(const cpl_tensor *t, int d, double v);

/* As cpl_search_cell. */
int cpl_tensor_cell(const cpl_tensor *t, const double x[3], double tie);

#endif
