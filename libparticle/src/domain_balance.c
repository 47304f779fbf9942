/* SPDX-License-Identifier: GPL-3.0-or-later */
/* New parts of equal weight: recursive coordinate bisection by Zoltan. Only the cuts are taken from
 * it; who owns a point follows from the cuts alone (domain.h), so that a particle on a cut, or many
 * at one point, have one owner whatever order they come in. */
#include "domain.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <zoltan.h>

#include "particle/status.h"

typedef struct objects {
  const part_store *store;
  const double *home; /* [local][3] places that count; NULL: positions */
  const double *weight;
  uint64_t first; /* number of the first own particle over all ranks */
} objects;

static int object_count(void *data, int *error) {
  *error = ZOLTAN_OK;
  return ((const objects *)data)->store->local;
}

static void object_list(void *data, int gid_entries, int lid_entries, ZOLTAN_ID_PTR gid,
                        ZOLTAN_ID_PTR lid, int weights, float *weight, int *error) {
  const objects *o = (const objects *)data;
  (void)gid_entries;
  (void)lid_entries;
  for (int i = 0; i < o->store->local; i++) {
    /* Two words: numbers go beyond 2^32. */
    gid[2 * i] = (ZOLTAN_ID_TYPE)((o->first + (uint64_t)i) >> 32);
    gid[2 * i + 1] = (ZOLTAN_ID_TYPE)((o->first + (uint64_t)i) & 0xffffffffu);
    lid[i] = (unsigned)i;
    if (weights > 0)
      weight[i] = (float)o->weight[i];
  }
  *error = ZOLTAN_OK;
}

static int object_dimensions(void *data, int *error) {
  (void)data;
  *error = ZOLTAN_OK;
  return 3;
}

static void object_positions(void *data, int gid_entries, int lid_entries, int n, ZOLTAN_ID_PTR gid,
                             ZOLTAN_ID_PTR lid, int dimensions, double *position, int *error) {
  const objects *o = (const objects *)data;
  const double *x = part_record_double(o->store, 0);
  const size_t width = (size_t)o->store->layout->records[0].width;
  (void)gid_entries;
  (void)lid_entries;
  (void)gid;
  for (int k = 0; k < n; k++)
    for (int d = 0; d < dimensions; d++)
      position[k * dimensions + d] = o->home != NULL ? o->home[3 * (size_t)lid[k] + (size_t)d]
                                                     : x[(size_t)lid[k] * width + (size_t)d];
  *error = ZOLTAN_OK;
}

static int set_up(struct Zoltan_Struct *zz, objects *o, int weighted) {
  const char *const params[][2] = {
      {"DEBUG_LEVEL", "0"},
      {"LB_METHOD", "RCB"},
      {"NUM_GID_ENTRIES", "2"},
      {"NUM_LID_ENTRIES", "1"},
      {"OBJ_WEIGHT_DIM", weighted ? "1" : "0"},
      {"RETURN_LISTS", "NONE"}, /* the cuts are all we want */
      {"KEEP_CUTS", "1"},
      {"AVERAGE_CUTS", "1"},           /* between particles, not through one */
      {"RCB_RECTILINEAR_BLOCKS", "1"}, /* particles on a cut are on one side of it */
      {"RCB_OUTPUT_LEVEL", "0"},
  };
  int error = ZOLTAN_OK;
  for (size_t k = 0; k < sizeof params / sizeof params[0]; k++)
    if (error == ZOLTAN_OK)
      error = Zoltan_Set_Param(zz, params[k][0], params[k][1]);
  if (error == ZOLTAN_OK)
    error = Zoltan_Set_Num_Obj_Fn(zz, object_count, o);
  if (error == ZOLTAN_OK)
    error = Zoltan_Set_Obj_List_Fn(zz, object_list, o);
  if (error == ZOLTAN_OK)
    error = Zoltan_Set_Num_Geom_Fn(zz, object_dimensions, o);
  if (error == ZOLTAN_OK)
    error = Zoltan_Set_Geom_Multi_Fn(zz, object_positions, o);
  return error == ZOLTAN_OK ? PART_OK : part_fail(PART_ERR_MPI, "Zoltan refused its set-up");
}

