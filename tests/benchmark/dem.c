/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Contact loop: particle-steps a second of four scenes, and steps of dilute ones. Used by
 * tests/benchmark/dem.
 *
 *   dem make bed|gas|drum FILE         a start state: x y z d vx vy vz, one particle a line; drum:
 *                                      also its triangles, FILE.stl
 *   dem tile FILE TO TILE_X TILE_Y     copies of a bed in x and y
 *   dem run bed|gas|drum FILE REPEATS STEPS [WIDTH [TILE_X TILE_Y]]
 *   dem dilute fall|fly TIME           TIME s of few spheres, with skip and without
 *
 * 10,000 spheres of 2500 kg/m3; linear spring and dashpot, k_n = 1000 N/m, k_t = 2/7 k_n, e = 0.9,
 * mu = 0.5; step t_c/50. bed: of 1 mm, settled on a plane of 20 d x 20 d, periodic sideways. gas:
 * of 1 mm in a periodic cube, solid fraction 0.3. drum: of 2 mm in a drum of 100 mm, 20 mm wide
 * between planes, a barrel of 768 triangles that makes one turn a second. run prints "steps
 * <particles> <substeps> <rebuilds> <seconds> <wall seconds> <bytes>" for every repeat: processor
 * time and clock of the slowest rank, bytes that ranks sent each other. WIDTH limits the vectors
 * (8, 4; 1: plain loop; 0: what the processor has). dilute prints "dilute <steps> <steps of skip
 * off> <largest difference of positions, m>". */
#define _POSIX_C_SOURCE 200809L
#include <time.h>

#include "demStart.h"

/* Bytes sent to other ranks, and processor time inside calls that wait for them (it is mostly
 * polling): libraries' calls go through here by the profiling interface of MPI. */
static double bytes_sent, waited;

