/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the ghost points behind walls add to the sums of the pair loops: point by point, or from the
 * table where there is one plane alone. */
#include "internal.h"

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The table holds what is linear in the velocity: all but Monaghan's viscosity. */
static int by_table(const sph_t *sph, const sph_seer *s) {
  const int linear = sph->params.viscosity_model == SPH_MORRIS || !(sph->params.viscosity > 0.0);
  return s->alone && linear && sph->params.skip && !sph->plan.fixed && !sph->plan.variable;
}

/* Velocity of a particle less that of the ghost: normal part along n, the rest across. */
static double split(const sph_t *sph, int i, const sph_face *face, double across[3]) {
  const double *x = sph_xv(sph) + SPH_XV * (size_t)i, *v = x + 4;
  double normal = 0.0, wall[3];
  sph_face_velocity(sph, face, x, wall);
  for (int c = 0; c < 3; c++)
    normal += (v[c] - wall[c]) * face->n[c];
  for (int c = 0; c < 3; c++)
    across[c] = v[c] - wall[c] - normal * face->n[c];
  return normal;
}

/* Eq. 26 in S.4, for walls whose surface moves in itself; and V W for S.6. Ghosts have the pressure
 * that makes S.5 vanish. */
static void density_of_points(sph_t *sph, int i, sph_seer *s) {
  const double h = sph_length(sph, i), norm = sph_norm_at(sph, h), slope_norm = norm / (h * h);
  const double *v = sph_xv(sph) + SPH_XV * (size_t)i + 4;
  double *sum = sph->sum + SPH_SUMS * (size_t)i;
  double *shade = sph->plan.summation ? &sph->shade[i] : sph->plan.variable ? &sum[7] : NULL;
  const int n = sph_walls_points(sph, s);
  for (int k = 0; k < n; k++) {
    const sph_point *p = &sph->walls.point[k];
    const double q = sqrt(dot(p->r, p->r)) / h;
    const double f = p->volume * slope_norm * sph_slope(sph->params.kernel, q);
    sum[0] -= f * (dot(p->q, v) - p->pushed);
    sum[6] -= f * dot(p->r, p->r);
    if (shade != NULL)
      *shade += p->volume * norm * sph_shape(sph->params.kernel, q);
  }
}

static void density_by_table(sph_t *sph, int i, const sph_seer *s) {
  const double per_distance = sph_walls_mirror(sph, 1.0, s->distance) - 1.0;
  double t[SPH_TABLE_COUNT], across[3];
  sph_walls_look_up(sph, s->distance, t);
  sph->sum[SPH_SUMS * (size_t)i] +=
      (t[SPH_TABLE_GRADIENT] + per_distance * t[SPH_TABLE_GRADIENT_DEPTH]) *
      split(sph, i, &sph->walls.face[s->nearest], across);
  sph->sum[SPH_SUMS * (size_t)i + 6] -=
      t[SPH_TABLE_NORMAL] + (double)(sph->params.dimensions - 1) * t[SPH_TABLE_ACROSS];
  if (sph->plan.summation)
    sph->shade[i] += t[SPH_TABLE_SHADE];
}

int sph_walls_density(sph_t *sph) {
  int status = PART_OK;
  if (sph->plan.pushed)
    return PART_OK;
  part_timers_start(sph->timers, sph->stage[SPH_STAGE_WALLS]);
  if (sph->plan.summation)
    memset(sph->shade, 0, (size_t)sph->store->local * sizeof *sph->shade);
  for (int row = 0; status == PART_OK && row < sph->walls.rows; row++) {
    sph_seer s;
    status = sph_walls_see(sph, row, &s);
    if (status != PART_OK || s.count == 0)
      continue;
    if (by_table(sph, &s))
      density_by_table(sph, sph->walls.particle[row], &s);
    else
      density_of_points(sph, sph->walls.particle[row], &s);
  }
  part_timers_stop(sph->timers, sph->stage[SPH_STAGE_WALLS]);
  return status;
}

/* Viscous part along d = -r and along u: S.8 and S.9 with the velocity of eq. 25; S.10 with its
 * part along the normal, approach = (u_n n).d. */
static void viscous(const sph_t *sph, double h, const double d[3], const double u[3], double approach,
                    double *along_d, double *along_u) {
  const sph_params *p = &sph->params;
  const double d2 = dot(d, d), soft = d2 + 0.01 * h * h, w = dot(d, u);
  *along_u = 0.0;
  *along_d = p->density * p->artificial_viscosity * p->sound_speed * h *
             (approach < 0.0 ? approach : 0.0) / soft;
  if (p->viscosity_model == SPH_MORRIS) {
    *along_u = 2.0 * p->viscosity;
  } else if (p->viscosity > 0.0) {
    const double per_r = 1.0 / sqrt(d2);
    *along_d += p->density * sph->monaghan * (p->smoothing_length / h) * (p->sound_speed + fabs(w) * per_r) * w * per_r;
  }
}

