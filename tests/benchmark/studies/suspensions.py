# SPDX-License-Identifier: GPL-3.0-or-later
"""The cases of Robinson et al. with many spheres, by the scripts of their tutorials: a block that sinks against the closed form of
the porosity that the method itself makes of it; the growth of a disturbed front against the dispersion relation of the porosity
measured in the run."""
from run import against, script


def cpb(run, ratio, quick):
    """Porosity 0.8 in water, 30 d long; ratio: h/d, cells and distances of fluid particles are h/1.5."""
    words = ('water', '0.8', ratio, '30', run.solver)
    value = run.settings(*words)
    run.take(value, 'constant/demProperties', rampTime='ramp', rampFluidDensity='density')
    run.take(value, 'constant/sphProperties', spacing='spacing', smoothingLength='smoothingLength', soundSpeed='soundSpeed',
             backgroundPressure='backgroundPressure')
    run.solve()
    r = script(run.tutorial).read('_'.join(map(str, words)), run.path)
    return against(r['found'], r['own'], fromUniform=float(r['found'] / r['uniform'] - 1))


def rti(run, n, quick):
    """Water; n: cells or fluid particles across. The error is that of the wave that is farther off."""
    plot = script(run.tutorial)
    words = ('water', n, '0.1')
    value = run.settings(*words)
    run.take(value, 'constant/demProperties', rampFluidDensity='density')
    run.take(value, 'constant/couplingProperties', bandwidth='bandwidth')
    run.take(value, 'constant/sphProperties', **{name: name for name in ('spacing', 'smoothingLength', 'kernel', 'soundSpeed', 'backgroundPressure')})
    run.solve()
    waves = list(plot.growth(run.path, plot.st.run('water', n, 0.1), run.solver))
    if any(w['rate'] is None for w in waves):
        raise RuntimeError('a wave has too few times between %g and %g of its first amplitude; at the end: %s'
                           % (*plot.GROWN, ', '.join('%.3g' % (w['amplitude'][-1] / w['amplitude'][0]) for w in waves)))
    worst = max(waves, key=lambda w: abs(w['rate'] / w['expected'] - 1))
    return against(worst['rate'], worst['expected'], wave=worst['mode'], others=[float(w['rate'] / w['expected'] - 1) for w in waves])
