/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Wall-clock timers by stage name. The clock is the system's, so that timing needs no MPI. */
#define _POSIX_C_SOURCE 200809L
#include "particle/timers.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "memory.h"
#include "particle/status.h"

enum { STAGES_MAX = 64, NAME_LENGTH = 40 };

typedef struct timer_stage {
  char name[NAME_LENGTH];
  double seconds, begun;
  long long calls;
} timer_stage;

struct part_timers {
  int count;
  timer_stage stage[STAGES_MAX];
};

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

int part_timers_create(part_timers **timers) {
  *timers = NULL;
  return part_allocate(1, sizeof **timers, timers);
}

void part_timers_destroy(part_timers *timers) {
  free(timers);
}

int part_timers_stage(part_timers *timers, const char *name, int *stage) {
  if (strlen(name) >= NAME_LENGTH)
    return part_fail(PART_ERR_RANGE, "stage name '%s' is longer than %d", name, NAME_LENGTH - 1);
  for (int s = 0; s < timers->count; s++)
    if (strcmp(timers->stage[s].name, name) == 0) {
      *stage = s;
      return PART_OK;
    }
  if (timers->count == STAGES_MAX)
    return part_fail(PART_ERR_RANGE, "stage '%s' is one more than the %d that timers hold", name,
                     STAGES_MAX);
  *stage = timers->count++;
  memcpy(timers->stage[*stage].name, name, strlen(name) + 1);
  return PART_OK;
}

void part_timers_start(part_timers *timers, int stage) {
  timers->stage[stage].begun = now();
}

void part_timers_stop(part_timers *timers, int stage) {
  timer_stage *s = &timers->stage[stage];
  s->seconds += now() - s->begun;
  s->calls++;
}

double part_timers_seconds(const part_timers *timers, int stage) {
  return timers->stage[stage].seconds;
}

long long part_timers_calls(const part_timers *timers, int stage) {
  return timers->stage[stage].calls;
}

/* Mean and largest over ranks. All ranks must have made the same stages in the same order. */
static int reduce(const part_timers *timers, MPI_Comm comm, double *mean, double *largest) {
  double seconds[STAGES_MAX];
  int size = 1, count[2] = {timers->count, -timers->count}, extreme[2];
  for (int s = 0; s < timers->count; s++)
    seconds[s] = mean[s] = largest[s] = timers->stage[s].seconds;
  MPI_Comm_size(comm, &size);
  if (size == 1)
    return PART_OK;
  if (MPI_Allreduce(count, extreme, 2, MPI_INT, MPI_MAX, comm) != MPI_SUCCESS)
    return part_fail(PART_ERR_MPI, "MPI_Allreduce failed");
  if (extreme[0] != -extreme[1])
    return part_fail(PART_ERR_STATE, "ranks have between %d and %d timer stages", -extreme[1],
                     extreme[0]);
  if (MPI_Allreduce(seconds, mean, timers->count, MPI_DOUBLE, MPI_SUM, comm) != MPI_SUCCESS ||
      MPI_Allreduce(seconds, largest, timers->count, MPI_DOUBLE, MPI_MAX, comm) != MPI_SUCCESS)
    return part_fail(PART_ERR_MPI, "MPI_Allreduce failed");
  for (int s = 0; s < timers->count; s++)
    mean[s] /= size;
  return PART_OK;
}

int part_timers_report(const part_timers *timers, MPI_Comm comm, size_t size, char *text) {
  double mean[STAGES_MAX], largest[STAGES_MAX], total = 0.0;
  if (size == 0)
    return part_fail(PART_ERR_ARGUMENT, "no room for the table of timers");
  text[0] = '\0';
  PART_TRY(reduce(timers, comm, mean, largest));
  for (int s = 0; s < timers->count; s++)
    total += mean[s];
  size_t used = 0;
  for (int s = -1; s < timers->count && used < size; s++) {
    int n;
    if (s < 0)
      n = snprintf(text, size, "%-24s %12s %12s %12s %7s\n", "stage", "calls", "mean s",
                   "largest s", "share");
    else
      n = snprintf(text + used, size - used, "%-24s %12lld %12.4g %12.4g %6.1f%%\n",
                   timers->stage[s].name, timers->stage[s].calls, mean[s], largest[s],
                   total > 0.0 ? 100.0 * mean[s] / total : 0.0);
    used += n > 0 ? (size_t)n : 0;
  }
  if (used >= size)
    return part_fail(PART_ERR_ARGUMENT, "the table of timers needs more than %zu bytes", size);
  return PART_OK;
}
