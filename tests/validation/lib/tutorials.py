# SPDX-License-Identifier: GPL-3.0-or-later
"""Run tutorials, some of them shortened, in copies, with the limits of their own plots. One check per row of the table that each prints."""
import json
import os
import re
import shutil
import subprocess
import sys

from coupled import HERE, case_path

ROOT = os.path.normpath(os.path.join(HERE, '..', '..', '..'))


def copy_of(case, folder, tree):
    """The case in a tree of its own, beside the same tools."""
    to = os.path.join(tree, 'tutorials', folder, case)
    shutil.rmtree(to, ignore_errors=True)
    shutil.copytree(os.path.join(ROOT, 'tutorials', folder, case), to,
                    ignore=shutil.ignore_patterns('runs', 'particles', 'postProcessing', '0', '0.[0-9]*', 'log.*', '*.png', 'polyMesh', 'results.json'))
    return to


def shorten(folder, name, pattern, text):
    path = os.path.join(folder, name)
    with open(path) as source:
        old = source.read()
    new = re.sub(pattern, text, old)
    assert new != old, '%s: nothing matches %s' % (path, pattern)
    with open(path, 'w') as out:
        out.write(new)


def run(checks, folder, cases):
    """cases: (name, options of Allrun, (file, pattern, text) that shortens it or None, arguments of plot)."""
    tree = case_path(folder + '_tutorials')
    shutil.rmtree(tree, ignore_errors=True)
    os.makedirs(os.path.join(tree, 'tutorials'))
    os.symlink(os.path.join(ROOT, 'etc'), os.path.join(tree, 'etc'))
    os.symlink(os.path.join(ROOT, 'tests'), os.path.join(tree, 'tests'))
    os.symlink(os.path.join(ROOT, 'tutorials', 'tools'), os.path.join(tree, 'tutorials', 'tools'))
    for case, options, shorter, arguments in cases:
        if sys.argv[1:] and case not in sys.argv[1:]:
            continue
        one(checks, copy_of(case, folder, tree), case, options, shorter, arguments)


def one(checks, folder, case, options, shorter, arguments):
    label = case + ''.join('_' + word.strip('-') for word in options if word[0] == '-' and word != '-run')
    if shorter:
        shorten(folder, *shorter)
    command = './Allrun -noPlot "$@" && %s plot %s' % (sys.executable, ' '.join(arguments))
    run = subprocess.run(['sh', '-c', command, 'sh', *options], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    try:
        with open(os.path.join(folder, *arguments[:1], 'results.json')) as source:
            rows = json.load(source)['rows']
    except OSError:
        checks.check('%s_runs' % label, False, ' '.join(run.stdout.split()[-60:]))
        return
    for row in rows:
        name = '%s:%s' % (label, re.sub(r'[ ,:/=]+', '_', row['quantity'].strip()))
        checks.note('%-60s %.6g' % (name, row['computed']))
        checks.check(name, row['good'], '%g, to be %s %s' % (row['computed'], row['closed'], row['paper']))
