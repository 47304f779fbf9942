# SPDX-License-Identifier: GPL-3.0-or-later
"""Small OpenFOAM cases for tests: write dictionaries from Python values, run, read fields back."""
import os
import re
import shutil
import subprocess
import sys

import numpy as np

MAKE_MESH = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', 'meshes', 'makeMesh.py')
HEADER = 'FoamFile\n{{\n    version 2.0;\n    format ascii;\n    class {cls};\n    object {name};\n}}\n'


def foam(value):
    """Python value -> OpenFOAM text: dict, list/tuple (vector or list), bool, str, number."""
    if isinstance(value, dict):
        return '{\n' + entries(value) + '}'
    if isinstance(value, bool):
        return 'on' if value else 'off'
    if isinstance(value, (list, tuple)):
        return '(' + ' '.join(foam(v) for v in value) + ')'
    return repr(value) if isinstance(value, float) else str(value)


def entries(values):
    return ''.join('%s %s%s\n' % (key, foam(v), '' if isinstance(v, dict) else ';')
                   for key, v in values.items())


class Case:
    """An OpenFOAM case directory, made anew."""

    def __init__(self, path):
        self.path = path
        shutil.rmtree(path, ignore_errors=True)
        os.makedirs(path)

    def write(self, name, values, cls='dictionary'):
        path = os.path.join(self.path, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, 'w') as out:
            out.write(HEADER.format(cls=cls, name=os.path.basename(name)) + entries(values))

    def field(self, name, dimensions, internal, boundary, cls=None):
        """boundary: {patch: {...}}; internal: number, vector or list of them."""
        vector = isinstance(internal, tuple)
        if isinstance(internal, list):
            vector = isinstance(internal[0], (tuple, np.ndarray))
            kind = 'vector' if vector else 'scalar'
            rows = ' '.join(foam(tuple(map(float, v))) if vector else repr(float(v)) for v in internal)
            text = 'nonuniform List<%s> %d(%s)' % (kind, len(internal), rows)
        else:
            text = 'uniform ' + foam(internal)
        self.write('0/' + name, {
            'dimensions': '[%s]' % ' '.join(map(str, dimensions)),
            'internalField': text, 'boundaryField': boundary},
            cls or ('volVectorField' if vector else 'volScalarField'))

    def box(self, lo, hi, cells, kinds):
        """blockMesh box; kinds: {'x': 'cyclic'|'wall'|'empty'|'patch'|'symmetryPlane', ...};
        patches xMin, xMax, ..."""
        (x0, y0, z0), (x1, y1, z1) = lo, hi
        faces = {'xMin': (0, 4, 7, 3), 'xMax': (1, 2, 6, 5), 'yMin': (0, 1, 5, 4), 'yMax': (3, 7, 6, 2),
                 'zMin': (0, 3, 2, 1), 'zMax': (4, 5, 6, 7)}
        patches = []
        for name, face in faces.items():
            kind = kinds[name] if name in kinds else kinds[name[0]]
            patch = {'type': kind, 'faces': [face]}
            if kind == 'cyclic':
                patch['neighbourPatch'] = name[0] + ('Max' if name.endswith('Min') else 'Min')
            patches.append('%s %s' % (name, foam(patch)))
        self.write('system/blockMeshDict', {
            'vertices': [(x0, y0, z0), (x1, y0, z0), (x1, y1, z0), (x0, y1, z0),
                         (x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1)],
            'blocks': '( hex (0 1 2 3 4 5 6 7) %s simpleGrading (1 1 1) )' % foam(tuple(cells)),
            'edges': [], 'boundary': '(' + '\n'.join(patches) + ')'})
        self.run('blockMesh')

    def mesh(self, lo, hi, cells, kinds, options):
        words = [sys.executable, MAKE_MESH, '.', '--cells', *cells, '--origin', *lo,
                 '--length', *(b - a for a, b in zip(lo, hi)), *options]
        for kind in ('cyclic', 'wall', 'empty'):
            sides = [side for side, k in kinds.items() if k == kind]
            words += ['--' + kind, *sides] if sides else []
        self.run(*map(str, words))

    def run(self, *command, check=True, timeout=600):
        """Run in the case; the log is log.<command>. Returns (exit status, text)."""
        name = [c for c in command if not c.startswith('-') and not c.isdigit()
                and os.path.basename(c) not in ('mpirun', os.path.basename(sys.executable))][0]
        log = os.path.join(self.path, 'log.' + os.path.basename(name))
        with open(log, 'w') as out:
            env = dict(os.environ, PWD=os.path.abspath(self.path))
            status = subprocess.call(command, cwd=self.path, env=env, stdout=out,
                                     stderr=subprocess.STDOUT, timeout=timeout)
        with open(log) as text:
            output = text.read()
        if check and status != 0:
            raise RuntimeError('%s failed in %s:\n%s' % (' '.join(command), self.path, output[-3000:]))
        return status, output

    def last(self, name):
        """Internal field of the last time written."""
        times = [d for d in os.listdir(self.path) if re.fullmatch(r'[0-9.e+-]+', d)]
        return self.read(max(times, key=float) + '/' + name)

    def read(self, name):
        """Internal field (ascii) as an array [n] or [n][3]; name: 'time/field'."""
        with open(os.path.join(self.path, name)) as source:
            text = source.read()
        match = re.search(r'internalField\s+nonuniform\s+List<(\w+)>\s*(\d+)\s*\(', text)
        if not match:
            match = re.search(r'internalField\s+uniform\s+(.*?);', text)
            return np.array([float(v) for v in match.group(1).strip('() ').split()])
        body = text[match.end():text.index('\n)\n', match.end())] if match.group(1) != 'scalar' else \
            text[match.end():text.index(')', match.end())]
        values = np.array([float(v) for v in body.replace('(', ' ').replace(')', ' ').split()])
        return values.reshape(-1, 3) if match.group(1) == 'vector' else values


