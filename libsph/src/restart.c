/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files: what sph_write adds to the particles, and how sph_read takes it up again. On the same
 * number of ranks the run goes on bit for bit; on another the decomposition is new and the sums of
 * all ranks of the writing run go to rank 0. */
#include "internal.h"
#include "particle/vtkhdf.h"

enum { STATE_VALUES = 13, BUDGET_VALUES = 24, WALL_VALUES = 19 };

/* The first are what must be as it was, the others go on. */
static void pack_state(const sph_t *sph, double value[STATE_VALUES]) {
  const sph_params *p = &sph->params;
  const double packed[STATE_VALUES] = {
      (double)p->dimensions,  p->depth,           p->spacing,
      p->smoothing_length,    p->kernel,          p->density,
      sph->walls.count,       sph->ranks,         sph->time,
      (double)sph->total,     (double)sph->steps, (double)sph->rebuilds,
      (double)sph->generation};
  memcpy(value, packed, sizeof packed);
}

static void pack_sum(const part_sum *sum, double **to) {
  memcpy(*to, sum->value, sizeof sum->value);
  memcpy(*to + 3, sum->lost, sizeof sum->lost);
  *to += 6;
}

static void unpack_sum(part_sum *sum, const double **from) {
  for (int c = 0; c < 3; c++) {
    sum->value[c] += (*from)[c];
    sum->lost[c] += (*from)[3 + c];
  }
  *from += 6;
}

/* [BUDGET_VALUES], then [walls][WALL_VALUES]. */
static int pack_budget(const sph_t *sph, double **values, size_t *n) {
  size_t room = 0;
  *n = BUDGET_VALUES + WALL_VALUES * (size_t)sph->walls.count;
  PART_TRY(sph_grow(*n, sizeof **values, &room, values));
  double *to = *values;
  pack_sum(&sph->gravity_impulse, &to);
  pack_sum(&sph->wall_impulse, &to);
  pack_sum(&sph->force_impulse, &to);
  memcpy(to, sph->initial_momentum, 3 * sizeof *to);
  memcpy(to + 3, sph->wall_force, 3 * sizeof *to);
  to += 6;
  for (int w = 0; w < sph->walls.count; w++) {
    pack_sum(&sph->walls.wall[w].impulse, &to);
    pack_sum(&sph->walls.wall[w].work, &to);
    memcpy(to, sph->walls.wall[w].force, 3 * sizeof *to);
    memcpy(to + 3, sph->walls.wall[w].torque, 3 * sizeof *to);
    to[6] = sph->walls.wall[w].power;
    to += 7;
  }
  return PART_OK;
}

/* Adds, so that several ranks of the writing run can be taken in one after the other. */
static void add_budget(sph_t *sph, const double *from) {
  unpack_sum(&sph->gravity_impulse, &from);
  unpack_sum(&sph->wall_impulse, &from);
  unpack_sum(&sph->force_impulse, &from);
  for (int c = 0; c < 3; c++) {
    sph->initial_momentum[c] += from[c];
    sph->wall_force[c] += from[3 + c];
  }
  from += 6;
  for (int w = 0; w < sph->walls.count; w++) {
    sph_wall *wall = &sph->walls.wall[w];
    unpack_sum(&wall->impulse, &from);
    unpack_sum(&wall->work, &from);
    for (int c = 0; c < 3; c++) {
      wall->force[c] += from[c];
      wall->torque[c] += from[3 + c];
    }
    wall->power += from[6];
    from += 7;
  }
}

static int unpack_budget(sph_t *sph, size_t size, const double *values) {
  const size_t one = BUDGET_VALUES + WALL_VALUES * (size_t)sph->walls.count;
  if (size % (one * sizeof *values) != 0 || size == 0)
    return part_fail(PART_ERR_FORMAT, "the sums of momentum are cut short");
  if (sph->restored_elsewhere && sph->rank > 0)
    return PART_OK;
  for (size_t k = 0; k < size / sizeof *values; k += one)
    add_budget(sph, values + k);
  return PART_OK;
}

