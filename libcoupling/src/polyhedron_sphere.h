/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Volume of the unit ball about the origin behind, and in the cone of, a planar polygon. Summed
 * over the faces of a polyhedron (convex or not) these give its volume inside the ball:
 *   V = Vs [origin inside] - sum_f D_f      transfer form
 *   V = sum_f F_f                           flux form
 * with D, F signed by the outward normal; both change sign with the orientation of the face, so
 * each is computed once and goes to the owner and, negated, to the neighbour. The flux form is
 * continuous in the position of the ball; the transfer form only needs the faces that the ball
 * meets, but loses digits as the origin comes near a face that it meets.
 *
 * Derivation: doc/equations.md, sphere and polyhedron (a polygon cut by the circle of the ball in
 * its plane is a sum of right triangles about the foot of the normal, and circular sectors). */
#ifndef COUPLING_POLYHEDRON_SPHERE_H
#define COUPLING_POLYHEDRON_SPHERE_H

enum { CPL_POLYGON_MAX = 64 }; /* edges of one polygon; faces with more are cut into triangles */

/* A polygon edge from v1 to v2, as the ball sees it. s: coordinate along it, 0 nearest to the
 * origin. [a, b]: part inside the ball (a < b), or none (a = b = s2: all outside). */
typedef struct cpl_edge {
  double m[3];   /* v1 x t, t the unit direction; n.m = distance of the foot of the plane, > 0 when
                    it is on the inner side */
  double m2;     /* |m|^2, distance of the line squared */
  double s1, s2; /* ends */
  double r1, r2; /* |v1|, |v2| */
  double a, b, ra, rb;
} cpl_edge;

typedef struct cpl_polygon_edge { /* edge with orientation +1 or -1 in a polygon */
  const cpl_edge *edge;
  double sign;
} cpl_polygon_edge;

/* v: ends, in radii relative to the centre. An edge of no length gets a = b = s1 = s2 = 0. */
void cpl_edge_set(const double v1[3], double r1, const double v2[3], double r2, cpl_edge *edge);

/* D of a convex polygon: unit normal n, h = n.v. *met: the ball meets the polygon (D != 0). */
double cpl_polygon_deficit(int edges, const cpl_polygon_edge *edge, const double n[3], double h,
                           int *met);
/* F of a polygon. solid_angle: signed solid angle of the polygon, used when |h| >= 1. */
double cpl_polygon_flux(int edges, const cpl_polygon_edge *edge, const double n[3], double h,
                        double solid_angle);
/* Signed solid angle of the triangle a b c, > 0 when its normal points away from the origin. */
double cpl_solid_angle(const double a[3], const double b[3], const double c[3]);

#endif
