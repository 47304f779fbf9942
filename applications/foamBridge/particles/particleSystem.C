/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "particleSystem.H"

#include "Time.H"
#include "foamMesh.H"
#include "foamParams.H"
#include "lagrangianCloud.H"
#include "wearTables.H"

namespace Foam
{

particleSystem::particleSystem(const polyMesh& mesh, const vector& gravity, int carried, scalar added)
:
  mesh_(mesh),
  dict_
  (
    IOobject
    (
      "demProperties", mesh.time().constant(), mesh, IOobject::MUST_READ, IOobject::NO_WRITE
    )
  ),
  box_(foamMesh::box(mesh)),
  params_(),
  restarted_(false),
  dem_(createParticles(mesh, dict_, box_, gravity, carried, added, params_, restarted_)),
  substeps_(0),
  files_(mesh.time()),
  state_(),
  stateIsNow_(false),
  registry_(mesh, *this)
{}

particleSystem::~particleSystem() { dem_destroy(dem_); }

void particleSystem::advance(scalar dt)
{
  checkStatus(dem_advance(dem_, dt, &substeps_), dict_);
  stateIsNow_ = false;
}

void particleSystem::kick(const double* impulse)
{
  checkStatus(dem_kick(dem_, impulse), "particleSystem::kick");
  stateIsNow_ = false;
}

const dem_report& particleSystem::state() const
{
  if (!stateIsNow_)
  {
    checkStatus(dem_get_report(dem_, &state_), "particleSystem::state");
    stateIsNow_ = true;
  }
  return state_;
}

void particleSystem::write()
{
  files_.purge();
  checkStatus
  (
    dem_write(dem_, files_.present().c_str(), files_.series().c_str()), "particleSystem::write"
  );
  dem_set_time(dem_, mesh_.time().value()); // that of a restart
  const List<cloudColumn> columns
  ({
    {"U", DEM_FIELD_VELOCITY, 1}, {"omega", DEM_FIELD_ANGULAR_VELOCITY, 1}, {"d", DEM_FIELD_RADIUS, 2},
    {"kind", DEM_FIELD_KIND, 1}
  });
  writeLagrangianCloud(mesh_, dem_store(dem_), particleCommunicator(), "particles", columns);
  writeWear(dem_, mesh_.time());
}

void particleSystem::reportPlan(Ostream& os) const
{
  char text[4096];
  checkStatus(dem_plan_text(dem_, sizeof text, text), "particleSystem::reportPlan");
  os << text;
}

void particleSystem::reportStep(Ostream& os) const
{
  const scalar step = dem_stable_step(dem_);
  if (step > GREAT)
  {
    os << "Contact step: not limited, nothing can touch" << nl;
    return;
  }
  os << "Contact step: at most " << step << " s = timeStepFraction " << params_.time_step_fraction
     << " of the shortest contact time (or half period of a bond), " << step/params_.time_step_fraction
     << " s, of all materials that can meet (doc/equations.md D.11, B.9)" << nl;
}

void particleSystem::report(Ostream& os) const
{
  const dem_report& r = state();
  auto count = [](int64_t n) { return std::to_string(n); }; // beyond OpenFOAM's label
  os << "Particles: " << count(r.particles).c_str() << " substeps " << substeps_ << " contacts "
     << count(r.contacts).c_str() << " + " << count(r.wall_contacts).c_str() << " on walls, max overlap "
     << r.max_overlap << ", max speed " << r.max_speed << " m/s";
  if (r.bonds + r.broken_bonds > 0)
  {
    os << ", bonds " << count(r.bonds).c_str() << ", broken " << count(r.broken_bonds).c_str();
  }
}

void particleSystem::reportBudget(Ostream& os) const
{
  os << "Particle momentum budget: error " << state().budget_error;
}

void particleSystem::reportTimers(Ostream& os) const
{
  char text[4096];
  checkStatus(part_timers_report(dem_timers(dem_), particleCommunicator(), sizeof text, text), "timers");
  os << text;
}

scalar particleSystem::particleSteps() const
{
  return returnReduce(scalar(dem_store(dem_)->local)*substeps_, sumOp<scalar>());
}

void particleSystem::weigh(scalar& mass, vector& centre, scalar& energy) const
{
  part_store* s = dem_store(dem_);
  const double* x = part_field_double(s, DEM_FIELD_POSITION);
  const double* inverseMass = part_field_double(s, DEM_FIELD_SPHERE_INVERSE_MASS);
  const int64_t* kind = part_field_int64(s, DEM_FIELD_KIND);
  const double* material = part_field_double(s, DEM_FIELD_MATERIAL);
  const int materialStride = part_field_stride(s, DEM_FIELD_MATERIAL);
  const int xStride = part_field_stride(s, DEM_FIELD_POSITION);
  const int massStride = part_field_stride(s, DEM_FIELD_SPHERE_INVERSE_MASS);
  const int kindStride = part_field_stride(s, DEM_FIELD_KIND);
  mass = 0;
  centre = Zero;
  for (int i = 0; i < s->local; ++i)
  {
    if (kind[i*kindStride] == DEM_FIXED) continue;
    const scalar own = dem_own_share(dem_, int(material[i*materialStride])); // not the added mass
    const scalar m = own/inverseMass[i*massStride];
    mass += m;
    centre += m*vector(x[i*xStride], x[i*xStride + 1], x[i*xStride + 2]);
  }
  reduce(mass, sumOp<scalar>());
  reduce(centre, sumOp<vector>());
  centre /= max(mass, VSMALL);
  energy = 0;
  for (direction d = 0; d < 3; ++d)
  {
    if (!box_.periodic[d]) energy -= mass*params_.gravity[d]*(centre[d] - box_.lo[d]);
  }
}

} // namespace Foam
