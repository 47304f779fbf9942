/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A sum of many small parts, with the rounding errors carried along (Neumaier). */
#ifndef PARTICLE_SUM_H
#define PARTICLE_SUM_H

#include <math.h>

typedef struct part_sum {
  double value[3], lost[3];
} part_sum;

static inline void part_sum_add(part_sum *sum, const double part[3], double factor) {
  for (int c = 0; c < 3; c++) {
    const double p = factor * part[c], t = sum->value[c] + p;
    sum->lost[c] +=
        fabs(sum->value[c]) >= fabs(p) ? (sum->value[c] - t) + p : (p - t) + sum->value[c];
    sum->value[c] = t;
  }
}

static inline void part_sum_total(const part_sum *sum, double total[3]) {
  for (int c = 0; c < 3; c++)
    total[c] = sum->value[c] + sum->lost[c];
}

#endif
