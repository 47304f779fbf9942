/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Neighbour lists: when they are made again, and how everything comes along. */
#include "internal.h"

/* Substeps after which lists that still hold are made again when their skin is far too wide. */
enum { skin_trial = 256 };

static int make_pairs(dem_t *dem, const int *count, const void *payload) {
  if (dem->plan.bonds)
    PART_TRY(dem_bonds_list(dem, count, payload));
  PART_TRY(dem_pair_list_filter(dem));
  if (dem->plan.lubrication)
    PART_TRY(dem_film_list(dem));
  if (dem->plan.tangential && payload != NULL)
    PART_TRY(dem_history_scatter(dem, count, payload));
  return dem_fast_list(dem);
}

/* Own masses per material, and the positions that the lists belong to. */
static int note_state(dem_t *dem) {
  const double *xr = dem_xr(dem);
  free(dem->x_built);
  dem->x_built = NULL;
  PART_TRY(dem_allocate(3 * (size_t)dem->store->local, sizeof *dem->x_built, &dem->x_built));
  for (int m = 0; m < dem->materials; m++)
    dem->mass_of[m] = 0.0;
  for (int i = 0; i < dem->store->local; i++) {
    memcpy(dem->x_built + 3 * (size_t)i, xr + DEM_XR * (size_t)i, 3 * sizeof(double));
    if (dem_kind_of(dem, i) == DEM_FREE)
      dem->mass_of[dem_material_of(dem, i)] += 1.0 / dem_vm(dem)[DEM_VM * (size_t)i + 3];
  }
  dem->travel = 0.0;
  return PART_OK;
}

/* Pairs of all ranks, each once; and no particle may have got lost. */
static int count_all(dem_t *dem) {
  const part_pairs *pairs = dem->pairs;
  int64_t sum[2] = {0, dem->store->local};
  for (int i = 0; dem->plan.pairs && i < pairs->rows; i++)
    for (int k = pairs->start[i]; k < pairs->start[i + 1]; k++)
      sum[0] +=
          pairs->partner[k] < dem->store->local || dem_id(dem, i) < dem_id(dem, pairs->partner[k]);
  if (dem->ranks > 1 &&
      MPI_Allreduce(MPI_IN_PLACE, sum, 2, MPI_INT64_T, MPI_SUM, dem->comm) != MPI_SUCCESS)
    return part_fail(PART_ERR_MPI, "a sum over ranks failed");
  dem->listed = sum[0];
  return sum[1] == dem->total ? PART_OK
                              : part_fail(PART_ERR_STATE, "%lld particles are there, not %lld",
                                          (long long)sum[1], (long long)dem->total);
}

static int make_lists(dem_t *dem, const int *count, const void *payload) {
  if (dem->plan.pairs)
    PART_TRY(make_pairs(dem, count, payload));
  if (dem->plan.walls)
    PART_TRY(dem_walls_list(dem, count, payload));
  if (dem->plan.clumps)
    PART_TRY(dem_clumps_list(dem, count, payload));
  if (dem->carried.vectors > 0)
    PART_TRY(dem_carried_list(dem, count, payload));
  return note_state(dem);
}

/* The skin that costs least, from the way per substep since the lists were built. Per particle and
 * substep, b s/d pairs are listed for a skin s, and 2 way/s lists are built, each as dear as K
 * pairs: s^2 = 2 (K/b) d way. On the vector path pairs of the skin are looked at once in
 * inner/(2 way) substeps only (fast_list.c), so that s^2 = (K/b) d inner. Ratios are round numbers
 * from measurements of gas and bed; the optimum is flat. All that enters is the same on every rank,
 * and is in restart files. */
static double best_skin(const dem_t *dem) {
  const double d = 2.0 * dem->r_mean;
  const long long steps = dem->substeps - dem->substeps_built;
  const double way = fmin(dem->travel, 0.5 * dem->skin) / (double)(steps > 0 ? steps : 1);
  const double best2 =
      dem->fast.kernels != NULL ? 8.0 * d * dem_fast_inner(dem, way) : 20.0 * d * way;
  /* Where few pairs are near, lists cost little, and a wide skin lets dem_horizon look farther. */
  if ((double)dem->listed < 0.25 * (double)dem->total) {
    const int wider = (double)dem->listed < 0.06 * (double)dem->total;
    return fmin(fmax((wider ? 2.0 : 1.0) * dem->skin, dem->skin_most), dem->skin_wide);
  }
  return fmin(fmax(sqrt(best2), 0.01 * d), dem->skin_most);
}

