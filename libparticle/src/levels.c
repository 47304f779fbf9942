/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "particle/levels.h"

#include <math.h>

/* A level costs every smaller sphere a look at a few cells, and saves it the candidates that the
 * larger cells of the next level would bring: measured on power laws of ratio 50 the cost is flat
 * between 1.7 and 2.5. */
static const double widest = 2.0;

void part_levels_set(part_levels *levels, double r_min, double r_max) {
  const double ratio = r_min > 0.0 && r_max > r_min ? r_max / r_min : r_max > r_min ? HUGE_VAL : 1.0;
  /* Rounding must not make a level more of a ratio that is just a power of two. */
  const double wanted = ceil(log(ratio) / log(widest) * (1.0 - 1e-12));
  levels->count = wanted < 1.0               ? 1
                  : wanted > PART_LEVELS_MAX ? PART_LEVELS_MAX
                                             : (int)wanted;
  const double factor = wanted > PART_LEVELS_MAX ? widest : pow(ratio, 1.0 / levels->count);
  double top = r_max;
  for (int k = levels->count - 1; k >= 0; k--) {
    levels->top[k] = top;
    top /= factor;
  }
}
