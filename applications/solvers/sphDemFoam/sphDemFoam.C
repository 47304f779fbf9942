/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sphDemFoam: flow of a fluid through and with particles, without a mesh (SPH-DEM). The case is that of cfdDemFoam
 * and constant/sphProperties: the mesh is the container, the conditions of U say what its patches are.
 *
 *   fluid --sample--> solids --contact steps--> solids --reaction, porosity--> fluid --step-->
 *
 * Without constant/demProperties the fluid is alone, in three dimensions or in two.
 * deltaT of controlDict is the interval of reports; within it, the steps are those of the fluid (S.15, P.9). */
#include "Time.H"
#include "argList.H"
#include "dimensionedScalar.H"
#include "dimensionedVector.H"
#include "polyMesh.H"
#include "uniformDimensionedFields.H"

#include "fieldlessFunctions.H"
#include "fluidPhase.H"
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
    "solids from constant/demProperties, drag law from constant/couplingProperties; without these files the fluid alone."
  );
  #include "setRootCaseLists.H"
  #include "createTime.H"
  #include "createPolyMesh.H"
  #include "readFluidProperties.H"

  fieldlessFunctions functions(runTime);
  autoPtr<fluidPhase> scene(fluidPhase::New(mesh, g.value(), properties));
  fluidPhase& fluid = scene();
  autoPtr<particleTables> tables;
  if (fluid.solids() && !functions.found("particleTables"))
  {
    tables.reset(new particleTables(*fluid.solids(), runTime));
  }
  Info<< nl << "Scene plan: skipped | why | saves" << nl;
  fluid.reportPlan(Info);
  Info<< endl;
  functions.start();

  progress pace(runTime);
  while (runTime.run())
  {
    ++runTime;
    Info<< "Time = " << runTime.timeName() << ", deltaT = " << runTime.deltaTValue() << nl;

    fluid.advance(runTime.deltaTValue());

    fluid.report(Info);
    fluid.tabulate();
    if (tables.valid()) tables->write();
    functions.execute();
    runTime.write();
    if (runTime.writeTime())
    {
      restartTime(runTime);
      fluid.write();
    }
    pace.report(Info, fluid.particleSteps());
  }
  functions.end();
  fluid.reportTimers(Info);
  Info<< "End" << nl << endl;
  return 0;
}
