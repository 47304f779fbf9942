# SPDX-License-Identifier: GPL-3.0-or-later
"""metric coupling.<mesh>.{<stage>,together} ns per sphere, coupling.<mesh>.ranks2 (time of the busiest of two ranks over that
of one rank, all stages), coupling.fixed.{weights,all} (share of a step of cfdDemFoam, %)."""
import os
import re
import statistics
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, '..', 'validation', 'lib'))
sys.path.insert(0, HERE)
from coupled import CELL, GRAVITY, PITCH, case_path, coupled, lattice, solve  # noqa: E402

TOGETHER = ('locate', 'voidFraction', 'sample', 'force', 'source')
COUPLING = ('locate', 'void fraction', 'sample fluid', 'fluid force', 'momentum source', 'reaction')
ROUNDS = 5


def stages(program, mesh, ranks):
    """{stage: ns per sphere}"""
    command = ['mpirun', '--allow-run-as-root', '--oversubscribe', '--bind-to', 'none', '-np', str(ranks)] if ranks > 1 else []
    # who waits for the other rank must not burn the time that is measured
    os.environ['OMPI_MCA_mpi_yield_when_idle'] = '1'
    text = subprocess.run(command + [program, mesh], check=True, stdout=subprocess.PIPE, universal_newlines=True).stdout
    return {name: float(ns) for name, ns in re.findall(r'^\w+ (\w+) (\S+)$', text, flags=re.M)}


def meshes(program):
    for mesh in ('cartesian', 'polyhedra', 'warped'):
        one, two = [], []
        for _ in range(ROUNDS):
            one.append(stages(program, mesh, 1))
            two.append(stages(program, mesh, 2))
        median = {name: statistics.median(r[name] for r in one) for name in one[0]}
        for name, ns in median.items():
            print('metric coupling.%s.%s %.4g ns' % (mesh, name, ns))
        print('metric coupling.%s.together %.4g ns' % (mesh, sum(median[name] for name in TOGETHER)))
        ratio = statistics.median(sum(b.values()) / sum(a.values()) for a, b in zip(one, two))
        print('metric coupling.%s.ranks2 %.3g 1' % (mesh, ratio), flush=True)


def fixed():
    """Porous block of Markauskas et al. (4410 spheres that do not move, 784 cells), 300 steps."""
    case = coupled(case_path('couplingFixed'), cells=(7, 7, 16), body=(0, 0, GRAVITY), u0=(0, 0, 0.9), dt=2e-3, end=0.6,
                   insertion={'block': lattice((21, 21, 10), 6 * CELL + PITCH)})
    text = solve(case)[1]
    found = {}
    for name, seconds in re.findall(r'^([a-z][a-z, ]*?) +\d+ +([\d.e+-]+) +[\d.e+-]+ +[\d.]+%$', text, flags=re.M):
        found.setdefault(name, []).append(float(seconds))
    total = sum(found[name][0] for name in (
        'step size', 'particles and exchange', 'face coefficients', 'momentum', 'pressure', 'turbulence', 'reaction',
        'report and output'))
    print('metric coupling.fixed.weights %.2f %%' % (100 * sum(found[name][-1] for name in COUPLING[:2]) / total))
    print('metric coupling.fixed.all %.2f %%' % (100 * sum(found[name][-1] for name in COUPLING) / total))


meshes(sys.argv[1])
fixed()
