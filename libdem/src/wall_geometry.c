/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Nearest point of a wall element, and the bins in which triangles are looked up. */
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

int dem_element_nearest(const dem_element *e, const double x[3], double p[3], double n[3],
                        double *distance) {
  const double d[3] = {x[0] - e->a[0], x[1] - e->a[1], x[2] - e->a[2]};
  double side = dot(d, e->n);
  const int feature = e->plane ? 0 : nearest_of_triangle(e, x, p);
  if (feature == 0) {
    /* From the normal of the element, so that a plane and triangles on it give the same. A plane
     * keeps particles on the side of its normal; a triangle has two sides. */
    const double sign = !e->plane && side < 0.0 ? -1.0 : 1.0;
    side *= sign;
    for (int c = 0; c < 3; c++) {
      n[c] = sign * e->n[c];
      p[c] = -side * n[c];
    }
    *distance = side;
    return 0;
  }
  *distance = sqrt(dot(p, p));
  for (int c = 0; c < 3; c++)
    n[c] = *distance > 0.0 ? -p[c] / *distance : e->n[c];
  return feature;
}

void dem_shift_position(const double length[3], int shift, const double x[3], double shifted[3]) {
  /* The element at + s L meets x where the element itself meets x - s L. */
  shifted[0] = x[0] - (shift % 3 - 1) * length[0];
  shifted[1] = x[1] - (shift / 3 % 3 - 1) * length[1];
  shifted[2] = x[2] - (shift / 9 - 1) * length[2];
}

int dem_bins_find(const dem_bins *bins, const double x[3]) {
  int at[3];
  if (bins->start == NULL)
    return -1;
  for (int c = 0; c < 3; c++) {
    const double k = floor((x[c] - bins->lo[c]) / bins->edge);
    if (!(k >= 0.0 && k < bins->cells[c]))
      return -1;
    at[c] = (int)k;
  }
  return (at[2] * bins->cells[1] + at[1]) * bins->cells[0] + at[0];
}

static void bounds(const dem_walls *walls, double reach, double lo[3], double hi[3]) {
  for (int c = 0; c < 3; c++) {
    lo[c] = HUGE_VAL;
    hi[c] = -HUGE_VAL;
    for (size_t k = 0; k < walls->elements; k++) {
      const dem_element *e = &walls->element[k];
      if (e->plane)
        continue;
      lo[c] = fmin(lo[c], fmin(e->a[c], fmin(e->b[c], e->c[c])) - reach);
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

int dem_walls_bins(dem_walls *walls, double reach) {
  dem_bins *bins = &walls->bins;
  double hi[3];
  size_t triangles = 0;
  int *at;
  for (size_t k = 0; k < walls->elements; k++)
    triangles += !walls->element[k].plane;
  if (triangles == 0)
    return PART_OK;
  bounds(walls, reach, bins->lo, hi);
  PART_TRY(size_bins(bins, triangles, reach, hi));
  const int cells = bins->cells[0] * bins->cells[1] * bins->cells[2];
  PART_TRY(dem_allocate((size_t)cells, sizeof *at, &at));
  for (size_t k = 0; k < walls->elements; k++)
    if (!walls->element[k].plane)
      enter(bins, &walls->element[k], (int)k, reach, at);
  for (int k = 0; k < cells; k++) {
    bins->start[k + 1] = bins->start[k] + at[k];
    at[k] = bins->start[k];
  }
  const int status = dem_allocate((size_t)bins->start[cells], sizeof *bins->item, &bins->item);
  for (size_t k = 0; status == PART_OK && k < walls->elements; k++)
    if (!walls->element[k].plane)
      enter(bins, &walls->element[k], (int)k, reach, at);
  free(at);
  return status;
}
