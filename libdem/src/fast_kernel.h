/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The kernels of fast.h, written once and included by one file for each PART_WIDTH. */
#include <string.h>

#include "fast.h"
#include "fast_lanes.h"
#include "laws.h"

#define INLINE static inline __attribute__((always_inline))

/* What is the same for all blocks of a call, out of memory that a store could change. */
typedef struct constants {
  const double *xr, *vm;
  double *ft, dt;
  vec reach, per_reach, root, root_mass; /* equal only */
  const dem_coefs *table;
  dem_lane_coefs coefs; /* one material only */
  double materials;
} constants;

INLINE constants constants_of(const dem_lanes *in, int equal) {
  const dem_coefs *c = in->coefs;
  constants k = {.xr = in->xr, .vm = in->vm, .ft = in->ft, .dt = in->dt, .table = c};
  k.materials = equal ? 1.0 : in->materials;
  k.coefs =
      (dem_lane_coefs){vec_all(c->k_n), vec_all(c->k_t),     vec_all(c->c_n),  vec_all(c->c_t),
                       vec_all(c->mu),  vec_all(c->mu_roll), vec_all(c->pull), c->tangential_mass};
  if (equal) {
    k.reach = vec_all(in->reach);
    k.per_reach = vec_all(1.0 / in->reach);
    k.root = vec_sqrt(vec_all(in->inverse));
    k.root_mass = vec_all(1.0) / k.root;
  }
  return k;
}

/* Components of the position record of a block: x_i - x_j and r_i + r_j. */
INLINE vec separation(const double *xr, const unsigned *i, const unsigned *j, vec d[4]) {
  const quad sign = {-1.0, -1.0, -1.0, 1.0};
  quad r[PART_WIDTH];
  for (int k = 0; k < PART_WIDTH; k++)
    r[k] = *quad_at(xr, i[k]) + sign * *quad_at(xr, j[k]);
  to_lanes_4(r, d);
  return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
}

INLINE vec_mask touching(vec d2, vec reach) {
  return vec_both(vec_less(d2, reach * reach), vec_less(vec_all(0.0), d2));
}

/* pair: number of the two materials in the table. */
INLINE dem_lane_coefs coefs_of(const constants *in, vec pair, vec_mask touches) {
  if (in->materials == 1.0)
    return in->coefs;
  const vec number = vec_keep(touches, pair);
  _Alignas(64) double part[7][PART_WIDTH];
  for (int k = 0; k < PART_WIDTH; k++) {
    const dem_coefs *one = &in->table[(int)number[k]];
    part[0][k] = one->k_n;
    part[1][k] = one->k_t;
    part[2][k] = one->c_n;
    part[3][k] = one->c_t;
    part[4][k] = one->mu;
    part[5][k] = one->mu_roll;
    part[6][k] = one->pull;
  }
  const vec *v = (const vec *)part;
  return (dem_lane_coefs){v[0], v[1], v[2], v[3], v[4], v[5], v[6], in->table->tangential_mass};
}

/* omega_i - omega_j from u_i + u_j, and the two radii. */
INLINE void relative_spin(const constants *in, const unsigned *j, const vec sum[3], vec r_i,
                          vec r_j, vec spin[3]) {
  quad u[PART_WIDTH];
  vec u_j[4];
  for (int k = 0; k < PART_WIDTH; k++)
    u[k] = ((const quad *)record_at(in->vm, j[k]))[1];
  to_lanes_4(u, u_j);
  for (int c = 0; c < 3; c++)
    spin[c] = (sum[c] - u_j[c]) / r_i - u_j[c] / r_j;
}

INLINE vec partner_radius(const constants *in, const unsigned *j) {
  vec r = vec_all(0.0);
  for (int k = 0; k < PART_WIDTH; k++)
    r[k] = (*quad_at(in->xr, j[k]))[3];
  return r;
}

/* What a block of pairs looks like. */
typedef struct geometry {
  vec n[3], distance, reach;
  vec_mask touches;
} geometry;

INLINE void measure(const constants *in, const unsigned *i, const unsigned *j, int equal,
                    geometry *g) {
  vec d[4];
  const vec d2 = separation(in->xr, i, j, d);
  g->reach = equal ? in->reach : d[3];
  g->touches = touching(d2, g->reach);
  g->distance = vec_sqrt(d2);
  const vec inverse = vec_all(1.0) / g->distance;
  for (int c = 0; c < 3; c++)
    g->n[c] = d[c] * inverse;
}

/* Forces f[0..2] on i and torques over radius f[4..6] on both; moment (N m) to i, less it to j. */
typedef struct push {
  vec f[8], moment[3], r_i, r_j;
} push;

/* Effective mass and radius, and |d|/(r_i + r_j). */
INLINE vec pair_of(const constants *in, const unsigned *j, const geometry *g, vec inverse_mass,
                   int equal, push *p, dem_touch *touch) {
  if (equal) {
    p->r_i = p->r_j = vec_all(0.5) * in->reach;
    touch->inverse_root = in->root;
    touch->root_mass = in->root_mass;
    touch->radius = vec_all(0.25) * in->reach;
    return g->distance * in->per_reach;
  }
  touch->inverse_root = vec_sqrt(inverse_mass); /* two inverses from one division */
  const vec rest = vec_all(1.0) / (touch->inverse_root * g->reach);
  const vec per_reach = rest * touch->inverse_root;
  p->r_j = partner_radius(in, j);
  p->r_i = g->reach - p->r_j;
  touch->root_mass = rest * g->reach;
  touch->radius = p->r_i * p->r_j * per_reach;
  return g->distance * per_reach;
}

