/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "virtual_mass.h"
#include <math.h>
#include "sphere.h"

static double added_mass(const cpl_t *cpl, double volume) {
  return cpl->params.virtual_mass_coefficient * cpl->fluid.density * volume;
}

int cpl_virtual_force(cpl_t *cpl, cpl_particles *p) {
  if (!p->velocity_before && cpl->params.two_way && p->count > 0)
    return part_fail(PART_ERR_ARGUMENT, "cpl_fluid_force: virtualMass is on with twoWay, but the "
                                        "particles have no velocity_before");
  for (int i = 0; i < cpl->count; i++) {
    const double *a = cpl->acceleration.data + 3 * (size_t)i;
    const double mass = added_mass(cpl, cpl->volume.data[i]);
    double *state = cpl->force.data + (size_t)i * CPL_FORCE_WIDTH;
    double *su = p->fluid_su + (size_t)i * (size_t)p->fluid_su_stride;
    for (int d = 0; d < 3; d++) {
      if (!isfinite(a[d]))
        return part_fail(PART_ERR_NUMERIC,
                         "coupling: the fluid's acceleration at particle %lld is %g m/s2",
                         (long long)cpl->id.data[i], a[d]);
      su[d] += mass * a[d];
      state[CPL_FORCE_EXTRA + d] += mass * a[d];
    }
  }
  return PART_OK;
}

void cpl_received(const cpl_t *cpl, const cpl_particles *p, int i, double impulse[3],
                  double added[3]) {
  const double *given = cpl_at(p->fluid_impulse, p->fluid_impulse_stride, i);
  if (!cpl->params.virtual_mass) {
    for (int d = 0; d < 3; d++)
      impulse[d] = given[d];
    return;
  }
  const double *v = cpl_at(p->velocity, p->velocity_stride, i);
  const double *before = cpl_at(p->velocity_before, p->velocity_before_stride, i);
  const double mass = added_mass(cpl, cpl_sphere_volume(*cpl_at(p->radius, p->radius_stride, i)));
  for (int d = 0; d < 3; d++) {
    const double change = mass * (v[d] - before[d]);
    impulse[d] = given[d] - change;
    if (added)
      added[d] = change;
  }
}
