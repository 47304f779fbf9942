/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which cell contains a point; life of a search. */
#include "search_type.h"
#include "sub_cell.h"
#include "tensor_grid.h"
#include "polyhedron_sphere.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int cpl_search_create(const cpl_mesh *mesh, cpl_search **search) {
  cpl_search *s = calloc(1, sizeof *s);
  *search = NULL;
  if (s == NULL)
    return part_fail(PART_ERR_MEMORY, "search: no memory");
  s->mesh = mesh;
  const size_t n = (size_t)mesh->cells + 1;
  s->state = calloc(n, 1);
  s->volume = malloc(n * sizeof *s->volume);
  s->queue = malloc(n * sizeof *s->queue);
  int status = PART_OK;
  if (s->state == NULL || s->volume == NULL || s->queue == NULL)
    status = part_fail(PART_ERR_MEMORY, "search: no memory for %d cells", mesh->cells);
  if (status == PART_OK)
    status = cpl_search_build_faces(s);
  if (status == PART_OK)
    status = cpl_search_build_cells(s);
  if (status == PART_OK)
    status = cpl_search_build_bins(s);
  if (status == PART_OK)
    status = cpl_tensor_create(s, &s->tensor);
  if (status == PART_OK && s->tensor == NULL)
    status = cpl_search_build_corners(s);
  if (status != PART_OK) {
    cpl_search_destroy(s);
    return status;
  }
  *search = s;
  return PART_OK;
}

void cpl_search_destroy(cpl_search *s) {
  if (s == NULL)
    return;
  free(s->plane);
  free(s->corner);
  free(s->cell_face_start);
  free(s->cell_face);
  free(s->bound);
  free(s->is_box);
  free(s->at_border);
  free(s->bin_start);
  free(s->bin_cell);
  free(s->state);
  free(s->volume);
  free(s->queue);
  cpl_hexes_destroy(s->hexes);
  cpl_tensor_destroy(s->tensor);
  free(s);
}

void cpl_search_bounds(const cpl_search *s, double lo[3], double hi[3]) {
  memcpy(lo, s->lo, sizeof s->lo);
  memcpy(hi, s->hi, sizeof s->hi);
}

void cpl_search_mark(const cpl_search *s, const double lo[3], const double bin[3], const int n[3],
                     unsigned char *mark) {
  for (int c = 0; c < s->mesh->cells; c++) {
    int from[3], to[3];
    for (int d = 0; d < 3; d++) {
      const double last = n[d] - 1;
      from[d] = (int)fmin(fmax(floor((s->bound[c][d] - s->tie - lo[d]) / bin[d]), 0.0), last);
      to[d] = (int)fmin(fmax(floor((s->bound[c][3 + d] + s->tie - lo[d]) / bin[d]), 0.0), last);
    }
    for (int k = from[2]; k <= to[2]; k++)
      for (int j = from[1]; j <= to[1]; j++)
        memset(mark + from[0] + (size_t)n[0] * ((size_t)j + (size_t)n[1] * (size_t)k), 1,
               (size_t)(to[0] - from[0] + 1));
  }
}

/* ---- point in cell --------------------------------------------------------------------------- */

/* x sees all triangles of a warped face from the inner side. */
static int sees_fan(const cpl_search *s, int f, double sign, const double x[3]) {
  const double *c = s->plane[f].c, u[3] = {c[0] - x[0], c[1] - x[1], c[2] - x[2]};
  for (int i = 0; i < -s->plane[f].count; i++) {
    const double *n = s->corner[s->plane[f].row + 2 * i];
    if (sign * (n[0] * u[0] + n[1] * u[1] + n[2] * u[2]) <= s->tie)
      return 0;
  }
  return s->plane[f].count < 0;
}

int cpl_search_surely_in(const cpl_search *s, int cell, const double x[3]) {
  const double *b = s->bound[cell];
  for (int d = 0; d < 3; d++)
    if (!(x[d] > b[d] + s->tie && x[d] < b[3 + d] - s->tie))
      return 0;
  if (s->is_box[cell])
    return 1;
  for (int k = s->cell_face_start[cell]; k < s->cell_face_start[cell + 1]; k++) {
    const int code = s->cell_face[k];
    const cpl_face_plane *p = &s->plane[code < 0 ? ~code : code];
    const double h =
        p->n[0] * (p->c[0] - x[0]) + p->n[1] * (p->c[1] - x[1]) + p->n[2] * (p->c[2] - x[2]);
    const double sign = code < 0 ? -1.0 : 1.0;
    const double thickness = (double)p->thickness;
    if (sign * h <= thickness + s->tie &&
        (sign * h < -thickness || !sees_fan(s, code < 0 ? ~code : code, sign, x)))
      return 0; /* x does not see this face surely from inside */
  }
  return 1; /* all solid angles are positive, so x is inside, whatever the shape */
}

/* x lies on the triangle abc to within tie. */
static int on_triangle(const double a[3], const double b[3], const double c[3], double tie) {
  const double *v[3] = {a, b, c};
  double n[3] = {0.0, 0.0, 0.0}, m[3][3], size;
  for (int i = 0; i < 3; i++) {
    const double *p = v[i], *q = v[(i + 1) % 3];
    m[i][0] = p[1] * q[2] - p[2] * q[1];
    m[i][1] = p[2] * q[0] - p[0] * q[2];
    m[i][2] = p[0] * q[1] - p[1] * q[0];
    for (int d = 0; d < 3; d++)
      n[d] += m[i][d];
  }
  size = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  if (!(size > 0.0) || fabs(n[0] * a[0] + n[1] * a[1] + n[2] * a[2]) > tie * size)
    return 0;
  for (int i = 0; i < 3; i++) {
    const double *p = v[i], *q = v[(i + 1) % 3];
    const double u[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
    const double inner = (m[i][0] * n[0] + m[i][1] * n[1] + m[i][2] * n[2]) / size;
    if (inner < -tie * sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]))
      return 0;
  }
  return 1;
}

