# SPDX-License-Identifier: GPL-3.0-or-later
"""Fluid without solids, or with some that stand still, measured as the tutorials' plots do; on a mesh with the cells in place of the
particles. cfdDemFoam runs these cases as they are, without constant/demProperties."""
import os

import numpy as np

import foamData as fd
from run import CFD, script


def poiseuille(run, n, quick):
    """n across, quintic spline: the cubic one keeps an error that no refinement takes away. Largest of the three times of the
    rms difference to the series over its peak. cfdDemFoam: steps with the square of the cells, for time is first order."""
    plot = script(run.tutorial)
    if run.solver == CFD:
        run.cells(4, n, 1)
        run.control(deltaT=0.3e-3 * (8 / n) ** 2)
        run.solve()
        y = (np.arange(n) + 0.5) / n * plot.WIDTH
        errors = [mesh_error(plot, run.path, t, y, n) for t in plot.TIMES]
    else:
        run.points(n, plot.WIDTH)
        run.set('constant/sphProperties', 'kernel', 'quinticSpline')
        run.solve()
        errors = [plot.error(run.path, t) for t in plot.TIMES]
    return dict(error=float(max(errors)), others=[float(e) for e in errors])


def mesh_error(plot, path, t, y, n):
    name = next(name for name in fd.times(path) if abs(float(name) - t) < 1e-9)
    u = fd.column(os.path.join(path, name, 'U'), (4, n, 1))[0, :, :, 0]
    return np.sqrt(np.mean((u - plot.series(y, t)[:, None]) ** 2)) / plot.series(np.array([plot.WIDTH / 2]), t)[0]


def cylinder_lattice(run, n, quick):
    """Largest difference on the two lines over the peak of the finite elements on that line. sphDemFoam: means of fifteen parts of
    a line at the times written after 3000 s. cfdDemFoam: n cells on each quarter of the cylinder and n from there to the
    square, the values on the lines as they are at the end. It takes 3000 s to be steady, so a quick run is as long."""
    plot = script(run.tutorial)
    if run.solver == CFD:
        run.cells(n, n, 1, blocks=4)
        run.control(deltaT=160 / n, writeInterval=4000, endTime=4000)
        run.solve()
        run.call(['postProcess', '-func', 'writeCellCentres', '-latestTime'])
        lines = mesh_lines(run.path, n)
    else:
        run.points(n, plot.SIDE)
        run.solve()
        lines = {line: plot.compare(run.path, line)[:2] for line in plot.LINES}
    errors = []
    for line, (name, _) in plot.LINES.items():
        (at, there), (y, u) = plot.reference(name), lines[line]
        exact = np.interp(y, at, there) if run.solver == CFD else plot.compare(run.path, line)[2]
        errors.append(float(np.abs(u - exact).max() / there.max()))
    return dict(error=max(errors), others=errors)


def mesh_lines(path, n):
    """(y, u) on the lines of the tutorial's plot, which are faces of the mesh: means of the two cells beside, of which the one is
    the mirror image of the other. Blocks of the mesh: south, east, north, west; in each the cells along the square first, rows
    from the square inwards."""
    time = os.path.join(path, fd.times(path)[-1])
    u = fd.internal_field(os.path.join(time, 'U'), 4 * n * n)[:, 0].reshape(4, n, n)
    x = fd.internal_field(os.path.join(time, 'C'), 4 * n * n).reshape(4, n, n, 3)
    half = n // 2
    above = [u[2, :, half - 1:half + 1].mean(1), x[2, :, half - 1:half + 1, 1].mean(1)]
    if np.abs(x[2, :, half - 1, 1] - x[2, :, half, 1]).max() > 1e-9 or np.abs(x[1, 0, :, 1] - x[3, 0, ::-1, 1]).max() > 1e-9:
        raise RuntimeError('%s: the mesh is not symmetric about the lines' % path)
    between = [(u[1, 0, :] + u[3, 0, ::-1]) / 2, x[1, 0, :, 1]]
    return {'through the cylinder': (above[1], above[0]), 'between two cylinders': (between[1], between[0])}


def still_tank(run, n, quick):
    """Water with the block in it. Largest error of the pressure below the surface over that at the floor, in the second second;
    others: of the level and of the pressure at the floor."""
    plot = script(run.tutorial)
    run.points(n, plot.WIDTH)
    run.control(endTime=1.2 if quick else 2)
    run.solve()
    level = plot.LEVELS['block']
    _, _, height, floor, error, speed = plot.look(run.path, level, plot.WIDTH / n)
    return dict(error=float(error / plot.pressure(level)), others=[float(height / level - 1), float(floor / plot.pressure(level) - 1)],
                speed=float(speed / np.sqrt(plot.cf.G * level)))
