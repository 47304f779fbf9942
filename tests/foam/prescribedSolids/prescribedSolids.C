/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "prescribedSolids.H"

#include "Random.H"
#include "mathematicalConstants.H"

namespace Foam
{

static const scalar samples = 12; // per direction of a cell, for shapes that cut it obliquely

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
{}

scalar prescribedSolids::inside(const dictionary& region, const vector& x, scalar t) const
{
  const vector moved = x - t*region.getOrDefault<vector>("velocity", Zero);
  const word shape(region.get<word>("shape"));
  if (shape == "slab")
  {
    const scalar s = moved & region.get<vector>("normal");
    return s > region.get<scalar>("from") && s < region.get<scalar>("to");
  }
  const vector axis(region.get<vector>("axis"));
  vector r = moved - region.get<vector>("centre");
  r -= axis*(axis & r);
  return mag(r) < region.get<scalar>("radius");
}

/* Part of the cell inside. A slab along a coordinate axis cuts Cartesian cells exactly. */
scalar prescribedSolids::fraction(const dictionary& region, label cell, scalar t) const
{
  const boundBox box(mesh_.points(), mesh_.cellPoints()[cell], false);
  const vector normal(region.getOrDefault<vector>("normal", Zero));
  if (region.get<word>("shape") == "slab" && cmptMax(cmptMag(normal)) > 1 - SMALL)
  {
    const scalar shift = t*(region.getOrDefault<vector>("velocity", Zero) & normal);
    const scalar a = box.min() & normal, b = box.max() & normal;
    const scalar lo = max(min(a, b), region.get<scalar>("from") + shift);
    const scalar hi = min(max(a, b), region.get<scalar>("to") + shift);
    return max(hi - lo, scalar(0))/mag(b - a);
  }
  scalar sum = 0;
  const vector h = box.span()/samples;
  for (scalar i = 0; i < samples; ++i)
    for (scalar k = 0; k < samples; ++k)
      for (scalar l = 0; l < samples; ++l)
        sum += inside(region, box.min() + cmptMultiply(h, vector(i + 0.5, k + 0.5, l + 0.5)), t);
  return sum/pow3(samples);
}

scalar prescribedSolids::solids(const dictionary& region, label cell, scalar t) const
{
  if (region.get<word>("shape") != "layers")
  {
    return fraction(region, cell, t)*(1 - region.get<scalar>("eps"));
  }
  const scalar height = region.get<scalar>("layerHeight");
  const label layer =
    label(floor((mesh_.cellCentres()[cell] & region.get<vector>("normal"))/height));
  const scalarList cells(region.lookup("cells"));
  const label k = layer - region.get<label>("first");
  return k < 0 || k >= cells.size()
    ? 0
    : cells[k]*region.get<scalar>("sphereVolume")/mesh_.V()[cell];
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
      forAll(eps, cell) eps[cell] = low + (high - low)*random.sample01<scalar>();
      continue;
    }
    const vector velocity(region.getOrDefault<vector>("velocity", Zero));
    const scalar d = region.getOrDefault<scalar>("diameter", 0);
    const scalar drag = region.getOrDefault<scalar>("drag", 0);
    forAll(eps, cell)
    {
      const scalar s = solids(region, cell, t);
      if (s <= 0) continue;
      eps[cell] -= s;
      vp[cell] = velocity;
      scalar coefficient = drag;
      if (region.get<word>("shape") != "layers") coefficient *= s/(1 - region.get<scalar>("eps"));
      if (d > 0)
      {
        const scalar w = max(mag(j[cell] - velocity), 1e-12);
        const scalar re = w*d/nu;
        const scalar xi = 3.7 - 0.65*exp(-0.5*sqr(1.5 - log10(re)));
        const scalar force = constant::mathematical::pi/8*sqr(0.63 + 4.8/sqrt(re))*sqr(d*w)
                           *pow(eps[cell], -xi);
        coefficient = s/(constant::mathematical::pi/6*pow3(d))*force/w;
      }
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
