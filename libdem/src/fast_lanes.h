/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Records of PART_WIDTH pairs to one vector per component, and back. A record of 8 is the pair of
 * its halves where vectors hold 4. */
#ifndef DEM_FAST_LANES_H
#define DEM_FAST_LANES_H

#include "particle/lanes.h"

#define SHUFFLE __builtin_shufflevector

/* Records of 4 and of 8 doubles of the particle with number place/8: addresses that a load can work
 * out itself. */
#define quad_at(base, place) ((quad *)((char *)(base) + 4 * (size_t)(place)))
#define record_at(base, place) ((vec *)((char *)(base) + 8 * (size_t)(place)))

#if PART_WIDTH == 8

/* [8 records][4] -> [4][8 lanes]. */
static inline void to_lanes_4(const quad r[8], vec v[4]) {
  vec a[4];
  for (int k = 0; k < 4; k++)
    a[k] = SHUFFLE(r[k], r[k + 4], 0, 1, 2, 3, 4, 5, 6, 7);
  const vec lo01 = SHUFFLE(a[0], a[1], 0, 8, 2, 10, 4, 12, 6, 14);
  const vec hi01 = SHUFFLE(a[0], a[1], 1, 9, 3, 11, 5, 13, 7, 15);
  const vec lo23 = SHUFFLE(a[2], a[3], 0, 8, 2, 10, 4, 12, 6, 14);
  const vec hi23 = SHUFFLE(a[2], a[3], 1, 9, 3, 11, 5, 13, 7, 15);
  v[0] = SHUFFLE(lo01, lo23, 0, 1, 8, 9, 4, 5, 12, 13);
  v[1] = SHUFFLE(hi01, hi23, 0, 1, 8, 9, 4, 5, 12, 13);
  v[2] = SHUFFLE(lo01, lo23, 2, 3, 10, 11, 6, 7, 14, 15);
  v[3] = SHUFFLE(hi01, hi23, 2, 3, 10, 11, 6, 7, 14, 15);
}

/* 8 x 8, either way. */
static inline void transpose_8(vec v[8]) {
  vec a[8], b[8];
  for (int k = 0; k < 8; k += 2) {
    a[k] = SHUFFLE(v[k], v[k + 1], 0, 8, 2, 10, 4, 12, 6, 14);
    a[k + 1] = SHUFFLE(v[k], v[k + 1], 1, 9, 3, 11, 5, 13, 7, 15);
  }
  for (int k = 0; k < 8; k += 4)
    for (int m = 0; m < 2; m++) {
      b[k + m] = SHUFFLE(a[k + m], a[k + m + 2], 0, 1, 8, 9, 4, 5, 12, 13);
      b[k + m + 2] = SHUFFLE(a[k + m], a[k + m + 2], 2, 3, 10, 11, 6, 7, 14, 15);
    }
  for (int m = 0; m < 4; m++) {
    v[m] = SHUFFLE(b[m], b[m + 4], 0, 1, 2, 3, 8, 9, 10, 11);
    v[m + 4] = SHUFFLE(b[m], b[m + 4], 4, 5, 6, 7, 12, 13, 14, 15);
  }
}

/* record[i] + sign * record[j] of 8 components. */
static inline void load_8(const double *record, const unsigned *i, const unsigned *j, vec sign,
                          vec v[8]) {
  for (int k = 0; k < 8; k++)
    v[k] = *record_at(record, i[k]) + sign * *record_at(record, j[k]);
  transpose_8(v);
}

/* record[i] += v, record[j] += sign * v. */
static inline void add_8(double *record, const unsigned *i, const unsigned *j, vec sign, vec v[8]) {
  transpose_8(v);
  for (int k = 0; k < 8; k++) {
    *record_at(record, i[k]) += v[k];
    *record_at(record, j[k]) += sign * v[k];
  }
}

/* record[i] += v, record[j] += w. */
static inline void add_8_two(double *record, const unsigned *i, const unsigned *j, vec v[8],
                             vec w[8]) {
  transpose_8(v);
  transpose_8(w);
  for (int k = 0; k < 8; k++) {
    *record_at(record, i[k]) += v[k];
    *record_at(record, j[k]) += w[k];
  }
}

static inline vec sign_8(double a, double b, double last) {
  return (vec){a, a, a, b, 1.0, 1.0, 1.0, last};
}

#else /* 4 */

static inline void to_lanes_4(const quad r[4], vec v[4]) {
  const vec lo01 = SHUFFLE(r[0], r[1], 0, 4, 2, 6), hi01 = SHUFFLE(r[0], r[1], 1, 5, 3, 7);
  const vec lo23 = SHUFFLE(r[2], r[3], 0, 4, 2, 6), hi23 = SHUFFLE(r[2], r[3], 1, 5, 3, 7);
  v[0] = SHUFFLE(lo01, lo23, 0, 1, 4, 5);
  v[1] = SHUFFLE(hi01, hi23, 0, 1, 4, 5);
  v[2] = SHUFFLE(lo01, lo23, 2, 3, 6, 7);
  v[3] = SHUFFLE(hi01, hi23, 2, 3, 6, 7);
}

typedef struct halves {
  quad lo, hi;
} halves;

static inline void load_8(const double *record, const unsigned *i, const unsigned *j, halves sign,
                          vec v[8]) {
  quad lo[4], hi[4];
  for (int k = 0; k < 4; k++) {
    const quad *a = record_at(record, i[k]);
    const quad *b = record_at(record, j[k]);
    lo[k] = a[0] + sign.lo * b[0];
    hi[k] = a[1] + sign.hi * b[1];
  }
  to_lanes_4(lo, v);
  to_lanes_4(hi, v + 4);
}

static inline void add_8(double *record, const unsigned *i, const unsigned *j, halves sign,
                         vec v[8]) {
  quad lo[4], hi[4];
  to_lanes_4(v, lo);
  to_lanes_4(v + 4, hi);
  for (int k = 0; k < 4; k++) {
    quad *a = record_at(record, i[k]), *b = record_at(record, j[k]);
    a[0] += lo[k];
    a[1] += hi[k];
    b[0] += sign.lo * lo[k];
    b[1] += sign.hi * hi[k];
  }
}

static inline void add_8_two(double *record, const unsigned *i, const unsigned *j, vec v[8],
                             vec w[8]) {
  quad own[2][4], other[2][4];
  for (int half = 0; half < 2; half++) {
    to_lanes_4(v + 4 * half, own[half]);
    to_lanes_4(w + 4 * half, other[half]);
  }
  for (int k = 0; k < 4; k++)
    for (int half = 0; half < 2; half++) {
      record_at(record, i[k])[half] += own[half][k];
      record_at(record, j[k])[half] += other[half][k];
    }
}

static inline halves sign_8(double a, double b, double last) {
  return (halves){{a, a, a, b}, {1.0, 1.0, 1.0, last}};
}

#endif
#endif