def flow_case(path, *, lo, hi, cells, kinds, regions=(), model='A', nu=1e-6, div='Gauss linear',
              dt=1e-3, end=1.0, body=(0, 0, 0), correctors=3, u_walls='slip', u0=(0, 0, 0), outer=1,
              ddt='Euler', laplacian='Gauss linear corrected', outlet=(), box=True, u_patch=None,
              tolerance=1e-12, mesh=None, nonorth=0, noise=0.0,
              predictor=False, closure=False):
    """A case for prescribedSolidsFoam (and, with other dictionaries added, for cfdDemFoam).

    mesh: options for tests/meshes/makeMesh.py, instead of blockMesh; kinds says the same sides."""
    case = Case(path)
    case.write('system/controlDict', {
        'application': 'prescribedSolidsFoam', 'startFrom': 'startTime', 'startTime': 0,
        'stopAt': 'endTime', 'endTime': end, 'deltaT': dt, 'writeControl': 'runTime',
        'writeInterval': end, 'writeFormat': 'ascii', 'writePrecision': 17, 'timeFormat': 'general',
        'timePrecision': 12, 'runTimeModifiable': 'no'})
    case.write('system/fvSchemes', {
        'ddtSchemes': {'default': ddt}, 'gradSchemes': {'default': 'Gauss linear'},
        'divSchemes': {'default': 'none', 'div(phi,U)': div},
        'laplacianSchemes': {'default': laplacian}, 'interpolationSchemes': {'default': 'linear'},
        'snGradSchemes': {'default': laplacian.replace('Gauss linear ', '')}})
    solver = {'solver': 'PCG', 'preconditioner': 'DIC', 'tolerance': tolerance, 'relTol': 0}
    transport = {'solver': 'PBiCGStab', 'preconditioner': 'DILU', 'tolerance': tolerance, 'relTol': 0}
    case.write('system/fvSolution', {
        'solvers': {'p_rgh': solver, 'p_rghFinal': solver, 'U': transport, 'UFinal': transport},
        'PIMPLE': {'momentumPredictor': predictor, 'momentumClosure': closure,
                   'nOuterCorrectors': outer, 'nCorrectors': correctors,
                   'nNonOrthogonalCorrectors': nonorth, 'pRefCell': 0, 'pRefValue': 0}})
    case.write('constant/transportProperties', {'nu': '[0 2 -1 0 0 0 0] %r' % nu, 'model': model,
                                               'initialNoise': noise})
    case.write('constant/g', {'dimensions': '[0 1 -2 0 0 0 0]', 'value': (0, 0, 0)},
               'uniformDimensionedVectorField')
    case.write('constant/bodyAcceleration', {'dimensions': '[0 1 -2 0 0 0 0]', 'value': body},
               'uniformDimensionedVectorField')
    case.write('constant/prescribedSolids', {'regions': [dict(r) for r in regions]})
    if mesh:
        case.mesh(lo, hi, cells, kinds, mesh)
    elif box:
        case.box(lo, hi, cells, kinds)
    u_boundary, p_boundary = {}, {}
    for name in ('xMin', 'xMax', 'yMin', 'yMax', 'zMin', 'zMax'):
        kind = kinds[name] if name in kinds else kinds[name[0]]
        if kind in ('cyclic', 'empty', 'symmetryPlane'):
            u_boundary[name] = p_boundary[name] = {'type': kind}
        else:
            u_boundary[name] = {'type': u_walls}
            p_boundary[name] = {'type': 'fixedFluxPressure', 'value': 'uniform 0'}
        if u_patch and name in u_patch:
            u_boundary[name] = u_patch[name]
        if name in outlet:
            u_boundary[name] = {'type': 'zeroGradient'}
            p_boundary[name] = {'type': 'fixedValue', 'value': 'uniform 0'}
    case.field('U', (0, 1, -1, 0, 0, 0, 0), u0, u_boundary,
               None if isinstance(u0, (list, tuple)) else 'volVectorField')
    case.field('p_rgh', (0, 2, -2, 0, 0, 0, 0), 0.0, p_boundary)
    return case


def steps(text):
    """The 'step' lines of prescribedSolidsFoam as a list of dicts."""
    rows = []
    for line in text.splitlines():
        words = line.split()
        if not words or words[0] != 'step':
            continue
        row, key = {}, None
        for word in words[1:]:
            if word[0].isalpha() and word not in ('nan', 'inf'):
                key = word
                row[key] = []
            else:
                row[key].append(float(word))
        rows.append({k: v[0] if len(v) == 1 else np.array(v) for k, v in row.items()})
    return rows
