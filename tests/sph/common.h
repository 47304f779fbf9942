/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scenes and checks that the tests of libsph share. */
#ifndef TEST_SPH_COMMON_H
#define TEST_SPH_COMMON_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "sph/sph.h"

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

/* Water in a box from 0 to length; two dimensions, h = 1.5 dx, no gravity, nothing periodic, to be
 * changed. */
typedef struct scene {
  MPI_Comm comm;
  part_box box;
  sph_params params;
} scene;
scene scene_2d(double length_x, double length_y, double dx);
scene scene_3d(const double length[3], double dx);
sph_t *scene_create(const scene *s);

/* Fill the whole box, or its lower part in y up to `level` with hydrostatic pressure. */
void fill_box(sph_t *sph, const scene *s);
void fill_water(sph_t *sph, const scene *s, double level, int direction);
/* Plane walls at both ends of a direction. */
void add_planes(sph_t *sph, const scene *s, int direction, int slip);

/* Small random velocities, the same for a particle on any number of ranks; before sph_start, so
 * that they are in the momentum to begin with. */
void stir(sph_t *sph, const scene *s, double speed);

typedef struct body {
  double x[3], v[3], p, density, a[3], count;
} body;
/* Particles by id, on every rank. */
void find_all(sph_t *sph, MPI_Comm comm, int64_t first, int64_t n, body *bodies);

int world_rank(void);
int world_size(void);
/* A file of this test and number of ranks, in a temporary folder. */
const char *path_of(const char *name);

#endif
