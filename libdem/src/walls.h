/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Walls: their elements (planes, cylinders, triangles) and motion, the list of elements near each
 * particle, and the tangential history of each particle with each element.
 *
 * Elements stay as they were given (the wall's own frame); what moves is the pose of the wall. A
 * particle is seen from that frame, so that bins and nearest points never change.
 *
 * History of a wall contact is up to three dem_entry with the keys -1-3m, -2-3m, -3-3m: tangential
 * spring, direction of the contact when it was last active, spring of rolling; m = element * 27 +
 * code of the periodic shift. */
#ifndef DEM_WALLS_H
#define DEM_WALLS_H

#include <stddef.h>
#include <stdint.h>

#include "dem/dem.h"
#include "particle/motion.h"
#include "particle/sum.h"

enum { DEM_SHIFTS = 27, DEM_NO_SHIFT = 13 };
enum dem_element_shape { DEM_SHAPE_PLANE, DEM_SHAPE_CYLINDER, DEM_SHAPE_TRIANGLE };

/* Where a wall is: what was given at X is at from + turn (X - centre). */
typedef struct dem_pose {
  part_pose body;           /* velocity at x is drift + gain (x - from) */
  double shift[3], from[3]; /* m; way less wrap; centre + shift */
} dem_pose;

typedef struct dem_wall {
  char name[256];
  int material, first, count; /* elements first .. first+count-1 */
  int given;                  /* how many were given */
  int moves, turns;
  dem_wall_params params; /* directions are unit vectors */
  double sweep;           /* m, largest distance from the axis of what sweeps when the wall turns */
  double spin[3];         /* rad/s, now */
  double wrap[3];         /* m, whole periods taken off the shift when the lists were built */
  dem_pose pose, listed;  /* now; when the lists were built */
  double force[3], torque[3];          /* on the wall, by own particles, now */
  part_sum impulse, spin_impulse, work; /* of them since the start; work: first component */
} dem_wall;

typedef struct dem_element {
  int wall, material, shape;
  int given;               /* number in the wall as it was given */
  double a[3], b[3], c[3]; /* corners of a triangle; a: point of a plane or of a cylinder's axis */
  double n[3];             /* unit normal; of a cylinder: axis */
  double radius, length;   /* cylinder */
  int side;
} dem_element;

/* The face of an element as a plane, and three planes through its edges at right angles to it that
 * face out: inside all of them the nearest point is on the face. Four at once. */
typedef struct dem_facet {
  double a[3]; /* distances are from a point a of the element */
  double back; /* its distance from behind times this counts: -1 two sides, 0 one */
  double n[3][4], o[4];
} dem_facet;

/* One near element of a particle: row entry. */
typedef struct dem_near {
  int element, shift; /* shift code: (sx+1) + 3 (sy+1) + 9 (sz+1), element seen at + s L */
  double spring[3];   /* m, tangential history */
  double roll[3];     /* m, history of rolling */
  double n[3];        /* direction of the contact when last active; zero: not active */
} dem_near;

/* Bins of triangles: those within reach of some point of the bin. Walls at rest share one grid, a
 * moving one has its own, in its own frame. */
typedef struct dem_bins {
  int wall; /* one whose frame it is */
  double lo[3], edge;
  int cells[3];
  int *start, *item; /* [cells+1], elements */
} dem_bins;

typedef struct dem_walls {
  int count, moving; /* moving: one of them does */
  dem_wall *wall;
  size_t capacity, elements, element_capacity;
  dem_element *element;
  dem_facet *facet; /* [elements]; of planes and triangles */
  int groups;
  dem_bins *bins;
  /* Rows: only particles that have a near element. */
  int rows;
  int *particle, *start;
  size_t row_capacity, start_capacity, near_capacity;
  dem_near *near;
  struct dem_candidate *scratch; /* room for the longest row */
  size_t scratch_capacity;
  /* Per row: where the particle was when it was last looked at, and path + the gap it had then;
   * negative: look at every step. */
  double *checked;
  size_t checked_capacity;
  double margin;          /* m, way of moving walls that the lists allow for, beside the skin */
  double path;            /* m, the same of all steps so far: only grows */
  double travel;          /* m, bound of the way of any wall's surface since the lists were built */
  double particle_travel; /* m, dem->travel when they were */
} dem_walls;

/* A place where a sphere touches an element, relative to its centre. */
typedef struct dem_candidate {
  int entry, order;       /* in near[]; number of element and shift */
  int feature;            /* 0 face, 1 edge, 2 vertex */
  double p[3], n[3], gap; /* nearest point, direction from it to the centre, distance of the two */
} dem_candidate;

struct dem_t;

/* ---- wall_params.c: entries of a wall against its type, directions to unit length -------------
 */
int dem_wall_check(const struct dem_t *dem, dem_wall_params *params);
part_motion dem_wall_motion(const dem_wall_params *params);

/* ---- stl.c: triangles of an STL file, vertices [count][9] malloc'ed; do they close? Local. ----
 */
int dem_stl_read(const char *path, double scale, int *count, double **vertices);
int dem_stl_closed(const char *path, int count, const double *vertices);

/* ---- wall_geometry.c ---------------------------------------------------------------------------
 */
/* Nearest point of an element to x (relative to x), unit direction from it to x, distance (negative
 * behind a one-sided element). Returns the feature: 0 face, 1 edge, 2 vertex. */
int dem_element_nearest(const dem_element *element, const double x[3], double p[3], double n[3],
                        double *distance);
int dem_walls_bins(dem_walls *walls, double reach);
int dem_walls_facets(dem_walls *walls);
/* Bin of x, -1: none. */
int dem_bins_find(const dem_bins *bins, const double x[3]);

/* ---- wall_motion.c -----------------------------------------------------------------------------
 */
void dem_wall_prepare(dem_wall *wall, const dem_element *element);
/* ERR_RANGE when particles do not fit into it; the shortest time that the step has to resolve. */
int dem_wall_fits(const struct dem_t *dem, const dem_wall *wall, double *least);
/* Poses at time t, velocities as means over the step h before (0: of the moment). */
void dem_walls_move(struct dem_t *dem, double t, double h);
/* Lists are built now. */
void dem_walls_listed(struct dem_t *dem);
/* Bound of the way of any wall's surface within dt from now (m). */
double dem_walls_way(const struct dem_t *dem, double dt);
/* Own frame of a wall, seen with a periodic shift: x to there; a direction from there. */
void dem_wall_see(const struct dem_t *dem, const dem_wall *wall, int shift, const double x[3],
                  double seen[3]);
void dem_wall_direct(const dem_wall *wall, double v[3]);
/* dem_element_nearest for an element as it is now, seen with a shift. */
int dem_wall_nearest(const struct dem_t *dem, int element, int shift, const double x[3],
                     double p[3], double n[3], double *distance);

/* ---- wall_list.c -------------------------------------------------------------------------------
 */
/* Near elements of every own movable particle within r + skin; those with history stay in. */
int dem_walls_list(struct dem_t *dem, const int *count, const void *payload);
/* The same for the walls alone, when only they have moved on; local. */
int dem_walls_relist(struct dem_t *dem);
double dem_wall_gap(const struct dem_t *dem, int element, const double x[3]);
/* ERR_OVERLAP when a particle is too deep in a wall; local. */
int dem_walls_check(struct dem_t *dem);

/* ---- wall_report.c: sums of forces -------------------------------------------------------------
 */
enum { DEM_WALL_VALUES = 24 };
void dem_walls_no_force(struct dem_t *dem);
void dem_walls_add_impulse(struct dem_t *dem, double h);
void dem_wall_pack(const dem_wall *wall, double value[DEM_WALL_VALUES]);
void dem_wall_unpack(dem_wall *wall, const double value[DEM_WALL_VALUES]); /* adds */

/* ---- walls.c -----------------------------------------------------------------------------------
 */
void dem_walls_free(dem_walls *walls);

#endif
