/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Smoothing lengths (S.26) that outgrow the lists, or are found together with the densities of S.6. */
#include "internal.h"

/* Error of h, and passes over all pairs. From the density of the step before it takes 2 or 3. */
static const double tolerance = 1e-11;
enum { PASSES = 40 };

static double power(const sph_t *sph, double h) {
  return sph->params.dimensions == 2 ? h * h : h * h * h;
}

int sph_hold_lengths(sph_t *sph) {
  int is;
  PART_TRY(sph_outgrown(sph, &is));
  return is ? sph_rebuild(sph, 0) : sph_refresh_ghosts(sph);
}

/* One pass of Newton's method for n(h) v h^d = 1, n = sum_b W_ab(h): d n/dh = -(d n + sum r dW/dr)/h. The density is that
 * of the new h. Returns the largest change over h. */
static double newton_pass(sph_t *sph) {
  const sph_lanes lanes = sph_lanes_of(sph);
  const double own = sph_shape(sph->params.kernel, 0.0), unit = sph_unit_volume(sph);
  const double d = (double)sph->params.dimensions;
  double most = 0.0;
  sph->loops->number[sph->params.kernel](&lanes, 0, sph->lists.rows, sph->sum);
  for (int i = 0; i < sph->store->local; i++) {
    const double h = sph_length(sph, i), moment = sph->sum[SPH_SUMS * (size_t)i + 6];
    const double n = sph->sum[SPH_SUMS * (size_t)i + 5] + own * sph_norm_at(sph, h);
    double change = -(n - 1.0 / (unit * power(sph, h))) / moment;
    most = fmax(most, moment > 0.0 ? fabs(change) : HUGE_VAL);
    change = moment > 0.0 ? fmin(fmax(change, -0.2), 0.2) : 0.2; /* without neighbours: look farther */
    sph_mass(sph)[SPH_MASS * (size_t)i + 1] =
        sph_mass(sph)[SPH_MASS * (size_t)i] / (unit * power(sph, h * (1.0 + change)));
    sph_set_omega(sph, i, fmax(moment / (d * n), 1e-3));
  }
  sph_set_lengths(sph);
  return most;
}

int sph_solve_lengths(sph_t *sph) {
  for (int pass = 0; pass < PASSES; pass++) {
    int is;
    part_timers_start(sph->timers, sph->stage[SPH_STAGE_DENSITY]);
    double most = newton_pass(sph);
    part_timers_stop(sph->timers, sph->stage[SPH_STAGE_DENSITY]);
    PART_TRY(part_agree(sph->comm, sph_check_lengths(sph)));
    PART_TRY(sph_outgrown(sph, &is));
    if (is)
      PART_TRY(sph_rebuild(sph, 0));
    if (MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_DOUBLE, MPI_MAX, sph->comm) != MPI_SUCCESS)
      return part_fail(PART_ERR_MPI, "a maximum over ranks failed");
    if (most < tolerance && !is)
      return PART_OK;
  }
  return part_fail(PART_ERR_NUMERIC, "time %g s: smoothing lengths and densities are not found in %d passes",
                   sph->time, (int)PASSES);
}
