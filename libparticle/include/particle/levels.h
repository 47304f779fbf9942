/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Size classes of spheres ("levels"), for neighbour search over wide size distributions: a grid of
 * linked cells for each level, so that the cells of small spheres are small (hierarchical grid; He
 * et al. 2007, Powder Technol. 177, 99; Ogarko and Luding 2012, Comput. Phys. Commun. 183, 931).
 * All ranks must use the same levels: they decide the order of particles and who needs a ghost. */
#ifndef PARTICLE_LEVELS_H
#define PARTICLE_LEVELS_H

#ifdef __cplusplus
extern "C" {
#endif

enum { PART_LEVELS_MAX = 16 };

/* Level k holds radii in (top[k-1], top[k]]; level 0 also all that are smaller, the last one also
 * all that are larger. */
typedef struct part_levels {
  int count;                   /* 1 .. PART_LEVELS_MAX */
  double top[PART_LEVELS_MAX]; /* m, increasing */
} part_levels;

/* As few levels between the smallest and the largest radius as keep the largest of a level within
 * twice its smallest, their bounds a geometric series. */
void part_levels_set(part_levels *levels, double r_min, double r_max);

static inline int part_level_of(const part_levels *levels, double r) {
  int k = levels->count - 1;
  while (k > 0 && r <= levels->top[k - 1])
    k--;
  return k;
}

#ifdef __cplusplus
}
#endif
#endif
