/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "extra.h"
#include <math.h>
#include <string.h>
#include "spin_forces.h"

int cpl_uses_curl(const cpl_params *p) {
  return p->saffman_lift || p->magnus_lift || p->rotational_drag;
}

int cpl_uses_extra(const cpl_params *p) {
  return p->saffman_lift || p->magnus_lift || p->virtual_mass;
}

static int check_view(const cpl_t *cpl, const cpl_particles *p) {
  const int needed = cpl->params.magnus_lift || cpl->params.rotational_drag;
  return !needed || p->angular_velocity || p->count == 0
             ? PART_OK
             : part_fail(PART_ERR_ARGUMENT,
                         "cpl_fluid_force: magnusLift or rotationalDrag is on, but the particles "
                         "have no angular_velocity");
}

int cpl_extra_forces(cpl_t *cpl, cpl_particles *p) {
  const cpl_params *params = &cpl->params;
  const double rho = cpl->fluid.density, mu = cpl->fluid.viscosity;
  const int turning = params->magnus_lift || params->rotational_drag;
  PART_TRY(check_view(cpl, p));
  if (params->rotational_drag)
    PART_TRY(CPL_RESERVE(cpl->turning, 4 * (size_t)cpl->count));
  for (int i = 0; i < cpl->count; i++) {
    const double *v = cpl_at(p->velocity, p->velocity_stride, i);
    const double *curl = cpl->curl.data + 3 * (size_t)i;
    double *state = cpl->force.data + (size_t)i * CPL_FORCE_WIDTH;
    double *su = p->fluid_su + (size_t)i * (size_t)p->fluid_su_stride;
    const double eps = cpl->eps.data[i], d = 2.0 * cpl->sphere.data[4 * (size_t)i + 3];
    double slip[3], turn[3] = {0.0, 0.0, 0.0}, force[3] = {0.0, 0.0, 0.0};
    for (int k = 0; k < 3; k++) {
      slip[k] = cpl->superficial.data[3 * (size_t)i + (size_t)k] / eps - v[k];
      if (cpl->wake)
        slip[k] -= cpl->disturbance.data[3 * (size_t)i + (size_t)k];
      if (turning)
        turn[k] = 0.5 * curl[k] - cpl_at(p->angular_velocity, p->angular_velocity_stride, i)[k];
    }
    if (params->saffman_lift)
      cpl_add_cross(cpl_saffman_scale(cpl_norm3(slip), cpl_norm3(curl), d, rho, mu), slip, curl,
                    force);
    if (params->magnus_lift)
      cpl_add_cross(cpl_magnus_scale(cpl_norm3(slip), cpl_norm3(turn), d, rho, mu), turn, slip,
                    force);
    /* model B: with the part of the pressure gradient that it causes, as for drag (forces.c) */
    const double part = params->model == CPL_MODEL_B ? cpl->inverse_eps.data[i] : 1.0;
    for (int k = 0; k < 3; k++) {
      if (!isfinite(force[k]))
        return part_fail(PART_ERR_NUMERIC, "coupling: the lift force on particle %lld is %g N",
                         (long long)cpl->id.data[i], force[k]);
      state[CPL_FORCE_EXTRA + k] = part * force[k];
      su[k] += part * force[k];
    }
    if (params->rotational_drag) {
      double *to = cpl->turning.data + 4 * (size_t)i;
      for (int k = 0; k < 3; k++)
        to[k] = 0.5 * curl[k];
      to[3] = cpl_turning_drag(cpl_norm3(turn), d, rho, mu);
    }
  }
  return PART_OK;
}

const double *cpl_turning(const cpl_t *cpl) {
  return cpl->params.rotational_drag && cpl->force_count >= 0 ? cpl->turning.data : NULL;
}
