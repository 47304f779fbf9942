# SPDX-License-Identifier: GPL-3.0-or-later
"""Blocks of spheres and single ones: the speed against the closed form of the porosity that the method itself deposits
(tutorials/tools/closedForms.py, pointForms.py), for a sphere its terminal speed alone. fromSharp: the same speed over that of a
block with sharp faces, which says how much of the block a resolution smears."""
import os
import re

import numpy as np

import closedForms as cf
import foamData as fd
import pointForms as pf
from run import CFD, against

WIDTH, HEIGHT, D, PITCH = 0.112, 0.256, 4e-3, 0.016 / 3
COUNT = 4410


def sharp(force):
    """Speed with the same fluid fraction, 0.779, all over the block and 1 beside it: what both methods' blocks become as they
    are resolved."""
    eps = 1 - cf.sphere(D) / PITCH ** 3
    return cf.root(lambda w: COUNT * cf.di_felice(w, D, eps) / eps - force, 1e-6, 1e2)


def exchange_length(run, n):
    """n fluid particles across the block's column; length of the kernel of the exchange."""
    h = run.points(n, WIDTH)
    with open(os.path.join(run.path, 'constant', 'sphProperties')) as source:
        length = re.search(r'\bcouplingLength\s+([-\d.e]+);', source.read())
    return h * (float(length.group(1)) if length else 2.0)


def flow(run, n, quick):
    end = 0.7 if quick else 1.2
    run.control(endTime=end)
    from_sharp = lambda speed: speed / sharp(1000.0 * cf.G * WIDTH ** 2 * HEIGHT) - 1
    if run.solver == CFD:
        run.cells(*n)
        run.control(deltaT=0.002 * 16 / n[2], writeInterval=end)
        run.solve()
        rows = fd.function_object(run.path, 'superficialVelocity')
        block = cf.Block(0.104 + PITCH * np.arange(10), D, (21 // n[0]) ** 2, (WIDTH / n[0]) ** 2, np.linspace(0, HEIGHT, n[2] + 1))
        speed = -rows[rows[:, 0] > 0.8 * end, 3].mean()
        return against(speed, cf.flow_speed(block, HEIGHT), fromSharp=from_sharp(speed))
    length = exchange_length(run, n)
    run.solve()
    table = run.fluid()
    block = pf.PointBlock(0.104 + PITCH * np.arange(10), D, 441, WIDTH ** 2, HEIGHT, length)
    speed = -table['superficial velocity'][table['Time'] > 0.8 * end, 2].mean()
    return against(speed, pf.flow_speed(block, WIDTH ** 2, HEIGHT), fromSharp=from_sharp(speed))


def settling(run, n, quick):
    """cfdDemFoam: mean speed over whole cells of 16 mm, for it goes up and down with them."""
    upper, lower, end = (0.176, 0.144, 1.2) if quick else (0.16, 0.096, 1.9)
    run.control(endTime=end, writeInterval=end)
    from_sharp = lambda speed: speed / sharp(COUNT * cf.sphere(D) * 200.0 * cf.G) - 1
    if run.solver == CFD:
        run.cells(*n)
        run.control(deltaT=0.002 * 16 / n[2])
        run.solve()
        t, v = run.speeds()
        t, v = np.append(0, t), np.append(0, v)
        z = 0.2 - np.append(0, np.cumsum((v[1:] + v[:-1]) / 2 * np.diff(t)))
        model = cf.Settling(D / 2 + PITCH * np.arange(10), D, (21 // n[0]) ** 2, (WIDTH / n[0]) ** 2,
                            np.linspace(0, HEIGHT, n[2] + 1), 1200.0)
        closed, at, _ = model.fall(0.2, 0.5)
        if z[-1] > lower:
            raise RuntimeError('the block is still at %g m at the end' % z[-1])
        way = upper - lower
        speed = way / cf.time_between(t, z, upper, lower)
        return against(speed, way / cf.time_between(closed, at, upper, lower), fromSharp=from_sharp(speed))
    length = exchange_length(run, n)
    run.solve()
    t, v = run.speeds()
    block = pf.PointBlock(0.128 + PITCH * (np.arange(10) - 4.5), D, 441, WIDTH ** 2, HEIGHT, length)
    speed = v[t > 0.8].mean()
    return against(speed, pf.settling_speed(block, 10, 200.0), fromSharp=from_sharp(speed))


def sphere(run, n, quick):
    """4 mm, two-way, without correction of the flow that its own drag makes. fromOwn: over the terminal speed at the fluid fraction
    of a cell with the sphere in it."""
    run.control(endTime=0.5 if quick else 0.8, writeInterval=1.0)
    width, height = 0.1001, 0.1212
    if run.solver == CFD:
        run.cells(n, n, round(1.2 * n))
        run.control(deltaT=0.007 / n)
    else:
        run.points(n, width)
    run.solve()
    t, v = run.speeds()
    speed, more = v[t > 0.7 * t[-1]].mean(), {}
    if run.solver == CFD:
        eps = 1 - cf.sphere(D) / ((width / n) ** 2 * height / round(1.2 * n))
        more['fromOwn'] = float(speed / cf.sphere_terminal(D, 1200.0, eps) - 1)
    return against(speed, cf.sphere_terminal(D, 1200.0, 1.0), **more)


def sps(run, ratio, quick):
    """Water, Stokes' law, with that correction; ratio: h/d."""
    value = run.settings('water', 'stokes', ratio)
    run.take(value, 'constant/couplingProperties', drag='law', bandwidth='bandwidth')
    run.take(value, 'constant/demProperties', insertion__sphere__origin='origin', insertion__sphere__velocity='velocity')
    run.take(value, 'constant/sphProperties', spacing='spacing', smoothingLength='smoothingLength', soundSpeed='soundSpeed',
             backgroundPressure='backgroundPressure')
    run.solve()
    t, v = run.speeds()
    return against(v[t > 0.5 * t[-1]].mean(), -float(value['velocity'].strip('()').split()[2]))
