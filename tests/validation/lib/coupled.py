# SPDX-License-Identifier: GPL-3.0-or-later
"""Small cfdDemFoam cases for the validation and stability tests, and readers of what they write. SI units."""
import math
import os
import re
import sys

import h5py
import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, '..', '..', 'foam', 'lib'))
from checks import Checks  # noqa: E402,F401
import scotch  # noqa: E402
from foamcase import HEADER, flow_case, foam  # noqa: E402

WATER = dict(density=1000.0, nu=1e-6)
CELL = 0.016         # cells of Markauskas et al.'s porous blocks
PITCH = CELL / 3     # of their sphere lattice
DIAMETER = 4e-3
GRAVITY = 9.81
SPHERE = math.pi / 6 * DIAMETER ** 3


def case_path(name):
    """Where a test keeps its case: build/tests/validation/cases/NAME, left for inspection."""
    root = os.environ.get('CFDDEM_BUILD') or os.path.join(HERE, '..', '..', '..', 'build')
    return os.path.join(os.path.abspath(root), 'tests', 'validation', 'cases', name)


def control(case, **entries):
    """system/controlDict; 17 digits, so that a file holds every bit and decomposePar loses none."""
    words = {
        'application': 'cfdDemFoam', 'startFrom': 'startTime', 'startTime': 0, 'stopAt': 'endTime',
        'endTime': 1.0, 'deltaT': 1e-3, 'writeControl': 'adjustableRunTime', 'writeInterval': 1.0,
        'writeFormat': 'ascii', 'writePrecision': 17, 'timeFormat': 'general', 'timePrecision': 12,
        'runTimeModifiable': 'no'}
    words.update(entries)
    case.write('system/controlDict', words)


def edit(case, name, old, new):
    """Replace text in a file of the case; an error if it is not there exactly once."""
    path = os.path.join(case.path, name)
    with open(path) as source:
        text = source.read()
    if text.count(old) != 1:
        raise ValueError('%s: %d times "%s"' % (path, text.count(old), old))
    with open(path, 'w') as out:
        out.write(text.replace(old, new))


def coupled(path, *, cells=(3, 3, 16), lo=(0, 0, 0), hi=None, kinds=None, insertion=None, g=(0, 0, 0), body=(0, 0, 0),
            dt=1e-3, end=1.0, density=1200.0, fluid=1000.0, nu=1e-6, coupling=None, contact=None, walls=None, dem=None,
            times=None, spheres=None, turbulent=False, **flow):
    """A case for cfdDemFoam: box of water (or fluid, nu), particles as in insertion. flow: of foamcase.flow_case;
    times: entries of controlDict; spheres: rows x y z d [vx vy vz] of free ones; turbulent: k-epsilon."""
    hi = hi or tuple(CELL * n for n in cells)
    kinds = kinds or {'x': 'wall', 'y': 'wall', 'z': 'cyclic'}
    case = flow_case(path, lo=lo, hi=hi, cells=cells, kinds=kinds, body=body, dt=dt, end=end, nu=nu, **flow)
    os.remove(os.path.join(path, 'constant', 'prescribedSolids'))
    # 'pRefCell 0' is a cell of rank 0, another one in every decomposition; this is the same place in all
    edit(case, 'system/fvSolution', 'pRefCell 0;', 'pRefPoint %s;' % foam(
        tuple(float(a + 0.37 * (b - a) / n) for a, b, n in zip(lo, hi, cells))))
    control(case, **dict({'deltaT': dt, 'endTime': end, 'writeInterval': end}, **(times or {})))
    case.write('constant/g', {'dimensions': '[0 1 -2 0 0 0 0]', 'value': g}, 'uniformDimensionedVectorField')
    case.write('constant/transportProperties', {
        'transportModel': 'Newtonian', 'nu': '[0 2 -1 0 0 0 0] %r' % nu, 'rho': '[1 -3 0 0 0 0 0] %r' % fluid})
    case.write('constant/turbulenceProperties', {'simulationType': 'laminar'})
    if turbulent:
        k_epsilon(case, kinds)
    case.write('constant/couplingProperties', dict(
        {'model': 'A', 'voidFraction': 'exact', 'drag': 'diFelice', 'twoWay': True}, **(coupling or {})))
    law = dict({'law': 'linearSpringDashpot', 'normalStiffness': 1000.0, 'restitution': 0.9, 'friction': 0.0},
               **(contact or {}))
    insertion = dict(insertion or {}, **({'spheres': sphere_file(case, spheres)} if spheres else {}))
    case.write('constant/demProperties', dict({
        'materials': {'glass': {'density': density}}, 'contacts': {'default': law}},
        insertion=insertion, **dict(dem or {}, **({'walls': walls} if walls else {}))))
    return case


