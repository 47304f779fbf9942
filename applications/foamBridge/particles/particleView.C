/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "particleView.H"

namespace Foam
{

cpl_particles particleView(dem_t* dem)
{
  part_store* s = dem_store(dem);
  cpl_particles v = cpl_particles();
  v.count = s->local;
  v.position = part_field_double(s, DEM_FIELD_POSITION);
  v.position_stride = part_field_stride(s, DEM_FIELD_POSITION);
  v.radius = part_field_double(s, DEM_FIELD_RADIUS);
  v.radius_stride = part_field_stride(s, DEM_FIELD_RADIUS);
  v.velocity = part_field_double(s, DEM_FIELD_VELOCITY);
  v.velocity_stride = part_field_stride(s, DEM_FIELD_VELOCITY);
  // Of the sphere itself, in a block too: so the response of all members together stays bounded
  v.inverse_mass = part_field_double(s, DEM_FIELD_SPHERE_INVERSE_MASS);
  v.inverse_mass_stride = part_field_stride(s, DEM_FIELD_SPHERE_INVERSE_MASS);
  v.angular_velocity = part_field_double(s, DEM_FIELD_ANGULAR_VELOCITY);
  v.angular_velocity_stride = part_field_stride(s, DEM_FIELD_ANGULAR_VELOCITY);
  v.velocity_before = part_field_double(s, DEM_FIELD_VELOCITY_ENDED);
  v.velocity_before_stride = part_field_stride(s, DEM_FIELD_VELOCITY_ENDED);
  v.id = part_field_int64(s, DEM_FIELD_ID);
  v.id_stride = part_field_stride(s, DEM_FIELD_ID);
  v.kind = part_field_int64(s, DEM_FIELD_KIND);
  v.kind_stride = part_field_stride(s, DEM_FIELD_KIND);
  v.fluid_su = part_field_double(s, DEM_FIELD_FLUID_SU);
  v.fluid_su_stride = part_field_stride(s, DEM_FIELD_FLUID_SU);
  v.fluid_sp = part_field_double(s, DEM_FIELD_FLUID_SP);
  v.fluid_sp_stride = part_field_stride(s, DEM_FIELD_FLUID_SP);
  v.fluid_impulse = part_field_double(s, DEM_FIELD_FLUID_IMPULSE);
  v.fluid_impulse_stride = part_field_stride(s, DEM_FIELD_FLUID_IMPULSE);
  v.memory = dem_carried(dem);
  v.memory_stride = 3*CPL_MEMORY_VECTORS;
  return v;
}

} // namespace Foam
