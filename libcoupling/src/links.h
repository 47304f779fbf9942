/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which cells exchange through which faces, coupled faces included: rows of neighbours with the
 * conductance of the face between. */
#ifndef COUPLING_LINKS_H
#define COUPLING_LINKS_H

#include "coupling/coupling.h"
#include "memory.h"

typedef struct cpl_links {
  const cpl_mesh *mesh;
  int halo;                      /* coupled faces */
  CPL_ARRAY(int) start;          /* [cells+1] into the next two */
  CPL_ARRAY(int) link;           /* neighbour cells; cells + k: what is behind coupled face k */
  CPL_ARRAY(double) conductance; /* (S.d)/|d|^2, m; 0 for a face that looks the wrong way */
  CPL_ARRAY(double) sent;        /* work space */
} cpl_links;

/* Area vector of a face: triangles about its centre, m2. */
void cpl_face_area(const cpl_mesh *mesh, int face, double area[3]);
/* Local. mesh is used, not copied. After an error free it all the same. */
int cpl_links_make(const cpl_mesh *mesh, cpl_links *links);
void cpl_links_free(cpl_links *links);
/* Collective. other[halo][n] = cell[cells][n] of the cells behind the coupled faces. */
int cpl_links_exchange(cpl_links *links, int n, const double *cell, double *other);

#endif
