/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Faces as planes and fans, cells as lists of faces and boxes, bins. See search.h. */
#include "search_type.h"
#include "polyhedron_sphere.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double *point_of(const cpl_mesh *m, int f, int i) {
  return m->point + 3 * m->face_point[m->face_start[f] + i];
}

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* n += (a - c) x (b - c) */
static void add_cross(const double c[3], const double a[3], const double b[3], double n[3]) {
  const double u[3] = {a[0] - c[0], a[1] - c[1], a[2] - c[2]};
  const double v[3] = {b[0] - c[0], b[1] - c[1], b[2] - c[2]};
  n[0] += u[1] * v[2] - u[2] * v[1];
  n[1] += u[2] * v[0] - u[0] * v[2];
  n[2] += u[0] * v[1] - u[1] * v[0];
}

static void make_unit(double n[3]) { /* 0 stays 0 */
  const double size = sqrt(dot(n, n));
  for (int d = 0; d < 3 && size > 0.0; d++)
    n[d] /= size;
}

/* No corner turns the wrong way, seen along the unit normal n. */
static int is_convex(const cpl_mesh *m, int f, int count, const double n[3]) {
  for (int i = 0; i < count; i++) {
    double t[3] = {0.0, 0.0, 0.0};
    add_cross(point_of(m, f, i), point_of(m, f, (i + 1) % count), point_of(m, f, (i + 2) % count),
              t);
    if (dot(t, n) < 0.0)
      return 0;
  }
  return 1;
}

/* Plane of face f; returns 1 when the face is planar (to round-off) and convex. */
static int build_plane(cpl_search *s, int f, int count, double round_off) {
  const cpl_mesh *m = s->mesh;
  cpl_face_plane *p = &s->plane[f];
  memset(p, 0, sizeof *p);
  double thickness = 0.0, reach = 0.0;
  memcpy(p->c, m->face_centre + 3 * f, sizeof p->c);
  for (int i = 0; i < count; i++)
    add_cross(p->c, point_of(m, f, i), point_of(m, f, (i + 1) % count), p->n);
  make_unit(p->n);
  for (int i = 0; i < count; i++) {
    const double *v = point_of(m, f, i);
    const double u[3] = {v[0] - p->c[0], v[1] - p->c[1], v[2] - p->c[2]};
    thickness = fmax(thickness, fabs(dot(u, p->n)));
    reach = fmax(reach, sqrt(dot(u, u)));
  }
  p->thickness = nextafterf((float)thickness, HUGE_VALF);
  p->reach = nextafterf((float)reach, HUGE_VALF);
  return count == 3 || (count <= CPL_POLYGON_MAX && thickness <= 1e-14 * reach + round_off &&
                        is_convex(m, f, count, p->n));
}

int cpl_search_build_faces(cpl_search *s) {
  const cpl_mesh *m = s->mesh;
  s->plane = aligned_alloc(sizeof *s->plane, ((size_t)m->faces + 1) * sizeof *s->plane);
  if (s->plane == NULL)
    return part_fail(PART_ERR_MEMORY, "search: no memory for %d faces", m->faces);
  double largest = 0.0;
  for (int i = 0; i < 3 * m->points; i++)
    largest = fmax(largest, fabs(m->point[i]));
  for (int f = 0; f < m->faces; f++) {
    const int count = m->face_start[f + 1] - m->face_start[f];
    if (count < 3)
      return part_fail(PART_ERR_ARGUMENT, "search: face %d has %d points, needs 3 or more", f,
                       count);
    const int planar = build_plane(s, f, count, 8e-16 * largest);
    s->plane[f].row = -1;
    s->plane[f].count = planar ? count : -count;
  }
  s->round_off = 2e-15 * largest; /* blockMesh: planes of 90 cells are 5e-16 thick */
  s->tie = 5.0 * s->round_off;
  return PART_OK;
}

