/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cfdDemFoam: flow of a fluid through and with particles (CFD-DEM).
 *
 *   cells --sample--> particles --substeps--> particles --deposit--> cells --flow--> reaction
 *
 * The fluid is incompressible and locally averaged (model A or B); its unknown is the mixture volume
 * flux j (applications/foamBridge/mixtureScheme). Particles are those of libdem, the exchange is that
 * of libcoupling. Without constant/demProperties the fluid is alone. See doc/equations.md. */
#include "PhaseIncompressibleTurbulenceModel.H"
#include "fixedFluxPressureFvPatchScalarField.H"
#include "fvCFD.H"
#include "pimpleControl.H"
#include "singlePhaseTransportModel.H"
#include "uniformDimensionedFields.H"

#include "blockAnswer.H"
#include "fluidSteps.H"
#include "foamParams.H"
#include "frozenFlow.H"
#include "mixtureFields.H"
#include "mixtureScheme.H"
#include "operatorSelfTest.H"
#include "progress.H"
#include "restartTime.H"
#include "solidPhase.H"
#include "stageTimers.H"

int main(int argc, char* argv[])
{
  argList::addNote
  (
    "Coupled CFD-DEM: incompressible fluid on the mesh (laminar or OpenFOAM turbulence model),\n"
    "particles from constant/demProperties, exchange from constant/couplingProperties; without these files\n"
    "the fluid alone."
  );
  argList::addBoolOption("selfTest", "check the OpenFOAM operators on this mesh before running");
  #include "setRootCaseLists.H"
  #include "createTime.H"
  #include "createMesh.H"
  pimpleControl pimple(mesh);
  #include "createTimeControls.H"
  #include "createFields.H"
  #include "createPhases.H"
  #include "initContinuityErrs.H"

  if (args.found("selfTest") && !operatorSelfTest(mesh, Info))
  {
    FatalErrorInFunction << "an OpenFOAM operator is wrong on this mesh" << exit(FatalError);
  }
  progress pace(runTime);
  stageTimers stage;
  fluidSteps fluidStep(runTime, mesh);
  exchangedImpulse given(mesh);
  while (runTime.run())
  {
    stage.next("step size");
    solids.modify();
    #include "readTimeControls.H"
    #include "mixtureCourant.H"
    #include "setDeltaT.H"
    roundDeltaT(runTime);
    ++runTime;
    const scalar dt = runTime.deltaTValue();
    fluidStep.start(fluidStep.needed(courantRate*dt, maxCo));
    Info<< "Time = " << runTime.timeName() << ", deltaT = " << dt;
    if (fluidStep.number() > 1) Info<< ", fluid steps " << fluidStep.number();
    Info<< nl;
    if (frozenFlow* flow = solids.frozen())
    {
      #include "frozenStep.H"
      continue;
    }
    while (fluidStep.next())
    {
      if (fluidStep.first()) // within the loop: the change of eps belongs to the first fluid step
      {
        stage.next("particles and exchange");
        solids.begin(dt, U, stress);     // fluid force on the particles
        solids.advance(dt, eps, vp, ap, answer); // contact steps; where the particles are
        solids.source(dt, D, G);         // their drag on the fluid
        stage.next("face coefficients");
        scheme.update();
        if (!solids.unresolvedDrag()) scheme.resolve(phi, j);
        #include "beginAnswer.H"
        if (solids.virtualMass()) Ubefore = U;
      }
      #include "fluidStep.H"
    }
    if (!solids.none())
    {
      solids.react
      (
        dt, given.pressure(), given.drag(), given.volume(), given.stress(), scheme.predictionWeight()
      );
      #include "endAnswer.H"
    }
    p = p_rgh + (g & mesh.C());

    stage.next("report and output");
    solids.report(Info);
    runTime.write();
    if (runTime.writeTime())
    {
      restartTime(runTime);
      solids.write();
    }
    pace.report(Info, solids.particleSteps());
    stage.stop();
  }
  stage.report(Info);
  solids.reportTimers(Info);
  Info<< "End" << nl << endl;
  return 0;
}