def k_epsilon(case, kinds):
    case.write('constant/turbulenceProperties', {
        'simulationType': 'RAS', 'RAS': {'RASModel': 'kEpsilon', 'turbulence': True, 'printCoeffs': False}})
    walls = {'k': 'kqRWallFunction', 'epsilon': 'epsilonWallFunction', 'nut': 'nutkWallFunction'}
    for name, dimensions, value in (('k', (0, 2, -2, 0, 0, 0, 0), 1e-3), ('epsilon', (0, 2, -3, 0, 0, 0, 0), 1e-3),
                                    ('nut', (0, 2, -1, 0, 0, 0, 0), 0.0)):
        patch = {'wall': {'type': walls[name], 'value': 'uniform %r' % value}, 'cyclic': {'type': 'cyclic'}}
        case.field(name, dimensions, value, {
            s: patch[kinds[s] if s in kinds else kinds[s[0]]] for s in ('xMin', 'xMax', 'yMin', 'yMax', 'zMin', 'zMax')})
    edit(case, 'system/fvSchemes', 'div(phi,U)', """div(phiFluid,k) Gauss upwind; div(phiFluid,epsilon) Gauss upwind;
div(phi,U)""")
    edit(case, 'system/fvSolution', 'p_rghFinal {', """"(k|epsilon).*" { solver PBiCGStab; preconditioner DILU; tolerance 1e-14; relTol 0; }
p_rghFinal {""")
    edit(case, 'system/fvSchemes', 'ddtSchemes', 'wallDist { method meshWave; }\nddtSchemes')


def lattice(count, bottom, kind='fixed', corner=(0.0, 0.0), diameter=DIAMETER, pitch=PITCH):
    """Simple cubic lattice of spheres; bottom: the lower end of the first layer (half a pitch below its centres)."""
    return {'method': 'lattice', 'kind': kind, 'material': 'glass', 'diameter': diameter,
            'origin': (corner[0] + pitch / 2, corner[1] + pitch / 2, bottom + pitch / 2),
            'spacing': (pitch, pitch, pitch), 'count': count}


def cap(height, r):
    """Volume of the part of a sphere below height above its centre."""
    h = min(max(height + r, 0.0), 2 * r)
    return math.pi * h * h * (3 * r - h) / 3


def sphere_weights(layers, bottom, faces):
    """[layers][cells]: share of a sphere of each layer of a lattice (see there) between the planes z = faces."""
    below = [[cap(z - (bottom + (k + 0.5) * PITCH), DIAMETER / 2) for z in faces] for k in range(layers)]
    return np.diff(below, axis=1) / SPHERE


def floor(z=0.0):
    return {'floor': {'type': 'plane', 'point': (0, 0, z), 'normal': (0, 0, 1), 'material': 'glass'}}


def sphere_file(case, rows):
    """Insertion of free spheres from a file, rows x y z d [vx vy vz]."""
    name = os.path.join(case.path, 'constant', 'spheres.txt')
    with open(name, 'w') as out:
        out.writelines(' '.join(repr(float(v)) for v in row) + '\n' for row in rows)
    return {'method': 'file', 'kind': 'free', 'material': 'glass', 'file': '"%s"' % name}


# ------------------------------------------------------------------------------ running

