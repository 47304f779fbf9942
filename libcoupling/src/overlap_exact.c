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

static double relative(const walk *w, const double *x, double v[3]) {
  for (int d = 0; d < 3; d++)
    v[d] = (x[d] - w->centre[d]) * w->inverse;
  return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Corners of a face in radii, read when needed: a fan may have any number of them. */
static const double *corner(const walk *w, int f, int i) {
  const cpl_mesh *m = w->s->mesh;
  return m->point + 3 * m->face_point[m->face_start[f] + i];
}

typedef double (*face_form)(walk *w, int edges, const cpl_polygon_edge *edge, const double n[3],
                            double h, const double *v[3], int *met);

static inline double deficit_form(walk *w, int edges, const cpl_polygon_edge *edge,
                                  const double n[3], double h, const double *v[3], int *met) {
  (void)v;
  int here;
  const double value = cpl_polygon_deficit(edges, edge, n, h, &here);
  *met |= here;
  w->near |= here && fabs(h) < near_face;
  return value;
}

static inline double flux_form(walk *w, int edges, const cpl_polygon_edge *edge, const double n[3],
                               double h, const double *v[3], int *met) {
  (void)w;
  (void)met;
  const double angle = fabs(h) < 1.0 ? 0.0 : cpl_solid_angle(v[0], v[1], v[2]);
  return cpl_polygon_flux(edges, edge, n, h, angle);
}

/* A fan of triangles about the face centre; neighbours in the fan share the spoke between them. */
static inline double fan(walk *w, int f, int count, face_form form, int *met) {
  double c[3], first[3], v[2][3], r[2], sum = 0.0;
  cpl_edge spoke[2], first_spoke, rim;
  const double rc = relative(w, w->s->plane[f].c, c);
  const double rfirst = relative(w, corner(w, f, 0), first);
  cpl_edge_set(c, rc, first, rfirst, &first_spoke);
  memcpy(v[0], first, sizeof first);
  r[0] = rfirst;
  spoke[0] = first_spoke;
  for (int i = 0; i < count; i++) {
    const int a = i & 1, b = 1 - a;
    if (i + 1 < count) {
      r[b] = relative(w, corner(w, f, i + 1), v[b]);
      cpl_edge_set(c, rc, v[b], r[b], &spoke[b]);
    } else {
      memcpy(v[b], first, sizeof first);
      r[b] = rfirst;
      spoke[b] = first_spoke;
    }
    const double *n = w->s->triangle_n[w->s->triangle[f] + i], h = dot(n, c);
    if (n[0] == 0.0 && n[1] == 0.0 && n[2] == 0.0)
      continue;
    cpl_edge_set(v[a], r[a], v[b], r[b], &rim);
    const cpl_polygon_edge edge[3] = {{&spoke[a], 1.0}, {&rim, 1.0}, {&spoke[b], -1.0}};
    const double *corners[3] = {c, v[a], v[b]};
    sum += form(w, 3, edge, n, h, corners, met);
  }
  return sum;
}

static double fan_deficit(walk *w, int f, int count, int *met) {
  return fan(w, f, count, deficit_form, met);
}

/* A planar convex face: its corners in radii and its edges, all in its own sense. */
typedef struct {
  double v[CPL_POLYGON_MAX][3];
  cpl_edge edge[CPL_POLYGON_MAX];
  cpl_polygon_edge side[CPL_POLYGON_MAX];
} polygon;

static inline void polygon_set(const walk *w, int f, int count, polygon *p) {
  double r[CPL_POLYGON_MAX];
  for (int i = 0; i < count; i++)
    r[i] = relative(w, corner(w, f, i), p->v[i]);
  for (int i = 0; i < count; i++) {
    const int j = i + 1 < count ? i + 1 : 0;
    cpl_edge_set(p->v[i], r[i], p->v[j], r[j], &p->edge[i]);
    p->side[i] = (cpl_polygon_edge){&p->edge[i], 1.0};
  }
}

static double polygon_deficit(walk *w, int f, int count, int *met) {
  polygon p;
  polygon_set(w, f, count, &p);
  const double *n = w->s->plane[f].n;
  return deficit_form(w, count, p.side, n, dot(n, p.v[0]), NULL, met);
}

static double polygon_flux(walk *w, int f, int count) {
  polygon p;
  double angle = 0.0;
  polygon_set(w, f, count, &p);
  const double *n = w->s->plane[f].n, h = dot(n, p.v[0]);
  for (int i = 1; i + 1 < count && fabs(h) >= 1.0; i++)
    angle += cpl_solid_angle(p.v[0], p.v[i], p.v[i + 1]);
  return cpl_polygon_flux(count, p.side, n, h, angle);
}

/* D of face f for its owner, in radii cubed. */
static double face_deficit(walk *w, int f, int *met) {
  const cpl_mesh *m = w->s->mesh;
  const int count = m->face_start[f + 1] - m->face_start[f];
  return w->s->triangle[f] < 0 ? polygon_deficit(w, f, count, met) : fan_deficit(w, f, count, met);
}

static double face_flux(walk *w, int f) {
  const cpl_mesh *m = w->s->mesh;
  const int count = m->face_start[f + 1] - m->face_start[f];
  int met;
  return w->s->triangle[f] < 0 ? polygon_flux(w, f, count) : fan(w, f, count, flux_form, &met);
}

/* ---- cells ----------------------------------------------------------------------------------- */

static int may_meet_face(const walk *w, int f) {
  const cpl_face_plane *p = &w->s->plane[f];
  const double x[3] = {p->c[0] - w->centre[0], p->c[1] - w->centre[1], p->c[2] - w->centre[2]};
  const double reach = p->reach + w->radius;
  return fabs(dot(p->n, x)) < w->radius + p->thickness && dot(x, x) < reach * reach;
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

/* The faces of a cell that its other side has not done. Between two boxes no deficit is needed:
 * their volumes have a closed form. */
static void visit(walk *w, int cell) {
  cpl_search *s = w->s;
  double bound[6];
  s->state[cell] = CPL_DONE;
  for (int k = s->cell_face_start[cell]; k < s->cell_face_start[cell + 1]; k++) {
    const int code = s->cell_face[k], f = code < 0 ? ~code : code;
    const int other = cpl_other_cell(s, code);
    if ((other >= 0 && s->state[other] == CPL_DONE) || !may_meet_face(w, f))
      continue;
    if (other >= 0 && !touches_bound(w, other, bound))
      continue;
    if (s->is_box[cell] && (other < 0 || s->is_box[other])) {
      if (other < 0)
        w->border = 1;
      else
        cpl_search_queue(s, other);
      continue;
    }
    int met = 0;
    const double deficit = code < 0 ? -face_deficit(w, f, &met) : face_deficit(w, f, &met);
    if (!met)
      continue;
    s->volume[cell] -= deficit;
    if (other < 0) {
      w->border = 1;
    } else {
      cpl_search_queue(s, other);
      s->volume[other] += deficit;
    }
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
