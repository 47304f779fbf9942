/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "particlePhase.H"

#include "Time.H"
#include "fvcCurl.H"
#include "fvcGrad.H"
#include "foamParams.H"
#include "mathematicalConstants.H"
#include "mixtureFields.H"
#include "particleView.H"

namespace Foam
{

/* Vectors that particles carry for the coupling; asked before the dictionary is checked. */
static int carriedVectors(const dictionary& dict)
{
  return dict.getOrDefault<Switch>("selfDisturbance", false) ? CPL_MEMORY_VECTORS : 0;
}

/* Density (kg/m3 of particle) of the fluid that particles take along: their inertia is made at the
 * start. What is not allowed is found when the dictionary is checked. */
static scalar virtualDensity(const dictionary& dict, scalar fluidDensity)
{
  if (!dict.getOrDefault<Switch>("virtualMass", false)) return 0;
  return max(dict.getOrDefault<scalar>("virtualMassCoefficient", 0.5), scalar(0))*fluidDensity;
}

static const double* data(const vectorField& field)
{
  return reinterpret_cast<const double*>(field.cdata());
}

static double* data(vectorField& field) { return reinterpret_cast<double*>(field.data()); }

/* Volume over the largest face: the shortest way through a cell, flat ones too. */
static scalar smallestCell(const fvMesh& mesh)
{
  scalarField largest(mesh.nCells(), Zero);
  forAll(mesh.faceAreas(), facei)
  {
    const scalar area = mag(mesh.faceAreas()[facei]);
    scalar& own = largest[mesh.faceOwner()[facei]];
    own = max(own, area);
    if (facei < mesh.nInternalFaces())
    {
      scalar& nei = largest[mesh.faceNeighbour()[facei]];
      nei = max(nei, area);
    }
  }
  return gMin(scalarField(mesh.cellVolumes()/largest));
}

static bool anyMoves(part_store* s)
{
  const int64_t* kind = part_field_int64(s, DEM_FIELD_KIND);
  const int stride = part_field_stride(s, DEM_FIELD_KIND);
  bool moves = false;
  for (int i = 0; i < s->local; ++i) moves = moves || kind[i*stride] != DEM_FIXED;
  reduce(moves, orOp<bool>());
  return moves;
}

particlePhase::particlePhase(const fvMesh& mesh, const fluid& fluid)
:
  couplingDict_
  (
    IOobject
    (
      "couplingProperties", mesh.time().constant(), mesh, IOobject::MUST_READ_IF_MODIFIED, IOobject::NO_WRITE
    )
  ),
  system_
  (
    mesh, fluid.gravity, carriedVectors(couplingDict_), virtualDensity(couplingDict_, fluid.density)
  ),
  mesh_(mesh),
  fluid_(fluid),
  couplingDigest_(couplingDict_.digest()),
  frozenDigest_(couplingDict_.subOrEmptyDict("frozenFlow").digest()),
  meshView_(mesh),
  params_(),
  dem_(system_.dem()),
  cpl_(nullptr),
  view_(),
  generation_(-1),
  moved_(true),
  deposited_(false),
  still_(false),
  clumps_(system_.state().clumps > 0),
  volumeError_(0),
  smallestCell_(smallestCell(mesh)),
  epsParticles_
  (
    IOobject("epsParticles", mesh.time().timeName(), mesh, IOobject::READ_IF_PRESENT, IOobject::NO_WRITE),
    mesh, dimensionedScalar("one", dimless, 1), extrapolatedPatchTypes(mesh)
  ),
  acceleration_
  (
    IOobject
    (
      "fluidAcceleration", mesh.time().timeName(), mesh, IOobject::READ_IF_PRESENT, IOobject::NO_WRITE
    ),
    mesh, dimensionedVector(dimAcceleration, Zero), extrapolatedPatchTypes(mesh)
  ),
  pressureAcceleration_
  (
    IOobject
    (
      "pressureAcceleration", mesh.time().timeName(), mesh, IOobject::READ_IF_PRESENT,
      IOobject::AUTO_WRITE
    ),
    mesh, dimensionedVector(dimAcceleration, Zero), extrapolatedPatchTypes(mesh)
  )
{
  readParams(couplingDict_, cpl_params_table, &params_, wordList({"frozenFlow"}));
  if (couplingDict_.found("frozenFlow"))
  {
    if (params_.two_way)
    {
      FatalIOErrorInFunction(couplingDict_)
          << "entry 'twoWay' can not be on with frozenFlow: a flow that is not solved can not feel the"
          << " particles; allowed: off" << exit(FatalIOError);
    }
    frozen_.reset(new frozenFlow(mesh, couplingDict_.subDict("frozenFlow")));
  }
  if (!modelB() && params_.two_way && !params_.pressure_gradient)
  {
    FatalIOErrorInFunction(couplingDict_)
        << "entry 'pressureGradient' can not be off in two-way model A or Bfull: the fluid lacks the pressure"
        << " on the solids, so the particles must get it; allowed: on, or model B, or twoWay off"
        << exit(FatalIOError);
  }
  if (system_.params().dimensions == 2)
  {
    FatalIOErrorInFunction(system_.dict())
        << "entry 'dimensions' can not be 2 with a fluid: volume fraction and drag are those of spheres;"
        << " allowed: 3, or demFoam" << exit(FatalIOError);
  }
  still_ = system_.params().skip && !anyMoves(dem_store(dem_));

  cpl_fluid properties;
  properties.density = fluid.density;
  properties.viscosity = fluid.viscosity*fluid.density;
  // Model B drives the whole mixture volume with gravity and body acceleration, so the particles get
  // the reaction of both as buoyancy; in model A that of the body acceleration is in the pressure
  const vector buoyant(fluid.gravity + (modelB() ? fluid.bodyAcceleration : vector(Zero)));
  for (direction d = 0; d < 3; ++d) properties.gravity[d] = buoyant[d];
  checkStatus
  (
    cpl_create
    (
      particleCommunicator(), &meshView_.view(), &system_.box(), &params_, &properties, &cpl_
    ),
    couplingDict_
  );
  if (params_.two_way && dem_block_count(dem_) > 0)
  {
    blocks_.reset(new blockAnswer(dem_, cpl_, mesh, view_, fluid.density, mag(fluid.gravity)));
  }
  if (!params_.two_way) epsParticles_.writeOpt() = IOobject::AUTO_WRITE;
  if (params_.virtual_mass) acceleration_.writeOpt() = IOobject::AUTO_WRITE;
}

particlePhase::~particlePhase() { cpl_destroy(cpl_); }

/* Members of clumps overlap: the fluid sees the sphere of their share of the volume. */
void particlePhase::look()
{
  view_ = particleView(dem_);
  if (!clumps_) return;
  volumeRadius_.setSize(view_.count);
  dragRadius_.setSize(view_.count);
  checkStatus(dem_fluid_spheres(dem_, volumeRadius_.data(), dragRadius_.data()), "particlePhase::look");
  view_.radius = volumeRadius_.cdata();
  view_.drag_radius = dragRadius_.cdata();
  view_.radius_stride = view_.drag_radius_stride = 1;
}

/* Weights of the particles where they are now; nothing to do if they have not moved. */
void particlePhase::locate()
{
  look();
  if (!moved_ && generation_ == dem_generation(dem_)) return;
  checkStatus(cpl_locate(cpl_, &view_), "particlePhase::locate");
  deposited_ = false;
  generation_ = dem_generation(dem_);
  moved_ = false;
}

void particlePhase::deposit(volScalarField& eps, volVectorField& vp)
{
  locate();
  cpl_cells cells = cpl_cells();
  cells.eps = epsParticles_.primitiveFieldRef().data();
  cells.solid_velocity = data(vp.primitiveFieldRef());
  checkStatus(cpl_void_fraction(cpl_, &view_, &cells, &volumeError_), couplingDict_);
  deposited_ = true;
  epsParticles_.correctBoundaryConditions();
  if (params_.two_way)
  {
    eps = epsParticles_;
  }
  else
  {
    vp.primitiveFieldRef() = Zero; // the flow does not know that there are particles
  }
  vp.correctBoundaryConditions();
}

bool particlePhase::start(volScalarField& eps, volVectorField& vp)
{
  if (!system_.restarted())
  {
    deposit(eps, vp);
    return true;
  }
  if (params_.two_way) epsParticles_ = eps;
  return false;
}

/* What the edited dictionary asks for: of the entries that may change the new values, of the others
 * those in use, each difference named. */
static cpl_params changed(const dictionary& dict, const cpl_params& now)
{
  cpl_params wanted;
  readParams(dict, cpl_params_table, &wanted, wordList({"frozenFlow"}));
  for (int i = 0; i < cpl_params_table.count; ++i)
  {
    const part_param& row = cpl_params_table.rows[i];
    if (!cpl_param_differs(&row, &now, &wanted)) continue;
    if (!cpl_may_change(row.name))
    {
      FatalIOErrorInFunction(dict)
          << "entry '" << row.name << "' can not change in a run; those that can: drag, minimumEps, overfull"
          << exit(FatalIOError);
    }
  }
  return wanted;
}

void particlePhase::modify()
{
  const SHA1Digest digest(couplingDict_.digest());
  if (digest == couplingDigest_) return;
  couplingDigest_ = digest;
  const bool throwing = FatalIOError.throwExceptions();
  try
  {
    const cpl_params wanted(changed(couplingDict_, params_));
    if (couplingDict_.subOrEmptyDict("frozenFlow").digest() != frozenDigest_)
    {
      FatalIOErrorInFunction(couplingDict_) << "frozenFlow can not change in a run" << exit(FatalIOError);
    }
    checkStatus(cpl_change_params(cpl_, &wanted), couplingDict_);
    params_ = wanted;
    deposited_ = false;
    Info<< "couplingProperties has changed: drag " << cpl_drag_name(params_.drag) << ", minimumEps "
        << params_.minimum_eps << ", overfull "
        << (params_.overfull == CPL_OVERFULL_SPREAD ? "spread" : "error") << nl;
  }
  catch (const IOerror& err)
  {
    WarningInFunction
        << "couplingProperties has changed, and is ignored; the run goes on with what it had:" << nl << err.message() << endl;
  }
  FatalIOError.throwExceptions(throwing);
}

void particlePhase::begin(scalar dt, const volVectorField& U, const volVectorField& stress)
{
  locate();
  const vectorField superficial(epsParticles_.primitiveField()*U.primitiveField());
  const vectorField gradient(-fluid_.density*pressureAcceleration_.primitiveField());
  const vectorField divTau(fluid_.density*stress.primitiveField());
  cpl_cells cells = cpl_cells();
  cells.eps = epsParticles_.primitiveFieldRef().data();
  cells.superficial = data(superficial);
  cells.pressure_gradient = data(gradient);
  cells.stress_divergence = data(divTau);
  cells.acceleration = data(acceleration_.primitiveField());
  vectorField curl;
  if (params_.saffman_lift || params_.magnus_lift || params_.rotational_drag)
  {
    curl = fvc::curl(U)().primitiveField();
    cells.curl = data(curl);
  }
  checkStatus(cpl_sample_fluid(cpl_, &view_, &cells), "particlePhase::begin");
  checkStatus(cpl_fluid_force(cpl_, &view_), "particlePhase::begin");
  if (const double* turn = cpl_turning(cpl_))
  {
    checkStatus(dem_relax_spin(dem_, turn, dt), "particlePhase::begin");
  }
}

void particlePhase::accelerate(const volVectorField& U, const tmp<volVectorField>& ddtU)
{
  acceleration_.primitiveFieldRef() = (ddtU + (U & fvc::grad(U, "grad(U)")))().primitiveField();
}

void particlePhase::advance
(
  scalar dt, volScalarField& eps, volVectorField& vp, volVectorField& ap, volScalarField& answer
)
{
  system_.advance(dt);
  if (still_ && deposited_)
  {
    look();
    return;
  }
  moved_ = !still_; // those that stand still come here after a write or restart, in a new order
  deposit(eps, vp);
  if (params_.two_way) depositMotion(dt, ap, answer);
}

/* Mean acceleration of the solids over the step, weighted by volume like their velocity, and how far they
 * will go with the pressure of the flow step that follows (M.16). */
void particlePhase::depositMotion(scalar dt, volVectorField& ap, volScalarField& answer)
{
  part_store* s = dem_store(dem_);
  const double* before = part_field_double(s, DEM_FIELD_VELOCITY_BEFORE);
  const int stride = part_field_stride(s, DEM_FIELD_VELOCITY_BEFORE);
  List<double> motion(4*view_.count);
  for (int i = 0; i < view_.count; ++i)
  {
    double* row = &motion[4*i];
    const double r = view_.radius[i*view_.radius_stride];
    const double volume = 4.0/3.0*constant::mathematical::pi*r*r*r;
    for (int d = 0; d < 3; ++d)
    {
      row[d] = volume/dt*(view_.velocity[i*view_.velocity_stride + d] - before[i*stride + d]);
    }
    // A block answers as a whole: blockAnswer
    const int64_t kind = view_.kind[i*view_.kind_stride];
    const bool answers = kind != DEM_FIXED && kind != DEM_BLOCK;
    row[3] = answers ? fluid_.density*sqr(volume)*view_.inverse_mass[i*view_.inverse_mass_stride] : 0;
  }
  List<double> sums(4*mesh_.nCells(), 0.0);
  checkStatus(cpl_deposit(cpl_, 4, motion.cdata(), sums.data()), "particlePhase::advance");
  forAll(mesh_.V(), celli)
  {
    const scalar solid = mesh_.V()[celli]*(1 - epsParticles_[celli]);
    const double* sum = &sums[4*celli];
    ap[celli] = solid > SMALL*mesh_.V()[celli] ? vector(sum[0], sum[1], sum[2])/solid : vector(Zero);
    answer[celli] = sum[3]/mesh_.V()[celli];
  }
  ap.correctBoundaryConditions();
  answer.correctBoundaryConditions();
}

void particlePhase::source(scalar dt, volScalarField& D, volVectorField& G)
{
  cpl_cells cells = cpl_cells();
  cells.eps = epsParticles_.primitiveFieldRef().data();
  cells.drag_coefficient = D.primitiveFieldRef().data();
  cells.drag_explicit = data(G.primitiveFieldRef());
  checkStatus(cpl_momentum_source(cpl_, &view_, &cells, dt), "particlePhase::source");
  D.primitiveFieldRef() /= fluid_.density;
  G.primitiveFieldRef() /= fluid_.density;
  D.correctBoundaryConditions();
  G.correctBoundaryConditions();
}

vectorField particlePhase::volumeImpulse
(
  scalar dt, const vectorField& volume, const volVectorField& stress
) const
{
  vectorField impulse(fluid_.density*dt*volume);
  if (params_.viscous_stress)
  {
    const scalarField solid(mesh_.V().field()*(1 - epsParticles_.primitiveField()));
    impulse += fluid_.density*dt*solid*stress.primitiveField();
  }
  return impulse;
}

bool particlePhase::foresee
(
  scalar dt, scalar part, const vectorField& drag, const vectorField& volume, const volVectorField& stress
)
{
  const vectorField dragImpulse(fluid_.density*dt*drag);
  const vectorField fromVolume(volumeImpulse(dt, volume, stress));
  kick_.setSize(3*view_.count + 1);
  checkStatus
  (
    cpl_foresee_kick
    (
      cpl_, &view_, data(dragImpulse), data(fromVolume), dt, part, kick_.data()
    ),
    "particlePhase::foresee"
  );
  return blocks_->correct(kick_.cdata());
}

void particlePhase::react
(
  scalar dt, const volVectorField& pressure, const vectorField& drag, const vectorField& volume,
  const volVectorField& stress, const scalarField& prediction
)
{
  if (!params_.two_way)
  {
    pressureAcceleration_ = pressure;
    return;
  }
  const scalarField& V = mesh_.V();
  forAll(volume, celli)
  {
    const scalar solid = V[celli]*(1 - epsParticles_[celli]);
    const vector now = solid > 1e-6*V[celli] ? volume[celli]/solid : pressure[celli];
    pressureAcceleration_[celli] += prediction[celli]*(now - pressureAcceleration_[celli]);
  }
  const vectorField dragImpulse(fluid_.density*dt*drag);
  const vectorField fromVolume(volumeImpulse(dt, volume, stress));
  const bool kicks = !still_ || params_.self_disturbance;
  kick_.setSize(3*view_.count + 1);
  checkStatus
  (
    cpl_reaction
    (
      cpl_, &view_, data(dragImpulse), data(fromVolume), dt, kicks ? kick_.data() : nullptr
    ),
    "particlePhase::react"
  );
  if (kicks) system_.kick(kick_.cdata());
}

scalar particlePhase::courant(scalar dt) const
{
  return system_.state().max_speed*dt/smallestCell_;
}

void particlePhase::write()
{
  system_.write();
  moved_ = true; // the order is new
}

void particlePhase::reportPlan(Ostream& os) const
{
  if (frozen_.valid()) frozen_->reportPlan(os);
  char text[4096];
  system_.reportPlan(os);
  if (still_) os << "locate, void fraction | no particle can move | worked out once" << nl;
  if (still_ && params_.two_way && !params_.self_disturbance)
  {
    os << "reaction per particle | no particle can move | the budget is that of the cells" << nl;
  }
  checkStatus(cpl_plan_text(cpl_, sizeof text, text), "particlePhase::reportPlan");
  os << text;
}

void particlePhase::report(Ostream& os) const
{
  system_.report(os);
  os << ", volume error " << volumeError_ << nl;
  system_.reportBudget(os);
  const label outside = returnReduce(label(cpl_outside_range(cpl_)), sumOp<label>());
  if (outside > 0)
  {
    const cpl_drag_range& range = *cpl_drag_range_of(params_.drag);
    os << nl << "Drag law " << cpl_drag_name(params_.drag) << ": " << outside
       << " particles outside its range, Re " << range.re_low << " to " << range.re_high << ", eps "
       << range.eps_low << " to " << range.eps_high;
  }
  long long overfull;
  double moved;
  cpl_overfull_of(cpl_, &overfull, &moved);
  if (overfull > 0)
  {
    os << nl << "Overfull cells: " << label(overfull) << " would have eps below " << params_.minimum_eps << "; "
       << moved << " m3 of solids moved to the cells around";
  }
  if (params_.two_way)
  {
    cpl_budget b;
    if (cpl_get_budget(cpl_, &b) == PART_OK)
    {
      if (blocks_.valid()) blocks_->report(os);
      os << nl << "Exchange: fluid gave (" << b.fluid[0] << ' ' << b.fluid[1] << ' ' << b.fluid[2]
         << ") N s, particles received (" << b.particles[0] << ' ' << b.particles[1] << ' '
         << b.particles[2] << ") N s, error " << b.error;
    }
  }
  os << endl;
}

void particlePhase::reportTimers(Ostream& os) const
{
  char text[4096];
  system_.reportTimers(os);
  checkStatus(part_timers_report(cpl_timers(cpl_), particleCommunicator(), sizeof text, text), "timers");
  os << text;
}

} // namespace Foam
