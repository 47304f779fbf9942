/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The scene plan: what is there and what can be left out. */
#include <stdio.h>

#include "internal.h"

void sph_make_plan(sph_t *sph) {
  const sph_params *p = &sph->params;
  sph_plan *plan = &sph->plan;
  plan->walls = sph->walls.count > 0;
  plan->fixed = plan->walls && sph->walls.wall[0].params.model == SPH_WALL_fixed;
  plan->pushed = sph_walls_push(sph);
  plan->diffusion = p->density_diffusion > 0.0;
  plan->xsph = p->xsph > 0.0;
  plan->shifting = p->shifting > 0.0;
  plan->correction = p->gradient_correction;
  plan->variable = p->variable_smoothing;
  plan->summation = p->density_scheme == SPH_SUMMATION;
  plan->viscous = p->viscosity > 0.0 || p->artificial_viscosity > 0.0;
  plan->hydrostatic =
      sph->hydrostatic[0] != 0.0 || sph->hydrostatic[1] != 0.0 || sph->hydrostatic[2] != 0.0;
}

static int check_fields(const sph_t *sph) {
  for (int i = 0; i < sph->store->local; i++) {
    const double *m = sph_mass(sph) + SPH_MASS * (size_t)i;
    const double *f = sph_force(sph) + SPH_FORCE * (size_t)i;
    if (!(m[2] > 0.0 && m[2] <= 1.0))
      return part_fail(PART_ERR_RANGE, "particle %lld: eps is %g; must be in (0, 1]",
                       (long long)sph_id(sph, i), m[2]);
    if (!isfinite(f[0] + f[1] + f[2]))
      return part_fail(PART_ERR_NUMERIC, "particle %lld: the force on it is not finite",
                       (long long)sph_id(sph, i));
    if (!isfinite(f[3] + f[4] + f[5] + f[6]))
      return part_fail(PART_ERR_NUMERIC,
                       "particle %lld: the rate or the gradient of its eps is not finite",
                       (long long)sph_id(sph, i));
    if (sph->params.dimensions == 2 && f[2] != 0.0)
      return part_fail(PART_ERR_RANGE,
                       "particle %lld: the force on it has a z component of %g N; must be 0 with "
                       "dimensions 2",
                       (long long)sph_id(sph, i), f[2]);
  }
  return PART_OK;
}

int sph_plan_fields(sph_t *sph) {
  double most[3] = {-1.0, 0.0, 0.0};
  PART_TRY(part_agree(sph->comm, check_fields(sph)));
  for (int i = 0; i < sph->store->local; i++) {
    const double *f = sph_force(sph) + SPH_FORCE * (size_t)i;
    most[0] = fmax(most[0], -sph_mass(sph)[SPH_MASS * (size_t)i + 2]);
    if (f[0] != 0.0 || f[1] != 0.0 || f[2] != 0.0)
      most[1] = 1.0;
    if (f[3] != 0.0 || f[4] != 0.0 || f[5] != 0.0 || f[6] != 0.0)
      most[2] = 1.0;
  }
  if (MPI_Allreduce(MPI_IN_PLACE, most, 3, MPI_DOUBLE, MPI_MAX, sph->comm) != MPI_SUCCESS)
    return part_fail(PART_ERR_MPI, "a maximum over ranks failed");
  sph->least_eps = -most[0];
  sph->plan.porous = sph->least_eps < 1.0 || most[2] > 0.0;
  sph->plan.forces = most[1] > 0.0;
  sph->plan.eps_moves = most[2] > 0.0 && !sph->eps_ahead;
  sph->plan.seen = sph->plan.porous && sph->params.consistent_porosity && !sph->plan.summation;
  return sph_plan_balance(sph);
}

static int add_line(size_t size, char *text, const char *what, const char *why, const char *saves) {
  const size_t used = strlen(text);
  const int n = snprintf(text + used, size - used, "%s | %s | %s\n", what, why, saves);
  return n >= 0 && (size_t)n < size - used
             ? PART_OK
             : part_fail(PART_ERR_RANGE, "the scene plan needs more than %zu characters", size);
}

int sph_plan_text(const sph_t *sph, size_t size, char *text) {
  const sph_plan *plan = &sph->plan;
  if (size == 0)
    return part_fail(PART_ERR_RANGE, "the scene plan needs room");
  text[0] = '\0';
  if (!sph->started)
    return part_fail(PART_ERR_STATE, "sph_plan_text comes after sph_start");
  if (!sph->params.skip)
    return add_line(size, text, "nothing skipped", "skip is off", "-");
  if (!plan->porous)
    PART_TRY(add_line(size, text, "eps of partners", "eps is 1 everywhere",
                      "a load a pair, their copies on other ranks"));
  if (!plan->seen && !plan->summation)
    PART_TRY(add_line(size, text, "eps that the divergence sees",
                      plan->porous ? "consistentPorosity is off" : "eps is 1 everywhere",
                      "a kernel value and a division a pair"));
  if (!plan->diffusion && !plan->summation)
    PART_TRY(add_line(size, text, "density diffusion", "densityDiffusion is 0",
                      "a fifth of the density loop"));
  if (plan->diffusion && !plan->balance)
    PART_TRY(add_line(size, text, "pressure gradient that forces balance", "no force of others, no eps with gravity",
                      "three loads a pair"));
  if (!plan->xsph && !plan->summation)
    PART_TRY(add_line(size, text, "kernel values", "neither xsph nor summation",
                      "a third of the density loop"));
  if (!plan->correction)
    PART_TRY(add_line(size, text, "correction of gradients", "gradientCorrection is off",
                      "a sum and a load a pair"));
  if (!plan->variable)
    PART_TRY(add_line(size, text, "smoothing lengths and Omega of partners", "variableSmoothing is off",
                      "two loads and a kernel value a pair"));
  if (!plan->shifting)
    PART_TRY(add_line(size, text, "particle shifting", "shifting is 0", "a loop over pairs"));
  if (!(sph->params.artificial_pressure > 0.0) && !(sph->params.anti_clump > 0.0))
    PART_TRY(add_line(size, text, "kernel values of forces",
                      "neither artificialPressure nor antiClump", "a third of the force loop"));
  if (!plan->eps_moves)
    PART_TRY(
        add_line(size, text, "change of eps within a step", "no rate of eps", "a sum a particle"));
  if (!plan->viscous)
    PART_TRY(add_line(size, text, "viscous force", "no viscosity", "a division a pair"));
  if (!plan->walls)
    PART_TRY(add_line(size, text, "walls", "there are none", "ghost points"));
  else
    PART_TRY(add_line(size, text, "walls for far particles", "no wall within the support and skin",
                      "ghost points of these particles"));
  if (plan->pushed)
    PART_TRY(add_line(size, text, "points behind walls", "the walls push along their normal",
                      "ghost points"));
  else if (plan->walls && sph->walls.planes > 0 && !plan->fixed &&
           (sph->params.viscosity_model == SPH_MORRIS || !(sph->params.viscosity > 0.0)))
    PART_TRY(add_line(size, text, "ghost points behind a plane alone",
                      "their sums depend on the distance alone: a table",
                      "two thirds of the walls' time"));
  return PART_OK;
}
