/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files: what dem_write adds to the particles, and how dem_read takes it up again. On the same
 * number of ranks the run goes on bit for bit; on another the decomposition is new and the sums of
 * all ranks of the writing run go to rank 0. */
#include "internal.h"
#include "particle/vtkhdf.h"

enum { STATE_VALUES = 17, BUDGET_VALUES = 33 };

static void pack_state(const dem_t *dem, double value[STATE_VALUES]) {
  const double packed[STATE_VALUES] = {dem->time,
                                       dem->r_mean,
                                       (double)dem->total,
                                       (double)dem->materials,
                                       (double)dem->walls.elements,
                                       (double)dem->blocks,
                                       (double)dem->substeps,
                                       (double)dem->rebuilds,
                                       (double)dem->generation,
                                       (double)dem->ranks,
                                       dem->skin,
                                       dem->shape.depth,
                                       dem_bonds_values(dem),
                                       dem->impact_speed,
                                       dem->load.reached,
                                       dem->kicked,
                                       dem->added_density};
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

static void pack_budget(const dem_t *dem, double value[BUDGET_VALUES]) {
  double *to = value;
  pack_sum(&dem->wall_impulse, &to);
  pack_sum(&dem->support_impulse, &to);
  pack_sum(&dem->gravity_impulse, &to);
  pack_sum(&dem->fluid_impulse, &to);
  memcpy(to, dem->initial_momentum, 3 * sizeof(double));
  memcpy(to + 3, dem->wall_force, 3 * sizeof(double));
  memcpy(to + 6, dem->support_force, 3 * sizeof(double));
}

/* Adds, so that several ranks of the writing run can be taken in one after the other. */
static void unpack_budget(dem_t *dem, const double *from) {
  unpack_sum(&dem->wall_impulse, &from);
  unpack_sum(&dem->support_impulse, &from);
  unpack_sum(&dem->gravity_impulse, &from);
  unpack_sum(&dem->fluid_impulse, &from);
  for (int c = 0; c < 3; c++) {
    dem->initial_momentum[c] += from[c];
    dem->wall_force[c] += from[3 + c];
    dem->support_force[c] += from[6 + c];
  }
}

/* History as records {id, number of entries} followed by the entries. */
typedef struct history_head {
  int64_t id, count;
} history_head;

static int pack_history(const dem_t *dem, size_t *size, unsigned char **bytes) {
  int *count;
  void *payload;
  *size = 0;
  *bytes = NULL;
  PART_TRY(dem_history_gather(dem, &count, &payload));
  for (int i = 0; i < dem->store->local; i++)
    if (count[i] > 0)
      *size += sizeof(history_head) + (size_t)count[i] * sizeof(dem_entry);
  const int status = dem_allocate(*size, 1, bytes);
  const unsigned char *from = payload;
  unsigned char *to = *bytes;
  for (int i = 0; status == PART_OK && i < dem->store->local; i++) {
    const history_head head = {dem_id(dem, i), count[i]};
    const size_t length = (size_t)count[i] * sizeof(dem_entry);
    if (count[i] == 0)
      continue;
    memcpy(to, &head, sizeof head);
    memcpy(to + sizeof head, from, length);
    to += sizeof head + length;
    from += length;
  }
  free(count);
  free(payload);
  return status;
}

static int by_id(const void *a, const void *b) {
  history_head x, y;
  memcpy(&x, *(const unsigned char *const *)a, sizeof x);
  memcpy(&y, *(const unsigned char *const *)b, sizeof y);
  return (x.id > y.id) - (x.id < y.id);
}

/* Pointers to the records, sorted by id. ERR_FORMAT when the lengths do not fit. */
static int index_history(const unsigned char *bytes, size_t size, const unsigned char ***record,
                         size_t *records) {
  size_t capacity = 0;
  history_head head;
  *records = 0;
  for (size_t at = 0; at < size;) {
    if (size - at >= sizeof head)
      memcpy(&head, bytes + at, sizeof head);
    if (size - at < sizeof head || head.count < 0 ||
        (size_t)head.count > (size - at - sizeof head) / sizeof(dem_entry))
      return part_fail(PART_ERR_FORMAT, "contact history is cut short");
    PART_TRY(dem_grow(*records + 1, sizeof **record, &capacity, record));
    (*record)[(*records)++] = bytes + at;
    at += sizeof head + (size_t)head.count * sizeof(dem_entry);
  }
  if (*records > 1)
    qsort(*record, *records, sizeof **record, by_id);
  return PART_OK;
}

/* History of own particles from all records, into kept_count and kept. */
static int take_history(dem_t *dem, const unsigned char **record, size_t records) {
  size_t used = 0, capacity = 0;
  dem_entry *entry = NULL;
  PART_TRY(dem_allocate((size_t)dem->store->local, sizeof *dem->kept_count, &dem->kept_count));
  for (int i = 0; i < dem->store->local; i++) {
    const history_head wanted = {dem_id(dem, i), 0};
    const unsigned char *key = (const unsigned char *)&wanted;
    const unsigned char **found =
        records > 0 ? bsearch(&key, record, records, sizeof *record, by_id) : NULL;
    history_head head = {0, 0};
    if (found != NULL)
      memcpy(&head, *found, sizeof head);
    dem->kept_count[i] = (int)head.count;
    PART_TRY(dem_grow(used + (size_t)head.count + 1, sizeof *entry, &capacity, &entry));
    dem->kept = entry;
    if (found != NULL)
      memcpy(entry + used, *found + sizeof head, (size_t)head.count * sizeof *entry);
    used += (size_t)head.count;
  }
  return PART_OK;
}

static int unpack_history(dem_t *dem, const unsigned char *bytes, size_t size) {
  const unsigned char **record = NULL;
  size_t records = 0;
  int status = index_history(bytes, size, &record, &records);
  if (status == PART_OK)
    status = take_history(dem, record, records);
  free(record);
  return status;
}

/* Sums of the walls, for this rank. */
static int write_walls(dem_t *dem, part_file *file) {
  const size_t size = (size_t)dem->walls.count * DEM_WALL_VALUES * sizeof(double);
  double *values = NULL;
  PART_TRY(part_agree(dem->comm, dem_allocate(size, 1, &values)));
  for (int w = 0; w < dem->walls.count; w++)
    dem_wall_pack(&dem->walls.wall[w], values + (size_t)w * DEM_WALL_VALUES);
  const int status = part_file_write_blob(file, "demWalls", size, values);
  free(values);
  return status;
}

/* Adds what each writing rank had, one after the other. */
static int unpack_walls(dem_t *dem, size_t size, const double *values) {
  const size_t one = (size_t)dem->walls.count * DEM_WALL_VALUES * sizeof(double);
  if (one > 0 && size % one != 0)
    return part_fail(PART_ERR_FORMAT, "the sums of walls are cut short");
  if (dem->restored_elsewhere && dem->rank > 0)
    return PART_OK;
  for (size_t k = 0; one > 0 && k < size / one; k++)
    for (int w = 0; w < dem->walls.count; w++, values += DEM_WALL_VALUES)
      dem_wall_unpack(&dem->walls.wall[w], values);
  return PART_OK;
}

/* Wear and impacts, for this rank; empty when they are not counted. */
static int write_wear(dem_t *dem, part_file *file) {
  const size_t n = dem_wear_size(dem);
  double *values = NULL;
  PART_TRY(part_agree(dem->comm, dem_allocate(n, sizeof *values, &values)));
  dem_wear_pack(dem, values);
  const int status = part_file_write_blob(file, "demWear", n * sizeof *values, values);
  free(values);
  return status;
}

/* A run that did not count before begins with nothing. */
static int unpack_wear(dem_t *dem, size_t size, const double *values) {
  PART_TRY(dem_wear_prepare(dem));
  const size_t n = dem_wear_size(dem);
  if (size == 0 || n == 0 || (dem->restored_elsewhere && dem->rank > 0))
    return PART_OK;
  if (size % (n * sizeof *values) != 0)
    return part_fail(PART_ERR_FORMAT, "wear and impacts were not counted for the same things as "
                                      "now: wearCoefficient and breakageCoefficient must be given "
                                      "both times or not");
  for (size_t k = 0; k < size / sizeof *values; k += n)
    dem_wear_unpack(dem, values + k);
  return PART_OK;
}

/* ---- writing --------------------------------------------------------------------------------- */
static int write_blobs(dem_t *dem, part_file *file) {
  double budget[BUDGET_VALUES];
  unsigned char *bytes = NULL;
  size_t size = 0;
  pack_budget(dem, budget);
  PART_TRY(part_file_write_blob(file, "demBudget", sizeof budget, budget));
  PART_TRY(write_walls(dem, file));
  PART_TRY(write_wear(dem, file));
  int status = part_agree(dem->comm, pack_history(dem, &size, &bytes));
  if (status == PART_OK)
    status = part_file_write_blob(file, "demHistory", size, bytes);
  free(bytes);
  bytes = NULL;
  if (status == PART_OK)
    status = part_agree(dem->comm, part_domain_save(dem->domain, &size, &bytes));
  if (status == PART_OK)
    status = part_file_write_blob(file, "demDecomposition", size, bytes);
  free(bytes);
  return status;
}

static int write_file(dem_t *dem, part_file *file) {
  double state[STATE_VALUES];
  PART_TRY(part_file_write_store(file, dem->store));
  pack_state(dem, state);
  PART_TRY(part_file_write_values(file, "demState", STATE_VALUES, state));
  PART_TRY(dem_blocks_write(dem, file));
  if (dem->plan.bonds)
    PART_TRY(dem_bonds_write(dem, file));
  return write_blobs(dem, file);
}

int dem_write(dem_t *dem, const char *path, const char *series) {
  part_file *file;
  if (!dem->started)
    return part_fail(PART_ERR_STATE, "dem_write comes after dem_start");
  PART_TRY(dem_rebuild(dem, 0, NULL, NULL));
  PART_TRY(part_file_create(dem->comm, path, dem->time, &file));
  const int status = write_file(dem, file);
  if (status != PART_OK) {
    part_file_close(file);
    return status;
  }
  return part_file_commit(file, series);
}

/* ---- reading --------------------------------------------------------------------------------- */
static int unpack_state(dem_t *dem, const char *path, const double *value) {
  if ((int)value[3] != dem->materials || (size_t)value[4] != dem->walls.elements)
    return part_fail(PART_ERR_FORMAT,
                     "%s was written with %d materials and %d wall elements; now there are %d and "
                     "%d",
                     path, (int)value[3], (int)value[4], dem->materials, (int)dem->walls.elements);
  if (value[11] != dem->shape.depth)
    return part_fail(PART_ERR_FORMAT,
                     "%s was written with a depth of %g m (0: spheres); now it is %g m", path,
                     value[11], dem->shape.depth);
  if (value[16] != dem->added_density)
    return part_fail(PART_ERR_FORMAT,
                     "%s was written with an added mass of %g kg/m3 of particle (virtualMass); now "
                     "it is %g kg/m3",
                     path, value[16], dem->added_density);
  dem->time = value[0];
  dem->r_mean = value[1];
  dem->total = (int64_t)value[2];
  dem->blocks = (int)value[5];
  dem->substeps = (long long)value[6];
  dem->rebuilds = (long long)value[7] - 1; /* dem_start rebuilds once more than the writing run */
  dem->generation = (long long)value[8] - 1;
  dem->restored_elsewhere = (int)value[9] != dem->ranks;
  dem->skin = value[10];
  dem->impact_speed = value[13];
  dem->load.reached = value[14];
  dem->kicked = (int)value[15];
  return PART_OK;
}

static int read_blob(dem_t *dem, part_file *file, const char *name, size_t *size, void **bytes) {
  return dem->restored_elsewhere ? part_file_read_all_blobs(file, name, size, bytes)
                                 : part_file_read_blob(file, name, size, bytes);
}

static int read_blobs(dem_t *dem, part_file *file) {
  void *bytes = NULL;
  size_t size = 0;
  PART_TRY(read_blob(dem, file, "demBudget", &size, &bytes));
  const double *budget = bytes;
  if (!dem->restored_elsewhere || dem->rank == 0)
    for (size_t k = 0; k < size / (BUDGET_VALUES * sizeof(double)); k++)
      unpack_budget(dem, budget + k * BUDGET_VALUES);
  free(bytes);
  bytes = NULL;
  PART_TRY(read_blob(dem, file, "demWalls", &size, &bytes));
  int status = part_agree(dem->comm, unpack_walls(dem, size, bytes));
  free(bytes);
  bytes = NULL;
  PART_TRY(status);
  PART_TRY(read_blob(dem, file, "demWear", &size, &bytes));
  status = part_agree(dem->comm, unpack_wear(dem, size, bytes));
  free(bytes);
  bytes = NULL;
  PART_TRY(status);
  PART_TRY(read_blob(dem, file, "demHistory", &size, &bytes));
  status = part_agree(dem->comm, unpack_history(dem, bytes, size));
  free(bytes);
  bytes = NULL;
  if (status != PART_OK || dem->restored_elsewhere)
    return status;
  PART_TRY(part_file_read_blob(file, "demDecomposition", &size, &bytes));
  status = part_agree(dem->comm, part_domain_load(dem->domain, size, bytes));
  free(bytes);
  return status;
}

static int check_materials(const dem_t *dem, const char *path) {
  for (int i = 0; i < dem->store->local; i++) {
    const double m = dem_vm(dem)[DEM_VM * (size_t)i + 7];
    if (!(m >= 0.0 && m < dem->materials && m == floor(m)))
      return part_fail(PART_ERR_FORMAT, "%s: particle %lld has material %g of %d", path,
                       (long long)dem_id(dem, i), m, dem->materials);
  }
  return PART_OK;
}

static int read_file(dem_t *dem, const char *path, part_file *file) {
  double state[STATE_VALUES];
  int n = STATE_VALUES;
  PART_TRY(part_file_read_values(file, "demState", &n, state));
  PART_TRY(part_agree(dem->comm, n == STATE_VALUES ? unpack_state(dem, path, state)
                                                   : part_fail(PART_ERR_FORMAT,
                                                               "%s: demState has %d values, not "
                                                               "%d",
                                                               path, n, STATE_VALUES)));
  PART_TRY(part_file_read_store(file, dem->store));
  PART_TRY(part_agree(dem->comm, check_materials(dem, path)));
  PART_TRY(dem_blocks_read(dem, file));
  if (state[12] > 0.0)
    PART_TRY(dem_bonds_read(dem, file, (int)state[12]));
  return read_blobs(dem, file);
}

int dem_read(dem_t *dem, const char *path) {
  part_file *file;
  double time;
  if (dem->started || dem->restored || dem->seeds > 0)
    return part_fail(PART_ERR_STATE, "dem_read comes before dem_start, in place of insertion");
  PART_TRY(part_file_open(dem->comm, path, &time, &file));
  const int status = read_file(dem, path, file);
  part_file_close(file);
  if (status == PART_OK)
    dem->restored = 1;
  return status;
}
