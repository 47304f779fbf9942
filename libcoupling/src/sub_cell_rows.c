/* SPDX-License-Identifier: GPL-3.0-or-later */
/* See sub_cell.h. */
#include "sub_cell.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- corners of hexahedra -------------------------------------------------------------------- */

static int is_among(int p, const int *list, int n) {
  for (int i = 0; i < n; i++)
    if (list[i] == p)
      return 1;
  return 0;
}

/* The point joined to p by an edge of the cell that is not in the face `bottom`; -1: none. */
static int partner(const cpl_search *s, int cell, int p, const int bottom[4]) {
  const cpl_mesh *m = s->mesh;
  for (int k = s->cell_face_start[cell]; k < s->cell_face_start[cell + 1]; k++) {
    const int f = s->cell_face[k] < 0 ? ~s->cell_face[k] : s->cell_face[k];
    const int *v = m->face_point + m->face_start[f];
    for (int i = 0; i < 4; i++)
      for (int step = 1; step < 4 && v[i] == p; step += 2)
        if (!is_among(v[(i + step) % 4], bottom, 4))
          return v[(i + step) % 4];
  }
  return -1;
}

static void find_corners(const cpl_search *s, int cell, int corner[8]) {
  static const int place[4] = {0, 2, 3, 1}; /* the lower side, seen from outside */
  const cpl_mesh *m = s->mesh;
  const int first = s->cell_face_start[cell], count = s->cell_face_start[cell + 1] - first;
  corner[0] = -1;
  for (int k = first; k < first + count; k++) {
    const int f = s->cell_face[k] < 0 ? ~s->cell_face[k] : s->cell_face[k];
    if (count != 6 || m->face_start[f + 1] - m->face_start[f] != 4)
      return;
  }
  const int code = s->cell_face[first], f = code < 0 ? ~code : code;
  int bottom[4], found[8];
  for (int i = 0; i < 4; i++)
    bottom[i] = m->face_point[m->face_start[f] + (code < 0 ? (4 - i) % 4 : i)];
  for (int i = 0; i < 4; i++) {
    found[place[i]] = bottom[i];
    found[4 + place[i]] = partner(s, cell, bottom[i], bottom);
  }
  for (int i = 0; i < 8; i++)
    if (found[i] < 0 || is_among(found[i], found, i))
      return; /* six quadrilaterals, but not a hexahedron */
  memcpy(corner, found, sizeof found);
}

int cpl_hexes_create(cpl_search *s) {
  s->hexes = calloc(1, sizeof *s->hexes);
  if (s->hexes != NULL)
    s->hexes->corner = malloc(((size_t)s->mesh->cells + 1) * sizeof *s->hexes->corner);
  if (s->hexes == NULL || s->hexes->corner == NULL) {
    cpl_hexes_destroy(s->hexes);
    s->hexes = NULL;
    return part_fail(PART_ERR_MEMORY, "subCell: no memory for %d cells", s->mesh->cells);
  }
  for (int c = 0; c < s->mesh->cells; c++)
    find_corners(s, c, s->hexes->corner[c]);
  return PART_OK;
}

void cpl_hexes_destroy(cpl_hexes *hexes) {
  if (hexes != NULL) {
    free(hexes->corner);
    free(hexes->bits);
    free(hexes->square);
  }
  free(hexes);
}

/* ---- rows of a polyhedron -------------------------------------------------------------------- */

typedef struct { /* grid over the bound of a cell: centres at lo + (i + 1/2) step */
  const double *lo;
  double step[3];
  int n, words;
  int from[2], to[2]; /* rows j, k wanted */
  uint64_t *bits;
} grid;

/* First index whose centre is beyond x, at least 0. */
static int first_beyond(const grid *g, int d, double x) {
  const double t = ceil((x - g->lo[d]) / g->step[d] - 0.5);
  int i = t <= 0.0 ? 0 : t >= g->n ? g->n : (int)t;
  while (i > 0 && g->lo[d] + (i - 0.5) * g->step[d] > x)
    i--;
  while (i < g->n && g->lo[d] + (i + 0.5) * g->step[d] <= x)
    i++;
  return i;
}

