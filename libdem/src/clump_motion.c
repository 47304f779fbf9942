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
 *
 * The fluid acts on each member with Su_i - Sp_i (v + omega x a_i). Translation and rotation take
 * it one after the other, each in closed form with the other's velocity held: drag of any stiffness
 * is stable. The order is reversed in the second half of a step. */
#include "flow.h"
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

/* ---- fluid ----------------------------------------------------------------------------------- */
/* Sums over members at the present attitude: with a the arms, su = sum Su, sp = sum Sp, lever = sum
 * Sp a, torque = sum a x Su, drag = sum Sp (a.a - a a). */
typedef struct fluid_sums {
  double su[3], sp, lever[3], torque[3], drag[6];
} fluid_sums;

static fluid_sums sum_fluid(const dem_t *dem, const dem_clump *b) {
  const dem_clumps *c = &dem->clumps;
  const double *fluid = dem_fluid(dem);
  fluid_sums sums = {.sp = 0.0};
  double m[3][3], a[3], t[3];
  dem_turn_matrix(b->q, m);
  for (int k = b->first; k < b->first + b->count; k++) {
    const double *f = fluid + DEM_FLUID * (size_t)c->member[k], sp = f[3];
    dem_to_space((const double(*)[3])m, c->arm + 3 * (size_t)k, a);
    dem_cross(a, f, t);
    const double square = dem_dot(a, a);
    for (int d = 0; d < 3; d++) {
      sums.su[d] += f[d];
      sums.lever[d] += sp * a[d];
      sums.torque[d] += t[d];
      sums.drag[d] += sp * (square - a[d] * a[d]);
    }
    sums.drag[3] -= sp * a[0] * a[1];
    sums.drag[4] -= sp * a[0] * a[2];
    sums.drag[5] -= sp * a[1] * a[2];
    sums.sp += sp;
  }
  return sums;
}

/* Shares of the members in the impulse of a kick: (Su_i - Sp_i omega x a_i) h - Sp_i path. They add
 * up to it but for rounding, which is given out by Sp_i (by number without drag). */
static void share_impulse(dem_t *dem, const dem_clump *b, const double omega[3], double sp,
                          double h, const double path[3], const double impulse[3]) {
  const dem_clumps *c = &dem->clumps;
  double *fluid = dem_fluid(dem), m[3][3], a[3], u[3];
  double rest[3] = {impulse[0], impulse[1], impulse[2]};
  dem_turn_matrix(b->q, m);
  for (int k = b->first; k < b->first + b->count; k++) {
    double *f = fluid + DEM_FLUID * (size_t)c->member[k];
    dem_to_space((const double(*)[3])m, c->arm + 3 * (size_t)k, a);
    dem_cross(omega, a, u);
    for (int d = 0; d < 3; d++) {
      const double share = (f[d] - f[3] * u[d]) * h - f[3] * path[d];
      f[4 + d] += share;
      rest[d] -= share;
    }
  }
  for (int k = b->first; k < b->first + b->count; k++) {
    double *f = fluid + DEM_FLUID * (size_t)c->member[k];
    for (int d = 0; d < 3; d++)
      f[4 + d] += (sp > 0.0 ? f[3] / sp : 1.0 / b->count) * rest[d];
  }
}

/* dL/dt = torque - drag omega, in closed form for the present attitude: with y = I^-1/2 L in body
 * axes the matrix of the drag is symmetric, and its eigenvectors fall off each by itself. */
