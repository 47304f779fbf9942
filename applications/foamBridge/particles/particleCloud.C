/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "particleCloud.H"

#include "IOField.H"
#include "cloudRows.H"
#include "Time.H"
#include "dem/dem.h"
#include "foamParams.H"
#include "passiveParticleCloud.H"

namespace Foam
{

struct cloudRow
{
  double position[3], velocity[3], omega[3], diameter;
  int64_t id, kind;
};

static DynamicList<cloudRow> ownRows(part_store* s)
{
  DynamicList<cloudRow> rows(s->local);
  auto component = [s](int field, int i, int d)
  {
    return part_field_double(s, field)[i*part_field_stride(s, field) + d];
  };
  for (int i = 0; i < s->local; ++i)
  {
    cloudRow row;
    for (int d = 0; d < 3; ++d)
    {
      row.position[d] = component(DEM_FIELD_POSITION, i, d);
      row.velocity[d] = component(DEM_FIELD_VELOCITY, i, d);
      row.omega[d] = component(DEM_FIELD_ANGULAR_VELOCITY, i, d);
    }
    row.diameter = 2*component(DEM_FIELD_RADIUS, i, 0);
    row.id = part_field_int64(s, DEM_FIELD_ID)[i*part_field_stride(s, DEM_FIELD_ID)];
    row.kind = part_field_int64(s, DEM_FIELD_KIND)[i*part_field_stride(s, DEM_FIELD_KIND)];
    rows.append(row);
  }
  return rows;
}

void writeParticleCloud(const polyMesh& mesh, part_store* store, MPI_Comm comm)
{
  const DynamicList<cloudRow> own(ownRows(store));
  DynamicList<cloudRow> rows;
  DynamicList<label> cells;
  label outside;
  distributeRows(mesh, comm, own, rows, cells, outside);
  if (outside)
  {
    Info<< "Cloud: " << outside << " particles have their centre outside the mesh" << endl;
  }

  // origId is the particle's own number, and no counter is written that a restart would not know
  passiveParticleCloud cloud(mesh, "particles", IDLList<passiveParticle>());
  forAll(rows, i)
  {
    autoPtr<passiveParticle> p(new passiveParticle(mesh, rowPosition(rows[i]), cells[i]));
    p->origId() = label(rows[i].id);
    p->origProc() = 0;
    cloud.addParticle(p.release());
  }
  particle::particleCount_ = 0;

  auto io = [&](const word& name) { return cloud.fieldIOobject(name, IOobject::NO_READ); };
  IOField<vector> U(io("U"), rows.size()), omega(io("omega"), rows.size());
  IOField<scalar> d(io("d"), rows.size());
  IOField<label> id(io("id"), rows.size()), kind(io("kind"), rows.size());
  forAll(rows, i)
  {
    U[i] = vector(rows[i].velocity[0], rows[i].velocity[1], rows[i].velocity[2]);
    omega[i] = vector(rows[i].omega[0], rows[i].omega[1], rows[i].omega[2]);
    d[i] = rows[i].diameter;
    id[i] = label(rows[i].id);
    kind[i] = label(rows[i].kind);
  }
  // A rank without particles writes no fields, as OpenFOAM writes no positions there
  const bool any = rows.size() > 0;
  cloud.write();
  U.write(any);
  omega.write(any);
  d.write(any);
  id.write(any);
  kind.write(any);
}

} // namespace Foam
