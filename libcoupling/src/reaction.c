/* SPDX-License-Identifier: GPL-3.0-or-later */
/* After the flow step: what the fluid really gave up in each cell goes to the particles there, and
 * the momentum budget of the exchange.
 *
 *   kick_i = T_i dt + b_i sum_c w_ic (R_c - T_c dt)/S_c + V_i sum_c w_ic Q_c/s_c
 *            - (impulse_i - buoyancy_i dt)
 *
 * with R, Q the reactions through drag and through pressure and stress, T_i the drag and extra
 * forces that the cells were told of (source.c) and T_c their deposit, S_c = sum_i w_ic b_i and s_c
 * = sum_i w_ic V_i. So what is shared as drag coefficients is only what the change of the fluid's
 * velocity made: particles of one cell that move against each other, or have opposite lifts, each
 * keep their own. The sum over particles gives every R_c and Q_c exactly once. Buoyancy -rho_f V g
 * is known on both sides and is no part of the reactions. */
#include <math.h>
#include <string.h>
#include "coupling_type.h"
#include "exchange.h"
#include "match.h"
#include "virtual_mass.h"
#include "wake.h"
#include "sphere.h"

static const double ZERO[3] = {0.0, 0.0, 0.0};

static int finite3(const double *x) {
  return isfinite(x[0]) && isfinite(x[1]) && isfinite(x[2]);
}
static int zero3(const double *x) {
  return x[0] == 0.0 && x[1] == 0.0 && x[2] == 0.0;
}
static double norm3(const double *x) {
  return sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
}

static int bad_cell(const cpl_t *cpl, size_t c, int status, const char *what, const double *r) {
  const double *x = cpl->mesh.cell_centre + 3 * c;
  return part_fail(status, "cpl_reaction: (%g %g %g) N s in cell %zu at (%g %g %g) m %s", r[0],
                   r[1], r[2], c, x[0], x[1], x[2], what);
}

/* What the cells were told, at the particles' present place. */
static int deposit_told(cpl_t *cpl) {
  const int model_b = cpl->params.model == CPL_MODEL_B;
  const size_t n = 3 * (size_t)cpl->mesh.cells, count = 3 * (size_t)cpl->count;
  PART_TRY(cpl_agree(cpl, CPL_RESERVE(cpl->cell_told, n)));
  memset(cpl->cell_told.data, 0, n * sizeof *cpl->cell_told.data);
  const double *value = cpl->told.data;
  for (size_t k = 0; model_b && k < count; k++)
    cpl->particle_work2.data[k] = cpl->told.data[k] / cpl->inverse_eps.data[k / 3];
  PART_TRY(cpl_spread(cpl, 3, model_b ? cpl->particle_work2.data : value, cpl->cell_told.data));
  for (size_t k = 0; model_b && k < n; k++)
    cpl->cell_told.data[k] *= cpl->reps.data[k / 3];
  return PART_OK;
}

/* cell_work[cells][6] = (R - T dt)/S and Q/s; T 0 without kicks. dt: of the reactions. Drag in a cell whose particles
 * have no drag coefficient (all b_i = 0) is shared by volume. */
static int divide(cpl_t *cpl, const double *drag, const double *volume, double dt, int kicks) {
  for (size_t c = 0; c < (size_t)cpl->mesh.cells; c++) {
    const double *q = volume ? volume + 3 * c : ZERO;
    double r[3];
    for (size_t d = 0; d < 3; d++)
      r[d] = (drag ? drag[3 * c + d] : 0.0) - (kicks ? cpl->cell_told.data[3 * c + d] * dt : 0.0);
    double *row = cpl->cell_work.data + 6 * c;
    memset(row, 0, 6 * sizeof *row);
    if (!finite3(r) || !finite3(q))
      return bad_cell(cpl, c, PART_ERR_NUMERIC, "is not finite", finite3(r) ? q : r);
    if (zero3(r) && zero3(q))
      continue;
    const double solid = cpl->solid.data[c], share = cpl->share.data[c];
    if (!(solid > 0.0))
      return bad_cell(cpl, c, PART_ERR_ARGUMENT, "without particles there", zero3(r) ? q : r);
    for (int d = 0; d < 3; d++) {
      if (share > 0.0)
        row[d] = r[d] / share;
      row[3 + d] = (q[d] + (share > 0.0 ? 0.0 : r[d])) / solid;
    }
  }
  return PART_OK;
}

