/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Mean over a sphere of a radial kernel W about a point at the distance s from the sphere's centre:
 *   K(s; R) = (1/V) integral over q of W(q) 4 pi q^2 f dq,
 * with f the part of the shell of radius q about the point that is inside the sphere (P.2). Tabulated in s^2
 * and, where radii differ, in R^2; linear between nodes. In s^2 and R^2 because K is even in both; a mixture of
 * rows keeps the integral of K, which is 1. */
#ifndef COUPLING_POINTS_TABLE_H
#define COUPLING_POINTS_TABLE_H

#include "coupling/points.h"
#include "memory.h"

enum { POINTS_NODES = 4096, POINTS_ROWS = 33 };

typedef struct cpl_points_table_data {
  int rows;                    /* 0: not made yet */
  double least, most;          /* m, radii */
  double per_s2, per_r2, end2; /* nodes per m2; rows per m2; (support + most)^2 */
  CPL_ARRAY(double) value;     /* [rows][POINTS_NODES + 2], 1/m3 */
} cpl_points_table_data;

/* Local. For radii from least to most; exact: 0 takes W at the centre of the sphere. */
int points_table_make(cpl_points_table_data *table, const cpl_points_kernel *kernel, double least,
                      double most, int exact);
/* The exact value by quadrature. */
double points_sphere_mean(const cpl_points_kernel *kernel, double s, double radius);

/* Row of a radius, and the share of the next one. */
static inline const double *points_table_row(const cpl_points_table_data *t, double radius,
                                             double *share) {
  double at = t->rows > 1 ? (radius * radius - t->least * t->least) * t->per_r2 : 0.0;
  at = at > 0.0 ? at : 0.0;
  int row = (int)at;
  if (row > t->rows - 2)
    row = t->rows > 1 ? t->rows - 2 : 0;
  *share = t->rows > 1 ? at - (double)row : 0.0;
  return t->value.data + (size_t)row * (POINTS_NODES + 2);
}

static inline double points_table_at(const double *row, double share, double position) {
  const int k = (int)position;
  const double part = position - (double)k;
  const double here = row[k] + part * (row[k + 1] - row[k]);
  if (share == 0.0)
    return here;
  const double *next = row + POINTS_NODES + 2;
  return here + share * (next[k] + part * (next[k + 1] - next[k]) - here);
}

/* Its derivative by s^2, 1/m5: exactly that of the function above. */
static inline double points_table_slope(const cpl_points_table_data *t, const double *row, double share,
                                        double position) {
  const int k = (int)position;
  const double *next = row + POINTS_NODES + 2;
  const double here = row[k + 1] - row[k];
  return t->per_s2 * (share == 0.0 ? here : here + share * (next[k + 1] - next[k] - here));
}

#endif
