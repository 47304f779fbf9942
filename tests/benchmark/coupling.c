/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Time of the stages of an exchange, per sphere: CPU time of the busiest rank, median over repeats.
 *   coupling MESH [SPHERES]      MESH: cartesian, polyhedra, warped
 * 27,000 cells (polyhedra: 30,000, duals of tetrahedra with 14 planar faces; warped: the same with
 * corners moved by up to a tenth of an edge), 40,000 spheres of half a cell edge, in the order of
 * their cells as a particle store has them, a little elsewhere in every repeat. On several ranks
 * the cells are divided along z and the spheres along y, so that both must meet: the busiest rank's
 * time for all spheres is printed. Prints lines "MESH STAGE nanoseconds". */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "../coupling/scene.h"

/* helpers of tests/coupling; a benchmark is one program */
#include "../coupling/mesh_build.c"
#include "../coupling/mesh_dual.c"
#include "../coupling/mesh_maker.c"
#include "../coupling/scene.c"

enum { EDGE = 30, REPEATS = 21, STAGES = 6 };
static const char *const names[STAGES] = {"locate", "voidFraction", "sample",
                                          "force",  "source",       "reaction"};

static double seconds(void) { /* of this process only: the machine may be shared */
  return (double)clock() / CLOCKS_PER_SEC;
}

