/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Nearest point of a wall element in the frame of its wall, and the bins in which triangles are
 * looked up. */
#include "internal.h"

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Nearest point a + s ab + t ac of a triangle by the Voronoi region of x; relative to x. */
static int nearest_of_triangle(const dem_element *e, const double x[3], double p[3]) {
  double ab[3], ac[3], ax[3], bx[3], cx[3], s = 0.0, t = 0.0;
  int feature = 2;
  for (int c = 0; c < 3; c++) {
    ab[c] = e->b[c] - e->a[c];
    ac[c] = e->c[c] - e->a[c];
    ax[c] = x[c] - e->a[c];
    bx[c] = x[c] - e->b[c];
    cx[c] = x[c] - e->c[c];
  }
  const double a1 = dot(ab, ax), a2 = dot(ac, ax), b1 = dot(ab, bx), b2 = dot(ac, bx);
  const double c1 = dot(ab, cx), c2 = dot(ac, cx);
  /* Twice the areas of (x b c), (x c a), (x a b) in the plane, times |ab x ac|. */
  const double wa = b1 * c2 - c1 * b2, wb = c1 * a2 - a1 * c2, wc = a1 * b2 - b1 * a2;
  if (a1 <= 0.0 && a2 <= 0.0) {
    /* vertex a */
  } else if (b1 >= 0.0 && b2 <= b1) {
    s = 1.0;
  } else if (c2 >= 0.0 && c1 <= c2) {
    t = 1.0;
  } else if (wc <= 0.0 && a1 >= 0.0 && b1 <= 0.0) {
    feature = 1;
    s = a1 / (a1 - b1);
  } else if (wb <= 0.0 && a2 >= 0.0 && c2 <= 0.0) {
    feature = 1;
    t = a2 / (a2 - c2);
  } else if (wa <= 0.0 && b2 >= b1 && c1 >= c2) {
    feature = 1;
    t = (b2 - b1) / ((b2 - b1) + (c1 - c2));
    s = 1.0 - t;
  } else {
    const double all = wa + wb + wc;
    feature = 0;
    s = wb / all;
    t = wc / all;
  }
  for (int c = 0; c < 3; c++)
    p[c] = s * ab[c] + t * ac[c] - ax[c];
  return feature;
}

/* A plane keeps particles on the side of its normal; a triangle has two sides. The direction is
 * that of the normal, so that a plane and triangles on it give the same. */
static void face(const dem_element *e, const double x[3], double p[3], double n[3],
                 double *distance) {
  const double d[3] = {x[0] - e->a[0], x[1] - e->a[1], x[2] - e->a[2]};
  const double side = dot(d, e->n);
  const double sign = e->shape == DEM_SHAPE_TRIANGLE && side < 0.0 ? -1.0 : 1.0;
  *distance = sign * side;
  for (int c = 0; c < 3; c++) {
    n[c] = sign * e->n[c];
    p[c] = -*distance * n[c];
  }
}

/* x in cylindrical coordinates: height along the axis, distance from it, direction across. */
static void around(const dem_element *e, const double x[3], double *z, double *rho, double out[3]) {
  const double d[3] = {x[0] - e->a[0], x[1] - e->a[1], x[2] - e->a[2]};
  *z = dot(d, e->n);
  for (int c = 0; c < 3; c++)
    out[c] = d[c] - *z * e->n[c];
  *rho = sqrt(dot(out, out));
  if (*rho > 0.0) {
    for (int c = 0; c < 3; c++)
      out[c] /= *rho;
    return;
  }
  /* On the axis any direction across will do. */
  const double *n = e->n;
  const double other[3] = {fabs(n[0]) < 0.6, fabs(n[0]) >= 0.6, 0.0};
  const double t[3] = {n[1] * other[2] - n[2] * other[1], n[2] * other[0] - n[0] * other[2],
                       n[0] * other[1] - n[1] * other[0]};
  for (int c = 0; c < 3; c++)
    out[c] = t[c] / sqrt(dot(t, t));
}

/* Infinite ones have one side. A finite one is an open tube, met from both sides, or a rod with
 * flat ends. The end's rim is an edge. */
