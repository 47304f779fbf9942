/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rates and accelerations of the particles where they are, and the limits of the step. Equation
 * numbers: doc/equations.md. */
#include "internal.h"

/* S.3. The usual exponent without pow. */
static double pressure_of(const sph_params *p, double density) {
  const double x = density / p->density, k = p->density * p->sound_speed * p->sound_speed;
  const double x2 = x * x, power = p->gamma == 7.0 ? x2 * x2 * x2 * x : pow(x, p->gamma);
  return k / p->gamma * (power - 1.0) + p->background_pressure;
}

void sph_set_state(sph_t *sph, int i) {
  double *xv = sph_xv(sph) + SPH_XV * (size_t)i;
  const double *m = sph_mass(sph) + SPH_MASS * (size_t)i;
  xv[3] = m[0] / m[1];
  xv[7] = pressure_of(&sph->params, m[1] / m[2]);
}

void sph_set_states(sph_t *sph) {
  for (int i = 0; i < sph->store->local; i++)
    sph_set_state(sph, i);
  if (sph->plan.variable)
    sph_set_lengths(sph);
}

static int density_sums(sph_t *sph) {
  const sph_lanes lanes = sph_lanes_of(sph);
  part_timers_start(sph->timers, sph->stage[SPH_STAGE_DENSITY]);
  const sph_pair_loop *loop =
      sph->plan.variable ? sph->loops->variable_density : sph->loops->density;
  loop[sph->params.kernel](&lanes, 0, sph->lists.rows, sph->sum);
  part_timers_stop(sph->timers, sph->stage[SPH_STAGE_DENSITY]);
  return sph->plan.walls ? sph_walls_density(sph) : PART_OK;
}

/* S.22, from the sums of the density. */
static double factor_of(const sph_t *sph, int i) {
  const double moment =
      sph->sum[SPH_SUMS * (size_t)i + 6] / (double)sph->params.dimensions;
  const double share = sph_share_inside(moment);
  return share > 0.0 ? 1.0 + share * (1.0 / moment - 1.0) : 1.0;
}

int sph_make_factors(sph_t *sph) {
  if (sph->plan.variable)
    return sph_copy_lengths(sph);
  if (!sph->plan.correction)
    return PART_OK;
  for (int i = 0; i < sph->store->local; i++)
    sph->factor[i] = factor_of(sph, i);
  return part_domain_copy_to_ghosts(sph->domain, sph->store, sizeof *sph->factor, sph->factor,
                                    sph->factor + sph->store->local);
}

/* S.27, from the sums of the density: what the density follows at the end of the step is left in the sums. What 1 + sum is kept above is far
 * below what even particles can give. */
static void see_eps(sph_t *sph) {
  const int sum = sph->plan.variable ? 5 : 7;
  for (int i = 0; i < sph->store->local; i++) {
    const double eps = sph_mass(sph)[SPH_MASS * (size_t)i + 2];
    double *seen = sph_seen(sph) + SPH_SEEN * (size_t)i, *s = sph->sum + SPH_SUMS * (size_t)i;
    const double now = 1.0 / fmax(1.0 + eps * s[sum], 0.1);
    s[SPH_FOLLOW] = sph->has_seen ? *seen / now : 1.0;
    *seen = now;
  }
  sph->has_seen = 1;
}

/* S.4 + S.5, or S.6: what the scheme asks for. */
int sph_density_rates(sph_t *sph) {
  const sph_params *p = &sph->params;
  const int correct = sph->plan.correction, variable = sph->plan.variable;
  const double diffuse =
      2.0 * p->density_diffusion * (variable ? 1.0 : p->smoothing_length) / p->sound_speed;
  if (variable && sph->plan.summation)
    return sph_solve_lengths(sph);
  if (sph->plan.balance)
    PART_TRY(sph_make_balance(sph));
  PART_TRY(density_sums(sph));
  if (variable)
    sph_set_omegas(sph);
  if (sph->plan.summation) {
    sph_density_sums(sph);
    return PART_OK;
  }
  if (sph->plan.seen)
    see_eps(sph);
  for (int i = 0; i < sph->store->local; i++) {
    const double *s = sph->sum + SPH_SUMS * (size_t)i, *m = sph_mass(sph) + SPH_MASS * (size_t)i;
    sph_rate(sph)[SPH_RATE * (size_t)i + 3] =
        (correct    ? factor_of(sph, i)
         : variable ? sph->lens[2 * (size_t)i + 1]
                    : 1.0) *
            m[1] * s[0] -
        diffuse * s[1];
  }
  return PART_OK;
}

int sph_shift_sums(sph_t *sph) {
  const sph_lanes lanes = sph_lanes_of(sph);
  part_timers_start(sph->timers, sph->stage[SPH_STAGE_MOVE]);
  sph->loops->shift[sph->params.kernel](&lanes, 0, sph->lists.rows, sph->shift);
  part_timers_stop(sph->timers, sph->stage[SPH_STAGE_MOVE]);
  return sph->plan.walls ? sph_walls_shift(sph) : PART_OK;
}

