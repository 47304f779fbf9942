# SPDX-License-Identifier: GPL-3.0-or-later
"""Table and picture of the points of the study."""
import numpy as np

from run import CFD, SOLVERS

ROUND_OFF = 1e-7  # below: what the solvers of the linear systems and the closed form leave, not what a resolution makes


def report(row):
    name = 'study.%s.%s.%s' % (row['case'], row['solver'], row['resolution'].replace('=', ''))
    if 'failed' in row:
        print('FAILED %s: %s' % (name, row['failed']), flush=True)
        return
    print('metric %s.error %.4g 1' % (name, row['error']))
    for key in ('fromSharp', 'fromUniform', 'fromOwn'):
        if key in row:
            print('metric %s.%s %.4g 1' % (name, key, row[key]))
    print('metric %s.seconds %.4g s' % (name, row['seconds']), flush=True)


NOTES = {
    'poiseuille': lambda r: '1.2, 6, 30 ms: ' + ', '.join('%.3g %%' % (100 * e) for e in r['others']),
    'cylinderLattice': lambda r: 'through, between: ' + ', '.join('%.3g %%' % (100 * e) for e in r['others']),
    'stillTank': lambda r: 'level %+.3g %%, floor %+.3g %%, rms speed %.2g sqrt(gH)' % (*(100 * e for e in r['others']), r['speed']),
    'rti': lambda r: 'two waves: ' + ', '.join('%+.3g %%' % (100 * e) for e in r['others']),
}


def note(row):
    if row['case'] in NOTES:
        return NOTES[row['case']](row)
    for key, text in (('fromSharp', 'from a sharp block'), ('fromUniform', 'from uniform porosity'), ('fromOwn', 'from the speed at its cell\'s porosity')):
        if key in row:
            return '%s %+.2f %%' % (text, 100 * row[key])
    return ''


def table(rows, studies, out):
    form = '%-15s %-10s %-9s %12s %12s %11s %9s  %s'
    print(form % ('case', 'method', 'across', 'found', 'reference', 'error, %', 'seconds', 'more'), file=out)
    for case in studies:
        of = [r for r in rows if r['case'] == case]
        if of:
            print('%s: %s; %s' % (case, studies[case].error, studies[case].across), file=out)
        for r in of:
            if 'failed' in r:
                print('%-15s %-10s %-9s FAILED %s' % (case, r['solver'], r['resolution'], r['failed']), file=out)
                continue
            number = lambda key: '%.6g' % r[key] if key in r else '-'
            error = '%.4f' % (100 * r['error']) if r['error'] >= ROUND_OFF else 'round-off'
            print((form % (case, r['solver'], r['resolution'], number('found'), number('closed'), error, '%.2f' % r['seconds'],
                           note(r) + ('  (quick)' if r['quick'] else ''))).rstrip(), file=out)
        for solver, why in studies[case].why.items():
            if of:
                print('%-15s %-10s %s' % (case, solver, why), file=out)


def limits(values):
    """A third of a decade beyond them, and at least 1.2 decades, so that there is one with a number."""
    low, high = np.log10(min(values)) - 0.3, np.log10(max(values)) + 0.35
    more = max(0.0, 1.2 - (high - low)) / 2
    return 10 ** (low - more), 10 ** (high + more)


PLACES = ((0, 5, 'center', 'bottom'), (0, -6, 'center', 'top'), (6, 0, 'left', 'center'), (-6, 0, 'right', 'center'),
          (5, 4, 'left', 'bottom'), (-5, 4, 'right', 'bottom'), (5, -5, 'left', 'top'), (-5, -5, 'right', 'top'))


def write(ax, points, taken, colour, first):
    """Labels (x, y, text), each at the first of PLACES, from `first` on, that covers neither a mark nor a label (taken, in pixels)."""
    renderer = ax.figure.canvas.get_renderer()
    for x, y, text in points:
        tried = []
        for dx, dy, ha, va in PLACES[first:] + PLACES[:first]:
            label = ax.annotate(text, (x, y), textcoords='offset points', xytext=(dx, dy), ha=ha, va=va, fontsize=7, color=colour)
            box = label.get_window_extent(renderer)
            covered = sum(box.overlaps(other) for other in taken)
            tried.append((covered, label, box))
            if not covered:
                break
        covered, label, box = min(tried, key=lambda t: t[0])
        for _, other, _ in tried:
            if other is not label:
                other.remove()
        taken.append(box)


