/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Status names, the error text of this thread, and agreement of ranks on a status. */
#include "particle/status.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Room for at most 1023 bytes, as the header promises. */
enum { MESSAGE_SIZE = 1024 };

static _Thread_local char message[MESSAGE_SIZE];

int part_fail(int status, const char *format, ...) {
  /* By way of a buffer: an argument may be part_last_error() itself. */
  char text[MESSAGE_SIZE];
  va_list args;
  va_start(args, format);
  vsnprintf(text, sizeof text, format, args);
  va_end(args);
  memcpy(message, text, sizeof message);
  return status;
}

int part_fail_context(int status, const char *format, ...) {
  char text[2 * MESSAGE_SIZE + 2];
  va_list args;
  va_start(args, format);
  vsnprintf(text, MESSAGE_SIZE, format, args);
  va_end(args);
  strcat(text, ": ");
  strcat(text, message);
  text[MESSAGE_SIZE - 1] = '\0';
  memcpy(message, text, sizeof message);
  return status;
}

const char *part_status_name(int status) {
  static const char *const names[] = {
#define PART_STATUS(name, text) #name,
#include "particle/status.def"
#undef PART_STATUS
  };
  return status >= 0 && status < PART_STATUS_COUNT ? names[status] : "unknown status";
}

const char *part_status_text(int status) {
  static const char *const texts[] = {
#define PART_STATUS(name, text) text,
#include "particle/status.def"
#undef PART_STATUS
  };
  return status >= 0 && status < PART_STATUS_COUNT ? texts[status] : "unknown status";
}

const char *part_last_error(void) {
  return message;
}

int part_agree(MPI_Comm comm, int status) {
  struct {
    int status, rank;
  } mine, worst;
  int size = 1;
  if (MPI_Comm_size(comm, &size) != MPI_SUCCESS)
    return part_fail(PART_ERR_MPI, "MPI_Comm_size failed");
  if (size == 1)
    return status;
  mine.status = status;
  MPI_Comm_rank(comm, &mine.rank);
  /* MAXLOC takes the lowest rank among equals, as promised. */
  if (MPI_Allreduce(&mine, &worst, 1, MPI_2INT, MPI_MAXLOC, comm) != MPI_SUCCESS)
    return part_fail(PART_ERR_MPI, "MPI_Allreduce failed");
  if (worst.status == PART_OK)
    return PART_OK;
  char text[MESSAGE_SIZE];
  memcpy(text, message, sizeof text);
  if (MPI_Bcast(text, MESSAGE_SIZE, MPI_CHAR, worst.rank, comm) != MPI_SUCCESS)
    return part_fail(PART_ERR_MPI, "MPI_Bcast failed");
  memcpy(message, text, sizeof message);
  return worst.status;
}
