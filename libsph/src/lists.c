/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Neighbour lists: order of particles, ghosts, half lists by libparticle, and the full lists made
 * from them. */
#include "internal.h"

/* Partners of each row: its own half row and the rows it is partner in. */
static int count_rows(sph_t *sph) {
  const part_pairs *half = sph->pairs;
  sph_lists *lists = &sph->lists;
  const int n = half->rows;
  PART_TRY(sph_grow((size_t)n + 1, sizeof *lists->start, &lists->start_room, &lists->start));
  memset(lists->start, 0, ((size_t)n + 1) * sizeof *lists->start);
  for (int i = 0; i < n; i++)
    for (int k = half->start[i]; k < half->start[i + 1]; k++) {
      lists->start[i]++;
      if (half->partner[k] < n)
        lists->start[half->partner[k]]++;
    }
  long long sum = 0;
  lists->listed = 0;
  for (int i = 0; i <= n; i++) {
    const int count = i < n ? lists->start[i] : 0;
    lists->start[i] = (int)sum;
    lists->listed += count;
    sum += (count + SPH_BLOCK - 1) / SPH_BLOCK * SPH_BLOCK;
    if (sum > INT32_MAX)
      return part_fail(PART_ERR_RANGE, "more than 2^31 listed pairs on one rank");
  }
  lists->rows = n;
  return PART_OK;
}

/* Rows come out in increasing order of partners: those below i are put in as their rows are read.
 */
static int make_full(sph_t *sph) {
  const part_pairs *half = sph->pairs;
  sph_lists *lists = &sph->lists;
  PART_TRY(count_rows(sph));
  const int n = lists->rows;
  const size_t all = (size_t)lists->start[n];
  PART_TRY(sph_grow(all + 1, sizeof *lists->partner, &lists->partner_room, &lists->partner));
  PART_TRY(sph_grow(SPH_SUMS * (size_t)n, sizeof *sph->sum, &sph->sum_room, &sph->sum));
  if (sph->plan.variable)
    PART_TRY(sph_grow(2 * ((size_t)sph->store->local + (size_t)sph->store->ghost), sizeof *sph->lens,
                      &sph->lens_room, &sph->lens));
  if (sph->plan.correction)
    PART_TRY(sph_grow((size_t)sph->store->local + (size_t)sph->store->ghost, sizeof *sph->factor,
                      &sph->factor_room, &sph->factor));
  if (sph->plan.balance)
    PART_TRY(sph_grow_balance(sph));
  if (sph->plan.shifting)
    PART_TRY(sph_grow(SPH_SHIFTS * (size_t)n, sizeof *sph->shift, &sph->shift_room, &sph->shift));
  for (int i = 0; i < n; i++) {
    for (int k = half->start[i]; k < half->start[i + 1]; k++) {
      const int j = half->partner[k];
      lists->partner[lists->start[i]++] = j;
      if (j < n)
        lists->partner[lists->start[j]++] = i;
    }
    while (lists->start[i] % SPH_BLOCK != 0)
      lists->partner[lists->start[i]++] = i;
  }
  memmove(lists->start + 1, lists->start, (size_t)n * sizeof *lists->start);
  lists->start[0] = 0;
  return PART_OK;
}

static int count_all(const sph_t *sph) {
  int64_t sum = sph->store->local;
  if (MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_INT64_T, MPI_SUM, sph->comm) != MPI_SUCCESS)
    return part_fail(PART_ERR_MPI, "a sum over ranks failed");
  return sum == sph->total ? PART_OK
                           : part_fail(PART_ERR_STATE, "%lld particles are there, not %lld",
                                       (long long)sum, (long long)sph->total);
}

