/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Exact volume of a sphere in each cell of any polyhedral mesh. Everything is in radii relative to
 * the centre of the sphere.
 *
 * From the cell of the centre we walk over the cells that the ball meets; each face it meets moves
 * the volume behind it (its deficit D) from one side to the other:
 *   V[centre's cell] = Vs;  for every face met: V[owner] -= D, V[neighbour] += D
 * so the sum over cells is Vs by construction. A face of the border takes volume out of the mesh.
 * When the centre is close to a face that the ball meets, D jumps and loses digits: the cells are
 * computed again in the flux form (polyhedron_sphere.h), which is continuous. */
#include "box_sphere.h"
#include "overlap_methods.h"
#include "polyhedron_sphere.h"
#include "search_type.h"
#include "tensor_overlap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double ball = 4.18879020478639098; /* 4 pi / 3 */

/* Nearer than this (in radii) to a face that the ball meets, the transfer form loses more than
 * about 13 digits. */
static const double near_face = 1e-3;

typedef struct {
  cpl_search *s;
  const double *centre;
  double radius, inverse; /* 1 / radius */
  int near, border;       /* some face met is near; the ball reaches a border face */
} walk;

/* ---- faces ----------------------------------------------------------------------------------- */

static inline double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void to_radii(const walk *w, const double *x, double v[3]) {
  for (int d = 0; d < 3; d++)
    v[d] = (x[d] - w->centre[d]) * w->inverse;
}

static inline double relative(const walk *w, const double *x, double v[3]) {
  to_radii(w, x, v);
  return sqrt(dot(v, v));
}

static inline double deficit_form(walk *w, int edges, const cpl_polygon_edge *edge,
                                  const double n[3], double h, int *met) {
  int here;
  const double value = cpl_polygon_deficit(edges, edge, n, h, &here);
  *met |= here;
  w->near |= here && fabs(h) < near_face;
  return value;
}

static inline double flux_form(int edges, const cpl_polygon_edge *edge, const double n[3], double h,
                               const double *v[3]) {
  const double angle = fabs(h) < 1.0 ? 0.0 : cpl_solid_angle(v[0], v[1], v[2]);
  return cpl_polygon_flux(edges, edge, n, h, angle);
}

/* A fan of triangles about the face centre; neighbours in the fan share the spoke between them. */
static double fan_flux(walk *w, int f) {
  const int count = -w->s->plane[f].count;
  double c[3], first[3], v[2][3], r[2], sum = 0.0;
  cpl_edge spoke[2], first_spoke, rim;
  const cpl_face_plane *p = &w->s->plane[f];
  const double(*row)[3] = (const double(*)[3])w->s->corner + p->row; /* normal, corner, ... */
  const double rc = relative(w, p->c, c);
  const double rfirst = relative(w, row[1], first);
  cpl_edge_set(c, rc, first, rfirst, &first_spoke);
  memcpy(v[0], first, sizeof first);
  r[0] = rfirst;
  spoke[0] = first_spoke;
  for (int i = 0; i < count; i++) {
    const int a = i & 1, b = 1 - a;
    if (i + 1 < count) {
      r[b] = relative(w, row[2 * i + 3], v[b]);
      cpl_edge_set(c, rc, v[b], r[b], &spoke[b]);
    } else {
      memcpy(v[b], first, sizeof first);
      r[b] = rfirst;
      spoke[b] = first_spoke;
    }
    const double *n = row[2 * i], h = dot(n, c);
    if (n[0] == 0.0 && n[1] == 0.0 && n[2] == 0.0)
      continue;
    cpl_edge_set(v[a], r[a], v[b], r[b], &rim);
    const cpl_polygon_edge edge[3] = {{&spoke[a], 1.0}, {&rim, 1.0}, {&spoke[b], -1.0}};
    const double *corners[3] = {c, v[a], v[b]};
    sum += flux_form(3, edge, n, h, corners);
  }
  return sum;
}

/* The edge from a to b, not of unit length: n.m = the distance of the ball's foot on the plane of
 * normal n from the line, > 0 on the inner side, times the length. */
typedef struct {
  double m[3], length2;
} line;

static inline void line_set(const double a[3], const double b[3], line *l) {
  const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  l->m[0] = a[1] * u[2] - a[2] * u[1];
  l->m[1] = a[2] * u[0] - a[0] * u[2];
  l->m[2] = a[0] * u[1] - a[1] * u[0];
  l->length2 = dot(u, u);
}

/* The disc of radius^2 r2 in the plane of normal n lies surely on the outer side of a line: then
 * the deficit of a polygon with this edge is 0. Without a root or a division; what round-off could
 * decide otherwise is left to cpl_polygon_deficit. */
static inline int disc_outside(const double n[3], double r2, const line *l, double sign) {
  const double d = sign * dot(n, l->m);
  return d < 0.0 && d * d > 1.0000000001 * r2 * l->length2;
}

/* The same for deficits, where few triangles of a fan are met: roots and edges only for those. */
static double fan_deficit(walk *w, int f, int *met) {
  const cpl_face_plane *p = &w->s->plane[f];
  const double(*row)[3] = (const double(*)[3])w->s->corner + p->row; /* normal, corner, ... */
  const int count = -p->count;
  double c[3], v[2][3], first[3], r[2] = {0.0, 0.0}, sum = 0.0;
  cpl_edge spoke[2], rim;
  line spokes[2], rims;
  int known[2] = {0, 0}; /* r and spoke of v[0], v[1] */
  const double rc = relative(w, p->c, c);
  to_radii(w, row[1], first);
  memcpy(v[0], first, sizeof first);
  line_set(c, v[0], &spokes[0]);
  for (int i = 0; i < count; i++) {
    const int a = i & 1, b = 1 - a;
    const double *n = row[2 * i], h = dot(n, c), r2 = 1.0 - h * h;
    known[b] = 0;
    if (i + 1 < count)
      to_radii(w, row[2 * i + 3], v[b]);
    else
      memcpy(v[b], first, sizeof first);
    line_set(c, v[b], &spokes[b]);
    if (!(r2 > 0.0) || disc_outside(n, r2, &spokes[a], 1.0) ||
        disc_outside(n, r2, &spokes[b], -1.0) || (n[0] == 0.0 && n[1] == 0.0 && n[2] == 0.0))
      continue;
    line_set(v[a], v[b], &rims);
    if (disc_outside(n, r2, &rims, 1.0))
      continue;
    for (int k = 0; k < 2; k++)
      if (!known[k]) {
        r[k] = sqrt(dot(v[k], v[k]));
        cpl_edge_set(c, rc, v[k], r[k], &spoke[k]);
        known[k] = 1;
      }
    cpl_edge_set(v[a], r[a], v[b], r[b], &rim);
    const cpl_polygon_edge edge[3] = {{&spoke[a], 1.0}, {&rim, 1.0}, {&spoke[b], -1.0}};
    sum += deficit_form(w, 3, edge, n, h, met);
  }
  return sum;
}

/* A planar convex face: its corners in radii and its edges, all in its own sense. */
typedef struct {
  double v[CPL_POLYGON_MAX][3];
  cpl_edge edge[CPL_POLYGON_MAX];
  cpl_polygon_edge side[CPL_POLYGON_MAX];
} polygon;

static inline void polygon_corners(const walk *w, int f, int count, polygon *p) {
  const double(*row)[3] = (const double(*)[3])w->s->corner + w->s->plane[f].row;
  to_radii(w, row[0], p->v[0]);
  for (int i = 1; i < count; i++)
    to_radii(w, row[i], p->v[i]);
}

static inline void polygon_edges(int count, polygon *p) {
  double r[CPL_POLYGON_MAX];
  for (int i = 0; i < count; i++)
    r[i] = sqrt(dot(p->v[i], p->v[i]));
  for (int i = 0; i < count; i++) {
    const int j = i + 1 < count ? i + 1 : 0;
    cpl_edge_set(p->v[i], r[i], p->v[j], r[j], &p->edge[i]);
    p->side[i] = (cpl_polygon_edge){&p->edge[i], 1.0};
  }
}

static double polygon_deficit(walk *w, int f, int count, int *met) {
  polygon p;
  polygon_corners(w, f, count, &p);
  const double *n = w->s->plane[f].n, h = dot(n, p.v[0]), r2 = 1.0 - h * h;
  for (int i = 0; i < count; i++) {
    line edge;
    line_set(p.v[i], p.v[i + 1 < count ? i + 1 : 0], &edge);
    if (disc_outside(n, r2, &edge, 1.0))
      return 0.0;
  }
  polygon_edges(count, &p);
  return deficit_form(w, count, p.side, n, h, met);
}

static double polygon_flux(walk *w, int f, int count) {
  polygon p;
  double angle = 0.0;
  polygon_corners(w, f, count, &p);
  polygon_edges(count, &p);
  const double *n = w->s->plane[f].n, h = dot(n, p.v[0]);
  for (int i = 1; i + 1 < count && fabs(h) >= 1.0; i++)
    angle += cpl_solid_angle(p.v[0], p.v[i], p.v[i + 1]);
  return cpl_polygon_flux(count, p.side, n, h, angle);
}

/* D of face f for its owner, in radii cubed. */
static double face_deficit(walk *w, int f, int *met) {
  const int count = w->s->plane[f].count;
  return count > 0 ? polygon_deficit(w, f, count, met) : fan_deficit(w, f, met);
}

static double face_flux(walk *w, int f) {
  const int count = w->s->plane[f].count;
  return count > 0 ? polygon_flux(w, f, count) : fan_flux(w, f);
}

/* ---- cells ----------------------------------------------------------------------------------- */

static int may_meet_face(const walk *w, int f) {
  const cpl_face_plane *p = &w->s->plane[f];
  const double x[3] = {p->c[0] - w->centre[0], p->c[1] - w->centre[1], p->c[2] - w->centre[2]};
  const double reach = (double)p->reach + w->radius;
  return fabs(dot(p->n, x)) < w->radius + (double)p->thickness && dot(x, x) < reach * reach;
}

/* Bound of a cell in radii; 1 when the ball touches it. */
static int touches_bound(const walk *w, int cell, double bound[6]) {
  double gap2 = 0.0;
  for (int d = 0; d < 3; d++) {
    bound[d] = (w->s->bound[cell][d] - w->centre[d]) * w->inverse;
    bound[3 + d] = (w->s->bound[cell][3 + d] - w->centre[d]) * w->inverse;
    const double gap = bound[d] > 0.0 ? bound[d] : bound[3 + d] < 0.0 ? bound[3 + d] : 0.0;
    gap2 += gap * gap;
  }
  return gap2 < 1.0;
}

static void visit_face(walk *w, int cell, int code) {
  cpl_search *s = w->s;
  const int other = cpl_other_cell(s, code);
  if (s->is_box[cell] && (other < 0 || s->is_box[other])) {
    if (other < 0)
      w->border = 1;
    else
      cpl_search_queue(s, other);
    return;
  }
  int met = 0;
  const double deficit = code < 0 ? -face_deficit(w, ~code, &met) : face_deficit(w, code, &met);
  if (!met)
    return;
  s->volume[cell] -= deficit;
  if (other < 0) {
    w->border = 1;
  } else {
    cpl_search_queue(s, other);
    s->volume[other] += deficit;
  }
}

enum { AHEAD = 32 }; /* faces whose corners are on their way from memory */

/* Codes of the faces of a cell from *at on that the ball may meet, and whose other side has not
 * done them; their corners are asked for. Waiting for memory was a fifth of the time. */
static int near_faces(const walk *w, int cell, int *at, int list[AHEAD]) {
  const cpl_search *s = w->s;
  const int end = s->cell_face_start[cell + 1];
  int count = 0, k = *at;
  for (; k < end && count < AHEAD; k++) {
    const int code = s->cell_face[k], f = code < 0 ? ~code : code;
    const int other = cpl_other_cell(s, code);
    double bound[6];
    if ((other >= 0 && s->state[other] == CPL_DONE) || !may_meet_face(w, f) ||
        (other >= 0 && !touches_bound(w, other, bound)))
      continue;
    const double(*row)[3] = (const double(*)[3])s->corner + s->plane[f].row;
    for (int i = 0; i < abs(s->plane[f].count); i += 2)
      __builtin_prefetch(row + (s->plane[f].count < 0 ? 2 * i : i));
    list[count++] = code;
  }
  *at = k;
  return count;
}

/* The faces of a cell that its other side has not done. Between two boxes no deficit is needed:
 * their volumes have a closed form. */
static void visit(walk *w, int cell) {
  cpl_search *s = w->s;
  int list[AHEAD], k = s->cell_face_start[cell];
  for (int i = k; i < s->cell_face_start[cell + 1]; i++)
    __builtin_prefetch(&s->plane[s->cell_face[i] < 0 ? ~s->cell_face[i] : s->cell_face[i]]);
  s->state[cell] = CPL_DONE;
  while (k < s->cell_face_start[cell + 1]) {
    const int count = near_faces(w, cell, &k, list);
    for (int i = 0; i < count; i++)
      visit_face(w, cell, list[i]);
  }
}

/* Volumes of all queued cells that are not boxes, in the flux form. */
static void recompute(walk *w) {
  cpl_search *s = w->s;
  for (int q = 0; q < s->queued; q++) {
    s->state[s->queue[q]] = CPL_QUEUED;
    s->volume[s->queue[q]] = 0.0;
  }
  for (int q = 0; q < s->queued; q++) {
    const int cell = s->queue[q];
    s->state[cell] = CPL_DONE;
    for (int k = s->cell_face_start[cell]; k < s->cell_face_start[cell + 1]; k++) {
      const int code = s->cell_face[k], other = cpl_other_cell(s, code);
      const int ours = other >= 0 && s->state[other] != CPL_UNSEEN;
      if ((ours && s->state[other] == CPL_DONE) || (s->is_box[cell] && (!ours || s->is_box[other])))
        continue;
      const double flux = code < 0 ? -face_flux(w, ~code) : face_flux(w, code);
      s->volume[cell] += flux;
      if (ours)
        s->volume[other] -= flux;
    }
  }
}

static int doubtful(const walk *w) {
  const cpl_search *s = w->s;
  const double scale = w->inverse * w->inverse * w->inverse;
  for (int q = 0; q < s->queued; q++) {
    const int cell = s->queue[q];
    const double v = s->volume[cell], most = fmin(ball, s->mesh->volume[cell] * scale);
    if (!s->is_box[cell] && !(v >= -1e-10 && v <= most * (1.0 + 1e-10) + 1e-10))
      return 1;
  }
  return 0;
}

/* The bound is inside the ball, so the cell is. */
static int swallowed(const double bound[6]) {
  double far2 = 0.0;
  for (int d = 0; d < 3; d++)
    far2 += fmax(bound[d] * bound[d], bound[3 + d] * bound[3 + d]);
  return far2 <= 1.0;
}

static int collect(walk *w, cpl_overlaps *list) {
  cpl_search *s = w->s;
  const double scale = w->radius * w->radius * w->radius;
  for (int q = 0; q < s->queued; q++) {
    const int cell = s->queue[q];
    double bound[6], v = s->volume[cell] * scale;
    if (!touches_bound(w, cell, bound))
      continue;
    if (swallowed(bound))
      v = s->mesh->volume[cell];
    else if (s->is_box[cell])
      v = cpl_box_ball(bound, bound + 3) * scale;
    if (v > 0.0)
      PART_TRY(cpl_overlaps_add(list, cell, v));
  }
  return PART_OK;
}

int cpl_overlap_exact(cpl_search *s, int sub_cells, const double centre[3], double radius,
                      int *hint, cpl_overlaps *list) {
  (void)sub_cells;
  if (!(radius > 0.0 && radius < HUGE_VAL))
    return part_fail(PART_ERR_RANGE, "overlap: radius %g m is not in (0, inf)", radius);
  walk w = {.s = s, .centre = centre, .radius = radius, .inverse = 1.0 / radius};
  *hint = cpl_search_cell(s, centre, *hint);
  if (s->tensor != NULL)
    return cpl_tensor_overlap(s->tensor, s->mesh->volume, centre, radius, list);
  if (*hint >= 0) {
    cpl_search_queue(s, *hint);
    s->volume[*hint] = ball;
  }
  for (int q = 0; q < s->queued; q++)
    visit(&w, s->queue[q]);
  if (*hint < 0 || w.border) {
    const int from = s->queued;
    cpl_search_queue_touching(s, centre, radius, 1); /* it may come back elsewhere */
    for (int q = from; q < s->queued; q++)
      visit(&w, s->queue[q]);
  }
  if (w.near || doubtful(&w))
    recompute(&w);
  const int status = collect(&w, list);
  cpl_search_done(s);
  return status;
}
