/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "prescribedSolids.H"

#include "Random.H"
#include "mathematicalConstants.H"
#include "solidShapes.H"

namespace Foam
{

static scalarField givenField(const fvMesh& mesh, const word& name)
{
  return volScalarField
  (
    IOobject(name, mesh.time().timeName(), mesh, IOobject::MUST_READ, IOobject::NO_WRITE), mesh
  ).primitiveField();
}

prescribedSolids::prescribedSolids(const fvMesh& mesh)
:
  mesh_(mesh),
  regions_
  (
    IOdictionary
    (
      IOobject
      (
        "prescribedSolids", mesh.time().constant(), mesh, IOobject::MUST_READ, IOobject::NO_WRITE
      )
    ).lookup("regions")
  )
{
  for (const dictionary& region : regions_)
  {
    const word shape(region.get<word>("shape"));
    if (shape == "given")
    {
      epsGiven_ = givenField(mesh, "epsGiven");
      dragGiven_ = givenField(mesh, "dragGiven");
    }
    else if (shape != "slab" && shape != "disc" && shape != "random" && shape != "layers")
    {
      FatalIOErrorInFunction(region)
        << "unknown shape " << shape << ": slab, disc, random, layers or given"
        << exit(FatalIOError);
    }
  }
}

/* Part of the cell inside the slab or disc at time t. */
scalar prescribedSolids::part(const dictionary& region, label cell, scalar t) const
{
  const vector velocity(region.getOrDefault<vector>("velocity", Zero));
  if (region.get<word>("shape") == "disc")
  {
    return partInCylinder
    (
      mesh_, cell, region.get<vector>("centre") + t*velocity, region.get<vector>("axis"),
      region.get<scalar>("radius")
    );
  }
  const vector normal(region.get<vector>("normal"));
  const scalar from = region.get<scalar>("from"), to = region.get<scalar>("to");
  const scalar shift = t*(velocity & normal);
  auto one = [&](scalar moved)
  {
    return partBelow(mesh_, cell, normal, to + moved) - partBelow(mesh_, cell, normal, from + moved);
  };
  if (!region.found("period")) return one(shift);
  const scalar period = region.get<scalar>("period");
  const boundBox box(mesh_.points(), mesh_.cellPoints()[cell], false);
  const scalarField s(box.points()() & normal);
  scalar sum = 0;
  const label first = label(floor((min(s) - to - shift)/period));
  const label last = label(ceil((max(s) - from - shift)/period));
  for (label k = first; k <= last; ++k) sum += one(shift + k*period);
  return sum;
}

scalar prescribedSolids::solids(const dictionary& region, label cell, scalar t) const
{
  const word shape(region.get<word>("shape"));
  if (shape == "given") return 1 - epsGiven_[cell];
  if (shape != "layers") return part(region, cell, t)*(1 - region.get<scalar>("eps"));
  const scalar height = region.get<scalar>("layerHeight");
  const label layer =
    label(floor((mesh_.cellCentres()[cell] & region.get<vector>("normal"))/height));
  const scalarList cells(region.lookup("cells"));
  const label k = layer - region.get<label>("first");
  return k < 0 || k >= cells.size()
    ? 0
    : cells[k]*region.get<scalar>("sphereVolume")/mesh_.V()[cell];
}

scalar prescribedSolids::dragCoefficient
(
  const dictionary& region, label cell, scalar s, scalar eps, scalar slip, scalar nu
) const
{
  if (region.get<word>("shape") == "given") return dragGiven_[cell];
  const scalar d = region.getOrDefault<scalar>("diameter", 0);
  if (d > 0) // Di Felice (1994): force of one sphere per fluid density, times their number
  {
    const scalar w = max(slip, 1e-12);
    const scalar re = w*d/nu;
    const scalar xi = 3.7 - 0.65*exp(-0.5*sqr(1.5 - log10(re)));
    const scalar force =
      constant::mathematical::pi/8*sqr(0.63 + 4.8/sqrt(re))*sqr(d*w)*pow(eps, -xi);
    return s/(constant::mathematical::pi/6*pow3(d))*force/w;
  }
  const scalar inside = s/(1 - region.get<scalar>("eps"));
  return inside
    *(region.getOrDefault<scalar>("drag", 0) + eps*region.getOrDefault<scalar>("resistance", 0));
}

void prescribedSolids::update
(
  scalar t, scalar nu, const volVectorField& j, volScalarField& eps, volVectorField& vp,
  volScalarField& D, volVectorField& G
) const
{
  eps.primitiveFieldRef() = 1;
  vp.primitiveFieldRef() = Zero;
  D.primitiveFieldRef() = 0;
  G.primitiveFieldRef() = Zero;
  for (const dictionary& region : regions_)
  {
    if (region.get<word>("shape") == "random")
    {
      Random random(region.get<label>("seed") + Pstream::myProcNo());
      const scalar low = region.get<scalar>("low"), high = region.get<scalar>("high");
      const scalar drag = region.getOrDefault<scalar>("drag", 0);
      forAll(eps, cell)
      {
        eps[cell] = low + (high - low)*random.sample01<scalar>();
        D[cell] = drag*random.sample01<scalar>();
      }
      continue;
    }
    const vector velocity(region.getOrDefault<vector>("velocity", Zero));
    forAll(eps, cell)
    {
      const scalar s = solids(region, cell, t);
      if (s <= 0) continue;
      eps[cell] -= s;
      vp[cell] = velocity;
      const scalar coefficient =
        dragCoefficient(region, cell, s, eps[cell], mag(j[cell] - velocity), nu);
      D[cell] += coefficient;
      G[cell] += coefficient*eps[cell]*velocity;
    }
  }
  eps.correctBoundaryConditions();
  vp.correctBoundaryConditions();
  D.correctBoundaryConditions();
  G.correctBoundaryConditions();
}

} // namespace Foam
