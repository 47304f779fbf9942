/* SPDX-License-Identifier: GPL-3.0-or-later */
/* S.25: Gao and Sun (2011), eq. 4 for a particle and a wall, whose mass is infinite; damping by the
 * coefficient of restitution (eq. 10-11), which gives lambda/2 = -ln(e) sqrt(k/m)/sqrt(pi^2 +
 * ln(e)^2). */
#ifndef SPH_WALL_SPRING_H
#define SPH_WALL_SPRING_H

#include "../walls.h"

static inline double sph_wall_damping(const sph_wall_place *at) { /* lambda/2, 1/s */
  const double pi = 3.14159265358979323846, loss = -log(at->wall->restitution);
  return loss * sqrt(at->wall->stiffness / at->mass / (pi * pi + loss * loss));
}

static inline double sph_wall_push_spring(const sph_wall_place *at) {
  const double overlap = 0.5 * at->spacing - at->distance;
  if (overlap <= 0.0)
    return 0.0;
  return at->wall->stiffness / at->mass * overlap - 2.0 * sph_wall_damping(at) * at->leaving;
}

/* A fiftieth of the duration of a contact, as the paper has it. */
static inline double sph_wall_step_spring(const sph_wall_place *at) {
  const double pi = 3.14159265358979323846, half = sph_wall_damping(at);
  return 0.02 * pi / sqrt(at->wall->stiffness / at->mass - half * half);
}

#endif
