# SPDX-License-Identifier: GPL-3.0-or-later
"""One sphere that settles in a periodic box, two-way coupled: the case. Its closed form, the terminal speed plus what its
images do, is in tutorials/tools/settlingSphere.py."""
import os
import sys

import numpy as np
from coupled import GRAVITY, HERE, Log, coupled, solve

sys.path.insert(0, os.path.join(HERE, '..', '..', '..', 'tutorials', 'tools'))
from settlingSphere import DENSITY, DIAMETER, FLUIDS, terminal, with_images  # noqa: E402


def settle(path, fluid, ratio, *, coupling, width, bandwidth=None, travel=None, ranks=1, place=(0.31, 0.17), tetrahedra=False, **more):
    """Sphere of d in cells of ratio d, periodic sections of width d, twice as high, walls at the ends. Returns measured
    speeds over the last 2 cells or diameters; terminal speed; speed with the images. fluid: a name in FLUIDS, or its
    density and viscosity, {'fluid': kg/m3, 'nu': m2/s}."""
    properties = fluid if isinstance(fluid, dict) else FLUIDS[fluid]
    h = ratio * DIAMETER
    v = terminal(**properties)[0]
    edge = h * (6 ** (1 / 3) if tetrahedra else 1)  # six of a cube
    n = max(4 if tetrahedra else 8, round(width * DIAMETER / edge))
    lengths = (n * edge, n * edge, 2 * n * edge)
    travel = travel or max(6 * h, 6 * DIAMETER)
    start = (lengths[0] / 2 + place[0] * h, lengths[1] / 2 + place[1] * h, lengths[2] / 2 + travel / 2, DIAMETER, 0, 0, -v)
    entries = dict({'twoWay': True, 'minimumEps': 0.001}, **coupling)
    if bandwidth:
        entries['bandwidth'] = bandwidth
    case = coupled(
        path, cells=(n, n, 2 * n), hi=lengths, kinds={'x': 'cyclic', 'y': 'cyclic', 'z': 'wall'}, spheres=[start],
        density=DENSITY, g=(0, 0, -GRAVITY), coupling=entries, dt=0.05 * min(h, 2 * DIAMETER) / v, end=travel / v,
        predictor=True, correctors=4 if tetrahedra else 2, nonorth=int(tetrahedra), tolerance=1e-9,
        mesh=('--kind', 'tet') if tetrahedra else None, contact={'normalStiffness': 1e-2}, **properties, **more)
    window = max(2 * h, 2 * DIAMETER)
    times = (travel - window * np.linspace(0, 1, 9)) / v
    log = Log(solve(case, ranks=ranks, timeout=3000)[1])
    speed = np.array(log.speed)
    way = np.cumsum(speed * np.array(log.dt))
    last = speed[way > way[-1] - window]
    return last, v, with_images(lengths, (bandwidth or 6) * DIAMETER, h, start[2], times, **properties)
