/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pair loops for AVX2 with FMA. Only this file is compiled for it; sph_choose_loops asks the
 * processor. */
#include "pair_loops.h"

#if defined(__x86_64__) && defined(__GNUC__)

#include <immintrin.h>
#include <math.h>

/* From here on functions are compiled for the named instructions; multiply and add may be one
 * operation, as these have it. */
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2,fma"))), apply_to = function)
#pragma STDC FP_CONTRACT ON
#else
#pragma GCC push_options
#pragma GCC target("avx2,fma")
#pragma GCC optimize("fp-contract=fast", "no-trapping-math")
#endif

#define PART_WIDTH 4
#include "pair_kernel.h"

#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif

const sph_loops *sph_loops_avx2(void) {
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? &loops : NULL;
}

#else

const sph_loops *sph_loops_avx2(void) {
  return NULL;
}

#endif