/* S.22, S.26: ghost points have the factor of the particle. */
static double factor_of(const sph_t *sph, int i) {
  if (sph->plan.variable)
    return sph->lens[2 * (size_t)i + 1];
  return sph->plan.correction ? sph->factor[i] : 1.0;
}

/* Pressure behind a wall goes on as in a fluid that is at rest, or accelerated with the wall along its
 * normal: Pa/m at the density of the fluid. */
static void slope_behind(const sph_t *sph, const sph_face *face, const double x[3], double slope[3]) {
  double a[3];
  memcpy(slope, sph->hydrostatic, sizeof sph->hydrostatic);
  if (!sph->walls.wall[face->wall].moves)
    return;
  sph_face_acceleration(sph, face, x, a);
  const double normal = dot(a, face->n) * sph->params.density;
  for (int c = 0; c < 3; c++)
    slope[c] -= normal * face->n[c];
}

/* Eq. 25: u_ak = u_n n + mirror u_t, without u_t where the fluid slips. Pressure goes on behind the
 * wall as that of a fluid at rest; that of fixed points is no less than the
 * particle's: with that of their density alone (Wu et al. 2018) water 20 particles deep runs
 * through them. Returns the force over own volume in `force`. */
static void force_of(const sph_t *sph, int i, const sph_point *p, double h, double slope_norm,
                     double force[3]) {
  const double *x = sph_xv(sph) + SPH_XV * (size_t)i, *m = sph_mass(sph) + SPH_MASS * (size_t)i;
  const sph_face *face = &sph->walls.face[p->face];
  const double d[3] = {-p->r[0], -p->r[1], -p->r[2]};
  const double d2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
  const double f = p->volume * slope_norm * sph_slope(sph->params.kernel, sqrt(d2) / h);
  const double relative = m[1] / (m[2] * sph->params.density);
  const int slips = sph->walls.wall[face->wall].params.slip == SPH_FREE_SLIP;
  double u[3], slope[3], along_d, along_u, pressure = 2.0 * x[7];
  const int fixed = sph->plan.fixed;
  const double normal = split(sph, i, face, u);
  slope_behind(sph, face, x, slope);
  for (int c = 0; c < 3; c++) {
    u[c] = normal * face->n[c] + (slips ? 0.0 : p->mirror * u[c]);
    pressure += relative * slope[c] * p->r[c];
  }
  if (fixed)
    pressure = x[7] + fmax(x[7], sph->params.background_pressure);
  viscous(sph, h, d, u, fixed ? dot(d, u) : normal * dot(d, face->n), &along_d, &along_u);
  for (int c = 0; c < 3; c++)
    force[c] = f * ((m[2] * along_d - factor_of(sph, i) * pressure) * d[c] + m[2] * along_u * u[c]);
}

static void take_force(sph_t *sph, int i, int face, const double force[3]) {
  const double *x = sph_xv(sph) + SPH_XV * (size_t)i, volume = x[3];
  double *sum = sph->sum + SPH_SUMS * (size_t)i;
  sph_wall *wall = &sph->walls.wall[sph->walls.face[face].wall];
  double arm[3];
  for (int c = 0; c < 3; c++) {
    sum[c] += force[c];
    sph->wall_force[c] += volume * force[c];
    wall->force[c] -= volume * force[c];
    arm[c] = x[c] - wall->motion.centre[c] - wall->pose.way[c];
  }
  for (int c = 0; c < 3; c++) {
    const int d = (c + 1) % 3, e = (c + 2) % 3;
    wall->torque[c] -= volume * (arm[d] * force[e] - arm[e] * force[d]);
  }
}

/* Walls that push. Behind a surface of triangles there is no side: the error of that is the
 * state's. */
static void force_of_sides(sph_t *sph, int row, sph_seer *s) {
  sph_walls_sides(sph, s);
  for (int k = 0; k < s->sides; k++) {
    double force[3];
    sph_walls_push_force(sph, row, s, force, k);
    take_force(sph, sph->walls.particle[row], s->side[k].face, force);
  }
}

static void force_of_points(sph_t *sph, int i, sph_seer *s) {
  const double h = sph_length(sph, i), slope_norm = sph_norm_at(sph, h) / (h * h);
  const int n = sph_walls_points(sph, s);
  for (int k = 0; k < n; k++) {
    const sph_point *p = &sph->walls.point[k];
    double force[3];
    force_of(sph, i, p, h, slope_norm, force);
    take_force(sph, i, p->face, force);
  }
}