/* kick[view order] = what they were told, and shares of the rest. */
static int share_out(cpl_t *cpl, const cpl_particles *p, double dt, int remember, double *kick) {
  PART_TRY(cpl_gather(cpl, 6, cpl->cell_work.data, cpl->particle_work.data));
  for (size_t i = 0; i < (size_t)cpl->count; i++)
    for (size_t d = 0; d < 3; d++)
      cpl->particle_work2.data[3 * i + d] =
          cpl->told.data[3 * i + d] * dt +
          cpl->implicit.data[i] * cpl->particle_work.data[6 * i + d] +
          cpl->volume.data[i] * cpl->particle_work.data[6 * i + 3 + d];
  int status = CPL_RESERVE(cpl->id_work, p->count);
  PART_TRY(cpl_agree(cpl, status));
  for (int i = 0; i < p->count; i++)
    cpl->id_work.data[i] = p->id[(size_t)i * (size_t)p->id_stride];
  cpl_match *match;
  PART_TRY(cpl_match_create(cpl->comm, cpl->count, cpl->id.data, p->count, cpl->id_work.data,
                            "since cpl_locate", &match));
  status = cpl_match_move(match, 3, cpl->particle_work2.data, kick);
  if (status == PART_OK && remember && cpl->wake)
    status = cpl_wake_remember(cpl, p, match, dt);
  cpl_match_destroy(match);
  return status;
}

/* ---- budget --------------------------------------------------------------------------------- */
enum { FLUID = 0, PARTICLES = 3, REACTIONS = 6, BUOYANCY, IMPULSES, KICKS, TERMS };

/* Take from the kicks what was already received in this part of the step, and add up both sides. */
static void settle(const cpl_t *cpl, const cpl_particles *p, double dt, double part, double *kick,
                   double *sum) {
  for (int i = 0; i < p->count; i++) {
    double impulse[3];
    cpl_received(cpl, p, i, impulse, NULL);
    const double mass =
        cpl->fluid.density * cpl_sphere_volume(*cpl_at(p->radius, p->radius_stride, i));
    double *k = kick + 3 * (size_t)i, buoyancy[3];
    for (int d = 0; d < 3; d++) {
      buoyancy[d] = -mass * cpl->fluid.gravity[d] * dt;
      k[d] -= part * (impulse[d] - buoyancy[d]);
      sum[FLUID + d] += buoyancy[d];
      sum[PARTICLES + d] += impulse[d] + k[d];
    }
    sum[BUOYANCY] += norm3(buoyancy);
    sum[IMPULSES] += norm3(impulse);
    sum[KICKS] += norm3(k);
  }
}

/* No particle can move: what the cells' particles got together, without a pass over them. */
static void settle_cells(const cpl_t *cpl, double dt, double *sum) {
  double solid = 0.0, weight[3];
  for (int i = 0; i < cpl->count; i++)
    solid += cpl->volume.data[i];
  for (int d = 0; d < 3; d++) {
    weight[d] = -cpl->fluid.density * solid * cpl->fluid.gravity[d] * dt;
    sum[FLUID + d] += weight[d];
    sum[PARTICLES + d] += weight[d];
  }
  sum[BUOYANCY] += norm3(weight);
  for (size_t c = 0; c < (size_t)cpl->mesh.cells; c++)
    for (size_t d = 0; d < 3; d++)
      sum[PARTICLES + d] += cpl->cell_work.data[6 * c + d] * cpl->share.data[c] +
                            cpl->cell_work.data[6 * c + 3 + d] * cpl->solid.data[c];
}

static void close_budget(cpl_t *cpl, const double *drag, const double *volume, double *sum) {
  for (size_t c = 0; c < (size_t)cpl->mesh.cells; c++) {
    const double *r = drag ? drag + 3 * c : ZERO, *q = volume ? volume + 3 * c : ZERO;
    for (int d = 0; d < 3; d++)
      sum[FLUID + d] += r[d] + q[d];
    sum[REACTIONS] += norm3(r) + norm3(q);
  }
  if (cpl->size > 1)
    MPI_Allreduce(MPI_IN_PLACE, sum, TERMS, MPI_DOUBLE, MPI_SUM, cpl->comm);
  double difference[3], largest = 0.0;
  for (int d = 0; d < 3; d++) {
    cpl->budget.fluid[d] = sum[FLUID + d];
    cpl->budget.particles[d] = sum[PARTICLES + d];
    difference[d] = sum[FLUID + d] - sum[PARTICLES + d];
  }
  for (int k = REACTIONS; k < TERMS; k++)
    largest = fmax(largest, sum[k]);
  cpl->budget.error = largest > 0.0 ? norm3(difference) / largest : 0.0;
  cpl->has_budget = 1;
}

