/* SPDX-License-Identifier: GPL-3.0-or-later */
/* selfDisturbance of the exchange with fluid points (C.17, P.11): drag on the velocity without what the
 * sphere's own drag has given to the fluid, at the porosity without its own volume. The kernel is K of P.1,
 * which is sampled as it is spread. */
#include <math.h>
#include "points_type.h"

static const double PI = 3.14159265358979323846;

/* Variance of W per axis. */
static double kernel_variance(const cpl_points_kernel *kernel) {
  enum { PARTS = 2000 };
  const double step = kernel->support / PARTS;
  double sum = 0.0, all = 0.0;
  for (int k = 0; k < PARTS; k++) {
    const double r = (k + 0.5) * step, shell = r * r * kernel->value(kernel->context, r);
    all += shell;
    sum += shell * r * r;
  }
  return sum / (3.0 * all);
}

int points_wake_make(cpl_points_t *p) {
  if (!p->params.self_disturbance)
    return PART_OK;
  PART_TRY(CPL_RESERVE(p->wake, 1));
  p->variance = kernel_variance(&p->kernel);
  cpl_disturbance_make(p->wake.data);
  return PART_OK;
}

/* Of K: that of W, and of the sphere. */
static double spread_of(const cpl_points_t *p, double radius) {
  return p->variance + (p->params.porosity == CPL_POINTS_EXACT ? 0.2 * radius * radius : 0.0);
}

/* chi of C.17. */
static double own_share(double volume, double s0, double eps) {
  const double self = volume / (pow(2.0 * PI, 1.5) * s0 * s0 * s0), all = 1.0 - eps;
  return self < all ? self / all : 1.0;
}

/* The sampled eps without the sphere's own volume. */
double points_wake_eps(const cpl_points_t *p, int i, double radius) {
  const double eps = p->sampled_eps.data[i], s0 = sqrt(2.0 * spread_of(p, radius));
  return eps + own_share(p->volume.data[i], s0, eps) *
                   fmin(p->volume.data[i] / (pow(2.0 * PI, 1.5) * s0 * s0 * s0), 1.0 - eps);
}

void points_wake_subtract(const cpl_points_t *p, const cpl_particles *particles, int i, double *u) {
  const double *v = points_at(particles->velocity, particles->velocity_stride, i);
  const double *memory = points_at(particles->memory, particles->memory_stride, i);
  const double radius = *points_at(particles->radius, particles->radius_stride, i);
  const double s0 = sqrt(2.0 * spread_of(p, radius)), mu = p->fluid.viscosity;
  double slip2 = 0.0, share[CPL_MEMORY_VECTORS];
  for (int c = 0; c < 3; c++)
    slip2 += (u[c] - v[c]) * (u[c] - v[c]);
  cpl_disturbance_shares(p->wake.data, sqrt(slip2) * s0 * p->fluid.density / (2.0 * mu), share);
  const double scale =
      own_share(p->volume.data[i], s0, p->sampled_eps.data[i]) / (4.0 * PI * mu * s0);
  for (int k = 0; k < CPL_MEMORY_VECTORS; k++)
    for (int c = 0; c < 3; c++)
      u[c] += scale * share[k] * memory[3 * k + c]; /* the fluid got the opposite */
}

/* The memories hold the drag on the sphere: its impulse without buoyancy. */
void points_wake_remember(const cpl_points_t *p, const cpl_particles *particles, double dt) {
  const double nu = p->fluid.viscosity / p->fluid.density;
  for (int i = 0; i < particles->count; i++) {
    const double radius = *points_at(particles->radius, particles->radius_stride, i);
    const double *j = points_at(particles->fluid_impulse, particles->fluid_impulse_stride, i);
    const double weight = p->fluid.density * points_sphere_volume(radius);
    double *memory = particles->memory + (size_t)i * (size_t)particles->memory_stride;
    for (int k = 0; k < CPL_MEMORY_VECTORS; k++) {
      const double gain = -expm1(-dt * nu / (cpl_memory_time(k) * spread_of(p, radius)));
      for (int c = 0; c < 3; c++)
        memory[3 * k + c] += gain * (j[c] / dt + weight * p->fluid.gravity[c] - memory[3 * k + c]);
    }
  }
}
