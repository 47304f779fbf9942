/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Spheres on made meshes, and the comparison of an overlap with the references. */
#ifndef TEST_OVERLAP_CASE_H
#define TEST_OVERLAP_CASE_H

#include "../../libcoupling/src/overlap_methods.h"
#include "ball_reference.h"
#include "mesh_maker.h"

#define BALL 4.18879020478639098 /* volume of the unit ball */

typedef struct overlap_case {
  made_mesh mesh;
  ball_cells cells;
  cpl_search *search;
  double *volume; /* [cells] of the last sphere, in sphere volumes */
  double cell;    /* cell diameter: (mean volume)^(1/3) */
  uint64_t random;
} overlap_case;

void overlap_case_make(const mesh_options *options, overlap_case *c);
void overlap_case_free(overlap_case *c);

enum { VARIANTS = 3 }; /* plain, warped, and warped with shear and rotation */
mesh_options overlap_variant(mesh_kind kind, int variant);

/* Anywhere about the mesh, also outside; radii 0.02 .. 2 cells, sometimes as large as the mesh. */
void random_sphere(overlap_case *c, double centre[3], double *radius);
/* At or within 1e-16 .. 1e-3 radii of a face centre, vertex, edge or cell centre; or tangent to a
 * face, edge or vertex, or off by as little; radii as above. */
void degenerate_sphere(overlap_case *c, double centre[3], double *radius);

/* Run cpl_overlap_exact into c->volume; the sum over cells, in sphere volumes. A cell listed twice
 * or a volume <= 0 fails the test. */
double overlap_run(overlap_case *c, const double centre[3], double radius, int *hint);

typedef long double (*ball_reference)(const ball_cells *, int, const double[3], double);
/* Largest |volume - reference| over all cells, in sphere volumes; *sum: of the reference. */
double overlap_error(overlap_case *c, ball_reference reference, const double centre[3],
                     double radius, double *sum);

/* Environment variable OVERLAP_SPHERES, or the given number. */
int overlap_spheres(int otherwise);

#endif
