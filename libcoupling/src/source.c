/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the fluid gives the particles, and gets back.
 *
 * With J_i the drag impulse that particle i really received over dt, and
 *   b_i = (m_i/eps_i) (1 - exp(-beta_i dt/m_i))/dt        (fixed, blocks: beta_i/eps_i),
 * the flow step sees the drag -(D U - G) per mixture volume with
 *   D_c = sum_i w_ic b_i / V_c,     G_c = sum_i w_ic (b_i U_i - J_i/dt) / V_c.
 * When U has not changed since it was sampled this is -J_i/dt exactly. When it has, the drag grows
 * by b_i dU, what a particle takes that relaxes towards the new velocity: never more than m_i du.
 * The difference between what the fluid then really gave and J_i is the particle's kick.
 *
 * In a cell it is not: there b_i (U_c - U_i) comes to it, a drag on motion smaller than the weights
 * of a sphere, which particles do not get before their kicks. It acts like a viscosity, b per
 * volume times the variance of the weights. Without unresolvedDrag it is taken out, with the flow
 * that was sampled and the weights of now:
 *   G_c = sum_i w_ic [b_i (U_i + U_c - sum_c w_ic U_c) - J_i/dt] / V_c.
 *
 * J_i holds the extra forces too (lift, virtual mass), so G gives them back to the cells.
 *
 * Model B: the momentum of a sphere goes to its cells as w_ic/eps_c, see forces.c; with
 * e_i = sum_c w_ic/eps_c, D_c = sum_i w_ic b_i/(e_i eps_c V_c), and G_c likewise. */
#include <math.h>
#include <string.h>
#include "coupling_type.h"
#include "exchange.h"
#include "extra.h"
#include "match.h"
#include "virtual_mass.h"

/* ---- orders --------------------------------------------------------------------------------- */
/* From the order of a view to that of cpl_locate. */
static int match_view(cpl_t *cpl, const cpl_particles *p, cpl_match **match) {
  int status = CPL_RESERVE(cpl->id_work, p->count);
  PART_TRY(cpl_agree(cpl, status));
  for (int i = 0; i < p->count; i++)
    cpl->id_work.data[i] = p->id[(size_t)i * (size_t)p->id_stride];
  return cpl_match_create(cpl->comm, p->count, cpl->id_work.data, cpl->count, cpl->id.data,
                          "since cpl_locate", match);
}

/* particle_work[count][CPL_FORCE_WIDTH] = force state in the order of cpl_locate. */
static int order_force(cpl_t *cpl) {
  cpl_match *match;
  PART_TRY(cpl_match_create(cpl->comm, cpl->force_count, cpl->force_id.data, cpl->count,
                            cpl->id.data, "since cpl_fluid_force", &match));
  int status = CPL_RESERVE(cpl->particle_work, (size_t)cpl->count * CPL_FORCE_WIDTH);
  status = cpl_agree(cpl, status);
  if (status == PART_OK)
    status = cpl_match_move(match, CPL_FORCE_WIDTH, cpl->force.data, cpl->particle_work.data);
  cpl_match_destroy(match);
  return status;
}

/* Of a particle: impulse received, inverse mass (0: fixed, or member of a block), and m_a dv if
 * virtualMass asks for it.
 */
enum { IMPULSE = 0, INVERSE_MASS = 3, ADDED = 4, IMPULSE_WIDTH = 7 };

static int impulse_width(const cpl_t *cpl) {
  return cpl->params.virtual_mass ? IMPULSE_WIDTH : ADDED;
}

