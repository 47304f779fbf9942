/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Walls that move (S.28): faces as a function of time, velocity and acceleration at a place. */
#include "internal.h"

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double length_of(const double a[3]) {
  return sqrt(dot(a, a));
}

static part_motion motion_of(const sph_wall_params *p) {
  return PART_MOTION_OF(p);
}

/* ---- what is allowed ---------------------------------------------------------------------------
 */
static double across(const double a[3], const double b[3]) {
  const double n[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                       a[0] * b[1] - a[1] * b[0]};
  return length_of(n);
}

/* The model must know what to do with it. */
static int check_model(const sph_wall_params *p, int sliding) {
  if (p->model == SPH_WALL_ghost || (p->model == SPH_WALL_fixed && sliding))
    return PART_OK;
  return part_fail(PART_ERR_RANGE,
                   "entry %s: must be 0 with the wall's model; walls move with model ghostPoints%s",
                   p->rotation_rate != 0.0          ? "rotationRate"
                   : p->oscillation_amplitude > 0.0 ? "oscillationAmplitude"
                                                    : "velocity",
                   p->model == SPH_WALL_fixed ? ", planes along themselves with fixedPoints" : "");
}

/* Faces go on through periodic borders as they were given. */
static int check_periodic(const sph_t *sph, const sph_wall_params *p) {
  for (int c = 0; c < 3; c++) {
    double along[3] = {0.0, 0.0, 0.0};
    along[c] = 1.0;
    if (!sph->box.periodic[c] && !(c == 2 && sph->params.dimensions == 2))
      continue;
    if (p->rotation_rate != 0.0 && across(p->rotation_axis, along) > 1e-9)
      return part_fail(
          PART_ERR_RANGE,
          "entry rotationAxis: must be along %c, %s, so that the wall turns in itself", "xyz"[c],
          sph -> box.periodic[c] ? "in which the domain is periodic" : "with dimensions 2");
    if (p->type == SPH_PLANE)
      continue;
    if (p->velocity[c] != 0.0 ||
        (p->oscillation_amplitude > 0.0 && p->oscillation_direction[c] != 0.0))
      return part_fail(PART_ERR_RANGE, "entry %s: triangles can not move along %c, %s",
                       p->velocity[c] != 0.0 ? "velocity" : "oscillationDirection", "xyz"[c],
                       sph -> box.periodic[c] ? "in which the domain is periodic"
                                              : "with dimensions 2");
  }
  return PART_OK;
}

int sph_wall_check_motion(const sph_t *sph, sph_wall_params *p) {
  part_motion m = motion_of(p);
  PART_TRY(part_motion_check(&m));
  memcpy(p->rotation_axis, m.rotation_axis, sizeof m.rotation_axis);
  memcpy(p->oscillation_direction, m.oscillation_direction, sizeof m.oscillation_direction);
  if (!part_motion_moves(&m))
    return PART_OK;
  const int along =
      p->type == SPH_PLANE && m.rotation_rate == 0.0 && m.oscillation_amplitude == 0.0 &&
      fabs(dot(p->velocity, p->normal)) <= 1e-12 * length_of(p->velocity) * length_of(p->normal);
  PART_TRY(check_model(p, along));
  if (p->type == SPH_PLANE && m.rotation_rate != 0.0 &&
      across(m.rotation_axis, p->normal) > 1e-9 * length_of(p->normal))
    return part_fail(
        PART_ERR_RANGE,
        "entry rotationAxis: a plane has no end, so it can turn only about its normal");
  return check_periodic(sph, p);
}

/* ---- where they are ----------------------------------------------------------------------------
 */
static double off_axis(const part_motion *m, const double x[3]) {
  const double d[3] = {x[0] - m->centre[0], x[1] - m->centre[1], x[2] - m->centre[2]};
  return across(d, m->rotation_axis);
}

static void prepare_wall(sph_wall *wall) {
  const part_motion m = motion_of(&wall->params);
  const double speed = length_of(m.velocity), *n = wall->params.normal;
  wall->motion = m;
  wall->moves = part_motion_moves(&m);
  wall->turns = m.rotation_rate != 0.0;
  wall->travels = wall->moves && wall->params.type == SPH_TRIANGLES;
  if (wall->params.type == SPH_PLANE)
    wall->travels = fabs(dot(m.velocity, n)) > 1e-12 * speed * length_of(n) ||
                    (m.oscillation_amplitude > 0.0 &&
                     fabs(dot(m.oscillation_direction, n)) > 1e-12 * length_of(n));
}

