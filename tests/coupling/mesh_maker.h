/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Meshes for tests and benchmarks, as cpl_mesh views, with face centres, cell centres and volumes
 * computed as OpenFOAM does (primitiveMesh: triangles about the average of the face points,
 * pyramids about the average of the face centres). A bad request aborts: these are tests. */
#ifndef TEST_MESH_MAKER_H
#define TEST_MESH_MAKER_H

#include <stdint.h>
#include "coupling/coupling.h"

typedef enum {
  MESH_HEX,        /* n[0] x n[1] x n[2] hexahedra, x fastest */
  MESH_PRISM,      /* each hexahedron cut into 2 triangular prisms along z */
  MESH_TET,        /* each hexahedron cut into 6 tetrahedra around the diagonal 0-7 */
  MESH_POLY,       /* dual of MESH_TET: a cell per lattice point, inside with 14 faces of 4 and 6
                      points (a distorted truncated octahedron); faces are warped when warp > 0 */
  MESH_AGGLOMERATE /* hexahedra merged: of each 2 x 2 in x and y three make one L-shaped cell (not
                      convex, two faces with the same neighbour), the fourth stays alone */
} mesh_kind;

/* Zero gives the plain case: start from MESH_UNIT(kind, nx, ny, nz) and change what is needed. */
typedef struct mesh_options {
  mesh_kind kind;
  int n[3];
  double lo[3], hi[3]; /* of the box before shear and rotation, m */
  int periodic[3];     /* only copied to made_mesh.box: the faces there are boundary faces, as the
                          cyclic ones of OpenFOAM are; not together with shear or rotate */
  double grade[3];     /* ratio of the last to the first edge along an axis; 0 or 1: uniform */
  double warp;      /* lattice points inside move by up to this part of an edge along each axis */
  double warp_from; /* in [0, 1]: points in this first part of the box along x do not move */
  uint64_t seed;    /* of the warp */
  double shear;     /* x += shear y, y += shear z */
  double rotate[3]; /* rotation vector (rad) about the origin, after the shear */
} mesh_options;

#define MESH_UNIT(k, nx, ny, nz)                                                                   \
  ((mesh_options){.kind = (k), .n = {(nx), (ny), (nz)}, .hi = {1.0, 1.0, 1.0}})

/* view points at the arrays, which belong to this struct. box: lo, hi and periodic of the options
 * (bounds of the points when sheared or rotated). global_cell: after mesh_split the cell's number
 * in the whole mesh, else NULL. */
typedef struct made_mesh {
  cpl_mesh view;
  part_box box;
  double *point, *face_centre, *cell_centre, *volume;
  int *face_start, *face_point, *owner, *neighbour, *global_cell;
} made_mesh;

void mesh_make(const mesh_options *options, made_mesh *mesh);
void mesh_free(made_mesh *mesh);

/* The cells c with rank_of_cell[c] == rank, in their order, as that rank would see them: faces to
 * other ranks become boundary faces (after the true ones) that point outwards; points, faces and
 * cells are numbered anew, geometry is computed anew. May be empty. */
void mesh_split(const made_mesh *whole, const int *rank_of_cell, int rank, made_mesh *part);
/* rank_of_cell: blocks of consecutive cells; or cells at random (many processor faces). */
void mesh_part_blocks(const made_mesh *whole, int ranks, int *rank_of_cell);
void mesh_part_random(const made_mesh *whole, int ranks, uint64_t seed, int *rank_of_cell);

/* Area vector of face f as OpenFOAM computes it. */
void mesh_face_area(const cpl_mesh *mesh, int f, double area[3]);

/* Uniform in [0, 1); advances *state (splitmix64). The same numbers on every machine. */
double mesh_random(uint64_t *state);

/* Used by the makers: collect cells as outward oriented faces, then match faces between cells.
 * points of the builder are moved into the mesh. */
typedef struct mesh_builder {
  int cells, faces, capacity, points, corner_count, corner_capacity;
  double *point;
  int *start, *corner, *cell;
} mesh_builder;
void mesh_add_face(mesh_builder *b, int cell, int n, const int *corner);
void mesh_finish(mesh_builder *b, made_mesh *mesh); /* frees b */
void mesh_dual(const double *point, int points, const int (*tet)[4], int tets, made_mesh *mesh);
void *mesh_alloc(size_t count, size_t size); /* zeroed; aborts when there is none */

#endif
