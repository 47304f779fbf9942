/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "particleTables.H"

#include "OSspecific.H"
#include "Time.H"
#include "foamParams.H"

namespace Foam
{

static OFstream* openTable(const Time& time, const word& kind, const word& name, const char* head)
{
  if (!Pstream::master()) return nullptr;
  const fileName folder(time.globalPath()/"postProcessing"/kind/time.timeName());
  mkDir(folder);
  OFstream* file = new OFstream(folder/(name + ".dat"));
  file->precision(15); // enough for balances of these numbers to 1e-12
  *file << "# " << head << endl;
  return file;
}

static void put(Ostream& os, const double (&v)[3])
{
  for (const double component : v) os << tab << component;
}

particleTables::particleTables(const particleSystem& particles, const Time& time)
:
  particles_(particles),
  time_(time),
  state_
  (
    openTable
    (
      time, "particles", "particles",
      "Time [s]\tparticles\tcontacts\twall contacts\tmax overlap\tmax speed [m/s]\tkinetic energy [J]"
      "\tpotential energy [J]\tmass [kg]\tcentre x y z [m]\tmomentum x y z [N s]\tgravity impulse x y z [N s]\tfluid impulse x y z [N s]"
      "\twall impulse x y z [N s]\tsupport impulse x y z [N s]\tbudget error"
    )
  ),
  walls_(dem_wall_count(particles.dem())),
  bonded_(particles.state().bonds + particles.state().broken_bonds > 0),
  bonds_
  (
    bonded_
  ? openTable
    (
      time, "bonds", "bonds",
      "Time [s]\tbonds\tbroken\tenergy [J]\tlargest tensile stress [Pa]\tlargest shear stress [Pa]"
    )
  : nullptr
  ),
  broken_
  (
    bonded_ ? openTable(time, "bonds", "broken", "Time [s]\tid\tid of partner\tshear\tstress [Pa]") : nullptr
  ),
  brokenRows_(particles.state().broken_bonds)
{
  forAll(walls_, wall)
  {
    dem_wall_report r;
    checkStatus(dem_get_wall_report(particles.dem(), wall, &r), "particleTables");
    walls_.set
    (
      wall,
      openTable
      (
        time, "walls", r.name,
        "Time [s]\tcentre x y z [m]\tforce x y z [N]\ttorque x y z [N m]\timpulse x y z [N s]"
        "\tspin impulse x y z [N m s]\twork [J]"
      )
    );
  }
  write();
}

void particleTables::stateRow()
{
  const dem_report& r = particles_.state(); // collective, as the next
  scalar mass, potential;
  vector centre;
  particles_.weigh(mass, centre, potential);
  if (!state_.valid()) return;
  OFstream& os = state_();
  os << time_.value() << tab << std::to_string(r.particles).c_str() << tab
     << std::to_string(r.contacts).c_str() << tab << std::to_string(r.wall_contacts).c_str() << tab
     << r.max_overlap << tab << r.max_speed << tab << r.kinetic_energy << tab << potential << tab << mass
     << tab << centre.x() << tab << centre.y() << tab << centre.z();
  put(os, r.momentum);
  put(os, r.gravity_impulse);
  put(os, r.fluid_impulse);
  put(os, r.wall_impulse);
  put(os, r.support_impulse);
  os << tab << r.budget_error << endl;
}

void particleTables::wallRow(label wall)
{
  dem_wall_report r;
  checkStatus(dem_get_wall_report(particles_.dem(), wall, &r), "particleTables");
  if (!Pstream::master()) return;
  OFstream& os = walls_[wall];
  os << time_.value();
  put(os, r.centre);
  put(os, r.force);
  put(os, r.torque);
  put(os, r.impulse);
  put(os, r.spin_impulse);
  os << tab << r.work << endl;
}

void particleTables::bondRow()
{
  const dem_bond_state* bonds;
  size_t count;
  checkStatus(dem_bond_states(particles_.dem(), &bonds, &count), "particleTables");
  scalar tension = 0, shear = 0;
  for (size_t k = 0; k < count; ++k)
  {
    tension = max(tension, scalar(bonds[k].tensile_stress));
    shear = max(shear, scalar(bonds[k].shear_stress));
  }
  reduce(tension, maxOp<scalar>());
  reduce(shear, maxOp<scalar>());
  const dem_report& r = particles_.state(); // collective
  if (!Pstream::master()) return;
  bonds_() << time_.value() << tab << std::to_string(r.bonds).c_str() << tab
           << std::to_string(r.broken_bonds).c_str() << tab << r.bond_energy << tab << tension << tab << shear
           << endl;
}

void particleTables::brokenRows()
{
  const dem_broken_bond* broken;
  size_t count;
  checkStatus(dem_broken_bonds(particles_.dem(), &broken, &count), "particleTables");
  for (size_t k = brokenRows_; k < count && Pstream::master(); ++k)
  {
    broken_() << broken[k].time << tab << std::to_string(broken[k].a).c_str() << tab
              << std::to_string(broken[k].b).c_str() << tab << (broken[k].mode == DEM_BROKEN_BY_SHEAR)
              << tab << broken[k].stress << endl;
  }
  brokenRows_ = count;
}

void particleTables::write()
{
  stateRow();
  forAll(walls_, wall) wallRow(wall);
  if (bonded_)
  {
    bondRow();
    brokenRows();
  }
}

} // namespace Foam
