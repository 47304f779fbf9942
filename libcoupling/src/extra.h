/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Forces beside drag, pressure and stress: lift, and virtual mass (virtual_mass.h). They are known
 * when the particles are advanced, and what the fluid gets back is exactly their sum: particle by
 * particle, not shared as drag is.
 */
#ifndef COUPLING_EXTRA_H
#define COUPLING_EXTRA_H

#include "coupling_type.h"

int cpl_uses_curl(const cpl_params *params);  /* some force or torque needs curl u */
int cpl_uses_extra(const cpl_params *params); /* some force is extra */

/* Local. After the drag of cpl_fluid_force: adds to Su, fills CPL_FORCE_EXTRA and the turning drag.
 */
int cpl_extra_forces(cpl_t *cpl, cpl_particles *particles);

#endif
