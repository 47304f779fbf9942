/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Kernels for AVX-512. Only this file is compiled for it; dem_fast_choose asks the processor. */
#include "fast.h"

#if defined(__x86_64__) && defined(__GNUC__)

#include <immintrin.h>
#include <math.h>
#include <mpi.h>
#include <string.h>

/* From here on functions are compiled for the named instructions; multiply and add may be one
 * operation, as these have it. */
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx512f,avx512dq,avx512vl,avx2,fma"))),        \
                             apply_to = function)
#pragma STDC FP_CONTRACT ON
#else
#pragma GCC push_options
#pragma GCC target("avx512f,avx512dq,avx512vl,avx2,fma")
#pragma GCC optimize("fp-contract=fast", "no-trapping-math")
#endif

#define PART_WIDTH 8
#include "fast_kernel.h"

#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif

const dem_kernels *dem_kernels_avx512(void) {
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                 __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx2") &&
                 __builtin_cpu_supports("fma")
             ? &kernels
             : NULL;
}

#else

const dem_kernels *dem_kernels_avx512(void) {
  return NULL;
}

#endif
