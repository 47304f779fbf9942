/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the pair loops work on, and its copies on other ranks. */
#include "internal.h"

int sph_refresh_ghosts(sph_t *sph) {
  part_timers_start(sph->timers, sph->stage[SPH_STAGE_GHOSTS]);
  int status = part_domain_update_ghosts(sph->domain, sph->store);
  if (status == PART_OK && sph->plan.porous) {
    double *mass = sph_mass(sph);
    status = part_domain_copy_to_ghosts(sph->domain, sph->store, SPH_MASS * sizeof *mass, mass,
                                        mass + SPH_MASS * (size_t)sph->store->local);
  }
  if (status == PART_OK && sph->plan.variable)
    status = sph_copy_lengths(sph);
  part_timers_stop(sph->timers, sph->stage[SPH_STAGE_GHOSTS]);
  return status;
}

sph_lanes sph_lanes_of(const sph_t *sph) {
  const sph_params *p = &sph->params;
  const int all = !p->skip;
  const double *g = sph->hydrostatic;
  return (sph_lanes){
      .repulsion = p->artificial_pressure,
      .anti_clump = p->anti_clump,
      .per_shape = 1.0 / sph_shape(p->kernel, p->spacing / p->smoothing_length),
      .xv = sph_xv(sph),
      .mass = sph_mass(sph),
      .start = sph->lists.start,
      .partner = sph->lists.partner,
      .dimensions = (int)p->dimensions,
      .h = p->smoothing_length,
      .norm = sph->norm,
      .lens = sph->lens,
      .unit_norm = sph->unit_norm,
      .density = p->density,
      .hydrostatic = {g[0], g[1], g[2]},
      .balance = sph->plan.balance ? sph->balance : NULL,
      .seen = sph->plan.seen,
      .diffuse = sph->plan.diffusion || all,
      .smooth = sph->plan.xsph || all,
      .count = sph->plan.summation || (all && !sph->plan.variable),
      .porous = sph->plan.porous || all,
      .correct = sph->plan.correction,
      .factor = sph->factor,
      .viscosity = p->viscosity_model == SPH_MORRIS ? p->viscosity : 0.0,
      .monaghan = p->viscosity_model == SPH_MONAGHAN ? p->density * sph->monaghan : 0.0,
      .sound_speed = p->sound_speed,
      .artificial = p->density * p->artificial_viscosity * p->sound_speed * p->smoothing_length};
}
