/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Periodic boxes: wrapping and shortest differences; boxes in two dimensions. */
#include "particle/domain.h"

#include <limits.h>
#include <math.h>
#include "particle/status.h"

void part_box_wrap(const part_box *box, double x[3], int image[3]) {
  for (int d = 0; d < 3; d++) {
    if (image != NULL)
      image[d] = 0;
    if (!box->periodic[d] || (x[d] >= box->lo[d] && x[d] < box->hi[d]) || !isfinite(x[d]))
      continue;
    const double length = box->hi[d] - box->lo[d];
    const double turns = floor((x[d] - box->lo[d]) / length);
    double wrapped = x[d] - turns * length;
    /* Round-off can leave the result on the wrong side of either end. */
    if (wrapped < box->lo[d])
      wrapped = box->lo[d];
    if (wrapped >= box->hi[d])
      wrapped = x[d] < box->lo[d] ? nextafter(box->hi[d], box->lo[d]) : box->lo[d];
    if (image != NULL)
      image[d] = fabs(turns) < INT_MAX ? (int)turns : turns < 0.0 ? -INT_MAX : INT_MAX;
    x[d] = wrapped;
  }
}

void part_box_difference(const part_box *box, const double a[3], const double b[3], double d[3]) {
  for (int k = 0; k < 3; k++) {
    d[k] = a[k] - b[k];
    if (box->periodic[k]) {
      const double length = box->hi[k] - box->lo[k];
      d[k] -= length * nearbyint(d[k] / length);
    }
  }
}

int part_box_check_dimensions(const part_box *box, const char *table, int64_t dimensions,
                              double depth, const double gravity[3]) {
  if (dimensions == 3 && depth > 0.0)
    return part_fail(PART_ERR_RANGE, "%s: entry depth is not allowed with dimensions 3", table);
  if (dimensions == 3)
    return PART_OK;
  if (!(depth > 0.0))
    return part_fail(PART_ERR_RANGE, "%s: entry depth must be given and positive with dimensions 2",
                     table);
  if (gravity[2] != 0.0)
    return part_fail(PART_ERR_RANGE,
                     "%s: entry gravity: its z component is %g m/s^2; must be 0 with dimensions 2",
                     table, gravity[2]);
  if (box->periodic[2])
    return part_fail(PART_ERR_RANGE,
                     "%s: entry dimensions: 2 is not allowed in a domain that is periodic in z",
                     table);
  return PART_OK;
}