int cpl_search_build_corners(cpl_search *s) {
  const cpl_mesh *m = s->mesh;
  size_t rows = 0;
  for (int f = 0; f < m->faces; f++)
    rows += (size_t)abs(s->plane[f].count) * (s->plane[f].count < 0 ? 2 : 1);
  s->corner = rows < INT_MAX ? malloc((rows + 1) * sizeof *s->corner) : NULL;
  if (s->corner == NULL)
    return part_fail(PART_ERR_MEMORY, "search: no memory for %zu corners of faces", rows);
  int row = 0;
  for (int f = 0; f < m->faces; f++) {
    const int count = abs(s->plane[f].count);
    cpl_face_plane *p = &s->plane[f];
    p->row = row;
    for (int i = 0; i < count; i++) {
      if (p->count < 0) {
        double *n = memset(s->corner[row++], 0, sizeof *s->corner);
        add_cross(p->c, point_of(m, f, i), point_of(m, f, (i + 1) % count), n);
        make_unit(n);
      }
      memcpy(s->corner[row++], point_of(m, f, i), sizeof *s->corner);
    }
  }
  return PART_OK;
}

/* ---- cells ----------------------------------------------------------------------------------- */

static int build_cell_faces(cpl_search *s) {
  const cpl_mesh *m = s->mesh;
  s->cell_face_start = calloc((size_t)m->cells + 2, sizeof *s->cell_face_start);
  s->cell_face = malloc(((size_t)m->faces + (size_t)m->internal + 1) * sizeof *s->cell_face);
  if (s->cell_face_start == NULL || s->cell_face == NULL)
    return part_fail(PART_ERR_MEMORY, "search: no memory for the faces of %d cells", m->cells);
  int *start = s->cell_face_start + 1; /* one ahead: filling moves it to its place */
  for (int f = 0; f < m->faces; f++) {
    const int neighbour = f < m->internal ? m->neighbour[f] : 0;
    if (m->owner[f] < 0 || m->owner[f] >= m->cells || neighbour < 0 || neighbour >= m->cells)
      return part_fail(PART_ERR_ARGUMENT, "search: face %d has a cell outside 0 .. %d", f,
                       m->cells - 1);
    start[m->owner[f]]++;
    if (f < m->internal)
      start[neighbour]++;
  }
  int at = 0;
  for (int c = 0; c <= m->cells; c++) {
    const int count = c < m->cells ? start[c] : 0;
    start[c] = at;
    at += count;
  }
  for (int f = 0; f < m->faces; f++) {
    s->cell_face[start[m->owner[f]]++] = f;
    if (f < m->internal)
      s->cell_face[start[m->neighbour[f]]++] = ~f;
  }
  return PART_OK;
}

static void widen(double bound[6], const double x[3]) {
  for (int d = 0; d < 3; d++) {
    bound[d] = fmin(bound[d], x[d]);
    bound[3 + d] = fmax(bound[3 + d], x[d]);
  }
}

/* Every point of the face is, to round-off, in one and the same plane of the bound. */
static int face_on_bound(const cpl_search *s, int f, const double bound[6]) {
  const cpl_mesh *m = s->mesh;
  const int count = m->face_start[f + 1] - m->face_start[f];
  for (int b = 0; b < 6; b++) {
    int on = 1;
    for (int i = 0; i < count && on; i++)
      on = fabs(point_of(m, f, i)[b % 3] - bound[b]) <= s->round_off;
    if (on)
      return 1;
  }
  return 0;
}

int cpl_search_build_cells(cpl_search *s) {
  const cpl_mesh *m = s->mesh;
  const size_t n = (size_t)m->cells + 1;
  s->bound = malloc(n * sizeof *s->bound);
  s->is_box = malloc(n);
  s->at_border = calloc(n, 1);
  if (s->bound == NULL || s->is_box == NULL || s->at_border == NULL)
    return part_fail(PART_ERR_MEMORY, "search: no memory for %d cells", m->cells);
  PART_TRY(build_cell_faces(s));
  for (int d = 0; d < 3; d++) {
    s->lo[d] = HUGE_VAL;
    s->hi[d] = -HUGE_VAL;
  }
  for (int c = 0; c < m->cells; c++) {
    double *b = s->bound[c];
    for (int d = 0; d < 6; d++)
      b[d] = d < 3 ? HUGE_VAL : -HUGE_VAL;
    const int from = s->cell_face_start[c], to = s->cell_face_start[c + 1];
    for (int k = from; k < to; k++) {
      const int f = s->cell_face[k] < 0 ? ~s->cell_face[k] : s->cell_face[k];
      s->at_border[c] |= f >= m->internal;
      for (int i = 0; i < m->face_start[f + 1] - m->face_start[f]; i++)
        widen(b, point_of(m, f, i));
      if (s->plane[f].count < 0)
        widen(b, s->plane[f].c);
    }
    if (to - from < 4)
      return part_fail(PART_ERR_ARGUMENT, "search: cell %d has %d faces, needs 4 or more", c,
                       to - from);
    s->is_box[c] = 1;
    for (int k = from; k < to && s->is_box[c]; k++)
      s->is_box[c] =
          face_on_bound(s, s->cell_face[k] < 0 ? ~s->cell_face[k] : s->cell_face[k], b) ? 1 : 0;
    for (int d = 0; d < 3; d++) {
      s->lo[d] = fmin(s->lo[d], b[d]);
      s->hi[d] = fmax(s->hi[d], b[3 + d]);
    }
  }
  return PART_OK;
}

