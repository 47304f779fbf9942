/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fluidSteps.H"

#include "mixtureFields.H"

namespace Foam
{

fluidSteps::fluidSteps(Time& time, const fvMesh& mesh)
:
  time_(time),
  mesh_(mesh),
  number_(1),
  done_(0)
{
  most();
}

/* Schemes with more than one old level would take the length of the step before for that of a fluid step
 * where the number or deltaT changes. */
static void checkSchemes(const fvMesh& mesh)
{
  const word scheme(mesh.ddtScheme("ddt(j)"));
  if (scheme == "Euler") return;
  FatalErrorInFunction
      << "entry 'fluidSteps' above 1 needs the time scheme Euler; ddtSchemes has " << scheme << exit(FatalError);
}

label fluidSteps::most() const
{
  const dictionary& control = time_.controlDict();
  const label most = control.getOrDefault<label>("fluidSteps", 1);
  if (most < 1 || most > 1000)
  {
    FatalIOErrorInFunction(control)
        << "entry 'fluidSteps': " << most << " is not allowed; it must be in [1, 1000]" << exit(FatalIOError);
  }
  if (most > 1) checkSchemes(mesh_);
  return most;
}

label fluidSteps::needed(scalar courant, scalar maxCo) const
{
  const label limit = most();
  // Old levels are kept by the index of the time; 2 fluid steps in the first step and 1 in the second would
  // give two of them the same
  if (!time_.isAdjustTimeStep() || time_.timeIndex() <= 2) return limit;
  const scalar number = std::ceil(courant/maxCo*(1 - 1e-9));
  return number > limit ? limit : max(label(1), label(number));
}

void fluidSteps::start(label number)
{
  number_ = number;
  done_ = 0;
}

bool fluidSteps::next()
{
  if (done_ == number_)
  {
    if (number_ > 1) time_.endSubCycle();
    return false;
  }
  if (done_ == 0 && number_ > 1) time_.subCycle(number_);
  ++done_;
  if (number_ > 1)
  {
    ++time_;
    time_.subCycleIndex(done_);
  }
  return true;
}

static volVectorField empty(const fvMesh& mesh, const word& name)
{
  return volVectorField
  (
    IOobject(name, mesh.time().timeName(), mesh, IOobject::NO_READ, IOobject::NO_WRITE, false),
    mesh, dimensionedVector(dimAcceleration, Zero), extrapolatedPatchTypes(mesh)
  );
}

exchangedImpulse::exchangedImpulse(const fvMesh& mesh)
:
  count_(0),
  pressure_(empty(mesh, "exchangedPressure")),
  stress_(empty(mesh, "exchangedStress"))
{}

void exchangedImpulse::add
(
  const fluidSteps& steps, const vectorField& drag, const vectorField& volume,
  const volVectorField& pressure, const volVectorField& stress
)
{
  if (steps.first())
  {
    count_ = 0;
    drag_.setSize(drag.size());
    volume_.setSize(volume.size());
    drag_ = Zero;
    volume_ = Zero;
    pressure_.primitiveFieldRef() = Zero;
    stress_.primitiveFieldRef() = Zero;
  }
  const scalar share = 1/scalar(steps.number());
  drag_ += share*drag;
  volume_ += share*volume;
  pressure_.primitiveFieldRef() += share*pressure.primitiveField();
  stress_.primitiveFieldRef() += share*stress.primitiveField();
  if (++count_ == steps.number())
  {
    pressure_.correctBoundaryConditions();
    stress_.correctBoundaryConditions();
  }
}

} // namespace Foam