/* Ghosts have no MASS record of their own: half the support for the lists, eps 1. */
static int fill_ghosts(sph_t *sph) {
  double *mass = sph_mass(sph);
  if (sph->plan.variable)
    return part_domain_copy_to_ghosts(sph->domain, sph->store, SPH_MASS * sizeof *mass, mass,
                                      mass + SPH_MASS * (size_t)sph->store->local);
  for (int i = sph->store->local; i < sph->store->local + sph->store->ghost; i++) {
    double *m = sph_mass(sph) + SPH_MASS * (size_t)i;
    m[2] = 1.0;
    m[3] = 0.5 * sph->reach;
  }
  return PART_OK;
}

static int make_lists(sph_t *sph, const part_levels *levels) {
  PART_TRY(part_pairs_build(sph->pairs, sph->store, SPH_FIELD_SUPPORT, levels, sph->skin));
  PART_TRY(make_full(sph));
  sph->own_mass = 0.0;
  for (int i = 0; i < sph->store->local; i++)
    sph->own_mass += sph_mass(sph)[SPH_MASS * (size_t)i];
  return sph->plan.walls ? sph_walls_list(sph) : PART_OK;
}

static int rebuild(sph_t *sph, int balance) {
  part_levels levels;
  double range[2] = {0.5 * sph->reach, 0.5 * sph->reach};
  if (sph->plan.variable)
    PART_TRY(sph_list_supports(sph, range));
  part_levels_set(&levels, range[0], range[1]);
  if (balance || (sph->ranks > 1 && sph->imbalance > sph->params.balance_ratio))
    PART_TRY(part_domain_balance(sph->domain, sph->store, NULL));
  PART_TRY(part_domain_migrate(sph->domain, sph->store, 0, NULL, NULL));
  PART_TRY(part_agree(sph->comm,
                      part_sort(sph->store, &sph->box, SPH_FIELD_SUPPORT, &levels, sph->skin)));
  PART_TRY(part_domain_ghosts(sph->domain, sph->store, sph->reach + sph->skin));
  PART_TRY(fill_ghosts(sph));
  PART_TRY(part_agree(sph->comm, make_lists(sph, &levels)));
  PART_TRY(count_all(sph));
  if (sph->ranks > 1)
    PART_TRY(part_domain_imbalance(sph->domain, sph->store, &sph->imbalance));
  sph->travel = 0.0;
  if (sph->plan.variable)
    sph_set_lengths(sph); /* particles are in another order */
  return sph_refresh_ghosts(sph);
}

int sph_rebuild(sph_t *sph, int balance) {
  part_timers_start(sph->timers, sph->stage[SPH_STAGE_NEIGHBOURS]);
  const int status = rebuild(sph, balance);
  part_timers_stop(sph->timers, sph->stage[SPH_STAGE_NEIGHBOURS]);
  sph->generation++;
  sph->rebuilds++;
  return status == PART_OK
             ? PART_OK
             : part_fail_context(status, "time %g s, step %lld", sph->time, sph->steps);
}

int sph_choose_loops(sph_t *sph) {
  const sph_loops *const known[] = {sph_loops_avx512(), sph_loops_avx2(), sph_loops_plain()};
  const int width = sph->width_limit > 0 ? sph->width_limit : SPH_BLOCK;
  sph->loops = NULL;
  for (int k = 0; k < 3; k++) { /* ranks may run on different processors */
    int here = known[k] != NULL && known[k]->width <= width;
    if (MPI_Allreduce(MPI_IN_PLACE, &here, 1, MPI_INT, MPI_MIN, sph->comm) != MPI_SUCCESS)
      return part_fail(PART_ERR_MPI, "a minimum over ranks failed");
    if (here && sph->loops == NULL)
      sph->loops = known[k];
  }
  return PART_OK;
}

int sph_limit_width(sph_t *sph, int width) {
  if (width != 0 && width != 1 && width != 4 && width != 8)
    return part_fail(PART_ERR_RANGE, "width %d of the pair loops: must be 0, 1, 4 or 8", width);
  sph->width_limit = width;
  return sph_choose_loops(sph);
}
