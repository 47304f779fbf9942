/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Life of a domain, its parts, and the parts as bytes. */
#include "domain.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "memory.h"
#include "particle/status.h"

static int check_box(const part_box *box) {
  for (int d = 0; d < 3; d++)
    if (!(box->hi[d] > box->lo[d]) || !isfinite(box->hi[d] - box->lo[d]))
      return part_fail(PART_ERR_RANGE, "box from %g to %g m in direction %c: need finite lo < hi",
                       box->lo[d], box->hi[d], "xyz"[d]);
  return PART_OK;
}

int part_domain_create(MPI_Comm comm, const part_box *box, part_domain **domain) {
  part_domain *made = NULL;
  int size = 1;
  *domain = NULL;
  if (MPI_Comm_size(comm, &size) != MPI_SUCCESS)
    return part_fail(PART_ERR_MPI, "MPI_Comm_size failed");
  int status = check_box(box);
  if (status == PART_OK)
    status = part_allocate(1, sizeof *made, &made);
  if (status == PART_OK) {
    made->comm = MPI_COMM_NULL;
    made->size = size;
    made->box = *box;
    status = part_allocate((size_t)size, sizeof *made->part, &made->part);
  }
  status = part_agree(comm, status);
  if (status == PART_OK && (MPI_Comm_dup(comm, &made->comm) != MPI_SUCCESS ||
                            MPI_Comm_rank(comm, &made->rank) != MPI_SUCCESS))
    status = part_fail(PART_ERR_MPI, "MPI_Comm_dup failed");
  if (status != PART_OK) {
    part_domain_destroy(made);
    return status;
  }
  for (int d = 0; d < 3; d++) {
    made->part[0].lo[d] = -INFINITY;
    made->part[0].hi[d] = INFINITY;
  }
  *domain = made;
  return PART_OK;
}

void part_domain_destroy(part_domain *domain) {
  if (domain == NULL)
    return;
  part_ghost_plan_free(&domain->ghosts);
  if (domain->comm != MPI_COMM_NULL)
    MPI_Comm_free(&domain->comm);
  free(domain->part);
  free(domain);
}

MPI_Comm part_domain_comm(const part_domain *domain) {
  return domain->comm;
}
const part_box *part_domain_box(const part_domain *domain) {
  return &domain->box;
}

int part_domain_imbalance(const part_domain *domain, const part_store *store, double *ratio) {
  long long largest = store->local, sum = store->local;
  if (domain->size > 1 &&
      (MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_LONG_LONG, MPI_MAX, domain->comm) !=
           MPI_SUCCESS ||
       MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_LONG_LONG, MPI_SUM, domain->comm) != MPI_SUCCESS))
    return part_fail(PART_ERR_MPI, "MPI_Allreduce failed");
  *ratio = sum > 0 ? (double)largest * domain->size / (double)sum : 1.0;
  return PART_OK;
}

/* The decomposition as bytes: a mark, the number of ranks, this rank's part. */
typedef struct saved_part {
  char mark[8];
  int64_t size;
  part_region part;
} saved_part;

static const char MARK[8] = {'p', 'a', 'r', 't', 'R', 'C', 'B', '1'};

int part_domain_save(part_domain *domain, size_t *size, unsigned char **bytes) {
  saved_part saved;
  *size = 0;
  *bytes = NULL;
  PART_TRY(part_allocate(1, sizeof saved, bytes));
  memcpy(saved.mark, MARK, sizeof MARK);
  saved.size = domain->size;
  saved.part = domain->part[domain->rank];
  memcpy(*bytes, &saved, sizeof saved);
  *size = sizeof saved;
  return PART_OK;
}

static int check_saved(const part_domain *domain, size_t size, const unsigned char *bytes,
                       saved_part *saved) {
  if (size != sizeof *saved)
    return part_fail(PART_ERR_FORMAT, "a saved decomposition has %zu bytes, not %zu", sizeof *saved,
                     size);
  memcpy(saved, bytes, sizeof *saved);
  if (memcmp(saved->mark, MARK, sizeof MARK) != 0)
    return part_fail(PART_ERR_FORMAT, "not a saved decomposition");
  if (saved->size != domain->size)
    return part_fail(PART_ERR_FORMAT, "the decomposition is for %lld ranks, here are %d",
                     (long long)saved->size, domain->size);
  return PART_OK;
}

int part_domain_load(part_domain *domain, size_t size, const unsigned char *bytes) {
  saved_part saved = {.size = 0};
  PART_TRY(part_domain_agree(domain, check_saved(domain, size, bytes, &saved)));
  if (domain->size == 1)
    domain->part[0] = saved.part;
  else if (MPI_Allgather(&saved.part, sizeof saved.part, MPI_BYTE, domain->part, sizeof saved.part,
                         MPI_BYTE, domain->comm) != MPI_SUCCESS)
    return part_fail(PART_ERR_MPI, "MPI_Allgather failed");
  return PART_OK;
}