/* particle_work2[count][impulse_width] in the order of cpl_locate. */
static int order_impulse(cpl_t *cpl, const cpl_particles *p) {
  const int width = impulse_width(cpl);
  cpl_match *match;
  PART_TRY(match_view(cpl, p, &match));
  CPL_ARRAY(double) view = {NULL, 0};
  int status = CPL_RESERVE(view, (size_t)width * (size_t)p->count);
  if (status == PART_OK)
    status = CPL_RESERVE(cpl->particle_work2, (size_t)width * (size_t)cpl->count);
  status = cpl_agree(cpl, status);
  for (int i = 0; status == PART_OK && i < p->count; i++) {
    double *row = view.data + (size_t)width * (size_t)i;
    cpl_received(cpl, p, i, row + IMPULSE, width > ADDED ? row + ADDED : NULL);
    const int64_t kind = p->kind ? p->kind[(size_t)i * (size_t)p->kind_stride] : CPL_FREE_SPHERE;
    row[INVERSE_MASS] = kind == CPL_FIXED_SPHERE || kind == CPL_BLOCK_MEMBER
                            ? 0.0
                            : *cpl_at(p->inverse_mass, p->inverse_mass_stride, i);
  }
  if (status == PART_OK)
    status = cpl_match_move(match, width, view.data, cpl->particle_work2.data);
  CPL_FREE(view);
  cpl_match_destroy(match);
  return status;
}

/* ---- source --------------------------------------------------------------------------------- */
/* (1 - exp(-x))/x, x >= 0 */
static double relaxed(double x) {
  return x > 0.0 ? -expm1(-x) / x : 1.0;
}

/* 1/eps_c, and sum_c w_ic/eps_c where the particles are now. */
static int sample_inverse_eps(cpl_t *cpl, const cpl_cells *cells) {
  for (size_t c = 0; c < (size_t)cpl->mesh.cells; c++)
    cpl->reps.data[c] = 1.0 / cells->eps[c];
  return cpl_gather(cpl, 1, cpl->reps.data, cpl->inverse_eps.data);
}

static const double NONE[3] = {0.0, 0.0, 0.0};

/* particle_work: force states; particle_work2: impulses, becomes [count][4] with the values to
 * deposit, b and g. */
static int implicit_parts(cpl_t *cpl, double dt) {
  const int model_b = cpl->params.model == CPL_MODEL_B, width = impulse_width(cpl);
  const int lifted = cpl->wake && cpl_uses_extra(&cpl->params);
  for (size_t i = 0; i < (size_t)cpl->count; i++) {
    const double *force = cpl->particle_work.data + i * CPL_FORCE_WIDTH;
    const double *from = cpl->particle_work2.data + i * (size_t)width;
    double *row = cpl->particle_work2.data + 4 * i; /* never ahead of from */
    double *told = cpl->told.data + 3 * i, g[3];
    const double *now = cpl->params.unresolved_drag ? NONE : cpl->resampled.data + 3 * i;
    const double sp = force[CPL_FORCE_SP];
    const double b = sp * relaxed(sp * dt * from[INVERSE_MASS]) / force[CPL_FORCE_EPS];
    for (int d = 0; d < 3; d++) {
      if (lifted)
        cpl->extra.data[3 * i + (size_t)d] =
            force[CPL_FORCE_EXTRA + d] - (width > ADDED ? from[ADDED + d] / dt : 0.0);
      told[d] = from[IMPULSE + d] / dt - force[CPL_FORCE_CONSTANT + d];
      g[d] = b * (force[CPL_FORCE_U + d] - now[d]) - told[d];
    }
    if (!isfinite(b) || !isfinite(g[0]) || !isfinite(g[1]) || !isfinite(g[2]))
      return part_fail(PART_ERR_NUMERIC,
                       "coupling: the momentum source of particle %lld is not finite (impulse (%g "
                       "%g %g) N s, drag coefficient %g kg/s)",
                       (long long)cpl->id.data[i], from[0], from[1], from[2], sp);
    const double part = model_b ? 1.0 / cpl->inverse_eps.data[i] : 1.0;
    cpl->implicit.data[i] = b * part;
    row[0] = b * part;
    for (int d = 0; d < 3; d++)
      row[1 + d] = g[d] * part;
  }
  return PART_OK;
}

