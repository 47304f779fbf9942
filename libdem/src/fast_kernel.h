/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The kernels of fast.h, written once and included by one file for each DEM_WIDTH. */
#include <string.h>

#include "fast.h"
#include "fast_lanes.h"
#include "laws.h"

#define INLINE static inline __attribute__((always_inline))
/* Everything called is copied in, laws too: a call would pass some 30 vectors through memory (bed:
 * 25 to 31 million particle-steps a second). */
#define FLATTEN __attribute__((flatten))

/* Components of the position record of a block: x_i - x_j and r_i + r_j. */
INLINE vec separation(const double *xr, const int *i, const int *j, vec d[4]) {
  const quad sign = {-1.0, -1.0, -1.0, 1.0};
  quad r[DEM_WIDTH];
  for (int k = 0; k < DEM_WIDTH; k++)
    r[k] = *(const quad *)(xr + 4 * (long)i[k]) + sign * *(const quad *)(xr + 4 * (long)j[k]);
  to_lanes_4(r, d);
  return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
}

INLINE vec_mask touching(vec d2, vec reach) {
  return vec_both(vec_less(d2, reach * reach), vec_less(vec_all(0.0), d2));
}

/* pair: number of the two materials in the table. */
INLINE dem_lane_coefs coefs_of(const dem_lanes *in, vec pair, vec_mask touches) {
  const dem_coefs *c = in->coefs;
  if (in->materials == 1)
    return (dem_lane_coefs){vec_all(c->k_n),  vec_all(c->k_t),   vec_all(c->c_n),
                            vec_all(c->c_t),  vec_all(c->mu),    vec_all(c->mu_roll),
                            vec_all(c->pull), c->tangential_mass};
  const vec zero = vec_all(0.0);
  dem_lane_coefs lane = {zero, zero, zero, zero, zero, zero, zero, c->tangential_mass};
  const vec number = vec_keep(touches, pair);
  for (int k = 0; k < DEM_WIDTH; k++) {
    const dem_coefs *one = &c[(int)number[k]];
    lane.k_n[k] = one->k_n;
    lane.k_t[k] = one->k_t;
    lane.c_n[k] = one->c_n;
    lane.c_t[k] = one->c_t;
    lane.mu[k] = one->mu;
    lane.mu_roll[k] = one->mu_roll;
    lane.pull[k] = one->pull;
  }
  return lane;
}

/* omega_i - omega_j from u_i + u_j, and the two radii. */
INLINE void relative_spin(const dem_lanes *in, const int *j, const vec sum[3], vec r_i, vec r_j,
                          vec spin[3]) {
  quad u[DEM_WIDTH];
  vec u_j[4];
  for (int k = 0; k < DEM_WIDTH; k++)
    u[k] = *(const quad *)(in->vm + 8 * (long)j[k] + 4);
  to_lanes_4(u, u_j);
  for (int c = 0; c < 3; c++)
    spin[c] = (sum[c] - u_j[c]) / r_i - u_j[c] / r_j;
}

INLINE vec partner_radius(const dem_lanes *in, const int *j) {
  vec r = vec_all(0.0);
  for (int k = 0; k < DEM_WIDTH; k++)
    r[k] = in->xr[4 * (long)j[k] + 3];
  return r;
}

/* Forces f[0..2] and torques over radius f[4..6] to both ends; moment (N m) to i, less it to j. */
INLINE void scatter(const dem_lanes *in, const int *i, const int *j, vec f[8], const vec moment[3],
                    vec r_i, vec r_j, vec_mask touches, int parts) {
  if (parts & DEM_ROLLING) {
    vec g[8];
    for (int c = 0; c < 8; c++)
      g[c] = c < 4 ? -f[c] : f[c];
    for (int c = 0; c < 3; c++) {
      f[4 + c] += vec_keep(touches, moment[c] / r_i);
      g[4 + c] -= vec_keep(touches, moment[c] / r_j);
    }
    add_8_two(in->ft, i, j, f, g);
  } else {
    add_8(in->ft, i, j, sign_8(-1.0, 0.0, 0.0), f);
  }
}

/* One block of pairs. With m = m_i, m_j and arms r_i, r_j times share = |d|/(r_i + r_j):
 *   v = v_i - v_j - share (u_i + u_j) x n,   torque_i/r_i = torque_j/r_j = -share n x F */
