/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From what was inserted to a running scene. */
#include <fenv.h>

#include "internal.h"

static int check(const sph_t *sph) {
  if (sph->started)
    return part_fail(PART_ERR_STATE, "sph_start is called once");
  if (sph->total == 0)
    return part_fail(PART_ERR_STATE,
                     "there are no particles: insert or read some before sph_start");
  if (sph->params.variable_smoothing && sph->params.density_scheme == SPH_SUMMATION &&
      sph->walls.count > 0)
    return part_fail(PART_ERR_RANGE,
                     "%s: entry variableSmoothing: on with densityScheme summation has no walls, and "
                     "there is wall %s; must be off, or densityScheme continuity",
                     sph_params_table.name, sph->walls.wall[0].name);
  for (int c = 0; c < 3; c++) {
    const double length = sph->box.hi[c] - sph->box.lo[c];
    if (sph->box.periodic[c] && length < 2.0 * (sph->reach + sph->skin))
      return part_fail(PART_ERR_RANGE,
                       "the domain is %g m long in its periodic direction %d; must be at least two "
                       "supports with skin, %g m",
                       length, c, 2.0 * (sph->reach + sph->skin));
  }
  return PART_OK;
}

/* S.6 where particles have been put: at a free surface the sum lacks the part of the kernel that is in
 * the air, some 0.4 of it with h = 2 dx and 0.1 with h = dx. */
static int check_sums(sph_t *sph) {
  static const double least = 0.93;
  for (int i = 0; i < sph->store->local; i++) {
    const double *x = sph_xv(sph) + SPH_XV * (size_t)i;
    const double share =
        sph_mass(sph)[SPH_MASS * (size_t)i + 1] / sph_rate(sph)[SPH_RATE * (size_t)i + 3];
    if (!(share >= least))
      return part_fail(PART_ERR_RANGE,
                       "%s: entry densityScheme: summation gives particle %lld at (%g %g %g) m %g of "
                       "the density that it was put there with: it is at a free surface or beside a "
                       "hole, where densityScheme must be continuity",
                       sph_params_table.name, (long long)sph_id(sph, i), x[0], x[1], x[2], share);
    sph_rate(sph)[SPH_RATE * (size_t)i + 3] = 0.0;
  }
  return PART_OK;
}

/* The densities of before are kept in the place of their rates: the order may change. */
static int first_sums(sph_t *sph) {
  for (int i = 0; i < sph->store->local; i++)
    sph_rate(sph)[SPH_RATE * (size_t)i + 3] = sph_mass(sph)[SPH_MASS * (size_t)i + 1];
  int status = sph_density_rates(sph);
  if (status == PART_OK)
    status = check_sums(sph);
  PART_TRY(part_agree(sph->comm, status));
  sph_set_states(sph);
  return sph->plan.variable ? sph_hold_lengths(sph) : sph_refresh_ghosts(sph);
}

/* Floating point exceptions held: see sph_advance. */
static int first_rates(sph_t *sph) {
  fenv_t environment;
  feholdexcept(&environment);
  int status = PART_OK;
  if (sph->plan.summation) {
    status = first_sums(sph);
  } else if (sph->params.time_scheme == SPH_PREDICTOR_CORRECTOR || sph->plan.correction ||
             sph->plan.variable || sph->plan.seen) {
    status = part_agree(sph->comm, sph_density_rates(sph));
    if (status == PART_OK)
      status = sph_make_factors(sph);
  }
  if (status == PART_OK)
    status = sph_accelerations(sph);
  fesetenv(&environment);
  return status;
}

/* A file does not say where the plane is. */
static int find_plane(sph_t *sph) {
  double z = sph->store->local > 0 ? sph_xv(sph)[2] : HUGE_VAL;
  if (sph->params.dimensions == 3 || !isnan(sph->plane))
    return PART_OK;
  if (MPI_Allreduce(MPI_IN_PLACE, &z, 1, MPI_DOUBLE, MPI_MIN, sph->comm) != MPI_SUCCESS)
    return part_fail(PART_ERR_MPI, "a minimum over ranks failed");
  sph->plane = z;
  return PART_OK;
}

int sph_start(sph_t *sph) {
  PART_TRY(check(sph));
  PART_TRY(find_plane(sph));
  PART_TRY(part_agree(sph->comm, sph_walls_prepare(sph)));
  sph_make_plan(sph);
  PART_TRY(sph_choose_loops(sph));
  PART_TRY(part_agree(sph->comm, sph_walls_bins(&sph->walls, sph->reach + sph->skin)));
  PART_TRY(part_agree(sph->comm, sph_walls_table(sph)));
  PART_TRY(part_agree(sph->comm, sph_walls_fix(sph)));
  PART_TRY(sph_plan_fields(sph));
  if (!sph->restored)
    sph_set_states(sph);
  PART_TRY(sph_rebuild(sph, !sph->restored || sph->restored_elsewhere));
  sph->started = 1;
  sph->has_seen = sph->restored && sph->plan.seen;
  if (sph->restored)
    return PART_OK;
  PART_TRY(first_rates(sph));
  sph_own_momentum(sph, sph->initial_momentum, NULL);
  return PART_OK;
}

static int check_eps(const sph_t *sph, const double *eps) {
  for (int i = 0; i < sph->store->local; i++)
    if (!(eps[i] > 0.0 && eps[i] <= 1.0))
      return part_fail(PART_ERR_RANGE, "particle %lld: eps is %g; must be in (0, 1]",
                       (long long)sph_id(sph, i), eps[i]);
  return PART_OK;
}

int sph_displace(sph_t *sph, const double *eps) {
  if (!sph->started || sph->restored || sph->steps > 0)
    return part_fail(
        PART_ERR_STATE,
        "sph_displace comes after sph_start and before sph_advance, not after sph_read");
  PART_TRY(part_agree(sph->comm, check_eps(sph, eps)));
  sph->own_mass = 0.0;
  for (int i = 0; i < sph->store->local; i++) {
    double *m = sph_mass(sph) + SPH_MASS * (size_t)i;
    m[0] *= eps[i] / m[2];
    m[1] *= eps[i] / m[2];
    m[2] = eps[i];
    sph->own_mass += m[0];
  }
  PART_TRY(sph_plan_fields(sph));
  sph->has_seen = 0;
  sph_set_states(sph);
  PART_TRY(sph_refresh_ghosts(sph));
  PART_TRY(first_rates(sph));
  sph_own_momentum(sph, sph->initial_momentum, NULL);
  return PART_OK;
}
