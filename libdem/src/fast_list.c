/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The list of the vector path: those of the listed pairs that may touch before it is made again.
 *
 * Neighbour lists have a wide skin, so that they are made rarely; most of their pairs are far from
 * touching. The inner list holds the ones whose gap is below a narrow one, which depends on the
 * speed of now; it is made again when two particles may have come that much nearer. Making it looks
 * at every pair once, which costs as much as a few substeps with all of them.
 *
 * Bed of 10,000: 2.6 pairs a particle instead of 3.25 with one list at its best skin, and lists
 * made every 600 substeps instead of 220; gas: 0.16 instead of 1.2. */
#include "fast.h"
#include "internal.h"

/* Below this share of pairs in contact, packing them first is quicker. */
static const double dense_share = 0.35;

void dem_fast_free(dem_fast *fast) {
  free(fast->i);
  free(fast->j);
  free(fast->slot);
  for (int c = 0; c < DEM_HISTORY; c++)
    free(fast->history[c]);
  free(fast->was);
  free(fast->complete);
  free(fast->kick);
}

static int aligned(size_t bytes, void *pointer_to_pointer) {
  void *p = aligned_alloc(64, (bytes + 64) / 64 * 64);
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
  n += n / 4 + DEM_CHUNK_PAIRS;
  dem_fast_free(fast);
  fast->i = fast->j = NULL;
  memset(fast->history, 0, sizeof fast->history);
  fast->kick = NULL;
  fast->slot = fast->complete = NULL;
  fast->was = NULL;
  fast->room = 0;
  PART_TRY(aligned(n * sizeof *fast->i, &fast->i));
  PART_TRY(aligned(n * sizeof *fast->j, &fast->j));
  PART_TRY(aligned(n * sizeof *fast->slot, &fast->slot));
  for (int c = 0; c < dem->pairs->data_width; c++)
    PART_TRY(aligned(n * sizeof *fast->history[c], &fast->history[c]));
  PART_TRY(aligned(n / DEM_BLOCK_PAIRS + 1, &fast->was));
  PART_TRY(aligned((n / DEM_CHUNK_PAIRS + 1) * sizeof *fast->complete, &fast->complete));
  PART_TRY(aligned(4 * (size_t)dem->materials * sizeof *fast->kick, &fast->kick));
  fast->room = n;
  return PART_OK;
}

/* Per substep b g/d pairs are worked on for nothing, and 2 way/g times p pairs are looked at:
 * g^2 = 2 p/b d way with a round number from the bed; the optimum is flat. */
double dem_fast_inner(const dem_t *dem, double way) {
  return sqrt(0.15 * dem->r_mean * way);
}

/* Width of the inner skin (m) from the velocities of now. It must be wider than what the last step
 * may have parted, so that a pair whose spring is to become zero is still there. */
static double inner_skin(const dem_t *dem) {
  const double *vm = dem_vm(dem);
  double v2 = 0.0;
  for (int i = 0; i < dem->store->local; i++) {
    const double *v = vm + DEM_VM * (size_t)i;
    v2 = fmax(v2, v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  }
  const double way = fmax(sqrt(v2) * dem->stable_step, dem->fast.last_way);
  const double least = fmax(4.0 * way, 1e-4 * dem->r_mean);
  return fmin(fmax(dem_fast_inner(dem, way), least), dem->skin);
}

/* Place in the list of the q-th of the n pairs of a chunk: neighbours in the order of rows share
 * particles and would wait for each other's sums, so every group of 64 is turned like a matrix. */
static int place_of(int q, int n) {
  const int group = 64, first = q / group * group, here = n - first < group ? n - first : group;
  const int blocks = (here + DEM_BLOCK_PAIRS - 1) / DEM_BLOCK_PAIRS;
  q -= first;
  return first + q % blocks * DEM_BLOCK_PAIRS + q / blocks;
}

/* Number of pairs with a gap below `inner`; their slots and rows in order. */
static int select_pairs(const dem_t *dem, double inner, int *slot, unsigned *row, int *touching) {
  const part_pairs *pairs = dem->pairs;
  const double *xr = dem_xr(dem);
  int n = 0, touch = 0;
  for (int i = 0; i < pairs->rows; i++) {
    const double *x = xr + DEM_XR * (size_t)i;
    for (int k = pairs->start[i]; k < pairs->start[i + 1]; k++) {
      const double *y = xr + DEM_XR * (size_t)pairs->partner[k];
      const double d[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]}, sum = x[3] + y[3];
      const double d2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2], reach = sum + inner;
      slot[n] = k;
      row[n] = 8u * (unsigned)i;
      n += d2 < reach * reach;
      touch += d2 < sum * sum;
    }
  }
  *touching = touch;
  return n;
}

