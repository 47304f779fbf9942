/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sph_advance: steps of the two time schemes (S.13, S.14). */
#include <fenv.h>

#include "internal.h"

/* What particles get in h: gravity, the force of others and the rates of the fluid. */
static void kick(sph_t *sph, double h) {
  const double *g = sph->params.gravity;
  double force[3] = {0.0, 0.0, 0.0};
  for (int i = 0; i < sph->store->local; i++) {
    double *v = sph_xv(sph) + SPH_XV * (size_t)i + 4;
    const double *rate = sph_rate(sph) + SPH_RATE * (size_t)i;
    for (int c = 0; c < 3; c++)
      v[c] += h * (rate[c] + g[c]);
    if (sph->plan.forces) {
      const double *f = sph_force(sph) + SPH_FORCE * (size_t)i;
      const double w = h / sph_mass(sph)[SPH_MASS * (size_t)i];
      for (int c = 0; c < 3; c++) {
        v[c] += w * f[c];
        force[c] += f[c];
      }
    }
  }
  part_sum_add(&sph->gravity_impulse, g, sph->own_mass * h);
  part_sum_add(&sph->force_impulse, force, h);
  part_sum_add(&sph->wall_impulse, sph->wall_force, h);
  sph_walls_add_impulse(sph, h);
}

static void drift(sph_t *sph, double h) {
  for (int i = 0; i < sph->store->local; i++) {
    double *x = sph_xv(sph) + SPH_XV * (size_t)i;
    for (int c = 0; c < 3; c++)
      x[c] += h * x[4 + c];
  }
}

/* S.11, from the sums of the density loop. */
static void drift_with_neighbours(sph_t *sph, double h) {
  const double share = sph->params.xsph * h;
  for (int i = 0; i < sph->store->local && sph->plan.xsph; i++) {
    double *x = sph_xv(sph) + SPH_XV * (size_t)i;
    double *m = sph_mass(sph) + SPH_MASS * (size_t)i;
    sph_carry(sph, i, share, sph->sum + SPH_SUMS * (size_t)i + 2, x, m + 1, m + 2);
  }
}

static void change_density(sph_t *sph, double h) {
  for (int i = 0; i < sph->store->local; i++) {
    double *density = &sph_mass(sph)[SPH_MASS * (size_t)i + 1];
    *density += h * sph_rate(sph)[SPH_RATE * (size_t)i + 3];
    if (sph->plan.seen)
      *density *= sph->sum[SPH_SUMS * (size_t)i + SPH_FOLLOW];
  }
}

/* S.18, at the end of h from now. */
static void change_eps(sph_t *sph, double h) {
  for (int i = 0; i < sph->store->local && sph->plan.eps_moves; i++) {
    double *eps = &sph_mass(sph)[SPH_MASS * (size_t)i + 2];
    const double *f = sph_force(sph) + SPH_FORCE * (size_t)i;
    const double *v = sph_xv(sph) + SPH_XV * (size_t)i + 4;
    *eps = sph_moved_eps(*eps, h * (f[3] + v[0] * f[4] + v[1] * f[5] + v[2] * f[6]));
  }
}

static double own_speed(const sph_t *sph) {
  double most = 0.0;
  for (int i = 0; i < sph->store->local; i++) {
    const double *v = sph_xv(sph) + SPH_XV * (size_t)i + 4;
    const double v2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    if (!(v2 <= most))
      most = v2;
  }
  return sqrt(most);
}

/* Says which own particle it is that goes so far. */
static int too_far(const sph_t *sph) {
  int fastest = 0;
  double most = -1.0;
  for (int i = 0; i < sph->store->local; i++) {
    const double *v = sph_xv(sph) + SPH_XV * (size_t)i + 4;
    const double v2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    if (v2 > most) {
      most = v2;
      fastest = i;
    }
  }
  const double *x = sph_xv(sph) + SPH_XV * (size_t)fastest;
  return part_fail(
      PART_ERR_NUMERIC,
      "particle %lld at (%g %g %g) m, time %g s, velocity (%g %g %g) m/s would move by "
      "more than half the skin of %g m in one step: skinFraction is too small, or the "
      "speed of sound, or the step too long",
      (long long)sph_id(sph, fastest), x[0], x[1], x[2], sph->time, x[4], x[5], x[6], sph->skin);
}

