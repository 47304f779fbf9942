/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fluidPoints.H"

#include "OSspecific.H"
#include "Time.H"
#include "lagrangianCloud.H"
#include "foamMesh.H"
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
    "saffmanLift", "magnusLift", "rotationalDrag", "viscousStress", "selfDisturbance"
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
}

void fluidPoints::createExchange(const DynamicList<fluidWall>& walls)
{
  kernel_.kernel = sphParams_.kernel;
  kernel_.length = params_.coupling_length*sphParams_.smoothing_length;
  kernel_.sph = sph_;
  const DynamicList<cpl_points_plane> planes(mirrors(walls));
  mirrored_ = planes.size();
  hasWalls_ = walls.size() > 0;
  cpl_points_kernel kernel;
  kernel.support = sph_kernel_support(kernel_.kernel)*kernel_.length;
  kernel.value = kernelValue;
  kernel.gamma = hasWalls_ && planes.empty() ? gamma : nullptr;
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

static autoPtr<OFstream> openTable(const Time& time)
{
  if (!Pstream::master()) return autoPtr<OFstream>();
  const fileName folder(time.globalPath()/"postProcessing"/"fluid"/time.timeName());
  mkDir(folder);
  autoPtr<OFstream> file(new OFstream(folder/"fluid.dat"));
  file->precision(12);
  *file << "# Time [s]\tparticles\tsteps\tsuperficial velocity x y z [m/s]\tmax speed [m/s]\tleast eps"
        << "\tleast pressure [Pa]\tmost pressure [Pa]\tmomentum x y z [N s]\tgravity impulse x y z [N s]"
        << "\twall impulse x y z [N s]\tsolids' impulse x y z [N s]\tbudget error\texchange error" << endl;
  return file;
}

fluidPoints::fluidPoints(const polyMesh& mesh, const vector& gravity, const fluidProperties& properties)
:
  system_(mesh, gravity),
  mesh_(mesh),
  properties_(properties),
  sphDict_(readConstant(mesh, "sphProperties")),
  couplingDict_(readConstant(mesh, "couplingProperties")),
  coupling_(),
  params_(),
  sphParams_(),
  still_(Zero),
  kernel_(),
  files_(mesh.time(), "fluid"),
  mirrored_(0),
  hasWalls_(false),
  clumps_(system_.state().clumps > 0),
  sph_(nullptr),
  dem_(system_.dem()),
  points_(nullptr),
  view_(),
  fluid_(),
  fluidView_(),
  generation_(-1),
  steps_(0),
  contactSteps_(0)
{
  if (system_.params().dimensions == 2)
  {
    FatalIOErrorInFunction(system_.dict())
        << "entry 'dimensions' can not be 2 with a fluid: volume fraction and drag are those of spheres;"
        << " allowed: 3, or demFoam" << exit(FatalIOError);
  }
  readCoupling();
  still_ = gravityAtRest(sphDict_, system_.box(), properties_.drive);
  for (direction d = 0; d < 3; ++d) params_.still[d] = still_[d];
  readFluid(sphDict_, properties_, still_, sphParams_);
  const DynamicList<fluidWall> walls
  (
    fluidWalls
    (
      mesh, system_.box(), sph_kernel_support(sphParams_.kernel)*sphParams_.smoothing_length, still_ != vector::zero
    )
  );
  sph_ = createFluid(mesh, sphDict_, system_.box(), sphParams_, walls, system_.restarted(), files_.present());
  createExchange(walls);
  locateNow();
  if (!system_.restarted() && params_.two_way)
  {
    List<double> eps(fluid_.own);
    for (int a = 0; a < fluid_.own; ++a) eps[a] = fluid_.eps[std::size_t(a)*fluid_.mass_stride];
    for (int a = 0; a < fluid_.own; ++a) fluid_.eps[std::size_t(a)*fluid_.mass_stride] = 1;
    checkStatus(sph_displace(sph_, eps.cdata()), sphDict_);
  }
  table_ = openTable(mesh.time());
  tabulate();
}

fluidPoints::~fluidPoints()
{
  cpl_points_destroy(points_);
  sph_destroy(sph_);
}

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
  fluidView_.eps = fluid_.eps;
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
  files_.purge();
  checkStatus(sph_write(sph_, files_.present().c_str(), files_.series().c_str()), "fluidPoints::write");
  sph_set_time(sph_, mesh_.time().value()); // that of a restart
  const List<cloudColumn> columns
  ({
    {"U", SPH_FIELD_VELOCITY, 1}, {"p", SPH_FIELD_PRESSURE, 1}, {"eps", SPH_FIELD_EPS, 1},
    {"rho", SPH_FIELD_DENSITY, 1} // superficial
  });
  writeLagrangianCloud(mesh_, sph_store(sph_), particleCommunicator(), "fluid", columns);
  generation_ = -1; // a restart finds its pairs anew
}

