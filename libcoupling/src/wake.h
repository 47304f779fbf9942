/* SPDX-License-Identifier: GPL-3.0-or-later */
/* selfDisturbance: what disturbance.h needs of the particles, and what it gives them. */
#ifndef COUPLING_WAKE_H
#define COUPLING_WAKE_H

#include "coupling_type.h"
#include "match.h"

/* Collective. spread[count]: variance of the kernel of each particle as located, that of its
 * weights included. */
int cpl_wake_spread(cpl_t *cpl);
/* Local. disturbance[count][3] from the memories, at the sampled slip. */
int cpl_wake_velocity(cpl_t *cpl, const cpl_particles *particles);
/* Collective. The memories after a flow step dt: drag impulses as they stand in particle_work
 * (cpl_reaction), moved to the order of the view by match. */
int cpl_wake_remember(cpl_t *cpl, const cpl_particles *particles, cpl_match *match, double dt);

#endif