int cpl_search_in(const cpl_search *s, int cell, const double x[3]) {
  const cpl_mesh *m = s->mesh;
  const double *bound = s->bound[cell];
  for (int d = 0; d < 3; d++)
    if (!(x[d] >= bound[d] - s->tie && x[d] <= bound[3 + d] + s->tie))
      return 0;
  if (s->is_box[cell])
    return 1 + cpl_search_surely_in(s, cell, x);
  double sum = 0.0; /* solid angles of the surface: 4 pi inside, 0 outside */
  for (int k = s->cell_face_start[cell]; k < s->cell_face_start[cell + 1]; k++) {
    const int code = s->cell_face[k], f = code < 0 ? ~code : code;
    const int *p = m->face_point + m->face_start[f], n = m->face_start[f + 1] - m->face_start[f];
    const int planar = s->plane[f].count > 0;
    const double *apex = planar ? m->point + 3 * p[0] : s->plane[f].c;
    const double a[3] = {apex[0] - x[0], apex[1] - x[1], apex[2] - x[2]};
    for (int i = planar ? 1 : 0; i < (planar ? n - 1 : n); i++) {
      const double *q = m->point + 3 * p[i], *r = m->point + 3 * p[(i + 1) % n];
      const double b[3] = {q[0] - x[0], q[1] - x[1], q[2] - x[2]};
      const double c[3] = {r[0] - x[0], r[1] - x[1], r[2] - x[2]};
      if (on_triangle(a, b, c, s->tie))
        return 1;
      sum += (code < 0 ? -1.0 : 1.0) * cpl_solid_angle(a, b, c);
    }
  }
  return sum > 6.28318530717958648 ? 2 : 0;
}

int cpl_search_cell(cpl_search *s, const double x[3], int hint) {
  if (s->tensor != NULL)
    return cpl_tensor_cell(s->tensor, x, s->tie);
  if (hint >= 0 && hint < s->mesh->cells) {
    if (cpl_search_surely_in(s, hint, x) || cpl_search_in(s, hint, x) == 2)
      return hint;
    for (int k = s->cell_face_start[hint]; k < s->cell_face_start[hint + 1]; k++) {
      const int other = cpl_other_cell(s, s->cell_face[k]);
      if (other >= 0 && cpl_search_surely_in(s, other, x))
        return other;
    }
  }
  int from[3], to[3];
  double lo[3], hi[3];
  for (int d = 0; d < 3; d++) { /* on the border of the mesh counts as inside */
    lo[d] = x[d] - s->tie;
    hi[d] = x[d] + s->tie;
  }
  if (s->mesh->cells == 0 || !cpl_search_bin_range(s, lo, hi, from, to))
    return -1;
  /* every cell that has x within its bound is in the bin of x; bin lists are ascending */
  for (int d = 0; d < 3; d++)
    from[d] = (int)fmin(fmax((x[d] - s->lo[d]) * s->bin_inverse[d], 0.0), s->bins[d] - 1);
  const int b = from[0] + s->bins[0] * (from[1] + s->bins[1] * from[2]);
  for (int k = s->bin_start[b]; k < s->bin_start[b + 1]; k++)
    if (cpl_search_surely_in(s, s->bin_cell[k], x)) /* cheap, and then no other has it */
      return s->bin_cell[k];
  for (int k = s->bin_start[b]; k < s->bin_start[b + 1]; k++)
    if (cpl_search_in(s, s->bin_cell[k], x))
      return s->bin_cell[k];
  return -1;
}

/* ---- cells near a sphere --------------------------------------------------------------------- */

static int touches(const double bound[6], const double centre[3], double radius) {
  double gap2 = 0.0;
  for (int d = 0; d < 3; d++) {
    const double below = bound[d] - centre[d], above = centre[d] - bound[3 + d];
    const double gap = below > 0.0 ? below : above > 0.0 ? above : 0.0;
    gap2 += gap * gap;
  }
  return gap2 < radius * radius;
}

void cpl_search_queue_touching(cpl_search *s, const double centre[3], double radius,
                               int border_only) {
  int from[3], to[3];
  double lo[3], hi[3];
  for (int d = 0; d < 3; d++) {
    lo[d] = centre[d] - radius;
    hi[d] = centre[d] + radius;
  }
  if (s->mesh->cells == 0 || !cpl_search_bin_range(s, lo, hi, from, to))
    return;
  for (int k = from[2]; k <= to[2]; k++)
    for (int j = from[1]; j <= to[1]; j++)
      for (int i = from[0]; i <= to[0]; i++) {
        const int b = i + s->bins[0] * (j + s->bins[1] * k);
        for (int e = s->bin_start[b]; e < s->bin_start[b + 1]; e++) {
          const int cell = s->bin_cell[e];
          if (s->state[cell] == CPL_UNSEEN && (!border_only || s->at_border[cell]) &&
              touches(s->bound[cell], centre, radius))
            cpl_search_queue(s, cell);
        }
      }
}

void cpl_search_done(cpl_search *s) {
  for (int q = 0; q < s->queued; q++)
    s->state[s->queue[q]] = CPL_UNSEEN;
  s->queued = 0;
}

void cpl_search_set_reach(cpl_search *s, double reach) {
  s->kernel_reach = reach;
}
