/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fluid at the particles, the force on them, and its reaction on the points.
 *
 *   combined   F = beta/eps (u - v) - rho V g            (Markauskas et al. 2017, eq. 23)
 *   gradient   F = beta (u - v) + V (-grad p + div tau)  (Robinson et al. 2014, eq. 23-25)
 *   pairwise   F = sum_a f_ia, points_pairwise.c          (Gao and Sun 2011, eq. 36-37)
 *
 * u, eps and -grad p + div tau = rho_bar times the points' acceleration are normalised kernel sums; with them
 * a sphere that is only partly in the fluid (at a free surface) gets its wet share of the force (P.6). */
#include <math.h>
#include "match.h"
#include "points_type.h"

static double norm3(const double *v) {
  return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* S below this share of its value in the midst of the fluid: the sphere is coming out of it. Above, S differs
 * from 1 by the disorder of the points alone. */
static const double WET = 0.9;

/* ---- sample --------------------------------------------------------------------------------- */
/* Columns of the sums: S, eps, u, then theta or p. */
enum { SUM = 0, EPS, U, MORE = 5, MOST = 8 };

static int width(const cpl_points_t *p) {
  return MORE + (p->params.form == CPL_POINTS_GRADIENT   ? 3
                 : p->params.form == CPL_POINTS_PAIRWISE ? 1
                                                         : 0);
}

static void point_row(const cpl_points_t *p, const cpl_fluid_points *fluid, int a, double *row) {
  const double v = p->share.data[a];
  const double *u = points_at(fluid->velocity, fluid->velocity_stride, a);
  row[SUM] = v;
  row[EPS] = v * p->eps.data[a];
  for (int c = 0; c < 3; c++)
    row[U + c] = v * u[c];
  if (p->params.form == CPL_POINTS_PAIRWISE)
    row[MORE] = v * *points_at(fluid->pressure, fluid->pressure_stride, a);
  if (p->params.form == CPL_POINTS_GRADIENT) {
    const double m = v * *points_at(fluid->density, fluid->density_stride, a);
    const double *rate = points_at(fluid->acceleration, fluid->acceleration_stride, a);
    for (int c = 0; c < 3; c++)
      row[MORE + c] = m * rate[c];
  }
}

static void add_visits(const cpl_points_t *p, int n, const double *rows, double *received) {
  for (int k = 0; k < p->received; k++) {
    double sum[MOST] = {0.0};
    for (size_t q = p->start.data[k]; q < p->start.data[k + 1]; q++) {
      const double w = p->weight.data[q], *row = rows + (size_t)p->partner.data[q] * (size_t)n;
      for (int d = 0; d < n; d++)
        sum[d] += w * row[d];
    }
    memcpy(received + (size_t)k * (size_t)n, sum, (size_t)n * sizeof *sum);
  }
}

static int sample(cpl_points_t *p, const cpl_fluid_points *fluid) {
  const int n = width(p);
  int status = CPL_RESERVE(p->work, (size_t)p->points * (size_t)n);
  if (status == PART_OK)
    status = CPL_RESERVE(p->work2, (size_t)p->count * (size_t)n);
  if (status == PART_OK)
    status = CPL_RESERVE(p->share, p->points);
  PART_TRY(part_agree(p->comm, status));
  for (int a = 0; a < p->points; a++) {
    p->share.data[a] = *points_at(fluid->volume, fluid->volume_stride, a);
    point_row(p, fluid, a, p->work.data + (size_t)a * (size_t)n);
  }
  add_visits(p, n, p->work.data, p->receive_buffer.data);
  return points_back(p, n, p->receive_buffer.data, p->work2.data);
}

/* Sauter mean diameter of the solids at each particle into mean[count]. */
static int sample_sizes(cpl_points_t *p, double *mean) {
  int status = CPL_RESERVE(p->work, 2 * (size_t)p->points);
  CPL_ARRAY(double) sums = {NULL, 0};
  if (status == PART_OK)
    status = CPL_RESERVE(sums, 2 * (size_t)p->count);
  status = part_agree(p->comm, status);
  if (status == PART_OK) {
    for (int k = 0; k < p->received; k++) {
      double sum[2] = {0.0, 0.0};
      for (size_t q = p->start.data[k]; q < p->start.data[k + 1]; q++) {
        const int a = p->partner.data[q];
        const double w = p->weight.data[q] * p->share.data[a];
        sum[0] += w * p->solid.data[a];
        sum[1] += w * p->by_size.data[a];
      }
      memcpy(p->receive_buffer.data + 2 * (size_t)k, sum, sizeof sum);
    }
    status = points_back(p, 2, p->receive_buffer.data, sums.data);
  }
  for (int i = 0; status == PART_OK && i < p->count; i++)
    mean[i] = sums.data[2 * i + 1] > 0.0 ? sums.data[2 * i] / sums.data[2 * i + 1] : 0.0;
  CPL_FREE(sums);
  return status;
}

/* ---- force ---------------------------------------------------------------------------------- */
static int check_force(const cpl_points_t *p, const cpl_particles *particles,
                       const cpl_fluid_points *fluid) {
  if (p->located != 2)
    return part_fail(PART_ERR_STATE,
                     "cpl_points_force: call cpl_points_locate and cpl_points_porosity first");
  if (fluid->count != p->points || particles->count != p->count)
    return part_fail(PART_ERR_STATE, "cpl_points_force: not the particles or points of cpl_points_locate");
  for (int i = 0; i < p->count; i++)
    if (particles->id[(size_t)i * (size_t)particles->id_stride] != p->id.data[i])
      return part_fail(PART_ERR_STATE, "cpl_points_force: the order of the particles is not that of "
                                       "cpl_points_locate");
  if (p->params.form == CPL_POINTS_GRADIENT && (!fluid->density || !fluid->acceleration) && p->points > 0)
    return part_fail(PART_ERR_ARGUMENT,
                     "cpl_points_force: form gradient needs density and acceleration of the points");
  if (p->params.form == CPL_POINTS_PAIRWISE && !fluid->pressure && p->points > 0)
    return part_fail(PART_ERR_ARGUMENT, "cpl_points_force: form pairwise needs the pressure of the points");
  if (p->params.self_disturbance && !particles->memory && p->count > 0)
    return part_fail(PART_ERR_ARGUMENT,
                     "coupling: selfDisturbance is on, but the particles have no memory");
  return PART_OK;
}

static int numeric(const cpl_points_t *p, const cpl_particles *particles, int i) {
  const double *x = points_at(particles->position, particles->position_stride, i);
  const double *u = p->velocity.data + 3 * (size_t)i;
  return part_fail(PART_ERR_NUMERIC,
                   "coupling: the fluid force on particle %lld at (%g %g %g) m is not finite (eps %g, fluid "
                   "velocity (%g %g %g) m/s)",
                   (long long)p->id.data[i], x[0], x[1], x[2], p->sampled_eps.data[i], u[0], u[1], u[2]);
}

/* Share of a sphere that is in the fluid, from the sum of its kernel over the points (P.6). */
static double wet_share(const cpl_points_t *p, const double *x, double sum) {
  const double gamma = p->kernel.gamma ? fmax(p->kernel.gamma(p->kernel.context, x), 1e-3) : 1.0;
  return fmin(sum / (WET * gamma), 1.0);
}

/* eps of the drag law. */
static double eps_around(const cpl_points_t *p, const cpl_particles *particles, int i) {
  return p->params.self_disturbance
             ? points_wake_eps(p, i, *points_at(particles->radius, particles->radius_stride, i))
             : p->sampled_eps.data[i];
}

/* beta of particle i, with the share by volume in the drag of the body it belongs to. */
static double drag_of(cpl_points_t *p, const cpl_particles *particles, int i, double eps, double slip, double mean) {
  const double rho = p->fluid.density, mu = p->fluid.viscosity;
  const double r = *points_at(particles->radius, particles->radius_stride, i);
  const double big = particles->drag_radius
                         ? *points_at(particles->drag_radius, particles->drag_radius_stride, i)
                         : r;
  const cpl_drag_range *range = cpl_drag_range_of(p->params.drag);
  const double re = eps * slip * 2.0 * big * rho / mu, share = r / big;
  p->outside += re < range->re_low || re > range->re_high || eps < range->eps_low ||
                eps > range->eps_high + 1e-12;
  return cpl_drag_function(p->params.drag)(slip, 2.0 * big, eps, rho, mu, mean > 0.0 ? mean : 2.0 * big) *
         share * share * share;
}

static int particle_force(cpl_points_t *p, cpl_particles *particles, int i, const double *row, double mean) {
  const int gradient = p->params.form == CPL_POINTS_GRADIENT, pairs = p->params.form == CPL_POINTS_PAIRWISE;
  double *su = particles->fluid_su + (size_t)i * (size_t)particles->fluid_su_stride;
  double *sp = particles->fluid_sp + (size_t)i * (size_t)particles->fluid_sp_stride;
  double *u = p->velocity.data + 3 * (size_t)i, slip = 0.0;
  const double *v = points_at(particles->velocity, particles->velocity_stride, i), sum = row[SUM];
  p->sum.data[i] = sum;
  *sp = su[0] = su[1] = su[2] = 0.0;
  p->wet.data[i] = 0.0;
  p->sampled_eps.data[i] = 1.0;
  u[0] = u[1] = u[2] = 0.0;
  if (pairs)
    p->pressure.data[i] = sum > 0.0 ? row[MORE] / sum : 0.0;
  if (!(sum > 0.0))
    return PART_OK; /* out of the fluid */
  const double eps = p->sampled_eps.data[i] = row[EPS] / sum;
  const double wet = p->wet.data[i] =
      wet_share(p, points_at(particles->position, particles->position_stride, i), sum);
  for (int c = 0; c < 3; c++)
    u[c] = row[U + c] / sum;
  if (p->params.self_disturbance)
    points_wake_subtract(p, particles, i, u);
  for (int c = 0; c < 3; c++) {
    slip += (u[c] - v[c]) * (u[c] - v[c]);
  }
  const double around = eps_around(p, particles, i);
  const double beta = drag_of(p, particles, i, around, sqrt(slip), mean) / (gradient || pairs ? 1.0 : around);
  *sp = wet * beta;
  for (int c = 0; c < 3; c++) {
    const double resting = -p->fluid.density * p->params.still[c];
    const double rest = gradient ? row[MORE + c] / sum + resting
                        : pairs  ? resting
                                 : -p->fluid.density * p->fluid.gravity[c];
    su[c] = wet * ((pairs ? 0.0 : beta * u[c]) + p->volume.data[i] * rest);
  }
  p->drag_rate = fmax(p->drag_rate, *sp * (1.0 - eps) / (p->volume.data[i] * p->fluid.density * eps));
  return isfinite(*sp + su[0] + su[1] + su[2]) ? PART_OK : numeric(p, particles, i);
}

static int reserve_force(cpl_points_t *p) {
  PART_TRY(CPL_RESERVE(p->sum, p->count));
  PART_TRY(CPL_RESERVE(p->sampled_eps, p->count));
  PART_TRY(CPL_RESERVE(p->velocity, 3 * (size_t)p->count));
  if (p->params.form == CPL_POINTS_PAIRWISE)
    PART_TRY(CPL_RESERVE(p->pressure, p->count));
  return CPL_RESERVE(p->wet, p->count);
}

static int force(cpl_points_t *p, cpl_particles *particles, const cpl_fluid_points *fluid) {
  const size_t n = (size_t)width(p);
  CPL_ARRAY(double) mean = {NULL, 0};
  p->force_count = -1;
  p->outside = 0;
  p->drag_rate = 0.0;
  int status = check_force(p, particles, fluid);
  if (status == PART_OK)
    status = reserve_force(p);
  if (status == PART_OK && points_uses_sizes(p))
    status = CPL_RESERVE(mean, p->count);
  status = part_agree(p->comm, status);
  if (status == PART_OK)
    status = sample(p, fluid);
  if (status == PART_OK && points_uses_sizes(p))
    status = sample_sizes(p, mean.data);
  for (int i = 0; status == PART_OK && i < p->count; i++)
    status = particle_force(p, particles, i, p->work2.data + (size_t)i * n, mean.data ? mean.data[i] : 0.0);
  CPL_FREE(mean);
  PART_TRY(part_agree(p->comm, status));
  if (p->params.form == CPL_POINTS_PAIRWISE)
    PART_TRY(points_pairwise_force(p, particles, fluid));
  p->force_count = p->count;
  return PART_OK;
}

int cpl_points_force(cpl_points_t *p, cpl_particles *particles, const cpl_fluid_points *fluid) {
  part_timers_start(p->timers, p->stage[POINTS_FORCE]);
  const int status = force(p, particles, fluid);
  part_timers_stop(p->timers, p->stage[POINTS_FORCE]);
  return status;
}

int cpl_points_stable_step(const cpl_points_t *p, double *step) {
  double rate = p->drag_rate;
  if (p->force_count < 0)
    return part_fail(PART_ERR_STATE, "cpl_points_stable_step: call cpl_points_force first");
  if (MPI_Allreduce(MPI_IN_PLACE, &rate, 1, MPI_DOUBLE, MPI_MAX, p->comm) != MPI_SUCCESS)
    return part_fail(PART_ERR_MPI, "coupling: a maximum over ranks failed");
  *step = rate > 0.0 && p->params.two_way ? p->params.drag_fraction / rate : HUGE_VAL;
  return PART_OK;
}

const double *cpl_points_sampled_eps(const cpl_points_t *p) {
  return p->sampled_eps.data;
}
const double *cpl_points_sampled_velocity(const cpl_points_t *p) {
  return p->velocity.data;
}
const double *cpl_points_wet(const cpl_points_t *p) {
  return p->wet.data;
}
int64_t cpl_points_outside_range(const cpl_points_t *p) {
  return p->outside;
}

/* ---- reaction ------------------------------------------------------------------------------- */
/* work2[count][3] = J/(S dt) in the order of the force, without what the pressure at rest gave (P.10). */
static int order_impulses(cpl_points_t *p, const cpl_particles *particles, double dt) {
  cpl_match *match = NULL;
  CPL_ARRAY(double) impulse = {NULL, 0};
  int status = CPL_RESERVE(p->id_work, particles->count);
  if (status == PART_OK)
    status = CPL_RESERVE(impulse, 3 * (size_t)particles->count);
  if (status == PART_OK)
    status = CPL_RESERVE(p->work2, 3 * (size_t)p->count);
  status = part_agree(p->comm, status);
  for (int i = 0; status == PART_OK && i < particles->count; i++) {
    p->id_work.data[i] = particles->id[(size_t)i * (size_t)particles->id_stride];
    memcpy(impulse.data + 3 * (size_t)i,
           points_at(particles->fluid_impulse, particles->fluid_impulse_stride, i), 3 * sizeof(double));
  }
  if (status == PART_OK)
    status = cpl_match_create(p->comm, particles->count, p->id_work.data, p->count, p->id.data,
                              "since cpl_points_force", &match);
  if (status == PART_OK)
    status = cpl_match_move(match, 3, impulse.data, p->work2.data);
  cpl_match_destroy(match);
  CPL_FREE(impulse);
  PART_TRY(status);
  memset(&p->budget, 0, sizeof p->budget);
  for (int i = 0; i < p->count; i++) {
    double *j = p->work2.data + 3 * (size_t)i;
    const double lift = p->wet.data[i] * p->volume.data[i] * p->fluid.density * dt;
    for (int c = 0; c < 3; c++) {
      j[c] += lift * p->params.still[c];
      p->budget.particles[c] += j[c];
      if (p->params.form == CPL_POINTS_PAIRWISE)
        j[c] -= dt * p->paired.data[3 * i + c]; /* which goes from pair to pair */
      j[c] = p->sum.data[i] > 0.0 ? j[c] / (p->sum.data[i] * dt) : 0.0;
    }
  }
  return PART_OK;
}

static void spread(cpl_points_t *p, const double *received, cpl_fluid_points *fluid) {
  for (int a = 0; a < p->points; a++) {
    double *f = fluid->force + (size_t)a * (size_t)fluid->force_stride;
    f[0] = f[1] = f[2] = 0.0;
  }
  for (int k = 0; k < p->received; k++) {
    const double *j = received + 3 * (size_t)k;
    for (size_t q = p->start.data[k]; q < p->start.data[k + 1]; q++) {
      const int a = p->partner.data[q];
      const double w = p->weight.data[q] * p->share.data[a];
      double *f = fluid->force + (size_t)a * (size_t)fluid->force_stride;
      for (int c = 0; c < 3; c++)
        f[c] -= w * j[c];
    }
  }
}

static int close_budget(cpl_points_t *p, const cpl_fluid_points *fluid, double dt) {
  double sum[7] = {0.0};
  for (int a = 0; a < p->points; a++) {
    const double *f = points_at(fluid->force, fluid->force_stride, a);
    for (int c = 0; c < 3; c++)
      sum[c] -= dt * f[c];
    sum[6] += dt * norm3(f);
  }
  memcpy(sum + 3, p->budget.particles, 3 * sizeof *sum);
  if (MPI_Allreduce(MPI_IN_PLACE, sum, 7, MPI_DOUBLE, MPI_SUM, p->comm) != MPI_SUCCESS)
    return part_fail(PART_ERR_MPI, "coupling: a sum over ranks failed");
  double difference[3];
  for (int c = 0; c < 3; c++) {
    p->budget.fluid[c] = sum[c];
    p->budget.particles[c] = sum[3 + c];
    difference[c] = sum[c] - sum[3 + c];
  }
  p->budget.error = sum[6] > 0.0 ? norm3(difference) / sum[6] : 0.0;
  p->has_budget = 1;
  return PART_OK;
}

static int reaction(cpl_points_t *p, const cpl_particles *particles, cpl_fluid_points *fluid, double dt) {
  double *received;
  int status = PART_OK;
  if (p->force_count < 0 || p->located != 2 || fluid->count != p->points)
    status = part_fail(PART_ERR_STATE, "cpl_points_reaction: call cpl_points_force first, and "
                                       "cpl_points_locate again only after it");
  else if (!isfinite(dt) || dt <= 0.0)
    status = part_fail(PART_ERR_RANGE, "cpl_points_reaction: dt = %g s; it must be > 0", dt);
  else if (!fluid->force && fluid->count > 0)
    status = part_fail(PART_ERR_ARGUMENT, "cpl_points_reaction: force of the points is NULL");
  PART_TRY(part_agree(p->comm, status));
  PART_TRY(order_impulses(p, particles, dt));
  PART_TRY(points_forward(p, 3, p->work2.data, &received));
  spread(p, received, fluid);
  if (p->params.form == CPL_POINTS_PAIRWISE)
    points_pairwise_react(p, fluid);
  if (p->params.self_disturbance)
    points_wake_remember(p, particles, dt);
  return close_budget(p, fluid, dt);
}

int cpl_points_reaction(cpl_points_t *p, const cpl_particles *particles, cpl_fluid_points *fluid,
                        double dt) {
  if (!p->params.two_way)
    return PART_OK;
  part_timers_start(p->timers, p->stage[POINTS_REACTION]);
  const int status = reaction(p, particles, fluid, dt);
  part_timers_stop(p->timers, p->stage[POINTS_REACTION]);
  return status;
}

int cpl_points_budget(const cpl_points_t *p, cpl_budget *budget) {
  if (!p->has_budget)
    return part_fail(PART_ERR_STATE, "cpl_points_budget: call cpl_points_reaction first");
  *budget = p->budget;
  return PART_OK;
}