static void adapt_skin(dem_t *dem) {
  if (dem->params.skip && dem->plan.pairs && dem->substeps > dem->substeps_built)
    dem->skin = best_skin(dem);
  dem->substeps_built = dem->substeps;
}

/* Particles to their ranks and into order; *count NULL: without payload. Members of a clump go with
 * its centre of mass. */
static int rearrange(dem_t *dem, int balance, int **count, void **payload) {
  double *home = NULL;
  int status;
  if (dem->plan.clumps)
    PART_TRY(part_agree(dem->comm, dem_clumps_homes(dem, *count, *payload, &home)));
  status = dem_balance(dem, balance, home);
  if (status == PART_OK)
    status = *count == NULL ? part_domain_migrate(dem->domain, dem->store, 0, NULL, NULL)
                            : part_domain_migrate_home(dem->domain, dem->store, home,
                                                       sizeof(dem_entry), count, payload);
  free(home);
  PART_TRY(status);
  status = *count == NULL
               ? part_sort(dem->store, &dem->box, DEM_FIELD_RADIUS, &dem->levels, dem->skin)
               : dem_history_sort(dem, *count, *payload);
  return part_agree(dem->comm, status);
}

/* Bonded partners may be farther away than others: as far as the widest bond was a step ago.
 * Lubrication reaches farther, too. */
static double ghost_skin(const dem_t *dem) {
  return dem->skin + fmax(dem->bonds.widest, dem->film.range);
}

/* Ghosts, the pairs, and ghosts that are in one. Those in none are kept where somebody else than
 * pairs may want them. */
static int make_ghosts(dem_t *dem) {
  PART_TRY(part_domain_sphere_ghosts(dem->domain, dem->store, DEM_FIELD_RADIUS, &dem->levels,
                                     ghost_skin(dem)));
  PART_TRY(part_agree(dem->comm, part_pairs_build(dem->pairs, dem->store, DEM_FIELD_RADIUS,
                                                  &dem->levels, dem->skin)));
  if (dem->plan.bonds || dem->plan.lubrication || dem->plan.clumps)
    return PART_OK;
  return part_pairs_trim_ghosts(dem->pairs, dem->domain, dem->store);
}

static int rebuild(dem_t *dem, int balance, int **count, void **payload) {
  int status = PART_OK;
  adapt_skin(dem);
  if (dem->plan.bonds && dem->started)
    PART_TRY(dem_bonds_settle(dem));
  if (*count == NULL && dem_history_needed(dem))
    status = dem_history_gather(dem, count, payload);
  PART_TRY(part_agree(dem->comm, status));
  PART_TRY(rearrange(dem, balance, count, payload));
  if (dem->plan.pairs)
    PART_TRY(make_ghosts(dem));
  if (dem->plan.bonds)
    PART_TRY(dem_bonds_orient(dem, *count, *payload));
  PART_TRY(part_agree(dem->comm, make_lists(dem, *count, *payload)));
  if (dem->plan.clumps)
    PART_TRY(dem_clumps_turns(dem));
  PART_TRY(count_all(dem));
  return dem_balance_note(dem);
}

int dem_rebuild(dem_t *dem, int balance, int *count, void *payload) {
  part_timers_start(dem->timers, dem->stage[DEM_STAGE_NEIGHBOURS]);
  const int status = rebuild(dem, balance, &count, &payload);
  part_timers_stop(dem->timers, dem->stage[DEM_STAGE_NEIGHBOURS]);
  free(count);
  free(payload);
  dem->generation++;
  dem->rebuilds++;
  return status == PART_OK
             ? PART_OK
             : part_fail_context(status, "time %g s, step %lld", dem->time, dem->substeps);
}