/* ---- writing --------------------------------------------------------------------------------- */
static int write_blobs(sph_t *sph, part_file *file) {
  double *budget = NULL;
  unsigned char *bytes = NULL;
  size_t size = 0;
  int status = part_agree(sph->comm, pack_budget(sph, &budget, &size));
  if (status == PART_OK)
    status = part_file_write_blob(file, "sphBudget", size * sizeof *budget, budget);
  free(budget);
  if (status == PART_OK)
    status = part_agree(sph->comm, part_domain_save(sph->domain, &size, &bytes));
  if (status == PART_OK)
    status = part_file_write_blob(file, "sphDecomposition", size, bytes);
  free(bytes);
  return status;
}

static int write_file(sph_t *sph, part_file *file) {
  double state[STATE_VALUES];
  PART_TRY(part_file_write_store(file, sph->store));
  pack_state(sph, state);
  PART_TRY(part_file_write_values(file, "sphState", STATE_VALUES, state));
  return write_blobs(sph, file);
}

int sph_write(sph_t *sph, const char *path, const char *series) {
  part_file *file;
  if (!sph->started)
    return part_fail(PART_ERR_STATE, "sph_write comes after sph_start");
  PART_TRY(sph_rebuild(sph, 0));
  PART_TRY(part_file_create(sph->comm, path, sph->time, &file));
  const int status = write_file(sph, file);
  if (status != PART_OK) {
    part_file_close(file);
    return status;
  }
  return part_file_commit(file, series);
}

/* ---- reading --------------------------------------------------------------------------------- */
static int unpack_state(sph_t *sph, const char *path, int n, const double *value) {
  static const char *const what[] = {"dimensions",    "depth",   "spacing", "smoothingLength",
                                     "kernel number", "density", "walls"};
  double now[STATE_VALUES];
  if (n != STATE_VALUES)
    return part_fail(PART_ERR_FORMAT, "%s: sphState has %d values, not %d", path, n, STATE_VALUES);
  pack_state(sph, now);
  for (int k = 0; k < 7; k++)
    if (value[k] != now[k])
      return part_fail(PART_ERR_FORMAT, "%s was written with %s %g; now it is %g", path, what[k],
                       value[k], now[k]);
  sph->restored_elsewhere = (int)value[7] != sph->ranks;
  sph->time = value[8];
  sph->total = (int64_t)value[9];
  sph->steps = (long long)value[10];
  sph->rebuilds = (long long)value[11] - 1; /* sph_start rebuilds once more than the writing run */
  sph->generation = (long long)value[12] - 1;
  return PART_OK;
}

static int read_blobs(sph_t *sph, part_file *file) {
  void *bytes = NULL;
  size_t size = 0;
  PART_TRY(sph->restored_elsewhere ? part_file_read_all_blobs(file, "sphBudget", &size, &bytes)
                                   : part_file_read_blob(file, "sphBudget", &size, &bytes));
  int status = part_agree(sph->comm, unpack_budget(sph, size, bytes));
  free(bytes);
  bytes = NULL;
  if (status != PART_OK || sph->restored_elsewhere)
    return status;
  PART_TRY(part_file_read_blob(file, "sphDecomposition", &size, &bytes));
  status = part_agree(sph->comm, part_domain_load(sph->domain, size, bytes));
  free(bytes);
  return status;
}

static int read_file(sph_t *sph, const char *path, part_file *file) {
  double state[STATE_VALUES];
  int n = STATE_VALUES;
  PART_TRY(part_file_read_values(file, "sphState", &n, state));
  PART_TRY(part_agree(sph->comm, unpack_state(sph, path, n, state)));
  PART_TRY(part_file_read_store(file, sph->store));
  return read_blobs(sph, file);
}

int sph_read(sph_t *sph, const char *path) {
  part_file *file;
  double time;
  if (sph->started || sph->restored || sph->total > 0)
    return part_fail(PART_ERR_STATE, "sph_read comes before sph_start, in place of insertion");
  PART_TRY(part_file_open(sph->comm, path, &time, &file));
  const int status = read_file(sph, path, file);
  part_file_close(file);
  if (status == PART_OK)
    sph->restored = 1;
  return status;
}
