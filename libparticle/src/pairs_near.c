/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The inner loop of neighbour search, plain and for vectors of 4 (AVX2) and 8 (AVX-512). No
 * multiply-add is fused, so that all give the same bits (-ffp-contract is off in C11 mode). */
#include "pairs_near.h"

#include <limits.h>

#include "memory.h"
#include "particle/status.h"

#if defined(__x86_64__) && defined(__GNUC__)
#define PART_X86 1
#include <immintrin.h>
#endif

/* Written without a branch on the outcome, which is not predictable: every candidate is stored, and
 * the counter moves on for a pair. */
static int near_plain(const part_cells *c, int from, int to, const double xi[4], double skin,
                      int above, int *found) {
  int count = 0;
  for (int k = from; k < to; k++) {
    const int near =
        part_pair_near(c->x[k] - xi[0], c->y[k] - xi[1], c->z[k] - xi[2], xi[3], c->r[k], skin);
    found[count] = c->member[k];
    count += near & (c->member[k] > above);
  }
  return count;
}

#ifdef PART_X86

/* Bytes that bring the chosen ones of four ints to the front; [mask]. */
#define INT_AT(k) 4 * (k), 4 * (k) + 1, 4 * (k) + 2, 4 * (k) + 3
#define PACK(a, b, c, d) {INT_AT(a), INT_AT(b), INT_AT(c), INT_AT(d)}
static const unsigned char pack_4[16][16] = {
    PACK(0, 0, 0, 0), PACK(0, 0, 0, 0), PACK(1, 0, 0, 0), PACK(0, 1, 0, 0),
    PACK(2, 0, 0, 0), PACK(0, 2, 0, 0), PACK(1, 2, 0, 0), PACK(0, 1, 2, 0),
    PACK(3, 0, 0, 0), PACK(0, 3, 0, 0), PACK(1, 3, 0, 0), PACK(0, 1, 3, 0),
    PACK(2, 3, 0, 0), PACK(0, 2, 3, 0), PACK(1, 2, 3, 0), PACK(0, 1, 2, 3)};

__attribute__((target("avx2"))) static int near_avx2(const part_cells *c, int from, int to,
                                                     const double xi[4], double skin, int above,
                                                     int *found) {
  const __m256d x = _mm256_set1_pd(xi[0]), y = _mm256_set1_pd(xi[1]), z = _mm256_set1_pd(xi[2]);
  const __m256d r = _mm256_set1_pd(xi[3]), s = _mm256_set1_pd(skin);
  const __m128i low = _mm_set1_epi32(above);
  int count = 0;
  for (int k = from; k < to; k += 4) {
    const __m256d dx = _mm256_sub_pd(_mm256_loadu_pd(c->x + k), x);
    const __m256d dy = _mm256_sub_pd(_mm256_loadu_pd(c->y + k), y);
    const __m256d dz = _mm256_sub_pd(_mm256_loadu_pd(c->z + k), z);
    const __m256d reach = _mm256_add_pd(_mm256_add_pd(r, _mm256_loadu_pd(c->r + k)), s);
    const __m256d d2 = _mm256_add_pd(_mm256_add_pd(_mm256_mul_pd(dx, dx), _mm256_mul_pd(dy, dy)),
                                     _mm256_mul_pd(dz, dz));
    const __m128i member = _mm_loadu_si128((const __m128i *)(const void *)(c->member + k));
    unsigned mask =
        (unsigned)_mm256_movemask_pd(_mm256_cmp_pd(d2, _mm256_mul_pd(reach, reach), _CMP_LT_OQ)) &
        (unsigned)_mm_movemask_ps(_mm_castsi128_ps(_mm_cmpgt_epi32(member, low)));
    if (to - k < 4)
      mask &= (1U << (to - k)) - 1U;
    const __m128i order = _mm_loadu_si128((const __m128i *)(const void *)pack_4[mask]);
    _mm_storeu_si128((__m128i *)(void *)(found + count), _mm_shuffle_epi8(member, order));
    count += __builtin_popcount(mask);
  }
  return count;
}

