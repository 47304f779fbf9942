/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From what was inserted to a running scene: particles to ranks, masses, blocks, first forces. */
#include <fenv.h>

#include "internal.h"

/* Each rank begins with an equal run of the inserted particles; balancing sends them on. */
static int fill_store(dem_t *dem) {
  const int64_t first = dem->seeds * dem->rank / dem->ranks;
  const int64_t last = dem->seeds * (dem->rank + 1) / dem->ranks;
  int at;
  if (last - first > INT32_MAX / 2)
    return part_fail(PART_ERR_RANGE, "%lld particles are too many for %d ranks",
                     (long long)dem->seeds, dem->ranks);
  PART_TRY(part_store_append(dem->store, (int)(last - first), &at));
  for (int64_t k = first; k < last; k++, at++) {
    const dem_seed *seed = &dem->seed[k];
    double *x = dem_xr(dem) + DEM_XR * (size_t)at, *v = dem_vm(dem) + DEM_VM * (size_t)at;
    int64_t *meta = dem_meta(dem) + DEM_META * (size_t)at;
    memcpy(x, seed->x, sizeof seed->x);
    memcpy(v, seed->v, sizeof seed->v);
    memcpy(v + 4, seed->w, sizeof seed->w);
    x[3] = seed->r;
    v[7] = seed->material;
    meta[0] = dem->params.first_id + k;
    meta[1] = seed->kind;
    meta[2] = seed->block;
    const double inverse_mass = 1.0 / dem_own_mass(dem, at);
    v[3] = seed->kind == DEM_FREE ? inverse_mass : 0.0;
    dem_fluid(dem)[DEM_FLUID * (size_t)at + 7] = inverse_mass;
  }
  return PART_OK;
}

static int make_blocks(dem_t *dem) {
  for (int64_t k = 0; k < dem->seeds; k++)
    if (dem->seed[k].kind == DEM_BLOCK && dem->seed[k].block >= dem->blocks)
      dem->blocks = dem->seed[k].block + 1;
  PART_TRY(dem_allocate((size_t)dem->blocks, sizeof *dem->block, &dem->block));
  PART_TRY(dem_allocate((size_t)dem->blocks * (size_t)dem->materials, sizeof *dem->block_gravity,
                        &dem->block_gravity));
  /* Every rank knows every particle here: the same sums everywhere, in the order of ids. */
  for (int64_t k = 0; k < dem->seeds; k++) {
    const dem_seed *seed = &dem->seed[k];
    if (seed->kind != DEM_BLOCK)
      continue;
    dem_block *block = &dem->block[seed->block];
    const double mass = dem_mass(dem, seed->material, seed->r);
    block->members++;
    block->mass += mass;
    dem->block_gravity[seed->block * dem->materials + seed->material] += mass;
    for (int c = 0; c < 3; c++) {
      block->x[c] += seed->x[c];
      block->v[c] += mass * seed->v[c];
    }
  }
  for (int b = 0; b < dem->blocks; b++)
    for (int c = 0; c < 3 && dem->block[b].members > 0; c++) {
      dem->block[b].x[c] /= (double)dem->block[b].members;
      dem->block[b].v[c] /= dem->block[b].mass;
    }
  return PART_OK;
}

static void set_members(dem_t *dem) {
  for (int i = 0; i < dem->store->local; i++)
    if (dem_kind_of(dem, i) == DEM_BLOCK) {
      const dem_block *block = &dem->block[dem_block_of(dem, i)];
      double *v = dem_vm(dem) + DEM_VM * (size_t)i;
      memcpy(v, block->v, sizeof block->v);
      v[3] = 1.0 / block->mass;
    }
}

static int populate(dem_t *dem) {
  if (dem->materials == 0 || dem->seeds == 0)
    return part_fail(PART_ERR_STATE,
                     "there are no particles: insert or read some before dem_start");
  dem->total = dem->seeds;
  PART_TRY(make_blocks(dem));
  PART_TRY(fill_store(dem));
  set_members(dem);
  PART_TRY(dem_clumps_populate(dem, dem->seeds * dem->rank / dem->ranks));
  dem_clumps_free_seeds(&dem->clumps);
  return PART_OK;
}

static void drop_seeds(dem_t *dem) {
  free(dem->seed);
  dem->seed = NULL;
  dem->seed_capacity = 0;
}

static int prepare(dem_t *dem) {
  if (!dem->restored)
    PART_TRY(populate(dem));
  PART_TRY(dem_allocate((size_t)dem->materials, sizeof *dem->mass_of, &dem->mass_of));
  PART_TRY(dem_allocate(6 * (size_t)dem->materials, sizeof *dem->gravity_now, &dem->gravity_now));
  return PART_OK;
}

static int prepare_lists(dem_t *dem) {
  PART_TRY(part_pairs_create(DEM_HISTORY_WIDTH(dem_parts(dem)), &dem->pairs));
  dem_walls_move(dem, dem->time, 0.0);
  PART_TRY(dem_walls_facets(&dem->walls));
  PART_TRY(dem_wear_prepare(dem));
  return dem_walls_bins(&dem->walls, dem->r_max + 2.0 * dem->skin_most);
}

/* Floating point exceptions held as in dem_advance. */
static int first_forces(dem_t *dem) {
  fenv_t environment;
  feholdexcept(&environment);
  dem_fast_enter(dem);
  const int status = dem_forces(dem, 0.0);
  dem_fast_leave(dem);
  fesetenv(&environment);
  return status;
}

static int check_added_mass(const dem_t *dem) {
  if (!(dem->added_density > 0.0) || !(dem->plan.blocks || dem->plan.clumps))
    return PART_OK;
  return part_fail(
      PART_ERR_RANGE,
      "added mass (virtualMass) is that of single spheres, but there are %s: that of a "
      "whole body has another form and size; use free and fixed spheres",
      dem->plan.blocks ? "rigid blocks" : "clumps");
}

int dem_start(dem_t *dem) {
  if (dem->started)
    return part_fail(PART_ERR_STATE, "dem_start is called once");
  PART_TRY(part_agree(dem->comm, prepare(dem)));
  PART_TRY(part_agree(dem->comm, dem_bonds_check(dem, dem->kept_count, dem->kept)));
  if (dem->bonds.rules > 0 && !dem->restored)
    PART_TRY(dem_bonds_make(dem));
  drop_seeds(dem);
  PART_TRY(dem_make_plan(dem));
  PART_TRY(check_added_mass(dem));
  dem_fast_choose(dem);
  PART_TRY(part_agree(dem->comm, prepare_lists(dem)));
  int *count = dem->kept_count;
  void *payload = dem->kept;
  dem->kept_count = NULL;
  dem->kept = NULL;
  if (count != NULL && !dem_history_needed(dem)) { /* friction was taken out before the restart */
    free(count);
    free(payload);
    count = NULL;
    payload = NULL;
  }
  PART_TRY(dem_rebuild(dem, !dem->restored || dem->restored_elsewhere, count, payload));
  if (dem->plan.bonds)
    PART_TRY(dem_bonds_step(dem));
  dem->started = 1;
  if (dem->restored)
    return PART_OK;
  PART_TRY(part_agree(dem->comm, dem->plan.walls ? dem_walls_check(dem) : PART_OK));
  PART_TRY(first_forces(dem));
  dem_own_momentum(dem, dem->initial_momentum, NULL);
  return PART_OK;
}
