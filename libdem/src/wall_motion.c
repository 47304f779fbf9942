/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where walls are: an exact function of time, so that nothing drifts and a restart goes on. */
#include "internal.h"

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double length(const double a[3]) {
  return sqrt(dot(a, a));
}

/* Distance of x from the axis of rotation. */
static double off_axis(const dem_wall_params *p, const double x[3]) {
  const double d[3] = {x[0] - p->centre[0], x[1] - p->centre[1], x[2] - p->centre[2]};
  const double along = dot(d, p->rotation_axis);
  return sqrt(fmax(dot(d, d) - along * along, 0.0));
}

/* Rotation turns a plane about its normal, and an infinite cylinder about its direction
 * (wall_params.c): as a set a plane stays where it is, and so does a cylinder about its own axis.
 */
static double sweep_of(const dem_wall_params *p, const dem_element *e) {
  if (e->shape == DEM_SHAPE_PLANE)
    return 0.0;
  if (e->shape == DEM_SHAPE_TRIANGLE)
    return fmax(off_axis(p, e->a), fmax(off_axis(p, e->b), off_axis(p, e->c)));
  const double end[3] = {e->a[0] + e->length * e->n[0], e->a[1] + e->length * e->n[1],
                         e->a[2] + e->length * e->n[2]};
  const double off = fmax(off_axis(p, e->a), off_axis(p, end));
  const double aligned = fabs(dot(e->n, p->rotation_axis));
  return off <= 1e-12 * e->radius && aligned > 1.0 - 1e-14 ? 0.0 : off + e->radius;
}

static void set_pose(const dem_wall *wall, double t, double h, dem_pose *pose) {
  const part_motion motion = dem_wall_motion(&wall->params);
  part_motion_pose(&motion, t, h, &pose->body);
  for (int c = 0; c < 3; c++) {
    pose->shift[c] = pose->body.way[c] - wall->wrap[c];
    pose->from[c] = motion.centre[c] + pose->shift[c];
  }
}

void dem_wall_prepare(dem_wall *wall, const dem_element *element) {
  const dem_wall_params *p = &wall->params;
  const part_motion motion = dem_wall_motion(p);
  wall->turns = p->rotation_rate != 0.0;
  wall->moves = part_motion_moves(&motion);
  for (int k = 0; k < wall->count && wall->turns; k++)
    wall->sweep = fmax(wall->sweep, sweep_of(p, &element[k]));
  set_pose(wall, p->start_time, 0.0, &wall->pose);
  wall->listed = wall->pose;
}

int dem_wall_fits(const dem_t *dem, const dem_wall *wall, double *least) {
  const dem_wall_params *p = &wall->params;
  if (p->type == DEM_WALL_CYLINDER && p->side == DEM_WALL_INSIDE && !(p->radius > dem->r_max))
    return part_fail(PART_ERR_RANGE,
                     "wall %s: entry radius: %g m is not allowed; must be larger than that of the "
                     "largest particle, %g m",
                     wall->name, p->radius, dem->r_max);
  if (p->oscillation_amplitude > 0.0)
    *least = fmin(*least, 1.0 / p->oscillation_frequency);
  return PART_OK;
}

/* Way of the surface between two poses. A plane feels only what goes along its normal. */
static double way_between(const dem_t *dem, const dem_wall *wall, const dem_pose *a,
                          const dem_pose *b) {
  const double pi = 3.14159265358979323846;
  const double d[3] = {b->shift[0] - a->shift[0], b->shift[1] - a->shift[1],
                       b->shift[2] - a->shift[2]};
  const dem_element *e = &dem->walls.element[wall->first];
  const double shifted = e->shape == DEM_SHAPE_PLANE ? fabs(dot(d, e->n)) : length(d);
  return shifted + 2.0 * wall->sweep * sin(0.5 * fmin(fabs(b->body.angle - a->body.angle), pi));
}