static int by_value(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static int by_slot(const void *a, const void *b) {
  const particle *p = a, *q = b;
  for (int k = 2; k >= 0; k--) {
    const int i = (int)(p->x[k] * EDGE), j = (int)(q->x[k] * EDGE);
    if (i != j)
      return i - j;
  }
  return 0;
}

/* Slab of this rank in y; ids count through all. */
static void own_particles(scene *s, int count, const particle *all) {
  scene_particles(s, 0, all, 0, 0);
  free(s->row);
  free(s->number);
  s->row = mesh_alloc((size_t)count * ROW_WIDTH + 1, sizeof *s->row);
  s->number = mesh_alloc((size_t)count * 2 + 1, sizeof *s->number);
  s->view.count = 0;
  for (int i = 0; i < count; i++)
    if ((int)(all[i].x[1] * s->size) == s->rank)
      add_particle(s, i, &all[i]);
  const int own = s->view.count;
  double *row = s->row;
  s->view.position = row + ROW_X;
  s->view.radius = row + ROW_R;
  s->view.velocity = row + ROW_V;
  s->view.inverse_mass = row + ROW_IMASS;
  s->view.fluid_su = row + ROW_SU;
  s->view.fluid_sp = row + ROW_SP;
  s->view.fluid_impulse = row + ROW_J;
  s->view.id = s->number;
  s->view.kind = s->number + 1;
  s->view.count = own;
}

static void shift(scene *s, double by) {
  for (int i = 0; i < s->view.count; i++)
    for (int k = 0; k < 3; k++)
      s->row[(size_t)i * ROW_WIDTH + (size_t)k] += by;
}

/* What the particles would receive in a step: the force that they were told. */
static void receive(scene *s, double dt) {
  for (int i = 0; i < s->view.count; i++) {
    double *row = s->row + (size_t)i * ROW_WIDTH;
    for (int k = 0; k < 3; k++)
      row[ROW_J + k] = dt * (row[ROW_SU + k] - row[ROW_SP] * row[ROW_V + k]);
  }
}

/* Reactions as D and the volume of solids have them, so that no cell without particles has one. */
static void react(const scene *s, double *drag, double *volume) {
  for (int c = 0; c < s->mesh.view.cells; c++)
    for (int k = 0; k < 3; k++) {
      drag[3 * c + k] = 1e-7 * s->coefficient[c] * s->mesh.view.volume[c];
      volume[3 * c + k] = 1e-3 * (1.0 - s->eps[c]) * s->mesh.view.volume[c];
    }
}

static void exchange(scene *s, double *drag, double *volume, double *kick, double time[STAGES]) {
  const double dt = 1e-4;
  double at[STAGES + 1];
  at[0] = seconds();
  must(cpl_locate(s->cpl, &s->view) == PART_OK, "locate");
  at[1] = seconds();
  must(cpl_void_fraction(s->cpl, &s->view, &s->cells, NULL) == PART_OK, "void fraction");
  at[2] = seconds();
  must(cpl_sample_fluid(s->cpl, &s->view, &s->cells) == PART_OK, "sample");
  at[3] = seconds();
  must(cpl_fluid_force(s->cpl, &s->view) == PART_OK, "force");
  at[4] = seconds();
  receive(s, dt);
  const double between = seconds();
  must(cpl_momentum_source(s->cpl, &s->view, &s->cells, dt) == PART_OK, "source");
  at[5] = seconds() - (between - at[4]);
  react(s, drag, volume);
  const double again = seconds();
  must(cpl_reaction(s->cpl, &s->view, drag, volume, dt, kick) == PART_OK, "reaction");
  at[6] = at[5] + seconds() - again;
  for (int k = 0; k < STAGES; k++)
    time[k] = at[k + 1] - at[k];
}

int main(int argc, char **argv) {
  MPI_Init(&argc, &argv);
  const char *mesh = argc > 1 ? argv[1] : "";
  const int count = argc > 2 ? atoi(argv[2]) : 40000, warped = strcmp(mesh, "warped") == 0;
  const int poly = warped || strcmp(mesh, "polyhedra") == 0;
  if ((!poly && strcmp(mesh, "cartesian") != 0) || count < 1) {
    fprintf(stderr, "usage: coupling cartesian|polyhedra|warped [SPHERES]\n");
    return 2;
  }
  mesh_options options = MESH_UNIT(poly ? MESH_POLY : MESH_HEX, EDGE, EDGE, EDGE);
  options.warp = warped ? 0.1 : 0.0;
  particle *all = mesh_alloc((size_t)count, sizeof *all);
  const mesh_options inner = {.lo = {0.02, 0.02, 0.02}, .hi = {0.98, 0.98, 0.98}};
  scene_random(&inner, count, 0.25 / EDGE, 0.25 / EDGE, 3, all);
  qsort(all, (size_t)count, sizeof *all, by_slot);
  for (int i = 0; i < count; i++)
    all[i].kind = 0;

  scene s;
  const cpl_fluid air = {1.2, 1.8e-5, {0.0, 0.0, -9.81}};
  cpl_params params = scene_params();
  must(part_params_set(&cpl_params_table, "drag", NULL, "gidaspow", &params) == PART_OK, "drag");
  scene_mesh(&s, MPI_COMM_WORLD, &options, 0);
  must(scene_start(&s, &params, &air) == PART_OK, "start");
  own_particles(&s, count, all);
  scene_fluid(&s);
  double *drag = mesh_alloc(3 * (size_t)s.mesh.view.cells + 1, sizeof *drag);
  double *volume = mesh_alloc(3 * (size_t)s.mesh.view.cells + 1, sizeof *volume);
  double *kick = mesh_alloc(3 * (size_t)s.view.count + 1, sizeof *kick);
  double time[STAGES][REPEATS];
  for (int r = -2; r < REPEATS; r++) { /* the first two find memory and cells */
    double now[STAGES], most[STAGES];
    shift(&s, (r & 1 ? 1e-4 : -1e-4) / EDGE);
    exchange(&s, drag, volume, kick, now);
    MPI_Allreduce(now, most, STAGES, MPI_DOUBLE, MPI_MAX, s.comm);
    for (int k = 0; k < STAGES && r >= 0; k++)
      time[k][r] = most[k];
  }
  for (int k = 0; k < STAGES; k++) {
    qsort(time[k], REPEATS, sizeof(double), by_value);
    if (s.rank == 0)
      printf("%s %s %.4g\n", mesh, names[k], 1e9 * time[k][REPEATS / 2] / count);
  }
  free(drag);
  free(volume);
  free(kick);
  free(all);
  scene_free(&s);
  MPI_Finalize();
  return 0;
}
