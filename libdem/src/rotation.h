/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Vectors, rotations as unit quaternions, and symmetric 3 x 3 matrices. A quaternion q = (w, x, y,
 * z) takes body axes to space axes, x_space = q x_body q*. A symmetric matrix is xx yy zz xy xz yz.
 */
#ifndef DEM_ROTATION_H
#define DEM_ROTATION_H

#include <math.h>

static inline void dem_cross(const double a[3], const double b[3], double c[3]) {
  const double made[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                          a[0] * b[1] - a[1] * b[0]};
  for (int k = 0; k < 3; k++)
    c[k] = made[k];
}

static inline double dem_dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* p q: first q, then p. The result may be one of them. */
static inline void dem_turn_product(const double p[4], const double q[4], double pq[4]) {
  const double made[4] = {p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
                          p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
                          p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1],
                          p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0]};
  for (int k = 0; k < 4; k++)
    pq[k] = made[k];
}

static inline void dem_turn_normalise(double q[4]) {
  const double scale = 1.0 / sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (int k = 0; k < 4; k++)
    q[k] *= scale;
}

/* Rows are the space components: x_space = m x_body. */
static inline void dem_turn_matrix(const double q[4], double m[3][3]) {
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  const double made[3][3] = {
      {1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)},
      {2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)},
      {2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)}};
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++)
      m[r][c] = made[r][c];
}

static inline void dem_to_space(const double m[3][3], const double body[3], double space[3]) {
  for (int r = 0; r < 3; r++)
    space[r] = m[r][0] * body[0] + m[r][1] * body[1] + m[r][2] * body[2];
}

static inline void dem_to_body(const double m[3][3], const double space[3], double body[3]) {
  for (int c = 0; c < 3; c++)
    body[c] = m[0][c] * space[0] + m[1][c] * space[1] + m[2][c] * space[2];
}

/* n . S n */
static inline double dem_form(const double s[6], const double n[3]) {
  return s[0] * n[0] * n[0] + s[1] * n[1] * n[1] + s[2] * n[2] * n[2] +
         2.0 * (s[3] * n[0] * n[1] + s[4] * n[0] * n[2] + s[5] * n[1] * n[2]);
}

/* Symmetric matrix a [n][n] by Jacobi's rotations: its eigenvalues on the diagonal, its
 * eigenvectors in the columns of v [n][n], in no order. */
void dem_diagonalise(int n, double *a, double *v);
/* The same for a symmetric 3 x 3 matrix; the eigenvectors are right-handed. */
void dem_eigen(const double s[6], double value[3], double v[3][3]);
/* Unit quaternion of a rotation matrix. */
void dem_turn_of_matrix(const double m[3][3], double q[4]);

#endif
