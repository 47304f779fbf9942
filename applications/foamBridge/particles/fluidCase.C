/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fluidCase.H"

#include "OSspecific.H"
#include "Time.H"
#include "foamParams.H"
#include "meshSearch.H"
#include "particleCase.H"

#include <vector>

namespace Foam
{

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
  for (direction d = 0; d < 3; ++d) params.gravity[d] = properties.drive[d] - still[d];
  updateParams(dict, sph_params_table, &params, wordList({"coupling", "fill", "walls", "pressure"}));
  if (params.density_scheme == SPH_SUMMATION && dict.found("fill"))
  {
    FatalIOErrorInFunction(dict)
        << "entry 'densityScheme': summation is not for a free surface, which 'fill' makes; allowed: continuity"
        << exit(FatalIOError);
  }
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

/* Lattice points with their centre in a cell: 2 with room beside it, 1 without: where a wall cuts through the lattice, a
 * particle just in front of it would begin with far too many ghosts. The same list on every rank, whatever the decomposition. */
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
  for (std::size_t k = 0; k < inside.size(); ++k) whole[k] = inside[k] == 127 ? 2 : inside[k] & 1;
  return whole;
}

/* Half a spacing away from the walls, in three goes for a corner. False: there is no wall so near, or no such place. */
static bool moveFromWalls(const sph_t* sph, const sph_params& params, point& x)
{
  const scalar room = 0.5*params.spacing, small = 1e-4*params.spacing;
  scalar distance = sph_wall_distance(sph, x.cdata());
  if (!(distance < room)) return false;
  for (label go = 0; go < 3 && distance < 0.999*room; ++go)
  {
    vector normal(Zero);
    for (direction d = 0; d < direction(params.dimensions); ++d)
    {
      point beside(x);
      beside[d] += small;
      normal[d] = sph_wall_distance(sph, beside.cdata()) - distance;
    }
    x += (room - distance)*normal/max(mag(normal), VSMALL);
    distance = sph_wall_distance(sph, x.cdata());
  }
  return distance > 0.9*room;
}

/* What fills the mesh: without the points that have no room, the fluid would be some 0.3 spacings thinner at each wall
 * that cuts through the lattice, and slip there. */
static List<point> filledPoints(const sph_t* sph, const polyMesh& mesh, const lattice& l, const sph_params& params)
{
  const std::vector<char> inside(insideMesh(mesh, l));
  std::vector<label> near;
  for (label k = 0; k < l.size(); ++k)
  {
    if (inside[k] == 1) near.push_back(k);
  }
  std::vector<double> moved(4*near.size(), 0.0); // x y z, is there one?
  for (std::size_t j = Pstream::myProcNo(); j < near.size(); j += Pstream::nProcs())
  {
    point x(l.at(near[j]));
    if (!moveFromWalls(sph, params, x)) continue;
    for (direction d = 0; d < 3; ++d) moved[4*j + d] = x[d];
    moved[4*j + 3] = 1;
  }
  MPI_Allreduce(MPI_IN_PLACE, moved.data(), int(moved.size()), MPI_DOUBLE, MPI_SUM, particleCommunicator());
  DynamicList<point> points;
  std::size_t j = 0;
  for (label k = 0; k < l.size(); ++k)
  {
    if (inside[k] == 2) points.append(l.at(k));
    if (inside[k] != 1) continue;
    if (moved[4*j + 3] > 0) points.append(point(moved[4*j], moved[4*j + 1], moved[4*j + 2]));
    ++j;
  }
  return List<point>(points);
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
  const List<point> filled(filledPoints(sph, mesh, l, params));
  const scalar cell = l.side.x()*l.side.y()*l.side.z();
  const long long rank = Pstream::myProcNo(), ranks = Pstream::nProcs();
  const label first = label(filled.size()*rank/ranks), last = label(filled.size()*(rank + 1)/ranks);
  List<point> position(last - first);
  List<double> volume(last - first, cell), pressure(last - first);
  for (label k = first; k < last; ++k)
  {
    const point& x = filled[k];
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
