/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fluid quantities at the particles, and the force on them:
 *
 *   F = Su - Sp v = beta (u - v) - rho_f V g [- V grad p] [+ V div tau],   u = U/eps
 *
 * beta from the drag law; model B: beta/eps, which contains the force of the pressure gradient that
 * drag itself causes (Markauskas et al. 2017, eq. 23; Feng and Yu 2004). That gradient belongs to
 * the cells, so 1/eps is sum_c w_ic/eps_c and not one over the sampled eps: only then both models
 * have the same steady state where a sphere lies in cells of different eps. grad p without its
 * hydrostatic part: that is -rho_f V g.
 *
 * selfDisturbance: u is the sampled velocity without what the particle's own drag has given to it,
 * and the drag law has the sampled eps without the particle's own volume (wake.c).
 *
 * One-way coupling (Markauskas et al., section 6) is the same here: the flow has eps = 1 and no
 * source, but the particle's drag takes the void fraction that cpl_void_fraction found. The caller
 * gives that eps and superficial = eps u with it, whatever eps its flow equations use. */
#include <math.h>
#include <string.h>
#include "coupling_type.h"
#include "exchange.h"
#include "extra.h"
#include "drag/laws.h"
#include "sphere.h"
#include "virtual_mass.h"
#include "wake.h"

static int uses_pressure(const cpl_t *cpl) {
  return cpl->params.model != CPL_MODEL_B && cpl->params.pressure_gradient;
}

static int uses_sizes(const cpl_t *cpl) {
  return cpl_drag_needs_sizes(cpl->params.drag);
}

static inline double drag_radius(const cpl_t *cpl, const cpl_particles *p, int i) {
  return p->drag_radius ? *cpl_at(p->drag_radius, p->drag_radius_stride, i)
                        : cpl->sphere.data[4 * (size_t)i + 3];
}

/* ---- sample --------------------------------------------------------------------------------- */
/* Sauter mean diameter sum V_i/sum (V_i/d_i) of the cells, with the weights of the exchange, and
 * from there at the particles. */
static int sample_sizes(cpl_t *cpl, const cpl_particles *p) {
  const size_t cells = (size_t)cpl->mesh.cells, count = (size_t)cpl->count;
  int status = CPL_RESERVE(cpl->cell_work, 2 * cells);
  if (status == PART_OK)
    status = CPL_RESERVE(cpl->particle_work, 2 * count);
  if (status == PART_OK)
    status = CPL_RESERVE(cpl->mean_d, count);
  PART_TRY(cpl_agree(cpl, status));
  for (size_t i = 0; i < count; i++) {
    cpl->particle_work.data[2 * i] = cpl->volume.data[i];
    cpl->particle_work.data[2 * i + 1] = cpl->volume.data[i] / (2.0 * drag_radius(cpl, p, (int)i));
  }
  memset(cpl->cell_work.data, 0, 2 * cells * sizeof(double));
  PART_TRY(cpl_spread(cpl, 2, cpl->particle_work.data, cpl->cell_work.data));
  for (size_t c = 0; c < cells; c++) {
    const double *row = cpl->cell_work.data + 2 * c;
    cpl->cell_work.data[c] = row[1] > 0.0 ? row[0] / row[1] : 0.0;
  }
  return cpl_gather(cpl, 1, cpl->cell_work.data, cpl->mean_d.data);
}

static int check_cells(const cpl_t *cpl, const cpl_cells *cells) {
  if (!cells->eps || !cells->superficial)
    return part_fail(PART_ERR_ARGUMENT, "cpl_sample_fluid: needs eps and superficial of the cells");
  if (uses_pressure(cpl) && !cells->pressure_gradient)
    return part_fail(PART_ERR_ARGUMENT,
                     "cpl_sample_fluid: pressureGradient is on, but pressure_gradient is NULL");
  if (cpl->params.viscous_stress && !cells->stress_divergence)
    return part_fail(PART_ERR_ARGUMENT,
                     "cpl_sample_fluid: viscousStress is on, but stress_divergence is NULL");
  if (cpl_uses_curl(&cpl->params) && !cells->curl)
    return part_fail(PART_ERR_ARGUMENT,
                     "cpl_sample_fluid: lift or rotationalDrag is on, but curl is NULL");
  if (cpl->params.virtual_mass && !cells->acceleration)
    return part_fail(PART_ERR_ARGUMENT,
                     "cpl_sample_fluid: virtualMass is on, but acceleration is NULL");
  return PART_OK;
}

