/* SPDX-License-Identifier: GPL-3.0-or-later */
/* M.14 */
#include "mixtureScheme.H"

namespace Foam
{

/* One side of a face: its cell's arm, drag (D, known) and solids over fluid, times the part of the path
 * between the cell centres that lies in the cell. */
struct faceSide
{
  vector arm;
  scalar D;
  vector known;
  scalar solids;

  vector drag(scalar phi, const vector& S) const { return (D*phi - (known & S))*arm; }
};

/* To the cell on this side of a face: the drag of its own particles, and its share of the rest. */
static void give
(
  const faceSide& mine, const faceSide& other, scalar phi, const vector& S, scalar lacking, vector& drag,
  vector& volume
)
{
  const vector own(mine.drag(phi, S));
  const vector rest(lacking*(mine.arm + other.arm) - own - other.drag(phi, S));
  const scalar solids = mine.solids + other.solids;
  drag += own;
  if (solids > VSMALL) volume += mine.solids/solids*rest;
}

/* What the particles get, face by face. The fluid lacks, of the momentum f d of a face, the drag it
 * gave and (model A) the pressure on the solids, (1 - eps_f) P_f. Each cell's particles get the drag
 * of their own D and G at the face flux over their part of d; what remains is pressure on solids,
 * shared as (1 - eps)/eps. So the sum is exact for each face, and in a uniform flow each cell gets
 * the drag that its particles were told: nothing is left to correct in a steady state. */
void mixtureScheme::reaction
(
  const surfaceScalarField& phiNow,
  const surfaceScalarField& pressureForce,
  const volVectorField& damped,
  vectorField& drag,
  vectorField& volume
) const
{
  const surfaceScalarField lacking
  (
    (1 - pressureFactor_)*(pressureForce + (body_ & mesh_.Sf()))
  - ((dragExplicit_ & mesh_.Sf()) + before_ - Kf_*phiNow)
  );
  volVectorField known(D_*(1 - eps_)*vp_ + G_);
  surfaceScalarField phi(phiNow);
  if (fluxBefore_.valid())
  {
    phi -= fluxBefore_();
    known -= D_*flowBefore_();
  }
  const volScalarField ratio((1 - eps_)/eps_);
  const vectorField& Sf = mesh_.faceAreas();
  const labelUList& own = mesh_.owner();
  const labelUList& nei = mesh_.neighbour();

  drag = damped.primitiveField()*mesh_.V();
  // Model A: the body acceleration drives the fluid with eps of the faces, harmonic, whose sum is not
  // that of the cells. So of the pressure it causes, the solids get their volume's share by cells.
  volume.setSize(drag.size());
  volume = Zero;
  if (model_ == modelA) volume -= (1 - eps_.primitiveField())*mesh_.V()*body_.value();
  const surfaceScalarField& w = mesh_.weights();
  forAll(nei, facei)
  {
    const label P = own[facei], N = nei[facei];
    const faceSide sideP = {armOwn_[facei], D_[P], known[P], (1 - w[facei])*ratio[P]};
    const faceSide sideN = {armNei_[facei], D_[N], known[N], w[facei]*ratio[N]};
    give(sideP, sideN, phi[facei], Sf[facei], lacking[facei], drag[P], volume[P]);
    give(sideN, sideP, phi[facei], Sf[facei], lacking[facei], drag[N], volume[N]);
  }
  forAll(lacking.boundaryField(), patchi)
  {
    const fvPatch& patch = mesh_.boundary()[patchi];
    const fvsPatchScalarField& f = lacking.boundaryField()[patchi];
    const fvsPatchScalarField& phib = phi.boundaryField()[patchi];
    const vectorField Sb(patch.Sf());
    const fvsPatchVectorField& arm = armOwn_.boundaryField()[patchi];
    const labelUList& cells = patch.faceCells();
    if (!patch.coupled())
    {
      forAll(f, i)
      {
        const label P = cells[i];
        const vector own(faceSide{arm[i], D_[P], known[P], 0}.drag(phib[i], Sb[i]));
        drag[P] += own;
        volume[P] += f[i]*arm[i] - own;
      }
      continue;
    }
    const scalarField DN(D_.boundaryField()[patchi].patchNeighbourField());
    const scalarField ratioN(ratio.boundaryField()[patchi].patchNeighbourField());
    const vectorField knownN(known.boundaryField()[patchi].patchNeighbourField());
    const fvsPatchVectorField& armN = armNei_.boundaryField()[patchi];
    const scalarField& wb = patch.weights();
    forAll(f, i)
    {
      const label P = cells[i];
      const faceSide sideP = {arm[i], D_[P], known[P], (1 - wb[i])*ratio[P]};
      const faceSide sideN = {armN[i], DN[i], knownN[i], wb[i]*ratioN[i]};
      give(sideP, sideN, phib[i], Sb[i], f[i], drag[P], volume[P]);
    }
  }
}

} // namespace Foam
