/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sub-cells (Markauskas et al. 2017, section 3.1): a cell is divided into n^3 parts and a part
 * belongs to the sphere when its centre does. Instead of testing all of them, each row of sub-cells
 * along the first direction is cut by the sphere in one interval; its ends are then checked with
 * the plain test, so the marks are those of testing every centre.
 *
 * Boxes and hexahedra: equal parts of the cell's trilinear coordinates. Other cells: the parts of
 * an n^3 grid over the cell's bound whose centres are in the cell. The volumes add up to about that
 * of the sphere only, and a sphere that holds no centre gets none. */
#include "overlap_methods.h"
#include "sub_cell.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#ifdef __clang__ /* the test of one centre must round the same wherever it is compiled */
#pragma STDC FP_CONTRACT OFF
#endif

typedef struct {
  cpl_search *s;
  int n;
  const double *centre;
  double radius2, radius;
  unsigned char *mark; /* NULL: only volumes */
  double *square;      /* [2 n] scratch */
} sub_cells;

static void mark_span(const sub_cells *q, int j, int k, int lo, int hi) {
  if (q->mark != NULL)
    memset(q->mark + (size_t)lo + (size_t)q->n * ((size_t)j + (size_t)q->n * (size_t)k), 1,
           (size_t)(hi - lo + 1));
}

static int clip(double t, int low, int high) { /* towards an index, NaN to low */
  return t > low ? (t < high ? (int)t : high) : low;
}

/* ---- grids over a box ------------------------------------------------------------------------ */

typedef struct {
  double lo[3], step[3], inverse;
} box_grid;

static double grid_centre(const box_grid *g, int d, int i) {
  return g->lo[d] + (i + 0.5) * g->step[d];
}

static box_grid grid_of(const cpl_search *s, int cell, int n) {
  box_grid g;
  for (int d = 0; d < 3; d++) {
    g.lo[d] = s->bound[cell][d];
    g.step[d] = (s->bound[cell][3 + d] - g.lo[d]) / n;
  }
  g.inverse = 1.0 / g.step[0];
  return g;
}

/* Rows or columns of the grid that the sphere can reach, one too many rather than too few. */
static void reach(const sub_cells *q, const box_grid *g, int d, int *from, int *to) {
  *from = clip((q->centre[d] - q->radius - g->lo[d]) / g->step[d] - 1.5, 0, q->n);
  *to = clip((q->centre[d] + q->radius - g->lo[d]) / g->step[d] + 0.5, -1, q->n - 1);
}

/* Indices of row with distance^2 from its line to the centre yz2 whose centres are inside. */
static int box_row(const sub_cells *q, const box_grid *g, double yz2, int *lo, int *hi) {
  const double w = sqrt(q->radius2 - yz2) * g->inverse;
  const double middle = (q->centre[0] - g->lo[0]) * g->inverse - 0.5;
#define INSIDE(i)                                                                                  \
  ((grid_centre(g, 0, i) - q->centre[0]) * (grid_centre(g, 0, i) - q->centre[0]) + yz2 < q->radius2)
  int a = clip(middle - w + 1.0, 0, q->n), b = clip(middle + w, -1, q->n - 1);
  while (a > 0 && INSIDE(a - 1))
    a--;
  while (a <= b && !INSIDE(a))
    a++;
  while (b + 1 < q->n && b + 1 >= a && INSIDE(b + 1))
    b++;
  while (b >= a && !INSIDE(b))
    b--;
#undef INSIDE
  *lo = a;
  *hi = b;
  return b - a + 1;
}

static int count_bits(const uint64_t *row, int lo, int hi) {
  int count = 0;
  for (int w = lo / 64; w <= hi / 64; w++) {
    uint64_t bits = row[w];
    if (w == lo / 64)
      bits &= ~(uint64_t)0 << (lo % 64);
    if (w == hi / 64)
      bits &= ~(uint64_t)0 >> (63 - hi % 64);
    count += __builtin_popcountll(bits);
  }
  return count;
}

static int polyhedron_span(const sub_cells *q, int j, int k, int lo, int hi) {
  const int n = q->n, words = (n + 63) / 64;
  const uint64_t *row = q->s->hexes->bits + ((size_t)j + (size_t)n * (size_t)k) * (size_t)words;
  for (int i = lo; i <= hi && q->mark != NULL; i++)
    if (row[i / 64] >> (i % 64) & 1)
      mark_span(q, j, k, i, i);
  return count_bits(row, lo, hi);
}

