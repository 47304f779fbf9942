/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The contact horizon: no contact step is taken while no contact can exist before the end of the
 * advance. With constant forces and linear drag a step of any length is exact without contact, so
 * the answer does not change. */
#include "internal.h"

/* Longest way within dt from velocity v under (F - Sp v)/m, a = F/m, b = Sp/m: the velocity stays
 * between its beginning and F/Sp, and |v| grows by at most |a| dt. */
static double way(const double v[3], const double a[3], double b, double dt) {
  const double speed = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  const double gain = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
  const double free_end = speed + gain * dt;
  const double drag_end = b > 0.0 ? fmax(speed, gain / b) : HUGE_VAL;
  return fmin(free_end, drag_end) * dt;
}

static double longest_way(const dem_t *dem, double dt) {
  const double *g = dem->params.gravity;
  double most = 0.0, a[3];
  for (int i = 0; i < dem->store->local; i++) {
    const double *v = dem_vm(dem) + DEM_VM * (size_t)i, *f = dem_fluid(dem) + DEM_FLUID * (size_t)i;
    if (dem_kind_of(dem, i) != DEM_FREE)
      continue;
    for (int c = 0; c < 3; c++)
      a[c] = f[c] * v[3] + g[c];
    most = fmax(most, way(v, a, f[3] * v[3], dt));
  }
  if (dem->plan.clumps)
    most = fmax(most, dem_clumps_way(dem, dt));
  for (int b = 0; b < dem->blocks; b++) {
    const dem_block *block = &dem->block[b];
    if (block->members == 0)
      continue;
    for (int c = 0; c < 3; c++)
      a[c] = block->su[c] / block->mass + g[c];
    most = fmax(most, way(block->v, a, block->sp / block->mass, dt));
  }
  return most;
}

/* Smallest gap of listed pairs and of any others. */
static double pair_gap(const dem_t *dem) {
  const double *xr = dem_xr(dem);
  double least = dem->skin - 2.0 * dem->travel;
  for (int i = 0; i < dem->pairs->rows; i++)
    for (int k = dem->pairs->start[i]; k < dem->pairs->start[i + 1]; k++) {
      const double *x = xr + DEM_XR * (size_t)i;
      const double *y = xr + DEM_XR * (size_t)dem->pairs->partner[k];
      const double d[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
      least = fmin(least, sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) - x[3] - y[3]);
    }
  return least;
}

/* Exact for planes and cylinders; triangles that are not listed are far. Less the way of the walls
 * themselves. */
static double wall_gap(const dem_t *dem, double dt) {
  const dem_walls *walls = &dem->walls;
  const double far = dem->skin + walls->margin - walls->travel;
  double least = walls->groups > 0 ? far - (dem->travel + walls->particle_travel) : HUGE_VAL;
  double p[3], n[3], distance;
  for (int row = 0; row < walls->rows; row++)
    for (int k = walls->start[row]; k < walls->start[row + 1]; k++) {
      const double *x = dem_xr(dem) + DEM_XR * (size_t)walls->particle[row];
      dem_wall_nearest(dem, walls->near[k].element, walls->near[k].shift, x, p, n, &distance);
      least = fmin(least, distance - x[3]);
    }
  for (int w = 0; w < walls->count; w++) {
    const int first = walls->wall[w].first;
    for (int i = 0; walls->element[first].shape != DEM_SHAPE_TRIANGLE && i < dem->store->local;
         i++) {
      const double *x = dem_xr(dem) + DEM_XR * (size_t)i;
      if (dem_kind_of(dem, i) == DEM_FIXED)
        continue;
      least = fmin(least, dem_wall_gap(dem, first, x) - x[3]);
    }
  }
  return least - dem_walls_way(dem, dt);
}

int dem_horizon(dem_t *dem, double dt, int *free_flight) {
  double worst[3] = {longest_way(dem, dt), HUGE_VAL, HUGE_VAL};
  *free_flight = 0;
  /* The ramp of gravity is the one force that changes with time: no long steps under it. */
  if (!dem->plan.horizon || dem->bonds.alive > 0 || dem->time < dem->params.ramp_time)
    return PART_OK;
  if (dem->plan.pairs)
    worst[1] = pair_gap(dem);
  if (dem->plan.lubrication)
    worst[1] = fmin(worst[1], dem_film_gap(dem));
  if (dem->plan.walls)
    worst[2] = wall_gap(dem, dt);
  worst[0] = -worst[0];
  MPI_Allreduce(MPI_IN_PLACE, worst, 3, MPI_DOUBLE, MPI_MIN, dem->comm);
  /* A little more than the bound, for rounding of positions. */
  const double safe = -worst[0] * (1.0 + 1e-9) + 1e-9 * dem->r_mean;
  *free_flight = 2.0 * safe < worst[1] && safe < worst[2];
  return PART_OK;
}
