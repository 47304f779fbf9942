/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Wall-clock time per named stage. Cheap enough for every step (two clock reads a stage). */
#ifndef PARTICLE_TIMERS_H
#define PARTICLE_TIMERS_H

#include <mpi.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct part_timers part_timers;

int part_timers_create(part_timers **timers);
void part_timers_destroy(part_timers *timers);
/* Index of a stage, made when new (ERR_RANGE beyond 64). */
int part_timers_stage(part_timers *timers, const char *name, int *stage);
void part_timers_start(part_timers *timers, int stage);
void part_timers_stop(part_timers *timers, int stage);
/* Seconds and number of intervals of a stage on this rank. */
double part_timers_seconds(const part_timers *timers, int stage);
long long part_timers_calls(const part_timers *timers, int stage);
/* Collective: a table (stage, calls, mean and largest seconds over ranks, share) into text. */
int part_timers_report(const part_timers *timers, MPI_Comm comm, size_t size, char *text);

#ifdef __cplusplus
}
#endif
#endif