static void write_source(cpl_t *cpl, cpl_cells *cells) {
  const int model_b = cpl->params.model == CPL_MODEL_B;
  for (size_t c = 0; c < (size_t)cpl->mesh.cells; c++) {
    const double *row = cpl->cell_work.data + 4 * c;
    const double volume = cpl->mesh.volume[c] * (model_b ? cells->eps[c] : 1.0);
    cpl->share.data[c] = row[0];
    cells->drag_coefficient[c] = row[0] / volume;
    for (size_t d = 0; d < 3; d++) {
      const double own =
          cpl->params.unresolved_drag ? 0.0 : row[0] * cpl->cell_flow.data[3 * c + d];
      cells->drag_explicit[3 * c + d] = (row[1 + d] + own) / volume;
    }
  }
}

static int check_source(const cpl_t *cpl, const cpl_cells *cells, double dt) {
  if (!cells->drag_coefficient || !cells->drag_explicit)
    return part_fail(PART_ERR_ARGUMENT,
                     "cpl_momentum_source: needs drag_coefficient and drag_explicit of the cells");
  if (cpl->params.two_way && cpl->params.model == CPL_MODEL_B && !cells->eps)
    return part_fail(PART_ERR_ARGUMENT, "cpl_momentum_source: model B needs eps of the cells");
  if (!isfinite(dt) || dt <= 0.0)
    return part_fail(PART_ERR_RANGE, "cpl_momentum_source: dt = %g s; it must be > 0", dt);
  if (cpl->params.two_way && cpl->stamp == 0)
    return part_fail(PART_ERR_STATE, "cpl_momentum_source: call cpl_locate first");
  if (cpl->params.two_way && cpl->force_count < 0)
    return part_fail(PART_ERR_STATE, "cpl_momentum_source: call cpl_fluid_force first");
  return PART_OK;
}

static int reserve_source(cpl_t *cpl) {
  const size_t n = (size_t)cpl->mesh.cells, count = (size_t)cpl->count;
  PART_TRY(CPL_RESERVE(cpl->implicit, count));
  PART_TRY(CPL_RESERVE(cpl->told, 3 * count));
  PART_TRY(CPL_RESERVE(cpl->cell_work, 4 * n));
  if (!cpl->params.unresolved_drag)
    PART_TRY(CPL_RESERVE(cpl->resampled, 3 * count));
  if (cpl->wake && cpl_uses_extra(&cpl->params))
    PART_TRY(CPL_RESERVE(cpl->extra, 3 * count));
  if (cpl->params.model != CPL_MODEL_B)
    return PART_OK;
  PART_TRY(CPL_RESERVE(cpl->inverse_eps, count));
  return CPL_RESERVE(cpl->reps, n);
}

static int momentum_source(cpl_t *cpl, const cpl_particles *particles, cpl_cells *cells,
                           double dt) {
  const size_t n = (size_t)cpl->mesh.cells;
  PART_TRY(cpl_agree(cpl, check_source(cpl, cells, dt)));
  if (!cpl->params.two_way) {
    memset(cells->drag_coefficient, 0, n * sizeof(double));
    memset(cells->drag_explicit, 0, 3 * n * sizeof(double));
    return PART_OK;
  }
  PART_TRY(order_force(cpl));
  PART_TRY(order_impulse(cpl, particles));
  int status = reserve_source(cpl);
  PART_TRY(cpl_agree(cpl, status));
  if (cpl->params.model == CPL_MODEL_B)
    PART_TRY(sample_inverse_eps(cpl, cells));
  if (!cpl->params.unresolved_drag)
    PART_TRY(cpl_gather(cpl, 3, cpl->cell_flow.data, cpl->resampled.data));
  status = implicit_parts(cpl, dt);
  PART_TRY(cpl_agree(cpl, status));
  memset(cpl->cell_work.data, 0, 4 * n * sizeof(double));
  PART_TRY(cpl_spread(cpl, 4, cpl->particle_work2.data, cpl->cell_work.data));
  write_source(cpl, cells);
  cpl->source_stamp = cpl->stamp;
  return PART_OK;
}

int cpl_momentum_source(cpl_t *cpl, const cpl_particles *particles, cpl_cells *cells, double dt) {
  part_timers_start(cpl->timers, cpl->stage[CPL_SOURCE]);
  const int status = momentum_source(cpl, particles, cells, dt);
  part_timers_stop(cpl->timers, cpl->stage[CPL_SOURCE]);
  return status;
}
