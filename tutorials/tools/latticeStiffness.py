#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Stiffness in shear of a lattice of fluid particles under pressure. latticeStiffness.py prints a table.

A fluid has none. A simple cubic lattice with the forces of S.7 (doc/equations.md) at the uniform pressure p has: displaced by e cos(k.x), a
particle is pulled back, per volume, by

  p sum_b 2 V e.H(x_ab).e (1 - cos k.x_ab),      H the second derivatives of W

and that is k^2 G, with the modulus G along the lattice (k and e along its axes) and another across it (k along [1 1 0], e along [1 -1 0]). In the limit of many
neighbours both are 0. Where displacements stay below the spacing and grow as exp(n t), the fluid has the viscosity mu + G/n, G the mean of the two: a flow with a vertical and a
horizontal part shears both ways. G < 0: the lattice buckles, and the flow is faster."""
import numpy as np


def _cubic(q):
    return np.where(q < 1, -3 * q + 2.25 * q * q, -0.75 * np.clip(2 - q, 0, None) ** 2) / np.pi


def _quintic(q):
    power = [np.clip(s - q, 0, None) ** 4 for s in (3, 2, 1)]
    return -5 * (power[0] - 6 * power[1] + 15 * power[2]) / (120 * np.pi)


def _wendland_c2(q):
    s = np.clip(q / 2, 0, 1)
    return -10 * s * (1 - s) ** 3 * 21 / (16 * np.pi)


def _wendland_c4(q):
    s = np.clip(q / 2, 0, 1)
    return -28 / 3 * s * (5 * s + 1) * (1 - s) ** 5 * 495 / (256 * np.pi)


# dW/dq for h = 1, support over h, variance per axis over h^2
KERNELS = {'cubicSpline': (_cubic, 2, 0.3), 'quinticSpline': (_quintic, 3, 7 / 15),
           'wendlandC2': (_wendland_c2, 2, 4 / 15), 'wendlandC4': (_wendland_c4, 2, 8 / 39)}


def modulus(kernel, h, across=False, wavelength=28):
    """G/p of a kernel with h spacings, for waves of so many spacings."""
    slope, reach, _ = KERNELS[kernel]
    m = int(np.ceil(reach * h))
    x = np.array([(i, j, k) for i in range(-m, m + 1) for j in range(-m, m + 1) for k in range(-m, m + 1) if i or j or k], float)
    r = np.linalg.norm(x, axis=1)
    x, r = x[r < reach * h], r[r < reach * h]
    first = slope(r / h) / h ** 4
    small = 1e-5
    second = (slope(r / h + small) - slope(r / h - small)) / (2 * small) / h ** 5
    direction = np.array([1, 1, 0]) / np.sqrt(2) if across else np.array([1, 0, 0])
    e = np.array([1, -1, 0]) / np.sqrt(2) if across else np.array([0, 0, 1])
    along, k = (x @ e / r) ** 2, 2 * np.pi / wavelength
    return 2 * ((second * along + first / r * (1 - along)) * (1 - np.cos(k * x @ direction))).sum() / k ** 2


def main():
    print('kernel          h/dx   neighbours   G/p along    across      mean')
    for name, (_, reach, _) in KERNELS.items():
        for h in (1.2, 1.35, 1.5, 1.75, 2, 2.25, 2.5, 3):
            g = modulus(name, h), modulus(name, h, True)
            print('%-14s %5.2f %10.0f %13.5f %10.5f %10.5f' % (name, h, 4 / 3 * np.pi * (reach * h) ** 3, *g, sum(g) / 2))


if __name__ == '__main__':
    main()
