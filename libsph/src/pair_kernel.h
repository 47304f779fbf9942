/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The loops of pair_loops.h, written once and included by one file for each PART_WIDTH. */
#include "kernels.h"
#include "load.h"
#include "pair_loops.h"

typedef vec (*sph_kernel_function)(vec q);

/* A particle and its row, out of memory that a store could change. */
typedef struct row {
  vec x[3], v[3], p, eps;
  int k, end;
} row;

PART_LANES row take_row(const sph_lanes *in, int i) {
  const double *a = in->xv + SPH_XV * (size_t)i;
  row r = {.k = in->start[i], .end = in->start[i + 1]};
  for (int c = 0; c < 3; c++) {
    r.x[c] = vec_all(a[c]);
    r.v[c] = vec_all(a[4 + c]);
  }
  r.p = vec_all(a[7]);
  r.eps = vec_all(in->porous ? in->mass[4 * (size_t)i + 2] : 1.0);
  return r;
}

/* x_i - x_j and v_i - v_j of a block of partners, whose records are b. Returns |x_i - x_j|^2. */
PART_LANES vec separate(const row *r, const vec b[8], vec d[3], vec u[3]) {
  for (int c = 0; c < 3; c++) {
    d[c] = r->x[c] - b[c];
    u[c] = r->v[c] - b[4 + c];
  }
  return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
}

/* What S.5 takes off p_j - p_i of a block of partners, with the other sign: the mean of both along d. */
PART_LANES vec balanced(const sph_lanes *in, int i, const int *partner, const vec d[3]) {
  const double *g = in->hydrostatic;
  vec sum = vec_all(0.0);
  if (in->balance == NULL)
    return g[0] * d[0] + g[1] * d[1] + g[2] * d[2];
  const double *own = in->balance + SPH_BALANCE * (size_t)i;
  for (int c = 0; c < 3; c++)
    sum += (own[c] + vec_load_1(in->balance + c, SPH_BALANCE, partner)) * d[c];
  return 0.5 * sum;
}

/* 1/eps_j - 1/eps_i */
PART_LANES vec looser(const sph_lanes *in, vec own, const int *partner) {
  const vec eps = vec_load_1(in->mass + 2, 4, partner);
  return (own - eps) / (own * eps);
}

/* S.4, S.5, S.6, S.11, S.22, S.27. */
PART_LANES void density_loop(const sph_lanes *in, int from, int to, double *sum,
                            sph_kernel_function shape, sph_kernel_function slope) {
  const vec per_h = vec_all(1.0 / in->h), norm = vec_all(in->norm);
  const vec slope_norm = vec_all(in->norm / (in->h * in->h));
  const int values = in->smooth || in->count || in->seen;
  for (int i = from; i < to; i++) {
    row r = take_row(in, i);
    vec s[8];
    for (int c = 0; c < 8; c++)
      s[c] = vec_all(0.0);
    for (; r.k < r.end; r.k += PART_WIDTH) {
      vec b[8], d[3], u[3];
      vec_load_8(in->xv, in->partner + r.k, b);
      const vec d2 = separate(&r, b, d, u), q = vec_sqrt(d2) * per_h;
      const vec f = b[3] * slope_norm * slope(q);
      s[0] += f * (d[0] * u[0] + d[1] * u[1] + d[2] * u[2]);
      if (in->diffuse) {
        vec flow = b[7] - r.p + balanced(in, i, in->partner + r.k, d);
        if (in->porous)
          flow *= 0.5 * (r.eps + vec_load_1(in->mass + 2, 4, in->partner + r.k));
        s[1] += f * flow;
      }
      if (values) {
        const vec w = norm * shape(q), v = b[3] * w;
        for (int c = 0; c < 3; c++)
          s[2 + c] -= v * u[c];
        s[5] += vec_keep(vec_less(vec_all(0.0), d2), w);
        if (in->seen)
          s[7] += v * looser(in, r.eps, in->partner + r.k);
      }
      if (in->correct)
        s[6] -= f * d2;
    }
    for (int c = 0; c < 8; c++)
      sum[SPH_SUMS * (size_t)i + (size_t)c] = vec_sum(s[c]);
  }
}

/* Force of a block over V_i V_j slope, along d: S.7, S.9, S.10; and S.8 along u. */
PART_LANES void force_of(const sph_lanes *in, const vec d[3], const vec u[3], vec d2, vec pressure,
                        vec eps, vec *along_d, vec *along_u) {
  *along_d = -pressure;
  *along_u = 2.0 * in->viscosity * eps;
  if (in->monaghan > 0.0 || in->artificial > 0.0) {
    const vec w = d[0] * u[0] + d[1] * u[1] + d[2] * u[2];
    const vec approach = vec_min(w, vec_all(0.0));
    *along_d += in->artificial * eps * approach / (d2 + vec_all(0.01 * in->h * in->h));
    if (in->monaghan > 0.0) {
      const vec per_r = 1.0 / vec_sqrt(vec_max(d2, vec_all(1e-12 * in->h * in->h)));
      const vec speed = vec_max(w, -w) * per_r + in->sound_speed;
      *along_d += in->monaghan * eps * speed * w * per_r;
    }
  }
}

