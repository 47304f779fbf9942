/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A ball over a tensor grid: the planes cut it into boxes that share their corners and edges.
 * Everything is in radii relative to the centre. Formulas: box_sphere.c. */
#include "tensor_overlap.h"
#include "box_sphere.h"

#include <math.h>
#include <stdlib.h>

static const double pi = 3.14159265358979323846;
static const double ball = 4.18879020478639098; /* 4 pi / 3 */

/* What two crossing planes a, b share with every corner on their line: half the length of the line
 * in the ball, half the arcs on either plane, the exterior angle. */
typedef struct {
  double part, z, on_a, on_b, exterior; /* part: volume { x > a, y > b } */
} crossing;

static void cross_planes(double a, double b, crossing *e) {
  const double z2 = 1.0 - a * a - b * b;
  if (!(z2 > 0.0)) {
    e->part = cpl_edge_part(a, b);
    e->z = e->on_a = e->on_b = e->exterior = 0.0;
    return;
  }
  e->z = sqrt(z2);
  e->on_a = atan2(e->z, b);
  e->on_b = atan2(e->z, a);
  e->exterior = atan2(e->z, -a * b);
  e->part = (2.0 * (pi - e->exterior) - a * (3.0 - a * a) * e->on_a - b * (3.0 - b * b) * e->on_b +
             2.0 * a * b * e->z) /
            3.0;
}

/* Corner inside the ball; ab crosses a (its on_a) and b (its on_b), and so on. */
static double corner_inside(double a, double b, double c, const crossing *ab, const crossing *bc,
                            const crossing *ca) {
  const double pa = ab->on_a + ca->on_b - 0.5 * pi, pb = bc->on_a + ab->on_b - 0.5 * pi,
               pc = ca->on_a + bc->on_b - 0.5 * pi;
  return (2.0 * pi - ab->exterior - bc->exterior - ca->exterior) / 3.0 -
         (a * (3.0 - a * a) * pa + b * (3.0 - b * b) * pb + c * (3.0 - c * c) * pc) / 6.0 +
         (a * b * (ab->z - c) + b * c * (bc->z - a) + c * a * (ca->z - b)) / 3.0;
}

static int cell_at(const cpl_tensor *t, const int i[3]) {
  for (int d = 0; d < 3; d++)
    if (i[d] < 0 || i[d] >= t->n[d])
      return -1;
  return t->cell[(size_t)i[0] + (size_t)t->n[0] * ((size_t)i[1] + (size_t)t->n[1] * (size_t)i[2])];
}

/* ---- at most one plane in each direction: up to eight parts -----------------------------------
 */

/* p: the planes; 2 where there is none. first: slabs below them. Mirrored so that a, b, c >= 0. */
static int split_in_eight(const cpl_tensor *t, const double p[3], const int first[3], double scale,
                          cpl_overlaps *list) {
  const double a = fabs(p[0]), b = fabs(p[1]), c = fabs(p[2]);
  double cap[3] = {cpl_cap(a), cpl_cap(b), cpl_cap(c)}, part[8];
  crossing ab = {0}, bc = {0}, ca = {0};
  double corner = 0.0;
  if (a * a + b * b < 1.0)
    cross_planes(a, b, &ab);
  if (b * b + c * c < 1.0)
    cross_planes(b, c, &bc);
  if (c * c + a * a < 1.0)
    cross_planes(c, a, &ca);
  if (a * a + b * b + c * c < 1.0)
    corner = corner_inside(a, b, c, &ab, &bc, &ca);
  part[0] = ball - cap[0] - cap[1] - cap[2] + ab.part + bc.part + ca.part - corner;
  part[1] = cap[0] - ab.part - ca.part + corner;
  part[2] = cap[1] - ab.part - bc.part + corner;
  part[4] = cap[2] - bc.part - ca.part + corner;
  part[3] = ab.part - corner;
  part[6] = bc.part - corner;
  part[5] = ca.part - corner;
  part[7] = corner;
  for (int q = 0; q < 8; q++) {
    int at[3];
    if (!(part[q] > 0.0))
      continue;
    for (int d = 0; d < 3; d++) /* bit d: beyond the plane, away from the centre */
      at[d] = first[d] + (p[d] < 1.0 && (q >> d & 1) == (p[d] >= 0.0));
    const int cell = cell_at(t, at);
    if (cell >= 0)
      PART_TRY(cpl_overlaps_add(list, cell, part[q] * scale));
  }
  return PART_OK;
}