void sph_density_sums(sph_t *sph) {
  const double own = sph->norm * sph_shape(sph->params.kernel, 0.0);
  for (int i = 0; i < sph->store->local; i++) {
    double *m = sph_mass(sph) + SPH_MASS * (size_t)i;
    const double inside = 1.0 - (sph->plan.walls ? sph->shade[i] : 0.0);
    m[1] = m[0] * (sph->sum[SPH_SUMS * (size_t)i + 5] + own) / inside;
  }
}

int sph_accelerations(sph_t *sph) {
  const sph_lanes lanes = sph_lanes_of(sph);
  part_timers_start(sph->timers, sph->stage[SPH_STAGE_FORCE]);
  const sph_pair_loop *loop = sph->plan.variable ? sph->loops->variable_force : sph->loops->force;
  loop[sph->params.kernel](&lanes, 0, sph->lists.rows, sph->sum);
  part_timers_stop(sph->timers, sph->stage[SPH_STAGE_FORCE]);
  memset(sph->wall_force, 0, sizeof sph->wall_force);
  if (sph->plan.walls)
    PART_TRY(sph_walls_force(sph));
  for (int i = 0; i < sph->store->local; i++) {
    const double *s = sph->sum + SPH_SUMS * (size_t)i;
    const double per_density = 1.0 / sph_mass(sph)[SPH_MASS * (size_t)i + 1];
    double *rate = sph_rate(sph) + SPH_RATE * (size_t)i;
    for (int c = 0; c < 3; c++)
      rate[c] = per_density * s[c];
  }
  return PART_OK;
}

static int check_particle(const sph_t *sph, int i) {
  const sph_params *p = &sph->params;
  const double *x = sph_xv(sph) + SPH_XV * (size_t)i, *m = sph_mass(sph) + SPH_MASS * (size_t)i;
  const double v2 = x[4] * x[4] + x[5] * x[5] + x[6] * x[6], density = m[1] / m[2];
  const char *what = NULL;
  if (!isfinite(x[0] + x[1] + x[2] + v2 + x[7]))
    what = "is not finite";
  else if (v2 > p->sound_speed * p->sound_speed)
    what =
        "is faster than sound: soundSpeed must be ten times the largest speed, or the step is too "
        "long";
  else if (!(density > 0.5 * p->density && density < 2.0 * p->density))
    what =
        "has lost half of its density or doubled it: soundSpeed is too low, or the step too long";
  if (what == NULL)
    return PART_OK;
  return part_fail(PART_ERR_NUMERIC,
                   "particle %lld at (%g %g %g) m, time %g s, velocity (%g %g %g) m/s, density %g "
                   "kg/m^3 %s",
                   (long long)sph_id(sph, i), x[0], x[1], x[2], sph->time, x[4], x[5], x[6],
                   density, what);
}

int sph_check_state(sph_t *sph) {
  int status = PART_OK;
  for (int i = 0; status == PART_OK && i < sph->store->local; i++)
    status = check_particle(sph, i);
  return part_agree(sph->comm, status);
}

/* S.15. The speed of sound of the mixture is c/sqrt(eps). */
int sph_limits(sph_t *sph, double *step, double *speed) {
  const sph_params *p = &sph->params;
  const double c = p->sound_speed;
  double h = p->smoothing_length, most[2] = {0.0, 0.0};
  if (sph->plan.variable)
    PART_TRY(sph_least_length(sph, &h));
  for (int i = 0; i < sph->store->local; i++) {
    const double *v = sph_xv(sph) + SPH_XV * (size_t)i + 4;
    const double *rate = sph_rate(sph) + SPH_RATE * (size_t)i;
    const double *force = sph_force(sph) + SPH_FORCE * (size_t)i;
    const double per_mass = 1.0 / sph_mass(sph)[SPH_MASS * (size_t)i];
    double a2 = 0.0;
    for (int k = 0; k < 3; k++) {
      const double a = rate[k] + p->gravity[k] + per_mass * force[k];
      a2 += a * a;
    }
    most[0] = fmax(most[0], v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    most[1] = fmax(most[1], a2);
  }
  if (MPI_Allreduce(MPI_IN_PLACE, most, 2, MPI_DOUBLE, MPI_MAX, sph->comm) != MPI_SUCCESS)
    return part_fail(PART_ERR_MPI, "a maximum over ranks failed");
  /* Along their line of centres, S.9 and S.10 damp a wave three times as fast as across it. nu of
   * S.10 is alpha h c/(2 (d + 2)). */
  const double nu = p->viscosity / p->density * (p->viscosity_model == SPH_MONAGHAN ? 3.0 : 1.0) +
                    3.0 * p->artificial_viscosity * h * c / (2.0 * ((double)p->dimensions + 2.0));
  *speed = sqrt(most[0]);
  *step = p->courant * h / (c / sqrt(sph->least_eps) + fmax(*speed, sph_walls_speed(sph)));
  if (nu > 0.0)
    *step = fmin(*step, p->viscous_fraction * h * h / nu);
  if (most[1] > 0.0)
    *step = fmin(*step, p->force_fraction * sqrt(h / sqrt(most[1])));
  *step = fmin(*step, fmin(sph_walls_longest_step(sph), sph_walls_motion_step(sph)));
  /* Rates from before the step make S.14 stable to half as far. */
  if (p->time_scheme == SPH_PREDICTOR_CORRECTOR)
    *step *= 0.5;
  return PART_OK;
}
