/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const part_record records[] = {
    {"xr", PART_DOUBLE, 4}, {"v", PART_DOUBLE, 4},   {"force", PART_DOUBLE, 3},
    {"id", PART_INT64, 1},  {"code", PART_INT64, 2},
};
static const part_field fields[] = {
    {"position", REC_XR, 0, 3, PART_MOVES | PART_GHOST | PART_WRITTEN, "m", "centre"},
    {"radius", REC_XR, 3, 1, PART_MOVES | PART_GHOST | PART_WRITTEN, "m", "radius"},
    {"velocity", REC_V, 0, 3, PART_MOVES | PART_GHOST | PART_WRITTEN, "m/s", "velocity"},
    {"force", REC_F, 0, 3, 0, "N", "force of this step"},
    {"id", REC_ID, 0, 1, PART_MOVES | PART_WRITTEN, "", "global number"},
    {"code", REC_CODE, 1, 1, PART_MOVES | PART_WRITTEN, "", "some number"},
};
const part_layout test_layout = {(int)(sizeof records / sizeof records[0]), records,
                                 (int)(sizeof fields / sizeof fields[0]), fields, F_ID};

void check_ok(int status, const char *call, const char *file, int line) {
  if (status != PART_OK) {
    print_error("%s: %s: %s\n", call, part_status_name(status), part_last_error());
    _assert_int_equal((uintmax_t)status, 0, file, line);
  }
}

void check_fails(int wanted, const char *words, int status, const char *call, const char *file,
                 int line) {
  if (status != wanted || strstr(part_last_error(), words) == NULL) {
    print_error("%s: wanted %s with '%s', got %s: %s\n", call, part_status_name(wanted), words,
                part_status_name(status), part_last_error());
    _fail(file, line);
  }
}

/* splitmix64 (Steele, Lea and Flood 2014) */
static uint64_t next(uint64_t *state) {
  uint64_t z = (*state += UINT64_C(0x9e3779b97f4a7c15));
  z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
  z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
  return z ^ (z >> 31);
}

double uniform(uint64_t *state) {
  return (double)(next(state) >> 11) * 0x1p-53;
}
int below(uint64_t *state, int n) {
  return (int)(uniform(state) * n);
}

double *position(const part_store *store, int i) {
  return part_field_double(store, F_X) + 4 * (size_t)i;
}
double *radius(const part_store *store, int i) {
  return part_field_double(store, F_R) + 4 * (size_t)i;
}
double *velocity(const part_store *store, int i) {
  return part_field_double(store, F_V) + 4 * (size_t)i;
}
int64_t *id_of(const part_store *store, int i) {
  return part_field_int64(store, F_ID) + i;
}
int64_t *code_of(const part_store *store, int i) {
  return part_field_int64(store, F_CODE) + 2 * (size_t)i;
}

static double velocity_of(int64_t id, int d) {
  return 1.0 / (1.0 + 3.0 * (double)id + d);
}

void fill_particle(part_store *store, int i, int64_t id, const double x[3], double r) {
  *id_of(store, i) = id;
  *code_of(store, i) = id * 7919 + 13;
  *radius(store, i) = r;
  for (int d = 0; d < 3; d++) {
    position(store, i)[d] = x[d];
    velocity(store, i)[d] = velocity_of(id, d);
  }
}

int intact(const part_store *store, int i) {
  const int64_t id = *id_of(store, i);
  for (int d = 0; d < 3; d++)
    if (velocity(store, i)[d] != velocity_of(id, d))
      return 0;
  return *code_of(store, i) == id * 7919 + 13;
}

void fill_random(part_store *store, int n, int64_t first_id, const part_box *box, double r0,
                 double r1, uint64_t *state) {
  int first;
  OK(part_store_append(store, n, &first));
  for (int k = 0; k < n; k++) {
    double x[3];
    for (int d = 0; d < 3; d++)
      x[d] = box->lo[d] + uniform(state) * (box->hi[d] - box->lo[d]);
    fill_particle(store, first + k, first_id + k, x, r0 + uniform(state) * (r1 - r0));
  }
}

int world_rank(void) {
  int rank;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  return rank;
}

int world_size(void) {
  int size;
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  return size;
}

long long sum_over_ranks(long long value) {
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_LONG_LONG, MPI_SUM, MPI_COMM_WORLD);
  return value;
}

void each_domain(const part_box *box, int each, double r0, double r1, part_domain **domain,
                 part_store **store) {
  uint64_t seed = 1234 + (uint64_t)world_rank();
  OK(part_domain_create(MPI_COMM_WORLD, box, domain));
  OK(part_store_create(&test_layout, store));
  fill_random(*store, each, (int64_t)each * world_rank(), box, r0, r1, &seed);
  OK(part_domain_balance(*domain, *store, NULL));
  OK(part_domain_migrate(*domain, *store, 0, NULL, NULL));
}

void shared_domain(const part_box *box, int n, int scattered, part_domain **domain,
                   part_store **store) {
  uint64_t seed = 11 + (uint64_t)world_rank();
  OK(part_domain_create(MPI_COMM_WORLD, box, domain));
  OK(part_store_create(&test_layout, store));
  const int each = n / world_size(), rest = n - each * (world_size() - 1);
  int mine = scattered ? each : 0;
  if (world_rank() == 0)
    mine = scattered ? rest : n;
  const int64_t first = world_rank() == 0 ? 0 : rest + (int64_t)each * (world_rank() - 1);
  fill_random(*store, mine, first, box, 0.01, 0.02, &seed);
  OK(part_domain_balance(*domain, *store, NULL));
  OK(part_domain_migrate(*domain, *store, 0, NULL, NULL));
}

void drop_domain(part_domain *domain, part_store *store) {
  part_store_destroy(store);
  part_domain_destroy(domain);
}

double *all_particles(const part_store *store, int *n) {
  const int mine = 5 * store->local, size = world_size();
  int *count = calloc(2 * (size_t)size, sizeof *count), *start = count + size;
  double *own = calloc((size_t)mine + 1, sizeof *own);
  for (int i = 0; i < store->local; i++) {
    memcpy(own + 5 * i, position(store, i), 4 * sizeof *own);
    own[5 * i + 4] = (double)*id_of(store, i);
  }
  MPI_Allgather(&mine, 1, MPI_INT, count, 1, MPI_INT, MPI_COMM_WORLD);
  *n = 0;
  for (int r = 0; r < size; r++) {
    start[r] = *n;
    *n += count[r];
  }
  double *all = calloc((size_t)*n + 1, sizeof *all);
  MPI_Allgatherv(own, mine, MPI_DOUBLE, all, count, start, MPI_DOUBLE, MPI_COMM_WORLD);
  *n /= 5;
  free(own);
  free(count);
  return all;
}
