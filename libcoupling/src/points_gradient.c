/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gradient of the discrete porosity at the points (P.12): that of the tabulated K itself, so that eps and its gradient
 * belong to the same function of the place. */
#include "points_type.h"

static double *gradient_of(const cpl_fluid_points *fluid, int a) {
  return fluid->eps_gradient + (size_t)a * (size_t)fluid->eps_gradient_stride;
}

/* sum_i V_i grad K_ia */
static void add_visit(const cpl_points_t *p, int k, const cpl_fluid_points *fluid) {
  const cpl_points_visit *v = p->visit.data + k;
  const double volume = points_sphere_volume(v->radius);
  double share;
  const double *row = points_table_row(&p->table, v->radius, &share);
  for (size_t q = p->start.data[k]; q < p->start.data[k + 1]; q++) {
    const int a = p->partner.data[q];
    const double *x = points_at(fluid->position, fluid->position_stride, a);
    const double d[3] = {x[0] - v->x[0], x[1] - v->x[1], x[2] - v->x[2]};
    const double s2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    const double slope = points_table_slope(&p->table, row, share, s2 * p->table.per_s2);
    double *to = gradient_of(fluid, a);
    for (int c = 0; c < 3; c++)
      to[c] += volume * 2.0 * slope * d[c];
  }
}

/* Of Gamma, which is a function of the place alone that whoever couples has given: central differences. */
static double gamma_slope(const cpl_points_t *p, const double *x, int c) {
  const double step = 1e-4 * p->kernel.support;
  double lo[3] = {x[0], x[1], x[2]}, hi[3] = {x[0], x[1], x[2]};
  lo[c] -= step;
  hi[c] += step;
  return (points_inside(p, hi) - points_inside(p, lo)) / (2.0 * step);
}

void points_eps_gradient(const cpl_points_t *p, cpl_fluid_points *fluid) {
  for (int a = 0; a < p->points; a++)
    memset(gradient_of(fluid, a), 0, 3 * sizeof(double));
  for (int k = 0; k < p->received; k++)
    add_visit(p, k, fluid);
  for (int a = 0; a < p->points; a++) {
    const double *x = points_at(fluid->position, fluid->position_stride, a);
    const double solid = p->solid.data[a], gamma = points_inside(p, x);
    double *to = gradient_of(fluid, a);
    for (int c = 0; c < 3; c++) {
      to[c] *= -1.0 / gamma;
      if (p->kernel.gamma && solid > 0.0)
        to[c] += solid / (gamma * gamma) * gamma_slope(p, x, c);
    }
  }
}
