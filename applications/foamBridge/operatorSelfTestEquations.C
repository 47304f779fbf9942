/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The checks of operatorSelfTest.C that build matrices, or that pressure and momentum equations are
 * made of. */
#include "operatorSelfTestChecks.H"

#include "EulerDdtScheme.H"
#include "correctedSnGrad.H"
#include "fvc.H"
#include "fvm.H"
#include "gaussConvectionScheme.H"
#include "gaussLaplacianScheme.H"
#include "linear.H"
#include "uncorrectedSnGrad.H"
#include "upwind.H"

namespace Foam {
namespace selfTest {

namespace {

const char *const faceSum = "the sum over faces, any mesh";

template <class Type> using Interpolation = tmp<surfaceInterpolationScheme<Type>>;

template <class Type> Interpolation<Type> linearScheme(const fvMesh &mesh) {
  return Interpolation<Type>(new linear<Type>(mesh));
}

template <class Type> tmp<fv::laplacianScheme<Type, scalar>> laplacianScheme(const fvMesh &mesh) {
  return tmp<fv::laplacianScheme<Type, scalar>>(new fv::gaussLaplacianScheme<Type, scalar>(
      mesh, linearScheme<scalar>(mesh),
      tmp<fv::snGradScheme<Type>>(new fv::correctedSnGrad<Type>(mesh))));
}

tmp<fv::convectionScheme<vector>> convectionScheme(const surfaceScalarField &phi,
                                                   const Interpolation<vector> &face) {
  return tmp<fv::convectionScheme<vector>>(
      new fv::gaussConvectionScheme<vector>(phi.mesh(), phi, face));
}

// Over-relaxed two-point difference along the normal: 1/(n.d) times (neighbour - owner).
template <class Type> Field<Type> twoPoint(const FlatMesh &m, const VolField<Type> &f) {
  Field<Type> all(m.difference(f));
  forAll(all, i) {
    if (m.used[i]) {
      all[i] /= max((m.S[i] & m.delta[i]) / mag(m.S[i]), 0.05 * mag(m.delta[i]));
    }
  }
  return all;
}

// The rest of n.grad f, from interpolated cell gradients; none on boundary faces.
template <class Type, class Grad>
Field<Type> corrected(const FlatMesh &m, const VolField<Type> &f, const VolField<Grad> &grad) {
  Field<Type> all(twoPoint(m, f));
  const Field<Grad> face(m.interpolate(grad, nullptr));
  forAll(all, i) {
    if (m.used[i] && m.joinsCells[i]) {
      const vector n = m.S[i] / mag(m.S[i]);
      const vector rest = n - m.delta[i] / max(n & m.delta[i], 0.05 * mag(m.delta[i]));
      all[i] += rest & face[i];
    }
  }
  return all;
}

} // namespace

// Faces whose corrected snGrad of a linear field is exact: along the line between the centres, or
// (inside this rank) between two cells whose gradients are.
boolList Checks::exactNormalGradient() const {
  boolList faces(both(m_.normal, m_.keepsLinear));
  for (label f = 0; f < mesh_.nInternalFaces() && gaussLinear_; f++) {
    faces[f] =
        faces[f] || (exactCells_[mesh_.faceOwner()[f]] && exactCells_[mesh_.faceNeighbour()[f]]);
  }
  return faces;
}

void Checks::surfaceNormalGradient() {
  const std::string name = "grad(p_rgh)";
  const auto grad = fv::gradScheme<scalar>::New(mesh_, mesh_.gradScheme(name))().calcGrad(p_, name);
  const scalarField plain(m_.flatten(fv::uncorrectedSnGrad<scalar>(mesh_).snGrad(p_)()));
  const scalarField full(m_.flatten(fv::correctedSnGrad<scalar>(mesh_).snGrad(p_)()));
  scalarField want(mesh_.nFaces());
  forAll(want, f) {
    want[f] = (g_ & m_.S[f]) / mag(m_.S[f]);
  }
  const scalar scale = max(mag(g_), gMax(mag(plain))); // larger than g across a cyclic pair
  compare("snGrad(uncorrected).definition", plain, twoPoint(m_, p_), scale, allFaces_,
          "two-point difference");
  compare("snGrad(corrected).definition", full, corrected(m_, p_, grad()), scale, allFaces_,
          "two-point difference and the case's grad(p_rgh)");
  compare("snGrad(uncorrected,linear)", plain, want, mag(g_), both(m_.normal, m_.keepsLinear),
          "d along the normal");
  compare("snGrad(corrected,linear)", full, want, mag(g_), exactNormalGradient(),
          "d along the normal, or exact gradients in both cells");
  boolList inner(mesh_.nFaces(), false);
  for (label f = 0; f < mesh_.nInternalFaces(); f++) {
    inner[f] = linearCells_[mesh_.faceOwner()[f]] && linearCells_[mesh_.faceNeighbour()[f]];
  }
  compare("snGrad(corrected,linear).anyFace", full, want, mag(g_), inner,
          "error of the case's grad(p_rgh)", false);
}

void Checks::laplacian() {
  const std::string name = "grad(p_rgh)";
  const auto grad = fv::gradScheme<scalar>::New(mesh_, mesh_.gradScheme(name))().calcGrad(p_, name);
  const surfaceScalarField gamma("gamma", 1 + sqr(linearInterpolate(p_) / (mag(g_) * size_)));
  const scalarField coeff(m_.flatten(gamma)), area(mag(m_.S)), slope(corrected(m_, p_, grad()));
  const scalarField flux(coeff * area * slope), sum(m_.integrate(flux));
  const scalar scale = m_.termSize(mag(flux));
  mesh_.setFluxRequired(p_.name());
  const auto scheme = laplacianScheme<scalar>(mesh_);
  const auto L = scheme.constCast().fvmLaplacian(gamma, p_);
  const scalarField applied((L() & p_)().field());
  const surfaceScalarField matrixFlux("flux", L().flux());
  compare("fvm::laplacian(scalar).definition", applied, sum, scale, allCells_, faceSum);
  compare("fvc::laplacian(scalar).definition", scheme.constCast().fvcLaplacian(gamma, p_)(), sum,
          scale, allCells_, faceSum);
  compare("laplacian.flux.definition", m_.flatten(matrixFlux), flux, gMax(mag(flux)), allFaces_,
          "gamma |S| snGrad, boundary included");
  compare("div(laplacian.flux)", fvc::div(matrixFlux)(), applied, scale, allCells_,
          "what makes the corrected flux continuous, any mesh");

  const surfaceScalarField one("one", 0 * gamma + 1);
  const scalarField zero(mesh_.nCells(), Zero);
  const boolList faces(exactNormalGradient());
  compare("laplacian(linear)", scheme.constCast().fvcLaplacian(one, p_)(), zero,
          m_.termSize(mag(g_) * area), m_.cellsWhere(faces, faces),
          "snGrad exact on all faces of the cell");
}

void Checks::laplacianOfVector() {
  const auto grad = fv::gaussGrad<vector>(mesh_).calcGrad(U_, "grad");
  const surfaceScalarField nu("nu", dimensionedScalar("nu", dimViscosity, 1) *
                                        (1 + sqr(linearInterpolate(p_))));
  const auto L = laplacianScheme<vector>(mesh_).constCast().fvmLaplacian(nu, U_);
  const scalarField coeff(m_.flatten(nu)), area(mag(m_.S));
  const bool gaussU = schemeText(mesh_.gradScheme("grad(U)")) == "Gauss linear";
  const vectorField flux(coeff * area * corrected(m_, U_, grad()));
  compare("fvm::laplacian(vector).definition", (L() & U_)(), m_.integrate(flux),
          m_.termSize(mag(flux)), allCells_,
          gaussU ? faceSum : "the case's grad(U) is not Gauss linear", gaussU);
}

// Slip and symmetry planes rotate vectors in code that OpenFOAM's library brings compiled:
// transform(tmp, tmp).
void Checks::slipBoundary() {
  const Profile<vector> linearU = [this](const point &x) { return u_ + ((x - middle_) & G_); };
  volVectorField U(m_.field<vector>("U", dimVelocity, linearU, "slip"));
  vectorField got(mesh_.nFaces(), Zero), want(mesh_.nFaces(), Zero);
  boolList mirrors(mesh_.nFaces(), false);
  forAll(mesh_.boundary(), patchi) {
    const fvPatch &patch = mesh_.boundary()[patchi];
    if (patch.coupled() || patch.type() == "wedge") {
      continue;
    }
    forAll(patch, i) {
      const label f = patch.start() + i;
      const vector n = m_.S[f] / mag(m_.S[f]), inner = U[mesh_.faceOwner()[f]];
      got[f] = U.boundaryField()[patchi][i];
      want[f] = inner - (n & inner) * n;
      mirrors[f] = true;
    }
  }
  const scalar size = mag(u_) + mag(G_) * size_;
  compare("slip.value", got, want, size, mirrors, "the component along the boundary");

  const auto grad = fv::gaussGrad<vector>(mesh_).calcGrad(U, "grad");
  const bool gaussU = schemeText(mesh_.gradScheme("grad(U)")) == "Gauss linear";
  const surfaceScalarField nu("nu", dimensionedScalar("nu", dimViscosity, 1) *
                                        (1 + sqr(linearInterpolate(p_))));
  const auto L = laplacianScheme<vector>(mesh_).constCast().fvmLaplacian(nu, U);
  const scalarField coeff(m_.flatten(nu)), area(mag(m_.S));
  const vectorField flux(coeff * area * corrected(m_, U, grad()));
  compare("fvm::laplacian(vector).slip", (L() & U)(), m_.integrate(flux), m_.termSize(mag(flux)),
          allCells_, gaussU ? faceSum : "the case's grad(U) is not Gauss linear", gaussU);
}

// ----------------------------------------------------------------------------------------------
// reconstruction

void Checks::reconstruction() {
  const vectorField u(mesh_.nCells(), u_);
  compare("fvc::reconstruct(flux(uniform))", fvc::reconstruct(phi_)(), u, mag(u_), uniformCells_,
          "inverse(sum nS) . sum n(S.u), any mesh");

  vectorField R(mesh_.nCells(), Zero); // (1/V) sum f (x_f - x_P), f out of the cell
  const scalarField f(m_.flatten(phi_));
  for (label i = 0; i < mesh_.nFaces(); i++) {
    const label P = mesh_.faceOwner()[i];
    R[P] += f[i] * (m_.centre[i] - mesh_.cellCentres()[P]) / mesh_.V()[P];
    if (i < mesh_.nInternalFaces()) {
      const label N = mesh_.faceNeighbour()[i];
      R[N] -= f[i] * (m_.centre[i] - mesh_.cellCentres()[N]) / mesh_.V()[N];
    }
  }
  compare("R(flux(uniform))", R, u, mag(u_),
          both(uniformCells_, m_.cellsWhere(m_.planar, m_.planar)),
          "planar faces: sum (x_f - x_P) S = V I");
  compare("R(flux(uniform)).anyCell", R, u, mag(u_), uniformCells_,
          "warped faces: (x_f - x_P) S is not its integral", false);
}

// ----------------------------------------------------------------------------------------------
// momentum equation

void Checks::convection() {
  const surfaceScalarField phi("phi", linearInterpolate(U_) & mesh_.Sf());
  const scalarField flatPhi(m_.flatten(phi)), flatUniform(m_.flatten(phi_));
  const scalarField divPhi(m_.integrate(flatPhi));
  scalarField fromOwner(mesh_.nFaces());
  forAll(fromOwner, f) {
    fromOwner[f] = flatPhi[f] >= 0 ? 1 : 0;
  }
  const vectorField upwindFlux(flatPhi * m_.interpolate(U_, &fromOwner));
  const vectorField linearFlux(flatPhi * m_.interpolate(U_, nullptr));
  const scalar scale = m_.termSize(mag(linearFlux));

  const auto byUpwind =
      convectionScheme(phi, Interpolation<vector>(new upwind<vector>(mesh_, phi)));
  const auto byLinear = convectionScheme(phi, linearScheme<vector>(mesh_));
  const fvVectorMatrix upwindMatrix(byUpwind().fvmDiv(phi, U_)),
      linearMatrix(byLinear().fvmDiv(phi, U_));
  compare("fvm::div(phi,U).upwind.definition", (upwindMatrix & U_)(), m_.integrate(upwindFlux),
          scale, allCells_, faceSum);
  compare("fvm::div(phi,U).linear.definition", (linearMatrix & U_)(), m_.integrate(linearFlux),
          scale, allCells_, faceSum);
  compare("fvc::div(phi,U).linear.definition", byLinear().fvcDiv(phi, U_)(),
          m_.integrate(linearFlux), scale, allCells_, faceSum);

  vectorField advective(m_.integrate(linearFlux));
  forAll(advective, c) {
    advective[c] -= divPhi[c] * U_[c];
  }
  const fvVectorMatrix both(byLinear().fvmDiv(phi, U_) - fvm::Sp(fvc::div(phi), U_));
  compare("fvm::div-Sp(div).definition", (both & U_)(), advective, scale, allCells_, faceSum);

  const auto byUniform = convectionScheme(phi_, linearScheme<vector>(mesh_));
  const vectorField exact(mesh_.nCells(), u_ & G_);
  compare("fvm::div(uniformPhi,linearU)", (byUniform().fvmDiv(phi_, U_)() & U_)(), exact,
          m_.termSize(mag(flatUniform)) * gMax(mag(U_.primitiveField())), exactCells_,
          "(u.grad) U where the Gauss gradient is exact");
}

void Checks::sources() {
  const dimensionedScalar perSecond("perSecond", inv(dimTime), 1);
  const volScalarField K("K", perSecond * (2 + p_ / (mag(g_) * size_)));
  const volScalarField sign("sign", perSecond * p_);
  const volVectorField S("S", 3 * perSecond * U_ + K * uniform_);
  vectorField residual(mesh_.nCells()), solution(mesh_.nCells()), linearised(mesh_.nCells());
  forAll(residual, c) {
    residual[c] = K[c] * U_[c] - S[c];
    solution[c] = S[c] / K[c];
    linearised[c] = sign[c] * U_[c];
  }
  const fvVectorMatrix M(fvm::Sp(K, U_) - fvm::Su(S, U_)), signedMatrix(fvm::SuSp(sign, U_));
  const char *why = "cell by cell, any mesh";
  compare("fvm::Sp-Su", (M & U_)(), residual, gMax(mag(S.primitiveField())), allCells_, why);
  compare("H/A", (M.H() / M.A())(), solution, gMax(mag(solution)), allCells_, why);
  compare("fvm::SuSp", (signedMatrix & U_)(), linearised, gMax(mag(linearised)), allCells_, why);
}

void Checks::timeDerivative() {
  volVectorField U(U_);
  const scalar dt = mesh_.time().deltaTValue();
  vectorField rate(mesh_.nCells());
  forAll(rate, c) {
    vector &old = U.oldTime()[c];
    old = 0.5 * U[c] - vector(U[c].z(), U[c].x(), 1);
    rate[c] = (U[c] - old) / dt;
  }
  fv::EulerDdtScheme<vector> euler(mesh_);
  const scalar scale = gMax(mag(rate));
  compare("fvm::ddt.Euler", (euler.fvmDdt(U)() & U)(), rate, scale, allCells_, "(U - U_0)/dt");
  compare("fvc::ddt.Euler", euler.fvcDdt(U)(), rate, scale, allCells_, "(U - U_0)/dt");
}

void Checks::momentumMatrix() {
  volVectorField U(U_);
  const surfaceScalarField phi("phi", linearInterpolate(U_) & mesh_.Sf());
  const surfaceScalarField nu("nu", dimensionedScalar("nu", dimViscosity, 1) *
                                        (1 + sqr(linearInterpolate(p_))));
  const auto inertia = fv::EulerDdtScheme<vector>(mesh_).fvmDdt(U);
  const auto momentum =
      convectionScheme(phi, linearScheme<vector>(mesh_)).constCast().fvmDiv(phi, U);
  const auto viscous = laplacianScheme<vector>(mesh_).constCast().fvmLaplacian(nu, U);
  const fvVectorMatrix M(inertia() + momentum() - viscous());
  const volScalarField A("A", M.A());
  const volVectorField H("H", M.H()), byParts("byParts", (1 / A) * M.H());
  const vectorField sum((inertia() & U)().field() + (momentum() & U)().field() -
                        (viscous() & U)().field());
  vectorField split(mesh_.nCells()), quotient(mesh_.nCells());
  forAll(split, c) {
    split[c] = A[c] * U[c] - H[c];
    quotient[c] = H[c] / A[c];
  }
  const scalar scale = gMax(mag(H.primitiveField()));
  compare("UEqn.sumOfTerms", (M & U)(), sum, scale, allCells_, "matrix algebra, any mesh");
  compare("UEqn=AU-H", (M & U)(), split, scale, allCells_, "definition of A and H, any mesh");
  compare("rAU*H", byParts, quotient, gMax(mag(quotient)), allCells_, "cell by cell");
}

} // namespace selfTest
} // namespace Foam
