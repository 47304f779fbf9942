/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Geometry of faces: distances, and bins in which triangles are looked up. */
#include "internal.h"

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* From x to its nearest point of a triangle, by the region that x is in (Ericson 2005, sec. 5.1.5).
 */
static void nearest_of_triangle(const sph_face *f, const double x[3], double to[3]) {
  double ab[3], ac[3], ax[3], bx[3], cx[3], s = 0.0, t = 0.0;
  for (int c = 0; c < 3; c++) {
    ab[c] = f->b[c] - f->a[c];
    ac[c] = f->c[c] - f->a[c];
    ax[c] = x[c] - f->a[c];
    bx[c] = x[c] - f->b[c];
    cx[c] = x[c] - f->c[c];
  }
  const double a1 = dot(ab, ax), a2 = dot(ac, ax), b1 = dot(ab, bx), b2 = dot(ac, bx);
  const double c1 = dot(ab, cx), c2 = dot(ac, cx);
  const double wa = b1 * c2 - c1 * b2, wb = c1 * a2 - a1 * c2, wc = a1 * b2 - b1 * a2;
  if (a1 <= 0.0 && a2 <= 0.0) {
    /* corner a */
  } else if (b1 >= 0.0 && b2 <= b1) {
    s = 1.0;
  } else if (c2 >= 0.0 && c1 <= c2) {
    t = 1.0;
  } else if (wc <= 0.0 && a1 >= 0.0 && b1 <= 0.0) {
    s = a1 / (a1 - b1);
  } else if (wb <= 0.0 && a2 >= 0.0 && c2 <= 0.0) {
    t = a2 / (a2 - c2);
  } else if (wa <= 0.0 && b2 >= b1 && c1 >= c2) {
    t = (b2 - b1) / ((b2 - b1) + (c1 - c2));
    s = 1.0 - t;
  } else {
    s = wb / (wa + wb + wc);
    t = wc / (wa + wb + wc);
  }
  for (int c = 0; c < 3; c++)
    to[c] = s * ab[c] + t * ac[c] - ax[c];
}

double sph_face_distance(const sph_face *face, const double x[3], double *tilt) {
  const double d[3] = {x[0] - face->a[0], x[1] - face->a[1], x[2] - face->a[2]};
  const double height = dot(d, face->n);
  double to[3];
  if (face->type == SPH_PLANE) {
    *tilt = 1.0;
    return height;
  }
  nearest_of_triangle(face, x, to);
  const double distance = sqrt(dot(to, to));
  *tilt = distance > 0.0 ? fabs(height) / distance : 1.0;
  return height >= 0.0 ? distance : -distance;
}

/* Of triangles at the same distance, those of an edge or corner, the one that is seen most squarely
 * says on which side of the surface x is. Of equals the first in the list counts, which is in the
 * order of the faces: on the diagonal of a corner round-off must not choose, it differs between
 * ranks. */
int sph_faces_nearest(const sph_walls *walls, int n, const int *near, const double x[3],
                      double *distance) {
  int plane = -1, triangle = -1;
  double least = HUGE_VAL, closest = HUGE_VAL, best = 0.0;
  for (int k = 0; k < n; k++) {
    double tilt;
    const sph_face *face = &walls->face[near[k]];
    const double d = sph_face_distance(face, x, &tilt);
    if (face->type == SPH_PLANE) {
      if (d < least - walls->tie) {
        least = d;
        plane = near[k];
      }
    } else if (triangle < 0 || fabs(d) < fabs(closest) - walls->tie ||
               (fabs(d) <= fabs(closest) + walls->tie && tilt > best + 1e-9)) {
      closest = d;
      best = tilt;
      triangle = near[k];
    }
  }
  const int on_plane = plane >= 0 && (triangle < 0 || least <= closest + walls->tie);
  *distance = on_plane ? least : closest;
  return on_plane ? plane : triangle;
}

