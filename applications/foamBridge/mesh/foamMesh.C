/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "foamMesh.H"

#include "ListListOps.H"
#include "coupledFvPatch.H"
#include "cyclicPolyPatch.H"
#include "foamParams.H"
#include "fvMesh.H"
#include "processorCyclicPolyPatch.H"
#include "processorPolyPatch.H"

#include <cstring>

namespace Foam
{

foamMesh::foamMesh(const fvMesh& mesh)
:
  mesh_(mesh),
  faceStart_(mesh.nFaces() + 1),
  owner_(mesh.nFaces()),
  neighbour_(mesh.nInternalFaces())
{
  label corners = 0;
  forAll(mesh.faces(), facei)
  {
    faceStart_[facei] = corners;
    corners += mesh.faces()[facei].size();
    owner_[facei] = mesh.faceOwner()[facei];
  }
  faceStart_[mesh.nFaces()] = corners;
  facePoint_.setSize(corners);
  forAll(mesh.faces(), facei)
  {
    const face& f = mesh.faces()[facei];
    forAll(f, i) facePoint_[faceStart_[facei] + i] = f[i];
  }
  forAll(neighbour_, facei) neighbour_[facei] = mesh.faceNeighbour()[facei];

  view_.points = mesh.nPoints();
  view_.faces = mesh.nFaces();
  view_.internal = mesh.nInternalFaces();
  view_.cells = mesh.nCells();
  view_.point = reinterpret_cast<const double*>(mesh.points().cdata());
  view_.face_start = faceStart_.cdata();
  view_.face_point = facePoint_.cdata();
  view_.owner = owner_.cdata();
  view_.neighbour = neighbour_.cdata();
  view_.face_centre = reinterpret_cast<const double*>(mesh.faceCentres().cdata());
  view_.cell_centre = reinterpret_cast<const double*>(mesh.cellCentres().cdata());
  view_.volume = mesh.cellVolumes().cdata();
  makeCoupled();
}

void foamMesh::makeCoupled()
{
  DynamicList<int> cells;
  DynamicList<double> conductance;
  DynamicList<vector> way;
  coupledStart_.setSize(mesh_.boundary().size(), -1);
  forAll(mesh_.boundary(), patchi)
  {
    const fvPatch& patch = mesh_.boundary()[patchi];
    if (!patch.coupled()) continue;
    coupledStart_[patchi] = cells.size();
    const labelUList& faceCells = patch.faceCells();
    const vectorField d(patch.delta());
    forAll(faceCells, i)
    {
      cells.append(faceCells[i]);
      conductance.append(max(patch.Sf()[i] & d[i], scalar(0))/magSqr(d[i]));
      way.append(d[i]);
    }
  }
  coupledCell_ = cells;
  conductance_ = conductance;
  way_ = way;
  coupled_.count = coupledCell_.size();
  coupled_.cell = coupledCell_.cdata();
  coupled_.conductance = conductance_.cdata();
  coupled_.way = reinterpret_cast<const double*>(way_.cdata());
  coupled_.exchange = exchange;
  coupled_.context = this;
  view_.coupled = &coupled_;
}

/* Cyclic patches lie on this rank; for processor patches both ranks list the faces in one order. */
int foamMesh::exchange(void* context, int n, const double* own, double* other)
{
  const foamMesh& self = *static_cast<const foamMesh*>(context);
  const polyBoundaryMesh& patches = self.mesh_.boundaryMesh();
  const label requests = UPstream::nRequests();
  forAll(patches, patchi)
  {
    if (self.coupledStart_[patchi] < 0) continue;
    const std::size_t size = std::size_t(patches[patchi].size())*n;
    double* to = other + std::size_t(self.coupledStart_[patchi])*n;
    if (isA<processorPolyPatch>(patches[patchi]))
    {
      const processorPolyPatch& patch = refCast<const processorPolyPatch>(patches[patchi]);
      const double* from = own + std::size_t(self.coupledStart_[patchi])*n;
      UIPstream::read
      (
        UPstream::commsTypes::nonBlocking, patch.neighbProcNo(), reinterpret_cast<char*>(to),
        size*sizeof(double), patch.tag(), patch.comm()
      );
      UOPstream::write
      (
        UPstream::commsTypes::nonBlocking, patch.neighbProcNo(), reinterpret_cast<const char*>(from),
        size*sizeof(double), patch.tag(), patch.comm()
      );
    }
    else if (!isA<cyclicPolyPatch>(patches[patchi]))
    {
      FatalErrorInFunction
          << "patch " << patches[patchi].name() << " of type " << patches[patchi].type()
          << ": smoothing goes through cyclic patches whose faces match; allowed: cyclic, or smoothing off"
          << exit(FatalError);
    }
    else
    {
      const label partner = refCast<const cyclicPolyPatch>(patches[patchi]).neighbPatchID();
      std::memcpy(to, own + std::size_t(self.coupledStart_[partner])*n, size*sizeof(double));
    }
  }
  UPstream::waitRequests(requests);
  return PART_OK;
}

part_box foamMesh::box(const polyMesh& mesh)
{
  if (!returnReduce(mesh.nCells(), sumOp<label>()))
  {
    FatalErrorInFunction << "the mesh in " << mesh.meshDir() << " has no cells" << exit(FatalError);
  }
  const boundBox& bounds = mesh.bounds();
  part_box box = part_box();
  for (direction d = 0; d < 3; ++d)
  {
    box.lo[d] = bounds.min()[d];
    box.hi[d] = bounds.max()[d];
  }
  FixedList<label, 3> periodic(0);
  for (const polyPatch& patch : mesh.boundaryMesh())
  {
    vector apart(Zero);
    bool rotational = false;
    if (isA<cyclicPolyPatch>(patch))
    {
      const cyclicPolyPatch& cyclic = refCast<const cyclicPolyPatch>(patch);
      if (!patch.size()) continue; // its faces are processorCyclic patches here
      rotational = !cyclic.parallel();
      apart = patch.faceCentres()[0] - cyclic.neighbPatch().faceCentres()[0];
    }
    else if (isA<processorCyclicPolyPatch>(patch) && patch.size())
    {
      const processorCyclicPolyPatch& cyclic = refCast<const processorCyclicPolyPatch>(patch);
      rotational = !cyclic.referPatch().parallel();
      apart = patch.faceCentres()[0] - cyclic.neighbFaceCentres()[0];
    }
    else
    {
      continue;
    }
    const scalar length = mag(apart);
    direction axis = 3;
    for (direction d = 0; d < 3; ++d)
    {
      if (mag(mag(apart[d]) - length) < 1e-9*length) axis = d;
    }
    if (rotational || axis == 3)
    {
      FatalErrorInFunction
          << "cyclic patch " << patch.name() << " is not a translation along x, y or z:"
          << " particles can not be periodic across it" << exit(FatalError);
    }
    periodic[axis] = 1;
  }
  for (direction d = 0; d < 3; ++d) reduce(periodic[d], maxOp<label>());
  for (direction d = 0; d < 3; ++d) box.periodic[d] = periodic[d];
  return box;
}

List<FixedList<point, 3>> foamMesh::triangles(const polyMesh& mesh, const label patchi)
{
  const polyPatch& patch = mesh.boundaryMesh()[patchi];
  DynamicList<FixedList<point, 3>> mine;
  forAll(patch, i)
  {
    // Corners in reverse: OpenFOAM's faces point out of the domain, walls into it
    faceList parts(patch[i].nTriangles(mesh.points()));
    label n = 0;
    patch[i].triangles(mesh.points(), n, parts);
    for (const face& f : parts)
    {
      FixedList<point, 3> triangle;
      triangle[0] = mesh.points()[f[0]];
      triangle[1] = mesh.points()[f[2]];
      triangle[2] = mesh.points()[f[1]];
      mine.append(triangle);
    }
  }
  List<List<FixedList<point, 3>>> all(Pstream::nProcs());
  all[Pstream::myProcNo()] = mine;
  Pstream::gatherList(all);
  Pstream::scatterList(all);
  return ListListOps::combine<List<FixedList<point, 3>>>(all, accessOp<List<FixedList<point, 3>>>());
}

} // namespace Foam
