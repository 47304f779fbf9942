/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The ball cut by axis-aligned planes. With the position vector, the divergence theorem gives
 *   V = Omega / 3 + sum over plane faces of h A / 3
 * and Gauss-Bonnet the solid angle Omega of the part of the sphere,
 *   Omega = 2 pi - sum over arcs (a phi) - sum over vertices (exterior angle)
 * (doc/equations.md, sphere and box). atan2 everywhere: acos loses half the digits at tangency. */
#include "box_sphere.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

double cpl_cap(double a) {
  if (a >= 1.0)
    return 0.0;
  return a <= -1.0 ? 4.0 * pi / 3.0 : pi * (1.0 - a) * (1.0 - a) * (2.0 + a) / 3.0;
}

double cpl_edge_part(double a, double b) {
  if (a >= 1.0 || b >= 1.0)
    return 0.0;
  if (a <= -1.0)
    return cpl_cap(b);
  if (b <= -1.0)
    return cpl_cap(a);
  const double z2 = 1.0 - a * a - b * b;
  if (!(z2 > 0.0)) { /* the line of the edge misses the ball */
    if (a >= 0.0)
      return b >= 0.0 ? 0.0 : cpl_cap(a);
    return b >= 0.0 ? cpl_cap(b) : cpl_cap(a) + cpl_cap(b) - 4.0 * pi / 3.0;
  }
  const double z = sqrt(z2);
  return (2.0 * (pi - atan2(z, -a * b)) - a * (3.0 - a * a) * atan2(z, b) -
          b * (3.0 - b * b) * atan2(z, a) + 2.0 * a * b * z) /
         3.0;
}

/* The three planes meet inside the ball. */
static double corner_inside(double a, double b, double c) {
  const double zab = sqrt(1.0 - a * a - b * b), zbc = sqrt(1.0 - b * b - c * c),
               zca = sqrt(1.0 - c * c - a * a);
  const double exterior = atan2(zab, -a * b) + atan2(zbc, -b * c) + atan2(zca, -c * a);
  const double pa = atan2(zab, b) + atan2(zca, c) - 0.5 * pi;
  const double pb = atan2(zbc, c) + atan2(zab, a) - 0.5 * pi;
  const double pc = atan2(zca, a) + atan2(zbc, b) - 0.5 * pi;
  return (2.0 * pi - exterior) / 3.0 -
         (a * (3.0 - a * a) * pa + b * (3.0 - b * b) * pb + c * (3.0 - c * c) * pc) / 6.0 +
         (a * b * (zab - c) + b * c * (zbc - a) + c * a * (zca - b)) / 3.0;
}

double cpl_corner_part(double a, double b, double c) {
  if (a >= 1.0 || b >= 1.0 || c >= 1.0)
    return 0.0;
  if (a <= -1.0)
    return cpl_edge_part(b, c);
  if (b <= -1.0)
    return cpl_edge_part(c, a);
  if (c <= -1.0)
    return cpl_edge_part(a, b);
  if (a * a + b * b + c * c < 1.0)
    return corner_inside(a, b, c);
  if (a < 0.0) /* mirror until the part beyond the corner is empty */
    return cpl_edge_part(b, c) - cpl_corner_part(-a, b, c);
  if (b < 0.0)
    return cpl_edge_part(a, c) - cpl_corner_part(a, -b, c);
  return c < 0.0 ? cpl_edge_part(a, b) - cpl_corner_part(a, b, -c) : 0.0;
}

double cpl_box_ball(const double lo[3], const double hi[3]) {
  double v = 0.0;
  for (int i = 0; i < 8; i++) {
    const double x[3] = {i & 1 ? hi[0] : lo[0], i & 2 ? hi[1] : lo[1], i & 4 ? hi[2] : lo[2]};
    const double part = cpl_corner_part(x[0], x[1], x[2]);
    v += ((i ^ i >> 1 ^ i >> 2) & 1) ? -part : part;
  }
  return v > 0.0 ? v : 0.0;
}
