/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "operatorSelfTest.H"
#include "operatorSelfTestChecks.H"

#include "fvc.H"
#include "IStringStream.H"
#include "OStringStream.H"
#include "gaussGrad.H"

namespace Foam {
namespace selfTest {

vector without(const vector &v, const vector &mask) {
  return cmptMultiply(v, mask);
}

tensor without(const tensor &t, const vector &mask) {
  return cmptMultiply(t, mask * mask);
}

std::string schemeText(ITstream &scheme) {
  OStringStream text;
  forAll(scheme, i) {
    text << (i ? " " : "") << scheme[i];
  }
  return text.str();
}

Checks::Checks(const fvMesh &mesh, Ostream &report)
    : m_(mesh), mesh_(mesh), out_(report), middle_(mesh.bounds().midpoint()),
      g_(without(gradP, m_.mask)), G_(without(gradU, m_.mask)), u_(without(uniformU, m_.mask)),
      p_(m_.field<scalar>("p_rgh", dimless, [this](const point &x) { return g_ & (x - middle_); })),
      U_(m_.field<vector>("U", dimVelocity,
                          [this](const point &x) { return u_ + ((x - middle_) & G_); })),
      uniform_(m_.field<vector>("U", dimVelocity, [this](const point &) { return u_; })),
      phi_("phi", fvc::flux(uniform_)), allCells_(mesh.nCells(), true),
      uniformCells_(m_.cellsWhere(m_.keepsUniform, m_.keepsUniform)),
      linearCells_(m_.cellsWhere(m_.keepsLinear, m_.keepsLinear)),
      exactCells_(both(m_.cellsWhere(m_.straight, m_.planar), linearCells_)),
      allFaces_(mesh.nFaces(), true),
      gaussLinear_(schemeText(mesh.gradScheme("grad(p_rgh)")) == "Gauss linear"),
      size_(mesh.bounds().mag()) {}

// ----------------------------------------------------------------------------------------------
// report

void Checks::line(const char *name, scalar error, scalar limit, label checked, label all,
                  const char *why, bool must) {
  reduce(error, maxOp<scalar>());
  reduce(checked, sumOp<label>());
  reduce(all, sumOp<label>());
  const bool good = error <= limit;
  const char *status = checked == 0 ? "none" : !must ? "info" : good ? "ok" : "FAILED";
  failed_ += checked > 0 && must && !good;
  out_ << status << token::TAB << name << token::TAB << error << token::TAB << checked << '/' << all
       << token::TAB << why << nl;
}

// ----------------------------------------------------------------------------------------------
// algebra

// The result may reuse the memory of a tmp operand: that is what GCC 12.2 -O3 gets wrong.
template <class Result>
void Checks::product(const char *name, const tmp<Field<Result>> &got,
                     const std::function<Result(label)> &want) {
  Field<Result> expected(got().size());
  forAll(expected, i) {
    expected[i] = want(i);
  }
  scalar worst = 0;
  forAll(expected, i) {
    const scalar error = mag(got()[i] - expected[i]) / mag(expected[i]);
    worst = error <= GREAT ? max(worst, error) : GREAT;
  }
  line(name, worst, m_.tolerance, expected.size(), expected.size(), "element by element", true);
}

void Checks::algebra() {
  const label n = 1013; // odd: a vectorised loop must also treat its rest
  tensorField T(n);
  vectorField v(n), w(n);
  scalarField a(n);
  forAll(T, i) {
    for (direction d = 0; d < 9; d++) {
      T[i][d] = std::sin(0.37 * i + 1.7 * d) + (d % 4 == 0 ? 3 : 0); // well away from singular
    }
    v[i] = vector(1.5 + std::sin(0.7 * i), std::cos(0.3 * i), 0.2 * (i % 11));
    w[i] = vector(std::cos(0.9 * i), 1.5 + std::sin(0.2 * i), -0.1 * (i % 7));
    a[i] = 2 + std::sin(1.1 * i);
  }
  const symmTensorField s(symm(T));
  const auto t = [](const vectorField &f) { return tmp<vectorField>(new vectorField(f)); };
  const auto tt = [](const tensorField &f) { return tmp<tensorField>(new tensorField(f)); };
  const std::function<vector(label)> Tv = [&](label i) { return T[i] & v[i]; };
  const std::function<vector(label)> vT = [&](label i) { return v[i] & T[i]; };
  const std::function<tensor(label)> TT = [&](label i) { return T[i] & T[i]; };
  product<vector>("tensor&tmp<vector>", T & t(v), Tv);
  product<vector>("tmp<tensor>&vector", tt(T) & v, Tv);
  product<vector>("tmp<tensor>&tmp<vector>", tt(T) & t(v), Tv);
  product<vector>("tmp<vector>&tensor", t(v) & T, vT);
  product<vector>("tmp<vector>&tmp<tensor>", t(v) & tt(T), vT);
  product<vector>("symmTensor&tmp<vector>", s & t(v), [&](label i) { return s[i] & v[i]; });
  product<tensor>("tensor&tmp<tensor>", T & tt(T), TT);
  product<tensor>("tmp<tensor>&tmp<tensor>", tt(T) & tt(T), TT);
  product<vector>("vector^tmp<vector>", v ^ t(w), [&](label i) { return v[i] ^ w[i]; });
  product<vector>("scalar*tmp<vector>", a * t(v), [&](label i) { return a[i] * v[i]; });
  product<tensor>("vector*tmp<vector>", v * t(w), [&](label i) { return v[i] * w[i]; });
  product<tensor>("inv(tmp<tensor>)", inv(tt(T)), [&](label i) { return inv(T[i]); });
  product<tensor>("dev2(tmp<tensor>)", dev2(tt(T)), [&](label i) { return dev2(T[i]); });
}

void Checks::geometricAlgebra() {
  const tensor G = G_;
  const volTensorField T(m_.field<tensor>(
      "T", dimless, [&](const point &x) { return G * (g_ & (x - middle_)) + 3 * tensor::I; }));
  const surfaceTensorField Tf(linearInterpolate(T));
  const surfaceVectorField Uf(linearInterpolate(U_));
  vectorField cell(mesh_.nCells()), face(mesh_.nFaces(), Zero);
  forAll(cell, c) {
    cell[c] = T[c] & (2 * U_[c]);
  }
  const tensorField flatT(m_.flatten(Tf));
  const vectorField flatU(m_.flatten(Uf));
  forAll(face, f) {
    face[f] = flatT[f] & (2 * flatU[f]);
  }
  tensorField turned(mesh_.nCells());
  forAll(turned, c) {
    turned[c] = dev2((2 * T[c]).T());
  }
  const char *why = "element by element";
  compare("dev2(T(tmp<volTensor>))", dev2(Foam::T(2 * T))(), turned, gMax(mag(turned)), allCells_,
          why);
  compare("volTensor&tmp<volVector>", (T & (2 * U_))(), cell, gMax(mag(cell)), allCells_, why);
  compare("surfaceTensor&tmp<surfaceVector>", m_.flatten((Tf & (2 * Uf))()), face, gMax(mag(face)),
          allFaces_, why);
}

// ----------------------------------------------------------------------------------------------
// interpolation

void Checks::interpolation() {
  const vectorField u(mesh_.nFaces(), u_);
  vectorField U(mesh_.nFaces());
  scalarField p(mesh_.nFaces()), phi(mesh_.nFaces());
  forAll(p, f) {
    p[f] = g_ & (m_.centre[f] - middle_);
    U[f] = u_ + ((m_.centre[f] - middle_) & G_);
    phi[f] = u_ & m_.S[f];
  }
  const boolList centred(both(m_.straight, m_.keepsLinear));
  const scalar P = mag(g_) * size_, V = mag(u_) + mag(G_) * size_;
  const char *formula = "w own + (1-w) neighbour";
  const char *line = "the line between the cell centres meets the face centre";
  const scalarField pf(m_.flatten(linearInterpolate(p_)()));
  const vectorField Uf(m_.flatten(linearInterpolate(U_)()));
  compare("interpolate(uniform)", m_.flatten(fvc::interpolate(uniform_)()), u, mag(u_),
          m_.keepsUniform, "any mesh");
  compare("flux(uniform)", m_.flatten(phi_), phi, gMax(mag(phi)), m_.keepsUniform, "any mesh");
  compare("interpolate(scalar).definition", pf, m_.interpolate(p_, nullptr), P, allFaces_, formula);
  compare("interpolate(vector).definition", Uf, m_.interpolate(U_, nullptr), V, allFaces_, formula);
  compare("interpolate(linearScalar)", pf, p, P, centred, line);
  compare("interpolate(linearVector)", Uf, U, V, centred, line);
}

// ----------------------------------------------------------------------------------------------
// div and grad

const char *const gaussExact =
    "planar faces, met in their centres by the lines between cell centres";
const char *const sumOfFaces = "the sum over faces, any mesh";

void Checks::divergence() {
  const surfaceScalarField phi("phi", linearInterpolate(U_) & mesh_.Sf());
  const scalar scale = m_.termSize(mag(m_.flatten(phi))),
               uniformScale = m_.termSize(mag(m_.flatten(phi_)));
  const scalarField zero(mesh_.nCells(), Zero), trace(mesh_.nCells(), tr(G_));
  compare("div(flux(uniform))", fvc::div(phi_)(), zero, uniformScale, uniformCells_,
          "cells are closed, any mesh");
  compare("div(flux).definition", fvc::div(phi)(), m_.integrate(m_.flatten(phi)), scale, allCells_,
          sumOfFaces);
  compare("div(flux(linear))", fvc::div(phi)(), trace, scale, exactCells_, gaussExact);

  const tensor G = G_;
  const volTensorField T(
      m_.field<tensor>("T", dimless, [&](const point &x) { return G * (g_ & (x - middle_)); }));
  const surfaceVectorField Tf(mesh_.Sf() & linearInterpolate(T));
  const vectorField flat(m_.flatten(Tf)), exact(mesh_.nCells(), g_ & G);
  compare("div(tensor).definition", fvc::div(Tf)(), m_.integrate(flat), m_.termSize(mag(flat)),
          allCells_, sumOfFaces);
  compare("div(linearTensor)", fvc::div(Tf)(), exact, m_.termSize(mag(flat)), exactCells_,
          gaussExact);
}

template <class Type>
Field<typename outerProduct<vector, Type>::type> gaussSum(const FlatMesh &m,
                                                          const VolField<Type> &f) {
  const Field<Type> face(m.interpolate(f, nullptr));
  Field<typename outerProduct<vector, Type>::type> sum(face.size());
  forAll(sum, i) {
    sum[i] = m.S[i] * face[i];
  }
  return m.integrate(sum);
}

void Checks::gradient() {
  const auto gradP = fv::gaussGrad<scalar>(mesh_).calcGrad(p_, "grad(p_rgh)");
  const auto gradU = fv::gaussGrad<vector>(mesh_).calcGrad(U_, "grad(U)");
  const vectorField g(mesh_.nCells(), g_);
  const tensorField G(mesh_.nCells(), G_);
  compare("GaussLinearGrad(scalar).definition", gradP(), gaussSum(m_, p_), mag(g_), allCells_,
          sumOfFaces);
  compare("GaussLinearGrad(vector).definition", gradU(), gaussSum(m_, U_), mag(G_), allCells_,
          sumOfFaces);
  compare("GaussLinearGrad(linearScalar)", gradP(), g, mag(g_), exactCells_, gaussExact);
  compare("GaussLinearGrad(linearVector)", gradU(), G, mag(G_), exactCells_, gaussExact);
  compare("GaussLinearGrad(linearScalar).anyCell", gradP(), g, mag(g_), linearCells_,
          "skewness and warp", false);

  const std::string scheme = schemeText(mesh_.gradScheme("grad(p_rgh)"));
  const std::string why = "the case's grad(p_rgh): " + scheme;
  const auto configured =
      fv::gradScheme<scalar>::New(mesh_, mesh_.gradScheme("grad(p_rgh)"))().calcGrad(p_, "grad");
  compare("grad(p_rgh)", configured(), g, mag(g_), gaussLinear_ ? exactCells_ : linearCells_,
          why.c_str(), gaussLinear_);
}

bool Checks::run() {
  algebra();
  geometricAlgebra();
  interpolation();
  divergence();
  gradient();
  surfaceNormalGradient();
  laplacian();
  laplacianOfVector();
  slipBoundary();
  reconstruction();
  convection();
  sources();
  timeDerivative();
  momentumMatrix();
  return failed_ == 0;
}

} // namespace selfTest

bool operatorSelfTest(const fvMesh &mesh, Ostream &report) {
  return selfTest::Checks(mesh, report).run();
}

scalar linearGradientError(const fvMesh &mesh, const string &scheme) {
  const selfTest::FlatMesh m(mesh);
  const vector g(cmptMultiply(selfTest::gradP, m.mask));
  const point middle(mesh.bounds().midpoint());
  const auto p =
      m.field<scalar>("p_rgh", dimless, [&](const point &x) { return g & (x - middle); });
  IStringStream text(scheme);
  const auto grad = fv::gradScheme<scalar>::New(mesh, text)().calcGrad(p, "grad");
  const boolList cells(m.cellsWhere(m.keepsLinear, m.keepsLinear));
  scalar worst = 0;
  forAll(cells, c) {
    if (cells[c]) {
      worst = max(worst, mag(grad()[c] - g) / mag(g));
    }
  }
  return returnReduce(worst, maxOp<scalar>());
}

} // namespace Foam
