# SPDX-License-Identifier: GPL-3.0-or-later
"""A run that stops at a write and goes on, against the run without stop: bytes."""
import os
import re
import shutil

from coupled import arrays, control, times


def files(folder):
    """Relative paths of all files under folder."""
    return sorted(os.path.relpath(os.path.join(at, name), folder) for at, _, names in os.walk(folder) for name in names)


def same_sum(a, b):
    """OpenFOAM's sum of continuity errors, which only the log shows: text of writePrecision digits also in binary files, so a
    run of 6 digits goes on from a rounded one."""
    values = []
    for path in (a, b):
        with open(path) as source:
            values.append(float(re.search(r'\nvalue +(\S+);', source.read()).group(1)))
    return abs(values[0] - values[1]) <= 1e-5 * abs(values[1])


def different(a, b):
    """Files under the folders a and b that differ (or are in one only)."""
    names = set(files(a)) | set(files(b))
    apart = []
    for name in sorted(names):
        pair = [os.path.join(folder, name) for folder in (a, b)]
        if os.path.basename(name) == 'cumulativeContErr' and all(map(os.path.exists, pair)) and same_sum(*pair):
            continue
        if not all(map(os.path.exists, pair)) or open(pair[0], 'rb').read() != open(pair[1], 'rb').read():
            apart.append(name)
    return apart


def different_arrays(a, b):
    a, b = arrays(a), arrays(b)
    return [n for n in sorted(set(a) | set(b)) if n not in a or n not in b or a[n].tobytes() != b[n].tobytes()]


def go_on(whole, ranks, entries, solve):
    """The case `whole` has run. A copy goes on from its middle write (entries: of its controlDict; solve(case): runs a
    decomposed case). Returns (time of the middle write, of the last, files compared, what differs at the last write)."""
    again = whole.path + '_again'
    shutil.rmtree(again, ignore_errors=True)
    shutil.copytree(whole.path, again)
    roots = [''] if ranks == 1 else ['processor%d' % r for r in range(ranks)]
    written = [t for t in times(os.path.join(whole.path, roots[0])) if float(t) > 0]
    middle, last = written[len(written) // 2 - 1], written[-1]
    for time in written[len(written) // 2:]:
        for root in roots:
            shutil.rmtree(os.path.join(again, root, time))
        os.remove(os.path.join(again, 'particles', time + '.vtkhdf'))
    second = type(whole).__new__(type(whole))
    second.path = again
    control(second, **dict(entries, startFrom='latestTime'))
    solve(second)
    apart = []
    for root in roots:
        apart += [os.path.join(root, f) for f in different(os.path.join(whole.path, root, last), os.path.join(again, root, last))]
    file = os.path.join('particles', last + '.vtkhdf')
    apart += ['%s:%s' % (file, n) for n in different_arrays(*(os.path.join(p, file) for p in (whole.path, again)))]
    count = sum(len(files(os.path.join(whole.path, root, last))) for root in roots)
    return middle, last, count, apart