static int grid_volume(const sub_cells *q, int cell, double *volume) {
  const int n = q->n, box = q->s->is_box[cell];
  const box_grid g = grid_of(q->s, cell, n);
  int from[3], to[3];
  int64_t count = 0;
  for (int d = 0; d < 3; d++)
    reach(q, &g, d, &from[d], &to[d]);
  *volume = 0.0;
  if (from[0] > to[0] || from[1] > to[1] || from[2] > to[2])
    return PART_OK;
  if (!box)
    PART_TRY(cpl_polyhedron_rows(q->s, cell, n, from + 1, to + 1));
  for (int d = 1; d < 3; d++)
    for (int i = from[d]; i <= to[d]; i++) {
      const double x = grid_centre(&g, d, i) - q->centre[d];
      q->square[(d - 1) * n + i] = x * x;
    }
  for (int k = from[2]; k <= to[2]; k++)
    for (int j = from[1]; j <= to[1]; j++) {
      const double yz2 = q->square[j] + q->square[n + k];
      int lo, hi;
      if (!(yz2 < q->radius2) || box_row(q, &g, yz2, &lo, &hi) <= 0)
        continue;
      if (box)
        mark_span(q, j, k, lo, hi);
      count += box ? hi - lo + 1 : polyhedron_span(q, j, k, lo, hi);
    }
  *volume = (double)count * g.step[0] * g.step[1] * g.step[2];
  return PART_OK;
}

/* ---- hexahedra ------------------------------------------------------------------------------- */

/* Trilinear in the corners: x(xi, eta, zeta) = q00 + eta a1 + xi (b0 + eta b1) at one zeta, with q
 * on the four edges along zeta; their derivatives along zeta are the same at every zeta. */
typedef struct {
  double a[2][3], b[2][3];   /* at one zeta: constant, and factor of eta */
  double da[2][3], db[2][3]; /* derivatives along zeta */
} hex_slab;

typedef struct { /* at one eta and zeta: x = a + xi b */
  double a[3], b[3];
} hex_row;

static void hex_slab_set(const cpl_search *s, const int corner[8], int n, int k, hex_slab *h) {
  const double zeta = (k + 0.5) / n;
  for (int d = 0; d < 3; d++) {
    double q[4], dq[4];
    for (int i = 0; i < 4; i++) {
      const double low = s->mesh->point[3 * corner[i] + d];
      dq[i] = s->mesh->point[3 * corner[4 + i] + d] - low;
      q[i] = low + zeta * dq[i];
    }
    h->a[0][d] = q[0];
    h->a[1][d] = q[2] - q[0];
    h->b[0][d] = q[1] - q[0];
    h->b[1][d] = (q[3] - q[2]) - (q[1] - q[0]);
    h->da[0][d] = dq[0];
    h->da[1][d] = dq[2] - dq[0];
    h->db[0][d] = dq[1] - dq[0];
    h->db[1][d] = (dq[3] - dq[2]) - (dq[1] - dq[0]);
  }
}

static hex_row hex_row_of(const hex_slab *h, int n, int j) {
  const double eta = (j + 0.5) / n;
  hex_row r;
  for (int d = 0; d < 3; d++) {
    r.a[d] = h->a[0][d] + eta * h->a[1][d];
    r.b[d] = h->b[0][d] + eta * h->b[1][d];
  }
  return r;
}

static void hex_point(const hex_row *r, int n, int i, double x[3]) {
  const double xi = (i + 0.5) / n;
  for (int d = 0; d < 3; d++)
    x[d] = r->a[d] + xi * r->b[d];
}

static int hex_inside(const sub_cells *q, const hex_row *r, int i) {
  double x[3];
  hex_point(r, q->n, i, x);
  const double dx = x[0] - q->centre[0], dy = x[1] - q->centre[1], dz = x[2] - q->centre[2];
  return dx * dx + (dy * dy + dz * dz) < q->radius2;
}

static int hex_span(const sub_cells *q, const hex_row *r, int *lo, int *hi) {
  double bb = 0.0, bc = 0.0, cc = 0.0;
  for (int d = 0; d < 3; d++) {
    const double c = q->centre[d] - r->a[d];
    bb += r->b[d] * r->b[d];
    bc += r->b[d] * c;
    cc += c * c;
  }
  const double root2 = bc * bc - bb * (cc - q->radius2), slack = 1e-12 * bb * (cc + q->radius2);
  if (!(bb > 0.0) || root2 < -slack)
    return 0;
  const double w = sqrt(root2 > 0.0 ? root2 : 0.0);
  int a = clip((bc - w) / bb * q->n + 0.5, 0, q->n);
  int b = clip((bc + w) / bb * q->n - 0.5, -1, q->n - 1);
  while (a > 0 && hex_inside(q, r, a - 1))
    a--;
  while (a <= b && !hex_inside(q, r, a))
    a++;
  while (b + 1 < q->n && b + 1 >= a && hex_inside(q, r, b + 1))
    b++;
  while (b >= a && !hex_inside(q, r, b))
    b--;
  *lo = a;
  *hi = b;
  return b - a + 1;
}

static double triple(const double a[3], const double b[3], const double c[3]) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
         a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/* Sum over i = lo .. hi of the Jacobian at xi_i = (i + 1/2)/n; it is quadratic in xi. */
