# SPDX-License-Identifier: GPL-3.0-or-later
"""One sphere that settles in a periodic box, two-way coupled: its closed form. SI units.

Alone in an unbounded fluid it falls at the terminal speed of its drag law. In a box its images, each with the force of
the sphere, move the fluid too (Hasimoto's effect; here with the kernel of the exchange): the closed form is the terminal
speed plus the sum over all images of the Oseen solution, from the Fourier series of the box. The forces of the box add
up to none: the wall at its bottom carries them, and the mean flow is zero."""
import math

import numpy as np
from closedForms import G, di_felice, root, sphere

# Robinson et al. (2014), section 5: spheres of 0.1 mm and 2500 kg/m3 in water and in water-glycerol
DIAMETER, DENSITY = 1e-4, 2500.0
FLUIDS = {'water': dict(fluid=1000.0, nu=1e-6), 'glycerol': dict(fluid=1150.0, nu=8.9e-3 / 1150)}


def terminal(fluid, nu, d=DIAMETER, density=DENSITY):
    """Speed (m/s) and buoyant weight per fluid density (m4/s2), Di Felice's drag (one sphere)."""
    weight = (density - fluid) * sphere(d) * G
    return root(lambda v: di_felice(v, d, 1.0, fluid, fluid * nu) - weight, 1e-15, 10.0), weight / fluid


def periodic_response(lengths, s2, nu, speed, force):
    """Velocity at the place of a force that repeats with the box, kernel of total variance s2 per axis: steady Oseen."""
    n = [int(6 * l / (2 * math.pi * math.sqrt(s2))) + 1 for l in lengths]
    k = np.meshgrid(*(2 * math.pi / l * np.arange(-m, m + 1) for l, m in zip(lengths, n)), indexing='ij')
    k2 = sum(a ** 2 for a in k)
    k2[tuple(n)] = 1
    terms = (1 - k[2] ** 2 / k2) * np.exp(-k2 * s2 / 2) / (nu * k2 + 1j * k[2] * speed)
    terms[tuple(n)] = 0
    return force * terms.sum().real / np.prod(lengths)


def mirrored_response(lengths, s2, nu, speed, force, z):
    """The same for a box with walls that slip below and above, the force at the height z: mirrored, it points the other way."""
    n = [int(6 * l / (2 * math.pi * math.sqrt(s2))) + 1 for l in (lengths[0], lengths[1], 2 * lengths[2])]
    k = np.meshgrid(*(2 * math.pi / l * np.arange(-m, m + 1) for l, m in zip((lengths[0], lengths[1], 2 * lengths[2]), n)), indexing='ij')
    k2 = sum(a ** 2 for a in k)
    k2[tuple(n)] = 1
    terms = (1 - k[2] ** 2 / k2) * np.exp(-k2 * s2 / 2) / (nu * k2 + 1j * k[2] * speed) * (1 - np.cos(2 * k[2] * z))
    terms[tuple(n)] = 0
    return force * terms.sum().real / (2 * np.prod(lengths))


def free_response(s2, nu, speed, force):
    """The same for one force in an unbounded fluid: integral over wave numbers, the angle in closed form."""
    k = (np.arange(200000) + 0.5) / 200000 * 9 / math.sqrt(s2)
    a = np.maximum(speed / (nu * k), 1e-4)
    angle = np.where(a < 1e-2, 4 / 3 - 4 * a ** 2 / 15, 2 * ((1 + 1 / a ** 2) * np.arctan(a) / a - 1 / a ** 2))
    return force / nu / (4 * math.pi ** 2) * np.sum(np.exp(-k ** 2 * s2 / 2) * angle) * (k[1] - k[0])


def with_images(lengths, bandwidth, edge, fluid, nu, d=DIAMETER, density=DENSITY):
    """Speed in a box of these lengths, kernel exp(-r^2/b^2) with b the larger of bandwidth (m) and 1.5 cells of this edge."""
    v, weight = terminal(fluid, nu, d, density)
    s2 = max(bandwidth, 1.5 * edge) ** 2  # deposit and sample: twice b^2/2
    return v + periodic_response(lengths, s2, nu, v, weight) - free_response(s2, nu, v, weight)
