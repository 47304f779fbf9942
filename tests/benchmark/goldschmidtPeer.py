# SPDX-License-Identifier: GPL-3.0-or-later
"""The bed of goldschmidt.py for DPMFoam: same mesh, particles (with velocities), gas velocity and pressure, drag (Ergun below,
Wen and Yu above a void fraction of 0.8), contact (Hertz, E = 1e8 Pa, friction 0.1), solver tolerances and correctors."""
import os
import shutil
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, '..', 'foam', 'lib'))
from foamcase import HEADER, Case, foam  # noqa: E402

WALLS = ('top', 'bottom', 'sides', 'frontAndBack')


def internal_field(path):
    """Text of the values of a field that is written as ascii."""
    with open(path) as source:
        text = source.read()
    begin = text.index('internalField') + len('internalField')
    return text[begin:text.index(';', begin)].strip()


def cloud(dt):
    pair = {'useEquivalentSize': 'no', 'alpha': 0.02, 'b': 1.5, 'mu': 0.1, 'cohesionEnergyDensity': 0,
            'collisionResolutionSteps': 12}
    wall = dict(pair, youngsModulus=1e8, poissonsRatio=0.35)
    patches = [foam({name: {'type': 'rebound', 'e': 0.97, 'mu': 0.1}})[1:-1] for name in WALLS]
    return {
        'solution': {
            'active': 'true', 'coupled': 'true', 'transient': 'yes', 'cellValueSourceCorrection': 'off',
            'interpolationSchemes': {'rho.air': 'cell', 'U.air': 'cellPoint', 'mu.air': 'cell'},
            'integrationSchemes': {'U': 'Euler'}, 'sourceTerms': {'schemes': {'U': 'semiImplicit 1'}}},
        'constantProperties': {
            'parcelTypeId': 1, 'rhoMin': 1e-15, 'minParcelMass': 1e-15, 'rho0': 2526, 'youngsModulus': 1e8,
            'poissonsRatio': 0.35, 'constantVolume': 'false', 'alphaMax': 0.99},
        'subModels': {
            'particleForces': {'ErgunWenYuDrag': {'alphac': 'alpha.air'}, 'gravity': ''},
            'injectionModels': {'bed': {
                'type': 'kinematicLookupTableInjection', 'inputFile': '"bed"', 'massTotal': 0, 'parcelBasisType': 'fixed',
                'nParticle': 1, 'SOI': 0, 'duration': dt, 'randomise': 'no', 'parcelsPerSecond': 1.00001 / dt}},
            'dispersionModel': 'none', 'patchInteractionModel': 'localInteraction',
            'localInteractionCoeffs': {'patches': '(' + ''.join(patches) + ')'},
            'heatTransferModel': 'none', 'surfaceFilmModel': 'none', 'collisionModel': 'pairCollision',
            'pairCollisionCoeffs': {
                'maxInteractionDistance': 0.0025, 'writeReferredParticleCloud': 'no',
                'pairModel': 'pairSpringSliderDashpot', 'pairSpringSliderDashpotCoeffs': pair,
                'wallModel': 'wallSpringSliderDashpot', 'wallSpringSliderDashpotCoeffs': wall, 'U': 'U.air'},
            'stochasticCollisionModel': 'none', 'radiation': 'off'},
        'cloudFunctions': {}}


def fields(path, kept, start, speed):
    def write(name, cls, dimensions, patches):
        with open(os.path.join(path, '0', name), 'w') as out:
            out.write(HEADER.format(cls=cls, name=name) + 'dimensions %s;\ninternalField %s;\nboundaryField %s\n' % (
                dimensions, internal_field(os.path.join(kept, start, name.split('.')[0])), foam(patches)))
    os.makedirs(os.path.join(path, '0'))
    still = 'uniform (0 0 0)'
    write('U.air', 'volVectorField', '[0 1 -1 0 0 0 0]', {
        'sides': {'type': 'noSlip'}, 'frontAndBack': {'type': 'symmetry'},
        'top': {'type': 'pressureInletOutletVelocity', 'phi': 'phi.air', 'inletValue': still, 'value': still},
        'bottom': {'type': 'interstitialInletVelocity', 'inletVelocity': 'uniform (0 0 %g)' % speed, 'phi': 'phi.air',
                   'alpha': 'alpha.air', 'value': 'uniform (0 0 %g)' % speed}})
    flux = {'type': 'fixedFluxPressure', 'phi': 'phi.air', 'value': 'uniform 0'}
    write('p', 'volScalarField', '[0 2 -2 0 0 0 0]', {
        'sides': flux, 'bottom': flux, 'frontAndBack': {'type': 'symmetry'},
        'top': {'type': 'fixedValue', 'value': 'uniform 0'}})


def case(path, kept, start, spheres, diameter, density, speed, dt, steps):
    deck = Case(path)
    deck.write('system/controlDict', {
        'application': 'DPMFoam', 'startFrom': 'startTime', 'startTime': 0, 'stopAt': 'endTime', 'endTime': dt * steps,
        'deltaT': dt, 'writeControl': 'timeStep', 'writeInterval': 1000000, 'writeFormat': 'binary', 'timePrecision': 10})
    deck.write('system/fvSchemes', {
        'ddtSchemes': {'default': 'Euler'}, 'gradSchemes': {'default': 'Gauss linear'},
        'divSchemes': {'default': 'none', 'div(alphaPhi.air,U.air)': 'Gauss linear',
                       'div(((alpha.air*nuEff.air)*dev2(T(grad(U.air)))))': 'Gauss linear'},
        'laplacianSchemes': {'default': 'Gauss linear corrected'}, 'interpolationSchemes': {'default': 'linear'},
        'snGradSchemes': {'default': 'corrected'}})
    gamg = {'solver': 'GAMG', 'smoother': 'GaussSeidel', 'tolerance': 1e-7, 'relTol': 0}
    deck.write('system/fvSolution', {
        'solvers': {'"p.*"': gamg, '"U.*"': {'solver': 'smoothSolver', 'smoother': 'symGaussSeidel', 'tolerance': 1e-5,
                                             'relTol': 0}},
        'PIMPLE': {'nOuterCorrectors': 1, 'nCorrectors': 2, 'momentumPredictor': 'yes', 'nNonOrthogonalCorrectors': 0,
                   'pRefCell': 0, 'pRefValue': 0}})
    deck.write('constant/g', {'dimensions': '[0 1 -2 0 0 0 0]', 'value': (0, 0, -9.81)}, 'uniformDimensionedVectorField')
    deck.write('constant/transportProperties', {
        'continuousPhase': 'air', 'rho.air': 1.2, 'transportModel': 'Newtonian', 'nu': 1e-5})
    deck.write('constant/turbulenceProperties.air', {'simulationType': 'laminar'})
    deck.write('constant/kinematicCloudProperties', cloud(dt))
    with open(os.path.join(path, 'constant', 'bed'), 'w') as out:
        out.write(HEADER.format(cls='dictionary', name='bed') + '(\n')
        for row in spheres:
            out.write('(%r %r %r) (%r %r %r) %r %r 1\n' % (*map(float, row), diameter, density))
        out.write(')\n')
    shutil.copytree(os.path.join(kept, 'constant', 'polyMesh'), os.path.join(path, 'constant', 'polyMesh'))
    fields(path, kept, start, speed)
    return path
