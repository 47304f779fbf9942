/* SPDX-License-Identifier: GPL-3.0-or-later */
/* selfDisturbance: what disturbance.h needs of the particles, and what it gives them. */
#ifndef COUPLING_WAKE_H
#define COUPLING_WAKE_H

#include "coupling_type.h"
#include "match.h"

/* Collective. spread[count][2]: variances of the kernel of each particle as located, that of its
 * weights included: the one asked for, and that of its density (cpl_smoother_shape). */
int cpl_wake_spread(cpl_t *cpl);
/* chi <= 1, the share of a particle in the solids around it: volume m3, variance of its density m2,
 * eps as it samples it. */
double cpl_wake_share(double volume, double variance, double eps);
/* The same without the particle's own volume. */
double cpl_wake_eps(double volume, double variance, double eps);
/* Local. disturbance[count][3] from the memories, at the sampled slip. */
int cpl_wake_velocity(cpl_t *cpl, const cpl_particles *particles);
/* Collective. The memories after a flow step dt: drag impulses as they stand in particle_work
 * (cpl_reaction), moved to the order of the view by match. */
int cpl_wake_remember(cpl_t *cpl, const cpl_particles *particles, cpl_match *match, double dt);

#endif
