/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rigid clumps of spheres (doc/equations.md, R.1 to R.8). Member spheres are ordinary particles
 * (kind DEM_CLUMP, field BLOCK numbers the clump): neighbour lists, contact, walls and files know
 * nothing else. All members of a clump are on the rank that owns its centre of mass (its home).
 *
 * The state of a clump rides in the payload of its members (enum clump_part in clumps.c), and is
 * unpacked into a list after each rebuild. */
#ifndef DEM_CLUMPS_H
#define DEM_CLUMPS_H

#include <stddef.h>
#include <stdint.h>

struct dem_t;
struct dem_insert;
struct dem_seed;

/* ---- shapes ---------------------------------------------------------------------------------- */
typedef struct dem_clump_shape {
  int spheres;
  double *sphere;    /* [spheres][4] m: centre in principal axes about the centre of mass; r */
  double volume;     /* m3 */
  double centre[3];  /* m, centre of mass in the axes of the file */
  double inertia[3]; /* m5, principal, over density; axis 3 is the most distinct one */
  double axes[4];    /* quaternion, principal axes to those of the file */
  double bound;      /* m, of the smallest sphere about the centre of mass that holds all */
  double arm;        /* m, longest distance of a sphere's centre from the centre of mass */
  double light;      /* m-3, largest inverse effective mass of a contact, times density */
} dem_clump_shape;

/* Collective. Read a shape file; the same on every rank. ERR_IO, ERR_FORMAT, ERR_RANGE. */
int dem_clump_shape_read(const struct dem_t *dem, const char *path, dem_clump_shape *shape);
void dem_clump_shape_free(dem_clump_shape *shape);
/* K (R.4) at an arm: n.K n = (arm x n).J (arm x n), J the inverse inertia; in the same axes. */
void dem_clump_turn(const double per_inertia[6], const double arm[3], double k[6]);
/* Moments 1, x, y, z, xx, yy, zz, xy, xz, yz (m3 to m5) about `middle` (m, out) of the union of n
 * spheres [n][4] x y z r. Errors are below 1e-10 of volume, times half the longest edge of the box
 * around all for each power of length. ERR_MEMORY. */
int dem_union_moments(int n, const double *sphere, double moment[10], double middle[3]);

/* ---- insertion ------------------------------------------------------------------------------- */
/* One inserted clump, known to every rank until dem_start. */
typedef struct dem_clump_seed {
  int64_t first; /* id of its first member */
  int shape;     /* in dem_clumps.shape */
  double scale;  /* lengths over those of the shape */
  double x[3], q[4], v[3], w[3];
} dem_clump_seed;

/* The n places (r: of the bounding sphere) become clumps, and their members the seeds. turn:
 * attitude of the axes of the file [n][4], zero or NULL: as `insert` says. */
int dem_clumps_expand(struct dem_t *dem, const struct dem_insert *insert, int shape, int64_t n,
                      const struct dem_seed *place, const double *turn, struct dem_seed **seed,
                      int64_t *count);
/* Shape of a file, read once. Collective. */
int dem_clumps_shape(struct dem_t *dem, const char *path, int *shape);
/* Payload of own particles, which are consecutive seeds from `first`: the first state. */
int dem_clumps_populate(struct dem_t *dem, int64_t first);

/* ---- running --------------------------------------------------------------------------------- */
typedef struct dem_clump {
  int64_t number;
  int first, count; /* members first .. first+count-1 of the list, by id */
  int material;
  double mass, inertia[3]; /* kg, kg m2 principal */
  double light;            /* 1/kg, largest inverse effective mass of a contact */
  double x[3];             /* m, centre of mass */
  double q[4];             /* attitude: body to space axes */
  double v[3];             /* m/s */
  double spin[3];          /* kg m2/s, angular momentum about the centre of mass, space axes */
  double force[3];         /* N, contact */
  double torque[3];        /* N m, contact, about the centre of mass */
} dem_clump;

/* Entries of the payload (internal.h) of a member, written to `to`; returns their end. */
enum { DEM_CLUMP_ENTRIES = 9 }; /* at most */
struct dem_entry *dem_clump_put(const dem_clump *clump, const double arm[3], int is_first,
                                struct dem_entry *to);

typedef struct dem_clumps {
  int count; /* on this rank */
  dem_clump *clump;
  int members;
  int *member; /* [members] own particle */
  int *of;     /* [members] clump */
  double *arm; /* [members][3] m, in body axes */
  int *slot;   /* [local] member of the list, -1: none */
  /* [local + ghost][6] 1/kg: symmetric matrix K; along n a contact moves 1/m + n.K n (R.4). */
  double *turn;
  int parts; /* steps of the clumps per substep: more than 1 in free flight */
  /* before dem_start */
  int shapes;
  dem_clump_shape *shape;
  char **path; /* [shapes] */
  int64_t seeds;
  size_t seed_capacity;
  dem_clump_seed *seed;
} dem_clumps;

void dem_clumps_free(dem_clumps *clumps);
void dem_clumps_free_seeds(dem_clumps *clumps);
/* The list of own clumps, from the payload. */
int dem_clumps_list(struct dem_t *dem, const int *count, const void *payload);
/* Homes of own particles [local][3], from the payload. */
int dem_clumps_homes(const struct dem_t *dem, const int *count, const void *payload,
                     double **homes);
/* Largest inverse effective mass of the clump whose first member is own particle i, from its
 * payload of n entries; 0: i is not the first of a clump. */
double dem_clump_light(int n, const struct dem_entry *entry);
/* Collective. K of own members and of ghosts. */
int dem_clumps_turns(struct dem_t *dem);
/* 1/kg: how much an impulse along n changes the approach of particles i, j, own or ghosts (R.4). */
double dem_mobility(const struct dem_t *dem, int i, int j, const double n[3]);

/* Kick of one clump by contact, gravity (m/s2) and fluid over h, and the drift of drift_h (0: none)
 * under them. */
void dem_clump_kick_wet(struct dem_t *dem, dem_clump *clump, const double gravity[3], double h,
                        double drift_h);
/* As those of blocks. */
void dem_clumps_kick_drift(struct dem_t *dem, double t, double h, int fluid);
void dem_clumps_kick(struct dem_t *dem, double t, double h, int fluid);
void dem_clumps_forces(struct dem_t *dem);
/* Add impulse[3 i] (N s) to own member i. */
void dem_clumps_add(struct dem_t *dem, const double *impulse);
/* Bound of the longest way of an own member within dt, without contact. */
double dem_clumps_way(const struct dem_t *dem, double dt);

double dem_clump_energy(const dem_clump *clump);
void dem_clump_rotation(const dem_clump *clump, double omega[3]);

#endif
