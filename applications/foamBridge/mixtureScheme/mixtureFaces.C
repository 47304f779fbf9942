/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mixtureScheme.H"

#include "fvc.H"
#include "gaussLaplacianScheme.H"
#include "linear.H"
#include "mixtureFields.H"
#include "uncorrectedSnGrad.H"

namespace Foam
{

/* Faces whose normal does not lie along d, the line between the cell centres. S = along + skew, along
 * parallel to d (over-relaxed). Two-point differences give what a force does along d exactly, also
 * where pressure and drag have a kink. The rest comes from cells, and neither a cell's grad p nor its
 * drag is known at a kink, only their sum: so across() takes all of a face's force together, and where
 * it is in balance along every d nothing is left to correct. */
void mixtureScheme::makeSkew()
{
  const surfaceVectorField& Sf = mesh_.Sf();
  skew_ = mesh_.magSf()*mesh_.nonOrthCorrectionVectors();
  along_ = Sf - skew_;
  scalar largest = max((mag(skew_)/mesh_.magSf())().primitiveField());
  forAll(skew_.boundaryField(), patchi) // as many as this rank has: reduce after them, not inside
  {
    const fvsPatchVectorField& k = skew_.boundaryField()[patchi];
    if (k.size()) largest = max(largest, max(mag(k)/mesh_.magSf().boundaryField()[patchi]));
  }
  orthogonal_ = returnReduce(largest, maxOp<scalar>()) < 1e-10;
  if (orthogonal_) return;

  symmTensorField A(mesh_.nCells(), symmTensor::zero);
  const labelUList& own = mesh_.owner();
  const labelUList& nei = mesh_.neighbour();
  forAll(nei, facei)
  {
    const symmTensor a(sqr(along_[facei])/mag(along_[facei]));
    A[own[facei]] += a;
    A[nei[facei]] += a;
  }
  forAll(mesh_.boundary(), patchi)
  {
    const labelUList& cells = mesh_.boundary()[patchi].faceCells();
    const fvsPatchVectorField& a = along_.boundaryField()[patchi];
    forAll(a, i) A[cells[i]] += sqr(a[i])/mag(a[i]);
  }
  const Vector<label>& dirs = mesh_.geometricD();
  leastSquares_.setSize(A.size());
  forAll(A, celli)
  {
    for (direction d = 0; d < 3; ++d)
    {
      vector e(Zero);
      e[d] = 1;
      if (dirs[d] < 0) A[celli] += sqr(e)*tr(A[celli]); // an empty direction has no faces
    }
    leastSquares_[celli] = inv(A[celli]);
  }
}

tmp<surfaceScalarField> mixtureScheme::across(const surfaceScalarField& force) const
{
  tmp<surfaceScalarField> tacross(new surfaceScalarField("acrossForce", 0*force));
  if (orthogonal_) return tacross;

  volVectorField N
  (
    IOobject("cellForce", mesh_.time().timeName(), mesh_), mesh_,
    dimensionedVector(dimAcceleration, Zero), extrapolatedPatchTypes(mesh_)
  );
  vectorField& sum = N.primitiveFieldRef();
  const labelUList& own = mesh_.owner();
  const labelUList& nei = mesh_.neighbour();
  forAll(nei, facei)
  {
    const vector f = along_[facei]*(force[facei]/mag(along_[facei]));
    sum[own[facei]] += f;
    sum[nei[facei]] += f;
  }
  forAll(mesh_.boundary(), patchi)
  {
    const labelUList& cells = mesh_.boundary()[patchi].faceCells();
    const fvsPatchVectorField& a = along_.boundaryField()[patchi];
    const fvsPatchScalarField& f = force.boundaryField()[patchi];
    forAll(a, i) sum[cells[i]] += a[i]*(f[i]/mag(a[i]));
  }
  forAll(sum, celli) sum[celli] = leastSquares_[celli] & sum[celli];
  N.correctBoundaryConditions();
  tacross.ref() += skew_ & fvc::interpolate(N);
  return tacross;
}

tmp<surfaceScalarField> mixtureScheme::difference(const volScalarField& field) const
{
  return fv::uncorrectedSnGrad<scalar>(mesh_).snGrad(field);
}

tmp<surfaceScalarField> mixtureScheme::pressureForce(const volScalarField& p) const
{
  return -difference(p)*mesh_.magSf();
}

tmp<surfaceScalarField> mixtureScheme::ownForce(const volVectorField& j) const
{
  const surfaceVectorField W(fvc::interpolate(j) - vpf_);
  return driven_ - sqr(W & m_)*jump_;
}

// With -Kf phi this is drag along the line of cell centres only.
tmp<surfaceScalarField> mixtureScheme::dragForce(const volVectorField& j) const
{
  if (orthogonal_) return (dragExplicit_ & along_) + before_;
  return (dragExplicit_ & along_) + before_ + Kf_*(skew_ & fvc::interpolate(j));
}

tmp<surfaceScalarField> mixtureScheme::fullPressureForce
(
  const surfaceScalarField& along,
  const surfaceScalarField& across,
  const volVectorField& j
) const
{
  if (orthogonal_) return tmp<surfaceScalarField>(new surfaceScalarField(along));
  const surfaceVectorField others
  (
    inertia_ + pressureFactor_*body_ + dragExplicit_ - Kf_*fvc::interpolate(j)
  );
  return along + (across - (skew_ & others))/pressureFactor_;
}

tmp<fvScalarMatrix> mixtureScheme::pressureMatrix
(
  const surfaceScalarField& coefficient,
  const volScalarField& p
) const
{
  return fv::gaussLaplacianScheme<scalar, scalar>
  (
    mesh_,
    tmp<surfaceInterpolationScheme<scalar>>(new linear<scalar>(mesh_)),
    tmp<fv::snGradScheme<scalar>>(new fv::uncorrectedSnGrad<scalar>(mesh_))
  ).fvmLaplacian(coefficient, p);
}

/* Unit eigenvector of the largest eigenvalue of aa + bb: x a + y b with (x, y) that of the matrix of
 * their products. */
static vector principal(const vector& a, const vector& b)
{
  const scalar aa = a & a, bb = b & b, ab = a & b;
  const scalar largest = 0.5*(aa + bb) + std::sqrt(sqr(0.5*(aa - bb)) + sqr(ab));
  const vector v(aa > bb ? (largest - bb)*a + ab*b : ab*a + (largest - aa)*b);
  const scalar size = mag(v);
  return size > VSMALL ? vector(v/size) : vector(Zero);
}

/* Direction in which 1/eps jumps at a face (its sign does not matter): g = grad(1/eps), averaged over
 * neighbours. On a porosity step that lies on faces, of any mesh, each cell's g is normal to it, and so
 * is the average; on a step that cuts cells the average is truer than g. Where g vanishes (layers as
 * thin as a cell) the face's own difference is left. */
void mixtureScheme::makeNormal(const volScalarField& rEps)
{
  volVectorField g
  (
    IOobject("porosityNormal", mesh_.time().timeName(), mesh_), mesh_,
    dimensionedVector(dimless/dimLength, Zero), extrapolatedPatchTypes(mesh_)
  );
  g.primitiveFieldRef() = fvc::grad(rEps, "grad(rEps)")().primitiveField();
  g.correctBoundaryConditions();
  for (label pass = 0; pass < normalPasses; ++pass)
  {
    const volVectorField average(fvc::average(fvc::interpolate(g)()));
    g.primitiveFieldRef() = average.primitiveField();
    g.correctBoundaryConditions();
  }
  const surfaceVectorField gf(fvc::interpolate(g));
  const surfaceVectorField own(1e-4*difference(rEps)*along_/mag(along_));
  forAll(m_, facei) m_[facei] = principal(gf[facei], own[facei]);
  forAll(m_.boundaryField(), patchi)
  {
    const fvsPatchVectorField& gb = gf.boundaryField()[patchi];
    const fvsPatchVectorField& ob = own.boundaryField()[patchi];
    fvsPatchVectorField& m = m_.boundaryFieldRef()[patchi];
    forAll(m, i) m[i] = principal(gb[i], ob[i]);
  }
}

} // namespace Foam