/* The same summed beforehand: what is odd across the plane's directions has gone. */
static void force_by_table(sph_t *sph, int i, const sph_seer *s) {
  const double *x = sph_xv(sph) + SPH_XV * (size_t)i, *m = sph_mass(sph) + SPH_MASS * (size_t)i;
  const sph_params *p = &sph->params;
  const sph_face *face = &sph->walls.face[s->nearest];
  const double factor = factor_of(sph, i), *n = face->n;
  const double relative = factor * m[1] / (m[2] * p->density);
  const double per_distance = sph_walls_mirror(sph, 1.0, s->distance) - 1.0;
  const int slips = sph->walls.wall[face->wall].params.slip == SPH_FREE_SLIP;
  double u[3], t[SPH_TABLE_COUNT], force[3], g[3];
  slope_behind(sph, face, x, g);
  const double normal = split(sph, i, face, u), g_n = dot(g, n);
  sph_walls_look_up(sph, s->distance, t);
  const double mu = 2.0 * m[2] * (p->viscosity_model == SPH_MORRIS ? p->viscosity : 0.0);
  const double shear =
      slips ? 0.0 : mu * (t[SPH_TABLE_VISCOUS] + per_distance * t[SPH_TABLE_VISCOUS_DEPTH]);
  const double along = -2.0 * factor * x[7] * t[SPH_TABLE_GRADIENT] +
                       relative * t[SPH_TABLE_NORMAL] * g_n + mu * t[SPH_TABLE_VISCOUS] * normal +
                       m[2] * p->density * p->artificial_viscosity * p->sound_speed *
                           p->smoothing_length * fmin(normal, 0.0) * t[SPH_TABLE_APPROACH];
  for (int c = 0; c < 3; c++)
    force[c] = along * n[c] + shear * u[c] + relative * t[SPH_TABLE_ACROSS] * (g[c] - g_n * n[c]);
  take_force(sph, i, s->nearest, force);
}

/* Of walls as rigid bodies. */
static void set_powers(sph_walls *walls) {
  for (int w = 0; w < walls->count && walls->moving; w++) {
    sph_wall *wall = &walls->wall[w];
    for (int c = 0; c < 3; c++) {
      const int d = (c + 1) % 3, e = (c + 2) % 3;
      const double spin = 0.5 * (wall->pose.gain[e][d] - wall->pose.gain[d][e]);
      wall->power -= wall->force[c] * wall->pose.drift[c] + wall->torque[c] * spin;
    }
  }
}

int sph_walls_force(sph_t *sph) {
  int status = PART_OK;
  part_timers_start(sph->timers, sph->stage[SPH_STAGE_WALLS]);
  for (int w = 0; w < sph->walls.count; w++) {
    sph_wall *wall = &sph->walls.wall[w];
    memset(wall->force, 0, sizeof wall->force);
    memset(wall->torque, 0, sizeof wall->torque);
    wall->power = 0.0;
  }
  for (int row = 0; status == PART_OK && row < sph->walls.rows; row++) {
    sph_seer s;
    status = sph_walls_see(sph, row, &s);
    if (status != PART_OK || s.count == 0)
      continue;
    if (sph->plan.pushed)
      force_of_sides(sph, row, &s);
    else if (by_table(sph, &s))
      force_by_table(sph, sph->walls.particle[row], &s);
    else
      force_of_points(sph, sph->walls.particle[row], &s);
  }
  set_powers(&sph->walls);
  part_timers_stop(sph->timers, sph->stage[SPH_STAGE_WALLS]);
  return status;
}

void sph_walls_add_impulse(sph_t *sph, double h) {
  for (int w = 0; w < sph->walls.count; w++) {
    sph_wall *wall = &sph->walls.wall[w];
    const double power[3] = {wall->power, 0.0, 0.0};
    part_sum_add(&wall->impulse, wall->force, h);
    part_sum_add(&wall->work, power, h);
  }
}

/* Points have the pressure and eps of the particle: they add to the first and last of the sums of
 * S.19 alone. */
int sph_walls_shift(sph_t *sph) {
  const double h = sph->params.smoothing_length, slope_norm = sph->norm / (h * h);
  int status = PART_OK;
  if (sph->plan.pushed)
    return PART_OK;
  part_timers_start(sph->timers, sph->stage[SPH_STAGE_WALLS]);
  for (int row = 0; status == PART_OK && row < sph->walls.rows; row++) {
    double *sum = sph->shift + SPH_SHIFTS * (size_t)sph->walls.particle[row];
    sph_seer s;
    status = sph_walls_see(sph, row, &s);
    const int n = status == PART_OK && s.count > 0 ? sph_walls_points(sph, &s) : 0;
    for (int k = 0; k < n; k++) {
      const sph_point *p = &sph->walls.point[k];
      const double r2 = dot(p->r, p->r);
      const double f = p->volume * slope_norm * sph_slope(sph->params.kernel, sqrt(r2) / h);
      for (int c = 0; c < 3; c++)
        sum[c] -= f * p->r[c];
      sum[6] -= f * r2;
    }
  }
  part_timers_stop(sph->timers, sph->stage[SPH_STAGE_WALLS]);
  return status;
}