/* ---- reports ---------------------------------------------------------------------------------- */
/* Mean of eps u over the fluid, and the range of pressure; returns the least eps. Collective. */
scalar fluidPoints::volumeMean(vector& superficial, scalar& least, scalar& most) const
{
  sph_view v;
  checkStatus(sph_get_view(sph_, &v), "fluidPoints::volumeMean");
  scalar volume = 0, eps = 1;
  superficial = Zero;
  least = GREAT;
  most = -GREAT;
  for (int a = 0; a < v.own; ++a)
  {
    const std::size_t x = std::size_t(a)*v.xv_stride, m = std::size_t(a)*v.mass_stride;
    volume += v.volume[x];
    superficial += v.volume[x]*v.eps[m]*vector(v.velocity[x], v.velocity[x + 1], v.velocity[x + 2]);
    eps = min(eps, scalar(v.eps[m]));
    least = min(least, scalar(v.pressure[x]));
    most = max(most, scalar(v.pressure[x]));
  }
  reduce(volume, sumOp<scalar>());
  reduce(superficial, sumOp<vector>());
  reduce(eps, minOp<scalar>());
  reduce(least, minOp<scalar>());
  reduce(most, maxOp<scalar>());
  superficial /= max(volume, VSMALL);
  return eps;
}

static void put(Ostream& os, const double (&v)[3])
{
  for (const double component : v) os << tab << component;
}

void fluidPoints::tabulate()
{
  sph_report r;
  checkStatus(sph_get_report(sph_, &r), "fluidPoints::tabulate");
  vector superficial;
  scalar least, most;
  const scalar eps = volumeMean(superficial, least, most);
  cpl_budget b = cpl_budget();
  const bool exchanged = params_.two_way && steps_ > 0;
  if (exchanged) checkStatus(cpl_points_budget(points_, &b), "fluidPoints::tabulate");
  if (!table_.valid()) return;
  OFstream& os = table_();
  os << mesh_.time().value() << tab << std::to_string(r.particles).c_str() << tab << steps_ << tab
     << superficial.x() << tab << superficial.y() << tab << superficial.z() << tab << r.max_speed << tab << eps
     << tab << least << tab << most;
  put(os, r.momentum);
  put(os, r.gravity_impulse);
  put(os, r.wall_impulse);
  put(os, r.force_impulse);
  os << tab << r.budget_error << tab << b.error << endl;
}

void fluidPoints::reportPlan(Ostream& os) const
{
  char text[4096];
  system_.reportPlan(os);
  checkStatus(sph_plan_text(sph_, sizeof text, text), "fluidPoints::reportPlan");
  os << text;
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
  sph_report r;
  checkStatus(sph_get_report(sph_, &r), "fluidPoints::report");
  vector superficial;
  scalar least, most;
  const scalar eps = volumeMean(superficial, least, most);
  system_.report(os);
  os << nl;
  system_.reportBudget(os);
  os << nl << "Fluid: " << std::to_string(r.particles).c_str() << " particles, steps " << steps_ << ", max speed "
     << r.max_speed << " m/s, density " << r.least_density << " to " << r.most_density << " kg/m3, pressure "
     << least << " to " << most << " Pa, least eps " << eps << nl << "Superficial velocity: " << superficial
     << " m/s; momentum budget: error " << r.budget_error;
  cpl_budget b;
  if (params_.two_way && cpl_points_budget(points_, &b) == PART_OK)
  {
    os << nl << "Exchange: fluid gave (" << b.fluid[0] << ' ' << b.fluid[1] << ' ' << b.fluid[2]
       << ") N s, particles received (" << b.particles[0] << ' ' << b.particles[1] << ' ' << b.particles[2]
       << ") N s, error " << b.error;
  }
  label outside = label(cpl_points_outside_range(points_));
  reduce(outside, sumOp<label>());
  if (outside > 0)
  {
    os << nl << "Drag law " << cpl_drag_name(params_.drag) << ": " << outside << " particles outside its range";
  }
  os << endl;
}

void fluidPoints::reportTimers(Ostream& os) const
{
  char text[4096];
  system_.reportTimers(os);
  checkStatus(part_timers_report(sph_timers(sph_), particleCommunicator(), sizeof text, text), "timers");
  os << text;
  checkStatus(part_timers_report(cpl_points_timers(points_), particleCommunicator(), sizeof text, text), "timers");
  os << text;
}

scalar fluidPoints::particleSteps() const
{
  return returnReduce(scalar(sph_store(sph_)->local)*steps_, sumOp<scalar>()) + contactSteps_;
}

} // namespace Foam