/* ---- any number of planes ---------------------------------------------------------------------
 */

/* Index 0 of each direction stands for a plane at -infinity, 1 .. m for the planes cut. */
typedef struct {
  int m[3];
  double *p[3];           /* [m + 1], p[0] unused */
  double *cap[3];         /* [m + 1] */
  double *near2, *far2;   /* [m0 + m1 + m2 + 3] distances^2 of the slabs */
  double *volume;         /* [m2 + 1][m1 + 1][m0 + 1] */
  crossing *ab, *bc, *ca; /* [m0][m1], [m1][m2], [m2][m0], planes 1 .. m */
} tables;

static int make_room(cpl_tensor *t, const int m[3], tables *k) {
  const size_t a = (size_t)m[0] + 1, b = (size_t)m[1] + 1, c = (size_t)m[2] + 1;
  const size_t cross = sizeof(crossing) / sizeof(double);
  const size_t need = 4 * (a + b + c) + a * b * c + cross * (a * b + b * c + c * a);
  if (need > t->work_size) {
    double *grown = realloc(t->work, need * sizeof *grown);
    if (grown == NULL)
      return part_fail(PART_ERR_MEMORY, "overlap: no memory for %d x %d x %d planes", m[0], m[1],
                       m[2]);
    t->work = grown;
    t->work_size = need;
  }
  double *w = t->work;
  for (int d = 0; d < 3; d++) {
    k->m[d] = m[d];
    k->p[d] = w;
    k->cap[d] = w + m[d] + 1;
    w += 2 * (m[d] + 1);
  }
  k->near2 = w;
  k->far2 = w + a + b + c;
  k->volume = k->far2 + a + b + c;
  k->ab = (crossing *)(k->volume + a * b * c);
  k->bc = k->ab + a * b;
  k->ca = k->bc + b * c;
  return PART_OK;
}

/* Volume beyond the corner i, j, k. */
static double beyond(const tables *t, int i, int j, int k) {
  const crossing *ab = &t->ab[i * (t->m[1] + 1) + j], *bc = &t->bc[j * (t->m[2] + 1) + k],
                 *ca = &t->ca[k * (t->m[0] + 1) + i];
  if (i == 0) /* cap[0] is the ball */
    return j == 0 ? t->cap[2][k] : k == 0 ? t->cap[1][j] : bc->part;
  if (j == 0)
    return k == 0 ? t->cap[0][i] : ca->part;
  if (k == 0)
    return ab->part;
  const double a = t->p[0][i], b = t->p[1][j], c = t->p[2][k];
  if (a * a + b * b + c * c < 1.0)
    return corner_inside(a, b, c, ab, bc, ca);
  /* the corner is outside the ball: the parts on its far sides do not all meet */
  const int negative = (a < 0.0) + (b < 0.0) + (c < 0.0);
  if (negative == 0)
    return 0.0;
  if (negative == 1)
    return a < 0.0 ? bc->part : b < 0.0 ? ca->part : ab->part;
  if (negative == 2)
    return a >= 0.0   ? ab->part + ca->part - t->cap[0][i]
           : b >= 0.0 ? ab->part + bc->part - t->cap[1][j]
                      : ca->part + bc->part - t->cap[2][k];
  return ball - t->cap[0][i] - t->cap[1][j] - t->cap[2][k] + ab->part + bc->part + ca->part;
}

