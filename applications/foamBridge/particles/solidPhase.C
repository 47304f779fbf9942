/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solidPhase.H"

#include "OSspecific.H"
#include "Time.H"
#include "particlePhase.H"

namespace Foam
{

autoPtr<solidPhase> solidPhase::New(const fvMesh& mesh, const fluid& fluid)
{
  auto there = [&mesh](const word& name)
  {
    return returnReduce(isFile(mesh.time().globalPath()/mesh.time().constant()/name), orOp<bool>());
  };
  if (there("demProperties")) return autoPtr<solidPhase>(new particlePhase(mesh, fluid));
  if (there("couplingProperties"))
  {
    FatalErrorInFunction
        << "there is constant/couplingProperties, but no constant/demProperties: the fluid alone needs neither, with"
        << " solid particles it needs both" << exit(FatalError);
  }
  return autoPtr<solidPhase>(new solidPhase());
}

void solidPhase::reportPlan(Ostream& os) const
{
  os << "solid particles, porosity, drag | there is no constant/demProperties | all of DEM and of the exchange" << nl;
}

} // namespace Foam
