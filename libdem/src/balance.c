/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decomposition by cost: when the load of ranks has drifted apart, and new parts of equal cost.
 *
 * What it costs is known from the lists just built; the parts are made at the next rebuild, when
 * those lists are still there. So a restarted run, which builds the lists that were there when the
 * file was written, decides as the one that went on. */
#include "internal.h"

/* Own cost of the largest rank above the mean, in particles, before balancing is worth it. */
static const double worth_balancing = 16.0;
/* The ratio that was reached (last time, or since without balancing) may not get this much worse before it is tried again: particles are not
 * divided, and one cut serves many. */
static const double worse = 1.05;

/* Substep of a particle in units of the integration of one (about 20 cycles): a listed pair costs
 * as much, or a third of it where few pairs touch (fast.h); a wall element near is a contact, nearly
 * always. */
static const double pair_cost = 1.0, wall_cost = 3.0;

/* cost[i] of own particles from the lists, which are of these particles; returns the sum. */
static double costs(const dem_t *dem, double *cost) {
  const int n = dem->store->local;
  const part_pairs *pairs = dem->pairs;
  double sum = 0.0;
  for (int i = 0; i < n; i++)
    cost[i] = 1.0;
  for (int i = 0; dem->plan.pairs && pairs->rows == n && i < n; i++)
    cost[i] += pair_cost * (pairs->start[i + 1] - pairs->start[i]);
  for (int row = 0; dem->plan.walls && row < dem->walls.rows; row++)
    cost[dem->walls.particle[row]] +=
        wall_cost * (dem->walls.start[row + 1] - dem->walls.start[row]);
  for (int i = 0; i < n; i++)
    sum += cost[i];
  return sum;
}

int dem_balance_note(dem_t *dem) {
  double *cost = NULL, most, all;
  if (dem->ranks == 1)
    return PART_OK;
  PART_TRY(part_agree(dem->comm,
                      dem_allocate((size_t)dem->store->local, sizeof *cost, &cost)));
  const double own = costs(dem, cost);
  free(cost);
  if (MPI_Allreduce(&own, &most, 1, MPI_DOUBLE, MPI_MAX, dem->comm) != MPI_SUCCESS ||
      MPI_Allreduce(&own, &all, 1, MPI_DOUBLE, MPI_SUM, dem->comm) != MPI_SUCCESS)
    return part_fail(PART_ERR_MPI, "a sum over ranks failed");
  dem->load.ratio = all > 0.0 ? most * dem->ranks / all : 1.0;
  dem->load.mean = all / dem->ranks;
  if (dem->load.balanced || dem->load.ratio < dem->load.reached)
    dem->load.reached = dem->load.ratio;
  dem->load.balanced = 0;
  return PART_OK;
}

static int drifted(const dem_load *load, double allowed) {
  return load->ratio > allowed && (load->ratio - 1.0) * load->mean > worth_balancing &&
         load->ratio > worse * load->reached;
}

int dem_balance(dem_t *dem, int anyway, const double *home) {
  double *cost = NULL;
  if (dem->ranks == 1 || (!anyway && !drifted(&dem->load, dem->params.balance_ratio)))
    return PART_OK;
  PART_TRY(part_agree(dem->comm,
                      dem_allocate((size_t)dem->store->local, sizeof *cost, &cost)));
  if (dem->started)
    costs(dem, cost);
  const int status =
      part_domain_balance_home(dem->domain, dem->store, home, dem->started ? cost : NULL);
  free(cost);
  dem->load.balanced = dem->started; /* the first parts are by number, to be improved on */
  return status;
}
