/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "foamMesh.H"

#include "ListListOps.H"
#include "cyclicPolyPatch.H"
#include "processorCyclicPolyPatch.H"

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
