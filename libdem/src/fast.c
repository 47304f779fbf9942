/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The vector path: choice of kernels, the flat list, chunks of contact and motion. */
#include "fast.h"

#include "internal.h"
#include "laws.h"

/* The law that all given contacts have in common, -1 when they differ or there is none. */
int dem_common_law(const dem_t *dem) {
  int law = -2;
  for (int k = 0; k < dem->materials * dem->materials; k++) {
    if (dem->coefs[k].law < 0)
      continue;
    law = law == -2 || law == dem->coefs[k].law ? dem->coefs[k].law : -1;
  }
  return law < 0 ? -1 : law;
}

void dem_fast_choose(dem_t *dem) {
  const dem_kernels *const known[] = {dem_kernels_avx512(), dem_kernels_avx2()};
  dem_fast *fast = &dem->fast;
  fast->kernels = NULL;
  fast->law = dem_common_law(dem);
  fast->equal = dem->materials == 1 && dem->r_max == dem->r_min;
  if (!dem->params.skip || !dem->plan.all_free || !dem->plan.pairs || fast->law < 0)
    return;
  const int width = fast->limit > 0 ? fast->limit : 8;
  for (int k = 0; k < 2; k++) { /* ranks may run on different processors */
    int here = known[k] != NULL && known[k]->width <= width;
    if (dem->ranks > 1)
      MPI_Allreduce(MPI_IN_PLACE, &here, 1, MPI_INT, MPI_MIN, dem->comm);
    if (here && fast->kernels == NULL)
      fast->kernels = known[k];
  }
}

int dem_fast_limit(dem_t *dem, int width) {
  dem->fast.limit = width;
  if (!dem->started)
    return PART_OK;
  dem_fast_return(dem);
  dem_fast_choose(dem);
  return dem_fast_list(dem);
}

/* Multiply spins by r or its inverse, and torques by the opposite. */
static void scale_spins(dem_t *dem, int spins) {
  double *vm = dem_vm(dem), *ft = dem_ft(dem);
  const double *xr = dem_xr(dem);
  if (dem->fast.kernels == NULL || dem->fast.spins == spins)
    return;
  dem->fast.spins = spins;
  for (int i = 0; dem->plan.tangential && i < dem->store->local; i++) {
    const double r = xr[DEM_XR * (size_t)i + 3];
    double *v = vm + DEM_VM * (size_t)i, *f = ft + DEM_FT * (size_t)i;
    for (int c = 4; c < 7; c++) {
      v[c] = spins ? v[c] * r : v[c] / r;
      f[c] = spins ? f[c] / r : f[c] * r;
    }
  }
}

void dem_fast_enter(dem_t *dem) {
  scale_spins(dem, 1);
}
void dem_fast_leave(dem_t *dem) {
  scale_spins(dem, 0);
}

static dem_lanes lanes_of(const dem_t *dem, double dt) {
  const dem_fast *fast = &dem->fast;
  const int any = dem->store->local > 0;
  double *const *h = fast->history;
  return (dem_lanes){.xr = dem_xr(dem),
                     .vm = dem_vm(dem),
                     .ft = dem_ft(dem),
                     .i = fast->i,
                     .j = fast->j,
                     .history = {h[0], h[1], h[2], h[3], h[4], h[5]},
                     .was = fast->was,
                     .coefs = dem->coefs,
                     .materials = dem->materials,
                     .equal = fast->equal,
                     .reach = any ? 2.0 * dem_xr(dem)[3] : 0.0,
                     .inverse = any ? 2.0 * dem_vm(dem)[3] : 0.0,
                     .fetch_to = fast->pairs - DEM_FETCH_AHEAD,
                     .dt = dt};
}

/* Pairs in chunks; after each, motion (NULL: none) of the particles whose row is complete. */
static void run_chunks(dem_t *dem, double dt, dem_motion *motion) {
  dem_fast_update(dem);
  const dem_fast *fast = &dem->fast;
  const dem_lanes lanes = lanes_of(dem, dt);
  const dem_pairs_kernel kernel = fast->sparse ? fast->kernels->sparse[fast->law][dem_parts(dem)]
                                               : fast->kernels->dense[fast->law][dem_parts(dem)];
  int done = 0;
  for (int from = 0; from < fast->pairs; from += DEM_CHUNK_PAIRS) {
    const int end = from + DEM_CHUNK_PAIRS, complete = fast->complete[from / DEM_CHUNK_PAIRS];
    kernel(&lanes, from, end < fast->pairs ? end : fast->pairs);
    if (motion != NULL)
      fast->kernels->move(motion, done, complete);
    done = complete;
  }
  if (motion != NULL)
    fast->kernels->move(motion, done, dem->pairs->rows);
}

void dem_fast_forces(dem_t *dem, double dt) {
  run_chunks(dem, dt, NULL);
}

void dem_fast_step(dem_t *dem, double t, double h, double *way) {
  dem_motion motion = {.xr = dem_xr(dem),
                       .vm = dem_vm(dem),
                       .ft = dem_ft(dem),
                       .kick = dem->fast.kick,
                       .materials = dem->materials,
                       .tangential = dem->plan.tangential,
                       .spin = dem->shape.spin,
                       .dt = h};
  for (int m = 0; m < dem->materials; m++) {
    const double factor = dem_gravity_factor(dem, m, t, h);
    double *kick = dem->fast.kick + 4 * m, g[3];
    for (int c = 0; c < 3; c++) {
      g[c] = factor * dem->params.gravity[c];
      kick[c] = h * g[c];
    }
    kick[3] = 0.0;
    part_sum_add(&dem->gravity_impulse, g, dem->mass_of[m] * h);
  }
  run_chunks(dem, h, &motion);
  *way = h * sqrt(motion.most[0] + motion.most[1] + motion.most[2]);
}