def along(points):
    """Places every four pixels on the line through these."""
    return [a + (b - a) * t for a, b in zip(points, points[1:]) for t in np.linspace(0, 1, max(2, int(np.hypot(*(b - a)) / 4)))]


def panel(ax, rows, study, case, look):
    from matplotlib.ticker import NullFormatter
    good = [r for r in rows if 'failed' not in r]
    rounded = [r for r in good if r['error'] < ROUND_OFF]
    visible = [100 * r['error'] for r in good if r['error'] >= ROUND_OFF]
    floor = min(visible) / 10 if visible else 1e-5  # where those of round-off are drawn
    labels = []
    for solver in SOLVERS:
        points = [r for r in good if r['solver'] == solver]
        if not points:
            continue
        colour, mark, first = look[solver]
        x = [max(r['seconds'], 1e-2) for r in points]
        y = [100 * r['error'] if r['error'] >= ROUND_OFF else floor for r in points]
        ax.loglog(x, y, '-', color=colour)
        for r, a, b in zip(points, x, y):
            ax.plot(a, b, mark, color=colour, mfc='white' if r in rounded else colour)
        labels.append(([(a, b, r['resolution'].split('=')[-1]) for r, a, b in zip(points, x, y)], colour, first))
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_minor_formatter(NullFormatter())
    if good:
        ax.set_xlim(limits([max(r['seconds'], 1e-2) for r in good]))
        ax.set_ylim(limits(visible + [floor] * bool(rounded)))
    lines = ['%s %s' % (s, why) for s, why in study.why.items()]
    lines += ['failed: %s %s' % (r['solver'], r['resolution']) for r in rows if 'failed' in r]
    lines += ['hollow: round-off, below %g %%' % (100 * ROUND_OFF)] * bool(rounded)
    if lines:
        ax.text(0.03, 0.03, '\n'.join(lines), transform=ax.transAxes, fontsize=7.5, va='bottom')
    ax.set_title('%s (%s)' % (case, study.error))
    return labels


def draw(rows, studies, path):
    from matplotlib.lines import Line2D
    from matplotlib.transforms import Bbox
    from figures import CLOSED, COMPUTED, plt
    cases = [c for c in studies if any(r['case'] == c for r in rows)]
    if not any('failed' not in r for r in rows):
        return
    look = {CFD: (CLOSED, 's', 0), SOLVERS[1]: (COMPUTED, 'o', 1)}
    across = min(3, len(cases))
    down = -(-len(cases) // across)
    figure, axes = plt.subplots(down, across, figsize=(4.1 * across, 3.3 * down + 0.4), squeeze=False)
    labels = [panel(ax, [r for r in rows if r['case'] == case], studies[case], case, look) for ax, case in zip(axes.flat, cases)]
    for ax in axes.flat[len(cases):]:
        ax.set_visible(False)
    for ax in axes[:, 0]:
        ax.set_ylabel('error, %')
    for number, ax in enumerate(axes.flat):
        if number + across >= len(cases):
            ax.set_xlabel('processor time, s')
    figure.tight_layout(rect=(0, 0, 1, 1 - 0.3 / (3.3 * down + 0.4)))
    for ax, of in zip(axes.flat, labels):
        taken = [Bbox.from_bounds(x - 3, y - 3, 6, 6) for points, _, _ in of for x, y in ax.transData.transform([p[:2] for p in points])]
        for points, _, _ in of:
            taken += [Bbox.from_bounds(*at, 1, 1) for at in along(ax.transData.transform([p[:2] for p in points]))]
        for points, colour, first in of:
            write(ax, points, taken, colour, first)
    figure.legend(handles=[Line2D([], [], color=look[s][0], marker=look[s][1], label=s) for s in SOLVERS], loc='upper center', ncol=2)
    figure.savefig(path, dpi=130)
