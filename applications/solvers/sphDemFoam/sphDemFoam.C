/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sphDemFoam: flow of a fluid through and with particles, without a mesh (SPH-DEM). The case is that of cfdDemFoam
 * and constant/sphProperties: the mesh is the container, the conditions of U say what its patches are.
 *
 *   fluid --sample--> solids --contact steps--> solids --reaction, porosity--> fluid --step-->
 *
 * deltaT of controlDict is the interval of reports; within it, the steps are those of the fluid (S.15, P.9). */
#include "Time.H"
#include "argList.H"
#include "dimensionedScalar.H"
#include "dimensionedVector.H"
#include "polyMesh.H"
#include "uniformDimensionedFields.H"

#include "fluidPoints.H"
#include "foamParams.H"
#include "particleTables.H"
#include "progress.H"
#include "restartTime.H"

using namespace Foam;

int main(int argc, char* argv[])
{
  argList::addNote
  (
    "Coupled SPH-DEM: the fluid of constant/transportProperties as smoothed particles (constant/sphProperties),\n"
    "solids from constant/demProperties, drag law from constant/couplingProperties."
  );
  #include "setRootCaseLists.H"
  #include "createTime.H"
  if (runTime.controlDict().found("functions"))
  {
    Info<< "functions of controlDict are off: they are for fields on the mesh, of which there are none" << nl;
    runTime.functionObjects().off();
  }
  #include "createPolyMesh.H"
  #include "readFluidProperties.H"

  fluidPoints fluid(mesh, g.value(), properties);
  particleTables tables(fluid.system(), runTime);
  Info<< nl << "Scene plan: skipped | why | saves" << nl;
  fluid.reportPlan(Info);
  Info<< endl;

  progress pace(runTime);
  while (runTime.run())
  {
    ++runTime;
    Info<< "Time = " << runTime.timeName() << ", deltaT = " << runTime.deltaTValue() << nl;

    fluid.advance(runTime.deltaTValue());

    fluid.report(Info);
    fluid.tabulate();
    tables.write();
    runTime.write();
    if (runTime.writeTime())
    {
      restartTime(runTime);
      fluid.write();
    }
    pace.report(Info, fluid.particleSteps());
  }
  fluid.reportTimers(Info);
  Info<< "End" << nl << endl;
  return 0;
}
