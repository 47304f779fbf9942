# SPDX-License-Identifier: GPL-3.0-or-later
"""metric goldschmidt.{step,vsDPMFoam,couplingShare,stage.*}: a window is one run of each solver from the same developed bed.
Times of steps are CPU time, which a busy machine changes least; shares are of wall-clock time within our own run."""
import argparse
import hashlib
import os
import re
import shutil
import statistics
import subprocess
import sys

import h5py
import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.normpath(os.path.join(HERE, '..', '..'))
CASE = os.path.join(ROOT, 'tutorials', 'cfdDemFoam', 'goldschmidtBed')
sys.path.insert(0, os.path.join(ROOT, 'tests', 'foam', 'lib'))
sys.path.insert(0, HERE)
import goldschmidtPeer  # noqa: E402
from foamcase import foam  # noqa: E402

START = '0.3'                    # s, when the bed bubbles
DT = 2e-5                        # s
STEPS, PEER_STEPS = 150, 20      # of a window
FIRST = 5                        # steps of a window that are not counted
SPEED, DIAMETER, DENSITY = 1.875, 2.5e-3, 2526.0
COUPLING = ('locate', 'void fraction', 'sample fluid', 'fluid force', 'momentum source', 'reaction')
CONTACT = ('integrate', 'contact', 'walls', 'neighbours', 'ghosts')


def edit(path, *changes):
    with open(path) as source:
        text = source.read()
    for pattern, new in changes:
        text, found = re.subn(pattern, new, text, flags=re.S)
        if found != 1:
            sys.exit('goldschmidt: %d times %s in %s' % (found, pattern, path))
    with open(path, 'w') as out:
        out.write(text)


def our_case(path):
    """The tutorial, made as large as the experiment, with one size of spheres."""
    shutil.rmtree(path, ignore_errors=True)
    os.makedirs(path)
    for name in ('constant', 'system'):
        shutil.copytree(os.path.join(CASE, name), os.path.join(path, name), ignore=shutil.ignore_patterns('polyMesh'))
    shutil.copytree(os.path.join(CASE, '0.orig'), os.path.join(path, '0'))
    edit(os.path.join(path, 'system/blockMeshDict'), (r'yMin +\S+;', 'yMin -0.075;'), (r'yMax +\S+;', 'yMax 0.075;'),
         (r'zMax +\S+;', 'zMax 0.45;'), (r'cells +\(2 15 45\)', 'cells (2 30 90)'))
    bed = {'method': 'lattice', 'material': 'glass', 'diameter': DIAMETER, 'origin': (-0.006, -0.0735, 0.0015),
           'spacing': (0.003, 0.003, 0.003), 'count': (5, 50, 99)}
    edit(os.path.join(path, 'constant/demProperties'), (r'insertion\n.*', 'insertion %s' % foam({'bed': bed})),
         (r'youngsModulus \S+;', 'youngsModulus 1e8;'), (r'0 0 0.225\)', '0 0 0.45)'),
         (r'0 -0.0375 0\); n', '0 -0.075 0); n'), (r'0 0.0375 0\); n', '0 0.075 0); n'))
    edit(os.path.join(path, 'constant/couplingProperties'), (r'\ndrag [^\n]*', '\ndrag gidaspow;'))
    edit(os.path.join(path, 'system/controlDict'), (r'\nfunctions\n.*', '\n'))
    edit(os.path.join(path, '0/U'), (r'inletVelocity +uniform[^;]*;', 'inletVelocity uniform (0 0 %g);' % SPEED))
    return path


def control(path, **words):
    edit(os.path.join(path, 'system/controlDict'), *[(r'\n%s +[^\n]*' % k, '\n%s %s;' % (k, v)) for k, v in words.items()])


def run(path, *command):
    with open(os.path.join(path, 'log.' + command[0]), 'w') as log:
        if subprocess.run(command, cwd=path, stdout=log, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL).returncode:
            sys.exit('goldschmidt: %s failed, see %s' % (command[0], log.name))
    with open(log.name, errors='replace') as text:
        return text.read()