def decompose(case, ranks, method):
    """decomposePar by simple (mostly along z), hierarchical (x and y, so that periodic sides are split over ranks both ways) or scotch
    (see lib/scotch.py for packages without it)."""
    words = {'numberOfSubdomains': ranks, 'method': method, 'manualCoeffs': {'dataFile': '"cellDecomposition"'},
             'simpleCoeffs': {'n': {1: (1, 1, 1), 2: (1, 1, 2), 3: (1, 1, 3), 4: (2, 1, 2)}[ranks], 'delta': 0.001},
             'hierarchicalCoeffs': {'n': {1: (1, 1, 1), 2: (1, 2, 1), 3: (1, 3, 1), 4: (2, 2, 1)}[ranks], 'delta': 0.001, 'order': 'yxz'}}
    case.write('system/decomposeParDict', words)
    status, text = case.run('decomposePar', '-force', check=method != 'scotch')
    if method == 'scotch' and status and 'stub library' in text:
        rank = scotch.partition(os.path.join(case.path, 'constant', 'polyMesh'), ranks)
        with open(os.path.join(case.path, 'constant', 'cellDecomposition'), 'w') as out:
            out.write(HEADER.format(cls='labelList', name='cellDecomposition') + '%d\n(\n' % len(rank))
            out.writelines('%d\n' % r for r in rank)
            out.write(')\n')
        case.write('system/decomposeParDict', dict(words, method='manual'))
        case.run('decomposePar', '-force')


def solve(case, ranks=1, method='simple', decomposed=False, check=True, timeout=300, solver='cfdDemFoam'):
    """Run the solver on 1 or more ranks (after decomposePar, if not decomposed yet); (exit status, log)."""
    if ranks == 1:
        return case.run(solver, check=check, timeout=timeout)
    if not decomposed:
        decompose(case, ranks, method)
    return case.run('mpirun', '-np', str(ranks), solver, '-parallel', check=check, timeout=timeout)


def numbers(text):
    return [float(v) for v in re.findall(r'[-+]?(?:\d+\.?\d*(?:[eE][-+]?\d+)?|nan|inf)', text)]


class Log:
    """What a run of cfdDemFoam printed, one entry per step: time, speed (of the fastest particle), contacts, overlap,
    exchange (error), budget (error), fluid and received (impulse of the exchange, N s)."""

    def __init__(self, text):
        self.text = text
        self.time, self.dt, self.speed, self.contacts, self.overlap, self.substeps = [], [], [], [], [], []
        self.exchange, self.budget, self.fluid, self.received, self.volume = [], [], [], [], []
        for line in text.splitlines():
            if line.startswith('Time = '):
                time, dt = numbers(line)[:2]
                self.time.append(time)
                self.dt.append(dt)
            elif line.startswith('Particles: '):
                values = numbers(line)
                self.substeps.append(values[1])
                self.contacts.append(values[2] + values[3])
                self.overlap.append(values[4])
                self.speed.append(values[5])
                self.volume.append(values[6])
            elif line.startswith('Particle momentum budget'):
                self.budget.append(numbers(line)[0])
            elif line.startswith('Exchange:'):
                values = numbers(line)
                self.fluid.append(values[:3])
                self.received.append(values[3:6])
                self.exchange.append(values[6])


# ------------------------------------------------------------------------------ reading

def times(folder):
    """Names of the time directories of a case (or of processor0), in order."""
    names = [n for n in os.listdir(folder) if re.fullmatch(r'\d+(\.\d+)?([eE][-+]?\d+)?', n)]
    return sorted(names, key=float)


def particle_file(case, time):
    return os.path.join(case.path, 'particles', '%s.vtkhdf' % time)


def arrays(path):
    """All datasets and attributes of an HDF5 file by name, as bytes-comparable numpy arrays."""
    found = {}
    with h5py.File(path, 'r') as file:
        def visit(name, node):
            if isinstance(node, h5py.Dataset):
                found[name] = np.asarray(node[()])
            for key, value in node.attrs.items():
                found['%s@%s' % (name, key)] = np.asarray(value)
        file.visititems(visit)
    return found


def particles(case, time):
    """Particle quantities at a written time, rows in the order of id."""
    found = {name.split('/')[-1]: value for name, value in arrays(particle_file(case, time)).items()
             if '@' not in name and (name.startswith('VTKHDF/PointData/') or name == 'VTKHDF/Points')}
    order = np.argsort(found['id'])
    return {name: value[order] for name, value in found.items()}


def relative_difference(a, b, scale=0.0):
    """Largest difference over the largest magnitude of b (or scale, if larger; 0 if all are 0); inf where shapes differ or
    a is not finite."""
    a, b = np.asarray(a, float), np.asarray(b, float)
    if a.shape != b.shape:
        if a.size not in (1, 3) and b.size not in (1, 3):
            return math.inf
    largest = max(scale, np.abs(b).max() if b.size else 0.0)
    if not np.isfinite(a).all():
        return math.inf
    difference = np.abs(a - b).max() if a.size else 0.0
    return difference / largest if largest > 0 else difference
