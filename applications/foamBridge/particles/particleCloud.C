/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "particleCloud.H"

#include "IOField.H"
#include "Time.H"
#include "dem/dem.h"
#include "foamParams.H"
#include "meshSearch.H"
#include "particle/exchange.h"
#include "passiveParticleCloud.H"
#include "treeBoundBox.H"

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

static point position(const cloudRow& row)
{
  return point(row.position[0], row.position[1], row.position[2]);
}

/* Send each row to every rank whose mesh bounds hold its centre; each finds the cell; of those that
 * found one the lowest rank keeps the row. Fills rows and cells of this rank. */
static void distribute
(
  const polyMesh& mesh, MPI_Comm comm, const DynamicList<cloudRow>& own, DynamicList<cloudRow>& rows,
  DynamicList<label>& cells, label& outside
)
{
  List<boundBox> bounds(Pstream::nProcs());
  bounds[Pstream::myProcNo()] = boundBox(mesh.points(), false);
  Pstream::gatherList(bounds);
  Pstream::scatterList(bounds);

  DynamicList<int> to, from;
  DynamicList<cloudRow> sent;
  forAll(own, i)
  {
    forAll(bounds, proci)
    {
      if (!bounds[proci].contains(position(own[i]))) continue;
      to.append(proci);
      from.append(i);
      sent.append(own[i]);
    }
  }
  part_exchange* plan = nullptr;
  checkStatus(part_exchange_create(comm, to.size(), to.cdata(), &plan), "writeParticleCloud");
  List<cloudRow> received(part_exchange_receive_count(plan));
  checkStatus
  (
    part_exchange_forward(plan, sizeof(cloudRow), sent.cdata(), received.data()), "writeParticleCloud"
  );
  List<int> cell(received.size());
  const meshSearch search(mesh);
  forAll(received, k) cell[k] = search.findCell(position(received[k]));
  List<int> found(to.size());
  checkStatus
  (
    part_exchange_reverse(plan, sizeof(int), cell.cdata(), found.data()), "writeParticleCloud"
  );
  List<int> keeper(own.size(), -1);
  forAll(to, k)
  {
    if (found[k] >= 0 && keeper[from[k]] < 0) keeper[from[k]] = to[k];
  }
  List<int> keep(to.size());
  forAll(to, k) keep[k] = keeper[from[k]] == to[k];
  List<int> mine(received.size());
  checkStatus(part_exchange_forward(plan, sizeof(int), keep.cdata(), mine.data()), "writeParticleCloud");
  part_exchange_destroy(plan);
  forAll(received, k)
  {
    if (!mine[k]) continue;
    rows.append(received[k]);
    cells.append(cell[k]);
  }
  outside = 0;
  forAll(keeper, i) outside += keeper[i] < 0;
  reduce(outside, sumOp<label>());
}

void writeParticleCloud(const polyMesh& mesh, part_store* store, MPI_Comm comm)
{
  const DynamicList<cloudRow> own(ownRows(store));
  DynamicList<cloudRow> rows;
  DynamicList<label> cells;
  label outside;
  distribute(mesh, comm, own, rows, cells, outside);
  if (outside)
  {
    Info<< "Cloud: " << outside << " particles have their centre outside the mesh" << endl;
  }

  // origId is the particle's own number, and no counter is written that a restart would not know
  passiveParticleCloud cloud(mesh, "particles", IDLList<passiveParticle>());
  forAll(rows, i)
  {
    autoPtr<passiveParticle> p(new passiveParticle(mesh, position(rows[i]), cells[i]));
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
