/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "blockAnswer.H"

#include "foamParams.H"
#include "mathematicalConstants.H"
#include "mixtureFields.H"
#include "particleCase.H"

namespace Foam
{

static const scalar tolerance = 1e-6; // of the block's speed and w; the budget is exact whatever is left
static const label mostTries = 20, depth = 6;

static volVectorField empty(const fvMesh& mesh, const word& name, const dimensionSet& dimensions)
{
  return volVectorField
  (
    IOobject(name, mesh.time().timeName(), mesh, IOobject::NO_READ, IOobject::NO_WRITE, false),
    mesh, dimensionedVector(dimensions, Zero), extrapolatedPatchTypes(mesh)
  );
}

blockAnswer::blockAnswer
(
  dem_t* dem, cpl_t* cpl, const fvMesh& mesh, const cpl_particles& view, scalar fluidDensity, scalar gravity
)
:
  dem_(dem),
  cpl_(cpl),
  mesh_(mesh),
  view_(view),
  fluidDensity_(fluidDensity),
  gravity_(gravity),
  mass_(dem_block_count(dem), Zero),
  mean_(mass_.size(), Zero),
  smallest_(0),
  damped_(mass_.size(), Zero),
  speed_(mass_.size(), Zero),
  before_(mass_.size(), Zero),
  change_(mass_.size(), Zero),
  tries_(0),
  most_(0),
  residual_(0),
  worst_(0),
  drag_(empty(mesh, "blockDrag", dimAcceleration)),
  solids_(empty(mesh, "blockSolids", dimVelocity))
{
  forAll(mass_, b) mass_[b] = dem_block_mass(dem, int(b));
}

/* Sum over ranks, the same on each. */
template<class Type>
static void sumOverRanks(Field<Type>& values)
{
  if (!Pstream::parRun()) return;
  MPI_Allreduce
  (
    MPI_IN_PLACE, reinterpret_cast<double*>(values.data()), int(values.size()*pTraits<Type>::nComponents),
    MPI_DOUBLE, MPI_SUM, particleCommunicator()
  );
}

void blockAnswer::findMembers()
{
  const part_store* s = dem_store(dem_);
  const int64_t* number = part_field_int64(s, DEM_FIELD_BLOCK);
  const int stride = part_field_stride(s, DEM_FIELD_BLOCK);
  DynamicList<label> member, block;
  for (int i = 0; i < view_.count; ++i)
  {
    if (view_.kind[i*view_.kind_stride] != DEM_BLOCK) continue;
    member.append(i);
    block.append(label(number[i*stride]));
  }
  member_.transfer(member);
  block_.transfer(block);
}

/* Mean over dt of the answer of something that relaxes at the rate x/dt, over its end value: what makes the drag
 * on one sphere in a uniform flow that of C.10. */
static scalar meanOverEnd(scalar x)
{
  return x < 1e-4 ? 0.5 + x/12 : -1/std::expm1(-x) - 1/x;
}

void blockAnswer::start(scalar dt, label fluidSteps)
{
  findMembers();
  smallest_ = 1e-7*gravity_*dt; // what drag 1e7 times too stiff for the step leaves of it
  scalarField sp(mass_.size(), Zero);
  forAll(member_, k) sp[block_[k]] += view_.fluid_sp[member_[k]*view_.fluid_sp_stride];
  sumOverRanks(sp);
  forAll(mass_, b)
  {
    double x[3], v[3];
    if (!(mass_[b] > 0)) continue;
    checkStatus(dem_block_state(dem_, int(b), x, v), "blockAnswer::start");
    speed_[b] = vector(v[0], v[1], v[2]);
    const scalar rate = sp[b]*dt/scalar(fluidSteps)/mass_[b];
    mean_[b] = meanOverEnd(rate);
    damped_[b] = 1/(1 + mean_[b]*rate);
  }
  change_ = Zero;
  most_ = 0;
  worst_ = 0;
  nextFluidStep();
}

void blockAnswer::nextFluidStep()
{
  before_ = change_;
  points_.clear();
  steps_.clear();
  tries_ = 0;
  apply();
}

/* What w does to the flow: drag of its mean over the fluid step, and the solids that it carries. */
void blockAnswer::apply()
{
  List<double> value(6*view_.count, 0.0);
  forAll(member_, k)
  {
    const label i = member_[k], b = block_[k];
    const scalar sp = view_.fluid_sp[i*view_.fluid_sp_stride], r = view_.radius[i*view_.radius_stride];
    const vector drag(sp*(before_[b] + mean_[b]*(change_[b] - before_[b])));
    const vector solids(4.0/3.0*constant::mathematical::pi*r*r*r*change_[b]);
    for (direction d = 0; d < 3; ++d)
    {
      value[6*i + d] = drag[d];
      value[6*i + 3 + d] = solids[d];
    }
  }
  List<double> sum(6*mesh_.nCells(), 0.0);
  checkStatus(cpl_deposit(cpl_, 6, value.cdata(), sum.data()), "blockAnswer::apply");
  forAll(drag_, celli)
  {
    const double* s = &sum[6*celli];
    drag_[celli] = vector(s[0], s[1], s[2])/(fluidDensity_*mesh_.V()[celli]);
    solids_[celli] = vector(s[3], s[4], s[5])/mesh_.V()[celli];
  }
  drag_.correctBoundaryConditions();
  solids_.correctBoundaryConditions();
}

/* Component of x along directions that are orthogonal to each other and of length 1 are taken off; how much in a. */
static void takeOff(const UList<vectorField>& direction, vectorField& x, scalarList& a)
{
  forAll(direction, j)
  {
    a[j] = sum(direction[j] & x);
    x -= a[j]*direction[j];
  }
}

/* The point where the steps so far would combine to none: least squares over their differences. */
void blockAnswer::accelerate(const vectorField& step)
{
  if (tries_ > 0)
  {
    if (points_.size() == depth)
    {
      points_.remove(0);
      steps_.remove(0);
    }
    points_.append(vectorField(change_ - lastChange_));
    steps_.append(vectorField(step - lastStep_));
  }
  lastChange_ = change_;
  lastStep_ = step;

  DynamicList<vectorField> across, along; // orthonormal differences of steps, newest first; their points
  for (label j = steps_.size() - 1; j >= 0; --j)
  {
    vectorField df(steps_[j]), dw(points_[j]);
    const scalar size = std::sqrt(sum(magSqr(df)));
    scalarList a(across.size());
    takeOff(across, df, a);
    const scalar left = std::sqrt(sum(magSqr(df)));
    if (!(left > 1e-6*size) || !(size > VSMALL)) continue; // says nothing new
    forAll(across, k) dw -= a[k]*along[k];
    across.append(vectorField(df/left));
    along.append(vectorField(dw/left));
  }
  vectorField rest(step);
  scalarList a(across.size());
  takeOff(across, rest, a);
  change_ += rest;
  forAll(along, j) change_ -= a[j]*along[j];
}

bool blockAnswer::correct(const double* kick)
{
  vectorField answer(mass_.size(), Zero);
  forAll(member_, k)
  {
    const double* p = kick + 3*member_[k];
    answer[block_[k]] += vector(p[0], p[1], p[2]);
  }
  sumOverRanks(answer);
  vectorField step(mass_.size(), Zero);
  residual_ = 0;
  forAll(mass_, b)
  {
    if (!(mass_[b] > 0)) continue;
    const vector rest(answer[b]/mass_[b] - change_[b]);
    const scalar size = max(max(mag(speed_[b]), mag(answer[b])/mass_[b]), smallest_);
    if (mag(rest) > VSMALL) residual_ = max(residual_, mag(rest)/max(size, mag(rest)));
    step[b] = damped_[b]*rest;
  }
  most_ = max(most_, tries_ + 1);
  const bool settled = residual_ <= tolerance || tries_ + 1 == mostTries;
  if (settled)
  {
    worst_ = max(worst_, residual_);
    return true;
  }
  accelerate(step);
  ++tries_;
  apply();
  return false;
}

void blockAnswer::report(Ostream& os) const
{
  os << nl << "Blocks: velocity in " << most_ << " pressure correctors, residual " << worst_;
}

} // namespace Foam
