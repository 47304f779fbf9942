/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mixtureScheme.H"

#include "fvc.H"
#include "fvm.H"
#include "mixtureFields.H"
#include "surfaceInterpolationScheme.H"

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
  const volScalarField& answer,
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
  answer_(answer),
  D_(D),
  G_(G),
  body_(body),
  rf_(faceScalar(mesh, "rEpsf", dimless)),
  pressureFactor_(faceScalar(mesh, "pressureFactor", dimless)),
  Kf_(faceScalar(mesh, "Kf", dimless/dimTime)),
  dragExplicit_(faceVector(mesh, "dragExplicit", dimAcceleration)),
  inertia_(faceVector(mesh, "solidInertia", dimAcceleration)),
  response_(faceScalar(mesh, "response", dimless)),
  driven_(faceScalar(mesh, "driven", dimVolume/sqr(dimTime))),
  vpf_(faceVector(mesh, "vpf", dimVelocity)),
  m_(faceVector(mesh, "porosityNormal", dimless)),
  jump_(faceScalar(mesh, "BernoulliJump", dimLength)),
  snGradREps_(faceScalar(mesh, "snGradREps", dimless/dimLength)),
  armOwn_(faceVector(mesh, "armOwn", dimLength)),
  armNei_(faceVector(mesh, "armNei", dimLength)),
  along_(faceVector(mesh, "along", dimArea)),
  skew_(faceVector(mesh, "skew", dimArea)),
  before_(faceScalar(mesh, "dragBefore", dimVolume/sqr(dimTime))),
  orthogonal_(true),
  solids_(false),
  uniform_(true),
  responds_(false)
{
  makeArms();
  makeSkew();
}

/* Solids cross no wall. */
static void stopAtWalls(surfaceScalarField& field)
{
  forAll(field.boundaryField(), patchi)
  {
    if (!field.mesh().boundary()[patchi].coupled()) field.boundaryFieldRef()[patchi] = 0;
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
    inertia_ = path(volVectorField((1 - eps_)*ap_*rEps))/rf_;
    jump_ = difference(0.5*sqr(rEps))*magSf/rf_;
  }
  else
  {
    pressureFactor_ = dimensionedScalar("one", dimless, 1);
    Kf_ = path(D_);
    inertia_ = path(volVectorField((1 - eps_)*ap_));
    jump_ = difference(rEps)*magSf;
  }
  updateExplicitDrag();
  responds_ = model_ == modelA && gMax(answer_) > 0;
  if (responds_)
  {
    response_ = path(volScalarField(answer_*rEps))/rf_;
    stopAtWalls(response_);
  }
  driven_ = (inertia_ & along_) + pressureFactor_*(body_ & along_);

  if (uniform_)
  {
    m_ = dimensionedVector(dimless, Zero);
    return;
  }
  makeNormal(rEps);
}

void mixtureScheme::updateExplicitDrag()
{
  const volVectorField known(D_*((1 - eps_)*vp_) + G_);
  if (model_ == modelA) dragExplicit_ = path(volVectorField(known/eps_))/rf_;
  else dragExplicit_ = path(known);
}

tmp<surfaceScalarField> mixtureScheme::flux(const volVectorField& solids) const
{
  tmp<surfaceScalarField> tflux
  (
    model_ == modelA ? (path(volVectorField(solids/eps_)) & mesh_.Sf())/rf_ : path(solids) & mesh_.Sf()
  );
  stopAtWalls(tflux.ref());
  return tflux;
}

void mixtureScheme::resolve(const surfaceScalarField& phi, const volVectorField& j)
{
  fluxBefore_.reset(new surfaceScalarField("fluxBefore", phi));
  flowBefore_.reset(new volVectorField("flowBefore", j));
  facelessBefore_.reset(new volVectorField("facelessBefore", j - reconstruct(phi)));
  const volVectorField drag(D_*j);
  surfaceVectorField dragf("dragBefore", path(drag));
  if (model_ == modelA) dragf = path(volVectorField(drag/eps_))/rf_;
  before_ = Kf_*phi - (dragf & mesh_.Sf());
}

tmp<volVectorField> mixtureScheme::faceless(const volVectorField& cells, const surfaceScalarField& flux) const
{
  tmp<volVectorField> tpart(cells - reconstruct(flux));
  if (facelessBefore_.valid()) tpart.ref() -= facelessBefore_();
  return tpart;
}

// w of M.16 between eps = 0.7, below which there may be networks of contacts, and 0.9
static scalar predicted(scalar eps)
{
  return 0.2 + 0.8*min(max(5*(eps - 0.7), scalar(0)), scalar(1));
}

tmp<scalarField> mixtureScheme::predictionWeight() const
{
  tmp<scalarField> tw(new scalarField(eps_.size(), 1));
  if (responds_) forAll(tw(), celli) tw.ref()[celli] = predicted(eps_[celli]);
  return tw;
}

tmp<surfaceScalarField> mixtureScheme::predictionWeightf() const
{
  return 0.2 + 0.8*min(max(5*(1/rf_ - 0.7), scalar(0)), scalar(1));
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

} // namespace Foam
