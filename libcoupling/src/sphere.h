/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef COUPLING_SPHERE_H
#define COUPLING_SPHERE_H

/* m3. One definition, so that both sides of a balance use the same number. */
static inline double cpl_sphere_volume(double radius) {
  const double pi = 3.14159265358979323846;
  return 4.0 / 3.0 * pi * radius * radius * radius;
}

#endif
