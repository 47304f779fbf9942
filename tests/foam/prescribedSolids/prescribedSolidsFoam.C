/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The flow part of cfdDemFoam with solids given by formula: for tests of the momentum scheme.
 *
 * transportProperties: nu, model (A or B), initialNoise (m/s, a random velocity added to every cell).
 * U of the start time is read as the mixture volume flux j. Each step prints a line "step":
 *   t; mean of j; largest |j - mean|; largest |j|; range of p_rgh;
 *   budget: momentum (per fluid density, m4/s) since the start: gained by the fluid; given by the body
 *   force; pressed, by the pressure on fluid and particles (nothing in a periodic box, or the
 *   discretisation made it); taken by the particles (drag, pressure); and what the discretisation
 *   made of nothing, gained - given - pressed + taken. Shear at walls is not in it. */
#include "fvCFD.H"
#include "fixedFluxPressureFvPatchScalarField.H"
#include "Random.H"
#include "pimpleControl.H"
#include "uniformDimensionedFields.H"

#include "foamParams.H"
#include "mixtureFields.H"
#include "mixtureScheme.H"
#include "prescribedSolids.H"

static void addNoise(volVectorField& j, scalar size)
{
  Random random(7 + Pstream::myProcNo());
  for (vector& v : j.primitiveFieldRef())
  {
    v += size*(2*random.sample01<vector>() - vector::one);
  }
  j.correctBoundaryConditions();
}

static vector total(const vectorField& perCell)
{
  return gSum(perCell);
}

static OStringStream text(const vector& v)
{
  OStringStream out;
  out.precision(12);
  out << v.x() << ' ' << v.y() << ' ' << v.z();
  return out;
}

int main(int argc, char* argv[])
{
  argList::addNote("Flow through solids given by formula (test of the momentum scheme)");
  #include "setRootCase.H"
  #include "createTime.H"
  #include "createMesh.H"
  pimpleControl pimple(mesh);
  #include "createFields.H"
  #include "initContinuityErrs.H"

  const IOdictionary transport
  (
    IOobject("transportProperties", runTime.constant(), mesh, IOobject::MUST_READ)
  );
  const dimensionedScalar nu("nu", dimViscosity, transport);
  const volScalarField nuEff(workField("nuEff"), mesh, nu);
  const mixtureScheme::modelType model =
    transport.getOrDefault<word>("model", "A") == "B" ? mixtureScheme::modelB : mixtureScheme::modelA;

  const bool particleStress = false; // the solids feel pressure and drag only
  volVectorField stress
  (
    workField("stressDivergence"), mesh, dimensionedVector(dimAcceleration, Zero)
  );

  prescribedSolids solids(mesh);
  mixtureScheme scheme(mesh, model, eps, vp, ap, answer, D, G, bodyAcceleration);
  auto updateSolids = [&]()
  {
    solids.update(runTime.value(), nu.value(), j, eps, vp, D, G);
    if (model == mixtureScheme::modelB)
    {
      D /= eps;
      G /= eps;
    }
    scheme.update();
  };
  addNoise(j, transport.getOrDefault<scalar>("initialNoise", 0));
  updateSolids();
  U = scheme.interstitial(j);
  const scalar volume = gSum(mesh.V());
  const scalarField& V = mesh.V();
  vector gained(Zero), given(Zero), pressed(Zero), taken(Zero);
  vectorField drag(mesh.nCells()), ofVolume(mesh.nCells());

  while (runTime.loop())
  {
    updateSolids();
    while (pimple.loop())
    {
      #include "jEqn.H"
      while (pimple.correct())
      {
        #include "pEqn.H"
      }
    }
    U = scheme.interstitial(j);
    U.correctBoundaryConditions();
    p = p_rgh + (g & mesh.C());

    const scalar dt = runTime.deltaTValue();
    scheme.reaction(phi, pressureForce, damped, drag, ofVolume);
    gained += total(V*(j.primitiveField() - j.oldTime().primitiveField()));
    // By cells, also where the faces' eps is harmonic: reaction() gives the solids their cells' share
    const scalarField driven(model == mixtureScheme::modelA ? scalarField(V*eps) : scalarField(V));
    given += dt*total(driven*bodyAcceleration.value());
    pressed += dt*total(V*scheme.reconstruct(pressureForce)().primitiveField());
    taken += dt*total(drag + ofVolume);

    const vector mean = total(V*j.primitiveField())/volume;
    const vectorField deviation(j.primitiveField() - mean);
    Info<< "step t " << runTime.value() << " mean " << text(mean).str().c_str()
        << " deviation " << gMax(mag(deviation)()) << " max " << gMax(mag(j)().primitiveField())
        << " pRange " << gMax(p_rgh) - gMin(p_rgh)
        << " gained " << text(gained).str().c_str() << " given " << text(given).str().c_str()
        << " pressed " << text(pressed).str().c_str()
        << " taken " << text(taken).str().c_str()
        << " discretisation " << text(gained - given - pressed + taken).str().c_str() << endl;
    runTime.write();
  }
  return 0;
}
