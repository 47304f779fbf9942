/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Particles into lanes (particle/lanes.h). */
#ifndef SPH_LOAD_H
#define SPH_LOAD_H

#include <stddef.h>
#include "particle/lanes.h"

/* Records of 8 doubles of the particles numbered j[0 .. PART_WIDTH-1], one component a vector. */
#if PART_WIDTH == 8
PART_LANES void vec_load_8(const double *record, const int *j, vec v[8]) {
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
#elif PART_WIDTH == 4
PART_LANES void vec_load_8(const double *record, const int *j, vec v[8]) {
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
PART_LANES void vec_load_8(const double *record, const int *j, vec v[8]) {
  for (int c = 0; c < 8; c++)
    v[c] = record[8 * (size_t)*j + (size_t)c];
}
#endif

/* One value of each, `stride` apart. */
PART_LANES vec vec_load_1(const double *value, int stride, const int *j) {
#if PART_WIDTH == 1
  return value[(size_t)stride * (size_t)*j];
#else
  vec v = vec_all(0.0);
  for (int k = 0; k < PART_WIDTH; k++)
    v[k] = value[(size_t)stride * (size_t)j[k]];
  return v;
#endif
}

#endif
