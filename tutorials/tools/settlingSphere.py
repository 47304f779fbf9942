# SPDX-License-Identifier: GPL-3.0-or-later
"""One sphere that settles in a periodic box, two-way coupled: its closed form. SI units.

Alone in an unbounded fluid it falls at the terminal speed of its drag law. In a box its images, each with the force of
the sphere, move the fluid too (Hasimoto's effect; here with the kernel of the exchange): the closed form is the terminal
speed plus what all images have done to the fluid since the sphere began to sink, linear (Oseen), from the Fourier series
of the box, less the same of the sphere alone. The forces of the box add up to none: the wall at its bottom carries them,
and the mean flow is zero. The end of it, long after, is periodic_response less free_response."""
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


def box_response(lengths, s2, nu, speed, force, start, t):
    """Velocity at the place of a force that began at the height start at t = 0, in fluid at rest, and has sunk with speed since; kernel
    of total variance s2 per axis. Box periodic in x and y, walls that slip in z: linear, modes u_z ~ cos(kx x) cos(ky y) sin(kz z)."""
    width = 2 * math.pi * math.sqrt(s2)
    across = [2 * math.pi / l * np.arange(-int(6 * l / width) - 1, int(6 * l / width) + 2) for l in lengths[:2]]
    kz = math.pi / lengths[2] * np.arange(1, int(12 * lengths[2] / width) + 2)
    k = np.meshgrid(*across, kz, indexing='ij')
    k2 = sum(a ** 2 for a in k)
    z = start - speed * t
    # integral of exp(-nu k2 (t - s)) sin(kz z(s)) over s from 0 to t
    grown = (np.exp(1j * k[2] * z) - np.exp(1j * k[2] * start - nu * k2 * t)) / (nu * k2 - 1j * k[2] * speed)
    terms = (1 - k[2] ** 2 / k2) * np.exp(-k2 * s2 / 2) * grown.imag * np.sin(k[2] * z)
    return 2 * force * terms.sum() / np.prod(lengths)


def own_response(s2, nu, speed, force, t):
    """The same in an unbounded fluid: C.17 of doc/equations.md, midpoint rule in the root of the age."""
    n = 4000
    root_age = (np.arange(n) + 0.5) * math.sqrt(t) / n
    age = root_age ** 2
    x = speed * age / np.sqrt(s2 + 2 * nu * age)
    m = np.sqrt(2 / math.pi) * (x ** 3 / 3 - x ** 5 / 10)
    big = x > 1e-2
    m[big] = [math.erf(a / math.sqrt(2)) - math.sqrt(2 / math.pi) * a * math.exp(-a * a / 2) for a in x[big]]
    return force * np.sum(m / (2 * math.pi * (speed * age) ** 3) * 2 * root_age) * math.sqrt(t) / n


def with_images(lengths, bandwidth, edge, start, times, fluid, nu, d=DIAMETER, density=DENSITY):
    """Mean speed at these times in a box of these lengths, of a sphere that its drag holds up from t = 0 on, at the height start, with its
    terminal speed; kernel exp(-r^2/b^2) with b the larger of bandwidth (m) and 1.5 cells of this edge."""
    v, weight = terminal(fluid, nu, d, density)
    s2 = max(bandwidth, 1.5 * edge) ** 2  # deposit and sample: twice b^2/2
    return v + np.mean([box_response(lengths, s2, nu, v, weight, start, t) - own_response(s2, nu, v, weight, t) for t in times])
