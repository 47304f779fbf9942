/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The contact horizon: how long no contact can begin. With constant forces and linear drag a step
 * of any length is exact without contact, so that steps up to there may be taken at once and the
 * answer does not change.
 *
 * With a the acceleration of now, force and drag, and b = Sp/m, a particle is at
 *   x(t) = x + v t + a t^2/2 f(b t),   f = 2 phi2 falls from 1 to 0, |f'| <= 1/3 (flow.h)
 * Two particles, a gap apart along n, come nearer by no more than
 *   c t + A t^2/2,   c = -(v_i - v_j) . n,   A = |a_i - a_j| + |a_i| min(1, |b_i - b_j| T/3)
 * for t <= T. So a cloud that moves as one does not make steps short. Pairs that are not listed are
 * at least skin - 2 travel apart; each of them leaves the mean motion of all with c and A/2. */
#include "internal.h"

/* Of one particle, up to the end of the time that is looked at. */
typedef struct drift {
  double v[3], a[3], b;
  double spare; /* m/s, in any direction: members of a clump, which turn */
} drift;

typedef struct outlook {
  const dem_t *dem;
  double time;             /* s, how far it looks */
  double clumps;           /* m/s, of members of clumps */
  double v[3], a[3];       /* means; zero where something is fixed */
  double off[2];           /* largest c and A of a particle against the mean motion */
  double fastest, hardest; /* largest |v| and |a| */
  double wall_way, wall_speed;
} outlook;

/* Time in which c t + a t^2/2 reaches gap, a >= 0. */
static double time_to(double gap, double c, double a) {
  if (!(gap > 0.0))
    return 0.0;
  const double root = sqrt(c * c + 2.0 * a * gap);
  if (c > 0.0)
    return 2.0 * gap / (c + root);
  return a > 0.0 ? (root - c) / a : HUGE_VAL;
}

static double length(const double v[3]) {
  return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static double apart(const double a[3], const double b[3]) {
  const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  return length(d);
}

static void accelerate(drift *d, const double *v, const double *su, double sp, double inverse_mass,
                       const double *g) {
  for (int c = 0; c < 3; c++) {
    d->v[c] = v[c];
    d->a[c] = (su[c] - sp * v[c]) * inverse_mass + g[c];
  }
  d->b = sp * inverse_mass;
}

static drift drift_of(const outlook *view, int i) {
  const dem_t *dem = view->dem;
  const double *v = dem_vm(dem) + DEM_VM * (size_t)i, *f = dem_fluid(dem) + DEM_FLUID * (size_t)i;
  const double own = dem_own_part(dem, dem_material_of(dem, i)), *weight = dem->params.gravity;
  const double g[3] = {own * weight[0], own * weight[1], own * weight[2]};
  drift d = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, 0.0, 0.0};
  const dem_block *block;
  switch (dem_kind_of(dem, i)) {
  case DEM_FREE:
    accelerate(&d, v, f, f[3], v[3], g);
    break;
  case DEM_BLOCK:
    block = &dem->block[dem_block_of(dem, i)];
    accelerate(&d, block->v, block->su, block->sp, 1.0 / block->mass, g);
    break;
  case DEM_CLUMP:
    d.spare = view->clumps;
    break;
  default:
    break;
  }
  return d;
}

/* Mean motion of all, and the largest deviation from it. Collective; only pairs need it. */
static void mean_motion(outlook *view) {
  const dem_t *dem = view->dem;
  double sum[8] = {0.0};
  for (int i = 0; i < dem->store->local; i++) {
    const drift d = drift_of(view, i);
    const int still = dem_kind_of(dem, i) == DEM_FIXED || d.spare > 0.0;
    for (int c = 0; c < 3; c++) {
      sum[c] += d.v[c];
      sum[3 + c] += d.a[c];
    }
    sum[6] += 1.0;
    sum[7] += still;
  }
  MPI_Allreduce(MPI_IN_PLACE, sum, 8, MPI_DOUBLE, MPI_SUM, dem->comm);
  for (int c = 0; c < 3; c++) {
    view->v[c] = sum[7] > 0.0 ? 0.0 : sum[c] / sum[6];
    view->a[c] = sum[7] > 0.0 ? 0.0 : sum[3 + c] / sum[6];
  }
  for (int i = 0; i < dem->store->local; i++) {
    const drift d = drift_of(view, i);
    view->off[0] = fmax(view->off[0], apart(d.v, view->v) + d.spare);
    view->off[1] =
        fmax(view->off[1], apart(d.a, view->a) + length(d.a) * fmin(1.0, d.b * view->time / 3.0));
  }
  MPI_Allreduce(MPI_IN_PLACE, view->off, 2, MPI_DOUBLE, MPI_MAX, dem->comm);
}

