# SPDX-License-Identifier: GPL-3.0-or-later
"""Exact solutions of the locally averaged equations that the momentum tests compare with. SI units."""
from math import exp, log10, pi, sqrt

import numpy as np


def di_felice(w, d, eps, nu):
    """Drag on one sphere per fluid density, m4/s2: Di Felice (1994), with Dalla Valle's coefficient;
    w = eps |u - v|, the superficial slip."""
    re = w * d / nu
    xi = 3.7 - 0.65 * exp(-(1.5 - log10(re)) ** 2 / 2)
    return pi / 8 * (0.63 + 4.8 / sqrt(re)) ** 2 * d * d * w * w * eps ** -xi


def bisect(rising, lo, hi):
    """Root of a function that rises from below to above zero on (lo, hi), lo > 0."""
    for _ in range(200):
        mid = sqrt(lo * hi)
        lo, hi = (mid, hi) if rising(mid) < 0 else (lo, mid)
    return lo


def porous_block_flow(layers, height, cell_volume, length, d, nu, g=9.81):
    """Superficial velocity of a periodic column with layers[k] fixed spheres in the k-th whole-section
    cell of the block (Markauskas et al., flow through a porous block).

    U is uniform; the pressure jumps where the porosity does cancel around the period, so the driving force
    g length balances the sum over the cells of height (n F(U, eps)/V)/eps: drag per mixture volume over eps."""
    sphere = pi / 6 * d ** 3

    def balance(u):
        drag = 0.0
        for n in layers:
            eps = 1 - n * sphere / cell_volume
            drag += height * n * di_felice(u, d, eps, nu) / cell_volume / eps
        return drag - g * length
    return bisect(balance, 1e-9, 1e2)


def brinkman_layer(y, height, layer, eps, drag, nu, force):
    """Interstitial velocity u(y) along a porous layer 0 < y < layer under a free channel up to height,
    no slip at both walls, body acceleration force.

        layer:    eps force - drag eps u + (eps nu u')' = 0      drag: on the fluid -D U = -D eps u
        channel:      force              + nu u''       = 0
    u and eps nu u' (the shear stress on the mixture's fluid part) are continuous where the porosity jumps."""
    decay = sqrt(drag / nu)
    plateau = force / drag
    # u = plateau + a cosh + b sinh (layer), c + s (y - layer) - force/(2 nu) (y - layer)^2 (channel)
    h, t = decay * layer, height - layer
    rows = np.array([
        [1, 0, 0, 0],                                                        # u(0) = 0
        [np.cosh(h), np.sinh(h), -1, 0],                                     # u continuous
        [eps * decay * np.sinh(h), eps * decay * np.cosh(h), 0, -1],         # stress continuous
        [0, 0, 1, t]])                                                       # u(height) = 0
    a, b, c, s = np.linalg.solve(rows, [-plateau, -plateau, 0, force * t * t / (2 * nu)])
    inside = plateau + a * np.cosh(decay * y) + b * np.sinh(decay * y)
    free = c + s * (y - layer) - force / (2 * nu) * (y - layer) ** 2
    return np.where(y < layer, inside, free)
