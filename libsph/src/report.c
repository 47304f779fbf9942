/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Numbers of the state, and the momentum budget. */
#include "internal.h"

int sph_rank_sum(const sph_t *sph, int n, double *values) {
  double *all = NULL;
  size_t room = 0;
  if (sph->ranks == 1)
    return PART_OK;
  PART_TRY(
      part_agree(sph->comm, sph_grow((size_t)n * (size_t)sph->ranks, sizeof *all, &room, &all)));
  const int status = MPI_Allgather(values, n, MPI_DOUBLE, all, n, MPI_DOUBLE, sph->comm);
  for (int k = 0; k < n; k++) {
    values[k] = 0.0;
    for (int r = 0; r < sph->ranks; r++)
      values[k] += all[r * n + k];
  }
  free(all);
  return status == MPI_SUCCESS ? PART_OK : part_fail(PART_ERR_MPI, "a sum over ranks failed");
}

void sph_own_momentum(const sph_t *sph, double momentum[3], double *size) {
  momentum[0] = momentum[1] = momentum[2] = 0.0;
  if (size != NULL)
    *size = 0.0;
  for (int i = 0; i < sph->store->local; i++) {
    const double *v = sph_xv(sph) + SPH_XV * (size_t)i + 4;
    const double m = sph_mass(sph)[SPH_MASS * (size_t)i];
    for (int c = 0; c < 3; c++)
      momentum[c] += m * v[c];
    if (size != NULL)
      *size += m * sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  }
}

static int budget(const sph_t *sph, sph_report *report) {
  double sums[16], *initial = sums + 12, error = 0.0;
  sph_own_momentum(sph, sums, &sums[15]);
  part_sum_total(&sph->gravity_impulse, sums + 3);
  part_sum_total(&sph->wall_impulse, sums + 6);
  part_sum_total(&sph->force_impulse, sums + 9);
  memcpy(initial, sph->initial_momentum, 3 * sizeof(double));
  PART_TRY(sph_rank_sum(sph, 16, sums));
  double scale = sums[15];
  for (int c = 0; c < 3; c++) {
    report->momentum[c] = sums[c];
    report->gravity_impulse[c] = sums[3 + c];
    report->wall_impulse[c] = sums[6 + c];
    report->force_impulse[c] = sums[9 + c];
    error = fmax(error, fabs(sums[c] - initial[c] - (sums[3 + c] + sums[6 + c] + sums[9 + c])));
    for (int k = 3; k < 12; k += 3)
      scale = fmax(scale, fabs(sums[k + c]));
  }
  report->budget_error = scale > 0.0 ? error / scale : 0.0;
  return PART_OK;
}

int sph_get_report(sph_t *sph, sph_report *report) {
  double most[3] = {0.0, -HUGE_VAL, 0.0}, sums[2] = {0.0, 0.0};
  if (!sph->started)
    return part_fail(PART_ERR_STATE, "sph_get_report comes after sph_start");
  memset(report, 0, sizeof *report);
  for (int i = 0; i < sph->store->local; i++) {
    const double *x = sph_xv(sph) + SPH_XV * (size_t)i, *m = sph_mass(sph) + SPH_MASS * (size_t)i;
    const double v2 = x[4] * x[4] + x[5] * x[5] + x[6] * x[6], density = m[1] / m[2];
    most[0] = fmax(most[0], v2);
    most[1] = fmax(most[1], -density);
    most[2] = fmax(most[2], density);
    sums[0] += 0.5 * m[0] * v2;
    sums[1] += x[3];
  }
  long long listed = sph->lists.listed;
  if (MPI_Allreduce(MPI_IN_PLACE, most, 3, MPI_DOUBLE, MPI_MAX, sph->comm) != MPI_SUCCESS ||
      MPI_Allreduce(MPI_IN_PLACE, &listed, 1, MPI_LONG_LONG, MPI_SUM, sph->comm) != MPI_SUCCESS)
    return part_fail(PART_ERR_MPI, "a maximum over ranks failed");
  PART_TRY(sph_rank_sum(sph, 2, sums));
  report->particles = sph->total;
  report->max_speed = sqrt(most[0]);
  report->least_density = -most[1];
  report->most_density = most[2];
  report->kinetic_energy = sums[0];
  report->volume = sums[1];
  report->steps = sph->steps;
  report->rebuilds = sph->rebuilds;
  report->listed = listed;
  return budget(sph, report);
}

int sph_wall_count(const sph_t *sph) {
  return sph->walls.count;
}
const char *sph_wall_name(const sph_t *sph, int wall) {
  return wall >= 0 && wall < sph->walls.count ? sph->walls.wall[wall].name : NULL;
}

int sph_get_wall_report(sph_t *sph, int number, sph_wall_report *report) {
  double sums[12];
  PART_TRY(sph_get_wall_force(sph, number, report->force, report->impulse));
  const sph_wall *wall = &sph->walls.wall[number];
  memcpy(sums, wall->torque, 3 * sizeof *sums);
  part_sum_total(&wall->work, sums + 3);
  sums[6] = wall->power;
  PART_TRY(sph_rank_sum(sph, 7, sums));
  memcpy(report->torque, sums, sizeof report->torque);
  report->work = sums[3];
  report->power = sums[6];
  for (int c = 0; c < 3; c++) {
    report->centre[c] = wall->motion.centre[c] + wall->pose.way[c];
    report->velocity[c] = wall->pose.drift[c];
  }
  report->angle = wall->pose.angle;
  return PART_OK;
}

int sph_get_wall_force(sph_t *sph, int wall, double force[3], double impulse[3]) {
  double sums[6];
  if (!sph->started)
    return part_fail(PART_ERR_STATE, "sph_get_wall_force comes after sph_start");
  if (wall < 0 || wall >= sph->walls.count)
    return part_fail(PART_ERR_RANGE, "there is no wall %d", wall);
  memcpy(sums, sph->walls.wall[wall].force, 3 * sizeof(double));
  part_sum_total(&sph->walls.wall[wall].impulse, sums + 3);
  PART_TRY(sph_rank_sum(sph, 6, sums));
  memcpy(force, sums, 3 * sizeof(double));
  memcpy(impulse, sums + 3, 3 * sizeof(double));
  return PART_OK;
}