static int nearest_of_cylinder(const dem_element *e, const double x[3], double p[3], double n[3],
                               double *distance) {
  double z, rho, out[3];
  around(e, x, &z, &rho, out);
  const double end = e->length > 0.0 ? fmin(fmax(z, 0.0), e->length) : z, beyond = z - end;
  const int rod = e->side == DEM_WALL_OUTSIDE;
  if (beyond == 0.0) {
    const int inwards = !rod && (e->length == 0.0 || rho < e->radius);
    const double sign = inwards ? -1.0 : 1.0;
    *distance = sign * (rho - e->radius);
    for (int c = 0; c < 3; c++) {
      n[c] = sign * out[c];
      p[c] = -*distance * n[c];
    }
    return 0;
  }
  const int flat = rod && rho <= e->radius;
  const double across = flat ? 0.0 : rho - e->radius;
  *distance = sqrt(across * across + beyond * beyond);
  for (int c = 0; c < 3; c++) {
    p[c] = -(across * out[c] + beyond * e->n[c]);
    n[c] = -p[c] / *distance;
  }
  return !flat;
}

int dem_element_nearest(const dem_element *e, const double x[3], double p[3], double n[3],
                        double *distance) {
  if (e->shape == DEM_SHAPE_CYLINDER)
    return nearest_of_cylinder(e, x, p, n, distance);
  const int feature = e->shape == DEM_SHAPE_PLANE ? 0 : nearest_of_triangle(e, x, p);
  if (feature == 0) {
    face(e, x, p, n, distance);
    return 0;
  }
  *distance = sqrt(dot(p, p));
  for (int c = 0; c < 3; c++)
    n[c] = *distance > 0.0 ? -p[c] / *distance : e->n[c];
  return feature;
}

int dem_bins_find(const dem_bins *bins, const double x[3]) {
  int at[3];
  for (int c = 0; c < 3; c++) {
    const double k = floor((x[c] - bins->lo[c]) / bins->edge);
    if (!(k >= 0.0 && k < bins->cells[c]))
      return -1;
    at[c] = (int)k;
  }
  return (at[2] * bins->cells[1] + at[1]) * bins->cells[0] + at[0];
}

static int in_grid(const dem_walls *walls, const dem_bins *bins, const dem_element *e) {
  return e->shape == DEM_SHAPE_TRIANGLE &&
         (e->wall == bins->wall || !(walls->wall[e->wall].moves || walls->wall[bins->wall].moves));
}

static void bounds(const dem_walls *walls, dem_bins *bins, double reach, double hi[3]) {
  for (int c = 0; c < 3; c++) {
    bins->lo[c] = HUGE_VAL;
    hi[c] = -HUGE_VAL;
    for (size_t k = 0; k < walls->elements; k++) {
      const dem_element *e = &walls->element[k];
      if (!in_grid(walls, bins, e))
        continue;
      bins->lo[c] = fmin(bins->lo[c], fmin(e->a[c], fmin(e->b[c], e->c[c])) - reach);
      hi[c] = fmax(hi[c], fmax(e->a[c], fmax(e->b[c], e->c[c])) + reach);
    }
  }
}

static int size_bins(dem_bins *bins, size_t triangles, double reach, const double hi[3]) {
  const double most = 8.0 * (double)triangles + 64.0;
  double cells;
  for (bins->edge = 2.0 * reach;; bins->edge *= 1.3) {
    cells = 1.0;
    for (int c = 0; c < 3; c++)
      cells *= floor((hi[c] - bins->lo[c]) / bins->edge) + 1.0;
    if (cells <= most)
      break;
  }
  for (int c = 0; c < 3; c++)
    bins->cells[c] = (int)floor((hi[c] - bins->lo[c]) / bins->edge) + 1;
  return dem_allocate((size_t)cells + 1, sizeof *bins->start, &bins->start);
}