static void bounds(const sph_face *f, double lo[3], double hi[3]) {
  for (int c = 0; c < 3; c++) {
    lo[c] = fmin(f->a[c], fmin(f->b[c], f->c[c]));
    hi[c] = fmax(f->a[c], fmax(f->b[c], f->c[c]));
  }
}

/* Grid over all triangles with `reach` around them, of cells no smaller than reach. */
static void make_grid(const sph_walls *walls, double reach, sph_bins *bins) {
  double hi[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  bins->lo[0] = bins->lo[1] = bins->lo[2] = HUGE_VAL;
  for (int f = walls->planes; f < walls->faces; f++) {
    double a[3], b[3];
    bounds(&walls->face[f], a, b);
    for (int c = 0; c < 3; c++) {
      bins->lo[c] = fmin(bins->lo[c], a[c] - reach);
      hi[c] = fmax(hi[c], b[c] + reach);
    }
  }
  bins->edge = reach;
  for (double cells = HUGE_VAL; cells > 1e6; bins->edge *= cells > 1e6 ? 1.5 : 1.0) {
    cells = 1.0;
    for (int c = 0; c < 3; c++)
      cells *= bins->cells[c] = (int)fmin(floor((hi[c] - bins->lo[c]) / bins->edge) + 1.0, 1e6);
  }
}

/* Bins that a triangle with `reach` around it may touch: counted into start, or entered. */
static void enter(const sph_walls *walls, int f, double reach, sph_bins *bins, int count_only) {
  double lo[3], hi[3];
  int from[3], to[3];
  bounds(&walls->face[f], lo, hi);
  for (int c = 0; c < 3; c++) {
    from[c] = (int)fmax((lo[c] - reach - bins->lo[c]) / bins->edge, 0.0);
    to[c] = (int)fmin((hi[c] + reach - bins->lo[c]) / bins->edge, bins->cells[c] - 1);
  }
  for (int z = from[2]; z <= to[2]; z++)
    for (int y = from[1]; y <= to[1]; y++)
      for (int x = from[0]; x <= to[0]; x++) {
        int *start = &bins->start[(z * bins->cells[1] + y) * bins->cells[0] + x];
        if (!count_only)
          bins->item[*start] = f;
        ++*start;
      }
}

int sph_walls_bins(sph_walls *walls, double reach) {
  sph_bins *bins = &walls->bins;
  size_t room = 0;
  if (walls->planes == walls->faces)
    return PART_OK;
  make_grid(walls, reach, bins);
  const size_t cells = (size_t)bins->cells[0] * (size_t)bins->cells[1] * (size_t)bins->cells[2];
  PART_TRY(sph_grow(cells + 1, sizeof *bins->start, &room, &bins->start));
  for (int f = walls->planes; f < walls->faces; f++)
    enter(walls, f, reach, bins, 1);
  long long sum = 0;
  for (size_t k = 0; k <= cells; k++) {
    const int here = bins->start[k];
    bins->start[k] = (int)sum;
    sum += here;
    if (sum > INT32_MAX)
      return part_fail(PART_ERR_RANGE, "triangles are too many for the bins of walls");
  }
  room = 0;
  PART_TRY(sph_grow((size_t)sum + 1, sizeof *bins->item, &room, &bins->item));
  for (int f = walls->planes; f < walls->faces; f++)
    enter(walls, f, reach, bins, 0);
  memmove(bins->start + 1, bins->start, cells * sizeof *bins->start);
  bins->start[0] = 0;
  return PART_OK;
}

void sph_walls_free(sph_walls *walls) {
  free(walls->wall);
  free(walls->face);
  free(walls->given);
  free(walls->bins.start);
  free(walls->bins.item);
  free(walls->particle);
  free(walls->start);
  free(walls->near);
  free(walls->point);
  free(walls->within);
  free(walls->table);
  free(walls->fixed);
  free(walls->fixed_grid.start);
}
