/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a fluid sees of a clump, and the kick of a clump in a fluid that acts on each member with
 * Su_i - Sp_i (v + omega x a_i).
 *
 * With the attitude held, v and L follow one linear system. In y = (sqrt(m) v, L_k/sqrt(I_k)), L in
 * body axes, its matrix A is symmetric and takes energy only:
 *   dy/dt = f - A y,   y(h) - y = h phi1(A h) (f - A y),   mean of y = y + h phi2(A h) (f - A y)
 * (phi1, phi2 of flow.h), through the eigenvectors of A or, where A h is small, by series. Exact
 * for any stiffness. */
#include "flow.h"
#include "internal.h"
#include "rotation.h"

enum { SIX = 6, TERMS = 9 };
static const double small_drag = 0.1; /* of A times the time: the series is good to 1e-16 */

/* Sums over members: su = sum Su, sp = sum Sp, lever = sum Sp a, torque = sum a x Su, drag = sum Sp
 * (a.a - a a). */
typedef struct fluid_sums {
  double su[3], sp, lever[3], torque[3], drag[6];
} fluid_sums;

static fluid_sums sum_fluid(const dem_t *dem, const dem_clump *b, const double m[3][3]) {
  const dem_clumps *c = &dem->clumps;
  const double *fluid = dem_fluid(dem);
  fluid_sums sums = {.sp = 0.0};
  double a[3], t[3];
  for (int k = b->first; k < b->first + b->count; k++) {
    const double *f = fluid + DEM_FLUID * (size_t)c->member[k], sp = f[3];
    dem_to_space(m, c->arm + 3 * (size_t)k, a);
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

/* The system of one clump. */
typedef struct linear {
  double a[SIX * SIX], y[SIX], g[SIX]; /* g = f - A y */
  double root[SIX];                    /* sqrt(m) three times, sqrt(I_k) */
} linear;

static void set_matrix(const dem_clump *b, const fluid_sums *s, const double m[3][3], linear *l) {
  for (int k = 0; k < 3; k++) {
    const double e[3] = {m[0][k], m[1][k], m[2][k]}; /* body axis */
    const double de[3] = {s->drag[0] * e[0] + s->drag[3] * e[1] + s->drag[4] * e[2],
                          s->drag[3] * e[0] + s->drag[1] * e[1] + s->drag[5] * e[2],
                          s->drag[4] * e[0] + s->drag[5] * e[1] + s->drag[2] * e[2]};
    double turning[3];
    dem_cross(s->lever, e, turning);
    for (int c = 0; c < 3; c++) {
      const double other[3] = {m[0][c], m[1][c], m[2][c]};
      l->a[SIX * c + k] = c == k ? s->sp / b->mass : 0.0;
      l->a[SIX * c + 3 + k] = l->a[SIX * (3 + k) + c] = -turning[c] / (l->root[c] * l->root[3 + k]);
      l->a[SIX * (3 + c) + 3 + k] = dem_dot(de, other) / (l->root[3 + c] * l->root[3 + k]);
    }
  }
}

/* gravity: m/s2 */
static void set_up(const dem_clump *b, const fluid_sums *s, const double m[3][3],
                   const double gravity[3], linear *l) {
  double torque[3], t[3], spin[3];
  for (int c = 0; c < 3; c++) {
    l->root[c] = sqrt(b->mass);
    l->root[3 + c] = sqrt(b->inertia[c]);
    torque[c] = b->torque[c] + s->torque[c];
  }
  dem_to_body(m, torque, t);
  dem_to_body(m, b->spin, spin);
  set_matrix(b, s, m, l);
  for (int c = 0; c < 3; c++) {
    l->y[c] = b->v[c] * l->root[c];
    l->y[3 + c] = spin[c] / l->root[3 + c];
    l->g[c] = (b->force[c] + b->mass * gravity[c] + s->su[c]) / l->root[c];
    l->g[3 + c] = t[c] / l->root[3 + c];
  }
  for (int r = 0; r < SIX; r++)
    for (int c = 0; c < SIX; c++)
      l->g[r] -= l->a[SIX * r + c] * l->y[c];
}

/* gain = phi1(A h) g, slow = phi2(A h) g, far = phi2(A big) g */
static void by_series(const linear *l, double h, double big, double gain[SIX], double slow[SIX],
                      double far[SIX]) {
  double term[SIX], next[SIX], factor = 1.0, power = 1.0;
  memcpy(term, l->g, sizeof term);
  memset(gain, 0, SIX * sizeof *gain);
  memset(slow, 0, SIX * sizeof *slow);
  memset(far, 0, SIX * sizeof *far);
  for (int n = 0; n < TERMS; n++) {
    factor /= n + 1; /* 1/(n + 1)! */
    for (int r = 0; r < SIX; r++) {
      gain[r] += factor * term[r];
      slow[r] += factor / (n + 2) * term[r];
      far[r] += factor / (n + 2) * power * term[r];
      next[r] = 0.0;
      for (int c = 0; c < SIX; c++)
        next[r] -= h * l->a[SIX * r + c] * term[c];
    }
    memcpy(term, next, sizeof term);
    power *= big / h;
  }
}

static void by_eigenvectors(linear *l, double h, double big, double gain[SIX], double slow[SIX],
                            double far[SIX]) {
  double v[SIX * SIX];
  dem_diagonalise(SIX, l->a, v);
  memset(gain, 0, SIX * sizeof *gain);
  memset(slow, 0, SIX * sizeof *slow);
  memset(far, 0, SIX * sizeof *far);
  for (int k = 0; k < SIX; k++) {
    const double rate = fmax(l->a[(SIX + 1) * k], 0.0); /* below 0 by rounding only */
    const dem_flow near = dem_flow_of(rate * h), whole = dem_flow_of(rate * big);
    double part = 0.0;
    for (int r = 0; r < SIX; r++)
      part += v[SIX * r + k] * l->g[r];
    for (int r = 0; r < SIX; r++) {
      gain[r] += v[SIX * r + k] * part * near.phi1;
      slow[r] += v[SIX * r + k] * part * near.phi2;
      far[r] += v[SIX * r + k] * part * whole.phi2;
    }
  }
}

/* Shares of the members in the impulse of the kick: Su_i h - Sp_i (path + mean omega x a_i h). They
 * add up to it but for rounding, which is given out by Sp_i (by number without drag). */
static void share_impulse(dem_t *dem, const dem_clump *b, const double m[3][3], double sp, double h,
                          const double path[3], const double omega[3], const double impulse[3]) {
  const dem_clumps *c = &dem->clumps;
  double *fluid = dem_fluid(dem), a[3], u[3], rest[3] = {impulse[0], impulse[1], impulse[2]};
  for (int k = b->first; k < b->first + b->count; k++) {
    double *f = fluid + DEM_FLUID * (size_t)c->member[k];
    dem_to_space(m, c->arm + 3 * (size_t)k, a);
    dem_cross(omega, a, u);
    for (int d = 0; d < 3; d++) {
      const double share = f[d] * h - f[3] * (path[d] + u[d] * h);
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

void dem_clump_kick_wet(dem_t *dem, dem_clump *b, const double gravity[3], double h,
                        double drift_h) {
  double turn[3][3], gain[SIX], slow[SIX], far[SIX], size = 0.0;
  double path[3], omega[3], body_omega[3], impulse[3], body_spin[3], spin[3];
  linear l;
  dem_turn_matrix(b->q, turn);
  const double(*m)[3] = (const double(*)[3])turn;
  const fluid_sums sums = sum_fluid(dem, b, m);
  const double big = fmax(h, drift_h);
  set_up(b, &sums, m, gravity, &l);
  for (int k = 0; k < SIX; k++)
    size += l.a[(SIX + 1) * k]; /* the trace bounds the largest eigenvalue */
  if (size * big < small_drag)
    by_series(&l, h, big, gain, slow, far);
  else
    by_eigenvectors(&l, h, big, gain, slow, far);
  for (int c = 0; c < 3; c++) {
    const double gained = h * gain[c] / l.root[c];
    path[c] = h * (b->v[c] + h * slow[c] / l.root[c]);
    if (drift_h > 0.0)
      b->x[c] += drift_h * (b->v[c] + drift_h * far[c] / l.root[c]);
    impulse[c] = b->mass * gained - h * (b->force[c] + b->mass * gravity[c]);
    b->v[c] += gained;
    body_spin[c] = h * gain[3 + c] * l.root[3 + c];
    body_omega[c] = (l.y[3 + c] + h * slow[3 + c]) / l.root[3 + c];
  }
  dem_to_space(m, body_omega, omega);
  dem_to_space(m, body_spin, spin);
  for (int c = 0; c < 3; c++)
    b->spin[c] += spin[c];
  share_impulse(dem, b, m, sums.sp, h, path, omega, impulse);
}

int dem_fluid_spheres(const dem_t *dem, double *volume_radius, double *drag_radius) {
  const double per_volume = 3.0 / (4.0 * 3.14159265358979323846);
  const double *inverse = part_field_double(dem->store, DEM_FIELD_SPHERE_INVERSE_MASS);
  const size_t stride = (size_t)part_field_stride(dem->store, DEM_FIELD_SPHERE_INVERSE_MASS);
  const dem_clumps *c = &dem->clumps;
  if (!dem->started)
    return part_fail(PART_ERR_STATE, "dem_fluid_spheres comes after dem_start");
  for (int i = 0; i < dem->store->local; i++)
    volume_radius[i] = drag_radius[i] = dem_xr(dem)[DEM_XR * (size_t)i + 3];
  for (int k = 0; k < c->count; k++) {
    const dem_clump *b = &c->clump[k];
    const double density = dem->material[b->material].density;
    const double whole = cbrt(per_volume * b->mass / density);
    for (int m = b->first; m < b->first + b->count; m++) {
      const size_t i = (size_t)c->member[m];
      volume_radius[i] = cbrt(per_volume / (inverse[stride * i] * density));
      drag_radius[i] = whole;
    }
  }
  return PART_OK;
}
