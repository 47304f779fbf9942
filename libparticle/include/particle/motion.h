/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prescribed motion of a wall: translation, rotation and oscillation as exact functions of time, so that
 * nothing drifts and a restart goes on. Walls of libdem and libsph move by it. */
#ifndef PARTICLE_MOTION_H
#define PARTICLE_MOTION_H

#ifdef __cplusplus
extern "C" {
#endif

/* With s = min(max(t, start_time), stop_time) - start_time the displacement is
 * velocity s + amplitude sin(2 pi frequency s) direction, the angle rotation_rate s about an axis through
 * centre, which moves with the wall. */
typedef struct part_motion {
  double velocity[3], centre[3];                          /* m/s, m */
  double rotation_axis[3], rotation_rate;                 /* 1, rad/s */
  double oscillation_amplitude, oscillation_frequency;    /* m, Hz */
  double oscillation_direction[3], start_time, stop_time; /* 1, s */
} part_motion;

/* In C, the motion among the entries of a wall, which have the names of its members in each library. */
#define PART_MOTION_THREE(v) {(v)[0], (v)[1], (v)[2]}
#define PART_MOTION_OF(p)                                                                          \
  ((part_motion){.velocity = PART_MOTION_THREE((p)->velocity),                                     \
                 .centre = PART_MOTION_THREE((p)->centre),                                         \
                 .rotation_axis = PART_MOTION_THREE((p)->rotation_axis),                           \
                 .rotation_rate = (p)->rotation_rate,                                              \
                 .oscillation_amplitude = (p)->oscillation_amplitude,                              \
                 .oscillation_frequency = (p)->oscillation_frequency,                              \
                 .oscillation_direction = PART_MOTION_THREE((p)->oscillation_direction),           \
                 .start_time = (p)->start_time,                                                    \
                 .stop_time = (p)->stop_time})

/* Where a wall is: what was given at X is at centre + way + turn (X - centre). */
typedef struct part_pose {
  double angle, turn[3][3];    /* rad, 1 */
  double way[3];               /* m */
  double drift[3], gain[3][3]; /* m/s, 1/s: velocity at x is drift + gain (x - centre - way) */
  double acceleration[3];      /* m/s2, of the centre, of the moment */
} part_pose;

/* Makes the directions unit vectors. PART_ERR_RANGE: rotation without an axis, oscillation without
 * direction or frequency, stop_time before start_time; the text names the entry. */
int part_motion_check(part_motion *motion);
int part_motion_moves(const part_motion *motion);
/* At time t; h > 0: the velocity is the mean over the step before, 0: of the moment. turn and gain are
 * set when rotation_rate is not 0, else left as they are. */
void part_motion_pose(const part_motion *motion, double t, double h, part_pose *pose);

#ifdef __cplusplus
}
#endif
#endif
