/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The flow part of cfdDemFoam with solids given by formula: for tests of the momentum scheme. */
#include "fvCFD.H"
#include "fixedFluxPressureFvPatchScalarField.H"
#include "pimpleControl.H"
#include "uniformDimensionedFields.H"

#include "mixtureFields.H"
#include "mixtureScheme.H"
#include "prescribedSolids.H"

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

  prescribedSolids solids(mesh);
  mixtureScheme scheme(mesh, model, eps, vp, ap, D, G, bodyAcceleration);
  solids.update(runTime.value(), nu.value(), j, eps, vp, D, G);
  const scalar volume = gSum(mesh.V());

  while (runTime.loop())
  {
    solids.update(runTime.value(), nu.value(), j, eps, vp, D, G);
    if (model == mixtureScheme::modelB)
    {
      D /= eps;
      G /= eps;
    }
    scheme.update();
    while (pimple.loop())
    {
      #include "jEqn.H"
      while (pimple.correct())
      {
        #include "pEqn.H"
      }
    }
    p = p_rgh + (g & mesh.C());

    const vector mean = gSum((mesh.V()*j.primitiveField())())/volume;
    const vectorField deviation(j.primitiveField() - mean);
    Info<< "step t " << runTime.value() << " mean " << mean.x() << " " << mean.y() << " "
        << mean.z() << " deviation " << gMax(mag(deviation)()) << " max " << gMax(mag(j)().primitiveField())
        << " pRange " << gMax(p_rgh) - gMin(p_rgh) << endl;
    runTime.write();
  }
  return 0;
}
