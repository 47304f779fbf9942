# SPDX-License-Identifier: GPL-3.0-or-later
"""Read what a case wrote: fields (ascii), times, function objects, the solver's log. Numbers only, no OpenFOAM needed."""
import json
import os
import re

import numpy as np


def internal_field(path, cells):
    """Internal field of an ascii field file: [cells] or [cells][3]."""
    with open(path) as source:
        text = source.read()
    uniform = re.search(r'internalField\s+uniform\s+([^;]*);', text)
    if uniform:
        value = [float(word) for word in uniform.group(1).strip('() ').split()]
        return np.tile(value if len(value) > 1 else value[0], (cells, 1) if len(value) > 1 else cells)
    head = re.search(r'internalField\s+nonuniform\s+List<(scalar|vector)>\s*(\d+)\s*\(', text)
    if not head or int(head.group(2)) != cells:
        raise ValueError('%s: no ascii internalField of %d values' % (path, cells))
    width = 3 if head.group(1) == 'vector' else 1
    words = text[head.end():].replace('(', ' ').replace(')', ' ').split(None, cells * width)[:cells * width]
    values = np.array(words, float)
    return values.reshape(-1, 3) if width == 3 else values


def column(path, shape):
    """Field of a block mesh of shape (nx, ny, nz) as [nz][ny][nx] (and [3])."""
    nx, ny, nz = shape
    values = internal_field(path, nx * ny * nz)
    return values.reshape((nz, ny, nx) + values.shape[1:])


def times(case):
    """Names of the times written, but 0, in order: of the time directories, or of the particles where there are none (demFoam and sphDemFoam on
    several ranks has its fields, which are nobody's, in processor*)."""
    names = [n for n in os.listdir(case) if re.fullmatch(r'[0-9.]+(e-?[0-9]+)?', n) and float(n) > 0]
    for folder in ('particles', 'fluid'):
        if names or not os.path.isdir(os.path.join(case, folder)):
            continue
        names = [n[:-7] for n in os.listdir(os.path.join(case, folder)) if re.fullmatch(r'[0-9.]+(e-?[0-9]+)?\.vtkhdf', n)]
    return sorted((n for n in names if float(n) > 0), key=float)


def function_object(case, name):
    """Rows of numbers of a function object's only file (the latest start); brackets of vectors are dropped."""
    folder = os.path.join(case, 'postProcessing', name)
    start = max(os.listdir(folder), key=float)
    (file,) = os.listdir(os.path.join(folder, start))
    with open(os.path.join(folder, start, file)) as source:
        rows = [line.replace('(', ' ').replace(')', ' ').split() for line in source if line[0] != '#']
    return np.array(rows, float)


def log_series(log, label):
    """(t, value) of the number that follows label in the log, one per time step."""
    rows, t = [], None
    with open(log) as source:
        for line in source:
            if line.startswith('Time = '):
                t = float(line.split()[2].rstrip(','))
            elif label in line and t is not None:
                rows.append((t, float(re.match(r'\s*([-+.\de]+)', line.split(label, 1)[1]).group(1))))
    return np.array(rows).T


def clock(log):
    """(wall clock, processor) seconds of a finished run."""
    found = None
    with open(log) as source:
        for line in source:
            match = re.search(r'ExecutionTime = ([\d.]+) s\s*,?\s*ClockTime = ([\d.]+) s', line)
            found = match or found
    return float(found.group(2)), float(found.group(1))


def particles(case, time):
    """(centres [n][3], diameters [n]) in particles/<time>.vtkhdf."""
    import h5py
    with h5py.File(os.path.join(case, 'particles', time + '.vtkhdf'), 'r') as source:
        group = source['VTKHDF']
        return group['Points'][:], 2 * group['PointData/radius'][:]


def particle_data(case, time, folder='particles'):
    """All arrays of particles/<time>.vtkhdf (folder 'fluid': of those of a fluid) by name ('Points': centres), rows in the order of id."""
    import h5py
    with h5py.File(os.path.join(case, folder, time + '.vtkhdf'), 'r') as source:
        found = {name: value[:] for name, value in source['VTKHDF/PointData'].items()}
        found['Points'] = source['VTKHDF/Points'][:]
    order = np.argsort(found['id'])
    return {name: value[order] for name, value in found.items()}


