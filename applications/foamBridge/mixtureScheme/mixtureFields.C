/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mixtureFields.H"

#include "fixedValueFvPatchFields.H"
#include "polyPatch.H"
#include "wallFvPatch.H"
#include "zeroGradientFvPatchFields.H"

namespace Foam
{

wordList extrapolatedPatchTypes(const fvMesh& mesh)
{
  wordList types(mesh.boundary().size(), zeroGradientFvPatchScalarField::typeName);
  forAll(types, patchi)
  {
    const word& type = mesh.boundary()[patchi].type();
    if (polyPatch::constraintType(type)) types[patchi] = type;
  }
  return types;
}

tmp<vectorField> mixtureBoundaryValue
(
  const fvPatchVectorField& U,
  const scalarField& eps,
  const vectorField& vp
)
{
  vectorField solids(vp); // of the solids at the patch
  if (isA<wallFvPatch>(U.patch())) // none cross it; fluid may: a distributor plate
  {
    const vectorField n(U.patch().nf());
    solids -= n*(n & solids);
  }
  return U + (1 - eps)*(solids - U);
}

tmp<volVectorField> mixtureField
(
  const volVectorField& U,
  const volScalarField& eps,
  const volVectorField& vp
)
{
  wordList types(U.boundaryField().types());
  forAll(types, patchi)
  {
    const fvPatchVectorField& patch = U.boundaryField()[patchi];
    if (patch.fixesValue() && !patch.coupled() && !polyPatch::constraintType(patch.patch().type()))
    {
      types[patchi] = fixedValueFvPatchVectorField::typeName;
    }
  }
  tmp<volVectorField> tj
  (
    new volVectorField
    (
      IOobject
      (
        "mixtureField", U.time().timeName(), U.mesh(), IOobject::NO_READ, IOobject::NO_WRITE, false
      ),
      U.mesh(), dimensionedVector(dimVelocity, Zero), types
    )
  );
  volVectorField& j = tj.ref();
  j.primitiveFieldRef() =
    eps.primitiveField()*U.primitiveField() + (1 - eps.primitiveField())*vp.primitiveField();
  forAll(types, patchi)
  {
    if (types[patchi] == fixedValueFvPatchVectorField::typeName)
    {
      j.boundaryFieldRef()[patchi] == mixtureBoundaryValue
      (
        U.boundaryField()[patchi], eps.boundaryField()[patchi], vp.boundaryField()[patchi]
      );
    }
  }
  j.correctBoundaryConditions();
  return tj;
}

} // namespace Foam
