/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Who owns a place, and what the other files about the domain need of each other. */
#include <stdint.h>

#include "domain.h"
#include "particle/status.h"

int part_domain_agree(const part_domain *domain, int status) {
  return domain->size == 1 ? status : part_agree(domain->comm, status);
}

static int holds(const part_region *part, const double x[3]) {
  return x[0] > part->lo[0] && x[0] <= part->hi[0] && x[1] > part->lo[1] && x[1] <= part->hi[1] &&
         x[2] > part->lo[2] && x[2] <= part->hi[2];
}

int part_domain_owner(const part_domain *domain, const double x[3]) {
  if (holds(&domain->part[domain->rank], x)) /* nearly always */
    return domain->rank;
  for (int r = 0; r < domain->size; r++)
    if (holds(&domain->part[r], x))
      return r;
  return -1;
}

int part_domain_fail_at(const part_store *store, int i, int status, const char *what) {
  const int field = store->layout->id_field;
  const double *x =
      part_record_double(store, 0) + (size_t)i * (size_t)store->layout->records[0].width;
  const int64_t id =
      part_field_int64(store, field)[(size_t)i * (size_t)part_field_stride(store, field)];
  return part_fail(status, "particle %lld at (%.10g %.10g %.10g) %s", (long long)id, x[0], x[1],
                   x[2], what);
}