static void fill_tables(tables *t) {
  const int *m = t->m;
  double *near2 = t->near2, *far2 = t->far2;
  for (int d = 0; d < 3; d++) {
    t->cap[d][0] = ball;
    for (int i = 1; i <= m[d]; i++)
      t->cap[d][i] = cpl_cap(t->p[d][i]);
    for (int i = 0; i <= m[d]; i++) {
      const double lo = i > 0 ? t->p[d][i] : -2.0, hi = i < m[d] ? t->p[d][i + 1] : 2.0;
      const double gap = lo > 0.0 ? lo : hi < 0.0 ? hi : 0.0;
      *near2++ = gap * gap;
      *far2++ = fmax(lo * lo, hi * hi);
    }
  }
  for (int i = 1; i <= m[0]; i++)
    for (int j = 1; j <= m[1]; j++)
      cross_planes(t->p[0][i], t->p[1][j], &t->ab[i * (m[1] + 1) + j]);
  for (int j = 1; j <= m[1]; j++)
    for (int k = 1; k <= m[2]; k++)
      cross_planes(t->p[1][j], t->p[2][k], &t->bc[j * (m[2] + 1) + k]);
  for (int k = 1; k <= m[2]; k++)
    for (int i = 1; i <= m[0]; i++)
      cross_planes(t->p[2][k], t->p[0][i], &t->ca[k * (m[0] + 1) + i]);
}

/* Volumes between the planes: differences of what is beyond the corners. */
static void difference(tables *t) {
  const int a = t->m[0] + 1, b = t->m[1] + 1, c = t->m[2] + 1;
  double *v = t->volume;
  for (int k = 0; k < c; k++)
    for (int j = 0; j < b; j++)
      for (int i = 0; i < a; i++)
        v[i + a * (j + b * k)] = beyond(t, i, j, k);
  for (int q = 0; q < a * b * c; q++)
    v[q] -= q % a + 1 < a ? v[q + 1] : 0.0;
  for (int q = 0; q < a * b * c; q++)
    v[q] -= q / a % b + 1 < b ? v[q + a] : 0.0;
  for (int q = 0; q + a * b < a * b * c; q++)
    v[q] -= v[q + a * b];
}

static int split_in_many(const cpl_tensor *t, const double *cell_volume, tables *k,
                         const int first[3], double scale, cpl_overlaps *list) {
  const int a = k->m[0] + 1, b = k->m[1] + 1, c = k->m[2] + 1;
  fill_tables(k);
  difference(k);
  for (int q = 0; q < a * b * c; q++) {
    const int i[3] = {q % a, q / a % b, q / (a * b)};
    const int at[3] = {first[0] + i[0], first[1] + i[1], first[2] + i[2]};
    const double near2 = k->near2[i[0]] + k->near2[a + i[1]] + k->near2[a + b + i[2]];
    const double far2 = k->far2[i[0]] + k->far2[a + i[1]] + k->far2[a + b + i[2]];
    const int cell = near2 < 1.0 ? cell_at(t, at) : -1;
    if (cell < 0)
      continue;
    const double v = far2 <= 1.0 ? cell_volume[cell] : k->volume[q] * scale;
    if (v > 0.0)
      PART_TRY(cpl_overlaps_add(list, cell, v));
  }
  return PART_OK;
}

int cpl_tensor_overlap(cpl_tensor *t, const double *cell_volume, const double centre[3],
                       double radius, cpl_overlaps *list) {
  int first[3], m[3], most = 0;
  double p[3];
  for (int d = 0; d < 3; d++) {
    first[d] = cpl_tensor_slab(t, d, centre[d] - radius);
    m[d] = cpl_tensor_slab(t, d, centre[d] + radius) - first[d];
    most = m[d] > most ? m[d] : most;
    p[d] = m[d] > 0 ? (t->x[d][first[d] + 1] - centre[d]) / radius : 2.0;
  }
  const double scale = radius * radius * radius;
  if (most == 0) {
    const int cell = cell_at(t, first);
    return cell < 0 ? PART_OK : cpl_overlaps_add(list, cell, ball * scale);
  }
  if (most == 1)
    return split_in_eight(t, p, first, scale, list);
  tables k = {.m = {0}};
  PART_TRY(make_room(t, m, &k));
  for (int d = 0; d < 3; d++)
    for (int i = 1; i <= m[d]; i++)
      k.p[d][i] = (t->x[d][first[d] + i] - centre[d]) / radius;
  return split_in_many(t, cell_volume, &k, first, scale, list);
}
