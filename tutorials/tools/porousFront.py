#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""porousFront.py: what flows through a bed of smoothed particles' fluid over what flows to it, less one, when the divergence is that of a velocity
smoothed by the kernel (Wendland C2, length h) and the porosity falls from 1 to eps over a front as wide as the same kernel of length h_c (doc/equations.md, S.27).

Along the flow, integrals in place of sums: W * du/dx = -u d ln E/dx for the E that the density follows, solved for u by u += (right side - W * u)/2.
E = eps: S.4 alone. E = 1/(W * 1/eps): S.27. d ln E = -eps d(W * 1/eps): for which u = 1/eps at every place; it depends on the way, so no function of the place keeps it."""
import numpy as np

STEP = 0.004  # of h
X = (np.arange(4000) + 0.5) * STEP - 8.0


def plane(length):
    """Kernel integrated over planes, at STEP, sum 1."""
    r = np.linspace(0, 2, 2001)
    shell = r * (1 - r / 2) ** 4 * (2 * r + 1)
    beyond = np.concatenate((np.cumsum(((shell[1:] + shell[:-1]))[::-1])[::-1], [0]))
    reach = int(2 * length / STEP) + 1
    k = np.interp(np.abs(np.arange(-reach, reach + 1)) * STEP / length, r, beyond, right=0)
    return k / k.sum()


def smooth(f, k):
    return np.convolve(np.pad(f, len(k) // 2, mode='edge'), k, 'valid')


def flow(low, length, scheme):
    w = plane(1.0)
    eps = 1 - (1 - low) * smooth((X > 0).astype(float), plane(length))
    g = smooth(1 / eps, w)
    rise = {'S.4': -np.diff(np.log(eps)), 'S.27': np.diff(np.log(g)), 'way': (eps[1:] + eps[:-1]) / 2 * np.diff(g)}[scheme]
    u = 1 / eps
    for _ in range(400):
        right = 1 + np.concatenate(([0], np.cumsum((u[1:] + u[:-1]) / 2 * rise)))
        u = u + 0.5 * (right - smooth(u, w))
    return u[-1] * low - 1


print('%6s %6s %10s %10s %10s' % ('eps', 'h_c/h', 'S.4', 'S.27', 'by way'))
for low in (0.8, 0.65, 0.5, 0.4):
    for length in (1.0, 1.5, 2.0):
        print('%6g %6g' % (low, length) + ''.join(' %+9.2f%%' % (100 * flow(low, length, s)) for s in ('S.4', 'S.27', 'way')))
