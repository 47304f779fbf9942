# SPDX-License-Identifier: GPL-3.0-or-later
"""The scenes that the parallel, restart, budget and output tests share: small, but with everything in them that a
rank boundary or a restart can break."""
from coupled import CELL, GRAVITY, coupled, floor, lattice

CLOSED = {'x': 'cyclic', 'y': 'cyclic', 'z': 'wall'}


def fixed(path, **more):
    """Flow driven through a fixed block: 3 x 3 x 16 cells, 9 x 9 x 10 spheres, layers over 3 1/3 cells."""
    return coupled(path, insertion={'block': lattice((9, 9, 10), bottom=6 * CELL)},
                   **dict({'body': (0, 0, -GRAVITY), 'dt': 1e-3, 'end': 0.02}, **more))


def tets(path, **more):
    """Fixed and free spheres on tetrahedra: faces that are not orthogonal, at rank boundaries too."""
    return coupled(path, cells=(2, 2, 4), mesh=['--kind', 'tet'], nonorth=2, spheres=[(0.01, 0.012, 0.05, 0.004, 0, 0, -0.1)],
                   insertion={'block': lattice((6, 6, 4), bottom=0.014)}, g=(0, 0, -GRAVITY), body=(0, 0, -GRAVITY),
                   **dict({'dt': 1e-3, 'end': 0.02}, **more))


def settling(path, **more):
    """A rigid block that falls in a closed column, across cells (and across the borders of ranks)."""
    return coupled(path, kinds=CLOSED, insertion={'block': lattice((9, 9, 10), bottom=0.165, kind='block')},
                   g=(0, 0, -GRAVITY), walls=floor(),
                   **dict({'dt': 2e-3, 'end': 0.04}, **more))


def rows():
    """24 spheres of unequal size, thrown at each other and over the periodic sides, in the middle of the column."""
    found = []
    for n in range(24):
        i, j, k = n % 3, n // 3 % 2, n // 6
        x = (0.004 + 0.0145 * i + 0.0007 * k, 0.009 + 0.0215 * j + 0.0011 * i, 0.040 + 0.0062 * k + 0.0004 * j)
        v = (0.3 * (1 - i), 0.2 * (1 - 2 * j), 0.25 * (1.5 - k))
        found.append((*x, 0.004 + 0.0005 * (n % 4), *v))
    return found


def free(path, **more):
    """Free spheres with contacts and friction, crossing periodic sides, in water that they move."""
    return coupled(path, cells=(3, 3, 6), kinds=CLOSED, g=(0, 0, -GRAVITY), walls=floor(), density=2500.0, spheres=rows(),
                   **dict({'dt': 1e-3, 'end': 0.03, 'contact': {'normalStiffness': 200.0, 'friction': 0.3}}, **more))


def smooth(path, coupling=None, **more):
    """The free spheres with everything exchanged through a smooth kernel, without their own disturbance, with lift,
    torque and virtual mass of the fluid."""
    words = {'smoothing': 'diffusion', 'bandwidth': 2.0, 'selfDisturbance': True, 'saffmanLift': True, 'magnusLift': True,
             'rotationalDrag': True, 'virtualMass': (coupling or {}).get('model') != 'B'}  # B refuses it
    return free(path, coupling=dict(words, **(coupling or {})), **more)


def resolved(path, coupling=None, **more):
    """That without drag on what the kernel does not resolve."""
    words = {'unresolvedDrag': False}
    return smooth(path, coupling=dict(words, **(coupling or {})), **more)


def overfull(path, coupling=None, **more):
    """The free spheres with so much room asked for that every cell with one has to give some of it away."""
    return free(path, coupling=dict({'minimumEps': 0.99}, **(coupling or {})), **more)


SCENES = {'fixed': fixed, 'settling': settling, 'free': free, 'tets': tets, 'smooth': smooth, 'resolved': resolved, 'overfull': overfull}
