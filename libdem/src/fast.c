/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The vector path: choice of kernels, the flat list, chunks of contact and motion. */
#include "fast.h"

#include "internal.h"
#include "laws.h"

/* Below this share of listed pairs in contact, packing them first is quicker. */
static const double dense_share = 0.35;

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
  for (int k = 0; k < 2 && fast->kernels == NULL; k++)
    if (known[k] != NULL && (fast->limit == 0 || known[k]->width <= fast->limit))
      fast->kernels = known[k];
}

void dem_fast_free(dem_fast *fast) {
  free(fast->i);
  free(fast->j);
  for (int c = 0; c < DEM_HISTORY; c++)
    free(fast->history[c]);
  free(fast->was);
  free(fast->kick);
}

static int aligned(size_t bytes, void *pointer_to_pointer) {
  void *p = aligned_alloc(64, (bytes + 63) / 64 * 64);
  if (p == NULL)
    return part_fail(PART_ERR_MEMORY, "no memory for %zu bytes of pairs", bytes);
  memcpy(pointer_to_pointer, &p, sizeof p);
  return PART_OK;
}

/* Room for n pairs; content is lost. */
static int make_room(dem_t *dem, size_t n) {
  dem_fast *fast = &dem->fast;
  if (n <= fast->room && fast->kick != NULL)
    return PART_OK;
  n += n / 4 + DEM_BLOCK_PAIRS;
  dem_fast_free(fast);
  fast->i = fast->j = NULL;
  memset(fast->history, 0, sizeof fast->history);
  fast->kick = NULL;
  fast->was = NULL;
  fast->room = 0;
  PART_TRY(aligned(n * sizeof *fast->i, &fast->i));
  PART_TRY(aligned(n * sizeof *fast->j, &fast->j));
  for (int c = 0; c < DEM_HISTORY_WIDTH(dem_parts(dem)); c++)
    PART_TRY(aligned(n * sizeof *fast->history[c], &fast->history[c]));
  PART_TRY(aligned(n / DEM_BLOCK_PAIRS + 1, &fast->was));
  PART_TRY(aligned(4 * (size_t)dem->materials * sizeof *fast->kick, &fast->kick));
  fast->room = n;
  return PART_OK;
}

/* Flat indices; returns how many pairs touch. */
static int flatten(const dem_t *dem, int *flat_i, int *flat_j) {
  const part_pairs *pairs = dem->pairs;
  const double *xr = dem_xr(dem);
  int touching = 0;
  for (int i = 0; i < pairs->rows; i++) {
    const double *x = xr + DEM_XR * (size_t)i;
    for (int k = pairs->start[i]; k < pairs->start[i + 1]; k++) {
      const double *y = xr + DEM_XR * (size_t)pairs->partner[k];
      const double d[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]}, reach = x[3] + y[3];
      flat_i[k] = i;
      flat_j[k] = pairs->partner[k];
      touching += d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < reach * reach;
    }
  }
  return touching;
}

int dem_fast_list(dem_t *dem) {
  const part_pairs *pairs = dem->pairs;
  dem_fast *fast = &dem->fast;
  const int n = pairs->start[pairs->rows];
  if (fast->kernels == NULL)
    return PART_OK;
  fast->pairs = (n + DEM_BLOCK_PAIRS - 1) / DEM_BLOCK_PAIRS * DEM_BLOCK_PAIRS;
  PART_TRY(make_room(dem, (size_t)fast->pairs));
  fast->sparse = flatten(dem, fast->i, fast->j) < dense_share * n;
  for (int k = n; k < fast->pairs; k++)
    fast->i[k] = fast->j[k] = 0;
  const int width = pairs->data_width;
  for (int c = 0; c < width; c++) {
    double *to = fast->history[c];
    const double *from = pairs->data + c;
    for (int k = 0; k < fast->pairs; k++)
      to[k] = k < n ? from[(size_t)width * (size_t)k] : 0.0;
  }
  memset(fast->was, 255, (size_t)fast->pairs / DEM_BLOCK_PAIRS);
  return PART_OK;
}

void dem_fast_return(const dem_t *dem) {
  const part_pairs *pairs = dem->pairs;
  const dem_fast *fast = &dem->fast;
  const int width = pairs->data_width;
  if (fast->kernels == NULL || width == 0)
    return;
  const int n = pairs->start[pairs->rows];
  for (int k = 0; k < n; k++)
    for (int c = 0; c < width; c++)
      pairs->data[(size_t)width * (size_t)k + (size_t)c] = fast->history[c][k];
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
  const dem_fast *fast = &dem->fast;
  const dem_lanes lanes = lanes_of(dem, dt);
  const dem_pairs_kernel kernel = fast->sparse
                                      ? fast->kernels->sparse[fast->law][dem_parts(dem)]
                                      : fast->kernels->dense[fast->law][dem_parts(dem)];
  const int *start = dem->pairs->start, rows = dem->pairs->rows;
  int done = 0;
  for (int from = 0; from < fast->pairs; from += DEM_CHUNK_PAIRS) {
    const int end = from + DEM_CHUNK_PAIRS, to = end < fast->pairs ? end : fast->pairs;
    int complete = done;
    kernel(&lanes, from, to);
    if (motion == NULL)
      continue;
    while (complete < rows && start[complete + 1] <= to)
      complete++;
    fast->kernels->move(motion, done, complete);
    done = complete;
  }
  if (motion != NULL)
    fast->kernels->move(motion, done, rows);
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
    dem_sum_add(&dem->gravity_impulse, g, dem->mass_of[m] * h);
  }
  run_chunks(dem, h, &motion);
  *way = h * sqrt(motion.most[0] + motion.most[1] + motion.most[2]);
}