/* Su and Sp are not on copies: those count with the largest deviation of all. */
static double pair_time(const outlook *view, int i, int j, double slack) {
  const dem_t *dem = view->dem;
  const double *x = dem_xr(dem) + DEM_XR * (size_t)i, *y = dem_xr(dem) + DEM_XR * (size_t)j;
  const double n[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]}, distance = length(n);
  const double gap = distance - x[3] - y[3] - slack;
  if (!(gap > 0.0))
    return 0.0;
  const drift p = drift_of(view, i);
  const drift q = drift_of(view, j);
  double c = p.spare + q.spare, a;
  for (int k = 0; k < 3; k++)
    c -= (p.v[k] - q.v[k]) * n[k] / distance;
  if (j >= dem->store->local)
    a = apart(p.a, view->a) + length(p.a) * fmin(1.0, p.b * view->time / 3.0) + view->off[1];
  else
    a = apart(p.a, q.a) + length(p.a) * fmin(1.0, fabs(p.b - q.b) * view->time / 3.0);
  return time_to(gap, c, a);
}

static double pairs_time(const outlook *view, double slack) {
  const dem_t *dem = view->dem;
  double far = dem->skin - 2.0 * dem->travel - slack;
  if (dem->plan.lubrication)
    far = fmin(far, dem_film_gap(dem) - slack);
  double least = time_to(far, 2.0 * view->off[0], 2.0 * view->off[1]);
  for (int i = 0; i < dem->pairs->rows && least > 0.0; i++)
    for (int k = dem->pairs->start[i]; k < dem->pairs->start[i + 1]; k++)
      least = fmin(least, pair_time(view, i, dem->pairs->partner[k], slack));
  return least;
}

/* A place of a wall at the distance `gap` against the direction n; curved: of a cylinder. */
static double place_time(const outlook *view, int i, double gap, const double n[3], int curved) {
  const drift d = drift_of(view, i);
  double c = d.spare, a = 0.0;
  for (int k = 0; k < 3; k++) {
    c -= d.v[k] * n[k];
    a -= d.a[k] * n[k];
  }
  if (curved) {
    c = d.spare + length(d.v);
    a = length(d.a);
  }
  a = fmax(a, 0.0);
  return fmax(time_to(gap, c + view->wall_speed, a), time_to(gap - view->wall_way, c, a));
}

static double near_walls_time(const outlook *view, double slack) {
  const dem_t *dem = view->dem;
  const dem_walls *walls = &dem->walls;
  double least = HUGE_VAL, p[3], n[3], distance;
  for (int row = 0; row < walls->rows; row++)
    for (int k = walls->start[row]; k < walls->start[row + 1]; k++) {
      const int i = walls->particle[row], element = walls->near[k].element;
      const double *x = dem_xr(dem) + DEM_XR * (size_t)i;
      dem_wall_nearest(dem, element, walls->near[k].shift, x, p, n, &distance);
      least = fmin(least, place_time(view, i, distance - x[3] - slack, n,
                                     walls->element[element].shape == DEM_SHAPE_CYLINDER));
    }
  return least;
}

/* A plane of which periodic images are seen has more than one direction. */
static int has_images(const dem_t *dem, const dem_element *e) {
  int any = 0;
  for (int c = 0; c < 3; c++)
    any |= dem->box.periodic[c] && e->n[c] != 0.0;
  return any;
}

/* Planes and cylinders are few and looked at by everything; triangles that are not listed are far.
 */
