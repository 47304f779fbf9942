/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Several pairs at once, for the loops of the libraries on top of this one (not for their users):
 * one value of each of PART_WIDTH pairs (lanes) as a type with + - * /. A file sets PART_WIDTH to 8 (AVX-512), 4 (AVX2 with FMA) or nothing (1, plain double) before its
 * first include; what is written with these names then compiles for any width.
 *
 * A function of lanes must give a lane the same bits whatever the others hold: a branch that any
 * lane takes changes only the lanes that asked for it (vec_choose). So nothing depends on how pairs
 * are packed into lanes. */
#ifndef PARTICLE_LANES_H
#define PARTICLE_LANES_H

#include <math.h>

#ifndef PART_WIDTH
#define PART_WIDTH 1
#endif

/* A function of lanes is copied into its caller: a call would pass dozens of vectors through memory
 * (libdem's bed: 25 instead of 31 million particle-steps a second). */
#if defined(__GNUC__)
#define PART_LANES static inline __attribute__((always_inline, unused))
#else
#define PART_LANES static inline
#endif

#if PART_WIDTH > 1
#include <immintrin.h>
/* A record or half a record as it lies in memory. */
typedef double quad __attribute__((vector_size(32), may_alias));
#endif

#if PART_WIDTH == 8
typedef double vec __attribute__((vector_size(64), may_alias));
typedef __mmask8 vec_mask;
#define vec_all(x) ((vec)_mm512_set1_pd(x))
#define vec_sqrt(a) ((vec)_mm512_sqrt_pd((__m512d)(a)))
#define vec_max(a, b) ((vec)_mm512_max_pd((__m512d)(a), (__m512d)(b)))
#define vec_min(a, b) ((vec)_mm512_min_pd((__m512d)(a), (__m512d)(b)))
#define vec_less(a, b) _mm512_cmp_pd_mask((__m512d)(a), (__m512d)(b), _CMP_LT_OQ)
#define vec_both(m, n) ((vec_mask)((m) & (n)))
#define vec_bits(m) ((unsigned)(m))
#define vec_keep(m, a) ((vec)_mm512_maskz_mov_pd(m, (__m512d)(a)))
#define vec_choose(m, a, b) ((vec)_mm512_mask_blend_pd(m, (__m512d)(b), (__m512d)(a)))
#define vec_sum(a) _mm512_reduce_add_pd((__m512d)(a))
#elif PART_WIDTH == 4
typedef double vec __attribute__((vector_size(32), may_alias));
typedef __m256d vec_mask;
#define vec_all(x) ((vec)_mm256_set1_pd(x))
#define vec_sqrt(a) ((vec)_mm256_sqrt_pd((__m256d)(a)))
#define vec_max(a, b) ((vec)_mm256_max_pd((__m256d)(a), (__m256d)(b)))
#define vec_min(a, b) ((vec)_mm256_min_pd((__m256d)(a), (__m256d)(b)))
#define vec_less(a, b) _mm256_cmp_pd((__m256d)(a), (__m256d)(b), _CMP_LT_OQ)
#define vec_both(m, n) _mm256_and_pd(m, n)
#define vec_bits(m) ((unsigned)_mm256_movemask_pd(m))
#define vec_keep(m, a) ((vec)_mm256_and_pd(m, (__m256d)(a)))
#define vec_choose(m, a, b) ((vec)_mm256_blendv_pd((__m256d)(b), (__m256d)(a), m))
PART_LANES double vec_sum(vec a) {
  return (a[0] + a[1]) + (a[2] + a[3]);
}
#elif PART_WIDTH == 1
typedef double vec;
typedef int vec_mask;
#define vec_all(x) (x)
#define vec_sqrt(a) sqrt(a)
#define vec_max(a, b) ((a) > (b) ? (a) : (b))
#define vec_min(a, b) ((a) < (b) ? (a) : (b))
#define vec_less(a, b) ((a) < (b))
#define vec_both(m, n) ((m) && (n))
#define vec_bits(m) ((unsigned)(m))
#define vec_keep(m, a) ((m) ? (a) : 0.0)
#define vec_choose(m, a, b) ((m) ? (a) : (b))
#define vec_sum(a) (a)
#endif

#endif
