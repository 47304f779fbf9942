/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fluidWalls.H"

#include "IFstream.H"
#include "OSspecific.H"
#include "Time.H"
#include "coupledPolyPatch.H"
#include "emptyPolyPatch.H"
#include "foamMesh.H"
#include "foamParams.H"

#include <algorithm>

namespace Foam
{

/* ---- conditions of U -------------------------------------------------------------------------- */
static dictionary readU(const polyMesh& mesh, fileName& path)
{
  const word instance(mesh.time().findInstance("", "U", IOobject::READ_IF_PRESENT));
  path = mesh.time().path()/instance/"U";
  autoPtr<IFstream> is(new IFstream(path));
  if (!is->good())
  {
    FatalErrorInFunction
        << "there is no field U, whose boundary conditions say which patches are walls: " << path
        << exit(FatalError);
  }
  return dictionary(is());
}

enum patchKind { NO_WALL, FREE_SLIP, NO_SLIP };

static patchKind kindOf(const polyPatch& patch, const dictionary& U, const fileName& path, vector& velocity)
{
  velocity = Zero;
  if (isA<coupledPolyPatch>(patch) || !returnReduce(patch.size(), sumOp<label>())) return NO_WALL;
  const dictionary& fields = U.subDict("boundaryField");
  if (!fields.found(patch.name(), keyType::REGEX))
  {
    FatalErrorInFunction << "file " << path << ": no condition for patch " << patch.name() << exit(FatalError);
  }
  const dictionary& dict = fields.subDict(patch.name());
  const word type(dict.get<word>("type"));
  if (wordList({"slip", "symmetry", "symmetryPlane"}).found(type)) return FREE_SLIP;
  if (type == "noSlip") return NO_SLIP;
  if (wordList({"zeroGradient", "inletOutlet", "pressureInletOutletVelocity"}).found(type)) return NO_WALL;
  if (type == "fixedValue" && patch.type() == "wall")
  {
    ITstream& is = dict.lookup("value");
    const word first(is);
    if (first == "uniform")
    {
      is >> velocity;
      return NO_SLIP;
    }
  }
  FatalErrorInFunction
      << "file " << path << ": patch " << patch.name() << " has the condition " << type
      << ", which sphDemFoam does not have; allowed: noSlip, slip, symmetry, fixedValue uniform of a wall, and those of"
      << " an open patch (zeroGradient, inletOutlet, pressureInletOutletVelocity: a free surface)"
      << exit(FatalError);
  return NO_WALL;
}

/* ---- planes ----------------------------------------------------------------------------------- */
static vector normalOf(const FixedList<point, 3>& t)
{
  vector n((t[1] - t[0]) ^ (t[2] - t[0]));
  n /= max(mag(n), VSMALL);
  for (direction d = 0; d < 3; ++d)
  {
    if (mag(n[d]) < 1e-9) n[d] = 0; // rounding of corners; a wall along a periodic direction must be it exactly
  }
  return n/max(mag(n), VSMALL);
}

static bool inPlane(const sph_wall_params& p, const FixedList<point, 3>& t, scalar size)
{
  const vector n(p.normal[0], p.normal[1], p.normal[2]), x(p.point[0], p.point[1], p.point[2]);
  return mag(normalOf(t) - n) < 1e-6 && mag((t[0] - x) & n) < 1e-6*size;
}

static void put(double (&to)[3], const vector& v)
{
  for (direction d = 0; d < 3; ++d) to[d] = v[d];
}

/* Is all of the domain on one side? */
static bool bounds(const polyMesh& mesh, const sph_wall_params& p, scalar size)
{
  const vector n(p.normal[0], p.normal[1], p.normal[2]), x(p.point[0], p.point[1], p.point[2]);
  scalar least = GREAT;
  for (const point& corner : mesh.points()) least = min(least, (corner - x) & n);
  reduce(least, minOp<scalar>());
  return least > -1e-6*size;
}

/* What all walls have in common. */
static sph_wall_params readWalls(const dictionary& properties)
{
  sph_wall_params params;
  part_params_default(&sph_wall_table, &params);
  part_params_set(&sph_wall_table, "type", nullptr, "triangles", &params); // required; that of the patches
  if (properties.found("walls"))
  {
    const dictionary& walls = properties.subDict("walls");
    checkEntries(walls, wordList({"model", "layers", "stiffness", "restitution"}));
    updateParams(walls, sph_wall_table, &params);
  }
  return params;
}

static fluidWall makeWall(const word& name, const sph_wall_params& common, patchKind kind, const vector& velocity)
{
  fluidWall w;
  w.name = name;
  w.params = common;
  w.params.type = SPH_TRIANGLES;
  w.params.slip = kind == FREE_SLIP ? SPH_FREE_SLIP : SPH_NO_SLIP;
  put(w.params.velocity, velocity);
  return w;
}

/* The planes of one patch, appended. False: too many, it is curved. */
static bool addPlanes
(
  DynamicList<fluidWall>& planes, const fluidWall& patch, const List<FixedList<point, 3>>& triangles, scalar size
)
{
  label number = 0;
  const label first = planes.size();
  for (const FixedList<point, 3>& t : triangles)
  {
    bool known = false;
    for (label k = first; k < planes.size() && !known; ++k) known = inPlane(planes[k].params, t, size);
    if (known) continue;
    fluidWall w(patch);
    w.name = patch.name + ':' + Foam::name(number++);
    w.params.type = SPH_PLANE;
    put(w.params.point, t[0]);
    put(w.params.normal, normalOf(t));
    planes.append(w);
    if (planes.size() > 12) return false;
  }
  return true;
}

/* In an order that does not depend on the decomposition: of walls at the same distance the first one counts. */
static List<FixedList<point, 3>> sorted(const List<FixedList<point, 3>>& triangles)
{
  List<FixedList<point, 3>> list(triangles);
  std::sort
  (
    list.begin(), list.end(),
    [](const FixedList<point, 3>& a, const FixedList<point, 3>& b)
    {
      for (label c = 0; c < 3; ++c)
      {
        for (direction d = 0; d < 3; ++d)
        {
          if (a[c][d] != b[c][d]) return a[c][d] < b[c][d];
        }
      }
      return false;
    }
  );
  return list;
}

/* Walls go on beyond periodic borders as far as the kernel reaches. */
static List<FixedList<point, 3>> withImages
(
  const List<FixedList<point, 3>>& triangles, const part_box& box, scalar reach
)
{
  DynamicList<FixedList<point, 3>> all(triangles);
  for (direction d = 0; d < 3; ++d)
  {
    if (!box.periodic[d]) continue;
    const label before = all.size();
    for (label k = 0; k < before; ++k)
    {
      for (int side = -1; side <= 1; side += 2)
      {
        FixedList<point, 3> t(all[k]);
        scalar lo = GREAT, hi = -GREAT;
        for (label c = 0; c < 3; ++c)
        {
          t[c][d] += side*(box.hi[d] - box.lo[d]);
          lo = min(lo, t[c][d]);
          hi = max(hi, t[c][d]);
        }
        if (hi > box.lo[d] - 2*reach && lo < box.hi[d] + 2*reach) all.append(t);
      }
    }
  }
  return List<FixedList<point, 3>>(all);
}

/* Plane k is no other wall's too, and no open patch lies in it. */
static bool apart
(
  const DynamicList<fluidWall>& planes, label k, const List<List<FixedList<point, 3>>>& open, scalar size
)
{
  const sph_wall_params& plane = planes[k].params;
  const vector n(plane.normal[0], plane.normal[1], plane.normal[2]);
  const vector y(plane.point[0], plane.point[1], plane.point[2]);
  for (label other = 0; other < k; ++other)
  {
    const sph_wall_params& p = planes[other].params;
    const vector m(p.normal[0], p.normal[1], p.normal[2]);
    const vector x(p.point[0], p.point[1], p.point[2]);
    if (mag(n - m) < 1e-6 && mag((x - y) & n) < 1e-6*size) return false;
  }
  for (const List<FixedList<point, 3>>& triangles : open)
  {
    for (const FixedList<point, 3>& t : triangles)
    {
      if (inPlane(plane, t, size)) return false;
    }
  }
  return true;
}

DynamicList<fluidWall> fluidWalls
(
  const polyMesh& mesh, const part_box& box, const dictionary& properties, const sph_params& params, bool lids
)
{
  const sph_wall_params common(readWalls(properties));
  const scalar reach = sph_kernel_support(params.kernel)*params.smoothing_length;
  fileName path;
  const dictionary U(readU(mesh, path));
  scalar size = 0;
  for (direction d = 0; d < 3; ++d) size = max(size, box.hi[d] - box.lo[d]);
  DynamicList<fluidWall> patches, planes;
  List<List<FixedList<point, 3>>> open;
  bool flat = true;
  for (const polyPatch& patch : mesh.boundaryMesh())
  {
    if (isA<coupledPolyPatch>(patch) && patch.index() >= mesh.boundaryMesh().nNonProcessor()) continue;
    if (isA<emptyPolyPatch>(patch))
    {
      if (params.dimensions == 2) continue;
      FatalErrorInFunction
          << "patch " << patch.name() << " is empty, which a fluid in three dimensions can not have: constant/sphProperties"
          << " needs dimensions 2, or the patch another type" << exit(FatalError);
    }
    vector velocity;
    patchKind kind = kindOf(patch, U, path, velocity);
    if (kind == NO_WALL && lids && !isA<coupledPolyPatch>(patch) && returnReduce(patch.size(), sumOp<label>()))
    {
      kind = FREE_SLIP;
      Info<< "Patch " << patch.name() << " is a lid: with pressure p_rgh there is no free surface" << nl;
    }
    if (kind == NO_WALL && isA<coupledPolyPatch>(patch)) continue;
    const List<FixedList<point, 3>> triangles(sorted(foamMesh::triangles(mesh, patch.index())));
    if (kind == NO_WALL)
    {
      if (params.density_scheme == SPH_SUMMATION && returnReduce(patch.size(), sumOp<label>()))
      {
        FatalIOErrorInFunction(properties)
            << "entry 'densityScheme': summation is not for a free surface, and patch " << patch.name()
            << " is open; allowed: continuity, or pressure p_rgh" << exit(FatalIOError);
      }
      open.append(triangles);
      continue;
    }
    patches.append(makeWall(patch.name(), common, kind, velocity));
    flat = flat && addPlanes(planes, patches.last(), triangles, size);
    patches.last().triangles = withImages(triangles, box, reach);
  }
  for (label k = 0; k < planes.size() && flat; ++k) flat = bounds(mesh, planes[k].params, size);
  for (label k = 0; k < planes.size() && flat; ++k) flat = apart(planes, k, open, size);
  for (const fluidWall& w : patches)
  {
    if (!flat && mag(vector(w.params.velocity[0], w.params.velocity[1], w.params.velocity[2])) > 0)
    {
      FatalErrorInFunction
          << "file " << path << ": patch " << w.name << " has a velocity (fixedValue), which sphDemFoam has for the flat"
          << " walls of a convex container alone; here it must be noSlip or slip" << exit(FatalError);
    }
  }
  return flat ? planes : patches;
}

DynamicList<cpl_points_plane> mirrors(const DynamicList<fluidWall>& walls)
{
  DynamicList<cpl_points_plane> planes;
  for (const fluidWall& w : walls)
  {
    if (w.params.type != SPH_PLANE) return DynamicList<cpl_points_plane>();
    const vector n(w.params.normal[0], w.params.normal[1], w.params.normal[2]);
    for (const cpl_points_plane& other : planes)
    {
      const scalar c = mag(n & vector(other.normal[0], other.normal[1], other.normal[2]));
      if (c > 1e-9 && c < 1 - 1e-9) return DynamicList<cpl_points_plane>();
    }
    cpl_points_plane p;
    for (direction d = 0; d < 3; ++d)
    {
      p.point[d] = w.params.point[d];
      p.normal[d] = w.params.normal[d];
    }
    planes.append(p);
  }
  return planes;
}

} // namespace Foam
