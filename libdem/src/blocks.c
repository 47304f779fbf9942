/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rigid blocks: members share one velocity and do not turn. The state of a block is the same on
 * every rank bit for bit, because sums over ranks are taken in rank order everywhere.
 *
 * Mass of a member in the damping of a contact: against a free particle that of its block, which is
 * what the particle has to push, so that the pair has the restitution asked for. Against what does
 * not give way (walls, fixed particles, other blocks) its own: there many members touch together,
 * and with the block's mass n of them would damp sqrt(n) times too much, up to instability. With
 * its own a block that lands on all its members has the restitution asked for, and one that lands
 * on n of N has the damping ratio sqrt(n/N) of it. */
#include "flow.h"
#include "internal.h"
#include "particle/vtkhdf.h"

enum { BLOCK_VALUES = 11 };

int dem_rank_sum(const dem_t *dem, int n, double *values) {
  double *all;
  if (dem->ranks == 1)
    return PART_OK;
  PART_TRY(part_agree(dem->comm, dem_allocate((size_t)n * (size_t)dem->ranks, sizeof *all, &all)));
  const int error = MPI_Allgather(values, n, MPI_DOUBLE, all, n, MPI_DOUBLE, dem->comm);
  for (int k = 0; k < n; k++)
    values[k] = 0.0;
  for (int r = 0; r < dem->ranks; r++)
    for (int k = 0; k < n; k++)
      values[k] += all[(size_t)r * (size_t)n + (size_t)k];
  free(all);
  return error == MPI_SUCCESS ? PART_OK : part_fail(PART_ERR_MPI, "a sum over ranks failed");
}

/* Sums over the members of every block of `width` values that start at base[stride i]. */
static int member_sums(const dem_t *dem, const double *base, size_t stride, int width,
                       double **sums) {
  PART_TRY(part_agree(dem->comm, dem_allocate((size_t)(dem->blocks * width), sizeof **sums, sums)));
  for (int i = 0; i < dem->store->local; i++)
    if (dem_kind_of(dem, i) == DEM_BLOCK)
      for (int c = 0; c < width; c++)
        (*sums)[dem_block_of(dem, i) * width + c] += base[stride * (size_t)i + (size_t)c];
  const int status = dem_rank_sum(dem, dem->blocks * width, *sums);
  if (status != PART_OK)
    free(*sums);
  return status;
}

int dem_blocks_begin(dem_t *dem) {
  double *sums;
  PART_TRY(member_sums(dem, dem_fluid(dem), DEM_FLUID, 4, &sums));
  for (int b = 0; b < dem->blocks; b++) {
    dem_block *block = &dem->block[b];
    for (int c = 0; c < 3; c++) {
      block->su[c] = sums[4 * b + c];
      block->path[c] = block->impulse[c] = 0.0;
    }
    block->sp = sums[4 * b + 3];
  }
  free(sums);
  return PART_OK;
}

int dem_blocks_forces(dem_t *dem) {
  double *sums;
  PART_TRY(member_sums(dem, dem_ft(dem), DEM_FT, 3, &sums));
  for (int b = 0; b < dem->blocks; b++)
    for (int c = 0; c < 3; c++)
      dem->block[b].force[c] = sums[3 * b + c];
  free(sums);
  return PART_OK;
}

/* Half step of one block with the force of now; the displacement of drift_h with it. */
static void move_block(dem_t *dem, int number, double t, double h, double drift_h) {
  dem_block *block = &dem->block[number];
  const double w = 1.0 / block->mass, b = block->sp * w * h;
  const dem_flow half = dem_flow_of(b), whole = dem_flow_of(block->sp * w * drift_h);
  double weight = 0.0;
  for (int m = 0; m < dem->materials; m++)
    weight += dem->block_gravity[number * dem->materials + m] * dem_gravity_factor(dem, m, t, h);
  /* Every rank knows the block; one of them counts its share of the budget. */
  if (dem->rank == 0)
    part_sum_add(&dem->gravity_impulse, dem->params.gravity, weight * h);
  for (int c = 0; c < 3; c++) {
    const double a = (block->force[c] + weight * dem->params.gravity[c]) * w;
    const double s = block->su[c] * w, v = block->v[c];
    block->shift[c] = v * drift_h * whole.phi1 + (a + s) * drift_h * drift_h * whole.phi2;
    const double by_fluid = s * h * half.phi1 - v * half.lost - a * h * b * half.phi2;
    block->path[c] += v * h * half.phi1 + (a + s) * h * h * half.phi2;
    block->v[c] += a * h + by_fluid;
    block->x[c] += block->shift[c];
    block->impulse[c] += by_fluid * block->mass;
  }
}

static void move_members(dem_t *dem) {
  double *xr = dem_xr(dem), *vm = dem_vm(dem);
  for (int i = 0; i < dem->store->local; i++) {
    if (dem_kind_of(dem, i) != DEM_BLOCK)
      continue;
    const dem_block *block = &dem->block[dem_block_of(dem, i)];
    for (size_t c = 0; c < 3; c++) {
      xr[DEM_XR * (size_t)i + c] += block->shift[c];
      vm[DEM_VM * (size_t)i + c] = block->v[c];
    }
  }
}

static void move_blocks(dem_t *dem, double t, double h, double drift_h) {
  part_timers_start(dem->timers, dem->stage[DEM_STAGE_BLOCKS]);
  for (int b = 0; b < dem->blocks; b++)
    if (dem->block[b].members > 0)
      move_block(dem, b, t, h, drift_h);
  move_members(dem);
  part_timers_stop(dem->timers, dem->stage[DEM_STAGE_BLOCKS]);
}

