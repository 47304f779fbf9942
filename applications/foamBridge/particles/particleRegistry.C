/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "particleRegistry.H"

#include "Time.H"

namespace Foam
{

defineTypeNameAndDebug(particleRegistry, 0);

particleRegistry::particleRegistry(const objectRegistry& registry, particleSystem& particles)
:
  regIOobject
  (
    IOobject("particles", registry.time().timeName(), registry, IOobject::NO_READ, IOobject::NO_WRITE)
  ),
  particles_(particles)
{}

} // namespace Foam
