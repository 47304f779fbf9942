/* SPDX-License-Identifier: GPL-3.0-or-later */
/* See ball_reference.h. */
#include "ball_reference.h"

#include <math.h>
#include <stdlib.h>

typedef long double real;
typedef struct {
  real x[3][3];
} triangle;

static real dot(const real a[3], const real b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const real a[3], const real b[3], real c[3]) {
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

static void subtract(const real a[3], const real b[3], real c[3]) {
  for (int d = 0; d < 3; d++)
    c[d] = a[d] - b[d];
}

static int count_corners(const cpl_mesh *m, int f) {
  return m->face_start[f + 1] - m->face_start[f];
}

static void *allocate(size_t count, size_t size) {
  void *p = calloc(count + 1, size);
  if (p == NULL)
    abort();
  return p;
}

void ball_cells_create(const cpl_mesh *m, ball_cells *b) {
  b->mesh = m;
  b->start = allocate((size_t)m->cells + 1, sizeof *b->start);
  b->face = allocate((size_t)m->faces + (size_t)m->internal, sizeof *b->face);
  b->reach = allocate((size_t)m->cells, sizeof *b->reach);
  for (int f = 0; f < m->faces + m->internal; f++)
    b->start[1 + (f < m->faces ? m->owner[f] : m->neighbour[f - m->faces])]++;
  for (int c = 0; c < m->cells; c++)
    b->start[c + 1] += b->start[c];
  int *at = allocate((size_t)m->cells, sizeof *at);
  for (int f = 0; f < m->faces + m->internal; f++) {
    const int real_face = f < m->faces ? f : f - m->faces;
    const int c = f < m->faces ? m->owner[f] : m->neighbour[real_face];
    b->face[b->start[c] + at[c]++] = f < m->faces ? f : ~real_face;
    for (int i = 0; i < count_corners(m, real_face); i++) {
      const double *x = m->point + 3 * m->face_point[m->face_start[real_face] + i];
      const double *y = m->cell_centre + 3 * c;
      b->reach[c] = fmax(b->reach[c], hypot(hypot(x[0] - y[0], x[1] - y[1]), x[2] - y[2]));
    }
  }
  free(at);
}

void ball_cells_free(ball_cells *b) {
  free(b->start);
  free(b->face);
  free(b->reach);
}

int ball_may_touch(const ball_cells *b, int cell, const double x[3], double radius) {
  const double *y = b->mesh->cell_centre + 3 * cell;
  return hypot(hypot(x[0] - y[0], x[1] - y[1]), x[2] - y[2]) <= 1.001 * (radius + b->reach[cell]);
}

/* Surface of a cell, outward, in radii relative to the centre. Caller frees. */
static triangle *surface(const ball_cells *b, int cell, const double centre[3], double radius,
                         int *count) {
  const cpl_mesh *m = b->mesh;
  int corners = 0;
  *count = 0;
  for (int k = b->start[cell]; k < b->start[cell + 1]; k++)
    corners += count_corners(m, b->face[k] < 0 ? ~b->face[k] : b->face[k]);
  triangle *t = allocate((size_t)corners, sizeof *t);
  for (int k = b->start[cell]; k < b->start[cell + 1]; k++) {
    const int own = b->face[k] >= 0, f = own ? b->face[k] : ~b->face[k];
    const int *p = m->face_point + m->face_start[f], n = count_corners(m, f);
    for (int i = 0; i < n; i++, (*count)++) {
      const double *v[3] = {m->face_centre + 3 * f, m->point + 3 * p[own ? i : (i + 1) % n],
                            m->point + 3 * p[own ? (i + 1) % n : i]};
      for (int q = 0; q < 9; q++)
        t[*count].x[q / 3][q % 3] = ((real)v[q / 3][q % 3] - centre[q % 3]) / radius;
    }
  }
  return t;
}

/* ---- by edges -------------------------------------------------------------------------------- */

/* int dtheta int min(1, (h^2+q^2)^(-3/2)) q dq over the triangle foot, p(s1), p(s2), with p(s) at
 * distance d from the foot. The inner integral is q^2/2 inside the circle of radius r and
 * r^2/2 + 1 - (h^2+q^2)^(-1/2) outside (1/|h| - ... when the ball does not reach the plane). */
static real edge_integral(real h, real d, real s1, real s2) {
  if (d == 0.0L)
    return 0.0L;
  const real ad = fabsl(d), ah = fabsl(h), r2 = 1.0L - h * h, s02 = r2 - d * d;
  const real constant = r2 > 0.0L ? 0.5L * r2 + 1.0L : 1.0L / ah;
  const real s0 = s02 > 0.0L && r2 > 0.0L ? sqrtl(s02) : 0.0L;
  const real cut[4] = {s1, fminl(fmaxl(-s0, s1), s2), fmaxl(fminl(s0, s2), s1), s2};
  real sum = 0.0L;
  for (int i = 0; i < 3; i++) {
    const real x = cut[i], y = cut[i + 1];
    if (!(y > x))
      continue;
    if (i == 1 && s0 > 0.0L) {
      sum += 0.5L * ad * (y - x);
    } else {
      const real dx = sqrtl(h * h + d * d + x * x), dy = sqrtl(h * h + d * d + y * y);
      const real beta = atan2l(ah * y, ad * dy) - atan2l(ah * x, ad * dx);
      sum += constant * (atan2l(y, ad) - atan2l(x, ad)) - beta / ah;
    }
  }
  return d > 0.0L ? sum : -sum;
}

static real triangle_integral(const triangle *t) {
  real u[3], v[3], n[3];
  subtract(t->x[1], t->x[0], u);
  subtract(t->x[2], t->x[0], v);
  cross(u, v, n);
  const real size = sqrtl(dot(n, n));
  if (size == 0.0L)
    return 0.0L;
  for (int d = 0; d < 3; d++)
    n[d] /= size;
  const real h = dot(n, t->x[0]);
  if (h == 0.0L)
    return 0.0L;
  real sum = 0.0L;
  for (int i = 0; i < 3; i++) {
    real e[3], m[3];
    const real *a = t->x[i], *b = t->x[(i + 1) % 3];
    subtract(b, a, e);
    const real length = sqrtl(dot(e, e));
    if (length == 0.0L)
      continue;
    for (int d = 0; d < 3; d++)
      e[d] /= length;
    cross(a, e, m);
    sum += edge_integral(h, dot(n, m), dot(a, e), dot(b, e));
  }
  return h / 3.0L * sum;
}

long double ball_by_edges(const ball_cells *cells, int cell, const double centre[3],
                          double radius) {
  int count;
  triangle *t = surface(cells, cell, centre, radius, &count);
  real sum = 0.0L;
  for (int i = 0; i < count; i++)
    sum += triangle_integral(&t[i]);
  free(t);
  return sum;
}

/* ---- by slices ------------------------------------------------------------------------------- */

/* Signed area of the triangle origin, p, q inside the disc of radius r (2-D). */
static real disc_part(const real p[2], const real q[2], real r) {
  const real u[2] = {q[0] - p[0], q[1] - p[1]}, length = hypotl(u[0], u[1]);
  if (length == 0.0L)
    return 0.0L;
  const real d = (p[0] * u[1] - p[1] * u[0]) / length; /* distance of the line, signed */
  const real s1 = (p[0] * u[0] + p[1] * u[1]) / length, s2 = s1 + length;
  const real s02 = r * r - d * d, s0 = s02 > 0.0L ? sqrtl(s02) : 0.0L;
  const real a = fminl(fmaxl(-s0, s1), s2), b = fmaxl(fminl(s0, s2), s1), ad = fabsl(d);
  const real sector = atan2l(a, ad) - atan2l(s1, ad) + atan2l(s2, ad) - atan2l(b, ad);
  const real area = 0.5L * ad * (b - a) + 0.5L * r * r * sector;
  return d > 0.0L ? area : d < 0.0L ? -area : 0.0L;
}

static real slice_area(const triangle *t, int count, real z) {
  real sum = 0.0L;
  for (int k = 0; k < count; k++) {
    real p[2][2]; /* where the boundary of the triangle goes up through z, and down */
    int found = 0;
    for (int i = 0; i < 3; i++) {
      const real *a = t[k].x[i], *b = t[k].x[(i + 1) % 3];
      const int up = a[2] <= z && b[2] > z, down = a[2] > z && b[2] <= z;
      if (!up && !down)
        continue;
      const real w = (z - a[2]) / (b[2] - a[2]);
      for (int d = 0; d < 2; d++)
        p[up ? 0 : 1][d] = a[d] + w * (b[d] - a[d]);
      found++;
    }
    if (found == 2) /* an outward triangle has the inside on the left going down to up */
      sum += disc_part(p[1], p[0], sqrtl(1.0L - z * z));
  }
  return sum;
}

static real tanh_sinh(const triangle *t, int count, real lo, real hi) {
  const real half = 0.5L * (hi - lo), step = 0.125L;
  real sum = 0.0L;
  for (int k = -30; k <= 30; k++) {
    const real s = 1.5707963267948966192L * sinhl(step * k), c = coshl(s);
    const real weight = 1.5707963267948966192L * coshl(step * k) / (c * c);
    const real from_end = half * expl(-fabsl(s)) / c; /* distance to the nearer end */
    const real z = k < 0 ? lo + from_end : hi - from_end;
    if (z > lo && z < hi)
      sum += weight * slice_area(t, count, z);
  }
  return sum * half * step;
}

static int compare(const void *a, const void *b) {
  const real x = *(const real *)a, y = *(const real *)b;
  return (x > y) - (x < y);
}

/* Heights of triangle t where the slice is not smooth: corners, edges through the sphere, top and
 * bottom of the circle in its plane. Returns their number, <= 15. */
static int kinks(const triangle *t, real *z) {
  int n = 0;
  real u[3], v[3], m[3];
  for (int i = 0; i < 3; i++) {
    const real *a = t->x[i], *b = t->x[(i + 1) % 3];
    z[n++] = a[2];
    subtract(b, a, u);
    const real A = dot(u, u), B = dot(a, u), q = B * B - A * (dot(a, a) - 1.0L);
    for (int side = -1; side <= 1 && q > 0.0L && A > 0.0L; side += 2) {
      const real w = (-B + (real)side * sqrtl(q)) / A;
      if (w > 0.0L && w < 1.0L)
        z[n++] = a[2] + w * u[2];
    }
  }
  subtract(t->x[1], t->x[0], u);
  subtract(t->x[2], t->x[0], v);
  cross(u, v, m);
  const real size = sqrtl(dot(m, m)), h = size > 0.0L ? dot(m, t->x[0]) / size : 2.0L;
  if (fabsl(h) < 1.0L) {
    const real nz = m[2] / size, r = sqrtl((1.0L - h * h) * fmaxl(0.0L, 1.0L - nz * nz));
    z[n++] = h * nz - r;
    z[n++] = h * nz + r;
  }
  return n;
}

long double ball_by_slices(const ball_cells *cells, int cell, const double centre[3],
                           double radius) {
  int count, n = 2;
  triangle *t = surface(cells, cell, centre, radius, &count);
  real *z = malloc((size_t)(15 * count + 2) * sizeof *z), sum = 0.0L;
  if (z == NULL)
    abort();
  z[0] = -1.0L;
  z[1] = 1.0L;
  for (int i = 0; i < count; i++)
    n += kinks(&t[i], z + n);
  qsort(z, (size_t)n, sizeof *z, compare);
  for (int i = 0; i + 1 < n; i++)
    if (z[i] >= -1.0L && z[i + 1] <= 1.0L && z[i + 1] - z[i] > 1e-18L)
      sum += tanh_sinh(t, count, z[i], z[i + 1]);
  free(z);
  free(t);
  return sum;
}

long double ball_winding(const ball_cells *cells, int cell, const double x[3]) {
  int count;
  triangle *t = surface(cells, cell, x, 1.0, &count);
  real sum = 0.0L;
  for (int i = 0; i < count; i++) {
    const real *a = t[i].x[0], *b = t[i].x[1], *c = t[i].x[2];
    real bc[3];
    cross(b, c, bc);
    const real ra = sqrtl(dot(a, a)), rb = sqrtl(dot(b, b)), rc = sqrtl(dot(c, c));
    sum +=
        2.0L * atan2l(dot(a, bc), ra * rb * rc + dot(a, b) * rc + dot(a, c) * rb + dot(b, c) * ra);
  }
  free(t);
  return sum / 12.566370614359172953850573533118L;
}