/* Lists that hold until particles have moved by `way` more (m). With XSPH a particle goes no
 * farther than the fastest of its neighbourhood, for S.11 with V W summing to about 1; 2 is ample.
 * Collective. NaN counts as far, and is found by the check of the state. */
static int make_sure_of_lists(sph_t *sph, double way) {
  way *= 1.0 + 2.0 * sph->params.xsph + sph_shift_room(sph);
  if (!(way <= 0.5 * sph->skin))
    way = HUGE_VAL;
  const int own = isinf(way);
  if (MPI_Allreduce(MPI_IN_PLACE, &way, 1, MPI_DOUBLE, MPI_MAX, sph->comm) != MPI_SUCCESS)
    return part_fail(PART_ERR_MPI, "a maximum over ranks failed");
  if (isinf(way)) {
    PART_TRY(sph_check_state(sph));
    return part_agree(sph->comm, own ? too_far(sph) : PART_OK);
  }
  if (sph->travel + way > 0.5 * sph->skin)
    PART_TRY(sph_rebuild(sph, 0));
  sph->travel += way;
  return PART_OK;
}

/* S.13: half kick, half drift, density where velocities are, half drift, forces, half kick. */
static int symplectic_step(sph_t *sph, double h, double next) {
  const int summation = sph->plan.summation;
  kick(sph, 0.5 * h);
  PART_TRY(make_sure_of_lists(sph, fmax(own_speed(sph) * h, sph_walls_way(sph, h))));
  drift(sph, summation ? h : 0.5 * h);
  sph_walls_move(sph, summation ? next : 0.5 * (sph->time + next));
  PART_TRY(sph_refresh_ghosts(sph));
  PART_TRY(part_agree(sph->comm, sph_density_rates(sph)));
  PART_TRY(sph_make_factors(sph));
  if (sph->plan.shifting)
    PART_TRY(part_agree(sph->comm, sph_shift_sums(sph)));
  if (!summation) {
    change_density(sph, h);
    drift(sph, 0.5 * h);
    drift_with_neighbours(sph, h);
    sph_shift(sph, h);
  }
  sph_walls_move(sph, next);
  change_eps(sph, h);
  sph_set_states(sph);
  PART_TRY(sph->plan.variable ? sph_hold_lengths(sph) : sph_refresh_ghosts(sph));
  PART_TRY(part_agree(sph->comm, sph_accelerations(sph)));
  kick(sph, 0.5 * h);
  return PART_OK;
}

static int save(sph_t *sph) {
  const size_t n = (size_t)sph->store->local;
  PART_TRY(sph_grow(8 * n, sizeof *sph->saved, &sph->saved_room, &sph->saved));
  for (size_t i = 0; i < n; i++) {
    memcpy(sph->saved + 8 * i, sph_xv(sph) + SPH_XV * i, 8 * sizeof *sph->saved);
    sph->saved[8 * i + 3] = sph_mass(sph)[SPH_MASS * i + 1]; /* in place of the volume */
    sph->saved[8 * i + 7] = sph_mass(sph)[SPH_MASS * i + 2]; /* in place of the pressure */
  }
  return PART_OK;
}

/* To where the step began. */
static void restore(sph_t *sph) {
  for (size_t i = 0; i < (size_t)sph->store->local; i++) {
    double *xv = sph_xv(sph) + SPH_XV * i;
    const double *s = sph->saved + 8 * i;
    for (int c = 0; c < 3; c++) {
      xv[c] = s[c];
      xv[4 + c] = s[4 + c];
    }
    sph_mass(sph)[SPH_MASS * i + 1] = s[3];
    sph_mass(sph)[SPH_MASS * i + 2] = s[7];
  }
}

/* Without the impulses of walls and forces, which are those of the corrector. */
static void predict(sph_t *sph, double h) {
  const double *g = sph->params.gravity;
  for (size_t i = 0; i < (size_t)sph->store->local; i++) {
    double *xv = sph_xv(sph) + SPH_XV * i, *m = sph_mass(sph) + SPH_MASS * i;
    const double *rate = sph_rate(sph) + SPH_RATE * i, *f = sph_force(sph) + SPH_FORCE * i;
    for (int c = 0; c < 3; c++) {
      xv[c] += h * xv[4 + c];
      xv[4 + c] += h * (rate[c] + g[c] + f[c] / m[0]);
    }
    m[1] += h * rate[3];
  }
}

/* Rates at the middle of the step. The force loop writes over the sums of S.11, so they move the
 * place where the step began. */
