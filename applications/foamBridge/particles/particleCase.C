/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "particleCase.H"

#include "OSspecific.H"
#include "Time.H"
#include "foamMesh.H"
#include "foamParams.H"
#include "wordRes.H"

namespace Foam
{

mpiSession::mpiSession() : ours_(false)
{
  int initialized = 0;
  MPI_Initialized(&initialized);
  ours_ = !initialized;
  if (ours_) MPI_Init(nullptr, nullptr);
}

mpiSession::~mpiSession()
{
  if (ours_) MPI_Finalize();
}

MPI_Comm particleCommunicator() { return MPI_COMM_WORLD; }

static const dictionary& section(const dictionary& dict, const word& name)
{
  if (!dict.isDict(name))
  {
    FatalIOErrorInFunction(dict)
        << "sub-dictionary '" << name << "' is missing" << exit(FatalIOError);
  }
  return dict.subDict(name);
}

static int material(dem_t* dem, const dictionary& dict, const std::string& name)
{
  int number = -1;
  if (dem_find_material(dem, name.c_str(), &number) != PART_OK)
  {
    FatalIOErrorInFunction(dict)
        << part_last_error() << nl << "Materials: "
        << flatOutput(section(dict.topDict(), "materials").toc()) << exit(FatalIOError);
  }
  return number;
}

static int material(dem_t* dem, const dictionary& dict)
{
  return material(dem, dict, dict.get<word>("material"));
}

static void addMaterials(dem_t* dem, const dictionary& properties)
{
  for (const entry& e : section(properties, "materials"))
  {
    dem_material m;
    readParams(e.dict(), dem_material_table, &m, wordList({"name"}));
    if (e.keyword().size() >= sizeof m.name || e.keyword().find('-') != std::string::npos)
    {
      FatalIOErrorInFunction(e.dict())
          << "a material's name is one word without '-' of at most " << label(sizeof m.name - 1)
          << " letters, not '" << e.keyword() << "'" << exit(FatalIOError);
    }
    strcpy(m.name, e.keyword().c_str());
    int number;
    checkStatus(dem_add_material(dem, &m, &number), e.dict());
  }
}

/* Materials that a key of contacts or bonds names: default (-1, -1), or two with a '-' between. */
static void materialPair(dem_t* dem, const entry& e, int& a, int& b)
{
  a = b = -1;
  const std::string& key = e.keyword();
  if (key == "default") return;
  const std::string::size_type dash = key.find('-');
  a = material(dem, e.dict(), key.substr(0, dash));
  b = material(dem, e.dict(), dash == std::string::npos ? "" : key.substr(dash + 1));
}

static void addContacts(dem_t* dem, const dictionary& properties)
{
  for (const entry& e : section(properties, "contacts"))
  {
    dem_contact contact;
    readParams(e.dict(), dem_contact_table, &contact);
    int a, b;
    materialPair(dem, e, a, b);
    checkStatus(dem_set_contact(dem, a, b, &contact), e.dict());
  }
}

static void addLubrication(dem_t* dem, const dictionary& properties)
{
  if (!properties.found("lubrication")) return;
  const dictionary& dict = section(properties, "lubrication");
  dem_lubrication lubrication;
  readParams(dict, dem_lubrication_table, &lubrication);
  checkStatus(dem_set_lubrication(dem, &lubrication), dict);
}

/* Near pairs of these materials are bonded by dem_start; after a restart the bonds are in the file. */
static void addBonds(dem_t* dem, const dictionary& properties)
{
  if (!properties.found("bonds")) return;
  for (const entry& e : section(properties, "bonds"))
  {
    dem_bond bond;
    readParams(e.dict(), dem_bond_table, &bond);
    int a, b;
    materialPair(dem, e, a, b);
    checkStatus(dem_add_bonds(dem, a, b, &bond), e.dict());
  }
}

/* A file named in a dictionary: relative to the case, wherever the solver was started. */
template<unsigned N>
static void locateFile(const Time& time, const dictionary& dict, char (&path)[N])
{
  fileName file(path);
  file.expand();
  if (file.empty()) return;
  if (!file.isAbsolute() && cwd() != time.globalPath()) file = time.globalPath()/file;
  if (file.size() >= N)
  {
    FatalIOErrorInFunction(dict)
        << "entry 'file': the path " << file << " has more than " << label(N - 1) << " characters"
        << exit(FatalIOError);
  }
  strcpy(path, file.c_str());
}

/* Patches of the mesh, each a wall of its own: <name>:<patch>. */
static void addPatches
(
  dem_t* dem, const polyMesh& mesh, const word& name, const dictionary& dict,
  const dem_wall_params& params
)
{
  const wordRes wanted(dict.get<wordRes>("patches"));
  const labelHashSet patches = mesh.boundaryMesh().patchSet(wanted); // warns of a name without match
  if (patches.empty())
  {
    FatalIOErrorInFunction(dict)
        << "wall '" << name << "': no patch matches " << wanted << "; patches of the mesh: "
        << flatOutput(mesh.boundaryMesh().names()) << exit(FatalIOError);
  }
  for (const label patchi : patches.sortedToc())
  {
    const List<FixedList<point, 3>> triangles(foamMesh::triangles(mesh, patchi));
    const word wall(name + ':' + mesh.boundaryMesh()[patchi].name());
    checkStatus
    (
      dem_add_wall
      (
        dem, wall.c_str(), &params, triangles.size(), reinterpret_cast<const double*>(triangles.cdata())
      ),
      dict
    );
  }
}

/* By the table of libdem; its type triangles is patches here. */
static void addWall(dem_t* dem, const polyMesh& mesh, const word& name, const dictionary& dict)
{
  const word type(dict.get<word>("type"));
  const bool isPatches = type == "patches";
  if (!wordList({"plane", "cylinder", "stl", "patches"}).found(type))
  {
    FatalIOErrorInFunction(dict)
        << "wall '" << name << "' has type '" << type << "'; valid: plane, cylinder, stl, patches"
        << exit(FatalIOError);
  }
  dictionary settings(dict);
  if (isPatches)
  {
    settings.set("type", word("triangles"));
    settings.remove("patches");
  }
  dem_wall_params params;
  readParams(settings, dem_wall_table, &params);
  material(dem, dict);
  locateFile(mesh.time(), dict, params.file);
  if (isPatches)
  {
    addPatches(dem, mesh, name, dict, params);
  }
  else
  {
    checkStatus(dem_add_wall(dem, name.c_str(), &params, 0, nullptr), dict);
  }
}

static void addWalls(dem_t* dem, const polyMesh& mesh, const dictionary& properties)
{
  if (!properties.found("walls")) return;
  for (const entry& e : section(properties, "walls")) addWall(dem, mesh, e.keyword(), e.dict());
}

static void insertAll(dem_t* dem, const Time& time, const dictionary& properties)
{
  int block = 0;
  for (const entry& e : section(properties, "insertion"))
  {
    dem_insert insert;
    readParams(e.dict(), dem_insert_table, &insert);
    material(dem, e.dict());
    locateFile(time, e.dict(), insert.file);
    locateFile(time, e.dict(), insert.shape);
    const bool isBlock = insert.kind == DEM_BLOCK;
    int64_t inserted = 0;
    checkStatus(dem_insert_particles(dem, &insert, isBlock ? block : -1, &inserted), e.dict());
    if (isBlock) ++block;
    Info<< "Inserted " << label(inserted) << " particles: " << e.keyword() << endl;
  }
}

/* Newest time before this one that has a particle file, for a message; empty if there is none. */
static word lastWritten(const Time& time)
{
  word last;
  scalar newest = -GREAT;
  for (const fileName& name : readDir(time.globalPath()/"particles", fileName::FILE))
  {
    scalar value = 0;
    const word stem(name.lessExt());
    if (name.ext() != "vtkhdf" || !readScalar(stem.c_str(), value)) continue;
    if (value <= newest || value >= time.value()) continue;
    last = stem;
    newest = value;
  }
  return last;
}

dem_t* createParticles
(
  const polyMesh& mesh, const dictionary& properties, const part_box& box, const vector& gravity,
  int carried, double added, dem_params& params, bool& restarted
)
{
  part_params_default(&dem_params_table, &params);
  if (properties.found("gravity"))
  {
    FatalIOErrorInFunction(properties)
        << "entry 'gravity' belongs in constant/g, which fluid and particles share"
        << exit(FatalIOError);
  }
  for (direction d = 0; d < 3; ++d) params.gravity[d] = gravity[d];
  updateParams
  (
    properties, dem_params_table, &params,
    wordList({"materials", "contacts", "bonds", "lubrication", "walls", "insertion", "insertTime"})
  );
  dem_t* dem = nullptr;
  checkStatus(dem_create(particleCommunicator(), &box, &params, &dem), properties);
  checkStatus(dem_carry(dem, carried), properties);
  addMaterials(dem, properties);
  checkStatus(dem_add_mass(dem, added), properties);
  addContacts(dem, properties);
  addBonds(dem, properties);
  addLubrication(dem, properties);
  addWalls(dem, mesh, properties);

  const Time& time = mesh.time();
  const fileName file(time.globalPath()/"particles"/time.timeName() + ".vtkhdf");
  const scalar insertTime = properties.getOrDefault<scalar>("insertTime", 0);
  const bool start = mag(time.value() - insertTime) < SMALL + 1e-6*time.deltaTValue();
  restarted = !start;
  if (start)
  {
    insertAll(dem, time, properties);
  }
  else if (isFile(file))
  {
    Info<< "Reading particles from " << file << endl;
    checkStatus(dem_read(dem, file.c_str()), properties);
  }
  else
  {
    FatalIOErrorInFunction(properties)
        << "the run starts at time " << time.timeName() << " but there is no " << file
        << " to go on from, and particles are inserted at insertTime = " << insertTime;
    const word last(lastWritten(time));
    if (!last.empty()) FatalIOError << nl << "The last time before it with particles is " << last;
    FatalIOError << exit(FatalIOError);
  }
  dem_set_time(dem, time.value());
  checkStatus(dem_start(dem), properties);
  return dem;
}

} // namespace Foam
