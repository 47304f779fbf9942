# SPDX-License-Identifier: GPL-3.0-or-later
"""Look of the plots: one place for sizes, colours and how a block of spheres is marked."""
import matplotlib
matplotlib.use('Agg')
import matplotlib.pyplot as plt  # noqa: E402

COMPUTED, CLOSED, OTHER, SHADE = '#0b5cad', '#d1495b', '#6c757d', '#e9ecef'

plt.rcParams.update({
    'figure.dpi': 110, 'savefig.bbox': 'tight', 'font.size': 10, 'axes.grid': True, 'grid.color': '#dddddd',
    'grid.linewidth': 0.6, 'axes.spines.top': False, 'axes.spines.right': False, 'legend.frameon': False,
    'lines.linewidth': 1.6, 'axes.titlesize': 10, 'axes.axisbelow': True})
