/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Motion of clumps. Translation as free particles (integrate.c); rotation by kicks of the angular
 * momentum L in space axes, which nothing but torque changes, and a turn of the body under constant
 * L. With the principal moments I1, I2, I3 the rotational energy is split (Fasso 2003)
 *
 *   (L1^2 + L2^2)/(2 I2) + L3^2/(2 I3)   of a symmetric top: its turn is exact in closed form
 *   (1/I1 - 1/I2) L1^2/2                 a turn about axis 1
 *
 * half of the second, the first, half of the second: symplectic, reversible, second order, exact
 * for symmetric tops. Axis 3 is the one whose moment differs most from the others, so what is split
 * off is small.
 * The kick with a fluid is in clump_fluid.c. */
#include "internal.h"
#include "rotation.h"

static const double largest_turn = 0.1; /* rad, in one turn of a body that is no symmetric top */
static const double most_turns = 1e6;

void dem_clump_rotation(const dem_clump *b, double omega[3]) {
  double m[3][3], l[3];
  dem_turn_matrix(b->q, m);
  dem_to_body((const double(*)[3])m, b->spin, l);
  for (int c = 0; c < 3; c++)
    l[c] /= b->inertia[c];
  dem_to_space((const double(*)[3])m, l, omega);
}

double dem_clump_energy(const dem_clump *b) {
  double omega[3];
  dem_clump_rotation(b, omega);
  return 0.5 * (b->mass * dem_dot(b->v, b->v) + dem_dot(b->spin, omega));
}

/* ---- free turn ------------------------------------------------------------------------------- */
/* Angular momentum about one body axis. */
static double spin_about(const dem_clump *b, int axis) {
  double m[3][3];
  dem_turn_matrix(b->q, m);
  return m[0][axis] * b->spin[0] + m[1][axis] * b->spin[1] + m[2][axis] * b->spin[2];
}

static void turn_body(dem_clump *b, int axis, double angle) {
  double turn[4] = {cos(0.5 * angle), 0.0, 0.0, 0.0};
  turn[1 + axis] = sin(0.5 * angle);
  dem_turn_product(b->q, turn, b->q);
}

static void turn_symmetric(dem_clump *b, double h) {
  const double size = sqrt(dem_dot(b->spin, b->spin));
  turn_body(b, 2, (1.0 / b->inertia[2] - 1.0 / b->inertia[1]) * spin_about(b, 2) * h);
  const double half = 0.5 * size / b->inertia[1] * h, s = size > 0.0 ? sin(half) / size : 0.0;
  const double turn[4] = {cos(half), s * b->spin[0], s * b->spin[1], s * b->spin[2]};
  dem_turn_product(turn, b->q, b->q);
}

static void turn_free(dem_clump *b, double h) {
  const double rest = 1.0 / b->inertia[0] - 1.0 / b->inertia[1];
  const double fastest = sqrt(dem_dot(b->spin, b->spin)) *
                         fmax(1.0 / b->inertia[0], fmax(1.0 / b->inertia[1], 1.0 / b->inertia[2]));
  /* A step of dem_advance may be long where there is no contact. */
  const double parts =
      rest * b->inertia[1] != 0.0 ? fmin(ceil(fastest * h / largest_turn), most_turns) : 1.0;
  const double part = parts > 1.0 ? h / parts : h;
  for (double p = 0.0; p < parts || p == 0.0; p++) {
    turn_body(b, 0, rest * spin_about(b, 0) * 0.5 * part);
    turn_symmetric(b, part);
    turn_body(b, 0, rest * spin_about(b, 0) * 0.5 * part);
    dem_turn_normalise(b->q);
  }
}

/* ---- kicks ----------------------------------------------------------------------------------- */
/* Without fluid: a kick of h, then the drift of drift_h. */
static void kick_dry(dem_clump *b, const double gravity[3], double h, double drift_h) {
  const double w = 1.0 / b->mass;
  for (int c = 0; c < 3; c++) {
    b->v[c] += h * (b->force[c] * w + gravity[c]);
    b->x[c] += drift_h * b->v[c];
    b->spin[c] += h * b->torque[c];
  }
}

/* Members to their places (with x) and velocities. */
static void place_members(dem_t *dem, const dem_clump *b, int with_x) {
  const dem_clumps *c = &dem->clumps;
  double m[3][3], a[3], u[3], omega[3];
  dem_turn_matrix(b->q, m);
  dem_clump_rotation(b, omega);
  for (int k = b->first; k < b->first + b->count; k++) {
    double *x = dem_xr(dem) + DEM_XR * (size_t)c->member[k];
    double *v = dem_vm(dem) + DEM_VM * (size_t)c->member[k];
    dem_to_space((const double(*)[3])m, c->arm + 3 * (size_t)k, a);
    dem_cross(omega, a, u);
    for (int d = 0; d < 3; d++) {
      if (with_x)
        x[d] = b->x[d] + a[d];
      v[d] = b->v[d] + u[d];
      v[4 + d] = omega[d];
    }
  }
}

