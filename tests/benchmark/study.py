# SPDX-License-Identifier: GPL-3.0-or-later
"""Used by tests/benchmark/study: each point is one run of a tutorial's case, on one core, with its mesh or its fluid particles
made coarser or finer (and, for cfdDemFoam, the time step in proportion).

error: speed against the closed form of the porosity that the method itself deposits (tutorials/tools/closedForms.py,
pointForms.py); for spheres the terminal speed of one sphere alone, the same for both methods. seconds: processor time of the
solver. fromSharp: the same speed over that of a block
with sharp faces, which says how much of the block a resolution smears. resolution: cells, or fluid particles, across the width.

stillTank is not among them: cfdDemFoam has no free surface."""
import argparse
import json
import os
import re
import shutil
import subprocess
import sys

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.join(HERE, '..', '..')
TUTORIALS = os.path.join(ROOT, 'tutorials')
sys.path[:0] = [os.path.join(TUTORIALS, 'tools')]
import closedForms as cf  # noqa: E402
import foamData as fd     # noqa: E402
import pointForms as pf   # noqa: E402

OUT = os.path.join(os.environ.get('CFDDEM_BUILD') or os.path.join(ROOT, 'build'), 'tests', 'benchmark', 'study')
WIDTH, HEIGHT, D, PITCH = 0.112, 0.256, 4e-3, 0.016 / 3
SOLVERS = ('cfdDemFoam', 'sphDemFoam')


# ---- a run --------------------------------------------------------------------------------------
class Run:
    """A copy of a tutorial's case."""

    def __init__(self, tutorial, name, solver):
        self.path, self.solver = os.path.join(OUT, name), solver
        shutil.rmtree(self.path, ignore_errors=True)
        source = os.path.join(TUTORIALS, tutorial)
        for folder in ('constant', 'system'):
            shutil.copytree(os.path.join(source, folder), os.path.join(self.path, folder), ignore=shutil.ignore_patterns('polyMesh'))
        shutil.copytree(os.path.join(source, '0.orig'), os.path.join(self.path, '0'))

    def set(self, name, entry, value):
        self.call(['foamDictionary', name, '-entry', entry, '-set', value if isinstance(value, str) else '%.12g' % value])

    def cells(self, n):
        path = os.path.join(self.path, 'system', 'blockMeshDict')
        with open(path) as source:
            text, count = re.subn(r'\) \(\d+ \d+ \d+\) simple', ') (%d %d %d) simple' % tuple(n), source.read())
        if count != 1:
            raise RuntimeError('%s: no block to set the cells of' % path)
        with open(path, 'w') as out:
            out.write(text)

    def call(self, command):
        log = os.path.join(self.path, 'log.' + command[0])
        with open(log, 'a') as out:
            done = subprocess.run(command, cwd=self.path, stdout=out, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)
        if done.returncode != 0:
            with open(log) as text:
                raise RuntimeError('%s failed: %s' % (' '.join(command), ' '.join(text.read().split()[-60:])))

    def solve(self):
        self.call(['blockMesh'])
        self.call([self.solver])

    @property
    def log(self):
        return os.path.join(self.path, 'log.' + self.solver)

    def speeds(self):
        """(t, speed of the fastest solid particle): the fluid's particles have lines of their own."""
        rows, t = [], None
        with open(self.log) as source:
            for line in source:
                if line.startswith('Time = '):
                    t = float(line.split()[2].rstrip(','))
                elif line.startswith('Particles: ') and t is not None:
                    rows.append((t, float(re.search(r'max speed (\S+)', line).group(1))))
        return np.array(rows).T

    def fluid(self):
        return fd.table(self.path, 'fluid', 'fluid.dat')


def fine(run, n, width, ratio=None, **more):
    """n fluid particles across the width; ratio: h over their distance, that of the tutorial if None."""
    name = 'constant/sphProperties'
    with open(os.path.join(run.path, name)) as source:
        text = source.read()
    entry = lambda key: float(re.search(r'\b%s\s+([-\d.e]+);' % key, text).group(1))
    h = width / n * (ratio or entry('smoothingLength') / entry('spacing'))
    run.set(name, 'spacing', width / n)
    run.set(name, 'smoothingLength', h)
    return h * (entry('couplingLength') if 'couplingLength' in text else 2.0)


