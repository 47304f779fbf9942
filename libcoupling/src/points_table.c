/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "points_table.h"
#include <math.h>

static const double PI = 3.14159265358979323846;

/* Part of the shell of radius q about a point that is in a sphere of radius R at the distance s. */
static double shell_inside(double q, double s, double radius) {
  if (q <= radius - s)
    return 1.0;
  if (q >= s + radius || q <= s - radius)
    return 0.0;
  return (radius * radius - (s - q) * (s - q)) / (4.0 * s * q);
}

/* Five point Gauss-Legendre in panels. */
static double shells(const cpl_points_kernel *kernel, double s, double radius, double from, double to) {
  static const double x[5] = {-0.9061798459386640, -0.5384693101056831, 0.0, 0.5384693101056831,
                              0.9061798459386640};
  static const double w[5] = {0.2369268850561891, 0.4786286704993665, 0.5688888888888889,
                              0.4786286704993665, 0.2369268850561891};
  enum { PANELS = 12 };
  const double width = (to - from) / PANELS;
  double sum = 0.0;
  for (int p = 0; p < PANELS && width > 0.0; p++)
    for (int k = 0; k < 5; k++) {
      const double q = from + width * ((double)p + 0.5 * (1.0 + x[k]));
      sum += 0.5 * width * w[k] * kernel->value(kernel->context, q) * q * q * shell_inside(q, s, radius);
    }
  return 4.0 * PI * sum;
}

double points_sphere_mean(const cpl_points_kernel *kernel, double s, double radius) {
  if (radius <= 0.0)
    return s < kernel->support ? kernel->value(kernel->context, s) : 0.0;
  const double end = fmin(kernel->support, s + radius), middle = fmin(fabs(radius - s), end);
  double sum = shells(kernel, s, radius, middle, end);
  if (s < radius)
    sum += shells(kernel, s, radius, 0.0, middle);
  return sum / (4.0 / 3.0 * PI * radius * radius * radius);
}

int points_table_make(cpl_points_table_data *t, const cpl_points_kernel *kernel, double least,
                      double most, int exact) {
  const size_t width = POINTS_NODES + 2;
  t->least = least;
  t->most = most;
  t->rows = most > least * (1.0 + 1e-12) && exact ? POINTS_ROWS : 1;
  PART_TRY(CPL_RESERVE(t->value, (size_t)t->rows * width));
  const double end = kernel->support + (exact ? most : 0.0);
  t->end2 = end * end;
  t->per_s2 = (double)POINTS_NODES / t->end2;
  const double span = most * most - least * least;
  t->per_r2 = t->rows > 1 ? (double)(t->rows - 1) / span : 0.0;
  for (int r = 0; r < t->rows; r++) {
    const double r2 = least * least + (t->rows > 1 ? span * (double)r / (double)(t->rows - 1) : 0.0);
    double *row = t->value.data + (size_t)r * width;
    for (int k = 0; k <= POINTS_NODES; k++)
      row[k] = points_sphere_mean(kernel, sqrt((double)k / t->per_s2), exact ? sqrt(r2) : 0.0);
    row[POINTS_NODES + 1] = 0.0;
  }
  return PART_OK;
}