static int take_cuts(part_domain *domain, struct Zoltan_Struct *zz) {
  for (int r = 0; r < domain->size; r++) {
    part_region *p = &domain->part[r];
    int dimensions;
    if (Zoltan_RCB_Box(zz, r, &dimensions, &p->lo[0], &p->lo[1], &p->lo[2], &p->hi[0], &p->hi[1],
                       &p->hi[2]) != ZOLTAN_OK)
      return part_fail(PART_ERR_MPI, "Zoltan has no box for rank %d", r);
    for (int d = 0; d < 3; d++) { /* outer sides come as the largest double */
      if (p->lo[d] <= -DBL_MAX)
        p->lo[d] = -INFINITY;
      if (p->hi[d] >= DBL_MAX)
        p->hi[d] = INFINITY;
    }
  }
  return PART_OK;
}

static int bisect(part_domain *domain, objects *o, int weighted) {
  float version;
  int changes, gids, lids, imports, exports, *ranks[2] = {NULL, NULL}, *parts[2] = {NULL, NULL};
  ZOLTAN_ID_PTR gid[2] = {NULL, NULL}, lid[2] = {NULL, NULL};
  if (Zoltan_Initialize(0, NULL, &version) != ZOLTAN_OK)
    return part_fail(PART_ERR_MPI, "Zoltan does not start");
  struct Zoltan_Struct *zz = Zoltan_Create(domain->comm);
  int status = zz != NULL ? set_up(zz, o, weighted) : part_fail(PART_ERR_MEMORY, "no Zoltan");
  status = part_agree(domain->comm, status);
  if (status == PART_OK &&
      Zoltan_LB_Partition(zz, &changes, &gids, &lids, &imports, &gid[0], &lid[0], &ranks[0],
                          &parts[0], &exports, &gid[1], &lid[1], &ranks[1],
                          &parts[1]) < 0) /* warnings are positive */
    status = part_fail(PART_ERR_MPI, "Zoltan could not bisect");
  if (status == PART_OK)
    status = take_cuts(domain, zz);
  Zoltan_LB_Free_Part(&gid[0], &lid[0], &ranks[0], &parts[0]);
  Zoltan_LB_Free_Part(&gid[1], &lid[1], &ranks[1], &parts[1]);
  Zoltan_Destroy(&zz);
  return part_agree(domain->comm, status);
}

static int check_objects(const part_store *store, const double *home, const double *weight,
                         double *sum) {
  const double *x = part_record_double(store, 0);
  const size_t width = (size_t)store->layout->records[0].width;
  *sum = 0.0;
  for (int i = 0; i < store->local; i++) {
    const double *p = home != NULL ? home + 3 * (size_t)i : x + (size_t)i * width;
    if (!isfinite(p[0] + p[1] + p[2]))
      return part_domain_fail_at(store, i, PART_ERR_OUTSIDE, "is not finite");
    if (weight != NULL && !(weight[i] >= 0.0 && weight[i] < INFINITY))
      return part_domain_fail_at(store, i, PART_ERR_RANGE, "has a weight that is not in [0, inf)");
    *sum += weight != NULL ? weight[i] : 0.0;
  }
  return PART_OK;
}

int part_domain_balance(part_domain *domain, const part_store *store, const double *weight) {
  return part_domain_balance_home(domain, store, NULL, weight);
}

int part_domain_balance_home(part_domain *domain, const part_store *store, const double *home,
                             const double *weight) {
  double sums[2]; /* particles, weight; of this rank, then of all */
  objects o = {store, home, weight, 0};
  PART_TRY(part_domain_agree(domain, check_objects(store, home, weight, &sums[1])));
  if (domain->size == 1)
    return PART_OK;
  uint64_t after = (uint64_t)store->local;
  int has_weight = weight != NULL;
  sums[0] = store->local;
  if (MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, domain->comm) != MPI_SUCCESS ||
      MPI_Allreduce(MPI_IN_PLACE, &has_weight, 1, MPI_INT, MPI_MIN, domain->comm) != MPI_SUCCESS ||
      MPI_Scan(MPI_IN_PLACE, &after, 1, MPI_UINT64_T, MPI_SUM, domain->comm) != MPI_SUCCESS)
    return part_fail(PART_ERR_MPI, "MPI_Allreduce failed");
  if (sums[0] == 0.0)
    return PART_OK; /* nothing to divide: the parts stay */
  o.first = after - (uint64_t)store->local;
  return bisect(domain, &o, has_weight && sums[1] > 0.0);
}