/* One row per cell: eps, U, curl u and Du/Dt where used, then -grad p and div tau where used; model
 * B: 1/eps last. */
static void gather_cells(cpl_t *cpl, const cpl_cells *cells, size_t n) {
  const int pressure = uses_pressure(cpl), stress = cpl->params.viscous_stress;
  const int curl = cpl_uses_curl(&cpl->params);
  for (size_t c = 0; c < (size_t)cpl->mesh.cells; c++) {
    double *row = cpl->cell_work.data + c * n;
    *row++ = cells->eps[c];
    for (size_t d = 0; d < 3; d++)
      *row++ = cells->superficial[3 * c + d];
    for (size_t d = 0; curl && d < 3; d++)
      *row++ = cells->curl[3 * c + d];
    for (size_t d = 0; cpl->params.virtual_mass && d < 3; d++)
      *row++ = cells->acceleration[3 * c + d];
    for (size_t d = 0; pressure && d < 3; d++)
      *row++ = -cells->pressure_gradient[3 * c + d];
    for (size_t d = 0; stress && d < 3; d++)
      *row++ = cells->stress_divergence[3 * c + d];
    if (cpl->params.model == CPL_MODEL_B)
      *row++ = 1.0 / cells->eps[c];
  }
}

static void scatter_particles(cpl_t *cpl, size_t n) {
  const int model_b = cpl->params.model == CPL_MODEL_B;
  const size_t last = n - (model_b ? 1 : 0), to_virtual = cpl_uses_curl(&cpl->params) ? 7 : 4;
  const size_t others = to_virtual + (cpl->params.virtual_mass ? 3 : 0);
  for (size_t i = 0; i < (size_t)cpl->count; i++) {
    const double *row = cpl->particle_work.data + i * n;
    cpl->eps.data[i] = row[0];
    memcpy(cpl->superficial.data + 3 * i, row + 1, 3 * sizeof *row);
    if (model_b)
      cpl->inverse_eps.data[i] = row[last];
    if (to_virtual > 4)
      memcpy(cpl->curl.data + 3 * i, row + 4, 3 * sizeof *row);
    if (others > to_virtual)
      memcpy(cpl->acceleration.data + 3 * i, row + to_virtual, 3 * sizeof *row);
    double *constant = cpl->constant.data + 3 * i;
    for (size_t d = 0; d < 3; d++) {
      constant[d] = 0.0;
      for (size_t k = others + d; k < last; k += 3)
        constant[d] += row[k];
      constant[d] *= cpl->volume.data[i];
    }
  }
}

static int sample_fluid(cpl_t *cpl, const cpl_particles *particles, const cpl_cells *cells) {
  const int curl = cpl_uses_curl(&cpl->params);
  const int n = 4 + 3 * (curl != 0) + 3 * (cpl->params.virtual_mass != 0) +
                3 * (uses_pressure(cpl) != 0) + 3 * (cpl->params.viscous_stress != 0) +
                (cpl->params.model == CPL_MODEL_B);
  const size_t count = (size_t)particles->count;
  int status = cpl_check_order(cpl, particles, "cpl_sample_fluid");
  if (status == PART_OK)
    status = check_cells(cpl, cells);
  if (status == PART_OK)
    status = CPL_RESERVE(cpl->cell_work, (size_t)cpl->mesh.cells * (size_t)n);
  if (status == PART_OK)
    status = CPL_RESERVE(cpl->particle_work, count * (size_t)n);
  if (status == PART_OK)
    status = CPL_RESERVE(cpl->eps, count);
  if (status == PART_OK)
    status = CPL_RESERVE(cpl->superficial, 3 * count);
  if (status == PART_OK)
    status = CPL_RESERVE(cpl->constant, 3 * count);
  if (status == PART_OK && !cpl->params.unresolved_drag)
    status = CPL_RESERVE(cpl->cell_flow, 3 * (size_t)cpl->mesh.cells);
  if (status == PART_OK && curl)
    status = CPL_RESERVE(cpl->curl, 3 * count);
  if (status == PART_OK && cpl->params.virtual_mass)
    status = CPL_RESERVE(cpl->acceleration, 3 * count);
  if (status == PART_OK && cpl->params.model == CPL_MODEL_B)
    status = CPL_RESERVE(cpl->inverse_eps, count);
  PART_TRY(cpl_agree(cpl, status));
  gather_cells(cpl, cells, (size_t)n);
  if (!cpl->params.unresolved_drag && cpl->mesh.cells > 0)
    memcpy(cpl->cell_flow.data, cells->superficial,
           3 * (size_t)cpl->mesh.cells * sizeof *cells->superficial);
  PART_TRY(cpl_gather(cpl, n, cpl->cell_work.data, cpl->particle_work.data));
  scatter_particles(cpl, (size_t)n);
  if (uses_sizes(cpl))
    PART_TRY(sample_sizes(cpl, particles));
  if (cpl->wake)
    PART_TRY(cpl_wake_spread(cpl));
  cpl->sample_stamp = cpl->stamp;
  return PART_OK;
}