static int middle_rates(sph_t *sph, double h) {
  const double share = sph->params.xsph * h;
  sph_set_states(sph);
  PART_TRY(sph_refresh_ghosts(sph));
  PART_TRY(part_agree(sph->comm, sph_density_rates(sph)));
  PART_TRY(sph_make_factors(sph));
  if (sph->plan.summation) {
    sph_set_states(sph);
    PART_TRY(sph_refresh_ghosts(sph));
  }
  for (size_t i = 0; i < (size_t)sph->store->local && sph->plan.xsph; i++)
    sph_carry(sph, (int)i, share, sph->sum + SPH_SUMS * i + 2, sph->saved + 8 * i,
              sph->saved + 8 * i + 3, sph->saved + 8 * i + 7);
  if (sph->plan.shifting) {
    PART_TRY(part_agree(sph->comm, sph_shift_sums(sph)));
    for (int i = 0; i < sph->store->local; i++) {
      double *s = sph->saved + 8 * (size_t)i;
      sph_shift_one(sph, i, h, s, s + 3, s + 7);
    }
  }
  return part_agree(sph->comm, sph_accelerations(sph));
}

/* S.14: rates at the middle of the step, from a state predicted with those of the last step. */
static int corrected_step(sph_t *sph, double h, double next) {
  PART_TRY(make_sure_of_lists(sph, 0.5 * fmax(own_speed(sph) * h, sph_walls_way(sph, h))));
  PART_TRY(part_agree(sph->comm, save(sph)));
  predict(sph, 0.5 * h);
  change_eps(sph, 0.5 * h);
  sph_walls_move(sph, 0.5 * (sph->time + next));
  PART_TRY(middle_rates(sph, h));
  restore(sph);
  kick(sph, 0.5 * h);
  double way = fmax(own_speed(sph) * h, sph_walls_way(sph, h)) * (1.0 + 2.0 * sph->params.xsph + sph_shift_room(sph));
  if (MPI_Allreduce(MPI_IN_PLACE, &way, 1, MPI_DOUBLE, MPI_MAX, sph->comm) != MPI_SUCCESS)
    return part_fail(PART_ERR_MPI, "a maximum over ranks failed");
  sph->travel += way; /* of this whole step, that of its middle besides: a bound */
  drift(sph, h);
  sph_walls_move(sph, next);
  kick(sph, 0.5 * h);
  if (!sph->plan.summation)
    change_density(sph, h);
  change_eps(sph, h);
  sph_set_states(sph);
  return PART_OK;
}

static int run(sph_t *sph, double dt, int *steps) {
  const double end = sph->time + dt;
  double left = dt, longest, speed;
  PART_TRY(sph_plan_fields(sph));
  if (!sph->eps_ahead)
    sph_set_states(sph); /* eps may be new */
  while (left > 0.0) {
    PART_TRY(sph_limits(sph, &longest, &speed));
    /* A ratio that is whole but for rounding is meant to be whole. */
    const double ratio = fmax(ceil(left / longest * (1.0 - 1e-12)), 1.0);
    if (!(ratio < 1e9)) {
      PART_TRY(sph_check_state(sph));
      return part_fail(PART_ERR_RANGE, "advance by %g s: more than 1e9 steps of %g s", left,
                       longest);
    }
    const double h = left / ratio, rest = ratio > 1.0 ? left - h : 0.0;
    PART_TRY(sph->params.time_scheme == SPH_SYMPLECTIC ? symplectic_step(sph, h, end - rest)
                                                       : corrected_step(sph, h, end - rest));
    PART_TRY(sph_check_state(sph));
    left = rest;
    sph->time = end - left;
    sph->steps++;
    if (steps != NULL)
      ++*steps;
  }
  return PART_OK;
}

int sph_advance(sph_t *sph, double dt, int *steps) {
  if (steps != NULL)
    *steps = 0;
  if (!sph->started)
    return part_fail(PART_ERR_STATE, "sph_advance comes after sph_start");
  if (!(dt > 0.0) || !isfinite(dt))
    return part_fail(PART_ERR_RANGE, "advance by %g s: must be positive and finite", dt);
  /* Lanes of padding compute too: whoever traps floating point exceptions (OpenFOAM does) must not
   * see that. */
  fenv_t environment;
  feholdexcept(&environment);
  const int status = run(sph, dt, steps);
  fesetenv(&environment);
  return status;
}
