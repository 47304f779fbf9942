# SPDX-License-Identifier: GPL-3.0-or-later
"""A run of the study: a copy of a tutorial's case, with another resolution."""
import importlib.machinery
import importlib.util
import os
import re
import shutil
import subprocess
import sys

import numpy as np

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', '..')
TUTORIALS = os.path.join(ROOT, 'tutorials')
OUT = os.path.join(os.environ.get('CFDDEM_BUILD') or os.path.join(ROOT, 'build'), 'tests', 'benchmark', 'study')
sys.path[:0] = [os.path.join(TUTORIALS, 'tools')]
import foamData as fd  # noqa: E402

CFD, SPH = SOLVERS = ('cfdDemFoam', 'sphDemFoam')


def script(tutorial, name='plot'):
    """A tutorial's own script as a module: its closed forms and how it measures."""
    sys.dont_write_bytecode = True
    loader = importlib.machinery.SourceFileLoader('_'.join((os.path.basename(tutorial), name)), os.path.join(TUTORIALS, tutorial, name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    loader.exec_module(module)
    return module


class Run:
    """A copy of a tutorial's case in OUT/<name>."""

    def __init__(self, tutorial, name, solver):
        self.tutorial, self.name, self.solver = tutorial, name, solver
        self.path, self.source = os.path.join(OUT, name), os.path.join(TUTORIALS, tutorial)
        shutil.rmtree(self.path, ignore_errors=True)
        for folder in ('constant', 'system'):
            shutil.copytree(os.path.join(self.source, folder), os.path.join(self.path, folder), ignore=shutil.ignore_patterns('polyMesh'))
        shutil.copytree(os.path.join(self.source, '0.orig'), os.path.join(self.path, '0'))

    def set(self, name, entry, value):
        self.call(['foamDictionary', name, '-entry', entry, '-set', value if isinstance(value, str) else '%.12g' % value])

    def control(self, **entries):
        for entry, value in entries.items():
            self.set('system/controlDict', entry, value)

    def cells(self, *n, blocks=1):
        """Of each block of the mesh."""
        path = os.path.join(self.path, 'system', 'blockMeshDict')
        with open(path) as source:
            text, count = re.subn(r'\) \(\d+ \d+ \d+\) simple', ') (%d %d %d) simple' % tuple(n), source.read())
        if count != blocks:
            raise RuntimeError('%s: %d blocks to set the cells of, not %d' % (path, count, blocks))
        with open(path, 'w') as out:
            out.write(text)

    def points(self, n, width, ratio=None):
        """n fluid particles across the width; ratio: h over their distance, that of the tutorial if None. Returns h."""
        name = 'constant/sphProperties'
        with open(os.path.join(self.path, name)) as source:
            text = source.read()
        entry = lambda key: float(re.search(r'\b%s\s+([-\d.e]+);' % key, text).group(1))
        h = width / n * (ratio or entry('smoothingLength') / entry('spacing'))
        self.set(name, 'spacing', width / n)
        self.set(name, 'smoothingLength', h)
        return h

    def settings(self, *words):
        """constant/settings (and what else it writes) by the tutorial's own script; returns its entries as text."""
        done = subprocess.run([sys.executable, os.path.join(self.source, 'settings'), *map(str, words)], cwd=self.path, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        if done.returncode != 0:
            raise RuntimeError('settings %s: %s' % (' '.join(map(str, words)), ' '.join(done.stderr.split()[-40:])))
        with open(os.path.join(self.path, 'constant', 'settings'), 'w') as out:
            out.write(done.stdout)
        return dict(re.findall(r'^(\w+)\s+(.*);', done.stdout, re.M))

    def take(self, values, name, **entries):
        """Entries of a dictionary from settings(): entry='key there'."""
        for entry, key in entries.items():
            self.set(name, entry.replace('__', '/'), values[key])

    def call(self, command):
        log = os.path.join(self.path, 'log.' + command[0])
        with open(log, 'a') as out:
            done = subprocess.run(command, cwd=self.path, stdout=out, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
                                  env=dict(os.environ, PWD=os.path.realpath(self.path)))
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


def against(found, closed, **more):
    """What a case returns: the number found, what it is compared with, the relative error."""
    return dict(found=float(found), closed=float(closed), error=abs(float(found / closed - 1)), **more)