# ---- cases: (speed found, speed of the closed form) ---------------------------------------------
def flow(run, n, quick):
    end = 0.7 if quick else 1.2
    run.set('system/controlDict', 'endTime', end)
    if run.solver == 'cfdDemFoam':
        run.cells(n)
        run.set('system/controlDict', 'deltaT', 0.002 * 16 / n[2])
        run.set('system/controlDict', 'writeInterval', end)
        run.solve()
        rows = fd.function_object(run.path, 'superficialVelocity')
        block = cf.Block(0.104 + PITCH * np.arange(10), D, (21 // n[0]) ** 2, (WIDTH / n[0]) ** 2, np.linspace(0, HEIGHT, n[2] + 1))
        return -rows[rows[:, 0] > 0.8 * end, 3].mean(), cf.flow_speed(block, HEIGHT)
    length = fine(run, n, WIDTH)
    run.solve()
    table = run.fluid()
    block = pf.PointBlock(0.104 + PITCH * np.arange(10), D, 441, WIDTH ** 2, HEIGHT, length)
    late = table['Time'] > 0.8 * end
    return -table['superficial velocity'][late, 2].mean(), pf.flow_speed(block, WIDTH ** 2, HEIGHT)


def settling(run, n, quick):
    """cfdDemFoam: mean speed over whole cells of 16 mm, for it goes up and down with them."""
    upper, lower, end = (0.176, 0.144, 1.2) if quick else (0.16, 0.096, 1.9)
    run.set('system/controlDict', 'endTime', end)
    if run.solver == 'cfdDemFoam':
        run.cells(n)
        run.set('system/controlDict', 'deltaT', 0.002 * 16 / n[2])
        run.set('system/controlDict', 'writeInterval', end)
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
        return way / cf.time_between(t, z, upper, lower), way / cf.time_between(closed, at, upper, lower)
    length = fine(run, n, WIDTH)
    run.set('system/controlDict', 'writeInterval', end)
    run.solve()
    t, v = run.speeds()
    block = pf.PointBlock(0.128 + PITCH * (np.arange(10) - 4.5), D, 441, WIDTH ** 2, HEIGHT, length)
    return v[t > 0.8].mean(), pf.settling_speed(block, 10, 200.0)


def sphere(run, n, quick):
    """4 mm, two-way, without correction of the flow that its own drag makes."""
    run.set('system/controlDict', 'endTime', 0.5 if quick else 0.8)
    run.set('system/controlDict', 'writeInterval', 1.0)
    if run.solver == 'cfdDemFoam':
        run.cells((n, n, round(1.2 * n)))
        run.set('system/controlDict', 'deltaT', 0.007 / n)
    else:
        fine(run, n, 0.1001)
    run.solve()
    t, v = run.speeds()
    return v[t > 0.7 * t[-1]].mean(), cf.sphere_terminal(D, 1200.0, 1.0)


def sps(run, ratio, quick):
    """Water, Stokes' law, with that correction; ratio: h/d."""
    text = subprocess.run([sys.executable, os.path.join(TUTORIALS, 'sphDemFoam', 'sps', 'settings'), 'water', 'stokes', str(ratio)],
                          check=True, text=True, stdout=subprocess.PIPE).stdout
    with open(os.path.join(run.path, 'constant', 'settings'), 'w') as out:
        out.write(text)
    value = dict(re.findall(r'^(\w+)\s+(.*);', text, re.M))
    for entry, source in (('drag', 'law'), ('bandwidth', 'bandwidth')):
        run.set('constant/couplingProperties', entry, value[source])
    for entry in ('origin', 'velocity'):
        run.set('constant/demProperties', 'insertion/sphere/' + entry, value[entry])
    for entry in ('spacing', 'smoothingLength', 'soundSpeed', 'backgroundPressure'):
        run.set('constant/sphProperties', entry, value[entry])
    run.solve()
    t, v = run.speeds()
    return v[t > 0.5 * t[-1]].mean(), -float(value['velocity'].strip('()').split()[2])


# Case: function, tutorial, resolutions of cfdDemFoam, of sphDemFoam, how many across the width
STUDIES = {
    'flow': (flow, 'cfdDemFoam/porousBlockFlow', [(3, 3, 7), (7, 7, 16), (7, 7, 32), (21, 21, 48)], [7, 9, 11, 14],
             lambda n: 'x'.join(map(str, n)) if isinstance(n, tuple) else str(n)),
    'settling': (settling, 'cfdDemFoam/porousBlockSettling', [(3, 3, 8), (7, 7, 16), (7, 7, 32), (21, 21, 48)], [7, 9, 11, 14],
                 lambda n: 'x'.join(map(str, n)) if isinstance(n, tuple) else str(n)),
    'sphere': (sphere, 'cfdDemFoam/singleSphere', [5, 7, 11, 15], [7, 10, 14, 20], str),
    'sps': (sps, 'sphDemFoam/sps', [6, 5, 4, 3], [6, 5, 4, 3], lambda ratio: str(round(6 * 10 / ratio))),
}


def sharp(case):
    """Speed with the same fluid fraction, 0.779, all over the block and 1 beside it: what both methods' blocks become as they
    are resolved. The sphere's closed form is that of one alone already."""
    eps, count = 1 - cf.sphere(D) / PITCH ** 3, 4410
    force = {'flow': 1000.0 * cf.G * WIDTH ** 2 * HEIGHT, 'settling': count * cf.sphere(D) * 200.0 * cf.G}
    return cf.root(lambda w: count * cf.di_felice(w, D, eps) / eps - force[case], 1e-6, 1e2) if case in force else None


# ---- table and picture --------------------------------------------------------------------------
def one(case, solver, n, quick):
    function, tutorial, _, _, label = STUDIES[case]
    row = dict(case=case, solver=solver, resolution=label(n), quick=quick)
    try:
        run = Run(tutorial, '%s.%s.%s' % (case, solver, label(n)), solver)
        found, closed = function(run, n, quick)
        if not (np.isfinite(found) and np.isfinite(closed)):
            raise RuntimeError('speed %g m/s, closed form %g' % (found, closed))
        row.update(found=float(found), closed=float(closed), error=abs(float(found / closed - 1)), seconds=fd.clock(run.log)[1])
    except (RuntimeError, OSError, ValueError, KeyError, IndexError, AttributeError) as error:
        row['failed'] = '%s: %s' % (type(error).__name__, ' '.join(str(error).split())[-300:])
    return row


def report(row):
    name = 'study.%s.%s.%s' % (row['case'], row['solver'], row['resolution'])
    if 'failed' in row:
        print('FAILED %s: %s' % (name, row['failed']), flush=True)
        return
    print('metric %s.error %.4g 1' % (name, row['error']))
    if sharp(row['case']):
        print('metric %s.fromSharp %.4g 1' % (name, row['found'] / sharp(row['case']) - 1))
    print('metric %s.seconds %.4g s' % (name, row['seconds']), flush=True)


def table(rows, out):
    print('%-10s %-11s %-10s %12s %12s %10s %13s %9s' % (
        'case', 'method', 'across', 'speed, m/s', 'closed form', 'error, %', 'from sharp, %', 'seconds'), file=out)
    for r in rows:
        head = '%-10s %-11s %-10s ' % (r['case'], r['solver'], r['resolution'])
        print(head + ('FAILED ' + r['failed'] if 'failed' in r else '%12.6g %12.6g %10.4f %13s %9.2f%s' % (
            r['found'], r['closed'], 100 * r['error'],
            '%+.2f' % (100 * (r['found'] / sharp(r['case']) - 1)) if sharp(r['case']) else '-',
            r['seconds'], '  (quick)' if r['quick'] else '')), file=out)


def decades(limits):
    """Whole decades around them, so that the axis has numbers at these alone."""
    return 10 ** np.floor(np.log10(limits[0])), 10 ** np.ceil(np.log10(limits[1]))


def draw(rows, path):
    from figures import CLOSED, COMPUTED, plt
    cases = [c for c in STUDIES if any(r['case'] == c and 'failed' not in r for r in rows)]
    if not cases:
        return
    figure, axes = plt.subplots(1, len(cases), figsize=(3.4 * len(cases) + 0.6, 3.6), squeeze=False)
    for ax, case in zip(axes[0], cases):
        for solver, colour, mark in zip(SOLVERS, (CLOSED, COMPUTED), 'so'):
            points = [r for r in rows if r['case'] == case and r['solver'] == solver and 'failed' not in r]
            if points:
                # what is right to round-off has no place on the axis: drawn at 1e-6
                x, y = [max(r['seconds'], 1e-2) for r in points], [100 * max(r['error'], 1e-8) for r in points]
                ax.loglog(x, y, mark + '-', color=colour, label=solver)
                for r, a, b in zip(points, x, y):
                    ax.annotate(r['resolution'], (a, b), textcoords='offset points', xytext=(4, 4), fontsize=7, color=colour)
        ax.set(title=case, xlabel='processor time, s', xlim=decades(ax.get_xlim()), ylim=decades(ax.get_ylim()))
    axes[0][0].set_ylabel('error of the speed, %')
    axes[0][0].legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(path, dpi=130)


def kept(name):
    try:
        with open(name) as source:
            return json.load(source)
    except (OSError, ValueError):
        return []


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('--only', action='append', choices=STUDIES)
    parser.add_argument('--quick', action='store_true')
    parser.add_argument('--draw', action='store_true')
    options = parser.parse_args()
    os.makedirs(OUT, exist_ok=True)
    name = os.path.join(OUT, 'points.json')
    rows, good = kept(name), True
    chosen = options.only or list(STUDIES)
    if not options.draw:
        rows = [r for r in rows if r['case'] not in chosen]
        for case in chosen:
            for solver, resolutions in zip(SOLVERS, STUDIES[case][2:4]):
                for n in resolutions[:2] if options.quick else resolutions:
                    rows.append(one(case, solver, n, options.quick))
                    report(rows[-1])
                    good = good and 'failed' not in rows[-1]
                    with open(name, 'w') as out:
                        json.dump(rows, out, indent=1)
    else:
        for row in rows:
            report(row)
    rows.sort(key=lambda r: (list(STUDIES).index(r['case']), SOLVERS.index(r['solver'])))
    table(rows, sys.stdout)
    with open(os.path.join(OUT, 'table.txt'), 'w') as out:
        table(rows, out)
    draw(rows, os.path.join(OUT, 'study.png'))
    return 0 if good else 1


if __name__ == '__main__':
    sys.exit(main())