/* A kick of h from t, with the drift of drift_h after it. */
static void move(dem_t *dem, dem_clump *b, double t, double h, double drift_h, int fluid) {
  const double factor = dem_gravity_factor(dem, b->material, t, h);
  double gravity[3];
  for (int c = 0; c < 3; c++)
    gravity[c] = factor * dem->params.gravity[c];
  part_sum_add(&dem->gravity_impulse, gravity, b->mass * h);
  if (fluid)
    dem_clump_kick_wet(dem, b, gravity, h, drift_h);
  else
    kick_dry(b, gravity, h, drift_h);
  if (drift_h > 0.0)
    turn_free(b, drift_h);
}

void dem_clumps_kick_drift(dem_t *dem, double t, double h, int fluid) {
  const int parts = dem->clumps.parts;
  const double part = h / parts;
  part_timers_start(dem->timers, dem->stage[DEM_STAGE_CLUMPS]);
  for (int b = 0; b < dem->clumps.count; b++) {
    dem_clump *clump = &dem->clumps.clump[b];
    for (int p = 0; p < parts; p++) {
      if (p > 0)
        move(dem, clump, t + (p - 0.5) * part, 0.5 * part, 0.0, fluid);
      move(dem, clump, t + p * part, 0.5 * part, part, fluid);
    }
    place_members(dem, clump, 1);
  }
  part_timers_stop(dem->timers, dem->stage[DEM_STAGE_CLUMPS]);
}

void dem_clumps_kick(dem_t *dem, double t, double h, int fluid) {
  const double half = 0.5 * h / dem->clumps.parts;
  part_timers_start(dem->timers, dem->stage[DEM_STAGE_CLUMPS]);
  for (int b = 0; b < dem->clumps.count; b++) {
    /* t is the middle of the step */
    move(dem, &dem->clumps.clump[b], t + 0.5 * h - half, half, 0.0, fluid);
    place_members(dem, &dem->clumps.clump[b], 0);
  }
  part_timers_stop(dem->timers, dem->stage[DEM_STAGE_CLUMPS]);
}

void dem_clumps_forces(dem_t *dem) {
  const dem_clumps *c = &dem->clumps;
  const double *ft = dem_ft(dem);
  for (int n = 0; n < c->count; n++) {
    dem_clump *b = &c->clump[n];
    double m[3][3], a[3], t[3];
    dem_turn_matrix(b->q, m);
    for (int d = 0; d < 3; d++)
      b->force[d] = b->torque[d] = 0.0;
    for (int k = b->first; k < b->first + b->count; k++) {
      const double *f = ft + DEM_FT * (size_t)c->member[k];
      dem_to_space((const double(*)[3])m, c->arm + 3 * (size_t)k, a);
      dem_cross(a, f, t);
      for (int d = 0; d < 3; d++) {
        b->force[d] += f[d];
        b->torque[d] += t[d] + f[4 + d];
      }
    }
  }
}

void dem_clumps_add(dem_t *dem, const double *impulse) {
  const dem_clumps *c = &dem->clumps;
  for (int n = 0; n < c->count; n++) {
    dem_clump *b = &c->clump[n];
    double m[3][3], a[3], t[3];
    dem_turn_matrix(b->q, m);
    for (int k = b->first; k < b->first + b->count; k++) {
      const double *j = impulse + 3 * (size_t)c->member[k];
      dem_to_space((const double(*)[3])m, c->arm + 3 * (size_t)k, a);
      dem_cross(a, j, t);
      for (int d = 0; d < 3; d++) {
        b->v[d] += j[d] / b->mass;
        b->spin[d] += t[d];
      }
    }
    place_members(dem, b, 0);
  }
}

double dem_clumps_way(const dem_t *dem, double dt) {
  const dem_clumps *c = &dem->clumps;
  const double *g = dem->params.gravity;
  double most = 0.0;
  for (int n = 0; n < c->count; n++) {
    const dem_clump *b = &c->clump[n];
    double su[3] = {0.0, 0.0, 0.0}, torque = 0.0, reach = 0.0, sp = 0.0;
    for (int k = b->first; k < b->first + b->count; k++) {
      const double *f = dem_fluid(dem) + DEM_FLUID * (size_t)c->member[k];
      const double arm = sqrt(dem_dot(c->arm + 3 * (size_t)k, c->arm + 3 * (size_t)k));
      for (int d = 0; d < 3; d++)
        su[d] += f[d];
      sp += f[3];
      torque += arm * sqrt(dem_dot(f, f));
      reach = fmax(reach, arm);
    }
    const double a[3] = {su[0] / b->mass + g[0], su[1] / b->mass + g[1], su[2] / b->mass + g[2]};
    const double least = fmin(b->inertia[0], fmin(b->inertia[1], b->inertia[2]));
    const double gain = sqrt(dem_dot(a, a));
    double speed = sqrt(dem_dot(b->v, b->v)) + gain * dt;
    double rotation = (sqrt(dem_dot(b->spin, b->spin)) + torque * dt) / least;
    if (sp > 0.0) { /* drag only takes energy; force and torque make sqrt(2 E) grow */
      const double root = sqrt(2.0 * dem_clump_energy(b)) +
                          dt * sqrt(b->mass * gain * gain + torque * torque / least);
      speed = root / sqrt(b->mass);
      rotation = root / sqrt(least);
    }
    most = fmax(most, (speed + rotation * reach) * dt);
  }
  return most;
}
