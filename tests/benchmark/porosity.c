/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Void-fraction methods: time per sphere, and largest error of the volume in a cell. Spheres of
 * half a cell diameter at random places, in the order of their cells, which are given as hints
 * (tracking knows them). One core. Prints metric porosity.<method>.<mesh>.ns <time per sphere for
 * all cells it touches> ns metric porosity.<method>.<mesh>.error <largest error in a cell>
 * sphereVolumes The error is against ball_reference.c, after dividing by the sum over cells as the
 * coupling does. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "../coupling/ball_reference.h"
#include "../coupling/mesh_maker.h"
#include "../../libcoupling/src/overlap.h"

/* helpers of tests/coupling; a benchmark is one program */
#include "../coupling/ball_reference.c"
#include "../coupling/mesh_build.c"
#include "../coupling/mesh_dual.c"
#include "../coupling/mesh_maker.c"

enum { EDGE = 16, SPHERES = 4000, REFERENCES = 200, REPEATS = 7, SUB_CELLS = 40 };

typedef struct {
  double centre[3], radius;
  int cell;
} sphere;

static void check(int status) {
  if (status != PART_OK) {
    fprintf(stderr, "porosity: %s\n", part_last_error());
    exit(1);
  }
}

static int compare_sphere(const void *a, const void *b) {
  const int x = ((const sphere *)a)->cell, y = ((const sphere *)b)->cell;
  return (x > y) - (x < y);
}

/* Half a cell diameter, cell diameter = (mean volume)^(1/3); away from the border of the mesh. */
static void make_spheres(const made_mesh *m, cpl_search *search, int count, sphere *s) {
  uint64_t state = 7;
  const double edge = cbrt(1.0 / m->view.cells);
  for (int i = 0; i < count; i++) {
    for (int d = 0; d < 3; d++)
      s[i].centre[d] = 0.15 + 0.7 * mesh_random(&state);
    s[i].radius = 0.25 * edge;
    s[i].cell = cpl_search_cell(search, s[i].centre, -1);
  }
  qsort(s, (size_t)count, sizeof *s, compare_sphere);
}

static double seconds(void) { /* of this process only: the machine may be shared */
  return (double)clock() / CLOCKS_PER_SEC;
}

static double time_method(int method, cpl_search *search, const sphere *s, int count) {
  cpl_overlaps list = {0};
  double best = HUGE_VAL;
  for (int r = 0; r < REPEATS; r++) {
    const double start = seconds();
    for (int i = 0; i < count; i++) {
      int hint = s[i].cell;
      list.count = 0;
      check(cpl_overlap(method, search, SUB_CELLS, s[i].centre, s[i].radius, &hint, &list));
    }
    best = fmin(best, (seconds() - start) / count);
  }
  cpl_overlaps_free(&list);
  return 1e9 * best;
}

/* Volumes in all cells, in sphere volumes. */
static void reference(const ball_cells *cells, const sphere *s, double *volume) {
  for (int c = 0; c < cells->mesh->cells; c++)
    volume[c] = ball_may_touch(cells, c, s->centre, s->radius)
                    ? (double)(ball_by_edges(cells, c, s->centre, s->radius) /
                               4.18879020478639098461685784437267051226L)
                    : 0.0;
}

static double error_of(int method, cpl_search *search, const made_mesh *m, const sphere *s,
                       double *volume) {
  cpl_overlaps list = {0};
  double sum = 0.0, worst = 0.0;
  int hint = s->cell;
  check(cpl_overlap(method, search, SUB_CELLS, s->centre, s->radius, &hint, &list));
  for (int k = 0; k < list.count; k++)
    sum += list.volume[k];
  for (int k = 0; k < list.count; k++)
    volume[list.cell[k]] -= list.volume[k] / sum;
  for (int c = 0; c < m->view.cells; c++)
    worst = fmax(worst, fabs(volume[c]));
  for (int k = 0; k < list.count; k++)
    volume[list.cell[k]] += list.volume[k] / sum;
  cpl_overlaps_free(&list);
  return worst;
}

static void measure(const char *mesh_name, const mesh_options *options) {
  static const char *const names[] = {
#define CPL_VOID_FRACTION(name, meaning) #name,
#include "coupling/void_fractions.def"
#undef CPL_VOID_FRACTION
  };
  enum { METHODS = sizeof names / sizeof *names };
  made_mesh m;
  ball_cells cells;
  cpl_search *search;
  sphere *s = mesh_alloc(SPHERES, sizeof *s);
  double error[METHODS] = {0.0};
  mesh_make(options, &m);
  check(cpl_search_create(&m.view, &search));
  ball_cells_create(&m.view, &cells);
  make_spheres(&m, search, SPHERES, s);
  double *volume = mesh_alloc((size_t)m.view.cells, sizeof *volume);
  for (int i = 0; i < REFERENCES; i++) {
    const sphere *one = &s[i * (SPHERES / REFERENCES)];
    reference(&cells, one, volume);
    for (int k = 0; k < METHODS; k++)
      error[k] = fmax(error[k], error_of(k, search, &m, one, volume));
  }
  for (int k = 0; k < METHODS; k++) {
    const int count = strcmp(names[k], "subCell") == 0 ? SPHERES / 20 : SPHERES;
    const double ns = time_method(k, search, s, count);
    printf("metric porosity.%s.%s.ns %.1f ns\n", names[k], mesh_name, ns);
    printf("metric porosity.%s.%s.error %.2e sphereVolumes\n", names[k], mesh_name, error[k]);
  }
  free(volume);
  free(s);
  ball_cells_free(&cells);
  cpl_search_destroy(search);
  mesh_free(&m);
}

int main(void) {
  mesh_options o = MESH_UNIT(MESH_HEX, EDGE, EDGE, EDGE);
  measure("cartesian", &o);
  o.warp = 0.1;
  measure("warpedHex", &o);
  o.kind = MESH_POLY;
  measure("polyhedral", &o);
  o.kind = MESH_TET;
  o.n[0] = o.n[1] = o.n[2] = EDGE / 2;
  measure("tetrahedral", &o);
  return 0;
}
