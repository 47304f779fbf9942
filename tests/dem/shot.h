/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One collision of a sphere with another that rests, or with a wall. */
#ifndef TEST_DEM_SHOT_H
#define TEST_DEM_SHOT_H

#include "common.h"

/* The first comes along x, and touches when the line of centres is x. */
typedef struct shot {
  int law;
  double r[2];                  /* m; second 0: a wall */
  int triangle;                 /* the wall is one */
  double v[3];                  /* m/s, v[0] > 0 */
  double spin[2][3];            /* rad/s */
  double e, mu, mu_roll, ratio; /* ratio: k_t/k_n of the linear law, 0: default */
  double stiff;                 /* factor on the stiffness of scene_with_law, 0: 1 */
  double fraction, phase;       /* step over contact time; where inside a step they meet, 0 .. 1 */
} shot;

typedef struct outcome {
  body before[2], after[2];
  double m[2];         /* kg; wall: infinite */
  double contact_time; /* s, as the library says */
} outcome;

outcome shoot(const shot *s);

/* Part of the velocity that is left when the force is zero for the last time before they part: the
 * highest, because after it the damping pulls. Of a damped oscillator, and so of Hertz with the
 * damping of Tsuji, too (doc/equations.md D.5). */
double peak_rebound(double restitution);

#endif
