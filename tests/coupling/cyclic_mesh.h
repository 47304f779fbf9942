/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The unit block of n x n x n cubes whose borders are cyclic in all directions. */
#ifndef TEST_CYCLIC_MESH_H
#define TEST_CYCLIC_MESH_H

#include "mesh_maker.h"

typedef struct cyclic_mesh {
  made_mesh mesh; /* its view points at coupled: a cyclic_mesh must not be copied */
  cpl_coupled_faces coupled;
  int *cell, *partner;
  double *conductance, *way;
} cyclic_mesh;

void cyclic_make(cyclic_mesh *c, int n);
void cyclic_free(cyclic_mesh *c);

#endif
