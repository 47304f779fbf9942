/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "lagrangianCloud.H"

#include "IOField.H"
#include "Time.H"
#include "cloudRows.H"
#include "passiveParticleCloud.H"

namespace Foam
{

static const int mostColumns = 6;

/* Of one particle what its cloud shows; a whole number stands in the first place of its column. */
struct cloudRow
{
  double position[3];
  int64_t id;
  union
  {
    double real[3];
    int64_t whole;
  } column[mostColumns];
};

static DynamicList<cloudRow> ownRows(part_store* s, const UList<cloudColumn>& columns)
{
  DynamicList<cloudRow> rows(s->local);
  const double* x = static_cast<const double*>(s->record[0]); // begins with the position
  const int xStride = s->layout->records[0].width;
  const int idField = s->layout->id_field;
  for (int i = 0; i < s->local; ++i)
  {
    cloudRow row;
    for (int d = 0; d < 3; ++d) row.position[d] = x[i*xStride + d];
    row.id = part_field_int64(s, idField)[i*part_field_stride(s, idField)];
    forAll(columns, c)
    {
      const int field = columns[c].field, at = i*part_field_stride(s, field);
      const part_field& f = s->layout->fields[field];
      if (s->layout->records[f.record].type == PART_INT64)
      {
        row.column[c].whole = part_field_int64(s, field)[at];
        continue;
      }
      for (int d = 0; d < f.comps; ++d)
      {
        row.column[c].real[d] = columns[c].factor*part_field_double(s, field)[at + d];
      }
    }
    rows.append(row);
  }
  return rows;
}

/* One field of the cloud. A rank without particles writes none, as OpenFOAM writes no positions there. */
template<class Type, class Value>
static void writeField
(
  const passiveParticleCloud& cloud, const word& name, const UList<cloudRow>& rows, const Value& value
)
{
  IOField<Type> field(cloud.fieldIOobject(name, IOobject::NO_READ), rows.size());
  forAll(rows, i) field[i] = value(rows[i]);
  field.write(rows.size() > 0);
}

static void writeColumn
(
  const passiveParticleCloud& cloud, const part_layout& layout, const cloudColumn& column, label c,
  const UList<cloudRow>& rows
)
{
  const part_field& f = layout.fields[column.field];
  if (layout.records[f.record].type == PART_INT64)
  {
    writeField<label>(cloud, column.name, rows, [c](const cloudRow& r) { return label(r.column[c].whole); });
  }
  else if (f.comps == 3)
  {
    writeField<vector>
    (
      cloud, column.name, rows,
      [c](const cloudRow& r)
      {
        const double* v = r.column[c].real;
        return vector(v[0], v[1], v[2]);
      }
    );
  }
  else
  {
    writeField<scalar>(cloud, column.name, rows, [c](const cloudRow& r) { return r.column[c].real[0]; });
  }
}

void writeLagrangianCloud
(
  const polyMesh& mesh, part_store* store, MPI_Comm comm, const word& cloudName,
  const UList<cloudColumn>& columns
)
{
  if (columns.size() > mostColumns)
  {
    FatalErrorInFunction << columns.size() << " columns; " << mostColumns << " at most" << exit(FatalError);
  }
  const DynamicList<cloudRow> own(ownRows(store, columns));
  DynamicList<cloudRow> rows;
  DynamicList<label> cells;
  label outside;
  distributeRows(mesh, comm, own, rows, cells, outside);
  if (outside)
  {
    Info<< "Cloud " << cloudName << ": " << outside << " particles have their centre outside the mesh" << endl;
  }

  // origId is the particle's own number, and no counter is written that a restart would not know
  passiveParticleCloud cloud(mesh, cloudName, IDLList<passiveParticle>());
  forAll(rows, i)
  {
    autoPtr<passiveParticle> p(new passiveParticle(mesh, rowPosition(rows[i]), cells[i]));
    p->origId() = label(rows[i].id);
    p->origProc() = 0;
    cloud.addParticle(p.release());
  }
  particle::particleCount_ = 0;

  cloud.write();
  writeField<label>(cloud, "id", rows, [](const cloudRow& r) { return label(r.id); });
  forAll(columns, c) writeColumn(cloud, *store->layout, columns[c], c, rows);
}

} // namespace Foam
