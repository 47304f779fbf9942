/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Volume of the unit ball about the origin in axis-aligned boxes, in closed form. */
#ifndef COUPLING_BOX_SPHERE_H
#define COUPLING_BOX_SPHERE_H

/* Volume of { x > a }, { x > a, y > b }, { x > a, y > b, z > c } in the ball; any values. */
double cpl_cap(double a);
double cpl_edge_part(double a, double b);
double cpl_corner_part(double a, double b, double c);

/* Volume in the box lo < x < hi, >= 0. */
double cpl_box_ball(const double lo[3], const double hi[3]);

#endif
