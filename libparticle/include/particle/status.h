/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Status and error text of all libraries. Every call that can fail returns an int: PART_OK (0) or
 * one of enum part_status. The text of the last failure of this thread stays until the next one. */
#ifndef PARTICLE_STATUS_H
#define PARTICLE_STATUS_H

#include <mpi.h>

#ifdef __cplusplus
extern "C" {
#endif

enum part_status {
#define PART_STATUS(name, text) PART_##name,
#include "particle/status.def"
#undef PART_STATUS
  PART_STATUS_COUNT
};

/* Return from the calling function when a call fails. */
#define PART_TRY(call)                                                                             \
  do {                                                                                             \
    const int part_try_status = (call);                                                            \
    if (part_try_status != 0)                                                                      \
      return part_try_status;                                                                      \
  } while (0)

/* Record a formatted message (at most 1023 bytes are kept) and return status unchanged. */
int part_fail(int status, const char *format, ...)
#if defined(__GNUC__)
    __attribute__((format(printf, 2, 3)))
#endif
    ;

/* Put "where: " in front of the last message; returns status. For callers that know more. */
int part_fail_context(int status, const char *format, ...)
#if defined(__GNUC__)
    __attribute__((format(printf, 2, 3)))
#endif
    ;

const char *part_status_name(int status); /* "ERR_RANGE" */
const char *part_status_text(int status); /* "a value is outside its allowed range" */
const char *part_last_error(void);        /* message of the last part_fail of this thread, or "" */

/* Collective: every rank gets the largest status of all and the message of the lowest rank that
 * has it, so that all ranks leave together instead of waiting for one that has failed. */
int part_agree(MPI_Comm comm, int status);

#ifdef __cplusplus
}
#endif
#endif
