/* SPDX-License-Identifier: GPL-3.0-or-later */
/* See polyhedron_sphere.h. atan2 everywhere: acos and asin lose half the digits at tangency. */
#include "polyhedron_sphere.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

static inline double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void cross(const double a[3], const double b[3], double c[3]) {
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

void cpl_edge_set(const double v1[3], double r1, const double v2[3], double r2, cpl_edge *e) {
  const double u[3] = {v2[0] - v1[0], v2[1] - v1[1], v2[2] - v1[2]};
  const double length2 = dot(u, u);
  if (!(length2 > 0.0)) {
    *e = (cpl_edge){.r1 = r1, .r2 = r2, .ra = r1, .rb = r1};
    return;
  }
  const double inverse = 1.0 / sqrt(length2);
  const double t[3] = {u[0] * inverse, u[1] * inverse, u[2] * inverse};
  cross(v1, t, e->m);
  e->m2 = dot(e->m, e->m);
  e->s1 = dot(v1, t);
  e->s2 = dot(v2, t);
  e->r1 = r1;
  e->r2 = r2;
  e->a = e->b = e->s2;
  e->ra = e->rb = r2;
  const double s02 = 1.0 - e->m2;
  if (s02 > 0.0) {
    const double s0 = sqrt(s02);
    const double a = e->s1 > -s0 ? e->s1 : -s0, b = e->s2 < s0 ? e->s2 : s0;
    if (a < b) {
      e->a = a;
      e->b = b;
      e->ra = e->s1 > -s0 ? r1 : 1.0;
      e->rb = e->s2 < s0 ? r2 : 1.0;
    }
  }
}

/* An angle as a product of complex numbers, turns counted: one atan2 for a whole polygon. */
typedef struct {
  double re, im;
  int turns; /* crossings of the negative real axis */
} angle;

static inline void turn(angle *p, double re, double im) {
  const double x = p->re * re - p->im * im, y = p->re * im + p->im * re;
  if (im > 0.0) /* each factor turns by less than pi, in the direction of its im */
    p->turns += p->im >= 0.0 && y < 0.0;
  else if (im < 0.0)
    p->turns -= p->im < 0.0 && y >= 0.0;
  else if (re < 0.0) /* exactly half a turn: as the limit im -> +0 */
    p->turns += p->im >= 0.0 && y < 0.0;
  p->re = x;
  p->im = y;
  const double size = x * x + y * y;
  if (size > 1e100 || (size < 1e-100 && size > 0.0)) {
    const double scale = 1.0 / sqrt(size);
    p->re *= scale;
    p->im *= scale;
  }
}

static inline double angle_value(const angle *p) {
  return atan2(p->im + 0.0, p->re) + 2.0 * pi * p->turns; /* + 0.0: -0 belongs to the upper half */
}

typedef struct {
  angle theta, omega;
  double s;
  int outside, inside;
} sums;

/* theta of the outside piece [x, y]: angle seen from the foot of the plane. */
static inline void add_outside(sums *k, double d, double sign, double x, double y) {
  if (y > x) {
    turn(&k->theta, d * d + x * y, sign * d * (y - x));
    k->outside = 1;
  }
}

/* Om(b) - Om(a), Om(s) = atan2(s d, m2 + eta Dist(s)): solid angle of right triangles. */
static inline void add_inside(sums *k, const cpl_edge *e, double d, double sign, double eta) {
  const double xa = e->m2 + eta * e->ra, ya = e->a * d;
  const double xb = e->m2 + eta * e->rb, yb = e->b * d;
  turn(&k->omega, xb * xa + yb * ya, sign * (yb * xa - xb * ya));
  k->s += sign * d * (e->b - e->a);
  k->inside = 1;
}

double cpl_polygon_deficit(int edges, const cpl_polygon_edge *edge, const double n[3], double h,
                           int *met) {
  const double eta = fabs(h), r2 = 1.0 - h * h;
  double d[CPL_POLYGON_MAX];
  *met = 0;
  if (!(r2 > 0.0))
    return 0.0;
  int covered = 1; /* the polygon covers the whole disc */
  for (int i = 0; i < edges; i++) {
    d[i] = dot(n, edge[i].edge->m);
    const double inner = edge[i].sign * d[i], d2 = inner * inner;
    if (d2 >= r2 && inner < 0.0)
      return 0.0;
    covered = covered && d2 >= r2;
  }
  const double cap = (1.0 - eta) * (1.0 - eta) * (2.0 + eta);
  if (covered) {
    *met = 1;
    return copysign(cap * pi / 3.0, h);
  }
  sums k = {.theta = {1.0, 0.0, 0}, .omega = {1.0, 0.0, 0}};
  for (int i = 0; i < edges; i++) {
    const cpl_edge *e = edge[i].edge;
    add_outside(&k, d[i], edge[i].sign, e->s1, e->a);
    if (e->a < e->b) {
      add_inside(&k, e, d[i], edge[i].sign, eta);
      add_outside(&k, d[i], edge[i].sign, e->b, e->s2);
    }
  }
  double v = -eta * k.s / 6.0;
  if (k.inside)
    v += angle_value(&k.omega) / 3.0;
  if (k.outside)
    v += angle_value(&k.theta) * cap / 6.0;
  *met = v != 0.0;
  return copysign(1.0, h) * v;
}

static double flux_outside(double h, double d, double x, double dx, double y, double dy) {
  return atan2(h * d * (y * dx - x * dy), d * d * dx * dy + h * h * x * y);
}

double cpl_polygon_flux(int edges, const cpl_polygon_edge *edge, const double n[3], double h,
                        double solid_angle) {
  if (fabs(h) >= 1.0)
    return solid_angle / 3.0;
  double theta = 0.0, s = 0.0, b = 0.0;
  for (int i = 0; i < edges; i++) {
    const cpl_edge *e = edge[i].edge;
    const double d = dot(n, e->m), sign = edge[i].sign;
    if (e->a > e->s1) {
      theta += sign * atan2(d * (e->a - e->s1), d * d + e->s1 * e->a);
      b += sign * flux_outside(h, d, e->s1, e->r1, e->a, e->ra);
    }
    if (e->a < e->b) {
      s += sign * d * (e->b - e->a);
      if (e->s2 > e->b) {
        theta += sign * atan2(d * (e->s2 - e->b), d * d + e->s2 * e->b);
        b += sign * flux_outside(h, d, e->b, e->rb, e->s2, e->r2);
      }
    }
  }
  return h * s / 6.0 + h * (3.0 - h * h) / 6.0 * theta - b / 3.0;
}

double cpl_solid_angle(const double a[3], const double b[3], const double c[3]) {
  double bc[3];
  cross(b, c, bc);
  const double ra = sqrt(dot(a, a)), rb = sqrt(dot(b, b)), rc = sqrt(dot(c, c));
  return 2.0 * atan2(dot(a, bc), ra * rb * rc + dot(a, b) * rc + dot(a, c) * rb + dot(b, c) * ra);
}
