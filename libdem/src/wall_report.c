/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Force, torque, impulse and work of particles and walls on each other. */
#include "internal.h"

void dem_walls_no_force(dem_t *dem) {
  for (int c = 0; c < 3; c++)
    dem->wall_force[c] = 0.0;
  for (int w = 0; w < dem->walls.count; w++) {
    dem_wall *wall = &dem->walls.wall[w];
    memset(wall->force, 0, sizeof wall->force);
    memset(wall->torque, 0, sizeof wall->torque);
  }
}

void dem_walls_add_impulse(dem_t *dem, double h) {
  for (int w = 0; w < dem->walls.count; w++) {
    dem_wall *wall = &dem->walls.wall[w];
    part_sum_add(&wall->impulse, wall->force, h);
    part_sum_add(&wall->spin_impulse, wall->torque, h);
    if (!wall->moves)
      continue;
    double work[3] = {0.0, 0.0, 0.0};
    for (int c = 0; c < 3; c++)
      work[0] -= wall->force[c] * wall->pose.body.drift[c] + wall->torque[c] * wall->spin[c];
    part_sum_add(&wall->work, work, h);
  }
}

int dem_get_wall_report(dem_t *dem, int number, dem_wall_report *report) {
  double sums[13];
  if (!dem->started)
    return part_fail(PART_ERR_STATE, "dem_get_wall_report comes after dem_start");
  if (number < 0 || number >= dem->walls.count)
    return part_fail(PART_ERR_RANGE, "there is no wall %d; numbers are 0 to %d", number,
                     dem->walls.count - 1);
  const dem_wall *wall = &dem->walls.wall[number];
  double work[3];
  memcpy(sums, wall->force, 3 * sizeof(double));
  memcpy(sums + 3, wall->torque, 3 * sizeof(double));
  part_sum_total(&wall->impulse, sums + 6);
  part_sum_total(&wall->spin_impulse, sums + 9);
  part_sum_total(&wall->work, work);
  sums[12] = work[0];
  PART_TRY(dem_rank_sum(dem, 13, sums));
  memset(report, 0, sizeof *report);
  report->name = wall->name;
  report->elements = wall->given;
  memcpy(report->spin, wall->spin, sizeof report->spin);
  for (int c = 0; c < 3; c++) {
    report->centre[c] = wall->params.centre[c] + wall->pose.body.way[c];
    report->velocity[c] = wall->pose.body.drift[c];
    report->force[c] = sums[c];
    report->torque[c] = sums[3 + c];
    report->impulse[c] = sums[6 + c];
    report->spin_impulse[c] = sums[9 + c];
  }
  report->work = sums[12];
  return PART_OK;
}

static double *pack_sum(const part_sum *sum, double *to) {
  memcpy(to, sum->value, sizeof sum->value);
  memcpy(to + 3, sum->lost, sizeof sum->lost);
  return to + 6;
}

static const double *unpack_sum(part_sum *sum, const double *from) {
  for (int c = 0; c < 3; c++) {
    sum->value[c] += from[c];
    sum->lost[c] += from[3 + c];
  }
  return from + 6;
}

void dem_wall_pack(const dem_wall *wall, double value[DEM_WALL_VALUES]) {
  double *to = pack_sum(&wall->spin_impulse, pack_sum(&wall->impulse, value));
  to = pack_sum(&wall->work, to);
  memcpy(to, wall->force, 3 * sizeof(double));
  memcpy(to + 3, wall->torque, 3 * sizeof(double));
}

void dem_wall_unpack(dem_wall *wall, const double value[DEM_WALL_VALUES]) {
  const double *from = unpack_sum(&wall->spin_impulse, unpack_sum(&wall->impulse, value));
  from = unpack_sum(&wall->work, from);
  for (int c = 0; c < 3; c++) {
    wall->force[c] += from[c];
    wall->torque[c] += from[3 + c];
  }
}
