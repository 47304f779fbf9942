/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fluidPoints.H"

#include "Time.H"
#include "foamParams.H"
#include "particleView.H"

namespace Foam
{

static IOdictionary readConstant(const polyMesh& mesh, const word& name)
{
  return IOdictionary
  (
    IOobject(name, mesh.time().constant(), mesh, IOobject::MUST_READ, IOobject::NO_WRITE)
  );
}

/* What solids carry for the exchange: the memories of selfDisturbance. */
static int carriedVectors(const polyMesh& mesh)
{
  return readConstant(mesh, "couplingProperties").getOrDefault<Switch>("selfDisturbance", false) ? CPL_MEMORY_VECTORS : 0;
}

double fluidPoints::kernelValue(const void* context, double r)
{
  const decltype(kernel_)& k = *static_cast<const decltype(kernel_)*>(context);
  return sph_kernel_value(k.kernel, 3, k.length, r);
}

double fluidPoints::gamma(const void* context, const double x[3])
{
  const decltype(kernel_)& k = *static_cast<const decltype(kernel_)*>(context);
  return sph_kernel_gamma(k.kernel, 3, sph_wall_distance(k.sph, x)/k.length);
}

/* What a mesh has and points have not is an error where it is a force, and told in the plan where it is a way to
 * compute. */
void fluidPoints::readCoupling()
{
  readParams(couplingDict_, cpl_params_table, &coupling_);
  const wordList forces
  ({
    "saffmanLift", "magnusLift", "rotationalDrag", "virtualMass", "viscousStress"
  });
  for (const word& force : forces)
  {
    if (couplingDict_.getOrDefault<Switch>(force, false))
    {
      FatalIOErrorInFunction(couplingDict_)
          << "entry '" << force << "' is on, which sphDemFoam does not have; allowed: off, or cfdDemFoam"
          << exit(FatalIOError);
    }
  }
  readParams
  (
    sphDict_.found("coupling") ? sphDict_.subDict("coupling") : dictionary(sphDict_.name()/"coupling"),
    cpl_points_table, &params_
  );
  params_.drag = coupling_.drag;
  params_.two_way = coupling_.two_way;
  params_.self_disturbance = coupling_.self_disturbance;
}

void fluidPoints::createExchange()
{
  kernel_.kernel = sphParams_.kernel;
  kernel_.length = params_.coupling_length*sphParams_.smoothing_length;
  kernel_.sph = sph_;
  DynamicList<cpl_points_plane> planes(mirrors(walls_));
  if (params_.form == CPL_POINTS_PAIRWISE) planes.clear(); // Gamma at walls
  mirrored_ = planes.size();
  cpl_points_kernel kernel;
  kernel.support = sph_kernel_support(kernel_.kernel)*kernel_.length;
  kernel.value = kernelValue;
  kernel.gamma = walls_.size() && planes.empty() ? gamma : nullptr;
  kernel.context = &kernel_;
  cpl_fluid fluid;
  fluid.density = properties_.density;
  fluid.viscosity = properties_.viscosity;
  for (direction d = 0; d < 3; ++d) fluid.gravity[d] = properties_.drive[d];
  checkStatus
  (
    cpl_points_create
    (
      particleCommunicator(), &system_.box(), &params_, &fluid, &kernel, planes.size(), planes.cdata(), &points_
    ),
    sphDict_
  );
}

fluidPoints::fluidPoints(const polyMesh& mesh, const vector& gravity, const fluidProperties& properties)
:
  fluidPhase(mesh, properties, true),
  system_(mesh, gravity, carriedVectors(mesh)),
  couplingDict_(readConstant(mesh, "couplingProperties")),
  coupling_(),
  params_(),
  kernel_(),
  mirrored_(0),
  clumps_(system_.state().clumps > 0),
  dem_(system_.dem()),
  points_(nullptr),
  view_(),
  fluid_(),
  fluidView_(),
  generation_(-1),
  contactSteps_(0)
{
  if (system_.params().dimensions == 2)
  {
    FatalIOErrorInFunction(system_.dict())
        << "entry 'dimensions' can not be 2 with a fluid: volume fraction and drag are those of spheres;"
        << " allowed: 3, or demFoam" << exit(FatalIOError);
  }
  readCoupling();
  for (direction d = 0; d < 3; ++d) params_.still[d] = still_[d];
  start(system_.restarted());
  createExchange();
  locateNow();
  if (!system_.restarted() && params_.two_way)
  {
    List<double> eps(fluid_.own);
    for (int a = 0; a < fluid_.own; ++a) eps[a] = fluid_.eps[std::size_t(a)*fluid_.mass_stride];
    for (int a = 0; a < fluid_.own; ++a) fluid_.eps[std::size_t(a)*fluid_.mass_stride] = 1;
    checkStatus(sph_displace(sph_, eps.cdata()), sphDict_);
  }
  sph_set_eps_ahead(sph_, params_.two_way);
  openTable();
}

fluidPoints::~fluidPoints() { cpl_points_destroy(points_); }

/* ---- views ------------------------------------------------------------------------------------ */
void fluidPoints::look()
{
  view_ = particleView(dem_);
  if (clumps_)
  {
    volumeRadius_.setSize(view_.count);
    dragRadius_.setSize(view_.count);
    checkStatus(dem_fluid_spheres(dem_, volumeRadius_.data(), dragRadius_.data()), "fluidPoints::look");
    view_.radius = volumeRadius_.cdata();
    view_.drag_radius = dragRadius_.cdata();
    view_.radius_stride = view_.drag_radius_stride = 1;
  }
  checkStatus(sph_get_view(sph_, &fluid_), "fluidPoints::look");
  fluidView_.count = fluid_.own;
  fluidView_.position = fluid_.position;
  fluidView_.velocity = fluid_.velocity;
  fluidView_.volume = fluid_.volume;
  fluidView_.position_stride = fluidView_.velocity_stride = fluidView_.volume_stride = fluid_.xv_stride;
  fluidView_.density = fluid_.density;
  fluidView_.density_stride = fluidView_.eps_stride = fluid_.mass_stride;
  fluidView_.acceleration = fluid_.acceleration;
  fluidView_.acceleration_stride = fluid_.rate_stride;
  fluidView_.pressure = fluid_.pressure;
  fluidView_.pressure_stride = fluid_.xv_stride;
  fluidView_.eps = fluid_.eps;
  // eps on ways that are not the fluid's (S.11, S.19)
  fluidView_.eps_gradient = sphParams_.xsph > 0 || sphParams_.shifting > 0 ? fluid_.eps_gradient : nullptr;
  fluidView_.eps_gradient_stride = fluid_.force_stride;
  fluidView_.force = fluid_.force;
  fluidView_.force_stride = fluid_.force_stride;
}

/* Pairs and porosity, with the fluid particles at these places. */
void fluidPoints::locate(const double* position, int stride)
{
  cpl_fluid_points at(fluidView_);
  at.position = position;
  at.position_stride = stride;
  checkStatus(cpl_points_locate(points_, &view_, &at), sphDict_);
  checkStatus(cpl_points_porosity(points_, &at), sphDict_);
  generation_ = sph_generation(sph_);
}

void fluidPoints::locateNow()
{
  look();
  locate(fluid_.position, fluid_.xv_stride);
}

/* Where the fluid will be at the end of the step, to second order (P.9). */
void fluidPoints::predict(scalar dt)
{
  ahead_.setSize(3*fluid_.own);
  for (int a = 0; a < fluid_.own; ++a)
  {
    const double* x = fluid_.position + std::size_t(a)*fluid_.xv_stride;
    const double* u = fluid_.velocity + std::size_t(a)*fluid_.xv_stride;
    const double* rate = fluid_.acceleration + std::size_t(a)*fluid_.rate_stride;
    const double* force = fluid_.force + std::size_t(a)*fluid_.force_stride;
    const double perMass = 1/fluid_.mass[std::size_t(a)*fluid_.mass_stride];
    for (direction d = 0; d < 3; ++d)
    {
      ahead_[3*a + d] =
        x[d] + dt*(u[d] + 0.5*dt*(rate[d] + sphParams_.gravity[d] + perMass*force[d]));
    }
  }
}

/* ---- a step ----------------------------------------------------------------------------------- */
scalar fluidPoints::step(scalar left)
{
  double fluidStep, dragStep;
  look();
  if (generation_ != sph_generation(sph_)) locate(fluid_.position, fluid_.xv_stride);
  checkStatus(cpl_points_force(points_, &view_, &fluidView_), couplingDict_);
  checkStatus(sph_stable_step(sph_, &fluidStep), sphDict_);
  checkStatus(cpl_points_stable_step(points_, &dragStep), couplingDict_);
  const scalar ratio = max(std::ceil(left/min(fluidStep, dragStep)*(1 - 1e-12)), scalar(1));
  const scalar dt = left/ratio;

  system_.advance(dt);
  contactSteps_ += system_.particleSteps();
  look();
  checkStatus(cpl_points_reaction(points_, &view_, &fluidView_, dt), couplingDict_);
  predict(dt);
  locate(ahead_.cdata(), 3);
  int steps;
  checkStatus(sph_advance(sph_, dt, &steps), sphDict_);
  steps_ += steps;
  return ratio > 1 ? left - dt : 0;
}

void fluidPoints::advance(scalar dt)
{
  steps_ = 0;
  contactSteps_ = 0;
  for (scalar left = dt; left > 0;) left = step(left);
}

void fluidPoints::write()
{
  system_.write();
  fluidPhase::write();
  generation_ = -1; // a restart finds its pairs anew
}

/* ---- reports ---------------------------------------------------------------------------------- */
scalar fluidPoints::exchangeError() const
{
  cpl_budget b = cpl_budget();
  if (params_.two_way && steps_ > 0) checkStatus(cpl_points_budget(points_, &b), "fluidPoints::exchangeError");
  return b.error;
}

void fluidPoints::reportPlan(Ostream& os) const
{
  system_.reportPlan(os);
  fluidPhase::reportPlan(os);
  if (!params_.two_way) os << "porosity, drag on the fluid | one-way" << nl;
  os << "model, voidFraction, subCells, smoothing, bandwidth of couplingProperties | those of a mesh"
     << " | here: coupling of sphProperties" << nl;
  if (mirrored_ > 0)
  {
    os << "Gamma at walls | " << mirrored_ << " planes, at which spheres are mirrored | exact in corners" << nl;
  }
}

void fluidPoints::report(Ostream& os) const
{
  system_.report(os);
  os << nl;
  system_.reportBudget(os);
  os << nl;
  fluidPhase::report(os);
  cpl_budget b;
  if (params_.two_way && cpl_points_budget(points_, &b) == PART_OK)
  {
    os << "Exchange: fluid gave (" << b.fluid[0] << ' ' << b.fluid[1] << ' ' << b.fluid[2]
       << ") N s, particles received (" << b.particles[0] << ' ' << b.particles[1] << ' ' << b.particles[2]
       << ") N s, error " << b.error << nl;
  }
  label outside = label(cpl_points_outside_range(points_));
  reduce(outside, sumOp<label>());
  if (outside > 0)
  {
    os << "Drag law " << cpl_drag_name(params_.drag) << ": " << outside << " particles outside its range" << nl;
  }
  os << flush;
}

void fluidPoints::reportTimers(Ostream& os) const
{
  char text[4096];
  system_.reportTimers(os);
  fluidPhase::reportTimers(os);
  checkStatus(part_timers_report(cpl_points_timers(points_), particleCommunicator(), sizeof text, text), "timers");
  os << text;
}

scalar fluidPoints::particleSteps() const
{
  return fluidPhase::particleSteps() + contactSteps_;
}

} // namespace Foam
