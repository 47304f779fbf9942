/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Numbers of the state, and the momentum budget. */
#include "internal.h"

static void add_momentum(double mass, const double v[3], double momentum[3], double *size) {
  for (int c = 0; c < 3; c++)
    momentum[c] += mass * v[c];
  if (size != NULL)
    *size += mass * sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

void dem_own_momentum(const dem_t *dem, double momentum[3], double *size) {
  momentum[0] = momentum[1] = momentum[2] = 0.0;
  if (size != NULL)
    *size = 0.0;
  for (int i = 0; i < dem->store->local; i++) {
    const double *v = dem_vm(dem) + DEM_VM * (size_t)i;
    if (dem_kind_of(dem, i) == DEM_FREE)
      add_momentum(1.0 / v[3], v, momentum, size);
  }
  for (int b = 0; b < dem->clumps.count; b++)
    add_momentum(dem->clumps.clump[b].mass, dem->clumps.clump[b].v, momentum, size);
  for (int b = 0; b < dem->blocks && dem->rank == 0; b++)
    if (dem->block[b].members > 0)
      add_momentum(dem->block[b].mass, dem->block[b].v, momentum, size);
}

static double own_energy(const dem_t *dem, double *max_speed) {
  double energy = 0.0;
  *max_speed = 0.0;
  for (int i = 0; i < dem->store->local; i++) {
    const double *v = dem_vm(dem) + DEM_VM * (size_t)i, r = dem_xr(dem)[DEM_XR * (size_t)i + 3];
    const double v2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    const double w2 = v[4] * v[4] + v[5] * v[5] + v[6] * v[6];
    *max_speed = fmax(*max_speed, sqrt(v2));
    if (dem_kind_of(dem, i) == DEM_FREE)
      energy += 0.5 * dem_own_part(dem, (int)v[7]) / v[3] * (v2 + r * r * w2 / dem->shape.spin);
    else if (dem_kind_of(dem, i) == DEM_BLOCK)
      energy += 0.5 * dem_own_mass(dem, i) * v2;
  }
  for (int b = 0; b < dem->clumps.count; b++)
    energy += dem_clump_energy(&dem->clumps.clump[b]);
  return energy;
}

/* Contacts of particles that this rank counts, and the largest overlap of the smaller radius. */
static int64_t pair_contacts(const dem_t *dem, double *most) {
  const double *xr = dem_xr(dem);
  int64_t count = 0;
  if (!dem->plan.pairs)
    return 0;
  for (int i = 0; i < dem->pairs->rows; i++)
    for (int k = dem->pairs->start[i]; k < dem->pairs->start[i + 1]; k++) {
      const int j = dem->pairs->partner[k];
      const double *x = xr + DEM_XR * (size_t)i, *y = xr + DEM_XR * (size_t)j;
      const double d[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]}, reach = x[3] + y[3];
      const double distance2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
      if (!(distance2 < reach * reach))
        continue;
      const double overlap = reach - sqrt(distance2);
      if (!(overlap > 0.0))
        continue;
      *most = fmax(*most, overlap / fmin(x[3], y[3]));
      /* A pair with a ghost is listed at both ends. */
      count += j < dem->store->local || dem_id(dem, i) < dem_id(dem, j);
    }
  return count;
}

static int64_t wall_contacts(const dem_t *dem, double *most) {
  int64_t count = 0;
  if (!dem->plan.walls)
    return 0;
  for (int row = 0; row < dem->walls.rows; row++) {
    dem_candidate *place = dem->walls.scratch;
    const double r = dem_xr(dem)[DEM_XR * (size_t)dem->walls.particle[row] + 3];
    const int kept = dem_walls_touched(dem, row, place);
    for (int m = 0; m < kept; m++)
      *most = fmax(*most, (r - place[m].gap) / r);
    count += kept;
  }
  return count;
}

static int budget(const dem_t *dem, dem_report *report) {
  double sums[19], *initial = sums + 15, scale, error = 0.0;
  dem_own_momentum(dem, sums, &sums[18]);
  part_sum_total(&dem->gravity_impulse, sums + 3);
  part_sum_total(&dem->fluid_impulse, sums + 6);
  part_sum_total(&dem->wall_impulse, sums + 9);
  part_sum_total(&dem->support_impulse, sums + 12);
  memcpy(initial, dem->initial_momentum, 3 * sizeof(double));
  PART_TRY(dem_rank_sum(dem, 19, sums));
  scale = sums[18];
  for (int c = 0; c < 3; c++) {
    report->momentum[c] = sums[c];
    report->gravity_impulse[c] = sums[3 + c];
    report->fluid_impulse[c] = sums[6 + c];
    report->wall_impulse[c] = sums[9 + c];
    report->support_impulse[c] = sums[12 + c];
    const double given = sums[3 + c] + sums[6 + c] + sums[9 + c] + sums[12 + c];
    error = fmax(error, fabs(sums[c] - initial[c] - given));
    for (int k = 3; k < 15; k += 3)
      scale = fmax(scale, fabs(sums[k + c]));
  }
  report->budget_error = scale > 0.0 ? error / scale : 0.0;
  return PART_OK;
}

int dem_get_report(dem_t *dem, dem_report *report) {
  double most[2] = {0.0, 0.0}, energy;
  if (!dem->started)
    return part_fail(PART_ERR_STATE, "dem_get_report comes after dem_start");
  memset(report, 0, sizeof *report);
  energy = own_energy(dem, &most[1]);
  int64_t counts[3] = {pair_contacts(dem, &most[0]), wall_contacts(dem, &most[0]),
                       dem->clumps.count};
  MPI_Allreduce(MPI_IN_PLACE, counts, 3, MPI_INT64_T, MPI_SUM, dem->comm);
  MPI_Allreduce(MPI_IN_PLACE, most, 2, MPI_DOUBLE, MPI_MAX, dem->comm);
  PART_TRY(dem_rank_sum(dem, 1, &energy));
  report->particles = dem->total;
  report->load_ratio = dem->load.ratio;
  report->contacts = counts[0];
  report->wall_contacts = counts[1];
  report->clumps = counts[2];
  report->max_overlap = most[0];
  report->max_speed = most[1];
  report->kinetic_energy = energy;
  report->substeps = dem->substeps;
  report->rebuilds = dem->rebuilds;
  if (dem->plan.bonds) {
    report->bonds = dem->bonds.intact;
    report->broken_bonds = dem->bonds.broken;
    report->bond_energy = dem_bonds_energy(dem);
    PART_TRY(dem_rank_sum(dem, 1, &report->bond_energy));
  }
  return budget(dem, report);
}
