# SPDX-License-Identifier: GPL-3.0-or-later
"""Bad input: cases with one mistake each. The run must end with exit status not 0 and a message that holds the words given,
before it has written anything."""
import hashlib
import os
import re
import shutil


def replace(name, pattern, text):
    """The mistake: text for the first match of pattern in a file of the case."""
    def apply(case):
        path = os.path.join(case.path, name)
        with open(path) as source:
            old = source.read()
        new = re.sub(pattern, text, old, count=1, flags=re.S)
        assert new != old, '%s: nothing matches %s' % (name, pattern)
        with open(path, 'w') as out:
            out.write(new)
    return apply


def remove(name):
    return lambda case: os.remove(os.path.join(case.path, name))


def tree(folder):
    """Name and contents of every file that a result could be in."""
    found = {}
    for at, _, names in os.walk(folder):
        for name in names:
            if not name.startswith('log.'):
                with open(os.path.join(at, name), 'rb') as source:
                    found[os.path.join(at, name)] = hashlib.sha1(source.read()).hexdigest()
    return found


def refused(checks, good, build, solve, mistakes, results, only=()):
    """One check per row of mistakes {name: (mistake, words)}. good: a case that has run; results: its files and folders that
    must stay; build(name): the case anew; solve(case): (exit status, log)."""
    for name, (mistake, words) in mistakes.items():
        if only and name not in only:
            continue
        case = build(name)
        for result in results:
            shutil.copytree(os.path.join(good.path, result), os.path.join(case.path, result))
        mistake(case)
        before = tree(case.path)
        status, text = solve(case)
        error = text[text.find('--> FOAM FATAL'):]
        error = error[:error.find('FOAM exiting')] if '--> FOAM FATAL' in text else ''
        missing = [w for w in words if w not in error]
        why = []
        if status == 0:
            why.append('exit status 0')
        if not error:
            why.append('no error message: ...%s' % ' '.join(text.split()[-30:]))
        elif missing:
            why.append('no %s in: %s' % (missing, ' '.join(error.split())))
        if tree(case.path) != before:
            why.append('files changed')
        checks.check(name, not why, '; '.join(why))
