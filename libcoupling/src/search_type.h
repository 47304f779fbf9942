/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What search.c knows about a mesh; internal to the geometry files of libcoupling. */
#ifndef COUPLING_SEARCH_TYPE_H
#define COUPLING_SEARCH_TYPE_H

#include "search.h"

typedef struct cpl_tensor cpl_tensor; /* tensor_grid.h */
typedef struct cpl_hexes cpl_hexes;   /* sub_cell.h */

/* Where a face can be: within `thickness` of the plane through c with unit normal n (owner to
 * neighbour), and within `reach` of c = its face centre, both rounded up. One cache line: most
 * faces near a sphere are read here and not met. */
typedef struct cpl_face_plane {
  double n[3], c[3];
  float thickness, reach;
  int row;   /* in cpl_search.corner; -1: tensor grid, has none */
  int count; /* corners; fan: -count, each corner i preceded by the unit normal of triangle i (c, i,
                i + 1), 0 without area */
} cpl_face_plane;

struct cpl_search {
  const cpl_mesh *mesh;
  double lo[3], hi[3]; /* of all cells */
  double round_off;    /* m: of coordinates; faces this close to a plane are on it */
  double tie;          /* m: points this close to a face are on it */

  cpl_face_plane *plane; /* [faces] */
  double (*corner)[3];   /* of each face in a row, see cpl_face_plane; NULL for a tensor grid */

  int *cell_face_start, *cell_face; /* faces of each cell; ~f when the cell is the neighbour */
  double (*bound)[6];               /* [cells] lo, hi of each cell */
  unsigned char *is_box;            /* [cells] the cell is exactly its bound */
  unsigned char *at_border;         /* [cells] has a boundary face */

  int bins[3]; /* uniform grid over lo, hi; cells whose bound touches a bin, ascending */
  double bin_inverse[3];
  int *bin_start, *bin_cell;

  double kernel_reach; /* of the method kernel, over the radius */

  /* state of one overlap; all of state is 0 between calls */
  unsigned char *state; /* [cells] */
  double *volume;       /* [cells] */
  int *queue;           /* [cells] */
  int queued;

  cpl_tensor *tensor; /* NULL: the cells are not a tensor grid */
  cpl_hexes *hexes;   /* NULL until the first sub-cell overlap */
};

/* search_build.c: fill the parts of a search; s->mesh is set. */
int cpl_search_build_faces(cpl_search *s);
int cpl_search_build_cells(cpl_search *s);
int cpl_search_build_bins(cpl_search *s);
int cpl_search_build_corners(cpl_search *s); /* when the others and the tensor grid are known */
/* Range of bins [lo, hi] of a box, clipped; 0 when it misses the grid. */
int cpl_search_bin_range(const cpl_search *s, const double lo[3], const double hi[3], int from[3],
                         int to[3]);

/* x is in cell, farther than the tie distance from all its faces (sufficient, not necessary when
 * the cell is not convex or has warped faces). */
int cpl_search_surely_in(const cpl_search *s, int cell, const double x[3]);
/* 2: x is inside the cell, 1: on its surface (within tie), 0: outside. */
int cpl_search_in(const cpl_search *s, int cell, const double x[3]);

/* Queue every cell whose bound the sphere touches (border_only: and that has a border face), with
 * volume 0, unless it is queued already. cpl_search_done empties the queue. */
void cpl_search_queue_touching(cpl_search *s, const double centre[3], double radius,
                               int border_only);
void cpl_search_done(cpl_search *s);

enum { CPL_UNSEEN, CPL_QUEUED, CPL_DONE }; /* state of a cell */
static inline void cpl_search_queue(cpl_search *s, int cell) {
  if (s->state[cell] == CPL_UNSEEN) {
    s->state[cell] = CPL_QUEUED;
    s->volume[cell] = 0.0;
    s->queue[s->queued++] = cell;
  }
}

static inline int cpl_other_cell(const cpl_search *s, int code) { /* across a cell_face; -1: none */
  const int f = code < 0 ? ~code : code;
  return code < 0 ? s->mesh->owner[f] : f < s->mesh->internal ? s->mesh->neighbour[f] : -1;
}

#endif
