/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fieldlessFunctions.H"

namespace Foam
{

static const wordList& fieldless()
{
  static const wordList types
  ({
    "particleTables", "abort", "systemCall", "timeActivatedFileUpdate", "writeDictionary"
  });
  return types;
}

static dictionary chosen(const Time& runTime)
{
  dictionary all;
  dictionary functions;
  const dictionary* given = runTime.controlDict().findDict("functions");
  if (given)
  {
    for (const entry& e : *given)
    {
      const word type(e.isDict() ? e.dict().getOrDefault<word>("type", word::null) : word::null);
      if (!e.isDict() || fieldless().found(type))
      {
        functions.add(e);
        continue;
      }
      Info<< "functions: " << e.keyword() << " of type " << type << " is off: it is for fields on the mesh, of which"
          << " there are none" << nl;
    }
  }
  all.add("functions", functions);
  return all;
}

fieldlessFunctions::fieldlessFunctions(Time& runTime)
:
  dict_(chosen(runTime)),
  list_(runTime, dict_)
{
  runTime.functionObjects().off();
}

bool fieldlessFunctions::found(const word& type) const
{
  for (const entry& e : dict_.subDict("functions"))
  {
    if (e.isDict() && e.dict().getOrDefault<word>("type", word::null) == type) return true;
  }
  return false;
}

} // namespace Foam