static void kick_spin(dem_clump *b, const double torque[3], const double drag[6], double h) {
  static const int row[6] = {0, 1, 2, 0, 0, 1}, other[6] = {0, 1, 2, 1, 2, 2};
  double m[3][3], l[3], t[3], a[6], rate[3], v[3][3], root[3], column[3][3];
  dem_turn_matrix(b->q, m);
  dem_to_body((const double(*)[3])m, b->spin, l);
  dem_to_body((const double(*)[3])m, torque, t);
  for (int k = 0; k < 3; k++) {
    const double e[3] = {m[0][k], m[1][k], m[2][k]}; /* body axis k */
    root[k] = sqrt(b->inertia[k]);
    column[k][0] = drag[0] * e[0] + drag[3] * e[1] + drag[4] * e[2];
    column[k][1] = drag[3] * e[0] + drag[1] * e[1] + drag[5] * e[2];
    column[k][2] = drag[4] * e[0] + drag[5] * e[1] + drag[2] * e[2];
  }
  for (int k = 0; k < 6; k++) {
    const double e[3] = {m[0][other[k]], m[1][other[k]], m[2][other[k]]};
    a[k] = dem_dot(column[row[k]], e) / (root[row[k]] * root[other[k]]);
  }
  dem_eigen(a, rate, v);
  double gain[3] = {0.0, 0.0, 0.0};
  for (int k = 0; k < 3; k++) {
    double y = 0.0, force = 0.0;
    for (int c = 0; c < 3; c++) {
      y += v[c][k] * l[c] / root[c];
      force += v[c][k] * t[c] / root[c];
    }
    const double b_k = fmax(rate[k], 0.0) * h;
    const dem_flow flow = dem_flow_of(b_k);
    for (int c = 0; c < 3; c++)
      gain[c] += v[c][k] * root[c] * (force * h * flow.phi1 - y * flow.lost);
  }
  dem_to_space((const double(*)[3])m, gain, t);
  for (int c = 0; c < 3; c++)
    b->spin[c] += t[c];
}

/* ---- kicks ----------------------------------------------------------------------------------- */
typedef struct kick_step {
  double h, drift_h;       /* s */
  double gravity[3];       /* m/s2 */
  const fluid_sums *fluid; /* NULL: none */
} kick_step;

static void kick_velocity(dem_t *dem, dem_clump *b, const kick_step *step) {
  const double w = 1.0 / b->mass, h = step->h, big = step->drift_h;
  const fluid_sums *f = step->fluid;
  if (f == NULL) {
    for (int c = 0; c < 3; c++) {
      b->v[c] += h * (b->force[c] * w + step->gravity[c]);
      b->x[c] += big * b->v[c];
    }
    return;
  }
  double omega[3], turning[3], path[3], impulse[3];
  const double drag = f->sp * w * h;
  const dem_flow half = dem_flow_of(drag), whole = dem_flow_of(f->sp * w * big);
  dem_clump_rotation(b, omega);
  dem_cross(omega, f->lever, turning);
  for (int c = 0; c < 3; c++) {
    const double a = b->force[c] * w + step->gravity[c], s = (f->su[c] - turning[c]) * w;
    const double v = b->v[c];
    b->x[c] += v * big * whole.phi1 + (a + s) * big * big * whole.phi2;
    path[c] = v * h * half.phi1 + (a + s) * h * h * half.phi2;
    const double by_fluid = s * h * half.phi1 - v * half.lost - a * h * drag * half.phi2;
    b->v[c] += a * h + by_fluid;
    impulse[c] = by_fluid * b->mass;
  }
  share_impulse(dem, b, omega, f->sp, h, path, impulse);
}

static void kick_rotation(dem_clump *b, const kick_step *step) {
  const fluid_sums *f = step->fluid;
  if (f == NULL) {
    for (int c = 0; c < 3; c++)
      b->spin[c] += step->h * b->torque[c];
    return;
  }
  double torque[3];
  dem_cross(f->lever, b->v, torque);
  for (int c = 0; c < 3; c++)
    torque[c] = b->torque[c] + f->torque[c] - torque[c];
  kick_spin(b, torque, f->drag, step->h);
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
  kick_step step = {.h = h, .drift_h = drift_h};
  fluid_sums sums;
  if (fluid) {
    sums = sum_fluid(dem, b);
    step.fluid = &sums;
  }
  for (int c = 0; c < 3; c++)
    step.gravity[c] = factor * dem->params.gravity[c];
  dem_sum_add(&dem->gravity_impulse, step.gravity, b->mass * h);
  if (drift_h > 0.0) {
    kick_velocity(dem, b, &step);
    kick_rotation(b, &step);
    turn_free(b, drift_h);
  } else {
    kick_rotation(b, &step);
    kick_velocity(dem, b, &step);
  }
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
