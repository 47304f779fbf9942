/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a particle feels of its own drag (disturbance.h).
 *
 * Its share of the local flow is that of its own in the solids around: 1/chi = (1 - eps)/(V g) less
 * what is not known of g, with g the kernel with itself where they are sampled. Alone, chi is 1 and
 * the drag is that on the undisturbed velocity. In a bed it goes to 1 over the number of particles
 * in the kernel: what many particles give to the fluid is not a disturbance of one, it is the mean
 * flow of the drag law. So it is with its own volume in the porosity of that law. */
#include "wake.h"
#include "extra.h"
#include <math.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

/* (1 - eps)/(V g) of a sphere alone is 1 to 1.3 with the g of a Gaussian, up to 1.5 on badly warped
 * tetrahedra (tests/coupling/test_kernel_shape.c), which must not count as other particles. */
static const double NOT_KNOWN = 0.5;

int cpl_wake_spread(cpl_t *cpl) {
  if (cpl->spread_stamp == cpl->stamp)
    return PART_OK;
  const size_t count = (size_t)cpl->count;
  const double *shape;
  int status = CPL_RESERVE(cpl->spread, 2 * count);
  if (status == PART_OK)
    status = CPL_RESERVE(cpl->disturbance, 3 * count);
  if (status == PART_OK)
    status = CPL_RESERVE(cpl->particle_work, CPL_MOMENTS * count);
  PART_TRY(cpl_agree(cpl, status));
  PART_TRY(cpl_smoother_shape(cpl->smoother, &shape));
  PART_TRY(cpl_weights_moments(cpl->weights, shape, cpl->particle_work.data));
  for (size_t i = 0; i < count; i++) {
    const double *m = cpl->particle_work.data + CPL_MOMENTS * i;
    const double own = (m[3] - m[0] * m[0] - m[1] * m[1] - m[2] * m[2]) / 3.0;
    cpl->spread.data[2 * i] = m[4] + fmax(own, 0.0);
    cpl->spread.data[2 * i + 1] = m[5] + fmax(own, 0.0);
  }
  cpl->spread_stamp = cpl->stamp;
  return PART_OK;
}

double cpl_wake_share(double volume, double variance, double eps) {
  const double self = volume / pow(4.0 * PI * variance, 1.5);
  return self / fmax(self, 1.0 - eps - NOT_KNOWN * self);
}

double cpl_wake_eps(double volume, double variance, double eps) {
  const double self = volume / pow(4.0 * PI * variance, 1.5);
  return fmin(eps + cpl_wake_share(volume, variance, eps) * self, 1.0);
}

static int check_memory(const cpl_particles *p) {
  return p->memory || p->count == 0
             ? PART_OK
             : part_fail(PART_ERR_ARGUMENT, "coupling: selfDisturbance is on, but the particles "
                                            "have no memory");
}

int cpl_wake_velocity(cpl_t *cpl, const cpl_particles *p) {
  PART_TRY(check_memory(p));
  const double rho = cpl->fluid.density, nu = cpl->fluid.viscosity / rho;
  for (size_t i = 0; i < (size_t)cpl->count; i++) {
    const double *v = cpl_at(p->velocity, p->velocity_stride, (int)i);
    const double *superficial = cpl->superficial.data + 3 * i;
    const double *memory = cpl_at(p->memory, p->memory_stride, (int)i);
    double *w = cpl->disturbance.data + 3 * i;
    const double eps = cpl->eps.data[i], s0 = sqrt(2.0 * cpl->spread.data[2 * i]);
    double slip2 = 0.0, share[CPL_MEMORY_VECTORS];
    for (int d = 0; d < 3; d++) {
      const double slip = superficial[d] / eps - v[d];
      slip2 += slip * slip;
      w[d] = 0.0;
    }
    cpl_disturbance_shares(cpl->wake, sqrt(slip2) * s0 / (2.0 * nu), share);
    for (int k = 0; k < CPL_MEMORY_VECTORS; k++)
      for (int d = 0; d < 3; d++)
        w[d] += share[k] * memory[3 * k + d];
    const double scale = -cpl_wake_share(cpl->volume.data[i], cpl->spread.data[2 * i + 1], eps) /
                         (4.0 * PI * cpl->fluid.viscosity * s0);
    for (int d = 0; d < 3; d++)
      w[d] *= scale;
  }
  return PART_OK;
}

int cpl_wake_remember(cpl_t *cpl, const cpl_particles *p, cpl_match *match, double dt) {
  PART_TRY(cpl_agree(cpl, check_memory(p)));
  const double nu = cpl->fluid.viscosity / cpl->fluid.density;
  const int lifted = cpl_uses_extra(&cpl->params);
  double *row = cpl->particle_work2.data; /* free now: 4 per particle; drag force, T */
  int status = CPL_RESERVE(cpl->particle_work2, 4 * (size_t)cpl->count);
  CPL_ARRAY(double) view = {NULL, 0};
  if (status == PART_OK)
    status = CPL_RESERVE(view, 4 * (size_t)p->count);
  row = cpl->particle_work2.data;
  for (size_t i = 0; status == PART_OK && i < (size_t)cpl->count; i++) {
    for (size_t d = 0; d < 3; d++)
      row[4 * i + d] = cpl->told.data[3 * i + d] - (lifted ? cpl->extra.data[3 * i + d] : 0.0) +
                       cpl->implicit.data[i] * cpl->particle_work.data[6 * i + d] / dt;
    row[4 * i + 3] = cpl->spread.data[2 * i] / nu;
  }
  status = cpl_agree(cpl, status);
  if (status == PART_OK)
    status = cpl_match_move(match, 4, row, view.data);
  for (int i = 0; status == PART_OK && i < p->count; i++) {
    double *memory = p->memory + (size_t)i * (size_t)p->memory_stride;
    const double *force = view.data + 4 * (size_t)i;
    for (int k = 0; k < CPL_MEMORY_VECTORS; k++) {
      const double gain = -expm1(-dt / (cpl_memory_time(k) * force[3]));
      for (int d = 0; d < 3; d++)
        memory[3 * k + d] += gain * (force[d] - memory[3 * k + d]);
    }
  }
  CPL_FREE(view);
  return status;
}
