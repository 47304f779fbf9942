/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Several pairs at once: one value of each of SPH_WIDTH pairs (lanes) as a type with + - * /. A
 * file sets SPH_WIDTH to 8 (AVX-512), 4 (AVX2 with FMA) or nothing (1, plain double) before its
 * first include; what is written with these names then compiles for any width. */
#ifndef SPH_VEC_H
#define SPH_VEC_H

#include <math.h>
#include <stddef.h>

#ifndef SPH_WIDTH
#define SPH_WIDTH 1
#endif

#if defined(__GNUC__)
#define SPH_LANES static inline __attribute__((always_inline, unused))
#else
#define SPH_LANES static inline
#endif

#if SPH_WIDTH == 8
#include <immintrin.h>
typedef double vec __attribute__((vector_size(64), may_alias));
typedef __mmask8 vec_mask;
#define vec_all(x) ((vec)_mm512_set1_pd(x))
#define vec_sqrt(a) ((vec)_mm512_sqrt_pd((__m512d)(a)))
#define vec_max(a, b) ((vec)_mm512_max_pd((__m512d)(a), (__m512d)(b)))
#define vec_min(a, b) ((vec)_mm512_min_pd((__m512d)(a), (__m512d)(b)))
#define vec_less(a, b) _mm512_cmp_pd_mask((__m512d)(a), (__m512d)(b), _CMP_LT_OQ)
#define vec_keep(m, a) ((vec)_mm512_maskz_mov_pd(m, (__m512d)(a)))
#define vec_sum(a) _mm512_reduce_add_pd((__m512d)(a))
#elif SPH_WIDTH == 4
#include <immintrin.h>
typedef double vec __attribute__((vector_size(32), may_alias));
typedef __m256d vec_mask;
#define vec_all(x) ((vec)_mm256_set1_pd(x))
#define vec_sqrt(a) ((vec)_mm256_sqrt_pd((__m256d)(a)))
#define vec_max(a, b) ((vec)_mm256_max_pd((__m256d)(a), (__m256d)(b)))
#define vec_min(a, b) ((vec)_mm256_min_pd((__m256d)(a), (__m256d)(b)))
#define vec_less(a, b) _mm256_cmp_pd((__m256d)(a), (__m256d)(b), _CMP_LT_OQ)
#define vec_keep(m, a) ((vec)_mm256_and_pd(m, (__m256d)(a)))
SPH_LANES double vec_sum(vec a) {
  return (a[0] + a[1]) + (a[2] + a[3]);
}
#else
typedef double vec;
typedef int vec_mask;
#define vec_all(x) (x)
#define vec_sqrt(a) sqrt(a)
#define vec_max(a, b) ((a) > (b) ? (a) : (b))
#define vec_min(a, b) ((a) < (b) ? (a) : (b))
#define vec_less(a, b) ((a) < (b))
#define vec_keep(m, a) ((m) ? (a) : 0.0)
#define vec_sum(a) (a)
#endif

/* Records of 8 doubles of the particles numbered j[0 .. SPH_WIDTH-1], one component a vector. */
#if SPH_WIDTH == 8
SPH_LANES void vec_load_8(const double *record, const int *j, vec v[8]) {
  vec a[8], b[8];
  for (int k = 0; k < 8; k++)
    v[k] = *(const vec *)(record + 8 * (size_t)j[k]);
  for (int k = 0; k < 8; k += 2) {
    a[k] = __builtin_shufflevector(v[k], v[k + 1], 0, 8, 2, 10, 4, 12, 6, 14);
    a[k + 1] = __builtin_shufflevector(v[k], v[k + 1], 1, 9, 3, 11, 5, 13, 7, 15);
  }
  for (int k = 0; k < 8; k += 4)
    for (int m = 0; m < 2; m++) {
      b[k + m] = __builtin_shufflevector(a[k + m], a[k + m + 2], 0, 1, 8, 9, 4, 5, 12, 13);
      b[k + m + 2] = __builtin_shufflevector(a[k + m], a[k + m + 2], 2, 3, 10, 11, 6, 7, 14, 15);
    }
  for (int m = 0; m < 4; m++) {
    v[m] = __builtin_shufflevector(b[m], b[m + 4], 0, 1, 2, 3, 8, 9, 10, 11);
    v[m + 4] = __builtin_shufflevector(b[m], b[m + 4], 4, 5, 6, 7, 12, 13, 14, 15);
  }
}
#elif SPH_WIDTH == 4
SPH_LANES void vec_load_8(const double *record, const int *j, vec v[8]) {
  for (int half = 0; half < 2; half++) {
    vec r[4];
    for (int k = 0; k < 4; k++)
      r[k] = *(const vec *)(record + 8 * (size_t)j[k] + 4 * half);
    const vec lo01 = __builtin_shufflevector(r[0], r[1], 0, 4, 2, 6);
    const vec hi01 = __builtin_shufflevector(r[0], r[1], 1, 5, 3, 7);
    const vec lo23 = __builtin_shufflevector(r[2], r[3], 0, 4, 2, 6);
    const vec hi23 = __builtin_shufflevector(r[2], r[3], 1, 5, 3, 7);
    v[4 * half] = __builtin_shufflevector(lo01, lo23, 0, 1, 4, 5);
    v[4 * half + 1] = __builtin_shufflevector(hi01, hi23, 0, 1, 4, 5);
    v[4 * half + 2] = __builtin_shufflevector(lo01, lo23, 2, 3, 6, 7);
    v[4 * half + 3] = __builtin_shufflevector(hi01, hi23, 2, 3, 6, 7);
  }
}
#else
SPH_LANES void vec_load_8(const double *record, const int *j, vec v[8]) {
  for (int c = 0; c < 8; c++)
    v[c] = record[8 * (size_t)*j + (size_t)c];
}
#endif

/* One value of each, `stride` apart. */
SPH_LANES vec vec_load_1(const double *value, int stride, const int *j) {
#if SPH_WIDTH == 1
  return value[(size_t)stride * (size_t)*j];
#else
  vec v = vec_all(0.0);
  for (int k = 0; k < SPH_WIDTH; k++)
    v[k] = value[(size_t)stride * (size_t)j[k]];
  return v;
#endif
}

#endif
