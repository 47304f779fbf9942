/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "rotation.h"

/* One Jacobi rotation that makes a[p][q] zero. */
static void rotate(int n, double *a, double *v, int p, int q) {
  const double off = a[n * p + q];
  if (off == 0.0)
    return;
  const double theta = (a[n * q + q] - a[n * p + p]) / (2.0 * off);
  const double t = (theta >= 0.0 ? 1.0 : -1.0) / (fabs(theta) + sqrt(theta * theta + 1.0));
  const double c = 1.0 / sqrt(t * t + 1.0), s = t * c;
  for (int k = 0; k < n; k++) {
    const double kp = a[n * k + p], kq = a[n * k + q];
    a[n * k + p] = c * kp - s * kq;
    a[n * k + q] = s * kp + c * kq;
  }
  for (int k = 0; k < n; k++) {
    const double pk = a[n * p + k], qk = a[n * q + k];
    a[n * p + k] = c * pk - s * qk;
    a[n * q + k] = s * pk + c * qk;
  }
  for (int k = 0; k < n; k++) {
    const double kp = v[n * k + p], kq = v[n * k + q];
    v[n * k + p] = c * kp - s * kq;
    v[n * k + q] = s * kp + c * kq;
  }
  a[n * p + q] = a[n * q + p] = 0.0;
}

void dem_diagonalise(int n, double *a, double *v) {
  for (int k = 0; k < n * n; k++)
    v[k] = k % (n + 1) == 0 ? 1.0 : 0.0;
  for (int sweep = 0; sweep < 30; sweep++) {
    double off = 0.0, size = 0.0;
    for (int k = 0; k < n * n; k++)
      *(k % (n + 1) == 0 ? &size : &off) += fabs(a[k]);
    if (!(off > 1e-17 * size))
      break;
    for (int p = 0; p < n - 1; p++)
      for (int q = p + 1; q < n; q++)
        rotate(n, a, v, p, q);
  }
}

void dem_eigen(const double s[6], double value[3], double v[3][3]) {
  double a[9] = {s[0], s[3], s[4], s[3], s[1], s[5], s[4], s[5], s[2]};
  dem_diagonalise(3, a, &v[0][0]);
  for (int k = 0; k < 3; k++)
    value[k] = a[4 * k];
}

void dem_turn_of_matrix(const double m[3][3], double q[4]) {
  /* The largest component from the diagonal, the others from it: no cancellation. */
  const double square[4] = {1.0 + m[0][0] + m[1][1] + m[2][2], 1.0 + m[0][0] - m[1][1] - m[2][2],
                            1.0 - m[0][0] + m[1][1] - m[2][2], 1.0 - m[0][0] - m[1][1] + m[2][2]};
  const double p[4][4] = {{square[0], m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]},
                          {m[2][1] - m[1][2], square[1], m[0][1] + m[1][0], m[0][2] + m[2][0]},
                          {m[0][2] - m[2][0], m[0][1] + m[1][0], square[2], m[1][2] + m[2][1]},
                          {m[1][0] - m[0][1], m[0][2] + m[2][0], m[1][2] + m[2][1], square[3]}};
  int largest = 0;
  for (int k = 1; k < 4; k++)
    if (square[k] > square[largest])
      largest = k;
  for (int k = 0; k < 4; k++)
    q[k] = p[largest][k];
  dem_turn_normalise(q);
}
