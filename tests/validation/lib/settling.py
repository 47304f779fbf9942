# SPDX-License-Identifier: GPL-3.0-or-later
"""One sphere that settles in a periodic box, two-way coupled: the case, and its closed form.

Alone in an unbounded fluid it falls at the terminal speed of its drag law. In a box its images, each with the force of
the sphere, move the fluid too (Hasimoto's effect; here with the kernel of the exchange): the closed form is the terminal
speed plus the sum over all images of the Oseen solution, from the Fourier series of the box. The forces of the box add
up to none: the wall at its bottom carries them, and the mean flow is zero."""
import math

import numpy as np
from closed_forms import bisect, di_felice
from coupled import GRAVITY, Log, coupled, solve

# Robinson et al. (2014), section 5: spheres of 0.1 mm and 2500 kg/m3 in water and in water-glycerol
DIAMETER, DENSITY = 1e-4, 2500.0
FLUIDS = {'water': dict(fluid=1000.0, nu=1e-6), 'glycerol': dict(fluid=1150.0, nu=8.9e-3 / 1150)}


def terminal(fluid, nu):
    """Speed (m/s) and buoyant weight per fluid density (m4/s2)."""
    weight = (DENSITY - fluid) / fluid * math.pi / 6 * DIAMETER ** 3 * GRAVITY
    return bisect(lambda v: di_felice(v, DIAMETER, 1.0, nu) - weight, 1e-9, 10.0), weight


def periodic_response(lengths, s2, nu, speed, force):
    """Velocity at the place of a force that repeats with the box, kernel of total variance s2 per axis: steady Oseen."""
    n = [int(6 * l / (2 * math.pi * math.sqrt(s2))) + 1 for l in lengths]
    k = np.meshgrid(*(2 * math.pi / l * np.arange(-m, m + 1) for l, m in zip(lengths, n)), indexing='ij')
    k2 = sum(a ** 2 for a in k)
    k2[tuple(n)] = 1
    terms = (1 - k[2] ** 2 / k2) * np.exp(-k2 * s2 / 2) / (nu * k2 + 1j * k[2] * speed)
    terms[tuple(n)] = 0
    return force * terms.sum().real / np.prod(lengths)


def free_response(s2, nu, speed, force):
    """The same for one force in an unbounded fluid: integral over wave numbers, the angle in closed form."""
    k = (np.arange(200000) + 0.5) / 200000 * 9 / math.sqrt(s2)
    a = np.maximum(speed / (nu * k), 1e-4)
    angle = np.where(a < 1e-2, 4 / 3 - 4 * a ** 2 / 15, 2 * ((1 + 1 / a ** 2) * np.arctan(a) / a - 1 / a ** 2))
    return force / nu / (4 * math.pi ** 2) * np.sum(np.exp(-k ** 2 * s2 / 2) * angle) * (k[1] - k[0])


def settle(path, fluid, ratio, *, coupling, width, bandwidth=None, travel=None, ranks=1, place=(0.31, 0.17), mesh=None, **more):
    """Sphere of d in cells of ratio d, periodic sections of width d, twice as high, walls at the ends. Returns measured
    speeds over the last 2 cells or diameters; terminal speed; speed with the images."""
    properties = FLUIDS[fluid]
    h = ratio * DIAMETER
    v, weight = terminal(**properties)
    n = max(8, round(width / ratio))
    lengths = (n * h, n * h, 2 * n * h)
    travel = travel or max(6 * h, 6 * DIAMETER)
    start = (lengths[0] / 2 + place[0] * h, lengths[1] / 2 + place[1] * h, lengths[2] / 2 + travel / 2, DIAMETER, 0, 0, -v)
    entries = dict({'twoWay': True, 'minimumEps': 0.001}, **coupling)
    if bandwidth:
        entries['bandwidth'] = bandwidth
    case = coupled(
        path, cells=(n, n, 2 * n), hi=lengths, kinds={'x': 'cyclic', 'y': 'cyclic', 'z': 'wall'}, spheres=[start],
        density=DENSITY, g=(0, 0, -GRAVITY), coupling=entries, dt=0.05 * min(h, 2 * DIAMETER) / v, end=travel / v,
        predictor=True, correctors=2, tolerance=1e-9, mesh=mesh, contact={'normalStiffness': 1e-2}, **properties, **more)
    log = Log(solve(case, ranks=ranks, timeout=3000)[1])
    speed = np.array(log.speed)
    way = np.cumsum(speed * np.array(log.dt))
    last = speed[way > way[-1] - max(2 * h, 2 * DIAMETER)]
    s2 = max((bandwidth or 6) * DIAMETER, 1.5 * h) ** 2
    images = periodic_response(lengths, s2, properties['nu'], v, weight) - free_response(s2, properties['nu'], v, weight)
    return last, v, v + images