static double walls_time(const outlook *view, double slack) {
  const dem_t *dem = view->dem;
  const dem_walls *walls = &dem->walls;
  double least = near_walls_time(view, slack), p[3], n[3], distance;
  const double far =
      dem->skin + walls->margin - walls->travel - slack - (dem->travel + walls->particle_travel);
  if (walls->groups > 0)
    least = fmin(least, fmax(time_to(far, view->fastest + view->wall_speed, view->hardest),
                             time_to(far - view->wall_way, view->fastest, view->hardest)));
  for (int w = 0; w < walls->count && least > 0.0; w++) {
    const int first = walls->wall[w].first, shape = walls->element[first].shape;
    for (int i = 0; shape != DEM_SHAPE_TRIANGLE && i < dem->store->local; i++) {
      const double *x = dem_xr(dem) + DEM_XR * (size_t)i;
      if (dem_kind_of(dem, i) == DEM_FIXED)
        continue;
      const int curved = shape == DEM_SHAPE_CYLINDER || has_images(dem, &walls->element[first]);
      distance = dem_wall_gap(dem, first, x);
      if (!curved)
        dem_wall_nearest(dem, first, DEM_NO_SHIFT, x, p, n, &distance);
      least = fmin(least, place_time(view, i, distance - x[3] - slack, n, curved));
    }
  }
  return least;
}

/* In a dense scene the first pairs say no. */
static int any_touch(const dem_t *dem, double slack) {
  const double *xr = dem_xr(dem);
  int touch = 0;
  for (int i = 0; i < dem->pairs->rows && !touch; i++)
    for (int k = dem->pairs->start[i]; k < dem->pairs->start[i + 1]; k++) {
      const double *x = xr + DEM_XR * (size_t)i;
      const double *y = xr + DEM_XR * (size_t)dem->pairs->partner[k];
      touch |= apart(x, y) - x[3] - y[3] <= slack;
    }
  return touch;
}

/* What pairs and walls of this rank allow; largest motion of the walls and, against them, of
 * particles. */
static double least_time(outlook *view, double slack) {
  const dem_t *dem = view->dem;
  double least = HUGE_VAL;
  if (dem->plan.pairs)
    least = pairs_time(view, slack);
  if (!dem->plan.walls || !(least > 0.0))
    return least;
  view->wall_way = dem_walls_way(dem, view->time);
  view->wall_speed = dem_walls_way(dem, 1e-9 * view->time) / (1e-9 * view->time);
  for (int i = 0; i < dem->store->local; i++) {
    const drift d = drift_of(view, i);
    view->fastest = fmax(view->fastest, length(d.v) + d.spare);
    view->hardest = fmax(view->hardest, length(d.a));
  }
  return fmin(least, walls_time(view, slack));
}

int dem_horizon(dem_t *dem, double dt, double *free_time) {
  outlook view = {.dem = dem, .time = dt};
  *free_time = 0.0;
  /* The ramp of gravity is the one force that changes with time: no long steps under it. */
  if (!dem->plan.horizon || dem->bonds.alive > 0 || dem->time < dem->params.ramp_time)
    return PART_OK;
  /* A little less than the gap, for rounding of positions. */
  const double slack = 1e-9 * dem->r_mean;
  if (dem->plan.pairs) {
    double worst[2] = {any_touch(dem, slack), 0.0};
    if (dem->plan.clumps)
      worst[1] = dem_clumps_way(dem, dt) / dt;
    MPI_Allreduce(MPI_IN_PLACE, worst, 2, MPI_DOUBLE, MPI_MAX, dem->comm);
    if (worst[0] > 0.0)
      return PART_OK;
    view.clumps = worst[1];
    mean_motion(&view);
  } else if (dem->plan.clumps) {
    view.clumps = dem_clumps_way(dem, dt) / dt;
  }
  double least = least_time(&view, slack);
  MPI_Allreduce(MPI_IN_PLACE, &least, 1, MPI_DOUBLE, MPI_MIN, dem->comm);
  least *= 1.0 - 1e-9;
  /* The bound of clumps holds at the end of dt alone. */
  *free_time = dem->plan.clumps && least < dt ? 0.0 : least;
  return PART_OK;
}
