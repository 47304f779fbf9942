# SPDX-License-Identifier: GPL-3.0-or-later
"""Small demFoam cases for tests: particles alone, no fields, no fvSchemes. SI units."""
import coupled
from foamcase import Case

LAW = {'law': 'linearSpringDashpot', 'normalStiffness': 1000.0, 'restitution': 0.8, 'friction': 0.4}
CLOUD = {'method': 'random', 'material': 'glass', 'diameter': 0.006, 'diameterMax': 0.009, 'origin': (0.01, 0.0, 0.01),
         'extent': (0.08, 0.1, 0.08), 'number': 300}


def alone(path, *, lo=(0, 0, 0), hi=(0.1, 0.1, 0.1), cells=(4, 4, 4), kinds=None, g=(0, 0, -9.81), contact=None, walls=None,
          insertion=None, times=None, **dem):
    """A case for demFoam: a box of glass walls, periodic in y; 300 spheres are dropped. contact: what differs from LAW;
    times: entries of controlDict; dem: further entries of demProperties (materials, contacts replace those of glass)."""
    kinds = kinds or {'x': 'wall', 'y': 'cyclic', 'z': 'wall'}
    case = Case(path)
    coupled.control(case, **dict({'application': 'demFoam', 'deltaT': 0.01, 'endTime': 0.2, 'writeInterval': 0.1,
                                  'writeControl': 'runTime'}, **(times or {})))
    case.box(lo, hi, cells, kinds)
    case.write('constant/g', {'dimensions': '[0 1 -2 0 0 0 0]', 'value': g}, 'uniformDimensionedVectorField')
    if walls is None:
        walls = {'box': {'type': 'patches', 'patches': '("[xz].*")', 'material': 'glass'}}
    case.write('constant/demProperties', dict({
        'materials': {'glass': {'density': 2500.0}}, 'contacts': {'default': dict(LAW, **(contact or {}))},
        'walls': walls, 'insertion': insertion or {'cloud': CLOUD}}, **dem))
    return case


def solve(case, ranks=1, **options):
    return coupled.solve(case, ranks, solver='demFoam', **options)


def sphere(z, d=0.01, velocity=(0, 0, 0), **more):
    """Insertion of one sphere in the middle of the box."""
    return {'sphere': dict({'method': 'lattice', 'material': 'glass', 'diameter': d, 'origin': (0.05, 0.05, z),
                            'count': (1, 1, 1), 'velocity': velocity}, **more)}