double dem_blocks_kick_drift(dem_t *dem, double t, double h) {
  double most = 0.0;
  move_blocks(dem, t, 0.5 * h, h);
  for (int b = 0; b < dem->blocks; b++) {
    const double *s = dem->block[b].shift;
    const double way2 = s[0] * s[0] + s[1] * s[1] + s[2] * s[2];
    if (dem->block[b].members > 0)
      most = way2 > most ? way2 : most;
  }
  return sqrt(most);
}
void dem_blocks_kick(dem_t *dem, double t, double h) {
  move_blocks(dem, t, 0.5 * h, 0.0);
}

/* Shares of the members, J_i = Su_i dt - Sp_i (path of the block). Their sum equals the impulse of
 * the block but for the rounding of two large terms when drag is stiff; that rest is given out by
 * Sp_i (by number without drag), so that the shares add up. */
int dem_blocks_end(dem_t *dem, double dt) {
  double *fluid = dem_fluid(dem), *sums;
  for (int i = 0; i < dem->store->local; i++) {
    if (dem_kind_of(dem, i) != DEM_BLOCK)
      continue;
    double *f = fluid + DEM_FLUID * (size_t)i;
    for (int c = 0; c < 3; c++)
      f[4 + c] = f[c] * dt - f[3] * dem->block[dem_block_of(dem, i)].path[c];
  }
  PART_TRY(member_sums(dem, fluid + 4, DEM_FLUID, 3, &sums));
  for (int i = 0; i < dem->store->local; i++) {
    if (dem_kind_of(dem, i) != DEM_BLOCK)
      continue;
    const int b = dem_block_of(dem, i);
    const dem_block *block = &dem->block[b];
    double *f = fluid + DEM_FLUID * (size_t)i;
    const double share = block->sp > 0.0 ? f[3] / block->sp : 1.0 / (double)block->members;
    for (int c = 0; c < 3; c++)
      f[4 + c] += share * (block->impulse[c] - sums[3 * b + c]);
  }
  free(sums);
  return PART_OK;
}

void dem_blocks_add(dem_t *dem, const double *impulse) {
  for (int b = 0; b < dem->blocks; b++) {
    dem_block *block = &dem->block[b];
    for (int c = 0; c < 3 && block->members > 0; c++) {
      block->v[c] += impulse[3 * b + c] / block->mass;
      block->shift[c] = 0.0;
    }
  }
  move_members(dem);
}

/* ---- files ----------------------------------------------------------------------------------- */
/* [blocks][BLOCK_VALUES], then [blocks][materials] masses. */
static int pack_blocks(const dem_t *dem, double **values, int *n) {
  *n = dem->blocks * (BLOCK_VALUES + dem->materials);
  PART_TRY(dem_allocate((size_t)*n, sizeof **values, values));
  for (int b = 0; b < dem->blocks; b++) {
    const dem_block *block = &dem->block[b];
    double *to = *values + BLOCK_VALUES * b;
    to[0] = (double)block->members;
    to[1] = block->mass;
    memcpy(to + 2, block->x, 3 * sizeof(double));
    memcpy(to + 5, block->v, 3 * sizeof(double));
    memcpy(to + 8, block->force, 3 * sizeof(double));
  }
  if (dem->blocks > 0)
    memcpy(*values + BLOCK_VALUES * dem->blocks, dem->block_gravity,
           (size_t)(dem->blocks * dem->materials) * sizeof(double));
  return PART_OK;
}

static int unpack_blocks(dem_t *dem, const double *from) {
  PART_TRY(dem_allocate((size_t)dem->blocks, sizeof *dem->block, &dem->block));
  PART_TRY(dem_allocate((size_t)(dem->blocks * dem->materials), sizeof *dem->block_gravity,
                        &dem->block_gravity));
  for (int b = 0; b < dem->blocks; b++, from += BLOCK_VALUES) {
    dem_block *block = &dem->block[b];
    block->members = (int64_t)from[0];
    block->mass = from[1];
    memcpy(block->x, from + 2, 3 * sizeof(double));
    memcpy(block->v, from + 5, 3 * sizeof(double));
    memcpy(block->force, from + 8, 3 * sizeof(double));
  }
  if (dem->blocks > 0)
    memcpy(dem->block_gravity, from, (size_t)(dem->blocks * dem->materials) * sizeof(double));
  return PART_OK;
}

int dem_blocks_write(const dem_t *dem, part_file *file) {
  double *values = NULL;
  int n = 0;
  int status = part_agree(dem->comm, pack_blocks(dem, &values, &n));
  if (status == PART_OK && n > 0)
    status = part_file_write_values(file, "demBlocks", n, values);
  free(values);
  return status;
}

int dem_blocks_read(dem_t *dem, part_file *file) {
  int n = dem->blocks * (BLOCK_VALUES + dem->materials);
  double *values = NULL;
  if (n == 0)
    return PART_OK;
  int status = part_agree(dem->comm, dem_allocate((size_t)n, sizeof *values, &values));
  if (status == PART_OK)
    status = part_file_read_values(file, "demBlocks", &n, values);
  if (status == PART_OK)
    status = part_agree(dem->comm, unpack_blocks(dem, values));
  free(values);
  return status;
}