/* Largest displacement of an own particle since the lists were built; NaN when there is one. */
static double moved(const dem_t *dem) {
  const double *xr = dem_xr(dem);
  double most = 0.0;
  for (int i = 0; i < dem->store->local; i++) {
    const double *x = xr + DEM_XR * (size_t)i, *b = dem->x_built + 3 * (size_t)i;
    const double d[3] = {x[0] - b[0], x[1] - b[1], x[2] - b[2]};
    const double d2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    if (!(d2 <= most))
      most = d2;
    if (isnan(d2))
      break;
  }
  return sqrt(most);
}

static double max_over_ranks(const dem_t *dem, double value) {
  if (dem->ranks > 1)
    MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_MAX, dem->comm);
  return value;
}

static int relist_walls(dem_t *dem) {
  part_timers_start(dem->timers, dem->stage[DEM_STAGE_NEIGHBOURS]);
  const int status = dem_walls_relist(dem);
  part_timers_stop(dem->timers, dem->stage[DEM_STAGE_NEIGHBOURS]);
  return status;
}

/* Ghosts on their way, before ranks agree whether lists hold: so they wait for each other once in a
 * step, and copies made for nothing are as rare as rebuilds. */
static int send_ghosts(dem_t *dem) {
  if (!dem->plan.pairs)
    return PART_OK;
  part_timers_start(dem->timers, dem->stage[DEM_STAGE_GHOSTS]);
  const int status = part_domain_send_ghosts(dem->domain, dem->store);
  part_timers_stop(dem->timers, dem->stage[DEM_STAGE_GHOSTS]);
  return status;
}

static int receive_ghosts(dem_t *dem, int turns) {
  int status = PART_OK;
  part_timers_start(dem->timers, dem->stage[DEM_STAGE_GHOSTS]);
  if (dem->plan.pairs)
    status = part_domain_receive_ghosts(dem->domain);
  if (turns && dem->plan.clumps && status == PART_OK)
    status = dem_clumps_turns(dem);
  part_timers_stop(dem->timers, dem->stage[DEM_STAGE_GHOSTS]);
  return status;
}

/* Must lists be made again after a drift by `way`, as dem_refresh has it? */
static int lists_end(dem_t *dem, double way) {
  /* Lists hold until one particle has moved half the skin. Without lists only periodic wrapping and
   * the errors of migration are left, which can wait for a radius. */
  const double limit = dem->plan.pairs || dem->plan.walls ? 0.5 * dem->skin : dem->r_mean;
  /* The bound costs nothing; only when it says maybe, every particle is looked at. */
  const int trial =
      dem->plan.pairs && dem->params.skip && dem->substeps - dem->substeps_built == skin_trial;
  if (dem->bonds.stale && way >= 0.0)
    way = HUGE_VAL; /* a pair whose bond has gone must be listed */
  const double most = way >= 0.0 ? max_over_ranks(dem, way) : HUGE_VAL;
  double travel = dem->travel + most;
  dem_fast_moved(dem, most);
  if (!(travel <= limit) || trial) {
    travel = dem->bonds.stale ? HUGE_VAL : moved(dem);
    if (!(travel <= limit))
      travel = HUGE_VAL; /* NaN is not passed on reliably by MPI_MAX */
    travel = max_over_ranks(dem, travel);
  }
  dem->travel = travel;
  return !(travel <= limit) || (trial && best_skin(dem) < 0.7 * dem->skin);
}

int dem_refresh(dem_t *dem, double way) {
  PART_TRY(send_ghosts(dem));
  part_timers_start(dem->timers, dem->stage[DEM_STAGE_NEIGHBOURS]);
  const int rebuild_now = lists_end(dem, way);
  part_timers_stop(dem->timers, dem->stage[DEM_STAGE_NEIGHBOURS]);
  PART_TRY(receive_ghosts(dem, !rebuild_now));
  if (rebuild_now)
    return dem_rebuild(dem, 0, NULL, NULL);
  if (dem->plan.walls && dem->walls.travel > dem->walls.margin)
    return part_agree(dem->comm, relist_walls(dem));
  return PART_OK;
}