/* The n pairs from `first` on, in order of rows so far, become a chunk. */
static void arrange_chunk(dem_t *dem, int first, int n) {
  dem_fast *fast = &dem->fast;
  const part_pairs *pairs = dem->pairs;
  const int width = pairs->data_width;
  int slot[DEM_CHUNK_PAIRS];
  unsigned row[DEM_CHUNK_PAIRS];
  const int padded = (n + DEM_BLOCK_PAIRS - 1) / DEM_BLOCK_PAIRS * DEM_BLOCK_PAIRS;
  memcpy(slot, fast->slot + first, (size_t)n * sizeof *slot);
  memcpy(row, fast->i + first, (size_t)n * sizeof *row);
  for (int q = 0; q < padded; q++) {
    const int k = first + place_of(q, n), here = q < n;
    fast->slot[k] = here ? slot[q] : -1;
    fast->i[k] = here ? row[q] : 0;
    fast->j[k] = here ? 8u * (unsigned)pairs->partner[slot[q]] : 0;
    for (int c = 0; c < width; c++)
      fast->history[c][k] = here ? pairs->data[(size_t)width * (size_t)slot[q] + (size_t)c] : 0.0;
  }
}

static void make_inner(dem_t *dem) {
  dem_fast *fast = &dem->fast;
  int touching;
  fast->inner = inner_skin(dem);
  const int n = select_pairs(dem, fast->inner, fast->slot, fast->i, &touching);
  fast->pairs = (n + DEM_BLOCK_PAIRS - 1) / DEM_BLOCK_PAIRS * DEM_BLOCK_PAIRS;
  fast->sparse = touching < dense_share * n;
  fast->way = 0.0;
  for (int first = 0; first < n; first += DEM_CHUNK_PAIRS) {
    const int next = first + DEM_CHUNK_PAIRS;
    fast->complete[first / DEM_CHUNK_PAIRS] =
        next < n ? (int)(fast->i[next] / 8u) : dem->pairs->rows;
    arrange_chunk(dem, first, next < n ? DEM_CHUNK_PAIRS : n - first);
  }
  memset(fast->was, 255, (size_t)fast->pairs / DEM_BLOCK_PAIRS);
}

/* History of pairs that do not touch is nothing: what comes with the payload may be of before the
 * last step, and only pairs of the inner list are looked at before the next one. */
static void clear_history(dem_t *dem) {
  part_pairs *pairs = dem->pairs;
  const double *xr = dem_xr(dem);
  const size_t width = (size_t)pairs->data_width;
  for (int i = 0; i < pairs->rows && width > 0; i++)
    for (int k = pairs->start[i]; k < pairs->start[i + 1]; k++) {
      const double *x = xr + DEM_XR * (size_t)i, *y = xr + DEM_XR * (size_t)pairs->partner[k];
      const double d[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]}, reach = x[3] + y[3];
      if (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] >= reach * reach)
        memset(pairs->data + width * (size_t)k, 0, width * sizeof *pairs->data);
    }
}

int dem_fast_list(dem_t *dem) {
  if (dem->fast.kernels == NULL)
    return PART_OK;
  PART_TRY(make_room(dem, (size_t)dem->pairs->start[dem->pairs->rows] + 1));
  clear_history(dem);
  dem->fast.last_way = 0.0; /* not known after a restart */
  make_inner(dem);
  return PART_OK;
}

void dem_fast_return(const dem_t *dem) {
  const dem_fast *fast = &dem->fast;
  const int width = dem->pairs->data_width;
  if (fast->kernels == NULL || width == 0)
    return;
  for (int k = 0; k < fast->pairs; k++)
    for (int c = 0; c < width && fast->slot[k] >= 0; c++)
      dem->pairs->data[(size_t)width * (size_t)fast->slot[k] + (size_t)c] = fast->history[c][k];
}

void dem_fast_moved(dem_t *dem, double way) {
  dem->fast.way += way;
  dem->fast.last_way = way;
}

void dem_fast_update(dem_t *dem) {
  if (2.0 * dem->fast.way <= dem->fast.inner)
    return;
  dem_fast_return(dem);
  make_inner(dem);
}
