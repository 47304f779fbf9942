/* SPDX-License-Identifier: GPL-3.0-or-later */
/* S.24: Monaghan, Kos and Issa (2003), with which Robinson et al. (2014) make the floor of their
 * columns. Their boundary particles share the force by weights 1 - |x|/spacing along the wall,
 * which add up to 1 on a smooth wall: what is left is a function of the distance alone. Half of it,
 * m_k/(m_a + m_k) with equal masses, moves the fluid. */
#ifndef SPH_WALL_REPULSIVE_H
#define SPH_WALL_REPULSIVE_H

#include "../walls.h"

static inline double sph_wall_push_repulsive(const sph_wall_place *at) {
  const double q = at->distance / at->h, c2 = at->sound_speed * at->sound_speed;
  /* at the wall and behind it as a hundredth of a spacing before it */
  const double y = fmax(at->distance, 0.01 * at->spacing);
  const double shape = q < 2.0 / 3.0 ? 2.0 / 3.0
                       : q < 1.0     ? 2.0 * q - 1.5 * q * q
                       : q < 2.0     ? 0.5 * (2.0 - q) * (2.0 - q)
                                     : 0.0;
  return 0.5 * 0.02 * c2 / y * shape;
}

static inline double sph_wall_step_repulsive(const sph_wall_place *at) {
  (void)at;
  return HUGE_VAL; /* that of the acceleration (S.15) */
}

#endif
