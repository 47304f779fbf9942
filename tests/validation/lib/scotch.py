# SPDX-License-Identifier: GPL-3.0-or-later
"""Partition of a mesh by the scotch library itself, for OpenFOAM packages that were built without it (Debian's
decomposePar has a stub for 'method scotch'; its 'ptscotch' needs redistributePar, which v1912 gets wrong at cyclic
patches). The result goes to decomposePar as 'method manual'."""
import ctypes
import ctypes.util
import glob
import os
import re

import numpy as np


def label_list(path):
    """Contents of an ascii labelList of polyMesh."""
    with open(path) as source:
        text = re.sub(r'^.*?// \*.*?\n|FoamFile\s*\{.*?\}', '', source.read(), flags=re.S)
    body = text[text.index('(') + 1:text.rindex(')')]
    return np.array(body.split(), dtype=int)


def library():
    names = glob.glob('/usr/lib/*/libscotch-*.so') + [ctypes.util.find_library('scotch') or '']
    names = [n for n in names if n and (not n.startswith('/') or os.path.exists(n))]
    if not names:
        return None
    errors = glob.glob('/usr/lib/*/libscotcherr-*.so')
    if errors:
        ctypes.CDLL(errors[0], mode=ctypes.RTLD_GLOBAL)
    return ctypes.CDLL(names[0], mode=ctypes.RTLD_GLOBAL)


def partition(mesh, parts):
    """Rank of each cell of the polyMesh folder; None without libscotch."""
    scotch = library()
    if scotch is None:
        return None
    owner, neighbour = (label_list(os.path.join(mesh, n)) for n in ('owner', 'neighbour'))
    cells = owner.max() + 1
    pairs = [[] for _ in range(cells)]
    for p, n in zip(owner, neighbour):
        pairs[p].append(n)
        pairs[n].append(p)
    number = np.int64 if scotch.SCOTCH_numSizeof() == 8 else np.int32
    start = np.concatenate(([0], np.cumsum([len(p) for p in pairs]))).astype(number)
    ends = np.concatenate([np.array(p) for p in pairs]).astype(number)
    rank = np.zeros(cells, number)
    kind = ctypes.c_int64 if number is np.int64 else ctypes.c_int32
    at = lambda a: a.ctypes.data_as(ctypes.c_void_p)
    graph, strategy = ctypes.create_string_buffer(4096), ctypes.create_string_buffer(4096)
    assert scotch.SCOTCH_graphInit(graph) == 0 and scotch.SCOTCH_stratInit(strategy) == 0
    after = ctypes.c_void_p(start.ctypes.data + start.itemsize)
    assert scotch.SCOTCH_graphBuild(graph, kind(0), kind(cells), at(start), after, None, None,
                                    kind(len(ends)), at(ends), None) == 0
    assert scotch.SCOTCH_graphPart(graph, kind(parts), strategy, at(rank)) == 0
    scotch.SCOTCH_graphExit(graph)
    return rank.tolist()
