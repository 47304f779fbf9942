/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scenes and checks that the tests of libdem share. */
#ifndef TEST_DEM_COMMON_H
#define TEST_DEM_COMMON_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "dem/dem.h"

#define PI 3.14159265358979323846

/* Fails the test with the library's message. */
#define OK(call) check_ok((call), #call, __FILE__, __LINE__)
void check_ok(int status, const char *call, const char *file, int line);

/* The call fails with this status, and the message contains the words. */
#define FAILS(wanted, words, call) check_fails((wanted), (words), (call), #call, __FILE__, __LINE__)
void check_fails(int wanted, const char *words, int status, const char *call, const char *file,
                 int line);

/* |value - wanted| <= tolerance; prints the three otherwise. */
#define CLOSE(value, wanted, tolerance)                                                            \
  check_close((value), (wanted), (tolerance), #value, __FILE__, __LINE__)
void check_close(double value, double wanted, double tolerance, const char *what, const char *file,
                 int line);

/* What a test wants to vary; fill with scene_default() and change. */
typedef struct scene {
  MPI_Comm comm;
  part_box box;
  dem_params params;
  double density, young, poisson, breakage; /* 0: as not given */
  dem_contact contact;
} scene;
/* Rows of contact_laws.def, and a scene with that law, stiffness about as that of scene_default. */
enum { LINEAR, HERTZ, LAWS };
scene scene_with_law(int law);
scene scene_default(void);           /* box -1 .. 1 m, no gravity, one material, mu = 0, e = 1 */
dem_t *scene_create(const scene *s); /* material 0 is called "glass" */

/* One sphere. */
void add_sphere(dem_t *dem, int kind, int block, const double x[3], double r, const double v[3]);
dem_insert lattice(int kind, double diameter, const double origin[3], double spacing, int nx,
                   int ny, int nz);
/* A wall of glass with every entry at its default. */
dem_wall_params wall_of(int type);
/* Random spheres in a region. */
dem_insert random_spheres(int64_t number, double diameter, double diameter_max, const double lo[3],
                          double extent, int64_t seed);

/* State of one particle on every rank (collective). */
typedef struct body {
  double x[3], v[3], w[3], force[3], impulse[3];
} body;
body find(dem_t *dem, MPI_Comm comm, int64_t id);
/* States of all particles by id on every rank (collective): [n]. */
void find_all(dem_t *dem, MPI_Comm comm, int64_t n, body *bodies);
/* Set the fluid force of every particle (own). */
void set_fluid(dem_t *dem, const double su[3], double sp);
/* Give every own particle a velocity that depends on its id only. */
void stir(dem_t *dem, double speed);

/* A flat square of 2 n^2 triangles, edge `size`, centre `at`, with corners displaced at random in
 * the plane; normal is any unit vector. Returns the number of triangles; vertices: 18 n^2. */
int triangulated_square(const double at[3], const double normal[3], double size, int n,
                        double *vertices);

double sphere_mass(double density, double r);
int world_rank(void);
int world_size(void);

#endif
