# SPDX-License-Identifier: GPL-3.0-or-later
"""Used by tests/benchmark/study: each point is one run of a tutorial's case, on one core, with its mesh or its fluid particles
made coarser or finer (and, for cfdDemFoam, the time step in proportion). What the error of a case is, its function in studies/
says, and doc/study.md. seconds: processor time of the solver."""
import argparse
import json
import os
import sys

sys.path[:0] = [os.path.join(os.path.dirname(os.path.abspath(__file__)), 'studies')]
from run import CFD, OUT, SOLVERS, SPH, Run  # noqa: E402
import foamData as fd  # noqa: E402
import numpy as np     # noqa: E402
import show            # noqa: E402
from blocks import flow, settling, sphere, sps                    # noqa: E402
from fluids import cylinder_lattice, poiseuille, still_tank       # noqa: E402
from suspensions import cpb, rti                                  # noqa: E402


class Study:
    """function, tutorial, resolutions of cfdDemFoam and of sphDemFoam from coarse to fine; label: of a resolution, across: what
    that is; error: what of; why: why a method is not in it."""

    def __init__(self, function, tutorial, cfd, sph, across, error, label=str, why=None):
        self.function, self.tutorial, self.resolutions = function, tutorial, {CFD: cfd, SPH: sph}
        self.across, self.error, self.label, self.why = across, error, label, why or {}


def cells(n):
    return 'x'.join(map(str, n)) if isinstance(n, tuple) else str(n)


STUDIES = {
    'poiseuille': Study(poiseuille, 'sphDemFoam/poiseuille', [8, 16, 32, 64], [13, 19, 26, 38], 'across the gap', 'rms, of the peak'),
    'cylinderLattice': Study(cylinder_lattice, 'sphDemFoam/cylinderLattice', [8, 12, 16, 24], [24, 36, 50, 72],
                             'cells on a quarter of the cylinder, particles across the cell', 'largest on two lines, of the peak'),
    'stillTank': Study(still_tank, 'sphDemFoam/stillTank', [], [7, 8, 10, 12], 'across the width', 'largest of the pressure, of the floor\'s',
                       why={CFD: 'has no free surface'}),
    'flow': Study(flow, 'cfdDemFoam/porousBlockFlow', [(3, 3, 7), (7, 7, 16), (7, 7, 32), (21, 21, 48)], [6, 7, 8, 9],
                  'cells, particles across the width', 'speed', cells),
    'settling': Study(settling, 'cfdDemFoam/porousBlockSettling', [(3, 3, 8), (7, 7, 16), (7, 7, 24), (7, 7, 32)], [7, 8, 9, 11],
                      'cells, particles across the width', 'speed', cells),
    'sphere': Study(sphere, 'cfdDemFoam/singleSphere', [5, 7, 11, 15], [7, 10, 14, 20], 'across the width', 'speed'),
    'sps': Study(sps, 'sphDemFoam/sps', [6, 5, 4, 3], [6, 5, 4, 3], 'across the width', 'speed', lambda ratio: str(round(6 * 10 / ratio))),
    'cpb': Study(cpb, 'sphDemFoam/cpb', [6, 5, 4, 3, 2], [6, 5, 4, 3, 2], 'h/d', 'speed', lambda ratio: 'h/d=%d' % ratio),
    'rti': Study(rti, 'sphDemFoam/rti', [7, 10, 14, 28], [14, 18, 22, 28], 'across the width', 'growth rate'),
}
BROKEN = (RuntimeError, OSError, ValueError, KeyError, IndexError, AttributeError, StopIteration, SystemExit)


def one(case, solver, n, quick):
    study = STUDIES[case]
    row = dict(case=case, solver=solver, resolution=study.label(n), quick=quick)
    try:
        run = Run(study.tutorial, '%s.%s.%s' % (case, solver, row['resolution'].replace('/', '_')), solver)
        found = study.function(run, n, quick)
        if not np.isfinite(found['error']):
            raise RuntimeError('not a number: %s' % found)
        row.update(found, seconds=fd.clock(run.log)[1])
    except BROKEN as error:
        row['failed'] = '%s: %s' % (type(error).__name__, ' '.join(str(error).split())[-300:])
    return row


def kept(name):
    try:
        with open(name) as source:
            return json.load(source)
    except (OSError, ValueError):
        return []


def is_there(rows, case, solver, resolution, quick):
    """A point that need not be run again: whole, and not of a quick run where a long one is wanted."""
    return any((r['case'], r['solver'], r['resolution']) == (case, solver, resolution) and 'failed' not in r
               and (quick or not r['quick']) for r in rows)


def runs(rows, chosen, options, name):
    """Runs what is wanted, one at a time; rows are in the file after each. Returns the rows and whether all went well."""
    if not options.missing:
        rows = [r for r in rows if r['case'] not in chosen]
    good = True
    for case in chosen:
        for solver in SOLVERS:
            for n in STUDIES[case].resolutions[solver][:2 if options.quick else None]:
                resolution = STUDIES[case].label(n)
                if options.missing and is_there(rows, case, solver, resolution, options.quick):
                    continue
                row = one(case, solver, n, options.quick)
                rows = [r for r in rows if (r['case'], r['solver'], r['resolution']) != (case, solver, resolution)] + [row]
                show.report(row)
                good = good and 'failed' not in row
                with open(name + '.new', 'w') as out:
                    json.dump(rows, out, indent=1)
                os.replace(name + '.new', name)
    return rows, good


def in_order(rows):
    labels = {(case, solver): [s.label(n) for n in s.resolutions[solver]] for case, s in STUDIES.items() for solver in SOLVERS}
    rows = [r for r in rows if r['resolution'] in labels.get((r['case'], r['solver']), ())]  # those of an older list are not drawn
    return sorted(rows, key=lambda r: (list(STUDIES).index(r['case']), SOLVERS.index(r['solver']),
                                       labels[r['case'], r['solver']].index(r['resolution'])))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('--only', action='append', choices=STUDIES)
    parser.add_argument('--missing', action='store_true')
    parser.add_argument('--quick', action='store_true')
    parser.add_argument('--draw', action='store_true')
    options = parser.parse_args()
    os.makedirs(OUT, exist_ok=True)
    name = os.path.join(OUT, 'points.json')
    rows, good = kept(name), True
    if options.draw:
        for row in in_order(rows):
            show.report(row)
    else:
        rows, good = runs(rows, options.only or list(STUDIES), options, name)
    rows = in_order(rows)
    show.table(rows, STUDIES, sys.stdout)
    with open(os.path.join(OUT, 'table.txt'), 'w') as out:
        show.table(rows, STUDIES, out)
    show.draw(rows, STUDIES, os.path.join(OUT, 'study.png'))
    return 0 if good else 1


if __name__ == '__main__':
    sys.exit(main())
