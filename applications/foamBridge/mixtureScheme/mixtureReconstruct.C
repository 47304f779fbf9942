/* SPDX-License-Identifier: GPL-3.0-or-later */
/* M.10: cell vectors from face fluxes. */
#include "mixtureScheme.H"

#include "mixtureFields.H"
#include "zeroGradientFvPatchFields.H"

namespace Foam
{

/* On planar faces (1/V) sum (x_f - x_P) S is the unit tensor; on warped ones it is not, and the arms
 * are corrected by its inverse, so that reconstruct() is exact for uniform vectors on any mesh. */
void mixtureScheme::makeArms()
{
  const labelUList& own = mesh_.owner();
  const labelUList& nei = mesh_.neighbour();
  const surfaceVectorField& Cf = mesh_.Cf();
  const surfaceVectorField& Sf = mesh_.Sf();
  const volVectorField& C = mesh_.C();
  volTensorField correction
  (
    IOobject("armCorrection", mesh_.time().timeName(), mesh_), mesh_,
    dimensionedTensor(dimless, Zero), extrapolatedPatchTypes(mesh_)
  );
  tensorField& M = correction.primitiveFieldRef();
  forAll(nei, facei)
  {
    M[own[facei]] += (Cf[facei] - C[own[facei]])*Sf[facei];
    M[nei[facei]] -= (Cf[facei] - C[nei[facei]])*Sf[facei];
  }
  forAll(mesh_.boundary(), patchi)
  {
    const fvPatch& patch = mesh_.boundary()[patchi];
    const labelUList& cells = patch.faceCells();
    forAll(patch, i) M[cells[i]] += (patch.Cf()[i] - C[cells[i]])*Sf.boundaryField()[patchi][i];
  }
  const Vector<label>& dirs = mesh_.geometricD();
  forAll(M, celli)
  {
    M[celli] /= mesh_.V()[celli];
    for (direction d = 0; d < 3; ++d)
    {
      if (dirs[d] < 0) M[celli].component(4*d) = 1; // an empty direction has no faces
    }
    M[celli] = mag(M[celli] - tensor::I) < 1e-10 ? tensor(tensor::I) : inv(M[celli]);
  }
  correction.correctBoundaryConditions();

  forAll(nei, facei)
  {
    armOwn_[facei] = M[own[facei]] & (Cf[facei] - C[own[facei]]);
    armNei_[facei] = M[nei[facei]] & (C[nei[facei]] - Cf[facei]);
  }
  forAll(mesh_.boundary(), patchi)
  {
    const fvPatch& patch = mesh_.boundary()[patchi];
    const labelUList& cells = patch.faceCells();
    fvsPatchVectorField& inner = armOwn_.boundaryFieldRef()[patchi];
    forAll(inner, i) inner[i] = patch.Cf()[i] - C[cells[i]];
    if (patch.coupled())
    {
      armNei_.boundaryFieldRef()[patchi] ==
        (correction.boundaryField()[patchi].patchNeighbourField() & (patch.delta() - inner));
    }
    forAll(inner, i) inner[i] = M[cells[i]] & inner[i];
  }
}

tmp<volVectorField> mixtureScheme::reconstruct(const surfaceScalarField& flux) const
{
  tmp<volVectorField> tR
  (
    new volVectorField
    (
      IOobject("reconstructed", mesh_.time().timeName(), mesh_),
      mesh_,
      dimensionedVector(flux.dimensions()/dimArea, Zero),
      zeroGradientFvPatchVectorField::typeName
    )
  );
  vectorField& R = tR.ref().primitiveFieldRef();
  const labelUList& own = mesh_.owner();
  const labelUList& nei = mesh_.neighbour();
  forAll(nei, facei)
  {
    R[own[facei]] += flux[facei]*armOwn_[facei];
    R[nei[facei]] += flux[facei]*armNei_[facei];
  }
  forAll(flux.boundaryField(), patchi)
  {
    const labelUList& cells = mesh_.boundary()[patchi].faceCells();
    const fvsPatchScalarField& f = flux.boundaryField()[patchi];
    const fvsPatchVectorField& arm = armOwn_.boundaryField()[patchi];
    forAll(f, i) R[cells[i]] += f[i]*arm[i]; // empty patches have no faces here
  }
  R /= mesh_.V();
  tR.ref().correctBoundaryConditions();
  return tR;
}

} // namespace Foam
