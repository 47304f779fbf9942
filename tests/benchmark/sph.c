/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Speed of libsph. Used by tests/benchmark/sph.
 *
 *   sph still|dam NX NY NZ STEPS REPEATS [WIDTH]
 *
 * Water of NX x NY x NZ particles 0.01 m apart, h = 1.3 dx, Wendland C2, symplectic steps, density
 * diffusion 0.1, artificial viscosity 0.05, viscosity of water, no-slip walls by ghost points.
 * still: at rest in a tank that it fills sideways, with a free surface. dam: the column falls into
 * a tank three times as long. WIDTH: of the vectors, 0: any. Prints "steps <particles> <steps>
 * <rebuilds> <pair interactions, directed, within the support, a step> <seconds>" for each repeat;
 * everything counts, rebuilds of the lists too. */
#include <stdio.h>
#include <time.h>

#include "../../libsph/src/internal.h"

static void check(int status) {
  if (status == PART_OK)
    return;
  fprintf(stderr, "sph: %s\n", part_last_error());
  MPI_Abort(MPI_COMM_WORLD, 1);
}

static double now(void) {
  struct timespec t;
  timespec_get(&t, TIME_UTC);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static sph_t *make(int dam, const int n[3], int width) {
  const double dx = 0.01, depth = n[2] * dx;
  part_box box = {{0.0, 0.0, 0.0}, {n[0] * dx * (dam ? 3 : 1), n[1] * dx, 1.5 * depth}, {0}, {0}};
  sph_params params;
  sph_insert fill;
  sph_t *sph;
  part_params_default(&sph_params_table, &params);
  part_params_default(&sph_insert_table, &fill);
  params.spacing = dx;
  params.smoothing_length = 1.3 * dx;
  params.density = 1000.0;
  params.viscosity = 1e-3;
  params.artificial_viscosity = 0.05;
  params.gravity[2] = -9.81;
  params.sound_speed = 10.0 * sqrt(9.81 * depth) * (dam ? 2.0 : 1.0);
  check(sph_create(MPI_COMM_WORLD, &box, &params, &sph));
  for (int w = 0; w < 6; w++) {
    sph_wall_params wall;
    char name[2] = {(char)('a' + w), '\0'};
    part_params_default(&sph_wall_table, &wall);
    wall.type = SPH_PLANE;
    wall.normal[w / 2] = w % 2 ? -1.0 : 1.0;
    wall.point[w / 2] = w % 2 ? box.hi[w / 2] : box.lo[w / 2];
    check(sph_add_wall(sph, name, &wall, 0, NULL));
  }
  for (int c = 0; c < 3; c++) {
    fill.origin[c] = 0.0;
    fill.extent[c] = n[c] * dx;
  }
  fill.hydrostatic = 1;
  fill.surface[2] = depth;
  check(sph_insert_box(sph, &fill, NULL));
  check(sph_limit_width(sph, width));
  check(sph_start(sph));
  return sph;
}

static long long interactions(const sph_t *sph) {
  long long count = 0;
  const double *xv = sph_xv(sph);
  for (int i = 0; i < sph->lists.rows; i++)
    for (int k = sph->lists.start[i]; k < sph->lists.start[i + 1]; k++) {
      double d2 = 0.0;
      for (int c = 0; c < 3; c++) {
        const double d = xv[SPH_XV * (size_t)i + (size_t)c] -
                         xv[SPH_XV * (size_t)sph->lists.partner[k] + (size_t)c];
        d2 += d * d;
      }
      count += sph->lists.partner[k] != i && d2 < sph->reach * sph->reach;
    }
  return count;
}

int main(int argc, char **argv) {
  MPI_Init(&argc, &argv);
  if (argc < 7) {
    fprintf(stderr, "sph still|dam NX NY NZ STEPS REPEATS [WIDTH]\n");
    MPI_Abort(MPI_COMM_WORLD, 2);
  }
  const int n[3] = {atoi(argv[2]), atoi(argv[3]), atoi(argv[4])};
  sph_t *sph = make(strcmp(argv[1], "dam") == 0, n, argc > 7 ? atoi(argv[7]) : 0);
  for (int r = 0; r < atoi(argv[6]); r++) {
    double step;
    int steps;
    sph_report before, after;
    check(sph_get_report(sph, &before));
    check(sph_stable_step(sph, &step));
    const double start = now();
    check(sph_advance(sph, step * atoi(argv[5]), &steps));
    const double seconds = now() - start;
    check(sph_get_report(sph, &after));
    printf("steps %lld %d %lld %lld %.6f\n", (long long)after.particles, steps,
           after.rebuilds - before.rebuilds, interactions(sph), seconds);
  }
  sph_destroy(sph);
  MPI_Finalize();
  return 0;
}
