/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Virtual mass (doc/equations.md C.20): F = m_a (Du/Dt - dv/dt), m_a = C_a rho_f V.
 *
 * -m_a dv/dt is not a force on the particle: whoever moves it does so with the inertia m + m_a, and
 * inverse_mass of the view says so. What it received from the fluid is then the impulse of the view
 * less m_a dv, with dv all that changed its velocity from the end of the last advance to that of
 * this one, contacts and the kick between them included. */
#ifndef COUPLING_VIRTUAL_MASS_H
#define COUPLING_VIRTUAL_MASS_H

#include "coupling_type.h"

/* Local. After the other forces of cpl_fluid_force: adds m_a Du/Dt to Su and CPL_FORCE_EXTRA.
 * ERR_NUMERIC. */
int cpl_virtual_force(cpl_t *cpl, cpl_particles *particles);

/* Impulse that particle i of the view received from the fluid since the last advance, N s, and
 * m_a dv of it (may be NULL). */
void cpl_received(const cpl_t *cpl, const cpl_particles *particles, int i, double impulse[3],
                  double added[3]);

#endif
