/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lattices of hexahedra and their cuts, see mesh_maker.h. */
#include "mesh_maker.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

double mesh_random(uint64_t *state) {
  uint64_t z = (*state += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

void *mesh_alloc(size_t count, size_t size) {
  void *p = calloc(count ? count : 1, size);
  if (p == NULL) {
    fprintf(stderr, "mesh_maker: out of memory\n");
    abort();
  }
  return p;
}

static void require(int ok, const char *what) {
  if (!ok) {
    fprintf(stderr, "mesh_maker: %s\n", what);
    abort();
  }
}

/* ---- lattice points -------------------------------------------------------------------------- */

static double lattice_coordinate(const mesh_options *o, int axis, int i) {
  const int n = o->n[axis];
  const double g = o->grade[axis];
  double s = (double)i / n;
  if (n > 1 && g > 0.0 && g != 1.0) { /* edges in geometric series, last / first = g */
    const double q = pow(g, 1.0 / (n - 1));
    s = (pow(q, i) - 1.0) / (pow(q, n) - 1.0);
  }
  return i == n ? o->hi[axis] : o->lo[axis] + s * (o->hi[axis] - o->lo[axis]);
}

static int lattice_index(const mesh_options *o, int i, int j, int k) {
  return i + (o->n[0] + 1) * (j + (o->n[1] + 1) * k);
}

static void rotate_point(const double w[3], double x[3]) {
  const double a = sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
  if (a == 0.0)
    return;
  const double c = cos(a), s = sin(a) / a;
  const double wx = w[0] * x[0] + w[1] * x[1] + w[2] * x[2];
  const double cr[3] = {w[1] * x[2] - w[2] * x[1], w[2] * x[0] - w[0] * x[2],
                        w[0] * x[1] - w[1] * x[0]};
  for (int d = 0; d < 3; d++)
    x[d] = c * x[d] + s * cr[d] + (1.0 - c) / (a * a) * wx * w[d];
}

static double *lattice_points(const mesh_options *o) {
  double *point =
      mesh_alloc((size_t)lattice_index(o, o->n[0], o->n[1], o->n[2]) + 1, 3 * sizeof *point);
  uint64_t state = o->seed;
  for (int k = 0; k <= o->n[2]; k++)
    for (int j = 0; j <= o->n[1]; j++)
      for (int i = 0; i <= o->n[0]; i++) {
        const int ijk[3] = {i, j, k};
        double *x = point + 3 * lattice_index(o, i, j, k);
        int inside = 1;
        for (int d = 0; d < 3; d++) {
          x[d] = lattice_coordinate(o, d, ijk[d]);
          inside = inside && ijk[d] > 0 && ijk[d] < o->n[d];
        }
        inside = inside && i >= o->warp_from * o->n[0];
        for (int d = 0; d < 3 && inside && o->warp > 0.0; d++) {
          const double u = 2.0 * mesh_random(&state) - 1.0;
          const double there = lattice_coordinate(o, d, ijk[d] + (u > 0.0 ? 1 : -1));
          x[d] += o->warp * fabs(u) * (there - x[d]);
        }
        if (o->shear != 0.0) {
          x[0] += o->shear * x[1];
          x[1] += o->shear * x[2];
        }
        rotate_point(o->rotate, x);
      }
  return point;
}

/* ---- cells ----------------------------------------------------------------------------------- */

/* Corner b of a hexahedron is at (b & 1, b >> 1 & 1, b >> 2). */
static const int hex_face[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                   {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
static const int kuhn_tet[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                                   {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
static const int tet_face[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

static void add_hex(mesh_builder *b, int cell, const int p[8]) {
  for (int f = 0; f < 6; f++) {
    int c[4];
    for (int v = 0; v < 4; v++)
      c[v] = p[hex_face[f][v]];
    mesh_add_face(b, cell, 4, c);
  }
}

static void add_prism(mesh_builder *b, int cell, const int p[6]) { /* 0 1 2 below, 3 4 5 above */
  const int below[3] = {p[0], p[2], p[1]}, above[3] = {p[3], p[4], p[5]};
  mesh_add_face(b, cell, 3, below);
  mesh_add_face(b, cell, 3, above);
  for (int i = 0; i < 3; i++) {
    const int j = (i + 1) % 3, side[4] = {p[i], p[j], p[j + 3], p[i + 3]};
    mesh_add_face(b, cell, 4, side);
  }
}

static void add_tet(mesh_builder *b, int cell, const int p[4]) {
  for (int f = 0; f < 4; f++) {
    const int c[3] = {p[tet_face[f][0]], p[tet_face[f][1]], p[tet_face[f][2]]};
    mesh_add_face(b, cell, 3, c);
  }
}

/* Cells of one hexahedron of the lattice; returns the next free cell number. */
static int add_lattice_cell(mesh_builder *b, const mesh_options *o, int cell, int i, int j,
                            const int p[8]) {
  if (o->kind == MESH_PRISM) {
    const int one[6] = {p[0], p[1], p[3], p[4], p[5], p[7]};
    const int two[6] = {p[0], p[3], p[2], p[4], p[7], p[6]};
    add_prism(b, cell, one);
    add_prism(b, cell + 1, two);
    return cell + 2;
  }
  if (o->kind == MESH_TET) {
    for (int t = 0; t < 6; t++) {
      int c[4];
      for (int v = 0; v < 4; v++)
        c[v] = p[kuhn_tet[t][v]];
      add_tet(b, cell + t, c);
    }
    return cell + 6;
  }
  if (o->kind == MESH_AGGLOMERATE) { /* cell: first number of this layer */
    const int blocks = (o->n[0] + 1) / 2;
    add_hex(b, cell + 2 * (i / 2 + blocks * (j / 2)) + (i % 2 && j % 2), p);
    return cell;
  }
  add_hex(b, cell, p);
  return cell + 1;
}

static void add_lattice_cells(mesh_builder *b, const mesh_options *o) {
  int cell = 0;
  for (int k = 0; k < o->n[2]; k++) {
    for (int j = 0; j < o->n[1]; j++)
      for (int i = 0; i < o->n[0]; i++) {
        int p[8];
        for (int v = 0; v < 8; v++)
          p[v] = lattice_index(o, i + (v & 1), j + (v >> 1 & 1), k + (v >> 2));
        cell = add_lattice_cell(b, o, cell, i, j, p);
      }
    if (o->kind == MESH_AGGLOMERATE)
      cell += o->n[0] * o->n[1] / 2;
  }
  b->cells = cell;
}

static void make_poly(const mesh_options *o, made_mesh *mesh) {
  const int cells = o->n[0] * o->n[1] * o->n[2];
  double *point = lattice_points(o);
  int(*tet)[4] = mesh_alloc((size_t)cells * 6, sizeof *tet);
  int t = 0;
  for (int k = 0; k < o->n[2]; k++)
    for (int j = 0; j < o->n[1]; j++)
      for (int i = 0; i < o->n[0]; i++)
        for (int q = 0; q < 6; q++, t++)
          for (int v = 0; v < 4; v++) {
            const int c = kuhn_tet[q][v];
            tet[t][v] = lattice_index(o, i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
          }
  mesh_dual(point, lattice_index(o, o->n[0], o->n[1], o->n[2]) + 1, (const int(*)[4])tet, t, mesh);
  free(tet);
  free(point);
}

/* ---- public ---------------------------------------------------------------------------------- */

static void set_box(const mesh_options *o, made_mesh *mesh) {
  const int moved =
      o->shear != 0.0 || o->rotate[0] != 0.0 || o->rotate[1] != 0.0 || o->rotate[2] != 0.0;
  mesh->box = (part_box){.periodic = {o->periodic[0], o->periodic[1], o->periodic[2]}};
  for (int d = 0; d < 3; d++) {
    require(!(moved && o->periodic[d]), "a sheared or rotated mesh cannot be periodic");
    mesh->box.lo[d] = o->lo[d];
    mesh->box.hi[d] = o->hi[d];
    for (int p = 0; moved && p < mesh->view.points; p++) {
      const double x = mesh->point[3 * p + d];
      mesh->box.lo[d] = p == 0 ? x : fmin(mesh->box.lo[d], x);
      mesh->box.hi[d] = p == 0 ? x : fmax(mesh->box.hi[d], x);
    }
  }
}

void mesh_make(const mesh_options *o, made_mesh *mesh) {
  for (int d = 0; d < 3; d++)
    require(o->n[d] > 0 && o->hi[d] > o->lo[d], "n must be > 0 and hi > lo");
  require(o->kind != MESH_AGGLOMERATE || (o->n[0] % 2 == 0 && o->n[1] % 2 == 0),
          "MESH_AGGLOMERATE needs even n[0] and n[1]");
  if (o->kind == MESH_POLY) {
    make_poly(o, mesh);
  } else {
    mesh_builder b = {.points = lattice_index(o, o->n[0], o->n[1], o->n[2]) + 1};
    b.point = lattice_points(o);
    add_lattice_cells(&b, o);
    mesh_finish(&b, mesh);
  }
  set_box(o, mesh);
}