int cpl_sample_fluid(cpl_t *cpl, const cpl_particles *particles, const cpl_cells *cells) {
  part_timers_start(cpl->timers, cpl->stage[CPL_SAMPLE]);
  const int status = sample_fluid(cpl, particles, cells);
  part_timers_stop(cpl->timers, cpl->stage[CPL_SAMPLE]);
  return status;
}

const double *cpl_sampled_eps(const cpl_t *cpl) {
  return cpl->eps.data;
}
const double *cpl_sampled_superficial(const cpl_t *cpl) {
  return cpl->superficial.data;
}

/* ---- force ---------------------------------------------------------------------------------- */
static int numeric(const cpl_t *cpl, int i, const char *what, double value) {
  const double *x = cpl->sphere.data + 4 * (size_t)i;
  return part_fail(PART_ERR_NUMERIC, "coupling: %s is %g at particle %lld at (%g %g %g) m", what,
                   value, (long long)cpl->id.data[i], x[0], x[1], x[2]);
}

/* Not finite anywhere, or no room for fluid: name the quantity. */
static int check_sampled(const cpl_t *cpl, int i, const double *velocity) {
  const double *u = cpl->superficial.data + 3 * (size_t)i;
  const double *constant = cpl->constant.data + 3 * (size_t)i;
  if (!isfinite(cpl->eps.data[i]) || cpl->eps.data[i] <= 0.0)
    return numeric(cpl, i, "the void fraction", cpl->eps.data[i]);
  for (int d = 0; d < 3; d++) {
    if (!isfinite(u[d]))
      return numeric(cpl, i, "the superficial velocity", u[d]);
    if (!isfinite(velocity[d]))
      return numeric(cpl, i, "the particle velocity", velocity[d]);
    if (!isfinite(constant[d]))
      return numeric(cpl, i, "the pressure gradient or stress force", constant[d]);
  }
  return PART_OK;
}

static const double NO_WAKE[3] = {0.0, 0.0, 0.0};

