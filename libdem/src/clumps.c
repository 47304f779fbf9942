/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The clumps of a rank: payload of members, list after each rebuild, inverse effective masses. */
#include "internal.h"
#include "rotation.h"

/* Entries of a member, and those that only the first has; numbers of DEM_KEY_CLUMP. */
enum clump_part {
  PART_ARM,  /* m, in body axes */
  PART_HOME, /* m, centre of mass; the same bits at every member */
  PART_TURN, /* x, y, z of the attitude */
  PART_BODY, /* w of the attitude, mass, light */
  PART_VELOCITY,
  PART_SPIN,
  PART_INERTIA,
  PART_FORCE,
  PART_TORQUE, /* and with part << 8: the number of members */
};
enum { COUNT_SHIFT = 8 };

static dem_entry *put(dem_entry *to, int64_t part, double a, double b, double c) {
  *to = (dem_entry){.key = DEM_KEY(DEM_KEY_CLUMP, part), .value = {a, b, c}};
  return to + 1;
}

dem_entry *dem_clump_put(const dem_clump *b, const double arm[3], int is_first, dem_entry *to) {
  to = put(to, PART_ARM, arm[0], arm[1], arm[2]);
  to = put(to, PART_HOME, b->x[0], b->x[1], b->x[2]);
  if (!is_first)
    return to;
  to = put(to, PART_TURN, b->q[1], b->q[2], b->q[3]);
  to = put(to, PART_BODY, b->q[0], b->mass, b->light);
  to = put(to, PART_VELOCITY, b->v[0], b->v[1], b->v[2]);
  to = put(to, PART_SPIN, b->spin[0], b->spin[1], b->spin[2]);
  to = put(to, PART_INERTIA, b->inertia[0], b->inertia[1], b->inertia[2]);
  to = put(to, PART_FORCE, b->force[0], b->force[1], b->force[2]);
  return put(to, PART_TORQUE | (int64_t)b->count << COUNT_SHIFT, b->torque[0], b->torque[1],
             b->torque[2]);
}

/* One entry into a clump; arm: of the member that it is of. */
static void take(const dem_entry *e, dem_clump *b, double arm[3]) {
  const int64_t number = DEM_KEY_NUMBER(e->key);
  double *const to[] = {arm, b->x, b->q + 1, NULL, b->v, b->spin, b->inertia, b->force, b->torque};
  const int part = (int)(number & ((1 << COUNT_SHIFT) - 1));
  if (part == PART_BODY) {
    b->q[0] = e->value[0];
    b->mass = e->value[1];
    b->light = e->value[2];
  } else if (part <= PART_TORQUE) {
    memcpy(to[part], e->value, sizeof e->value);
  }
  if (part == PART_TORQUE)
    b->count = (int)(number >> COUNT_SHIFT);
}

static int is_clump_entry(const dem_entry *e) {
  return e->key >= 0 && DEM_KEY_KIND(e->key) == DEM_KEY_CLUMP;
}

/* ---- carrier --------------------------------------------------------------------------------- */
static int clumps_active(const dem_t *dem) {
  return dem->plan.clumps;
}

static void count_entries(const dem_t *dem, int *count) {
  const dem_clumps *c = &dem->clumps;
  for (int k = 0; k < c->members; k++)
    count[c->member[k]] += k == c->clump[c->of[k]].first ? DEM_CLUMP_ENTRIES : 2;
}

static dem_entry *put_entries(const dem_t *dem, int i, dem_entry *to) {
  const dem_clumps *c = &dem->clumps;
  const int slot = c->slot != NULL ? c->slot[i] : -1;
  if (slot < 0)
    return to;
  const dem_clump *clump = &c->clump[c->of[slot]];
  return dem_clump_put(clump, c->arm + 3 * (size_t)slot, slot == clump->first, to);
}

const dem_carrier dem_clumps_carrier = {clumps_active, count_entries, put_entries};

int dem_clumps_homes(const dem_t *dem, const int *count, const void *payload, double **homes) {
  const dem_entry *entry = payload;
  const int n = dem->store->local;
  PART_TRY(dem_allocate(3 * (size_t)n, sizeof **homes, homes));
  for (int i = 0; i < n; i++) {
    double *home = *homes + 3 * (size_t)i;
    memcpy(home, dem_xr(dem) + DEM_XR * (size_t)i, 3 * sizeof *home);
    for (int k = 0; k < count[i]; k++, entry++)
      if (entry->key == DEM_KEY(DEM_KEY_CLUMP, PART_HOME))
        memcpy(home, entry->value, 3 * sizeof *home);
  }
  return PART_OK;
}

double dem_clump_light(int n, const dem_entry *entry) {
  for (int k = 0; k < n; k++)
    if (entry[k].key == DEM_KEY(DEM_KEY_CLUMP, PART_BODY))
      return entry[k].value[2];
  return 0.0;
}

/* ---- list ------------------------------------------------------------------------------------ */
void dem_clumps_free(dem_clumps *c) {
  free(c->clump);
  free(c->member);
  free(c->of);
  free(c->arm);
  free(c->slot);
  free(c->turn);
  c->clump = NULL;
  c->member = c->of = c->slot = NULL;
  c->arm = c->turn = NULL;
  c->count = c->members = 0;
}

void dem_clumps_free_seeds(dem_clumps *c) {
  for (int k = 0; k < c->shapes; k++) {
    dem_clump_shape_free(&c->shape[k]);
    free(c->path[k]);
  }
  free(c->shape);
  free(c->path);
  free(c->seed);
  c->shape = NULL;
  c->path = NULL;
  c->seed = NULL;
  c->shapes = 0;
  c->seeds = 0;
}