static void toggle_beyond(const grid *g, int j, int k, double x) {
  uint64_t *row = g->bits + ((size_t)j + (size_t)g->n * (size_t)k) * (size_t)g->words;
  const int i = first_beyond(g, 0, x);
  for (int w = i / 64; w < g->words; w++)
    row[w] ^= w == i / 64 ? ~(uint64_t)0 << (i % 64) : ~(uint64_t)0;
}

/* Every row along +x that a triangle crosses is inside the cell on one side of it: toggle all
 * centres beyond. A line through an edge belongs to one of its two triangles (a <= z < b). */
static void toggle_triangle(const grid *g, const double *v[3]) {
  const double low = fmin(v[0][2], fmin(v[1][2], v[2][2]));
  const double high = fmax(v[0][2], fmax(v[1][2], v[2][2]));
  int k = first_beyond(g, 2, low);
  for (k = k > g->from[1] + 1 ? k - 1 : g->from[1]; k <= g->to[1]; k++) {
    const double z = g->lo[2] + (k + 0.5) * g->step[2];
    double end[2][2];
    int found = 0;
    if (z > high)
      break;
    for (int i = 0; i < 3 && found < 2; i++) {
      const double *a = v[i], *b = v[(i + 1) % 3];
      if ((a[2] <= z) == (b[2] <= z))
        continue;
      const double *p = a[2] <= z ? a : b, *q = a[2] <= z ? b : a; /* same for both triangles */
      const double w = (z - p[2]) / (q[2] - p[2]);
      end[found][0] = p[0] + w * (q[0] - p[0]);
      end[found++][1] = p[1] + w * (q[1] - p[1]);
    }
    if (found < 2 || end[0][1] == end[1][1])
      continue;
    const int l = end[0][1] < end[1][1] ? 0 : 1;
    const double *p = end[l], *q = end[1 - l];
    int j = first_beyond(g, 1, p[1]);
    for (j = j > g->from[0] + 1 ? j - 1 : g->from[0]; j <= g->to[0]; j++) {
      const double y = g->lo[1] + (j + 0.5) * g->step[1];
      if (y >= q[1])
        break;
      if (y >= p[1])
        toggle_beyond(g, j, k, p[0] + (y - p[1]) / (q[1] - p[1]) * (q[0] - p[0]));
    }
  }
}

int cpl_polyhedron_rows(cpl_search *s, int cell, int n, const int from[2], const int to[2]) {
  const cpl_mesh *m = s->mesh;
  grid g = {.lo = s->bound[cell], .n = n, .words = (n + 63) / 64};
  const size_t words = (size_t)n * (size_t)n * (size_t)g.words;
  if (words > s->hexes->words) {
    free(s->hexes->bits);
    s->hexes->bits = malloc(words * sizeof *s->hexes->bits);
    s->hexes->words = s->hexes->bits != NULL ? words : 0;
    if (s->hexes->bits == NULL)
      return part_fail(PART_ERR_MEMORY, "subCell: no memory for %d^3 sub-cells", n);
  }
  g.bits = s->hexes->bits;
  for (int d = 0; d < 3; d++)
    g.step[d] = (s->bound[cell][3 + d] - g.lo[d]) / n;
  memcpy(g.from, from, sizeof g.from);
  memcpy(g.to, to, sizeof g.to);
  for (int k = from[1]; k <= to[1]; k++)
    memset(g.bits + ((size_t)from[0] + (size_t)n * (size_t)k) * (size_t)g.words, 0,
           (size_t)(to[0] - from[0] + 1) * (size_t)g.words * sizeof *g.bits);
  for (int e = s->cell_face_start[cell]; e < s->cell_face_start[cell + 1]; e++) {
    const int f = s->cell_face[e] < 0 ? ~s->cell_face[e] : s->cell_face[e];
    const int *p = m->face_point + m->face_start[f],
              count = m->face_start[f + 1] - m->face_start[f];
    const int planar = s->plane[f].count > 0;
    for (int i = planar ? 1 : 0; i < (planar ? count - 1 : count); i++) {
      const double *v[3] = {planar ? m->point + 3 * p[0] : s->plane[f].c, m->point + 3 * p[i],
                            m->point + 3 * p[(i + 1) % count]};
      toggle_triangle(&g, v);
    }
  }
  return PART_OK;
}