static double jacobian_sum(const hex_slab *h, const hex_row *r, int n, int j, int lo, int hi) {
  const double eta = (j + 0.5) / n;
  double z0[3], z1[3]; /* derivative along zeta: z0 + xi z1; along eta: a[1] + xi b[1] */
  for (int d = 0; d < 3; d++) {
    z0[d] = h->da[0][d] + eta * h->da[1][d];
    z1[d] = h->db[0][d] + eta * h->db[1][d];
  }
  const double j0 = triple(r->b, h->a[1], z0), j2 = triple(r->b, h->b[1], z1);
  const double j1 = triple(r->b, h->a[1], z1) + triple(r->b, h->b[1], z0);
  const double count = hi - lo + 1, middle = (0.5 * (lo + hi) + 0.5) / n;
  const double spread = count * (count * count - 1.0) / (12.0 * n * n); /* sum (xi - middle)^2 */
  return count * (j0 + middle * (j1 + middle * j2)) + j2 * spread;
}

static void hex_volume(const sub_cells *q, int cell, double *volume) {
  const int n = q->n;
  double sum = 0.0;
  for (int k = 0; k < n; k++) {
    hex_slab h;
    hex_slab_set(q->s, q->s->hexes->corner[cell], n, k, &h);
    for (int j = 0; j < n; j++) {
      const hex_row r = hex_row_of(&h, n, j);
      int lo, hi;
      if (hex_span(q, &r, &lo, &hi) <= 0)
        continue;
      mark_span(q, j, k, lo, hi);
      sum += jacobian_sum(&h, &r, n, j, lo, hi);
    }
  }
  *volume = sum / ((double)n * n * n);
}

/* ---- public ---------------------------------------------------------------------------------- */

static int cell_volume(const sub_cells *q, int cell, double *volume) {
  if (q->s->is_box[cell] || q->s->hexes->corner[cell][0] < 0)
    return grid_volume(q, cell, volume);
  hex_volume(q, cell, volume);
  return PART_OK;
}

static int begin(sub_cells *q) {
  if (q->n < 1 || q->n > 4096)
    return part_fail(PART_ERR_RANGE, "subCell: %d sub-cells per edge, allowed 1 .. 4096", q->n);
  if (!(q->radius > 0.0 && q->radius < HUGE_VAL))
    return part_fail(PART_ERR_RANGE, "overlap: radius %g m is not in (0, inf)", q->radius);
  if (q->s->hexes == NULL)
    PART_TRY(cpl_hexes_create(q->s));
  if (q->s->hexes->squares < q->n) {
    free(q->s->hexes->square);
    q->s->hexes->square = malloc(2 * (size_t)q->n * sizeof(double));
    q->s->hexes->squares = q->s->hexes->square != NULL ? q->n : 0;
    if (q->s->hexes->square == NULL)
      return part_fail(PART_ERR_MEMORY, "subCell: no memory for a row of %d", q->n);
  }
  q->square = q->s->hexes->square;
  return PART_OK;
}

int cpl_sub_cell_marks(cpl_search *s, int n, int cell, const double centre[3], double radius,
                       unsigned char *mark) {
  double volume;
  sub_cells q = {s, n, centre, radius * radius, radius, mark, NULL};
  PART_TRY(begin(&q));
  memset(mark, 0, (size_t)n * (size_t)n * (size_t)n);
  return cell_volume(&q, cell, &volume);
}

int cpl_sub_cell_points(cpl_search *s, int n, int cell, double *point) {
  if (s->hexes == NULL)
    PART_TRY(cpl_hexes_create(s));
  const int hex = !s->is_box[cell] && s->hexes->corner[cell][0] >= 0;
  const box_grid g = grid_of(s, cell, n);
  for (int k = 0; k < n; k++) {
    hex_slab h;
    if (hex)
      hex_slab_set(s, s->hexes->corner[cell], n, k, &h);
    for (int j = 0; j < n; j++) {
      const hex_row r = hex ? hex_row_of(&h, n, j) : (hex_row){{0.0}, {0.0}};
      for (int i = 0; i < n; i++, point += 3) {
        const int index[3] = {i, j, k};
        if (hex)
          hex_point(&r, n, i, point);
        for (int d = 0; d < 3 && !hex; d++)
          point[d] = grid_centre(&g, d, index[d]);
      }
    }
  }
  return PART_OK;
}

int cpl_overlap_subCell(cpl_search *s, int n, const double centre[3], double radius, int *hint,
                        cpl_overlaps *list) {
  sub_cells q = {s, n, centre, radius * radius, radius, NULL, NULL};
  PART_TRY(begin(&q));
  int status = PART_OK;
  *hint = cpl_search_cell(s, centre, *hint);
  cpl_search_queue_touching(s, centre, radius, 0);
  for (int i = 0; i < s->queued && status == PART_OK; i++) {
    double volume;
    status = cell_volume(&q, s->queue[i], &volume);
    if (status == PART_OK && volume > 0.0)
      status = cpl_overlaps_add(list, s->queue[i], volume);
  }
  cpl_search_done(s);
  return status;
}
