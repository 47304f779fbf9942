# SPDX-License-Identifier: GPL-3.0-or-later
"""metric porousBlock.<model>.{error,spread,seconds}: 7 x 7 x 16 cells of 16 mm, 21 x 21 x 10 spheres of 4 mm in layers
of 2, 3, 3, 2 per cell, water, periodic, g = 9.81 m/s2 as body acceleration, dt 2 ms, 3 s; median of five runs."""
import os
import statistics
import sys
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, '..', 'validation', 'lib'))
sys.path.insert(0, os.path.join(HERE, '..', 'foam', 'lib'))
from closed_forms import porous_block_flow  # noqa: E402
from coupled import CELL, DIAMETER, GRAVITY, PITCH, WATER, case_path, coupled, lattice, solve  # noqa: E402

LAYERS = (18, 27, 27, 18)  # spheres per cell along the flow
RUNS = 5


def run(model):
    case = coupled(case_path('porousBlock' + model), cells=(7, 7, 16), body=(0, 0, GRAVITY), u0=(0, 0, 0.9), dt=2e-3,
                   end=3.0, coupling={'model': model},
                   insertion={'block': lattice((21, 21, 10), 6 * CELL + PITCH)})
    start = time.time()
    solve(case)
    seconds = time.time() - start
    j = case.read('3/j')[:, 2]
    exact = porous_block_flow(LAYERS, CELL, CELL ** 3, 16 * CELL, DIAMETER, WATER["nu"])
    return abs(j.mean() / exact - 1), (j.max() - j.min()) / exact, seconds


for name in 'AB':
    runs = [run(name) for _ in range(RUNS)]
    for k, (what, unit) in enumerate((('error', '1'), ('spread', '1'), ('seconds', 's'))):
        print('metric porousBlock.model%s.%s %.4g %s' % (name, what, statistics.median(r[k] for r in runs), unit), flush=True)
