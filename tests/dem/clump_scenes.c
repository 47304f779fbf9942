/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "clump_scenes.h"

static const char *path_of(const char *name) {
  static char path[8][300];
  static int next;
  const char *folder = getenv("TMPDIR");
  char *to = path[next++ % 8];
  snprintf(to, sizeof path[0], "%s/dem-clump-%s-%d.txt", folder != NULL ? folder : "/tmp", name,
           world_size());
  return to;
}

const char *write_clump_file(const char *name, const char *text) {
  const char *path = path_of(name);
  MPI_Barrier(MPI_COMM_WORLD);
  if (world_rank() == 0) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
  }
  MPI_Barrier(MPI_COMM_WORLD);
  return path;
}

int remove_clump_files(void **state) {
  (void)state;
  static const char *const names[] = {"top", "rod", "ball", "ell", "places", "bad"};
  for (int k = 0; k < 6 && world_rank() == 0; k++)
    remove(path_of(names[k]));
  return 0;
}

const char *top_shape(void) {
  return write_clump_file("top", "0 0 0 0.02\n0.014 0 0 0.02\n-0.014 0 0 0.02\n"
                                 "0 0.008 0 0.018\n0 -0.008 0 0.018\n");
}
const char *rod_shape(void) {
  return write_clump_file("rod", "-0.005 0 0 0.01\n0.005 0 0 0.01\n");
}
const char *ell_shape(void) {
  return write_clump_file("ell", "0 0 0 0.01\n0.006 0 0 0.009\n0.012 0.002 0 0.008\n"
                                 "0 0.006 0.001 0.009\n0 0.003 0.008 0.007\n");
}

dem_insert one_clump(const char *shape, const double at[3], const double v[3], const double w[3]) {
  dem_insert insert = lattice(DEM_CLUMP, 0.0, at, 0.0, 1, 1, 1);
  strcpy(insert.shape, shape);
  insert.orientation = DEM_ORIENTATION_AS_IN_FILE;
  memcpy(insert.velocity, v, sizeof insert.velocity);
  memcpy(insert.angular_velocity, w, sizeof insert.angular_velocity);
  return insert;
}

void turn_vector(const double q[4], const double a[3], double b[3]) {
  /* b = a + 2 w (u x a) + 2 u x (u x a) */
  const double u[3] = {q[1], q[2], q[3]};
  const double c[3] = {u[1] * a[2] - u[2] * a[1], u[2] * a[0] - u[0] * a[2],
                       u[0] * a[1] - u[1] * a[0]};
  const double d[3] = {u[1] * c[2] - u[2] * c[1], u[2] * c[0] - u[0] * c[2],
                       u[0] * c[1] - u[1] * c[0]};
  for (int k = 0; k < 3; k++)
    b[k] = a[k] + 2.0 * q[0] * c[k] + 2.0 * d[k];
}

dem_insert random_clumps(const char *shape, int64_t number, double diameter, double diameter_max,
                         const double lo[3], double extent, int64_t seed) {
  dem_insert insert = random_spheres(number, diameter, diameter_max, lo, extent, seed);
  insert.kind = DEM_CLUMP;
  strcpy(insert.shape, shape);
  return insert;
}
