/* SPDX-License-Identifier: GPL-3.0-or-later */
/* All contact forces at the present positions, and what walls and supports give. */
#include "internal.h"

static void support_force(dem_t *dem) {
  /* What fixed particles feel from contacts comes from movable ones only (fixed pairs are not
   * listed), so the movable ones feel its negative. */
  const double *ft = dem_ft(dem);
  for (int c = 0; c < 3; c++)
    dem->support_force[c] = 0.0;
  if (dem->plan.all_free)
    return;
  for (int i = 0; i < dem->store->local; i++)
    if (dem_kind_of(dem, i) == DEM_FIXED)
      for (int c = 0; c < 3; c++)
        dem->support_force[c] -= ft[DEM_FT * (size_t)i + (size_t)c];
}

void dem_no_forces(dem_t *dem) {
  memset(dem_ft(dem), 0, (size_t)dem->store->local * DEM_FT * sizeof(double));
}

/* Pairs in a plane of constant z have forces in the plane to the last bit; contacts with triangles
 * and bonds only to rounding. */
static void flatten(dem_t *dem) {
  double *ft = dem_ft(dem);
  for (int i = 0; i < dem->store->local; i++)
    ft[DEM_FT * (size_t)i + 2] = ft[DEM_FT * (size_t)i + 4] = ft[DEM_FT * (size_t)i + 5] = 0.0;
  dem->wall_force[2] = 0.0;
}

void dem_wall_stage(dem_t *dem, double dt) {
  dem_walls_no_force(dem);
  dem_wear_pairs(dem, dt);
  if (dem->plan.walls) {
    part_timers_start(dem->timers, dem->stage[DEM_STAGE_WALLS]);
    dem_wall_forces(dem, dt);
    part_timers_stop(dem->timers, dem->stage[DEM_STAGE_WALLS]);
  }
  if (dem->plan.bonds) {
    part_timers_start(dem->timers, dem->stage[DEM_STAGE_BONDS]);
    dem_bond_forces(dem, dt);
    part_timers_stop(dem->timers, dem->stage[DEM_STAGE_BONDS]);
  }
  if (dem->plan.lubrication) {
    part_timers_start(dem->timers, dem->stage[DEM_STAGE_LUBRICATION]);
    dem_film_forces(dem, dt);
    part_timers_stop(dem->timers, dem->stage[DEM_STAGE_LUBRICATION]);
  }
  if (dem->shape.flat)
    flatten(dem);
}

int dem_forces(dem_t *dem, double dt) {
  dem_no_forces(dem);
  if (dem->plan.pairs) {
    part_timers_start(dem->timers, dem->stage[DEM_STAGE_CONTACT]);
    dem_pair_forces(dem, dt);
    part_timers_stop(dem->timers, dem->stage[DEM_STAGE_CONTACT]);
  }
  dem_wall_stage(dem, dt);
  support_force(dem);
  if (dem->plan.clumps) {
    part_timers_start(dem->timers, dem->stage[DEM_STAGE_CLUMPS]);
    dem_clumps_forces(dem);
    part_timers_stop(dem->timers, dem->stage[DEM_STAGE_CLUMPS]);
  }
  if (dem->plan.blocks) {
    part_timers_start(dem->timers, dem->stage[DEM_STAGE_BLOCKS]);
    PART_TRY(dem_blocks_forces(dem));
    part_timers_stop(dem->timers, dem->stage[DEM_STAGE_BLOCKS]);
  }
  return PART_OK;
}