def developed(data):
    """Our case with a bubbling bed at START; made once per set of dictionaries."""
    fresh = our_case(os.path.join(data, 'goldschmidt.new'))
    key = hashlib.sha1()
    for folder, _, names in sorted(os.walk(fresh)):
        for name in sorted(names):
            with open(os.path.join(folder, name), 'rb') as source:
                key.update(source.read())
    kept = os.path.join(data, 'goldschmidt.%s.%s' % (START, key.hexdigest()[:12]))
    if not os.path.isdir(kept):
        print('making the bed: %s s of fluidisation' % START, flush=True)
        control(fresh, endTime=START, deltaT=1e-4, writeInterval=START, writeFormat='ascii', writePrecision=17)
        edit(os.path.join(fresh, 'constant/demProperties'), (r'timeStepFraction +\S+;', 'timeStepFraction 0.2;'))
        run(fresh, 'blockMesh')
        run(fresh, 'cfdDemFoam')
        edit(os.path.join(fresh, 'constant/demProperties'), (r'timeStepFraction +\S+;', 'timeStepFraction 0.1;'))
        os.rename(fresh, kept)
    shutil.rmtree(fresh, ignore_errors=True)
    control(kept, endTime=float(START) + DT * STEPS, deltaT=DT, writeInterval=1, timePrecision=10)
    return kept


def spheres(kept):
    """[24750][6] positions (m) and velocities (m/s) at START."""
    with h5py.File(os.path.join(kept, 'particles', START + '.vtkhdf'), 'r') as file:
        group = file['VTKHDF']
        return np.hstack([group['Points'][()], group['PointData/velocity'][()]])


def step_ms(text):
    """Mean CPU time of a step (ms), without the first ones; the log counts in hundredths of a second."""
    cpu = [float(v) for v in re.findall(r'ExecutionTime = ([\d.]+) s', text)]
    return 1e3 * (cpu[-1] - cpu[FIRST - 1]) / (len(cpu) - FIRST)


def stages(text):
    """{stage: wall-clock seconds} of the tables at the end of a log; a name that is in two of them counts for the first."""
    found = {}
    for name, seconds in re.findall(r'^([a-z][a-z, ]*?) +\d+ +([\d.e+-]+) +[\d.e+-]+ +[\d.]+%$', text, flags=re.M):
        found.setdefault(name, []).append(float(seconds))
    return found


def window(kept):
    text = run(kept, 'cfdDemFoam')
    substeps = {int(n) for n in re.findall(r'^Particles: 24750 substeps (\d+)', text, flags=re.M)}
    if substeps != {5}:
        sys.exit('goldschmidt: contact steps a fluid step are %s, not 5' % sorted(substeps))
    found = stages(text)
    flow = ['step size', 'particles and exchange', 'face coefficients', 'momentum', 'pressure', 'turbulence', 'reaction',
            'report and output']
    # 'reaction' is a stage of the solver (first) and, within it, one of the coupling (last)
    total = sum(found[name][0] for name in flow)
    coupling = sum(found[name][-1] for name in COUPLING)
    part = {'coupling.' + name: found[name][-1] / total for name in COUPLING}
    part.update({'contact.' + name: found[name][0] / total for name in CONTACT})
    part.update({'flow.' + name: found[name][0] / total for name in flow[2:5]})
    return step_ms(text), coupling / total, part


def main():
    options = argparse.ArgumentParser()
    options.add_argument('data')
    options.add_argument('--peers', action='store_true')
    options.add_argument('--rounds', type=int, default=5)
    options = options.parse_args()
    kept = developed(options.data)
    peer = goldschmidtPeer.case(os.path.join(options.data, 'goldschmidt.DPMFoam'), kept, START, spheres(kept), DIAMETER,
                                DENSITY, SPEED, DT, PEER_STEPS) if options.peers else None
    ours, theirs, ratios = [], [], []
    for k in range(options.rounds):
        ours.append(window(kept))
        if peer:
            theirs.append(step_ms(run(peer, 'DPMFoam')))
            ratios.append(theirs[-1] / ours[-1][0])
        print('round %d: %.1f ms%s' % (k + 1, ours[-1][0], ', DPMFoam %.1f ms' % theirs[-1] if peer else ''), flush=True)
    median = statistics.median
    print('metric goldschmidt.step %.2f ms' % median(o[0] for o in ours))
    print('metric goldschmidt.couplingShare %.1f %%' % (100 * median(o[1] for o in ours)))
    for name in ours[0][2]:
        print('metric goldschmidt.stage.%s %.1f %%' % (name.replace(' ', '_'), 100 * median(o[2][name] for o in ours)))
    if peer:
        print('metric goldschmidt.DPMFoam %.1f ms' % median(theirs))
        print('metric goldschmidt.vsDPMFoam %.2f 1' % median(ratios))


main()