/* A member before the list is made. */
typedef struct found {
  int64_t number, id;
  int index, entries;
  const dem_entry *entry;
} found;

static int by_number(const void *a, const void *b) {
  const found *x = a, *y = b;
  if (x->number != y->number)
    return x->number < y->number ? -1 : 1;
  return (x->id > y->id) - (x->id < y->id);
}

/* Own members, sorted by clump and id. */
static int find_members(const dem_t *dem, const int *count, const dem_entry *entry, found **made,
                        int *members) {
  const int n = dem->store->local;
  *members = 0;
  for (int i = 0; i < n; i++)
    *members += dem_kind_of(dem, i) == DEM_CLUMP;
  PART_TRY(dem_allocate((size_t)*members, sizeof **made, made));
  found *to = *made;
  for (int i = 0; i < n; i++) {
    if (dem_kind_of(dem, i) == DEM_CLUMP)
      *to++ = (found){dem_meta(dem)[DEM_META * (size_t)i + 2], dem_id(dem, i), i, count[i], entry};
    entry += count[i];
  }
  if (*members > 1)
    qsort(*made, (size_t)*members, sizeof **made, by_number);
  return PART_OK;
}

/* One clump from its members, which are next in the list. */
static int take_clump(dem_t *dem, const found *member, int n) {
  dem_clumps *c = &dem->clumps;
  dem_clump *clump = &c->clump[c->count];
  for (int k = 0; k < n; k++) {
    const int slot = c->members + k;
    dem_clump one = {.count = 0};
    double *arm = c->arm + 3 * (size_t)slot;
    for (int e = 0; e < member[k].entries; e++)
      if (is_clump_entry(&member[k].entry[e]))
        take(&member[k].entry[e], &one, arm);
    if (k == 0)
      *clump = one;
    c->member[slot] = member[k].index;
    c->of[slot] = c->count;
    c->slot[member[k].index] = slot;
  }
  if (clump->count != n || !(clump->mass > 0.0))
    return part_fail(PART_ERR_FORMAT, "clump %lld: %d of its %d spheres are there, with id %lld",
                     (long long)member->number, n, clump->count, (long long)member->id);
  clump->number = member->number;
  clump->first = c->members;
  clump->material = dem_material_of(dem, member->index);
  part_box_wrap(&dem->box, clump->x, NULL); /* as part_domain_migrate_home did */
  c->members += n;
  c->count++;
  return PART_OK;
}

/* As many clumps as there are numbers; at least the room of one. */
static int make_room(dem_t *dem, int members) {
  dem_clumps *c = &dem->clumps;
  const size_t n = (size_t)members, local = (size_t)dem->store->local;
  dem_clumps_free(c);
  PART_TRY(dem_allocate(n, sizeof *c->clump, &c->clump));
  PART_TRY(dem_allocate(n, sizeof *c->member, &c->member));
  PART_TRY(dem_allocate(n, sizeof *c->of, &c->of));
  PART_TRY(dem_allocate(3 * n, sizeof *c->arm, &c->arm));
  PART_TRY(dem_allocate(local, sizeof *c->slot, &c->slot));
  PART_TRY(dem_allocate(6 * (local + (size_t)dem->store->ghost), sizeof *c->turn, &c->turn));
  for (size_t i = 0; i < local; i++)
    c->slot[i] = -1;
  return PART_OK;
}

int dem_clumps_list(dem_t *dem, const int *count, const void *payload) {
  found *member = NULL;
  int members = 0;
  int status = find_members(dem, count, payload, &member, &members);
  if (status == PART_OK)
    status = make_room(dem, members);
  for (int from = 0, to; status == PART_OK && from < members; from = to) {
    for (to = from + 1; to < members && member[to].number == member[from].number;)
      to++;
    status = take_clump(dem, member + from, to - from);
  }
  free(member);
  return status;
}

/* ---- inverse effective masses ---------------------------------------------------------------- */
int dem_clumps_turns(dem_t *dem) {
  dem_clumps *c = &dem->clumps;
  static const int row[6] = {0, 1, 2, 0, 0, 1}, other[6] = {0, 1, 2, 1, 2, 2};
  for (int b = 0; b < c->count; b++) {
    const dem_clump *clump = &c->clump[b];
    double m[3][3], j[6], arm[3];
    dem_turn_matrix(clump->q, m);
    for (int e = 0; e < 6; e++)
      j[e] = m[row[e]][0] * m[other[e]][0] / clump->inertia[0] +
             m[row[e]][1] * m[other[e]][1] / clump->inertia[1] +
             m[row[e]][2] * m[other[e]][2] / clump->inertia[2];
    for (int k = clump->first; k < clump->first + clump->count; k++) {
      dem_to_space((const double(*)[3])m, c->arm + 3 * (size_t)k, arm);
      dem_clump_turn(j, arm, c->turn + 6 * (size_t)c->member[k]);
    }
  }
  return !dem->plan.pairs
             ? PART_OK
             : part_domain_copy_to_ghosts(dem->domain, dem->store, 6 * sizeof *c->turn, c->turn,
                                          c->turn + 6 * (size_t)dem->store->local);
}

double dem_mobility(const dem_t *dem, int i, int j, const double n[3]) {
  const double *vm = dem_vm(dem);
  double w = vm[DEM_VM * (size_t)i + 3] + vm[DEM_VM * (size_t)j + 3];
  if (dem->plan.clumps)
    w += dem_form(dem->clumps.turn + 6 * (size_t)i, n) +
         dem_form(dem->clumps.turn + 6 * (size_t)j, n);
  return w;
}
