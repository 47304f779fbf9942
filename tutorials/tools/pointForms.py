# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed forms for layers of equal spheres across a column whose fluid is smoothed particles (doc/equations.md, DEM-SPH).

The porosity is that of P.3 with the kernel's mean over each sphere (P.1), averaged over the section, so everything depends on
the height alone: eps(z), what a sphere of each layer samples of it and of the velocity, the balance of forces of the form
`combined` (P.7). Wendland C2; the layers are far from the ends of the column. SI units.
"""
import os
import re

import numpy as np

from closedForms import G, di_felice, root, sphere


def kernel(length, diameter, n=4001):
    """(z, K): mean over a sphere of the kernel, integrated over a section, 1/m."""
    radius = diameter / 2
    z = np.linspace(-2 * length - radius, 2 * length + radius, n)
    step = z[1] - z[0]
    q = np.abs(z) / length
    s = np.linspace(0, 2, 4001)
    shell = 2 * np.pi * s * 21 / (16 * np.pi) * (1 - s / 2) ** 4 * (2 * s + 1)  # 2 pi s W ds
    beyond = np.concatenate((np.cumsum(((shell[1:] + shell[:-1]) / 2 * (s[1] - s[0]))[::-1])[::-1], [0]))
    flat = np.interp(q, s, beyond, right=0) / length
    ball = np.clip(radius ** 2 - z ** 2, 0, None)
    both = np.convolve(flat, ball / (ball.sum() * step), 'same') * step
    return z, both / (both.sum() * step)


class PointBlock:
    """layers: heights of the layers; per_layer: spheres of each; area: of the column; length: coupling length h_c; rho, mu: of the fluid."""

    def __init__(self, layers, diameter, per_layer, area, height, length, n=4096, rho=1000.0, mu=1e-3):
        self.d, self.n, self.rho, self.mu = diameter, per_layer, rho, mu
        self.z = (np.arange(n) + 0.5) * height / n
        z, k = kernel(length, diameter)
        away = (self.z[None, :] - np.asarray(layers)[:, None] + height / 2) % height - height / 2
        weights = np.interp(away, z, k, left=0, right=0)
        weights /= weights.sum(1)[:, None]
        self.eps = 1 - per_layer * sphere(diameter) / area * weights.sum(0) * n / height
        self.weights = weights  # [layers][n] share of a sphere at each height
        self.eps_layer = weights @ self.eps
        self.slip_layer = weights @ (1 / self.eps)  # u_i over the superficial velocity

    def layer_forces(self, w):
        """Sum of beta/eps (u - v) over the spheres of each layer at the superficial slip w, N."""
        return self.n * di_felice(w * self.slip_layer * self.eps_layer, self.d, self.eps_layer, self.rho, self.mu) / self.eps_layer

    def force(self, w):
        return self.layer_forces(w).sum()

    def force_below(self, heights, w):
        """Of that, what the fluid gets below each of the heights, N: over the area, the pressure at a height is this less than
        beneath the block."""
        return np.interp(heights, self.z, np.cumsum(self.layer_forces(w) @ self.weights))


def flow_speed(block, area, height, rho=1000.0):
    """Superficial velocity of the flow that gravity drives through the fixed block in a periodic column."""
    return root(lambda w: block.force(w) - rho * G * area * height, 1e-4, 10.0)


def settling_speed(block, layers, excess):
    """Speed of the block in a closed column; excess: density of the spheres over that of the fluid, kg/m3."""
    weight = layers * block.n * sphere(block.d) * excess * G
    return root(lambda w: block.force(w) - weight, 1e-5, 10.0)


def fluid_fraction(length, diameter, n=81):
    """eps_i of one sphere in an unbounded fluid, two-way: the sphere's own volume, spread by the kernel's mean over it and seen
    through the same (P.3, P.5). Integrals over a cube of n^3 points."""
    reach = 2 * length + diameter / 2
    x = np.linspace(-reach, reach, n)
    r = np.sqrt(x[:, None, None] ** 2 + x[None, :, None] ** 2 + x[None, None, :] ** 2)
    z, flat = kernel(length, diameter)
    half = z >= 0
    density = np.gradient(flat[half], z[half])          # K(r) = -(d flat/dr)/(2 pi r): flat is K integrated over a plane
    weight = np.interp(r, z[half][1:], -density[1:] / (2 * np.pi * z[half][1:]), right=0)
    step = (x[1] - x[0]) ** 3
    weight /= weight.sum() * step
    return 1 - sphere(diameter) * (weight ** 2).sum() * step


def entries_of(case):
    """{name: value} of the numbers in constant/sphProperties."""
    with open(os.path.join(case, 'constant', 'sphProperties')) as source:
        return {name: float(value) for name, value in re.findall(r'(\w+)\s+(-?[\d.][-+.\deE]*)\s*;', source.read())}


def coupling_length(case):
    """Length of the exchange's kernel, m (P.1)."""
    entries = entries_of(case)
    return entries.get('couplingLength', 2) * entries['smoothingLength']
