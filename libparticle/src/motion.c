/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>

#include "particle/motion.h"
#include "particle/status.h"

/* To unit length; 0 stays. */
static int direction(double v[3], int needed, const char *entry, const char *why) {
  const double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  for (int c = 0; c < 3 && length > 0.0; c++)
    v[c] /= length;
  if (needed && !(length > 0.0 && isfinite(length)))
    return part_fail(PART_ERR_RANGE, "entry %s: a vector that is not zero is needed for %s", entry,
                     why);
  return PART_OK;
}

int part_motion_check(part_motion *m) {
  PART_TRY(direction(m->rotation_axis, m->rotation_rate != 0.0, "rotationAxis", "rotationRate"));
  PART_TRY(direction(m->oscillation_direction, m->oscillation_amplitude > 0.0,
                     "oscillationDirection", "oscillationAmplitude"));
  if (m->oscillation_amplitude > 0.0 && !(m->oscillation_frequency > 0.0))
    return part_fail(PART_ERR_RANGE,
                     "entry oscillationFrequency: must be positive with oscillationAmplitude %g m",
                     m->oscillation_amplitude);
  if (!(m->stop_time >= m->start_time))
    return part_fail(PART_ERR_RANGE, "entry stopTime: %g s is before startTime %g s", m->stop_time,
                     m->start_time);
  return PART_OK;
}

int part_motion_moves(const part_motion *m) {
  const double *v = m->velocity;
  return m->rotation_rate != 0.0 || sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) > 0.0 ||
         m->oscillation_amplitude > 0.0;
}

/* Time that the wall has moved until t. */
static double moved_time(const part_motion *m, double t) {
  return fmax(fmin(t, m->stop_time) - m->start_time, 0.0);
}

static void set_turn(const double axis[3], double angle, double turn[3][3]) {
  const double s = sin(angle), half = sin(0.5 * angle), one = 2.0 * half * half; /* 1 - cos */
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      turn[i][j] = one * axis[i] * axis[j] + (i == j ? 1.0 - one : 0.0);
  turn[0][1] -= s * axis[2];
  turn[1][0] += s * axis[2];
  turn[0][2] += s * axis[1];
  turn[2][0] -= s * axis[1];
  turn[1][2] -= s * axis[0];
  turn[2][1] += s * axis[0];
}

/* Velocity field whose displacement over h is that of the wall: with K the cross product with the
 * axis and b the angle of the step, (1 - turn(-b))/h = (sin b K - (1 - cos b) K K)/h. */
static void set_gain(const double k[3], double rate, double h, double moved, double gain[3][3]) {
  const double b = rate * moved, half = sin(0.5 * b);
  const double s = h > 0.0 ? sin(b) / h : rate, one = h > 0.0 ? 2.0 * half * half / h : 0.0;
  const double cross[3][3] = {{0.0, -k[2], k[1]}, {k[2], 0.0, -k[0]}, {-k[1], k[0], 0.0}};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) /* K K = k k^T - 1 */
      gain[i][j] = s * cross[i][j] - one * (k[i] * k[j] - (i == j ? 1.0 : 0.0));
}

/* Parts of the step h before t in which the wall moved. */
static double step_time(const part_motion *m, double t, double h) {
  if (t - h >= m->start_time && t <= m->stop_time)
    return h;
  return fmax(fmin(t, m->stop_time) - fmax(t - h, m->start_time), 0.0);
}

void part_motion_pose(const part_motion *m, double t, double h, part_pose *pose) {
  const double two_pi = 6.28318530717958647693, omega = two_pi * m->oscillation_frequency;
  const double s = moved_time(m, t), step = h > 0.0 ? step_time(m, t, h) : 0.0;
  const int now = t >= m->start_time && t < m->stop_time;
  /* sin(omega s) - sin(omega (s - step)) without the cancellation */
  const double swing = h > 0.0 ? 2.0 * cos(omega * (s - 0.5 * step)) * sin(0.5 * omega * step) / h
                               : (now ? omega * cos(omega * s) : 0.0);
  const double share = h > 0.0 ? step / h : now;
  for (int c = 0; c < 3; c++) {
    const double way = m->oscillation_amplitude * m->oscillation_direction[c];
    pose->way[c] = m->velocity[c] * s + way * sin(omega * s);
    pose->drift[c] = m->velocity[c] * share + way * swing;
    pose->acceleration[c] = now ? -way * omega * omega * sin(omega * s) : 0.0;
  }
  pose->angle = m->rotation_rate * s;
  if (m->rotation_rate == 0.0)
    return;
  set_turn(m->rotation_axis, pose->angle, pose->turn);
  set_gain(m->rotation_axis, h > 0.0 || now ? m->rotation_rate : 0.0, h, step, pose->gain);
}