/* With m = m_i, m_j and arms r_i, r_j times share = |d|/(r_i + r_j):
 *   v = v_i - v_j - share (u_i + u_j) x n,   torque_i/r_i = torque_j/r_j = -share n x F */
INLINE void push_of(const constants *in, const unsigned *i, const unsigned *j, const geometry *g,
                    double *const *history, dem_law_function *law, int parts, int equal, push *p) {
  const int width = DEM_HISTORY_WIDTH(parts);
  vec v[8], s[DEM_HISTORY], *f = p->f;
  dem_touch touch;
  load_8(in->vm, i, j, sign_8(-1.0, 1.0, in->materials), v);
  touch.touches = g->touches;
  touch.overlap = g->reach - g->distance;
  const vec share = pair_of(in, j, g, v[3], equal, p, &touch), *n = g->n;
  for (int c = 0; c < 3; c++) {
    touch.n[c] = n[c];
    touch.v[c] = v[c];
  }
  for (int c = 0; c < width; c++)
    s[c] = *(const vec *)history[c];
  if (parts & DEM_ROLLING)
    relative_spin(in, j, v + 4, p->r_i, p->r_j, touch.spin);
  if (parts & DEM_SLIDING) {
    for (int c = 0; c < 3; c++)
      v[4 + c] *= share;
    touch.v[0] -= v[5] * n[2] - v[6] * n[1];
    touch.v[1] -= v[6] * n[0] - v[4] * n[2];
    touch.v[2] -= v[4] * n[1] - v[5] * n[0];
  }
  const dem_lane_coefs coefs = coefs_of(in, v[7], touch.touches);
  dem_contact_force(law, &coefs, &touch, parts, in->dt, s, f, p->moment);
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
}

INLINE void scatter(const constants *in, const unsigned *i, const unsigned *j, push *p,
                    vec_mask touches, int parts) {
  vec *f = p->f;
  if (parts & DEM_ROLLING) {
    vec g[8];
    for (int c = 0; c < 8; c++)
      g[c] = c < 4 ? -f[c] : f[c];
    for (int c = 0; c < 3; c++) {
      f[4 + c] += vec_keep(touches, p->moment[c] / p->r_i);
      g[4 + c] -= vec_keep(touches, p->moment[c] / p->r_j);
    }
    add_8_two(in->ft, i, j, f, g);
  } else {
    add_8(in->ft, i, j, sign_8(-1.0, 0.0, 0.0), f);
  }
}

/* Records of the partners of a later block. */
INLINE void fetch(const constants *in, const unsigned *j) {
  for (int k = 0; k < PART_WIDTH; k++) {
    __builtin_prefetch(quad_at(in->xr, j[k]), 0);
    __builtin_prefetch(record_at(in->vm, j[k]), 0);
    __builtin_prefetch(record_at(in->ft, j[k]), 1);
  }
}

enum { BLOCKS = DEM_BLOCK_PAIRS / PART_WIDTH };

/* Pairs from .. to-1. The stages of 8 pairs one after the other, so that narrow vectors have two
 * blocks of which neither waits for the other (AVX2, bed: 27 to 19 ns a particle). */
INLINE void dense_loop(const dem_lanes *in, int from, int to, dem_law_function *law, int parts,
                       int equal) {
  const constants c = constants_of(in, equal);
  geometry g[BLOCKS];
  push p[BLOCKS];
  for (int first = from; first < to; first += DEM_BLOCK_PAIRS) {
    const int blocks = to - first < DEM_BLOCK_PAIRS ? (to - first) / PART_WIDTH : BLOCKS;
    for (int b = 0; b < blocks; b++) {
      const int k = first + b * PART_WIDTH;
      if (k < in->fetch_to)
        fetch(&c, in->j + k + DEM_FETCH_AHEAD);
      measure(&c, in->i + k, in->j + k, equal, &g[b]);
    }
    for (int b = 0; b < blocks; b++) {
      const int k = first + b * PART_WIDTH;
      double *history[DEM_HISTORY];
      for (int w = 0; w < DEM_HISTORY_WIDTH(parts); w++)
        history[w] = in->history[w] + k;
      push_of(&c, in->i + k, in->j + k, &g[b], history, law, parts, equal, &p[b]);
    }
    for (int b = 0; b < blocks; b++) {
      const int k = first + b * PART_WIDTH;
      scatter(&c, in->i + k, in->j + k, &p[b], g[b].touches, parts);
    }
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
  for (int m = 0; m < DEM_BLOCK_PAIRS; m += PART_WIDTH) {
    vec d[4];
    const vec d2 = separation(in->xr, in->i + k + m, in->j + k + m, d);
    bits |= vec_bits(touching(d2, d[3])) << m;
  }
  return bits;
}

enum { PACKED = DEM_CHUNK_PAIRS + DEM_BLOCK_PAIRS };

typedef struct packed {
  int count, from[PACKED];
  unsigned i[PACKED], j[PACKED];
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
  for (int k = p.count; k % PART_WIDTH != 0; k++) {
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
  run(&packed_lanes, 0, (p.count + PART_WIDTH - 1) / PART_WIDTH * PART_WIDTH);
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
  static void dense_##name##_##parts(const dem_lanes *in, int from, int to) {                      \
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

static const dem_kernels kernels = {PART_WIDTH, dense, sparse, move};