INLINE void block(const dem_lanes *in, const int *i, const int *j, double *const *history,
                  dem_law_function *law, int parts, int equal) {
  const int width = DEM_HISTORY_WIDTH(parts);
  vec d[4], v[8], s[DEM_HISTORY], f[8], moment[3];
  dem_touch touch;
  const vec d2 = separation(in->xr, i, j, d);
  if (equal)
    d[3] = vec_all(in->reach);
  touch.touches = touching(d2, d[3]);
  if (!vec_bits(touch.touches)) {
    for (int c = 0; c < width; c++)
      *(vec *)history[c] = vec_all(0.0);
    return;
  }
  load_8(in->vm, i, j, sign_8(-1.0, 1.0, in->materials), v);
  const vec distance = vec_sqrt(d2), root = vec_sqrt(equal ? vec_all(in->inverse) : v[3]);
  const vec r_j = equal ? vec_all(0.5 * in->reach) : partner_radius(in, j), r_i = d[3] - r_j;
  vec inverse, share;
  if (equal) { /* root and its inverse stay out of the loop */
    inverse = vec_all(1.0) / distance;
    share = distance * vec_all(1.0 / in->reach);
    touch.root_mass = vec_all(1.0) / root;
    touch.radius = vec_all(0.25 * in->reach);
  } else { /* three inverses from one division */
    const vec product = distance * root, rest = vec_all(1.0) / (product * d[3]);
    inverse = rest * root * d[3];
    share = distance * (rest * product);
    touch.root_mass = rest * distance * d[3];
    touch.radius = r_i * r_j * (rest * product);
  }
  touch.inverse_root = root;
  touch.overlap = d[3] - distance;
  for (int c = 0; c < 3; c++) {
    touch.n[c] = d[c] * inverse;
    touch.v[c] = v[c];
  }
  const vec *n = touch.n;
  for (int c = 0; c < width; c++)
    s[c] = *(const vec *)history[c];
  if (parts & DEM_ROLLING)
    relative_spin(in, j, v + 4, r_i, r_j, touch.spin);
  if (parts & DEM_SLIDING) {
    for (int c = 0; c < 3; c++)
      v[4 + c] *= share;
    touch.v[0] -= v[5] * n[2] - v[6] * n[1];
    touch.v[1] -= v[6] * n[0] - v[4] * n[2];
    touch.v[2] -= v[4] * n[1] - v[5] * n[0];
  }
  const dem_lane_coefs coefs = coefs_of(in, v[7], touch.touches);
  dem_contact_force(law, &coefs, &touch, parts, in->dt, s, f, moment);
  for (int c = 0; c < 3; c++)
    f[c] = vec_keep(touch.touches, f[c]);
  f[3] = f[4] = f[5] = f[6] = f[7] = vec_all(0.0);
  for (int c = 0; c < width; c++)
    *(vec *)history[c] = vec_keep(touch.touches, s[c]);
  if (parts & DEM_SLIDING) {
    f[4] = vec_keep(touch.touches, share * (n[2] * f[1] - n[1] * f[2]));
    f[5] = vec_keep(touch.touches, share * (n[0] * f[2] - n[2] * f[0]));
    f[6] = vec_keep(touch.touches, share * (n[1] * f[0] - n[0] * f[1]));
  }
  scatter(in, i, j, f, moment, r_i, r_j, touch.touches, parts);
}

/* Records of the partners of a later block. */
INLINE void fetch(const dem_lanes *in, const int *j) {
  for (int k = 0; k < DEM_WIDTH; k++) {
    __builtin_prefetch(in->xr + 4 * (long)j[k], 0);
    __builtin_prefetch(in->vm + 8 * (long)j[k], 0);
    __builtin_prefetch(in->ft + 8 * (long)j[k], 1);
  }
}

INLINE void dense_loop(const dem_lanes *in, int from, int to, dem_law_function *law, int parts,
                       int equal) {
  for (int k = from; k < to; k += DEM_WIDTH) {
    if (k < in->fetch_to)
      fetch(in, in->j + k + DEM_FETCH_AHEAD);
    double *history[DEM_HISTORY];
    for (int c = 0; c < DEM_HISTORY_WIDTH(parts); c++)
      history[c] = in->history[c] + k;
    block(in, in->i + k, in->j + k, history, law, parts, equal);
  }
}

INLINE void run_dense(const dem_lanes *in, int from, int to, dem_law_function *law, int parts) {
  if ((parts & DEM_SLIDING) && in->equal)
    dense_loop(in, from, to, law, parts, 1);
  else
    dense_loop(in, from, to, law, parts, 0);
}

/* Bits of the 8 pairs from k that touch. */
INLINE unsigned touching_8(const dem_lanes *in, int k) {
  unsigned bits = 0;
  for (int m = 0; m < DEM_BLOCK_PAIRS; m += DEM_WIDTH) {
    vec d[4];
    const vec d2 = separation(in->xr, in->i + k + m, in->j + k + m, d);
    bits |= vec_bits(touching(d2, d[3])) << m;
  }
  return bits;
}

enum { PACKED = DEM_CHUNK_PAIRS + DEM_BLOCK_PAIRS };

