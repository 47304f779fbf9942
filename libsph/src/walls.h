/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Walls: their faces (planes, triangles), the list of faces near each particle, and the ghost
 * points behind them that a particle sees (S.16). */
#ifndef SPH_WALLS_H
#define SPH_WALLS_H

#include <math.h>
#include <stddef.h>

#include "sph/sph.h"
#include "particle/motion.h"
#include "particle/sum.h"

typedef struct sph_face {
  int wall, type;          /* SPH_PLANE, SPH_TRIANGLES */
  double a[3], b[3], c[3]; /* m, corners of a triangle; a: point of a plane */
  double n[3];             /* unit normal to the fluid */
} sph_face;

/* Where a particle is before a wall that pushes. */
typedef struct sph_wall_place {
  double distance, leaving; /* m, m/s: along the normal */
  double mass;              /* kg, of the particle */
  double spacing, h, sound_speed;
  const sph_wall_params *wall;
} sph_wall_place;

typedef struct sph_wall {
  char name[PART_PARAM_WORD_LENGTH];
  sph_wall_params params;
  int moves, turns, travels; /* travels: its faces move, not its surface alone */
  part_motion motion;
  part_pose pose;
  double sweep;            /* m, largest distance of a corner from the axis */
  double force[3];         /* N, of own particles on it, now */
  double torque[3], power; /* N m, W: the same; power: of the wall on them */
  part_sum impulse, work;  /* N s; J, first component */
} sph_wall;

/* Bins of triangles: those within reach of some point of the bin. */
typedef struct sph_bins {
  double lo[3], edge;
  int cells[3];
  int *start, *item; /* [cells+1], faces */
} sph_bins;

/* A point behind a wall as a particle sees it. */
typedef struct sph_point {
  double r[3];   /* m, from the particle */
  double volume; /* m3 */
  double mirror; /* 1 + d_k/d_a of the deepest wall, Markauskas et al. 2017, eq. 25 */
  double q[3];   /* m, so that u_ak.r = q.u_a - pushed with the velocity of eq. 26 */
  double pushed; /* m2/s, by the velocities of the walls */
  int face;      /* of the deepest wall */
} sph_point;

/* Sums over the points behind a plane, f = V slope, down = distance of the point's layer from the
 * particle, depth = from the plane, t along one direction of the plane: wall_tables.c. */
enum sph_table {
  SPH_TABLE_GRADIENT,       /* f down */
  SPH_TABLE_GRADIENT_DEPTH, /* f down depth */
  SPH_TABLE_NORMAL,         /* f down^2 */
  SPH_TABLE_ACROSS,         /* f t^2 */
  SPH_TABLE_VISCOUS,        /* f */
  SPH_TABLE_VISCOUS_DEPTH,  /* f depth */
  SPH_TABLE_APPROACH,       /* f down^2/(r^2 + 0.01 h^2) */
  SPH_TABLE_SHADE,          /* V W */
  SPH_TABLE_COUNT
};

/* A point that stays where it is (S.23), and the grid in which they are looked up. */
typedef struct sph_fixed {
  double x[3]; /* m */
  int face;
} sph_fixed;
typedef struct sph_fixed_grid {
  double lo[3], edge;
  int cells[3];
  int *start; /* [cells + 1] */
} sph_fixed_grid;

typedef struct sph_walls {
  int count, faces, planes; /* the planes come first */
  int moving, travelling;   /* one of them does; its faces do */
  double tie;               /* m, distances that differ by less are the same */
  sph_wall *wall;
  sph_face *face, *given; /* now; as they were given (NULL: none travels) */
  sph_bins bins;
  /* Rows: only particles that have a near face. */
  int rows;
  int *particle, *start, *near;
  size_t row_room, start_room, near_room, point_room;
  sph_point *point; /* those of one particle */
  int *within;      /* [room of near] faces within the support of one particle */
  size_t within_room;
  double *table; /* [][SPH_TABLE_COUNT] */
  sph_fixed *fixed;
  size_t fixed_room;
  int fixed_count;
  double fixed_volume; /* m3, of each */
  sph_fixed_grid fixed_grid;
} sph_walls;

/* A flat side of the walls around a particle: the nearest of those faces that look the same way. */
typedef struct sph_side {
  const double *n;
  double distance; /* m, of its plane */
  int face;
  double speed; /* m/s, of the wall along n */
} sph_side;
enum { SPH_SIDES = 6 };