void dem_walls_move(dem_t *dem, double t, double h) {
  dem_walls *walls = &dem->walls;
  double most = 0.0, since = 0.0;
  for (int w = 0; w < walls->count && walls->moving; w++) {
    dem_wall *wall = &walls->wall[w];
    const dem_pose before = wall->pose;
    if (!wall->moves)
      continue;
    set_pose(wall, t, h, &wall->pose);
    for (int c = 0; c < 3; c++) {
      const int d = (c + 1) % 3, e = (c + 2) % 3;
      wall->spin[c] = 0.5 * (wall->pose.body.gain[e][d] - wall->pose.body.gain[d][e]);
    }
    most = fmax(most, way_between(dem, wall, &before, &wall->pose));
    since = fmax(since, way_between(dem, wall, &wall->listed, &wall->pose));
  }
  walls->path += most;
  walls->travel = since;
}

/* Whole periods are taken off only here: shift codes in the lists refer to them. */
void dem_walls_listed(dem_t *dem) {
  dem_walls *walls = &dem->walls;
  for (int w = 0; w < walls->count && walls->moving; w++) {
    dem_wall *wall = &walls->wall[w];
    for (int c = 0; c < 3; c++) {
      const double period = dem->box.hi[c] - dem->box.lo[c];
      wall->wrap[c] = dem->box.periodic[c] ? period * rint(wall->pose.body.way[c] / period) : 0.0;
      wall->pose.shift[c] = wall->pose.body.way[c] - wall->wrap[c];
      wall->pose.from[c] = wall->params.centre[c] + wall->pose.shift[c];
    }
    wall->listed = wall->pose;
  }
  walls->travel = 0.0;
  walls->particle_travel = 0.0;
}

double dem_walls_way(const dem_t *dem, double dt) {
  double most = 0.0;
  for (int w = 0; w < dem->walls.count && dem->walls.moving; w++) {
    const dem_wall_params *p = &dem->walls.wall[w].params;
    const double omega = 6.28318530717958647693 * p->oscillation_frequency;
    const double way = length(p->velocity) * dt +
                       fabs(p->rotation_rate) * dem->walls.wall[w].sweep * dt +
                       p->oscillation_amplitude * fmin(omega * dt, 2.0);
    most = fmax(most, way);
  }
  return most;
}

void dem_wall_see(const dem_t *dem, const dem_wall *wall, int shift, const double x[3],
                  double seen[3]) {
  const double *lo = dem->box.lo, *hi = dem->box.hi;
  memcpy(seen, x, 3 * sizeof *seen);
  if (shift != DEM_NO_SHIFT) {
    /* The element at + s L meets x where the element itself meets x - s L. */
    const int s[3] = {shift % 3 - 1, shift / 3 % 3 - 1, shift / 9 - 1};
    for (int c = 0; c < 3; c++)
      seen[c] -= s[c] * (hi[c] - lo[c]);
  }
  if (!wall->moves)
    return;
  if (!wall->turns) {
    for (int c = 0; c < 3; c++)
      seen[c] -= wall->pose.shift[c];
    return;
  }
  const double(*turn)[3] = wall->pose.body.turn, *centre = wall->params.centre;
  const double d[3] = {seen[0] - wall->pose.from[0], seen[1] - wall->pose.from[1],
                       seen[2] - wall->pose.from[2]};
  for (int c = 0; c < 3; c++)
    seen[c] = centre[c] + (turn[0][c] * d[0] + turn[1][c] * d[1] + turn[2][c] * d[2]);
}

void dem_wall_direct(const dem_wall *wall, double v[3]) {
  const double a[3] = {v[0], v[1], v[2]};
  for (int c = 0; c < 3 && wall->turns; c++)
    v[c] = dot(wall->pose.body.turn[c], a);
}

int dem_wall_nearest(const dem_t *dem, int element, int shift, const double x[3], double p[3],
                     double n[3], double *distance) {
  const dem_element *e = &dem->walls.element[element];
  const dem_wall *wall = &dem->walls.wall[e->wall];
  double seen[3];
  dem_wall_see(dem, wall, shift, x, seen);
  const int feature = dem_element_nearest(e, seen, p, n, distance);
  dem_wall_direct(wall, p);
  dem_wall_direct(wall, n);
  return feature;
}
