/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Motion under a constant force and linear drag, m dv/dt = F - Sp v, in closed form: with
 * b = Sp h/m
 *   v(h) - v = (F - Sp v) h/m phi1(b),        phi1 = (1 - exp(-b))/b
 *   x(h) - x = v h phi1(b) + F h^2/m phi2(b), phi2 = (1 - phi1)/b
 * exact for any h and any Sp, and the plain constant-acceleration formulas for Sp = 0. */
#ifndef DEM_FLOW_H
#define DEM_FLOW_H

#include <math.h>

typedef struct dem_flow {
  double lost; /* 1 - exp(-b), share of the velocity that drag takes */
  double phi1, phi2;
} dem_flow;

static inline dem_flow dem_flow_of(double b) {
  dem_flow flow;
  if (b == 0.0)
    return (dem_flow){0.0, 1.0, 0.5};
  flow.lost = -expm1(-b);
  flow.phi1 = flow.lost / b;
  /* Series where 1 - phi1 would cancel; the next term is below 3e-17. */
  if (b < 1e-2)
    flow.phi2 =
        1.0 / 2 + b * (-1.0 / 6 + b * (1.0 / 24 + b * (-1.0 / 120 + b * (1.0 / 720 - b / 5040))));
  else
    flow.phi2 = (1.0 - flow.phi1) / b;
  return flow;
}

#endif