static int check_reaction(const cpl_t *cpl, double dt, const double *kick) {
  if (!kick && cpl->wake)
    return part_fail(PART_ERR_ARGUMENT, "cpl_reaction: selfDisturbance needs the kicks");
  if (!cpl->params.two_way)
    return part_fail(PART_ERR_STATE, "cpl_reaction: twoWay is off: the fluid gives nothing up");
  if (cpl->stamp == 0 || cpl->source_stamp != cpl->stamp || cpl->solid_stamp != cpl->stamp)
    return part_fail(PART_ERR_STATE, "cpl_reaction: call cpl_void_fraction and "
                                     "cpl_momentum_source after cpl_locate");
  if (!isfinite(dt) || dt <= 0.0)
    return part_fail(PART_ERR_RANGE, "cpl_reaction: dt = %g s; it must be > 0", dt);
  return PART_OK;
}

/* probe: of the first part of the step, and nothing but the kicks. */
static int reaction(cpl_t *cpl, const cpl_particles *particles, const double *drag,
                    const double *volume, double dt, double part, int probe, double *kick) {
  int status = check_reaction(cpl, dt, kick);
  if (status == PART_OK)
    status = CPL_RESERVE(cpl->cell_work, 6 * (size_t)cpl->mesh.cells);
  if (status == PART_OK)
    status = CPL_RESERVE(cpl->particle_work, 6 * (size_t)cpl->count);
  if (status == PART_OK)
    status = CPL_RESERVE(cpl->particle_work2, 3 * (size_t)cpl->count);
  PART_TRY(cpl_agree(cpl, status));
  if (kick)
    PART_TRY(deposit_told(cpl));
  PART_TRY(cpl_agree(cpl, divide(cpl, drag, volume, part * dt, kick != NULL)));
  double sum[TERMS] = {0.0};
  if (kick) {
    if (cpl->wake && !probe)
      PART_TRY(cpl_wake_spread(cpl)); /* the particles have moved since cpl_sample_fluid */
    PART_TRY(share_out(cpl, particles, part * dt, !probe, kick));
    settle(cpl, particles, dt, part, kick, sum);
  } else {
    settle_cells(cpl, dt, sum);
  }
  if (!probe)
    close_budget(cpl, drag, volume, sum);
  return PART_OK;
}

int cpl_reaction(cpl_t *cpl, const cpl_particles *particles, const double *drag_reaction,
                 const double *volume_reaction, double dt, double *kick) {
  part_timers_start(cpl->timers, cpl->stage[CPL_REACT]);
  const int status =
      reaction(cpl, particles, drag_reaction, volume_reaction, dt, 1.0, 0, kick);
  part_timers_stop(cpl->timers, cpl->stage[CPL_REACT]);
  return status;
}

int cpl_foresee_kick(cpl_t *cpl, const cpl_particles *particles, const double *drag_reaction,
                     const double *volume_reaction, double dt, double part, double *kick) {
  if (!kick || !(part > 0.0) || part > 1.0)
    return part_fail(PART_ERR_ARGUMENT,
                     "cpl_foresee_kick: needs room for the kicks, and a part of the step in (0, 1]");
  part_timers_start(cpl->timers, cpl->stage[CPL_REACT]);
  const int status = reaction(cpl, particles, drag_reaction, volume_reaction, dt, part, 1, kick);
  part_timers_stop(cpl->timers, cpl->stage[CPL_REACT]);
  return status;
}

int cpl_get_budget(const cpl_t *cpl, cpl_budget *budget) {
  if (!cpl->has_budget)
    return part_fail(PART_ERR_STATE, "cpl_get_budget: call cpl_reaction first");
  *budget = cpl->budget;
  return PART_OK;
}