/* Walk the bins that a triangle belongs to: count them (item NULL) or enter it. */
static void enter(dem_bins *bins, const dem_element *e, int number, double reach, int *at) {
  const double far = reach + 0.5 * sqrt(3.0) * bins->edge * (1.0 + 1e-12);
  int from[3], to[3];
  for (int c = 0; c < 3; c++) {
    const double lo = fmin(e->a[c], fmin(e->b[c], e->c[c])) - reach - bins->lo[c];
    const double hi = fmax(e->a[c], fmax(e->b[c], e->c[c])) + reach - bins->lo[c];
    const int last = bins->cells[c] - 1;
    from[c] = lo < 0.0 ? 0 : (int)(lo / bins->edge);
    to[c] = (int)(hi / bins->edge) < last ? (int)(hi / bins->edge) : last;
  }
  for (int k = from[2]; k <= to[2]; k++)
    for (int j = from[1]; j <= to[1]; j++)
      for (int i = from[0]; i <= to[0]; i++) {
        const double x[3] = {bins->lo[0] + (i + 0.5) * bins->edge,
                             bins->lo[1] + (j + 0.5) * bins->edge,
                             bins->lo[2] + (k + 0.5) * bins->edge};
        double p[3], n[3], distance;
        dem_element_nearest(e, x, p, n, &distance);
        if (distance > far)
          continue;
        const int bin = (k * bins->cells[1] + j) * bins->cells[0] + i;
        if (bins->item != NULL)
          bins->item[at[bin]] = number;
        at[bin]++;
      }
}

static int fill_bins(const dem_walls *walls, dem_bins *bins, double reach) {
  double hi[3];
  size_t triangles = 0;
  int *at;
  for (size_t k = 0; k < walls->elements; k++)
    triangles += (size_t)in_grid(walls, bins, &walls->element[k]);
  bounds(walls, bins, reach, hi);
  PART_TRY(size_bins(bins, triangles, reach, hi));
  const int cells = bins->cells[0] * bins->cells[1] * bins->cells[2];
  PART_TRY(dem_allocate((size_t)cells, sizeof *at, &at));
  for (size_t k = 0; k < walls->elements; k++)
    if (in_grid(walls, bins, &walls->element[k]))
      enter(bins, &walls->element[k], (int)k, reach, at);
  for (int k = 0; k < cells; k++) {
    bins->start[k + 1] = bins->start[k] + at[k];
    at[k] = bins->start[k];
  }
  const int status = dem_allocate((size_t)bins->start[cells], sizeof *bins->item, &bins->item);
  for (size_t k = 0; status == PART_OK && k < walls->elements; k++)
    if (in_grid(walls, bins, &walls->element[k]))
      enter(bins, &walls->element[k], (int)k, reach, at);
  free(at);
  return status;
}

int dem_walls_bins(dem_walls *walls, double reach) {
  int rests = 0;
  PART_TRY(dem_allocate((size_t)walls->count, sizeof *walls->bins, &walls->bins));
  for (int w = 0; w < walls->count; w++) {
    const dem_wall *wall = &walls->wall[w];
    if (walls->element[wall->first].shape != DEM_SHAPE_TRIANGLE || (!wall->moves && rests++))
      continue;
    dem_bins *bins = &walls->bins[walls->groups++];
    bins->wall = w;
    PART_TRY(fill_bins(walls, bins, reach));
  }
  return PART_OK;
}

/* Outward unit normal, in the plane of the triangle, of its edge from a to b. */
static void edge_plane(const dem_element *e, const double a[3], const double b[3], int k,
                       dem_facet *facet) {
  const double t[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, *n = e->n;
  const double out[3] = {t[1] * n[2] - t[2] * n[1], t[2] * n[0] - t[0] * n[2],
                         t[0] * n[1] - t[1] * n[0]};
  const double length = sqrt(dot(out, out));
  for (int c = 0; c < 3; c++) {
    facet->n[c][k] = out[c] / length;
    facet->o[k] += out[c] / length * (a[c] - e->a[c]);
  }
}

int dem_walls_facets(dem_walls *walls) {
  PART_TRY(dem_allocate(walls->elements, sizeof *walls->facet, &walls->facet));
  for (size_t k = 0; k < walls->elements; k++) {
    const dem_element *e = &walls->element[k];
    dem_facet *facet = &walls->facet[k];
    memcpy(facet->a, e->a, sizeof facet->a);
    for (int c = 0; c < 3; c++)
      facet->n[c][0] = e->n[c];
    if (e->shape == DEM_SHAPE_TRIANGLE) {
      facet->back = -1.0;
      edge_plane(e, e->a, e->b, 1, facet);
      edge_plane(e, e->b, e->c, 2, facet);
      edge_plane(e, e->c, e->a, 3, facet);
    } else { /* no edges */
      facet->o[1] = facet->o[2] = facet->o[3] = HUGE_VAL;
    }
  }
  return PART_OK;
}
