/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "particleTablesObject.H"

#include "addToRunTimeSelectionTable.H"
#include "particleRegistry.H"

namespace Foam
{
namespace functionObjects
{

defineTypeNameAndDebug(particleTablesObject, 0);
addToRunTimeSelectionTable(functionObject, particleTablesObject, dictionary);

particleTablesObject::particleTablesObject
(
  const word& name, const Time& runTime, const dictionary& dict
)
:
  regionFunctionObject(name, runTime, dict)
{
  const particleRegistry* found = obr_.findObject<particleRegistry>("particles");
  if (!found)
  {
    FatalIOErrorInFunction(dict)
        << "function object " << name << " of type " << type() << " needs a solver with particles"
        << " (demFoam, cfdDemFoam)" << exit(FatalIOError);
  }
  tables_.reset(new particleTables(found->particles(), runTime));
}

bool particleTablesObject::read(const dictionary& dict) { return regionFunctionObject::read(dict); }

bool particleTablesObject::write()
{
  tables_->write();
  return true;
}

} // namespace functionObjects
} // namespace Foam
