# SPDX-License-Identifier: GPL-3.0-or-later
"""A uniform suspension in a box that is periodic all round: a lattice of free spheres, as many in every cell wherever they are,
that sinks through a fluid. The body acceleration carries the weight of all, so the momentum of the mixture stays zero, and
everything is known: with n spheres of volume V per volume and n V = 1 - eps,

    b = (1/eps - 1) (rho_s/rho - 1) g      (upward, on the fluid: eps rho b per volume)
    steady:  F = (rho_s - rho) V g         (fluid: eps rho b = n F)
    with F = beta s, s = u - v, from rest:  s = s_inf (1 - exp(-t/tau)),  1/tau = n beta (1/(eps rho) + 1/((1 - eps) rho_s))"""
import math

import numpy as np
from coupled import CELL, DIAMETER, GRAVITY, SPHERE, Log, coupled, lattice, particles, solve, times

EPS = 1 - 27 * SPHERE / CELL ** 3
FLUID, SOLID = 1000.0, 1200.0


class Suspension:
    """Closed form for a drag force F = beta s on a sphere, Stokes: beta = 3 pi mu d eps."""

    def __init__(self, mu):
        beta = 3 * math.pi * mu * DIAMETER * EPS
        n = (1 - EPS) / SPHERE
        self.slip = (SOLID - FLUID) * SPHERE * GRAVITY / beta
        self.time = 1 / (n * beta * (1 / (EPS * FLUID) + 1 / ((1 - EPS) * SOLID)))
        self.particle_time = SOLID * SPHERE / (beta / EPS)  # m/(3 pi mu d): of a sphere alone

    def at(self, t):
        """Slip at time t, from rest."""
        return -self.slip * math.expm1(-t / self.time)


def sink(path, nu, dt, steps, coupling=None, drag='stokes', start=0.0, **more):
    """Run it from this slip (m/s), momentum of the mixture zero. Returns slip u - v (upward; means over the cells and spheres), largest departure of a cell or sphere
    from these, and momentum of the mixture over rho (1 - eps) slip."""
    body = (1 / EPS - 1) * (SOLID / FLUID - 1) * GRAVITY
    v = -start * EPS * FLUID / (EPS * FLUID + (1 - EPS) * SOLID)
    spheres = dict(lattice((6, 6, 9), 0.0017, 'free'), velocity=(0, 0, v))
    case = coupled(
        path, cells=(2, 2, 3), kinds={'x': 'cyclic', 'y': 'cyclic', 'z': 'cyclic'}, g=(0, 0, -GRAVITY), body=(0, 0, body),
        insertion={'lattice': spheres}, u0=(0, 0, v + start), density=SOLID, fluid=FLUID, nu=nu, dt=dt, end=steps * dt,
        coupling=dict({'drag': drag}, **(coupling or {})), **more)
    text = solve(case)[1]
    last = times(case.path)[-1]
    u, v = case.read(last + '/U'), particles(case, last)['velocity']
    slip = u[:, 2].mean() - v[:, 2].mean()
    spread = max(np.abs(u - u.mean(axis=0)).max(), np.abs(v - v.mean(axis=0)).max())
    momentum = EPS * u[:, 2].mean() + (1 - EPS) * SOLID / FLUID * v[:, 2].mean()
    return slip, spread, momentum / ((1 - EPS) * slip), Log(text)
