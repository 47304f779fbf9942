# SPDX-License-Identifier: GPL-3.0-or-later
"""Report of a test script: lines 'ok name', 'not ok name why' and '# measured numbers'."""
import os
import sys


class Checks:
    def __init__(self):
        self.failed = 0

    def note(self, text):
        print('# ' + text, flush=True)

    def check(self, name, good, why=''):
        """A result that is not a number is not good: pass comparisons that are False for nan."""
        print('ok %s' % name if good else 'not ok %s %s' % (name, why), flush=True)
        self.failed += not good

    def below(self, name, value, limit):
        """|value| < limit; the number is printed either way."""
        self.note('%-60s %.3e (limit %.1e)' % (name, value, limit))
        self.check(name, abs(value) < limit, '%.3e is not below %.1e' % (value, limit))

    def finish(self):
        sys.exit(1 if self.failed else 0)


def case_path(name):
    """Where a test keeps its case: build/tests/foam/cases/NAME, left for inspection."""
    root = os.environ.get('CFDDEM_BUILD') or os.path.join(
        os.path.dirname(os.path.abspath(__file__)), '..', '..', '..', 'build')
    return os.path.join(os.path.abspath(root), 'tests', 'foam', 'cases', name)
