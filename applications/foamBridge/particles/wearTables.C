/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "wearTables.H"

#include "OFstream.H"
#include "OSspecific.H"
#include "Pstream.H"
#include "autoPtr.H"
#include "foamParams.H"
#include "scalarList.H"

namespace Foam
{

static autoPtr<OFstream> openFile(const Time& time, const word& kind, const word& name)
{
  if (!Pstream::master()) return autoPtr<OFstream>();
  const fileName folder(time.globalPath()/"postProcessing"/kind/time.timeName());
  mkDir(folder);
  autoPtr<OFstream> file(new OFstream(folder/(name + ".dat")));
  file->precision(12);
  return file;
}

static void writeWall(dem_t* dem, const Time& time, int wall)
{
  const int materials = dem_material_count(dem);
  dem_wall_report r;
  checkStatus(dem_get_wall_report(dem, wall, &r), "writeWear");
  scalarList energy(r.elements*materials), volume(r.elements), area(r.elements);
  checkStatus(dem_get_wear(dem, wall, energy.data(), volume.data(), area.data()), "writeWear");
  autoPtr<OFstream> file(openFile(time, "wear", r.name));
  if (!file.valid()) return;
  *file << "# element\tarea [m2]\tvolume worn [m3]\tthickness worn [m]";
  for (int m = 0; m < materials; ++m) *file << "\tshear energy of " << dem_material_name(dem, m) << " [J]";
  *file << nl;
  forAll(volume, i)
  {
    *file << i << tab << area[i] << tab << volume[i] << tab << volume[i]/area[i];
    for (int m = 0; m < materials; ++m) *file << tab << energy[i*materials + m];
    *file << nl;
  }
}

static void writeImpacts(dem_t* dem, const Time& time)
{
  autoPtr<OFstream> file(openFile(time, "impacts", "impacts"));
  if (file.valid()) *file << "# material\timpact energy [J]\tmass [kg]\tbreakage" << nl;
  for (int m = 0; m < dem_material_count(dem); ++m)
  {
    dem_impact impact;
    checkStatus(dem_get_impact(dem, m, &impact), "writeWear");
    if (!file.valid()) continue;
    *file << dem_material_name(dem, m) << tab << impact.energy << tab << impact.mass << tab
          << impact.breakage << nl;
  }
}

void writeWear(dem_t* dem, const Time& time)
{
  int shear = 0, impacts = 0;
  dem_wear_counted(dem, &shear, &impacts);
  for (int wall = 0; shear && wall < dem_wall_count(dem); ++wall) writeWall(dem, time, wall);
  if (impacts) writeImpacts(dem, time);
}

} // namespace Foam
