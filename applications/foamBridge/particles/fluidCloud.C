/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fluidCloud.H"

#include "IOField.H"
#include "Time.H"
#include "cloudRows.H"
#include "passiveParticleCloud.H"
#include "sph/sph.h"

namespace Foam
{

struct fluidRow
{
  double position[3], velocity[3], pressure, eps, density;
  int64_t id;
};

static DynamicList<fluidRow> ownRows(part_store* s)
{
  DynamicList<fluidRow> rows(s->local);
  auto component = [s](int field, int i, int d)
  {
    return part_field_double(s, field)[i*part_field_stride(s, field) + d];
  };
  for (int i = 0; i < s->local; ++i)
  {
    fluidRow row;
    for (int d = 0; d < 3; ++d)
    {
      row.position[d] = component(SPH_FIELD_POSITION, i, d);
      row.velocity[d] = component(SPH_FIELD_VELOCITY, i, d);
    }
    row.pressure = component(SPH_FIELD_PRESSURE, i, 0);
    row.eps = component(SPH_FIELD_EPS, i, 0);
    row.density = component(SPH_FIELD_DENSITY, i, 0);
    row.id = part_field_int64(s, SPH_FIELD_ID)[i*part_field_stride(s, SPH_FIELD_ID)];
    rows.append(row);
  }
  return rows;
}

void writeFluidCloud(const polyMesh& mesh, part_store* store, MPI_Comm comm)
{
  const DynamicList<fluidRow> own(ownRows(store));
  DynamicList<fluidRow> rows;
  DynamicList<label> cells;
  label outside;
  distributeRows(mesh, comm, own, rows, cells, outside);
  if (outside)
  {
    Info<< "Cloud: " << outside << " fluid particles are outside the mesh" << endl;
  }
  passiveParticleCloud cloud(mesh, "fluid", IDLList<passiveParticle>());
  forAll(rows, i)
  {
    autoPtr<passiveParticle> p(new passiveParticle(mesh, rowPosition(rows[i]), cells[i]));
    p->origId() = label(rows[i].id);
    p->origProc() = 0;
    cloud.addParticle(p.release());
  }
  particle::particleCount_ = 0;

  auto io = [&](const word& name) { return cloud.fieldIOobject(name, IOobject::NO_READ); };
  IOField<vector> U(io("U"), rows.size());
  IOField<scalar> p(io("p"), rows.size()), eps(io("eps"), rows.size()), rho(io("rho"), rows.size());
  IOField<label> id(io("id"), rows.size());
  forAll(rows, i)
  {
    U[i] = vector(rows[i].velocity[0], rows[i].velocity[1], rows[i].velocity[2]);
    p[i] = rows[i].pressure;
    eps[i] = rows[i].eps;
    rho[i] = rows[i].density;
    id[i] = label(rows[i].id);
  }
  const bool any = rows.size() > 0;
  cloud.write();
  U.write(any);
  p.write(any);
  eps.write(any);
  rho.write(any);
  id.write(any);
}

} // namespace Foam