/* What S.20 and S.21 add to p_i + p_j. */
PART_LANES vec repulsion(const sph_lanes *in, vec p, vec b, vec shape) {
  const vec zero = vec_all(0.0), f = shape * vec_all(in->per_shape), both = p + b;
  const vec pull = -(vec_min(p, zero) + vec_min(b, zero));
  const vec push = vec_keep(vec_less(zero, vec_min(p, b)), vec_all(0.05) * both);
  const vec r = in->repulsion * (pull + push) + in->anti_clump * vec_max(both, -both);
  return r * (f * f) * (f * f);
}

PART_LANES void force_loop(const sph_lanes *in, int from, int to, double *sum,
                          sph_kernel_function shape, sph_kernel_function slope) {
  const int repel = in->repulsion > 0.0 || in->anti_clump > 0.0;
  const vec per_h = vec_all(1.0 / in->h), slope_norm = vec_all(in->norm / (in->h * in->h));
  for (int i = from; i < to; i++) {
    row r = take_row(in, i);
    vec s[3] = {vec_all(0.0), vec_all(0.0), vec_all(0.0)};
    for (; r.k < r.end; r.k += PART_WIDTH) {
      vec b[8], d[3], u[3], along_d, along_u, eps = r.eps;
      vec_load_8(in->xv, in->partner + r.k, b);
      const vec d2 = separate(&r, b, d, u), q = vec_sqrt(d2) * per_h;
      const vec f = b[3] * slope_norm * slope(q);
      if (in->porous)
        eps = 0.5 * (eps + vec_load_1(in->mass + 2, 4, in->partner + r.k));
      vec p = r.p + b[7];
      if (in->correct)
        p = r.p * vec_all(in->factor[i]) + b[7] * vec_load_1(in->factor, 1, in->partner + r.k);
      if (repel)
        p += repulsion(in, r.p, b[7], shape(q));
      force_of(in, d, u, d2, p, eps, &along_d, &along_u);
      for (int c = 0; c < 3; c++)
        s[c] += f * (along_d * d[c] + along_u * u[c]);
    }
    for (int c = 0; c < 3; c++)
      sum[SPH_SUMS * (size_t)i + (size_t)c] = vec_sum(s[c]);
  }
}

/* S.19. */
PART_LANES void shift_loop(const sph_lanes *in, int from, int to, double *sum,
                          sph_kernel_function slope) {
  const vec per_h = vec_all(1.0 / in->h), slope_norm = vec_all(in->norm / (in->h * in->h));
  for (int i = from; i < to; i++) {
    row r = take_row(in, i);
    vec s[7];
    for (int c = 0; c < 7; c++)
      s[c] = vec_all(0.0);
    for (; r.k < r.end; r.k += PART_WIDTH) {
      vec b[8], d[3], u[3];
      vec_load_8(in->xv, in->partner + r.k, b);
      const vec d2 = separate(&r, b, d, u), q = vec_sqrt(d2) * per_h;
      const vec f = b[3] * slope_norm * slope(q), p = b[7] - r.p;
      for (int c = 0; c < 3; c++) {
        s[c] += f * d[c];
        s[3 + c] += p * f * d[c];
      }
      s[6] -= f * d2;
    }
    for (int c = 0; c < 7; c++)
      sum[SPH_SHIFTS * (size_t)i + (size_t)c] = vec_sum(s[c]);
  }
}

#include "pair_variable.h"

#define SPH_KERNEL(name, key, support, meaning)                                                    \
  static void variable_density_##name(const sph_lanes *in, int from, int to, double *sum) {        \
    variable_density_loop(in, from, to, sum, sph_shape_##name, sph_slope_##name);                  \
  }                                                                                                \
  static void number_##name(const sph_lanes *in, int from, int to, double *sum) {                  \
    number_loop(in, from, to, sum, sph_shape_##name, sph_slope_##name);                            \
  }                                                                                                \
  static void variable_force_##name(const sph_lanes *in, int from, int to, double *sum) {          \
    variable_force_loop(in, from, to, sum, sph_slope_##name);                                      \
  }                                                                                                \
  static void density_##name(const sph_lanes *in, int from, int to, double *sum) {                 \
    density_loop(in, from, to, sum, sph_shape_##name, sph_slope_##name);                           \
  }                                                                                                \
  static void force_##name(const sph_lanes *in, int from, int to, double *sum) {                   \
    force_loop(in, from, to, sum, sph_shape_##name, sph_slope_##name);                             \
  }                                                                                                \
  static void shift_##name(const sph_lanes *in, int from, int to, double *sum) {                   \
    shift_loop(in, from, to, sum, sph_slope_##name);                                               \
  }
#include "sph/kernels.def"
#undef SPH_KERNEL

static const sph_loops loops = {PART_WIDTH,
                                {
#define SPH_KERNEL(name, key, support, meaning) density_##name,
#include "sph/kernels.def"
#undef SPH_KERNEL
                                },
                                {
#define SPH_KERNEL(name, key, support, meaning) force_##name,
#include "sph/kernels.def"
#undef SPH_KERNEL
                                },
                                {
#define SPH_KERNEL(name, key, support, meaning) shift_##name,
#include "sph/kernels.def"
#undef SPH_KERNEL
                                },
                                {
#define SPH_KERNEL(name, key, support, meaning) variable_density_##name,
#include "sph/kernels.def"
#undef SPH_KERNEL
                                },
                                {
#define SPH_KERNEL(name, key, support, meaning) number_##name,
#include "sph/kernels.def"
#undef SPH_KERNEL
                                },
                                {
#define SPH_KERNEL(name, key, support, meaning) variable_force_##name,
#include "sph/kernels.def"
#undef SPH_KERNEL
                                }};