def table(case, folder, name):
    """A table of demFoam (postProcessing/folder/<start>/name), later starts over earlier ones: {column: values}. Columns of a
    vector are named in the header as 'momentum x y z'; they come as [n][3]."""
    root = os.path.join(case, 'postProcessing', folder)
    parts = []
    for start in sorted(os.listdir(root), key=float):
        path = os.path.join(root, start, name)
        rows = np.loadtxt(path, ndmin=2)
        parts = [p[p[:, 0] < rows[0, 0]] for p in parts] + [rows]
    with open(path) as source:
        heads = source.readline().lstrip('# ').rstrip().split('\t')
    rows, found, at = np.concatenate(parts), {}, 0
    for head in heads:
        head = re.sub(r' *\[.*\]', '', head)
        width = 3 if head.endswith(' x y z') else 1
        found[re.sub(r' x y z$', '', head)] = rows[:, at:at + 3] if width == 3 else rows[:, at]
        at += width
    return found


class Results:
    """Rows (quantity, unit, computed, closed form, paper), printed and kept for tutorials/comparison."""

    def __init__(self, case, compared='closed form', published='paper'):
        """compared, published: heads of the columns of the two kinds of reference."""
        self.case, self.rows, self.heads = case, [], dict(compared=compared, published=published)

    def add(self, quantity, unit, computed, closed=None, paper='', digits=4, limit=None):
        """limit: largest relative difference to the closed form; beyond it the case has failed."""
        computed, closed = float(computed), None if closed is None else float(closed)
        good = bool(np.isfinite(computed)) and (limit is None or abs(computed / closed - 1) < limit)
        self.rows.append(dict(quantity=quantity, unit=unit, computed=computed, closed=closed, paper=paper,
                              digits=digits, limit=limit, good=good))

    def require(self, good):
        """A condition on the last row that is not its difference to a closed form."""
        self.rows[-1]['good'] = self.rows[-1]['good'] and bool(good)

    def finish(self, path, seconds):
        """Write path (json), print the rows; exit status for the script."""
        with open(path, 'w') as out:
            json.dump(dict(case=self.case, seconds=seconds, rows=self.rows), out, indent=1)
        print_table([dict(r, case=self.case, seconds=seconds) for r in self.rows], **self.heads)
        return 0 if all(r['good'] for r in self.rows) else 1


def difference(computed, closed):
    """Relative difference in percent as text; round-off is not told apart."""
    if not closed:
        return '-'
    percent = 100 * (computed / closed - 1)
    return '< 1e-6 %' if abs(percent) < 1e-6 else '%+.2g %%' % percent


def print_table(rows, out=None, compared='closed form', published='paper'):
    """Rows of Results as a text table; those of a comparison have their method, too."""
    methods = any('method' in r for r in rows)
    lines = [('case', 'quantity', 'unit') + ('method',) * methods + ('computed', compared, 'difference', published, 'run time')]
    last, timed = None, set()
    for r in rows:
        number = '%.{}g'.format(r['digits'])
        closed, run = r['closed'], (r['case'], r.get('method'))
        lines.append(
            (r['case'] if r['case'] != last else '', r['quantity'], r['unit']) + (r.get('method', '-'),) * methods + (
                number % r['computed'] + ('' if r['good'] else ' (!)'),
                '-' if closed is None else number % closed,
                difference(r['computed'], closed),
                r['paper'] or '-', '%.0f s' % r['seconds'] if run not in timed else ''))
        last = r['case']
        timed.add(run)
    widths = [max(len(line[k]) for line in lines) for k in range(len(lines[0]))]
    for k, line in enumerate(lines):
        print('  '.join(word.ljust(width) for word, width in zip(line, widths)).rstrip(), file=out)
        if k == 0:
            print('  '.join('-' * width for width in widths), file=out)
