/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Form pairwise (P.13; Gao and Sun 2011, eq. 36-37): a force between each sphere and each point, and its opposite,
 *
 *   f_ia = 3 beta_i w_ia ((u_a - v_i).n) n - V_i V_a (p_a - p_i) grad_i K_ia,     n along their centres
 */
#include <math.h>
#include "points_type.h"

/* What a visit carries of its sphere, for the drag and for the pressure. */
enum { DRAG = 0, VELOCITY = 1, PRESSURE = 4, VOLUME = 5, CARRIED = 6 };

/* Both from the sphere to the point, of unit length, and 2 dK/ds^2 s. */
static double direction(const cpl_points_t *p, const cpl_points_visit *v, const double *x, double n[3]) {
  double s2 = 0.0, share;
  for (int c = 0; c < 3; c++) {
    n[c] = x[c] - v->x[c];
    s2 += n[c] * n[c];
  }
  const double s = sqrt(s2), *row = points_table_row(&p->table, v->radius, &share);
  for (int c = 0; c < 3; c++)
    n[c] = s > 0.0 ? n[c] / s : 0.0;
  return 2.0 * s * points_table_slope(&p->table, row, share, s2 * p->table.per_s2);
}

/* Force of pair q on the sphere of visit k. */
static void pair_force(const cpl_points_t *p, int k, size_t q, const double *of, const cpl_fluid_points *fluid,
                       double f[3]) {
  const int a = p->partner.data[q];
  const double *u = points_at(fluid->velocity, fluid->velocity_stride, a);
  double n[3], along = 0.0;
  const double slope = direction(p, p->visit.data + k, p->place_at.data + 3 * (size_t)a, n);
  for (int c = 0; c < 3; c++)
    along += (u[c] - of[VELOCITY + c]) * n[c];
  const double push = 3.0 * of[DRAG] * p->weight.data[q] * p->share.data[a] * along +
                      of[VOLUME] * p->share.data[a] *
                          (*points_at(fluid->pressure, fluid->pressure_stride, a) - of[PRESSURE]) * slope;
  for (int c = 0; c < 3; c++)
    f[c] = push * n[c];
}

int points_pairwise_force(cpl_points_t *p, const cpl_particles *particles, const cpl_fluid_points *fluid) {
  double *received;
  int status = CPL_RESERVE(p->carried, (size_t)p->received * CARRIED);
  if (status == PART_OK)
    status = CPL_RESERVE(p->work, (size_t)p->count * CARRIED);
  if (status == PART_OK)
    status = CPL_RESERVE(p->paired, 3 * (size_t)p->count);
  PART_TRY(part_agree(p->comm, status));
  for (int i = 0; i < p->count; i++) {
    double *of = p->work.data + (size_t)i * CARRIED;
    const double sum = p->sum.data[i], wet = p->wet.data[i];
    const double sp = *(particles->fluid_sp + (size_t)i * (size_t)particles->fluid_sp_stride);
    of[DRAG] = sum > 0.0 ? sp / sum : 0.0; /* the wet share is in it */
    of[PRESSURE] = p->pressure.data[i];
    of[VOLUME] = wet * p->volume.data[i];
    memcpy(of + VELOCITY, points_at(particles->velocity, particles->velocity_stride, i), 3 * sizeof *of);
  }
  PART_TRY(points_forward(p, CARRIED, p->work.data, &received));
  memcpy(p->carried.data, received, (size_t)p->received * CARRIED * sizeof *received);
  for (int k = 0; k < p->received; k++) {
    double sum[3] = {0.0, 0.0, 0.0}, f[3];
    for (size_t q = p->start.data[k]; q < p->start.data[k + 1]; q++) {
      pair_force(p, k, q, p->carried.data + (size_t)k * CARRIED, fluid, f);
      for (int c = 0; c < 3; c++)
        sum[c] += f[c];
    }
    memcpy(p->receive_buffer.data + 3 * (size_t)k, sum, sizeof sum);
  }
  PART_TRY(points_back(p, 3, p->receive_buffer.data, p->paired.data));
  for (int i = 0; i < p->count; i++) {
    double *su = particles->fluid_su + (size_t)i * (size_t)particles->fluid_su_stride;
    const double sp = *(particles->fluid_sp + (size_t)i * (size_t)particles->fluid_sp_stride);
    const double *v = points_at(particles->velocity, particles->velocity_stride, i);
    for (int c = 0; c < 3; c++)
      su[c] += p->paired.data[3 * i + c] + sp * v[c];
  }
  return PART_OK;
}

void points_pairwise_react(const cpl_points_t *p, cpl_fluid_points *fluid) {
  for (int k = 0; k < p->received; k++)
    for (size_t q = p->start.data[k]; q < p->start.data[k + 1]; q++) {
      double *to = fluid->force + (size_t)p->partner.data[q] * (size_t)fluid->force_stride, f[3];
      pair_force(p, k, q, p->carried.data + (size_t)k * CARRIED, fluid, f);
      for (int c = 0; c < 3; c++)
        to[c] -= f[c];
    }
}
