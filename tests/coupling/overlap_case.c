/* SPDX-License-Identifier: GPL-3.0-or-later */
/* See overlap_case.h. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <cmocka.h>

#include "overlap_case.h"

void overlap_case_make(const mesh_options *options, overlap_case *c) {
  mesh_make(options, &c->mesh);
  ball_cells_create(&c->mesh.view, &c->cells);
  assert_int_equal(cpl_search_create(&c->mesh.view, &c->search), PART_OK);
  c->volume = mesh_alloc((size_t)c->mesh.view.cells, sizeof *c->volume);
  c->cell = 0.0;
  for (int i = 0; i < c->mesh.view.cells; i++)
    c->cell += c->mesh.volume[i] / c->mesh.view.cells;
  c->cell = cbrt(c->cell);
  c->random = 20240229;
}

void overlap_case_free(overlap_case *c) {
  free(c->volume);
  cpl_search_destroy(c->search);
  ball_cells_free(&c->cells);
  mesh_free(&c->mesh);
}

mesh_options overlap_variant(mesh_kind kind, int variant) {
  mesh_options o = MESH_UNIT(kind, 4, 4, 4);
  o.lo[0] = -0.3;
  o.warp = variant > 0 ? 0.2 : 0.0;
  o.seed = 5;
  if (variant == 2) {
    o.shear = 0.3;
    o.rotate[0] = 0.3;
    o.rotate[2] = 1.0;
  }
  return o;
}

static double random_radius(overlap_case *c) {
  if (mesh_random(&c->random) < 0.01)
    return 0.3 + mesh_random(&c->random);
  return c->cell * 0.02 * pow(100.0, mesh_random(&c->random));
}

void random_sphere(overlap_case *c, double centre[3], double *radius) {
  const part_box *b = &c->mesh.box;
  for (int d = 0; d < 3; d++)
    centre[d] = b->lo[d] + (b->hi[d] - b->lo[d]) * (1.1 * mesh_random(&c->random) - 0.05);
  *radius = random_radius(c);
}

static double small_offset(overlap_case *c) { /* 0, or 1e-16 .. 1e-3 of either sign */
  const double u = mesh_random(&c->random);
  if (u < 0.3)
    return 0.0;
  const double size = pow(10.0, -16.0 + 13.0 * mesh_random(&c->random));
  return u < 0.65 ? size : -size;
}

/* Radius such that the sphere is tangent to a random face plane, edge line or vertex. */
static double tangent_radius(overlap_case *c, const double centre[3]) {
  const cpl_mesh *m = &c->mesh.view;
  const int f = (int)(mesh_random(&c->random) * m->faces);
  const int *p = m->face_point + m->face_start[f];
  const double *a = m->point + 3 * p[0], *b = m->point + 3 * p[1], u = mesh_random(&c->random);
  double n[3], x[3], t[3], xt = 0.0, tt = 0.0, xn = 0.0, nn = 0.0, xx = 0.0;
  mesh_face_area(m, f, n);
  for (int d = 0; d < 3; d++) {
    x[d] = centre[d] - a[d];
    t[d] = b[d] - a[d];
    xt += x[d] * t[d];
    tt += t[d] * t[d];
    xn += x[d] * n[d];
    nn += n[d] * n[d];
    xx += x[d] * x[d];
  }
  if (u < 0.4)
    return fabs(xn) / sqrt(nn);
  return u < 0.7 ? sqrt(fmax(0.0, xx - xt * xt / tt)) : sqrt(xx);
}

void degenerate_sphere(overlap_case *c, double centre[3], double *radius) {
  const cpl_mesh *m = &c->mesh.view;
  const double u = mesh_random(&c->random);
  random_sphere(c, centre, radius);
  if (u < 0.3) {
    const double r = tangent_radius(c, centre) * (1.0 + small_offset(c));
    if (r > 0.02 * c->cell && r < 2.0)
      *radius = r;
    return;
  }
  const int f = (int)(mesh_random(&c->random) * m->faces);
  const int *p = m->face_point + m->face_start[f], n = m->face_start[f + 1] - m->face_start[f];
  const int i = (int)(mesh_random(&c->random) * n);
  const double w = u < 0.5 ? 0.0 : mesh_random(&c->random); /* a vertex, or on an edge */
  for (int d = 0; d < 3; d++) {
    centre[d] = (1.0 - w) * m->point[3 * p[i] + d] + w * m->point[3 * p[(i + 1) % n] + d];
    if (u > 0.9)
      centre[d] = m->cell_centre[3 * m->owner[f] + d];
    else if (u > 0.7)
      centre[d] = m->face_centre[3 * f + d];
    centre[d] += *radius * small_offset(c);
  }
}

double overlap_run(overlap_case *c, const double centre[3], double radius, int *hint) {
  const double scale = 1.0 / (BALL * radius * radius * radius);
  cpl_overlaps list = {0};
  double sum = 0.0;
  for (int i = 0; i < c->mesh.view.cells; i++)
    c->volume[i] = 0.0;
  assert_int_equal(cpl_overlap_exact(c->search, 0, centre, radius, hint, &list), PART_OK);
  for (int k = 0; k < list.count; k++) {
    assert_true(list.volume[k] > 0.0);
    assert_true(c->volume[list.cell[k]] == 0.0);
    c->volume[list.cell[k]] = list.volume[k] * scale;
    sum += list.volume[k] * scale;
  }
  cpl_overlaps_free(&list);
  return sum;
}

double overlap_error(overlap_case *c, ball_reference reference, const double centre[3],
                     double radius, double *sum) {
  long double worst = 0.0L, total = 0.0L;
  for (int i = 0; i < c->mesh.view.cells; i++) {
    long double v = 0.0L;
    if (ball_may_touch(&c->cells, i, centre, radius))
      v = reference(&c->cells, i, centre, radius) / 4.18879020478639098461685784437267051L;
    worst = fmaxl(worst, fabsl(v - c->volume[i]));
    total += v;
  }
  *sum = (double)total;
  return (double)worst;
}

int overlap_spheres(int otherwise) {
  const char *text = getenv("OVERLAP_SPHERES");
  const int n = text != NULL ? atoi(text) : 0;
  return n > 0 ? n : otherwise;
}