typedef struct packed {
  int count, from[PACKED], i[PACKED], j[PACKED];
  _Alignas(64) double history[DEM_HISTORY][PACKED];
} packed;

INLINE void pack(const dem_lanes *in, int from, int to, packed *p, int width) {
  p->count = 0;
  for (int k = from; k < to; k += DEM_BLOCK_PAIRS) {
    const unsigned now = touching_8(in, k);
    unsigned ended = in->was[k / DEM_BLOCK_PAIRS] & ~now;
    in->was[k / DEM_BLOCK_PAIRS] = (unsigned char)now;
    for (; ended; ended &= ended - 1)
      for (int c = 0; c < width; c++)
        in->history[c][k + __builtin_ctz(ended)] = 0.0;
    for (unsigned left = now; left; left &= left - 1)
      p->from[p->count++] = k + __builtin_ctz(left);
  }
}

INLINE void run_sparse(const dem_lanes *in, int from, int to, dem_pairs_kernel run, int parts) {
  const int width = DEM_HISTORY_WIDTH(parts);
  packed p;
  pack(in, from, to, &p, width);
  for (int k = 0; k < p.count; k++) {
    p.i[k] = in->i[p.from[k]];
    p.j[k] = in->j[p.from[k]];
    for (int c = 0; c < width; c++)
      p.history[c][k] = in->history[c][p.from[k]];
  }
  for (int k = p.count; k % DEM_WIDTH != 0; k++) {
    p.i[k] = p.j[k] = 0;
    for (int c = 0; c < width; c++)
      p.history[c][k] = 0.0;
  }
  dem_lanes packed_lanes = *in;
  packed_lanes.i = p.i;
  packed_lanes.j = p.j;
  packed_lanes.fetch_to = 0;
  for (int c = 0; c < width; c++)
    packed_lanes.history[c] = p.history[c];
  run(&packed_lanes, 0, p.count);
  for (int k = 0; k < p.count; k++)
    for (int c = 0; c < width; c++)
      in->history[c][p.from[k]] = p.history[c][k];
}

/* I = m r^2/spin, so that r domega/dt = spin (torque/r)/m. */
INLINE void run_move(dem_motion *m, int from, int to, int tangential) {
  const double h = m->dt;
  const quad zero = {0.0, 0.0, 0.0, 0.0}, drift = {h, h, h, 0.0};
  quad most = zero, kick = *(const quad *)m->kick;
  for (int i = from; i < to; i++) {
    quad *x = (quad *)(m->xr + 4 * (long)i), *v = (quad *)(m->vm + 8 * (long)i);
    quad *f = (quad *)(m->ft + 8 * (long)i);
    const double w = m->vm[8 * (long)i + 3] * h;
    if (m->materials > 1)
      kick = *(const quad *)(m->kick + 4 * (int)m->vm[8 * (long)i + 7]);
    const quad now = v[0] + (f[0] * w + kick);
    v[0] = now;
    x[0] += drift * now;
    most = (quad)_mm256_max_pd((__m256d)most, (__m256d)(now * now));
    f[0] = zero;
    if (tangential) {
      v[1] += f[1] * (m->spin * w);
      f[1] = zero;
    }
  }
  for (int c = 0; c < 3; c++)
    m->most[c] = most[c] > m->most[c] ? most[c] : m->most[c];
}

static void move(dem_motion *m, int from, int to) {
  if (m->tangential)
    run_move(m, from, to, 1);
  else
    run_move(m, from, to, 0);
}

#define DEM_VARIANT(name, parts)                                                                   \
  static FLATTEN void dense_##name##_##parts(const dem_lanes *in, int from, int to) {              \
    run_dense(in, from, to, dem_law_##name, parts);                                                \
  }                                                                                                \
  static void sparse_##name##_##parts(const dem_lanes *in, int from, int to) {                     \
    run_sparse(in, from, to, dense_##name##_##parts, parts);                                       \
  }
#define DEM_LAW(name, key, meaning) DEM_VARIANTS(DEM_VARIANT, name)
#include "dem/contact_laws.def"
#undef DEM_VARIANT

#undef DEM_LAW
#define DEM_LAW(name, key, meaning) {DEM_VARIANTS(DEM_VARIANT, name)},
#define DEM_VARIANT(name, parts) [parts] = dense_##name##_##parts,
static const dem_pairs_kernel dense[DEM_LAW_COUNT][DEM_PARTS] = {
#include "dem/contact_laws.def"
};
#undef DEM_VARIANT
#define DEM_VARIANT(name, parts) [parts] = sparse_##name##_##parts,
static const dem_pairs_kernel sparse[DEM_LAW_COUNT][DEM_PARTS] = {
#include "dem/contact_laws.def"
};
#undef DEM_VARIANT
#undef DEM_LAW

static const dem_kernels kernels = {DEM_WIDTH, dense, sparse, move};
