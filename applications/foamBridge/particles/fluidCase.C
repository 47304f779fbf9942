/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fluidCase.H"

#include "IFstream.H"
#include "OSspecific.H"
#include "Time.H"
#include "coupledPolyPatch.H"
#include "emptyPolyPatch.H"
#include "foamMesh.H"
#include "foamParams.H"
#include "meshSearch.H"
#include "particleCase.H"

#include <algorithm>
#include <vector>

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
      open.append(triangles);
      continue;
    }
    patches.append(makeWall(patch.name(), common, kind, velocity));
    flat = flat && addPlanes(planes, patches.last(), triangles, size);
    patches.last().triangles = withImages(triangles, box, reach);
  }
  for (label k = 0; k < planes.size() && flat; ++k) flat = bounds(mesh, planes[k].params, size);
  for (label k = 0; k < planes.size() && flat; ++k)
  {
    for (label other = 0; other < k; ++other) // one plane, two walls
    {
      const vector x(planes[other].params.point[0], planes[other].params.point[1], planes[other].params.point[2]);
      FixedList<point, 3> t(x);
      const vector n(planes[k].params.normal[0], planes[k].params.normal[1], planes[k].params.normal[2]);
      const vector m(planes[other].params.normal[0], planes[other].params.normal[1], planes[other].params.normal[2]);
      const vector y(planes[k].params.point[0], planes[k].params.point[1], planes[k].params.point[2]);
      if (mag(n - m) < 1e-6 && mag((x - y) & n) < 1e-6*size) flat = false;
    }
    for (const List<FixedList<point, 3>>& triangles : open)
    {
      for (const FixedList<point, 3>& t : triangles) flat = flat && !inPlane(planes[k].params, t, size);
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

/* ---- parameters ------------------------------------------------------------------------------- */
vector gravityAtRest(const IOdictionary& dict, const part_box& box, const vector& drive)
{
  const word kind(dict.getOrDefault<word>("pressure", "p"));
  vector still(Zero);
  if (kind == "p") return still;
  if (kind != "p_rgh")
  {
    FatalIOErrorInFunction(dict)
        << "entry 'pressure': " << kind << "; allowed: p, p_rgh" << exit(FatalIOError);
  }
  if (dict.found("fill"))
  {
    FatalIOErrorInFunction(dict)
        << "entry 'fill' makes a free surface, at which pressure p_rgh is not 0; allowed: pressure p"
        << exit(FatalIOError);
  }
  for (direction d = 0; d < 3; ++d)
  {
    if (!box.periodic[d]) still[d] = drive[d];
  }
  return still;
}

sph_params readFluid
(
  const IOdictionary& dict, const fluidProperties& properties, const vector& still, const part_box& box, bool solids
)
{
  sph_params params;
  part_params_default(&sph_params_table, &params);
  const wordList elsewhere({"density", "viscosity", "gravity"});
  const wordList where({"transportProperties (rho)", "transportProperties (rho nu)", "g and bodyAcceleration"});
  forAll(elsewhere, k)
  {
    if (!dict.found(elsewhere[k])) continue;
    FatalIOErrorInFunction(dict)
        << "entry '" << elsewhere[k] << "' belongs in constant/" << where[k].c_str()
        << ", which both methods share" << exit(FatalIOError);
  }
  params.density = properties.density;
  params.viscosity = properties.viscosity;
  put(params.gravity, properties.drive - still);
  updateParams(dict, sph_params_table, &params, wordList({"coupling", "fill", "walls", "pressure"}));
  if (params.dimensions == 2 && solids)
  {
    FatalIOErrorInFunction(dict)
        << "entry 'dimensions' can not be 2 with solid particles: volume fraction and drag are those of spheres;"
        << " allowed: 3" << exit(FatalIOError);
  }
  if (params.dimensions == 2 && !dict.found("depth")) params.depth = box.hi[2] - box.lo[2];
  return params;
}

/* ---- fill ------------------------------------------------------------------------------------- */
struct lattice
{
  vector lo, side;
  FixedList<label, 3> n;
  label size() const { return n[0]*n[1]*n[2]; }
  point at(label k) const
  {
    return lo + vector
    (
      (k % n[0] + 0.5)*side.x(), (k/n[0] % n[1] + 0.5)*side.y(), (k/(n[0]*n[1]) + 0.5)*side.z()
    );
  }
};

static lattice makeLattice(const IOdictionary& dict, const part_box& box, const sph_params& params)
{
  const scalar spacing = params.spacing;
  lattice l;
  vector lo(box.lo[0], box.lo[1], box.lo[2]), hi(box.hi[0], box.hi[1], box.hi[2]);
  if (dict.found("fill"))
  {
    const dictionary& fill = dict.subDict("fill");
    checkEntries(fill, wordList({"min", "max"}));
    lo = max(lo, fill.getOrDefault<vector>("min", lo));
    hi = min(hi, fill.getOrDefault<vector>("max", hi));
  }
  l.lo = lo;
  scalar all = 1;
  for (direction d = 0; d < 3; ++d)
  {
    const scalar cells =
      d == 2 && params.dimensions == 2 ? scalar(1) : std::floor((hi[d] - lo[d])/spacing + 0.5);
    if (cells < 1)
    {
      FatalIOErrorInFunction(dict)
          << "entry 'spacing': " << spacing << " m is more than twice the fluid's extent " << hi[d] - lo[d]
          << " m in direction " << label(d) << exit(FatalIOError);
    }
    all *= cells;
    l.n[d] = label(min(cells, scalar(1e9)));
    l.side[d] = (hi[d] - lo[d])/cells;
  }
  if (all > 1e9)
  {
    FatalIOErrorInFunction(dict)
        << "entry 'spacing': " << all << " fluid particles; at most 1e9 are placed from a mesh" << exit(FatalIOError);
  }
  return l;
}

/* Lattice points with their centre in a cell, and room beside it: where a wall cuts through the lattice, a particle just
 * in front of it would begin with far too many ghosts. The same list on every rank, whatever the decomposition. */
static std::vector<char> insideMesh(const polyMesh& mesh, const lattice& l)
{
  const scalar room = 0.3; // of a spacing, along the axes
  const vector offsets[] =
  {
    vector(0, 0, 0), vector(room, 0, 0), vector(-room, 0, 0), vector(0, room, 0), vector(0, -room, 0),
    vector(0, 0, room), vector(0, 0, -room)
  };
  std::vector<unsigned char> inside(std::size_t(l.size()), 0);
  const meshSearch search(mesh);
  const boundBox bounds(mesh.points(), false);
  for (label k = 0; k < l.size(); ++k)
  {
    for (int o = 0; o < 7; ++o)
    {
      const point x(l.at(k) + cmptMultiply(offsets[o], l.side));
      if (bounds.contains(x) && search.findCell(x) >= 0) inside[k] = static_cast<unsigned char>(inside[k] | 1 << o);
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, inside.data(), l.size(), MPI_UNSIGNED_CHAR, MPI_BOR, particleCommunicator());
  std::vector<char> whole(inside.size());
  for (std::size_t k = 0; k < inside.size(); ++k) whole[k] = inside[k] == 127;
  return whole;
}

/* dp = rho d(work) with the density of S.3: rho_0 work but for c, whose fluid would sink until it is that dense. */
static scalar restingPressure(const sph_params& p, scalar work)
{
  const scalar c2 = sqr(p.sound_speed), n = p.gamma - 1;
  const scalar density = n > 1e-6 ? std::pow(max(1 + n*work/c2, scalar(0.1)), 1/n) : std::exp(work/c2);
  return p.background_pressure + p.density*c2/p.gamma*(std::pow(density, p.gamma) - 1);
}

static void fillMesh
(
  sph_t* sph, const polyMesh& mesh, const IOdictionary& dict, const part_box& box, const sph_params& params
)
{
  const lattice l(makeLattice(dict, box, params));
  const std::vector<char> inside(insideMesh(mesh, l));
  DynamicList<label> filled;
  for (label k = 0; k < l.size(); ++k)
  {
    if (inside[k]) filled.append(k);
  }
  const scalar cell = l.side.x()*l.side.y()*l.side.z();
  const long long rank = Pstream::myProcNo(), ranks = Pstream::nProcs();
  const label first = label(filled.size()*rank/ranks), last = label(filled.size()*(rank + 1)/ranks);
  List<point> position(last - first);
  List<double> volume(last - first, cell), pressure(last - first);
  for (label k = first; k < last; ++k)
  {
    const point x(l.at(filled[k]));
    scalar work = 0; // of gravity from the surface, m2/s2
    for (direction d = 0; d < 3; ++d)
    {
      const scalar top = params.gravity[d] < 0 ? l.lo[d] + l.n[d]*l.side[d] : l.lo[d];
      if (!box.periodic[d]) work += params.gravity[d]*(x[d] - top);
    }
    const scalar p = restingPressure(params, work);
    position[k - first] = x;
    pressure[k - first] = p;
  }
  int64_t inserted = 0;
  checkStatus
  (
    sph_insert_points
    (
      sph, position.size(), reinterpret_cast<const double*>(position.cdata()), nullptr, volume.cdata(),
      pressure.cdata(), &inserted
    ),
    dict
  );
  scalar meshVolume = sum(mesh.cellVolumes());
  reduce(meshVolume, sumOp<scalar>());
  Info<< "Fluid: " << std::to_string(inserted).c_str() << " particles, " << l.side << " m apart, of "
      << cell*filled.size() << " m3 (mesh: " << meshVolume << " m3)" << endl;
}

sph_t* createFluid
(
  const polyMesh& mesh, const IOdictionary& dict, const part_box& box, const sph_params& params,
  const DynamicList<fluidWall>& walls, bool restarted, const fileName& file
)
{
  sph_t* sph = nullptr;
  checkStatus(sph_create(particleCommunicator(), &box, &params, &sph), dict);
  for (const fluidWall& w : walls)
  {
    const bool plane = w.params.type == SPH_PLANE;
    checkStatus
    (
      sph_add_wall
      (
        sph, w.name.c_str(), &w.params, plane ? 0 : w.triangles.size(),
        plane ? nullptr : reinterpret_cast<const double*>(w.triangles.cdata())
      ),
      dict
    );
    Info<< "Fluid wall " << w.name << ": " << (plane ? "plane" : "triangles")
        << (w.params.slip == SPH_FREE_SLIP ? ", freeSlip" : ", noSlip") << nl;
  }
  if (!restarted)
  {
    fillMesh(sph, mesh, dict, box, params);
  }
  else if (isFile(file))
  {
    Info<< "Reading the fluid from " << file << endl;
    checkStatus(sph_read(sph, file.c_str()), dict);
  }
  else
  {
    FatalIOErrorInFunction(dict)
        << "the run starts at time " << mesh.time().timeName() << " but there is no " << file << " to go on from"
        << exit(FatalIOError);
  }
  sph_set_time(sph, mesh.time().value());
  checkStatus(sph_start(sph), dict);
  return sph;
}

} // namespace Foam
