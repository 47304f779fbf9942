/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solidShapes.H"

#include <algorithm>

namespace Foam
{

/* Part of a tetrahedron on the negative side, from the signed distances of its corners. */
static scalar tetPartBelow(scalar d[4])
{
  std::sort(d, d + 4);
  const label below = label(d[0] < 0) + label(d[1] < 0) + label(d[2] < 0) + label(d[3] < 0);
  if (below == 0) return 0;
  if (below == 4) return 1;
  if (below == 1) return pow3(d[0])/((d[0] - d[1])*(d[0] - d[2])*(d[0] - d[3]));
  if (below == 3) return 1 - pow3(d[3])/((d[3] - d[0])*(d[3] - d[1])*(d[3] - d[2]));
  // A wedge with corners a, b below: cuts on ac, ad, bc, bd at these parts of the edges
  const scalar ac = d[0]/(d[0] - d[2]), ad = d[0]/(d[0] - d[3]);
  const scalar bc = d[1]/(d[1] - d[2]), bd = d[1]/(d[1] - d[3]);
  return ac*ad + bc*(1 - ac)*ad + bc*bd*(1 - ad);
}

scalar partBelow(const fvMesh& mesh, label cell, const vector& normal, scalar level)
{
  const pointField& x = mesh.points();
  const vector& c = mesh.cellCentres()[cell];
  scalar part = 0, whole = 0;
  for (const label facei : mesh.cells()[cell])
  {
    const face& f = mesh.faces()[facei];
    const vector& fc = mesh.faceCentres()[facei];
    forAll(f, i)
    {
      const vector& a = x[f[i]];
      const vector& b = x[f.nextLabel(i)];
      const scalar volume = mag(((a - c) ^ (b - c)) & (fc - c));
      scalar d[4] =
      {
        (c & normal) - level, (fc & normal) - level, (a & normal) - level, (b & normal) - level
      };
      whole += volume;
      part += volume*tetPartBelow(d);
    }
  }
  return part/whole;
}

/* Area (signed) of the circle around the origin and the triangle origin, a, b in the plane. */
static scalar circleTriangle(const vector2D& a, const vector2D& b, scalar radius)
{
  const scalar r2 = sqr(radius);
  const vector2D d(b - a);
  const scalar dd = d & d, ad = a & d;
  auto cross = [](const vector2D& p, const vector2D& q) { return p.x()*q.y() - p.y()*q.x(); };
  auto sector = [&](const vector2D& p, const vector2D& q)
  {
    return 0.5*r2*std::atan2(cross(p, q), p & q);
  };
  const scalar root = sqr(ad) - dd*((a & a) - r2);
  if (dd < VSMALL) return 0;
  if (root <= 0) return sector(a, b);
  const scalar t0 = (-ad - sqrt(root))/dd, t1 = (-ad + sqrt(root))/dd;
  if (t1 <= 0 || t0 >= 1) return sector(a, b);
  const vector2D in(t0 > 0 ? a + t0*d : a), out(t1 < 1 ? a + t1*d : b);
  scalar area = 0.5*cross(in, out);
  if (t0 > 0) area += sector(a, in);
  if (t1 < 1) area += sector(out, b);
  return area;
}

scalar partInCylinder
(
  const fvMesh& mesh, label cell, const vector& centre, const vector& axis, scalar radius
)
{
  // The base of the prism: the face most normal to the axis
  label base = -1;
  scalar best = 0;
  for (const label facei : mesh.cells()[cell])
  {
    const vector& S = mesh.faceAreas()[facei];
    if (mag(S & axis)/mag(S) > best)
    {
      best = mag(S & axis)/mag(S);
      base = facei;
    }
  }
  const vector e1(normalised(mesh.faceAreas()[base] ^ vector(axis.y(), axis.z(), axis.x())));
  const vector e2(axis ^ e1);
  const face& f = mesh.faces()[base];
  auto project = [&](label point)
  {
    const vector r(mesh.points()[point] - centre);
    return vector2D(r & e1, r & e2);
  };
  scalar area = 0;
  forAll(f, i) area += circleTriangle(project(f[i]), project(f.nextLabel(i)), radius);
  return mag(area)/mag(mesh.faceAreas()[base]);
}

} // namespace Foam
