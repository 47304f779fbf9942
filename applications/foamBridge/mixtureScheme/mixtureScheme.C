/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mixtureScheme.H"

#include "convectionScheme.H"
#include "fvc.H"
#include "fvm.H"
#include "mixtureFields.H"
#include "surfaceInterpolationScheme.H"
#include "zeroGradientFvPatchFields.H"

namespace Foam
{

static surfaceScalarField faceScalar(const fvMesh& mesh, const word& name, const dimensionSet& dims)
{
  return surfaceScalarField
  (
    IOobject(name, mesh.time().timeName(), mesh),
    mesh,
    dimensionedScalar(dims, Zero)
  );
}

static surfaceVectorField faceVector(const fvMesh& mesh, const word& name, const dimensionSet& dims)
{
  return surfaceVectorField
  (
    IOobject(name, mesh.time().timeName(), mesh),
    mesh,
    dimensionedVector(dims, Zero)
  );
}

/* Resistances in series: between two cell centres, what happens in a cell counts with the part of
 * the path that lies in it, which is one minus the weight of linear interpolation. */
template<class Type>
tmp<GeometricField<Type, fvsPatchField, surfaceMesh>>
mixtureScheme::path(const GeometricField<Type, fvPatchField, volMesh>& field) const
{
  return surfaceInterpolationScheme<Type>::interpolate
  (
    field,
    tmp<surfaceScalarField>(new surfaceScalarField("pathWeights", 1 - mesh_.weights()))
  );
}

mixtureScheme::mixtureScheme
(
  const fvMesh& mesh,
  modelType model,
  const volScalarField& eps,
  const volVectorField& vp,
  const volVectorField& ap,
  const volScalarField& D,
  const volVectorField& G,
  const dimensionedVector& body
)
:
  mesh_(mesh),
  model_(model),
  eps_(eps),
  vp_(vp),
  ap_(ap),
  D_(D),
  G_(G),
  body_(body),
  rf_(faceScalar(mesh, "rEpsf", dimless)),
  pressureFactor_(faceScalar(mesh, "pressureFactor", dimless)),
  Kf_(faceScalar(mesh, "Kf", dimless/dimTime)),
  dragExplicit_(faceVector(mesh, "dragExplicit", dimAcceleration)),
  inertia_(faceVector(mesh, "solidInertia", dimAcceleration)),
  vpf_(faceVector(mesh, "vpf", dimVelocity)),
  m_(faceVector(mesh, "porosityNormal", dimless)),
  jump_(faceScalar(mesh, "BernoulliJump", dimLength)),
  snGradREps_(faceScalar(mesh, "snGradREps", dimless/dimLength)),
  armOwn_(faceVector(mesh, "armOwn", dimLength)),
  armNei_(faceVector(mesh, "armNei", dimLength)),
  along_(faceVector(mesh, "along", dimArea)),
  skew_(faceVector(mesh, "skew", dimArea)),
  orthogonal_(true),
  solids_(false),
  uniform_(true)
{
  makeArms();
  makeSkew();
}

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

void mixtureScheme::update()
{
  const scalar minEps = gMin(eps_);
  uniform_ = gMax(eps_) - minEps < SMALL;
  solids_ = minEps < 1 - SMALL;

  const volScalarField rEps("rEps", 1/eps_);
  const surfaceScalarField& magSf = mesh_.magSf();

  rf_ = path(rEps);
  snGradREps_ = fvc::snGrad(rEps);

  const volVectorField solids("solidsVelocity", (1 - eps_)*vp_);
  const surfaceScalarField solidsf("solidsf", fvc::interpolate(1 - eps_));
  vpf_ = fvc::interpolate(solids)/max(solidsf, dimensionedScalar("small", dimless, VSMALL));

  if (model_ == modelA)
  {
    pressureFactor_ = 1/rf_;
    Kf_ = path(volScalarField(D_*rEps))/rf_;
    dragExplicit_ = path(volVectorField((D_*solids + G_)*rEps))/rf_;
    inertia_ = path(volVectorField((1 - eps_)*ap_*rEps))/rf_;
    jump_ = difference(0.5*sqr(rEps))*magSf/rf_;
  }
  else
  {
    pressureFactor_ = dimensionedScalar("one", dimless, 1);
    Kf_ = path(D_);
    dragExplicit_ = path(volVectorField(D_*solids + G_));
    inertia_ = path(volVectorField((1 - eps_)*ap_));
    jump_ = difference(rEps)*magSf;
  }

  if (uniform_)
  {
    m_ = dimensionedVector(dimless, Zero);
    return;
  }
  makeNormal(rEps);
}

tmp<volVectorField> mixtureScheme::interstitial(const volVectorField& j) const
{
  return (j - (1 - eps_)*vp_)/eps_;
}

void mixtureScheme::mixtureBoundary(const volVectorField& U, volVectorField& j) const
{
  volVectorField::Boundary& jb = j.boundaryFieldRef();
  forAll(jb, patchi)
  {
    if (jb[patchi].fixesValue() && !jb[patchi].coupled())
    {
      jb[patchi] == mixtureBoundaryValue
      (
        U.boundaryField()[patchi], eps_.boundaryField()[patchi], vp_.boundaryField()[patchi]
      );
    }
  }
}

tmp<surfaceScalarField> mixtureScheme::solidFlux(const volScalarField& dEpsDt) const
{
  tmp<surfaceScalarField> tflux
  (
    new surfaceScalarField("phiSolid", fvc::interpolate((1 - eps_)*vp_) & mesh_.Sf())
  );
  volScalarField psi
  (
    IOobject("psi", mesh_.time().timeName(), mesh_), mesh_,
    dimensionedScalar(dimViscosity, Zero), extrapolatedPatchTypes(mesh_)
  );
  mesh_.setFluxRequired("psi");
  fvScalarMatrix psiEqn
  (
    fvm::laplacian(dimensionedScalar("one", dimless, 1), psi, "laplacian(p_rgh)")
 == dEpsDt - fvc::div(tflux())
  );
  psiEqn.setReference(0, 0);
  psiEqn.solve(mesh_.solver("p_rgh"));
  tflux.ref() += psiEqn.flux();
  return tflux;
}

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

tmp<surfaceScalarField> mixtureScheme::ownForce(const volVectorField& j) const
{
  const surfaceVectorField W(fvc::interpolate(j) - vpf_);
  return (inertia_ & along_) + pressureFactor_*(body_ & along_) - sqr(W & m_)*jump_;
}

// With -Kf phi this is drag along the line of cell centres only.
tmp<surfaceScalarField> mixtureScheme::dragForce(const volVectorField& j) const
{
  return (dragExplicit_ & along_) + Kf_*(skew_ & fvc::interpolate(j));
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

/* What the particles get, face by face. The fluid lacks, of the momentum f d of a face, the drag it
 * gave and (model A) the pressure on the solids, (1 - eps_f) P_f. Each cell's particles get the drag
 * of their own D and G at the face flux over their part of d; what remains is pressure on solids,
 * shared as (1 - eps)/eps. So the sum is exact for each face, and in a uniform flow each cell gets
 * the drag that its particles were told: nothing is left to correct in a steady state. */
void mixtureScheme::reaction
(
  const surfaceScalarField& phi,
  const surfaceScalarField& pressureForce,
  const volVectorField& damped,
  vectorField& drag,
  vectorField& volume
) const
{
  const surfaceScalarField lacking
  (
    (1 - pressureFactor_)*(pressureForce + (body_ & mesh_.Sf()))
  - ((dragExplicit_ & mesh_.Sf()) - Kf_*phi)
  );
  const volVectorField known(D_*(1 - eps_)*vp_ + G_);
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
  auto share = [](scalar mine, scalar other)
  {
    return mine + other > VSMALL ? mine/(mine + other) : scalar(0);
  };
  const surfaceScalarField& w = mesh_.weights();
  forAll(nei, facei)
  {
    const label P = own[facei], N = nei[facei];
    const vector &dP = armOwn_[facei], &dN = armNei_[facei];
    const vector dragP = (D_[P]*phi[facei] - (known[P] & Sf[facei]))*dP;
    const vector dragN = (D_[N]*phi[facei] - (known[N] & Sf[facei]))*dN;
    const vector rest = lacking[facei]*(dP + dN) - dragP - dragN;
    drag[P] += dragP;
    drag[N] += dragN;
    volume[P] += share((1 - w[facei])*ratio[P], w[facei]*ratio[N])*rest;
    volume[N] += share(w[facei]*ratio[N], (1 - w[facei])*ratio[P])*rest;
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
        const vector& dP = arm[i];
        const vector dragP = (D_[P]*phib[i] - (known[P] & Sb[i]))*dP;
        drag[P] += dragP;
        volume[P] += f[i]*dP - dragP;
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
      const vector &dP = arm[i], &dN = armN[i];
      const vector dragP = (D_[P]*phib[i] - (known[P] & Sb[i]))*dP;
      const vector dragN = (DN[i]*phib[i] - (knownN[i] & Sb[i]))*dN;
      drag[P] += dragP;
      volume[P] += share((1 - wb[i])*ratio[P], wb[i]*ratioN[i])*(f[i]*(dP + dN) - dragP - dragN);
    }
  }
}

} // namespace Foam
