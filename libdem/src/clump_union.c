/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Volume and moments of the union of spheres.
 *
 * A plane x = const cuts the spheres in disks. Area and moments of the union of disks are integrals
 * along its boundary (Green), arc by arc, and each arc's integrand is a trigonometric polynomial of
 * degree 4 at most, for which 16 Gauss points on half a circle are exact to rounding. So two of the
 * three integrations are exact. Along x the integrand is smooth but for square roots to odd powers
 * where a sphere, an overlap circle or a corner of three spheres begins or ends. Intervals between
 * the ends of spheres are halved until halving changes nothing above `accuracy` of the sum of the
 * spheres. */
#include "clumps.h"

#include "internal.h"

enum { POINTS = 16, DEEPEST = 48 };
static const double accuracy = 1e-12;
static const double pi = 3.14159265358979323846;

typedef struct quadrature {
  double node[POINTS], weight[POINTS]; /* on [-1, 1] */
} quadrature;

/* Disks of one plane, and the arcs of one circle that lie in others. */
typedef struct slice {
  int spheres, disks;
  double allowed;       /* change of an interval's moments by halving */
  const double *sphere; /* [spheres][4], about the middle, of unit size */
  double *disk;         /* [spheres][3] y z r */
  double (*covered)[2]; /* [2 spheres + 2] angles, from <= to */
  quadrature rule;
} slice;

static void make_rule(quadrature *rule) {
  for (int k = 0; k < POINTS; k++) {
    double x = cos(pi * (k + 0.75) / (POINTS + 0.5)), slope = 1.0;
    for (int newton = 0; newton < 8; newton++) {
      double p = x, before = 1.0;
      for (int n = 2; n <= POINTS; n++) {
        const double next = ((2 * n - 1) * x * p - (n - 1) * before) / n;
        before = p;
        p = next;
      }
      slope = POINTS * (x * p - before) / (x * x - 1.0);
      x -= p / slope;
    }
    rule->node[k] = x;
    rule->weight[k] = 2.0 / ((1.0 - x * x) * slope * slope);
  }
}

/* Boundary integrals over the arc from .. to of a circle: 1, y, z, yy, zz, yz over the area. */
static void add_arc(const slice *s, const double *disk, double from, double to, double sum[6]) {
  const int pieces = to - from > pi ? 2 : 1;
  const double half = 0.5 * (to - from) / pieces, r = disk[2];
  for (int p = 0; p < pieces; p++)
    for (int k = 0; k < POINTS; k++) {
      const double angle = from + (2 * p + 1 + s->rule.node[k]) * half;
      const double cosine = cos(angle), sine = sin(angle), w = half * r * s->rule.weight[k];
      const double y = disk[0] + r * cosine, z = disk[1] + r * sine;
      sum[0] += 0.5 * w * (y * cosine + z * sine);
      sum[1] += 0.5 * w * y * y * cosine;
      sum[2] += 0.5 * w * z * z * sine;
      sum[3] += w / 3.0 * y * y * y * cosine;
      sum[4] += w / 3.0 * z * z * z * sine;
      sum[5] += 0.5 * w * y * y * z * cosine;
    }
}

/* Angles of circle a that lie in disk b, into covered; returns how many intervals, -1: all. */
static int cover(const double *a, const double *b, int b_is_later, double (*covered)[2]) {
  const double y = b[0] - a[0], z = b[1] - a[1], d = sqrt(y * y + z * z);
  if (d >= a[2] + b[2])
    return 0;
  if (d + a[2] <= b[2]) /* of two equal ones the first counts */
    return d == 0.0 && a[2] == b[2] && b_is_later ? 0 : -1;
  if (d + b[2] <= a[2])
    return 0;
  const double c = (d * d + (a[2] - b[2]) * (a[2] + b[2])) / (2.0 * d * a[2]);
  const double middle = atan2(z, y), half = acos(fmin(fmax(c, -1.0), 1.0));
  double from = middle - half, to = middle + half;
  if (from < -pi) {
    covered[0][0] = from + 2.0 * pi;
    covered[0][1] = pi;
    from = -pi;
  } else if (to > pi) {
    covered[0][0] = -pi;
    covered[0][1] = to - 2.0 * pi;
    to = pi;
  } else {
    covered[0][0] = from;
    covered[0][1] = to;
    return 1;
  }
  covered[1][0] = from;
  covered[1][1] = to;
  return 2;
}

static int by_beginning(const void *a, const void *b) {
  const double *x = a, *y = b;
  return (x[0] > y[0]) - (x[0] < y[0]);
}

/* Arcs of disk i that are on the boundary of the union. */
static void add_circle(const slice *s, int i, double sum[6]) {
  int n = 0;
  double open = -pi;
  for (int j = 0; j < s->disks; j++) {
    const int more = j == i ? 0 : cover(s->disk + 3 * i, s->disk + 3 * j, j > i, s->covered + n);
    if (more < 0)
      return;
    n += more;
  }
  if (n > 1)
    qsort(s->covered, (size_t)n, sizeof *s->covered, by_beginning);
  for (int k = 0; k < n; k++) {
    if (s->covered[k][0] > open)
      add_arc(s, s->disk + 3 * i, open, s->covered[k][0], sum);
    open = fmax(open, s->covered[k][1]);
  }
  if (open < pi)
    add_arc(s, s->disk + 3 * i, open, pi, sum);
}

