/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mixtureScheme.H"

#include "fvc.H"

namespace Foam
{

/* The Bernoulli force gives the fluid bern_f d_f of momentum per face, convection through the jump of
 * 1/eps takes phi_W (W.m) m Delta(1/eps). Both are the same for a flow along a porosity step that
 * lies on the mesh; where they differ, each cell of the face gets half, and together with M.6 the
 * convected momentum then telescopes: W_f Delta(1/eps) + r_f Delta W = Delta(W/eps) exactly, as r_f
 * and linear interpolation weigh the two cells the other way round. */
tmp<volVectorField> mixtureScheme::momentumClosure
(
  const surfaceScalarField& phi,
  const volVectorField& j
) const
{
  tmp<volVectorField> tclosure
  (
    new volVectorField
    (
      IOobject("momentumClosure", mesh_.time().timeName(), mesh_),
      mesh_,
      dimensionedVector(dimAcceleration, Zero)
    )
  );
  if (uniform_) return tclosure;

  const surfaceVectorField W(fvc::interpolate(j) - vpf_);
  const surfaceScalarField Wm(W & m_);
  const surfaceScalarField phiW(phi - (vpf_ & mesh_.Sf()));
  const surfaceScalarField bern(sqr(Wm)*jump_);
  const surfaceScalarField dr(difference(1/eps_)/mesh_.nonOrthDeltaCoeffs());

  vectorField& closure = tclosure.ref().primitiveFieldRef();
  const vectorField& C = mesh_.cellCentres();
  const labelUList& own = mesh_.owner();
  const labelUList& nei = mesh_.neighbour();
  forAll(nei, facei)
  {
    const label P = own[facei], N = nei[facei];
    const vector half =
      0.5*(phiW[facei]*Wm[facei]*dr[facei]*m_[facei] - bern[facei]*(C[N] - C[P]));
    closure[P] += half;
    closure[N] += half;
  }
  forAll(phi.boundaryField(), patchi)
  {
    const fvPatch& patch = mesh_.boundary()[patchi];
    if (!patch.coupled()) continue; // eps does not jump there
    const labelUList& cells = patch.faceCells();
    const vectorField d(patch.delta());
    forAll(cells, i)
    {
      closure[cells[i]] += 0.5
       *(
          phiW.boundaryField()[patchi][i]*Wm.boundaryField()[patchi][i]
         *dr.boundaryField()[patchi][i]*m_.boundaryField()[patchi][i]
        - bern.boundaryField()[patchi][i]*d[i]
        );
    }
  }
  closure /= mesh_.V();
  return tclosure;
}

} // namespace Foam