static double processor_time(void) { /* of this process only: the machine may be shared */
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

int MPI_Isend(const void *data, int count, MPI_Datatype type, int to, int tag, MPI_Comm comm,
              MPI_Request *request) {
  int size, rank;
  PMPI_Type_size(type, &size);
  PMPI_Comm_rank(comm, &rank);
  bytes_sent += to == rank ? 0.0 : (double)count * size;
  return PMPI_Isend(data, count, type, to, tag, comm, request);
}

int MPI_Waitall(int count, MPI_Request *requests, MPI_Status *statuses) {
  const double start = processor_time();
  const int status = PMPI_Waitall(count, requests, statuses);
  waited += processor_time() - start;
  return status;
}

int MPI_Allreduce(const void *from, void *to, int count, MPI_Datatype type, MPI_Op op,
                  MPI_Comm comm) {
  const double start = processor_time();
  const int status = PMPI_Allreduce(from, to, count, type, op, comm);
  waited += processor_time() - start;
  return status;
}

/* The file nx x ny times side by side. */
static void tile(const char *from, const char *to, int nx, int ny) {
  FILE *in = fopen(from, "r"), *out = open_file(to);
  const double edge = box_of(BED).hi[0];
  double x[3], v[3], size;
  if (in == NULL) {
    fprintf(stderr, "dem: %s cannot be read\n", from);
    exit(1);
  }
  while (fscanf(in, "%lf %lf %lf %lf %lf %lf %lf", x, x + 1, x + 2, &size, v, v + 1, v + 2) == 7)
    for (int k = 0; k < nx * ny; k++) {
      const double at[3] = {x[0] + k % nx * edge, x[1] + k / nx * edge, x[2]};
      write_line(out, at, size, v);
    }
  fclose(in);
  fclose(out);
}

static double clock_now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void one_repeat(dem_t *dem, scene what, int steps) {
  dem_report before, after;
  int rank;
  check(dem_get_report(dem, &before));
  double time[3] = {processor_time(), clock_now(), -waited}, bytes = bytes_sent;
  for (int s = 0; s < steps; s += 100)
    check(dem_advance(dem, 100 * step(what), NULL));
  time[0] = processor_time() - time[0];
  time[1] = clock_now() - time[1];
  time[2] = time[0] - (time[2] + waited);
  double share = time[0] / time[1];
  bytes = bytes_sent - bytes;
  check(dem_get_report(dem, &after));
  MPI_Allreduce(MPI_IN_PLACE, time, 3, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
  MPI_Allreduce(MPI_IN_PLACE, &share, 1, MPI_DOUBLE, MPI_MIN, MPI_COMM_WORLD);
  MPI_Allreduce(MPI_IN_PLACE, &bytes, 1, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  if (rank == 0)
    printf("steps %lld %lld %lld %.6f %.6f %.6f %.3f %.0f\n", (long long)after.particles,
           after.substeps - before.substeps, after.rebuilds - before.rebuilds, time[0], time[1],
           time[2], share, bytes);
  fflush(stdout);
}

static void run(scene what, const char *path, int repeats, int steps, int width, int nx, int ny) {
  dem_t *dem = create(MPI_COMM_WORLD, what, path, nx, ny, 1);
  char text[2000];
  int rank;
  check(dem_fast_limit(dem, width));
  insert_file(dem, path);
  check(dem_start(dem));
  check(dem_advance(dem, 200 * step(what), NULL));
  for (int k = 0; k < repeats; k++)
    one_repeat(dem, what, steps);
  check(part_timers_report(dem_timers(dem), MPI_COMM_WORLD, sizeof text, text));
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  if (rank == 0)
    fprintf(stderr, "%s", text);
  dem_destroy(dem);
}

/* fall: one sphere, on a plane. fly: 100 in a periodic cube of 100 d. x: [number][3] by id. */
static long long fly(scene what, int number, double time, int skip, double *x) {
  const part_box box = box_of(what);
  dem_t *dem = create(MPI_COMM_SELF, what, "", 1, 1, skip);
  dem_insert insert;
  dem_report report;
  part_params_default(&dem_insert_table, &insert);
  insert.method = DEM_INSERT_RANDOM;
  strcpy(insert.material, "glass");
  insert.diameter = diameter(what);
  insert.number = number;
  for (int c = 0; c < 3; c++) {
    insert.origin[c] = what == FALL ? 0.05 : 0.0;
    insert.extent[c] = what == FALL ? 0.01 : box.hi[c];
    insert.velocity[c] = c == 0 ? 0.3 : 0.0;
  }
  check(dem_insert_particles(dem, &insert, -1, NULL));
  check(dem_start(dem));
  for (int i = 0; i < dem_store(dem)->local; i++)
    for (int c = 0; what == FLY && c < 3; c++)
      dem_vm(dem)[DEM_VM * (size_t)i + (size_t)c] +=
          0.1 * sin(1.0 + 3.0 * (double)dem_id(dem, i) + c);
  for (int k = 0; k < 20; k++)
    check(dem_advance(dem, time / 20.0, NULL));
  check(dem_get_report(dem, &report));
  for (int i = 0; i < dem_store(dem)->local; i++) {
    double *at = x + 3 * dem_id(dem, i);
    memcpy(at, dem_xr(dem) + DEM_XR * (size_t)i, 3 * sizeof *at);
    part_box_wrap(&box, at, NULL);
  }
  dem_destroy(dem);
  return report.substeps;
}

static void dilute(scene what, double time) {
  enum { MOST = 100 };
  static double x[2][3 * MOST];
  const int number = what == FALL ? 1 : MOST;
  const long long few = fly(what, number, time, 1, x[0]), all = fly(what, number, time, 0, x[1]);
  double worst = 0.0;
  for (int k = 0; k < 3 * number; k++) {
    const double d = fabs(x[0][k] - x[1][k]);
    worst = fmax(worst, fmin(d, fabs(box_of(what).hi[0] - d)));
  }
  printf("dilute %lld %lld %.2e\n", few, all, worst);
}

static scene find_scene(const char *name) {
  int what = 0;
  while (what < SCENES && strcmp(name, names[what]) != 0)
    what++;
  if (what == SCENES) {
    fprintf(stderr, "dem: no scene '%s'\n", name);
    exit(2);
  }
  return (scene)what;
}

int main(int argc, char **argv) {
  MPI_Init(&argc, &argv);
  if (argc == 4 && strcmp(argv[1], "make") == 0) {
    make(find_scene(argv[2]), argv[3]);
  } else if (argc == 6 && strcmp(argv[1], "tile") == 0) {
    tile(argv[2], argv[3], atoi(argv[4]), atoi(argv[5]));
  } else if (argc >= 6 && strcmp(argv[1], "run") == 0) {
    run(find_scene(argv[2]), argv[3], atoi(argv[4]), atoi(argv[5]), argc > 6 ? atoi(argv[6]) : 0,
        argc > 7 ? atoi(argv[7]) : 1, argc > 8 ? atoi(argv[8]) : 1);
  } else if (argc == 4 && strcmp(argv[1], "dilute") == 0) {
    dilute(find_scene(argv[2]), atof(argv[3]));
  } else {
    fprintf(stderr, "usage: see the head of dem.c\n");
    return 2;
  }
  MPI_Finalize();
  return 0;
}