__attribute__((target("avx512f,avx512vl,avx2"))) static int
near_avx512(const part_cells *c, int from, int to, const double xi[4], double skin, int above,
            int *found) {
  const __m512d x = _mm512_set1_pd(xi[0]), y = _mm512_set1_pd(xi[1]), z = _mm512_set1_pd(xi[2]);
  const __m512d r = _mm512_set1_pd(xi[3]), s = _mm512_set1_pd(skin);
  const __m256i low = _mm256_set1_epi32(above);
  int count = 0;
  for (int k = from; k < to; k += 8) {
    const __m512d dx = _mm512_sub_pd(_mm512_loadu_pd(c->x + k), x);
    const __m512d dy = _mm512_sub_pd(_mm512_loadu_pd(c->y + k), y);
    const __m512d dz = _mm512_sub_pd(_mm512_loadu_pd(c->z + k), z);
    const __m512d reach = _mm512_add_pd(_mm512_add_pd(r, _mm512_loadu_pd(c->r + k)), s);
    const __m512d d2 = _mm512_add_pd(_mm512_add_pd(_mm512_mul_pd(dx, dx), _mm512_mul_pd(dy, dy)),
                                     _mm512_mul_pd(dz, dz));
    const __m256i member = _mm256_loadu_si256((const __m256i *)(const void *)(c->member + k));
    unsigned mask = _mm512_cmp_pd_mask(d2, _mm512_mul_pd(reach, reach), _CMP_LT_OQ);
    mask &= _mm256_cmpgt_epi32_mask(member, low);
    if (to - k < 8)
      mask &= (1U << (to - k)) - 1U;
    /* Packed in a register: storing packed is slow on some processors. */
    _mm256_storeu_si256((__m256i *)(void *)(found + count),
                        _mm256_maskz_compress_epi32((__mmask8)mask, member));
    count += __builtin_popcount(mask);
  }
  return count;
}

part_near_function *part_near_variant(int k) {
  if (k == 1)
    return __builtin_cpu_supports("avx2") ? near_avx2 : (part_near_function *)0;
  if (k == 2)
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl")
               ? near_avx512
               : (part_near_function *)0;
  return k == 0 ? near_plain : (part_near_function *)0;
}

#else

part_near_function *part_near_variant(int k) {
  return k == 0 ? near_plain : (part_near_function *)0;
}

#endif

part_near_function *part_near_choose(void) {
  for (int k = 2; k > 0; k--)
    if (part_near_variant(k) != (part_near_function *)0)
      return part_near_variant(k);
  return near_plain;
}

static int make_room(part_found *found, int more) {
  const size_t room = (size_t)found->count + (size_t)more + CELLS_PADDING;
  if (room <= found->room)
    return PART_OK;
  if (room > INT_MAX)
    return part_fail(PART_ERR_RANGE, "more than %d pairs on one rank", INT_MAX);
  return part_grow(room, sizeof *found->item, &found->room, &found->item);
}

int part_cells_near(const part_cells *cells, part_near_function *near, const double xi[4],
                    double skin, int above, part_found *found) {
  int range[3][2];
  if (!part_cells_range(cells, xi, xi[3] + cells->r_max + skin, range))
    return PART_OK;
  for (int z = range[2][0]; z <= range[2][1]; z++)
    for (int y = range[1][0]; y <= range[1][1]; y++) {
      const int *line = cells->start + (z * cells->n[1] + y) * cells->n[0];
      const int from = line[range[0][0]], to = line[range[0][1] + 1];
      if (from == to)
        continue;
      PART_TRY(make_room(found, to - from));
      found->count += near(cells, from, to, xi, skin, above, found->item + found->count);
    }
  return PART_OK;
}
