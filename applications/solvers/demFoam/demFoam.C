/* SPDX-License-Identifier: GPL-3.0-or-later */
/* demFoam: particles alone (DEM) in an OpenFOAM case. The mesh gives the box, its periodic directions and the
 * patches that are walls; no fields, fvSchemes or fvSolution are needed.
 *
 * deltaT of controlDict is the interval of an advance: the run reports, and may write, at its ends. The
 * contact steps within are those that the contacts need (doc/equations.md D.11, D.15). */
#include "Time.H"
#include "argList.H"
#include "polyMesh.H"
#include "uniformDimensionedFields.H"

#include "foamParams.H"
#include "particleSystem.H"
#include "particleTables.H"
#include "progress.H"
#include "restartTime.H"

using namespace Foam;

int main(int argc, char* argv[])
{
  argList::addNote
  (
    "Particles alone (DEM): those of constant/demProperties, under constant/g, in the box of the mesh.\n"
    "deltaT of system/controlDict is the interval of reports; contact steps are chosen by the contacts."
  );
  #include "setRootCaseLists.H"
  #include "createTime.H"
  #include "createPolyMesh.H"

  const uniformDimensionedVectorField g
  (
    IOobject("g", runTime.constant(), runTime, IOobject::MUST_READ, IOobject::NO_WRITE)
  );
  checkDimensions(g, g.dimensions(), dimAcceleration);
  if (runTime.isAdjustTimeStep())
  {
    Info<< "adjustTimeStep: without effect, deltaT stays as it is; contact steps need no limit" << nl;
  }
  particleSystem particles(mesh, g.value());
  particleTables tables(particles, runTime);

  Info<< nl << "Scene plan: skipped | why | saves" << nl;
  particles.reportPlan(Info);
  Info<< nl;
  particles.reportStep(Info);
  Info<< endl;

  progress pace(runTime);
  while (runTime.run())
  {
    ++runTime;
    Info<< "Time = " << runTime.timeName() << ", deltaT = " << runTime.deltaTValue() << nl;

    particles.advance(runTime.deltaTValue());

    particles.report(Info);
    Info<< nl;
    particles.reportBudget(Info);
    Info<< endl;
    tables.write();
    runTime.write();
    if (runTime.writeTime())
    {
      restartTime(runTime);
      particles.write();
    }
    pace.report(Info, particles.particleSteps());
  }
  particles.reportTimers(Info);
  Info<< "End" << nl << endl;
  return 0;
}