/* 1, x, y, z, xx, yy, zz, xy, xz, yz over the union of disks at x. */
static void cut(slice *s, double x, double moment[10]) {
  double sum[6] = {0.0};
  s->disks = 0;
  for (int k = 0; k < s->spheres; k++) {
    const double *p = s->sphere + 4 * k, d = x - p[0], square = (p[3] - d) * (p[3] + d);
    if (!(square > 0.0))
      continue;
    double *disk = s->disk + 3 * s->disks++;
    disk[0] = p[1];
    disk[1] = p[2];
    disk[2] = sqrt(square);
  }
  for (int i = 0; i < s->disks; i++)
    add_circle(s, i, sum);
  const double made[10] = {sum[0], x * sum[0], sum[1],     sum[2],     x * x * sum[0],
                           sum[3], sum[4],     x * sum[1], x * sum[2], sum[5]};
  memcpy(moment, made, sizeof made);
}

/* One interval by Gauss points that crowd at its ends, x = (3t - t^3)/2: what goes with the square
 * root of the distance from an end is then smooth. */
static void integrate(slice *s, double from, double to, double sum[10]) {
  const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
  memset(sum, 0, 10 * sizeof *sum);
  for (int k = 0; k < POINTS; k++) {
    const double t = s->rule.node[k], w = 1.5 * half * (1.0 - t * t) * s->rule.weight[k];
    double moment[10];
    cut(s, middle + 0.5 * half * t * (3.0 - t * t), moment);
    for (int c = 0; c < 10; c++)
      sum[c] += w * moment[c];
  }
}

/* Halve until nothing changes; the size of everything is of order 1. */
static void refine(slice *s, double from, double to, const double whole[10], int depth,
                   double sum[10]) {
  const double middle = 0.5 * (from + to);
  double left[10], right[10], change = 0.0;
  integrate(s, from, middle, left);
  integrate(s, middle, to, right);
  for (int c = 0; c < 10; c++)
    change = fmax(change, fabs(left[c] + right[c] - whole[c]));
  if (change > s->allowed && depth < DEEPEST) {
    refine(s, from, middle, left, depth + 1, sum);
    refine(s, middle, to, right, depth + 1, sum);
    return;
  }
  for (int c = 0; c < 10; c++)
    sum[c] += left[c] + right[c];
}

static int by_value(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static void work(slice *s, double *end, double sum[10]) {
  double whole[10];
  s->allowed = 0.0;
  for (int k = 0; k < s->spheres; k++) {
    const double r = s->sphere[4 * k + 3];
    end[2 * k] = s->sphere[4 * k] - r;
    end[2 * k + 1] = s->sphere[4 * k] + r;
    s->allowed += accuracy * 4.0 / 3.0 * pi * r * r * r;
  }
  qsort(end, 2 * (size_t)s->spheres, sizeof *end, by_value);
  make_rule(&s->rule);
  memset(sum, 0, 10 * sizeof *sum);
  for (int k = 0; k < 2 * s->spheres - 1; k++) {
    if (!(end[k + 1] - end[k] > 1e-15))
      continue;
    integrate(s, end[k], end[k + 1], whole);
    refine(s, end[k], end[k + 1], whole, 0, sum);
  }
}

/* Middle and half the longest edge of the box around the spheres. */
static double frame(int n, const double *sphere, double middle[3]) {
  double size = 0.0;
  for (int c = 0; c < 3; c++) {
    double lo = HUGE_VAL, hi = -HUGE_VAL;
    for (int k = 0; k < n; k++) {
      lo = fmin(lo, sphere[4 * k + c] - sphere[4 * k + 3]);
      hi = fmax(hi, sphere[4 * k + c] + sphere[4 * k + 3]);
    }
    middle[c] = 0.5 * (lo + hi);
    size = fmax(size, 0.5 * (hi - lo));
  }
  return size;
}

int dem_union_moments(int n, const double *sphere, double moment[10], double middle[3]) {
  slice s = {.spheres = n};
  double *scaled = NULL, *end = NULL;
  const double size = frame(n, sphere, middle);
  int status = dem_allocate(4 * (size_t)n, sizeof *scaled, &scaled);
  if (status == PART_OK)
    status = dem_allocate(2 * (size_t)n, sizeof *end, &end);
  if (status == PART_OK)
    status = dem_allocate(3 * (size_t)n, sizeof *s.disk, &s.disk);
  if (status == PART_OK)
    status = dem_allocate(2 * (size_t)n + 2, sizeof *s.covered, &s.covered);
  if (status == PART_OK) {
    for (int k = 0; k < n; k++) {
      for (int c = 0; c < 3; c++)
        scaled[4 * k + c] = (sphere[4 * k + c] - middle[c]) / size;
      scaled[4 * k + 3] = sphere[4 * k + 3] / size;
    }
    s.sphere = scaled;
    work(&s, end, moment);
    const double v = size * size * size;
    for (int c = 0; c < 10; c++)
      moment[c] *= c == 0 ? v : c < 4 ? v * size : v * size * size;
  }
  free(scaled);
  free(end);
  free(s.disk);
  free(s.covered);
  return status;
}