/* ---- bins ------------------------------------------------------------------------------------ */

int cpl_search_bin_range(const cpl_search *s, const double lo[3], const double hi[3], int from[3],
                         int to[3]) {
  for (int d = 0; d < 3; d++) {
    if (!(hi[d] >= s->lo[d] && lo[d] <= s->hi[d]))
      return 0;
    const double last = s->bins[d] - 1;
    from[d] = (int)fmin(fmax((lo[d] - s->lo[d]) * s->bin_inverse[d], 0.0), last);
    to[d] = (int)fmin(fmax((hi[d] - s->lo[d]) * s->bin_inverse[d], 0.0), last);
  }
  return 1;
}

/* About one bin per cell, as cubic as the mesh allows. */
static void choose_bins(cpl_search *s) {
  double volume = 1.0, length = 0.0;
  for (int d = 0; d < 3; d++)
    length = fmax(length, s->hi[d] - s->lo[d]);
  for (int d = 0; d < 3; d++)
    volume *= fmax(s->hi[d] - s->lo[d], 1e-3 * length) / length;
  const double edge = cbrt(volume / s->mesh->cells) * length;
  for (int d = 0; d < 3; d++) {
    const double size = s->hi[d] - s->lo[d];
    s->bins[d] = (int)fmin(fmax(floor(size / edge), 1.0), 1000.0);
    s->bin_inverse[d] = size > 0.0 ? s->bins[d] / size : 0.0;
  }
}

int cpl_search_build_bins(cpl_search *s) {
  const int cells = s->mesh->cells;
  if (cells == 0)
    return PART_OK;
  choose_bins(s);
  const size_t bins = (size_t)s->bins[0] * (size_t)s->bins[1] * (size_t)s->bins[2];
  s->bin_start = calloc(bins + 2, sizeof *s->bin_start);
  if (s->bin_start == NULL)
    return part_fail(PART_ERR_MEMORY, "search: no memory for %zu bins", bins);
  int *start = s->bin_start + 1;
  for (int fill = 0; fill < 2; fill++) {
    for (int c = 0; c < cells; c++) {
      int from[3], to[3];
      double lo[3], hi[3];
      for (int d = 0; d < 3; d++) { /* a point on a face finds both cells */
        lo[d] = s->bound[c][d] - s->tie;
        hi[d] = s->bound[c][3 + d] + s->tie;
      }
      cpl_search_bin_range(s, lo, hi, from, to);
      for (int k = from[2]; k <= to[2]; k++)
        for (int j = from[1]; j <= to[1]; j++)
          for (int i = from[0]; i <= to[0]; i++) {
            int *slot = &start[i + s->bins[0] * (j + s->bins[1] * k)];
            if (fill)
              s->bin_cell[*slot] = c;
            (*slot)++;
          }
    }
    int at = 0;
    for (size_t b = 0; b <= bins && !fill; b++) {
      const int count = b < bins ? start[b] : 0;
      start[b] = at;
      at += count;
    }
    if (!fill && (s->bin_cell = malloc(((size_t)at + 1) * sizeof *s->bin_cell)) == NULL)
      return part_fail(PART_ERR_MEMORY, "search: no memory for %d bin entries", at);
  }
  return PART_OK;
}