/* What a particle sees of the walls. */
typedef struct sph_seer {
  const double *x;
  int *near, count; /* faces within the support */
  int planes;       /* they are all planes */
  int alone;        /* there is one face, a plane */
  int nearest;      /* of the faces */
  double distance;  /* m, of the solid */
  int sides;
  sph_side side[SPH_SIDES];
} sph_seer;

struct sph_t;

/* ---- wall_faces.c: geometry --------------------------------------------------------------------
 */
/* Signed distance of a face from x: negative behind. *tilt: how squarely x is seen from the nearest
 * point, for ties between faces that meet there. */
double sph_face_distance(const sph_face *face, const double x[3], double *tilt);
/* Face of a list that x is deepest behind or nearest to, and the signed distance of the solid from
 * x: the least of that of the planes and that of the surface of triangles. */
int sph_faces_nearest(const sph_walls *walls, int n, const int *near, const double x[3],
                      double *distance);
int sph_walls_bins(sph_walls *walls, double reach);
void sph_walls_free(sph_walls *walls);

/* ---- wall_motion.c -----------------------------------------------------------------------------
 */
/* Entries of motion against type and model; directions to unit length. */
int sph_wall_check_motion(const struct sph_t *sph, sph_wall_params *params);
/* Once, when all walls are there. */
int sph_walls_prepare(struct sph_t *sph);
/* Poses and faces of time t. */
void sph_walls_move(struct sph_t *sph, double t);
/* Velocity and acceleration of a face's wall at the foot of x on its plane. */
void sph_face_velocity(const struct sph_t *sph, const sph_face *face, const double x[3], double u[3]);
void sph_face_acceleration(const struct sph_t *sph, const sph_face *face, const double x[3],
                           double a[3]);
/* Bounds: way of any face within h (m), speed of any surface (m/s); longest step that resolves motions. */
double sph_walls_way(const struct sph_t *sph, double h);
double sph_walls_speed(const struct sph_t *sph);
double sph_walls_motion_step(const struct sph_t *sph);

/* ---- wall_list.c: near faces of every own particle
 * ----------------------------------------------- */
int sph_walls_list(struct sph_t *sph);
/* Triangles of the bin that a point is in, into near[]; how many. */
int sph_walls_in_bin(const sph_walls *walls, const double x[3], int *near);

/* ---- wall_tables.c
 * -------------------------------------------------------------------------------- */
int sph_walls_table(struct sph_t *sph);
void sph_walls_look_up(const struct sph_t *sph, double distance, double sum[SPH_TABLE_COUNT]);

/* ---- wall_points.c
 * ------------------------------------------------------------------------------- */
/* ERR_OUTSIDE when the particle of a row is behind a wall by more than a spacing. count 0: no wall
 * is within the support now. */
int sph_walls_see(struct sph_t *sph, int row, sph_seer *s);
/* Ghost points into sph->walls.point; how many. */
int sph_walls_points(struct sph_t *sph, sph_seer *s);
/* Sides of the walls around the particle, in s. */
void sph_walls_sides(const struct sph_t *sph, sph_seer *s);
/* 1 + behind/distance of eq. 25-26. */
double sph_walls_mirror(const struct sph_t *sph, double behind, double distance);

/* ---- wall_fixed.c
 * -------------------------------------------------------------------------------- */
int sph_walls_fix(struct sph_t *sph); /* once, after the bins; nothing without such walls */
/* Into sph->walls.point, as sph_walls_points. */
int sph_walls_fixed_points(struct sph_t *sph, const sph_seer *s);

/* ---- wall_push.c
 * ------------------------------------------------------------------------------- */
int sph_walls_push(const struct sph_t *sph); /* do the walls push? */
/* Force of one side of the row's particle over its volume. */
void sph_walls_push_force(struct sph_t *sph, int row, sph_seer *s, double force[3], int side);
double sph_walls_longest_step(const struct sph_t *sph);

/* ---- wall_sums.c: what walls add to the sums of the pair loops
 * -------------------------------------- */
int sph_walls_density(struct sph_t *sph);
int sph_walls_force(struct sph_t *sph);
int sph_walls_shift(struct sph_t *sph);
void sph_walls_add_impulse(struct sph_t *sph, double h);

#endif
