/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Walls: elements (planes, triangles), the list of elements near each particle, and the tangential
 * history of each particle with each element.
 *
 * History of a wall contact is two dem_entry: key -1-2m holds the spring, key -2-2m the direction
 * of the contact when it was last active, with m = element * 27 + code of the periodic shift. */
#ifndef DEM_WALLS_H
#define DEM_WALLS_H

#include <stddef.h>
#include <stdint.h>

enum { DEM_SHIFTS = 27, DEM_NO_SHIFT = 13 };

typedef struct dem_wall {
  char name[256];
  int material, first, count; /* elements first .. first+count-1 */
} dem_wall;

typedef struct dem_element {
  int wall, material, plane;
  double a[3], b[3], c[3]; /* corners of a triangle; a: a point of a plane */
  double n[3];             /* unit normal */
} dem_element;

/* One near element of a particle: row entry. */
typedef struct dem_near {
  int element, shift; /* shift code: (sx+1) + 3 (sy+1) + 9 (sz+1), element seen at + s L */
  double spring[3];   /* m, tangential history */
  double n[3];        /* direction of the contact when last active; zero: not active */
} dem_near;

/* Bins of triangles: those within reach of some point of the bin. */
typedef struct dem_bins {
  double lo[3], edge;
  int cells[3];
  int *start, *item; /* [cells+1], elements; NULL without triangles */
} dem_bins;

typedef struct dem_walls {
  int count;
  dem_wall *wall;
  size_t capacity, elements, element_capacity;
  dem_element *element;
  dem_bins bins;
  /* Rows: only particles that have a near element. */
  int rows;
  int *particle, *start;
  size_t row_capacity, start_capacity, near_capacity;
  dem_near *near;
  struct dem_candidate *scratch; /* room for the longest row */
  size_t scratch_capacity;
} dem_walls;

/* A place where a sphere touches an element, relative to its centre. */
typedef struct dem_candidate {
  int entry;              /* in near[] */
  int feature;            /* 0 face, 1 edge, 2 vertex */
  double p[3], n[3], gap; /* nearest point, direction from it to the centre, distance of the two */
} dem_candidate;

struct dem_t;
/* Nearest point of an element to x (relative to x), unit direction from it to x, distance (negative
 * behind a plane). Returns the feature: 0 face, 1 edge, 2 vertex. */
int dem_element_nearest(const dem_element *element, const double x[3], double p[3], double n[3],
                        double *distance);
/* Offset of an element seen with a shift code: add to x. */
void dem_shift_position(const double length[3], int shift, const double x[3], double shifted[3]);

int dem_walls_bins(dem_walls *walls, double reach);
/* Bin of x, -1: none. */
int dem_bins_find(const dem_bins *bins, const double x[3]);
/* Near elements of every own movable particle within r + skin; those with history stay in. */
int dem_walls_list(struct dem_t *dem, const int *count, const void *payload);
/* ERR_OVERLAP when a particle is too deep in a wall; local. */
int dem_walls_check(struct dem_t *dem);
void dem_walls_free(dem_walls *walls);

#endif
