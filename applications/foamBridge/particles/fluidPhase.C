/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fluidPhase.H"

#include "OSspecific.H"
#include "Time.H"
#include "fluidPoints.H"
#include "foamMesh.H"
#include "foamParams.H"
#include "lagrangianCloud.H"

namespace Foam
{

static IOdictionary readProperties(const polyMesh& mesh)
{
  return IOdictionary
  (
    IOobject("sphProperties", mesh.time().constant(), mesh, IOobject::MUST_READ, IOobject::NO_WRITE)
  );
}

fluidPhase::fluidPhase(const polyMesh& mesh, const fluidProperties& properties, bool solids)
:
  mesh_(mesh),
  properties_(properties),
  sphDict_(readProperties(mesh)),
  box_(foamMesh::box(mesh)),
  still_(gravityAtRest(sphDict_, box_, properties.drive)),
  sphParams_(readFluid(sphDict_, properties, still_, box_, solids)),
  walls_(fluidWalls(mesh, box_, sphDict_, sphParams_, still_ != vector::zero)),
  files_(mesh.time(), "fluid"),
  sph_(nullptr),
  steps_(0)
{}

fluidPhase::fluidPhase(const polyMesh& mesh, const fluidProperties& properties)
:
  fluidPhase(mesh, properties, false)
{
  if (sphDict_.found("coupling"))
  {
    FatalIOErrorInFunction(sphDict_)
        << "entry 'coupling' belongs to a fluid with solid particles, and there is no constant/demProperties"
        << exit(FatalIOError);
  }
  start(mag(mesh.time().value()) > SMALL + 1e-6*mesh.time().deltaTValue());
  openTable();
}

fluidPhase::~fluidPhase() { sph_destroy(sph_); }

autoPtr<fluidPhase> fluidPhase::New
(
  const polyMesh& mesh, const vector& gravity, const fluidProperties& properties
)
{
  auto there = [&mesh](const word& name)
  {
    return returnReduce(isFile(mesh.time().globalPath()/mesh.time().constant()/name), orOp<bool>());
  };
  if (there("demProperties")) return autoPtr<fluidPhase>(new fluidPoints(mesh, gravity, properties));
  if (there("couplingProperties"))
  {
    FatalErrorInFunction
        << "there is constant/couplingProperties, but no constant/demProperties: the fluid alone needs neither, with"
        << " solid particles it needs both" << exit(FatalError);
  }
  return autoPtr<fluidPhase>(new fluidPhase(mesh, properties));
}

void fluidPhase::start(bool restarted)
{
  sph_ = createFluid(mesh_, sphDict_, box_, sphParams_, walls_, restarted, files_.present());
}

void fluidPhase::openTable()
{
  if (Pstream::master())
  {
    const fileName folder(mesh_.time().globalPath()/"postProcessing"/"fluid"/mesh_.time().timeName());
    mkDir(folder);
    table_.reset(new OFstream(folder/"fluid.dat"));
    table_->precision(15); // enough for balances of these numbers to 1e-12
    *table_ << "# Time [s]\tparticles\tsteps\tsuperficial velocity x y z [m/s]\tmax speed [m/s]\tleast eps"
            << "\tleast pressure [Pa]\tmost pressure [Pa]\tkinetic energy [J]\tmomentum x y z [N s]"
            << "\tgravity impulse x y z [N s]\twall impulse x y z [N s]\tsolids' impulse x y z [N s]"
            << "\tbudget error\texchange error" << endl;
  }
  tabulate();
}

void fluidPhase::advance(scalar dt) { checkStatus(sph_advance(sph_, dt, &steps_), sphDict_); }

void fluidPhase::write()
{
  files_.purge();
  checkStatus(sph_write(sph_, files_.present().c_str(), files_.series().c_str()), "fluidPhase::write");
  sph_set_time(sph_, mesh_.time().value()); // that of a restart
  const List<cloudColumn> columns
  ({
    {"U", SPH_FIELD_VELOCITY, 1}, {"p", SPH_FIELD_PRESSURE, 1}, {"eps", SPH_FIELD_EPS, 1},
    {"rho", SPH_FIELD_DENSITY, 1} // superficial
  });
  writeLagrangianCloud(mesh_, sph_store(sph_), particleCommunicator(), "fluid", columns);
}

/* ---- reports ---------------------------------------------------------------------------------- */
/* Mean of eps u over the fluid, and the range of pressure; returns the least eps. Collective. */
scalar fluidPhase::volumeMean(vector& superficial, scalar& least, scalar& most) const
{
  sph_view v;
  checkStatus(sph_get_view(sph_, &v), "fluidPhase::volumeMean");
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

void fluidPhase::tabulate()
{
  sph_report r;
  checkStatus(sph_get_report(sph_, &r), "fluidPhase::tabulate");
  vector superficial;
  scalar least, most;
  const scalar eps = volumeMean(superficial, least, most), exchange = exchangeError();
  if (!table_.valid()) return;
  OFstream& os = table_();
  os << mesh_.time().value() << tab << std::to_string(r.particles).c_str() << tab << steps_ << tab
     << superficial.x() << tab << superficial.y() << tab << superficial.z() << tab << r.max_speed << tab << eps
     << tab << least << tab << most << tab << r.kinetic_energy;
  put(os, r.momentum);
  put(os, r.gravity_impulse);
  put(os, r.wall_impulse);
  put(os, r.force_impulse);
  os << tab << r.budget_error << tab << exchange << endl;
}

void fluidPhase::reportPlan(Ostream& os) const
{
  char text[4096];
  checkStatus(sph_plan_text(sph_, sizeof text, text), "fluidPhase::reportPlan");
  os << text;
  if (!solids())
  {
    os << "solid particles, porosity, drag | there is no constant/demProperties | all of DEM and of the exchange" << nl;
  }
}

void fluidPhase::report(Ostream& os) const
{
  sph_report r;
  checkStatus(sph_get_report(sph_, &r), "fluidPhase::report");
  vector superficial;
  scalar least, most;
  const scalar eps = volumeMean(superficial, least, most);
  os << "Fluid: " << std::to_string(r.particles).c_str() << " particles, steps " << steps_ << ", max speed "
     << r.max_speed << " m/s, density " << r.least_density << " to " << r.most_density << " kg/m3, pressure "
     << least << " to " << most << " Pa, least eps " << eps << nl << "Superficial velocity: " << superficial
     << " m/s; momentum budget: error " << r.budget_error << endl;
}

void fluidPhase::reportTimers(Ostream& os) const
{
  char text[4096];
  checkStatus(part_timers_report(sph_timers(sph_), particleCommunicator(), sizeof text, text), "timers");
  os << text;
}

scalar fluidPhase::particleSteps() const
{
  return returnReduce(scalar(sph_store(sph_)->local)*steps_, sumOp<scalar>());
}

} // namespace Foam
