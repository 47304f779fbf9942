/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pressure gradient that gravity and the force of others ask for, which density diffusion
 * leaves alone (S.5). Without it fluid goes past the drag of a bed: 63 % more than the drag lets
 * through at porosity 0.5 (tutorials/sphDemFoam/cpb). */
#include "internal.h"

int sph_plan_balance(sph_t *sph) {
  sph_plan *plan = &sph->plan;
  double sums[4] = {0.0, 0.0, 0.0, 0.0};
  plan->balance =
      plan->diffusion && (plan->forces || (plan->porous && plan->hydrostatic) || !sph->params.skip);
  memset(sph->common, 0, sizeof sph->common);
  if (!plan->balance)
    return PART_OK;
  for (int i = 0; i < sph->store->local; i++) {
    const double *f = sph_force(sph) + SPH_FORCE * (size_t)i;
    for (int c = 0; c < 3; c++)
      sums[c] += f[c];
    sums[3] += sph_mass(sph)[SPH_MASS * (size_t)i];
  }
  if (plan->forces)
    PART_TRY(sph_rank_sum(sph, 4, sums));
  for (int c = 0; c < 3; c++)
    sph->common[c] = sph->box.periodic[c] && sums[3] > 0.0 ? sums[c] / sums[3] : 0.0;
  return part_agree(sph->comm, sph_grow_balance(sph));
}

int sph_grow_balance(sph_t *sph) {
  return sph_grow(SPH_BALANCE * ((size_t)sph->store->local + (size_t)sph->store->ghost),
                  sizeof *sph->balance, &sph->balance_room, &sph->balance);
}

int sph_make_balance(sph_t *sph) {
  const double density = sph->params.density;
  for (int i = 0; i < sph->store->local; i++) {
    const double *f = sph_force(sph) + SPH_FORCE * (size_t)i;
    const double eps = sph_mass(sph)[SPH_MASS * (size_t)i + 2];
    const double per_volume = 1.0 / sph_xv(sph)[SPH_XV * (size_t)i + 3];
    double *b = sph->balance + SPH_BALANCE * (size_t)i;
    for (int c = 0; c < 3; c++)
      b[c] = eps * (sph->hydrostatic[c] - density * sph->common[c]) + per_volume * f[c];
    b[3] = 0.0;
  }
  return part_domain_copy_to_ghosts(sph->domain, sph->store, SPH_BALANCE * sizeof *sph->balance,
                                    sph->balance,
                                    sph->balance + SPH_BALANCE * (size_t)sph->store->local);
}