int sph_walls_prepare(sph_t *sph) {
  sph_walls *walls = &sph->walls;
  size_t room = 0;
  for (int w = 0; w < walls->count; w++) {
    prepare_wall(&walls->wall[w]);
    walls->moving |= walls->wall[w].moves;
    walls->travelling |= walls->wall[w].travels;
  }
  if (walls->travelling) {
    PART_TRY(sph_grow((size_t)walls->faces, sizeof *walls->given, &room, &walls->given));
    memcpy(walls->given, walls->face, (size_t)walls->faces * sizeof *walls->given);
  }
  for (int f = 0; f < walls->faces; f++) {
    const sph_face *face = &walls->face[f];
    sph_wall *wall = &walls->wall[face->wall];
    if (wall->turns && face->type == SPH_TRIANGLES)
      wall->sweep =
          fmax(wall->sweep,
               fmax(off_axis(&wall->motion, face->a),
                    fmax(off_axis(&wall->motion, face->b), off_axis(&wall->motion, face->c))));
  }
  sph_walls_move(sph, sph->time);
  return PART_OK;
}

static void move_point(const sph_wall *wall, const double from[3], double to[3]) {
  const part_pose *pose = &wall->pose;
  const double *o = wall->motion.centre;
  const double d[3] = {from[0] - o[0], from[1] - o[1], from[2] - o[2]};
  for (int c = 0; c < 3; c++)
    to[c] = wall->turns ? o[c] + pose->way[c] + dot(pose->turn[c], d) : from[c] + pose->way[c];
}

void sph_walls_move(sph_t *sph, double t) {
  sph_walls *walls = &sph->walls;
  for (int w = 0; w < walls->count && walls->moving; w++)
    if (walls->wall[w].moves)
      part_motion_pose(&walls->wall[w].motion, t, 0.0, &walls->wall[w].pose);
  for (int f = 0; f < walls->faces && walls->travelling; f++) {
    const sph_face *given = &walls->given[f];
    const sph_wall *wall = &walls->wall[given->wall];
    sph_face *face = &walls->face[f];
    if (!wall->travels)
      continue;
    move_point(wall, given->a, face->a);
    if (given->type == SPH_PLANE)
      continue; /* turns in itself alone */
    move_point(wall, given->b, face->b);
    move_point(wall, given->c, face->c);
    for (int c = 0; c < 3 && wall->turns; c++)
      face->n[c] = dot(wall->pose.turn[c], given->n);
  }
}

/* ---- how fast ----------------------------------------------------------------------------------
 */
/* From the wall's centre to the foot of x. */
static void lever_of(const sph_wall *wall, const sph_face *face, const double x[3],
                     double lever[3]) {
  const double d[3] = {x[0] - face->a[0], x[1] - face->a[1], x[2] - face->a[2]};
  const double height = dot(d, face->n);
  for (int c = 0; c < 3; c++)
    lever[c] = x[c] - height * face->n[c] - wall->motion.centre[c] - wall->pose.way[c];
}

void sph_face_velocity(const sph_t *sph, const sph_face *face, const double x[3], double u[3]) {
  const sph_wall *wall = &sph->walls.wall[face->wall];
  double lever[3];
  memcpy(u, wall->pose.drift, sizeof wall->pose.drift);
  if (!wall->turns)
    return;
  lever_of(wall, face, x, lever);
  for (int c = 0; c < 3; c++)
    u[c] += dot(wall->pose.gain[c], lever);
}

void sph_face_acceleration(const sph_t *sph, const sph_face *face, const double x[3], double a[3]) {
  const sph_wall *wall = &sph->walls.wall[face->wall];
  double lever[3], u[3];
  memcpy(a, wall->pose.acceleration, sizeof wall->pose.acceleration);
  if (!wall->turns)
    return;
  lever_of(wall, face, x, lever);
  for (int c = 0; c < 3; c++)
    u[c] = dot(wall->pose.gain[c], lever);
  for (int c = 0; c < 3; c++)
    a[c] += dot(wall->pose.gain[c], u);
}

static double swing_of(const part_motion *m) { /* m/s */
  return 6.28318530717958647693 * m->oscillation_frequency * m->oscillation_amplitude;
}

double sph_walls_speed(const sph_t *sph) {
  double most = 0.0;
  for (int w = 0; w < sph->walls.count && sph->walls.moving; w++) {
    const sph_wall *wall = &sph->walls.wall[w];
    const part_motion *m = &wall->motion;
    most = fmax(most, length_of(m->velocity) + swing_of(m) + fabs(m->rotation_rate) * wall->sweep);
  }
  return most;
}

double sph_walls_way(const sph_t *sph, double h) {
  return sph->walls.travelling ? h * sph_walls_speed(sph) : 0.0;
}

/* Fifty steps in a period of an oscillation or a turn. */
double sph_walls_motion_step(const sph_t *sph) {
  double step = HUGE_VAL;
  for (int w = 0; w < sph->walls.count && sph->walls.moving; w++) {
    const part_motion *m = &sph->walls.wall[w].motion;
    if (m->oscillation_amplitude > 0.0)
      step = fmin(step, 0.02 / m->oscillation_frequency);
    if (m->rotation_rate != 0.0)
      step = fmin(step, 0.02 * 6.28318530717958647693 / fabs(m->rotation_rate));
  }
  return step;
}
