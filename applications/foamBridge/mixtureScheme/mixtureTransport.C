/* SPDX-License-Identifier: GPL-3.0-or-later */
/* M.4, M.6, M.7: convection and viscous stress across porosity steps. */
#include "mixtureScheme.H"

#include "convectionScheme.H"
#include "fvc.H"
#include "fvm.H"

namespace Foam
{

tmp<surfaceScalarField> mixtureScheme::convectionFlux(const surfaceScalarField& phi) const
{
  const surfaceScalarField phiP(vpf_ & mesh_.Sf());
  return tmp<surfaceScalarField>(new surfaceScalarField("phiC", rf_*(phi - phiP) + phiP));
}

tmp<volVectorField> mixtureScheme::tangential
(
  const surfaceScalarField& phi,
  const surfaceScalarField& phiC,
  const volVectorField& j,
  const volVectorField& u,
  const word& scheme
) const
{
  tmp<volVectorField> tT
  (
    new volVectorField
    (
      IOobject("tangential", mesh_.time().timeName(), mesh_),
      mesh_,
      dimensionedVector(dimAcceleration, Zero)
    )
  );
  if (uniform_) return tT;

  tmp<fv::convectionScheme<vector>> tscheme
  (
    fv::convectionScheme<vector>::New(mesh_, phiC, mesh_.divScheme(scheme))
  );
  const surfaceVectorField uf(tscheme().interpolate(phiC, u));
  const surfaceVectorField jf(tscheme().interpolate(phiC, j));
  const surfaceScalarField phiW(phi - (vpf_ & mesh_.Sf()));

  vectorField& T = tT.ref().primitiveFieldRef();
  const labelUList& own = mesh_.owner();
  const labelUList& nei = mesh_.neighbour();
  auto part = [](const vector& m, scalar flux, scalar r, const vector& du, const vector& dj)
  {
    const vector q = du - r*dj;
    return vector(flux*(q - m*(m & q)));
  };
  forAll(nei, facei)
  {
    const vector& m = m_[facei];
    const label P = own[facei], N = nei[facei];
    T[P] += part(m, phiW[facei], rf_[facei], uf[facei] - u[P], jf[facei] - j[P]);
    T[N] -= part(m, phiW[facei], rf_[facei], uf[facei] - u[N], jf[facei] - j[N]);
  }
  forAll(uf.boundaryField(), patchi)
  {
    const labelUList& cells = mesh_.boundary()[patchi].faceCells();
    forAll(cells, i)
    {
      const label P = cells[i];
      T[P] += part
      (
        m_.boundaryField()[patchi][i], phiW.boundaryField()[patchi][i],
        rf_.boundaryField()[patchi][i],
        uf.boundaryField()[patchi][i] - u[P], jf.boundaryField()[patchi][i] - j[P]
      );
    }
  }
  T /= mesh_.V();
  return tT;
}

/* laplacian(eps_f nu, u) with u = j/eps + known: the matrix of u, its columns divided by eps. What
 * is known enters as the difference of the two forms at the present j. */
tmp<fvVectorMatrix> mixtureScheme::viscous
(
  const volScalarField& nu,
  const volVectorField& j,
  volVectorField& u
) const
{
  const surfaceScalarField epsNu("epsNu", fvc::interpolate(nu)/rf_);
  fvVectorMatrix uMatrix(fvm::laplacian(epsNu, u, "laplacian(nuEff,U)"));

  const scalarField rEps(1/eps_.primitiveField());
  tmp<fvVectorMatrix> tM(new fvVectorMatrix(j, uMatrix.dimensions()));
  fvVectorMatrix& M = tM.ref();
  const labelUList& own = mesh_.owner();
  const labelUList& nei = mesh_.neighbour();
  const scalarField& upper = uMatrix.upper();
  const scalarField& lower = uMatrix.lower();
  scalarField& newUpper = M.upper();
  scalarField& newLower = M.lower();
  forAll(nei, facei)
  {
    newUpper[facei] = upper[facei]*rEps[nei[facei]];
    newLower[facei] = lower[facei]*rEps[own[facei]];
  }
  M.diag() = uMatrix.diag()*rEps;
  M.source() = uMatrix.source();
  forAll(u.boundaryField(), patchi)
  {
    const fvPatch& patch = mesh_.boundary()[patchi];
    const scalarField inner(rEps, patch.faceCells());
    M.internalCoeffs()[patchi] = uMatrix.internalCoeffs()[patchi]*inner;
    M.boundaryCoeffs()[patchi] = uMatrix.boundaryCoeffs()[patchi];
    if (u.boundaryField()[patchi].coupled())
    {
      M.boundaryCoeffs()[patchi] /= eps_.boundaryField()[patchi].patchNeighbourField();
    }
  }
  if (!uniform_)
  {
    // The jump of the normal velocity is not shear (M.7)
    const surfaceVectorField W(fvc::interpolate(j) - vpf_);
    M -= fvc::div(epsNu*m_*(m_ & W)*snGradREps_*mesh_.magSf());
  }
  if (solids_ && gMax(magSqr(vp_.primitiveField())()) > 0)
  {
    const volVectorField full("full", uMatrix & u);
    const volVectorField scaled("scaled", M & j);
    M += full - scaled;
  }
  return tM;
}

/* The transposed part of the stress, explicit: it is not zero where the viscosity varies. */
tmp<volVectorField> mixtureScheme::transposeStress(const volScalarField& nu, const volVectorField& u)
  const
{
  return fvc::div
  (
    (fvc::interpolate(nu)/rf_)*(mesh_.Sf() & fvc::interpolate(dev2(T(fvc::grad(u, "grad(U)")))))
  );
}

} // namespace Foam