static inline __attribute__((always_inline)) int
force_loop(cpl_t *cpl, cpl_particles *p, cpl_drag_law law, cpl_drag_range range, int sizes) {
  const double rho = cpl->fluid.density, mu = cpl->fluid.viscosity;
  const int model_b = cpl->params.model == CPL_MODEL_B;
  for (int i = 0; i < cpl->count; i++) {
    const double *v = cpl_at(p->velocity, p->velocity_stride, i);
    PART_TRY(check_sampled(cpl, i, v));
    const double eps = cpl->eps.data[i], volume = cpl->volume.data[i];
    const double *superficial = cpl->superficial.data + 3 * (size_t)i;
    const double *constant = cpl->constant.data + 3 * (size_t)i;
    const double *own = cpl->wake ? cpl->disturbance.data + 3 * (size_t)i : NO_WAKE;
    const double to_interstitial = 1.0 / eps;
    double u[3], slip2 = 0.0;
    for (int d = 0; d < 3; d++) {
      u[d] = superficial[d] * to_interstitial - own[d];
      slip2 += (u[d] - v[d]) * (u[d] - v[d]);
    }
    const double slip = sqrt(slip2), d_i = 2.0 * drag_radius(cpl, p, i);
    const double around =
        cpl->wake ? cpl_wake_eps(volume, cpl->spread.data[2 * (size_t)i + 1], eps) : eps;
    const double re = around * slip * d_i * rho / mu;
    cpl->outside += re < range.re_low || re > range.re_high || around < range.eps_low ||
                    around > range.eps_high + 1e-12; /* rounding of eps = 1 */
    double beta = law(slip, d_i, around, rho, mu, sizes ? cpl->mean_d.data[i] : d_i);
    if (p->drag_radius) /* the share by volume in the drag of the larger sphere */
      beta *= volume / cpl_sphere_volume(0.5 * d_i);
    if (model_b)
      beta *= cpl->inverse_eps.data[i] * (eps / around);
    if (!isfinite(beta))
      return numeric(cpl, i, "the drag coefficient", beta);
    double *su = p->fluid_su + (size_t)i * (size_t)p->fluid_su_stride;
    double *state = cpl->force.data + (size_t)i * CPL_FORCE_WIDTH;
    for (int d = 0; d < 3; d++) {
      const double c = constant[d] - rho * volume * cpl->fluid.gravity[d];
      su[d] = beta * u[d] + c;
      state[CPL_FORCE_U + d] = superficial[d];
      state[CPL_FORCE_CONSTANT + d] = c;
    }
    p->fluid_sp[(size_t)i * (size_t)p->fluid_sp_stride] = beta;
    state[CPL_FORCE_SP] = beta;
    state[CPL_FORCE_EPS] = eps;
    state[CPL_FORCE_EXTRA] = state[CPL_FORCE_EXTRA + 1] = state[CPL_FORCE_EXTRA + 2] = 0.0;
  }
  return PART_OK;
}

/* One loop per law, with the law inlined. */
#define CPL_DRAG(name, function, re_low, re_high, eps_low, eps_high, sizes, meaning)               \
  static int force_##name(cpl_t *cpl, cpl_particles *p) {                                          \
    const cpl_drag_range range = {re_low, re_high, eps_low, eps_high};                             \
    return force_loop(cpl, p, function, range, sizes);                                             \
  }
#include "coupling/drag_laws.def"
#undef CPL_DRAG

static int (*const force_loops[])(cpl_t *, cpl_particles *) = {
#define CPL_DRAG(name, function, re_low, re_high, eps_low, eps_high, sizes, meaning) force_##name,
#include "coupling/drag_laws.def"
#undef CPL_DRAG
};

static int fluid_force(cpl_t *cpl, cpl_particles *particles) {
  PART_TRY(cpl_check_order(cpl, particles, "cpl_fluid_force"));
  if (cpl->sample_stamp != cpl->stamp)
    return part_fail(PART_ERR_STATE, "cpl_fluid_force: call cpl_sample_fluid after cpl_locate");
  cpl->force_count = -1;
  cpl->outside = 0;
  PART_TRY(CPL_RESERVE(cpl->force, (size_t)cpl->count * CPL_FORCE_WIDTH));
  PART_TRY(CPL_RESERVE(cpl->force_id, cpl->count));
  if (cpl->wake)
    PART_TRY(cpl_wake_velocity(cpl, particles));
  PART_TRY(force_loops[cpl->params.drag](cpl, particles));
  if (cpl_uses_curl(&cpl->params))
    PART_TRY(cpl_extra_forces(cpl, particles));
  if (cpl->params.virtual_mass)
    PART_TRY(cpl_virtual_force(cpl, particles));
  if (cpl->count > 0)
    memcpy(cpl->force_id.data, cpl->id.data, (size_t)cpl->count * sizeof(int64_t));
  cpl->force_count = cpl->count;
  return PART_OK;
}

int cpl_fluid_force(cpl_t *cpl, cpl_particles *particles) {
  part_timers_start(cpl->timers, cpl->stage[CPL_FORCE]);
  const int status = fluid_force(cpl, particles);
  part_timers_stop(cpl->timers, cpl->stage[CPL_FORCE]);
  return status;
}

const double *cpl_own_disturbance(const cpl_t *cpl) {
  return cpl->wake ? cpl->disturbance.data : NULL;
}

int64_t cpl_outside_range(const cpl_t *cpl) {
  return cpl->outside;
}
