/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shapes and insertions that the tests of clumps share. */
#ifndef TEST_DEM_CLUMP_SCENES_H
#define TEST_DEM_CLUMP_SCENES_H

#include "common.h"

/* A file that all ranks see; rank 0 writes. Collective over MPI_COMM_WORLD. The names are those
 * that remove_clump_files knows; the path is good for some calls. */
const char *write_clump_file(const char *name, const char *text);
int remove_clump_files(void **state);

const char *top_shape(void); /* principal axes x, y, z; I_x < I_y < I_z */
const char *rod_shape(void); /* two touching spheres of radius 0.005 along x */
const char *ell_shape(void); /* five spheres, no symmetry, about 0.02 m */

/* One clump in the attitude of its file. */
dem_insert one_clump(const char *shape, const double at[3], const double v[3], const double w[3]);
/* Random clumps in a box. */
dem_insert random_clumps(const char *shape, int64_t number, double diameter, double diameter_max,
                         const double lo[3], double extent, int64_t seed);

/* b = q a q* */
void turn_vector(const double q[4], const double a[3], double b[3]);

#endif
