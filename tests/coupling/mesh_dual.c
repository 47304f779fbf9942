/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dual of a tetrahedral mesh: a cell per point. An edge gives a face through the centroids of the
 * tetrahedra around it (on the boundary closed by two triangle centroids and the edge's middle); a
 * boundary triangle gives each of its points a quadrilateral. See mesh_maker.h. */
#include "mesh_maker.h"

#include <stdlib.h>
#include <string.h>

/* A tetrahedron (index) seen along its edge a < b: it fills the angle from point c to point d. */
typedef struct {
  int a, b, c, d, tet;
} wedge;

static int compare_wedge(const void *pa, const void *pb) {
  return memcmp(pa, pb, sizeof(wedge)); /* any total order that keeps an edge together */
}

typedef struct { /* new points by what they stand for, found again by linear probing */
  mesh_builder *b;
  const double *from; /* points of the tetrahedral mesh */
  int size, (*key)[3], *value;
} midpoints;

/* Number of the new point in the middle of n <= 3 old points. */
static int middle(midpoints *m, int n, int p0, int p1, int p2) {
  int k[3] = {p0, p1, n == 3 ? p2 : -1};
  for (int i = 0; i < n; i++)
    for (int j = i + 1; j < n; j++)
      if (k[j] < k[i]) {
        const int t = k[i];
        k[i] = k[j];
        k[j] = t;
      }
  unsigned h = ((unsigned)k[0] * 73856093u) ^ ((unsigned)k[1] * 19349663u) ^
               ((unsigned)(k[2] + 1) * 83492791u);
  for (h %= (unsigned)m->size; m->value[h] >= 0; h = (h + 1) % (unsigned)m->size)
    if (memcmp(m->key[h], k, sizeof k) == 0)
      return m->value[h];
  memcpy(m->key[h], k, sizeof k);
  double *x = m->b->point + 3 * m->b->points;
  for (int d = 0; d < 3; d++) {
    x[d] = m->from[3 * k[0] + d] + m->from[3 * k[1] + d] + (n == 3 ? m->from[3 * k[2] + d] : 0.0);
    x[d] /= n;
  }
  return m->value[h] = m->b->points++;
}

/* The face of the edge of w[0..n-1]. */
static void add_edge_face(midpoints *m, const wedge *w, int n) {
  int corner[67], count = 0, at = 0, open = 0;
  if (n > 64)
    abort();
  for (int i = 0; i < n && !open; i++) { /* start where nothing comes before, if there is such */
    int before = 0;
    for (int j = 0; j < n; j++)
      before = before || w[j].d == w[i].c;
    if (!before) {
      at = i;
      open = 1;
    }
  }
  if (open) {
    corner[count++] = middle(m, 2, w[0].a, w[0].b, -1);
    corner[count++] = middle(m, 3, w[0].a, w[0].b, w[at].c);
  }
  for (int k = 0; k < n; k++) {
    corner[count++] = w[at].tet;
    int next = 0;
    while (next < n && w[next].c != w[at].d)
      next++;
    if (next == n)
      break;
    at = next;
  }
  if (open)
    corner[count++] = middle(m, 3, w[0].a, w[0].b, w[at].d);
  int back[67];
  for (int i = 0; i < count; i++)
    back[i] = corner[count - 1 - i];
  mesh_add_face(m->b, w[0].a, count, corner); /* normal from a to b */
  mesh_add_face(m->b, w[0].b, count, back);
}

static int compare_triangle(const void *pa, const void *pb) {
  return memcmp(pa, pb, 3 * sizeof(int));
}

/* The triangles of only one tetrahedron, outward, cut into quadrilaterals for their points. */
static void add_boundary(midpoints *m, const int (*tet)[4], int tets) {
  static const int face[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  int(*tri)[6] = mesh_alloc((size_t)tets * 4, sizeof *tri); /* sorted, then oriented */
  int old_points = 0;
  for (int t = 0; t < 4 * tets; t++) {
    for (int v = 0; v < 3; v++)
      tri[t][3 + v] = tri[t][v] = tet[t / 4][face[t % 4][v]];
    for (int v = 0; v < 2; v++)
      for (int u = v + 1; u < 3; u++)
        if (tri[t][u] < tri[t][v]) {
          const int x = tri[t][u];
          tri[t][u] = tri[t][v];
          tri[t][v] = x;
        }
    old_points = tri[t][2] >= old_points ? tri[t][2] + 1 : old_points;
  }
  qsort(tri, (size_t)tets * 4, sizeof *tri, compare_triangle);
  int *copy = mesh_alloc((size_t)old_points, sizeof *copy);
  memset(copy, -1, (size_t)old_points * sizeof *copy);
  for (int t = 0; t < 4 * tets; t++) {
    if (t + 1 < 4 * tets && compare_triangle(tri[t], tri[t + 1]) == 0) {
      t++;
      continue;
    }
    const int *p = tri[t] + 3;
    for (int v = 0; v < 3; v++) {
      const int a = p[v], b = p[(v + 1) % 3], c = p[(v + 2) % 3];
      if (copy[a] < 0) {
        memcpy(m->b->point + 3 * m->b->points, m->from + 3 * a, 3 * sizeof(double));
        copy[a] = m->b->points++;
      }
      const int quad[4] = {copy[a], middle(m, 2, a, b, -1), middle(m, 3, a, b, c),
                           middle(m, 2, a, c, -1)};
      mesh_add_face(m->b, a, 4, quad);
    }
  }
  free(copy);
  free(tri);
}

void mesh_dual(const double *point, int points, const int (*tet)[4], int tets, made_mesh *mesh) {
  static const int edge[6][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2},
                                 {1, 2, 0, 3}, {1, 3, 2, 0}, {2, 3, 0, 1}};
  mesh_builder b = {.cells = points, .points = tets};
  b.point = mesh_alloc((size_t)(tets + 10 * tets + points), 3 * sizeof(double));
  midpoints m = {.b = &b, .from = point, .size = 24 * tets + 1};
  m.key = mesh_alloc((size_t)m.size, sizeof *m.key);
  m.value = mesh_alloc((size_t)m.size, sizeof *m.value);
  memset(m.value, -1, (size_t)m.size * sizeof *m.value);
  wedge *w = mesh_alloc((size_t)tets * 6, sizeof *w);
  for (int t = 0; t < tets; t++) {
    for (int i = 0; i < 12; i++)
      b.point[3 * t + i % 3] += 0.25 * point[3 * tet[t][i / 3] + i % 3];
    for (int e = 0; e < 6; e++) { /* (a, b, c, d) is an even permutation; so is (b, a, d, c) */
      int q[4];
      for (int v = 0; v < 4; v++)
        q[v] = tet[t][edge[e][v]];
      w[6 * t + e] =
          q[0] < q[1] ? (wedge){q[0], q[1], q[2], q[3], t} : (wedge){q[1], q[0], q[3], q[2], t};
    }
  }
  qsort(w, (size_t)tets * 6, sizeof *w, compare_wedge);
  for (int i = 0, j; i < 6 * tets; i = j) {
    for (j = i; j < 6 * tets && w[j].a == w[i].a && w[j].b == w[i].b;)
      j++;
    add_edge_face(&m, w + i, j - i);
  }
  add_boundary(&m, tet, tets);
  free(w);
  free(m.key);
  free(m.value);
  mesh_finish(&b, mesh);
}
