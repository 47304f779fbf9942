/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "particleTables.H"

#include "OSspecific.H"
#include "Time.H"
#include "foamParams.H"

namespace Foam
{

static autoPtr<OFstream> openTable(const Time& time, const word& name)
{
  autoPtr<OFstream> file;
  if (!Pstream::master()) return file;
  const fileName folder(time.globalPath()/"postProcessing"/"particles"/time.timeName());
  mkDir(folder);
  file.reset(new OFstream(folder/name));
  file->precision(12);
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
  state_(openTable(time, "particles.dat"))
{
  if (state_.valid())
  {
    state_() << "# Time [s]\tparticles\tcontacts\twall contacts\tmax overlap\tmax speed [m/s]\tkinetic energy [J]"
                "\tpotential energy [J]\tmomentum x y z [N s]\tfrom gravity x y z\tfluid x y z\twalls x y z"
                "\tfixed particles x y z\tbudget error" << endl;
  }
  row();
}

void particleTables::row()
{
  dem_report r;
  checkStatus(dem_get_report(particles_.dem(), &r), "particleTables");
  const scalar potential = particles_.potentialEnergy(); // collective
  if (!state_.valid()) return;
  OFstream& os = state_();
  os << time_.value() << tab << std::to_string(r.particles).c_str() << tab
     << std::to_string(r.contacts).c_str() << tab << std::to_string(r.wall_contacts).c_str() << tab
     << r.max_overlap << tab << r.max_speed << tab << r.kinetic_energy << tab << potential;
  put(os, r.momentum);
  put(os, r.gravity_impulse);
  put(os, r.fluid_impulse);
  put(os, r.wall_impulse);
  put(os, r.support_impulse);
  os << tab << r.budget_error << endl;
}

void particleTables::write() { row(); }

} // namespace Foam
