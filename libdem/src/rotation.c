/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "rotation.h"

/* One Jacobi rotation that makes a[p][q] zero. */
static void rotate(double a[3][3], double v[3][3], int p, int q) {
  if (a[p][q] == 0.0)
    return;
  const double theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
  const double t = (theta >= 0.0 ? 1.0 : -1.0) / (fabs(theta) + sqrt(theta * theta + 1.0));
  const double c = 1.0 / sqrt(t * t + 1.0), s = t * c;
  for (int k = 0; k < 3; k++) {
    const double kp = a[k][p], kq = a[k][q];
    a[k][p] = c * kp - s * kq;
    a[k][q] = s * kp + c * kq;
  }
  for (int k = 0; k < 3; k++) {
    const double pk = a[p][k], qk = a[q][k];
    a[p][k] = c * pk - s * qk;
    a[q][k] = s * pk + c * qk;
  }
  for (int k = 0; k < 3; k++) {
    const double kp = v[k][p], kq = v[k][q];
    v[k][p] = c * kp - s * kq;
    v[k][q] = s * kp + c * kq;
  }
  a[p][q] = a[q][p] = 0.0;
}

void dem_eigen(const double s[6], double value[3], double v[3][3]) {
  double a[3][3] = {{s[0], s[3], s[4]}, {s[3], s[1], s[5]}, {s[4], s[5], s[2]}};
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++)
      v[r][c] = r == c ? 1.0 : 0.0;
  for (int sweep = 0; sweep < 30; sweep++) {
    const double off = fabs(a[0][1]) + fabs(a[0][2]) + fabs(a[1][2]);
    const double size = fabs(a[0][0]) + fabs(a[1][1]) + fabs(a[2][2]);
    if (!(off > 1e-17 * size))
      break;
    rotate(a, v, 0, 1);
    rotate(a, v, 0, 2);
    rotate(a, v, 1, 2);
  }
  for (int k = 0; k < 3; k++)
    value[k] = a[k][k];
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
