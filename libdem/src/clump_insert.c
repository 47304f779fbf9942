/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Clumps at insertion: places become bodies with an attitude, bodies become member spheres, and
 * after dem_start their state becomes the first payload. */
#include "internal.h"
#include "rotation.h"

int dem_clumps_shape(dem_t *dem, const char *path, int *number) {
  dem_clumps *c = &dem->clumps;
  for (int k = 0; k < c->shapes; k++)
    if (strcmp(c->path[k], path) == 0) {
      *number = k;
      return PART_OK;
    }
  dem_clump_shape shape;
  PART_TRY(dem_clump_shape_read(dem, path, &shape));
  const size_t n = (size_t)c->shapes + 1;
  dem_clump_shape *shapes = realloc(c->shape, n * sizeof *shapes);
  if (shapes != NULL)
    c->shape = shapes;
  char **paths = realloc(c->path, n * sizeof *paths);
  if (paths != NULL)
    c->path = paths;
  char *copy = malloc(strlen(path) + 1);
  if (shapes == NULL || paths == NULL || copy == NULL) {
    dem_clump_shape_free(&shape);
    free(copy);
    return part_agree(dem->comm, part_fail(PART_ERR_MEMORY, "no memory for shape %s", path));
  }
  strcpy(copy, path);
  c->shape[c->shapes] = shape;
  c->path[c->shapes] = copy;
  *number = c->shapes++;
  return part_agree(dem->comm, PART_OK);
}

/* Uniform over all attitudes (Shoemake 1992), the k-th of a seed whatever else was drawn. */
static void random_turn(int64_t seed, int64_t k, double q[4]) {
  const double pi = 3.14159265358979323846;
  uint64_t state = (uint64_t)seed * UINT64_C(0xd1342543de82ef95) + (uint64_t)k * 4096 + 1;
  dem_draw(&state);
  const double u = dem_draw(&state), a = 2.0 * pi * dem_draw(&state),
               b = 2.0 * pi * dem_draw(&state);
  const double turn[4] = {sqrt(1.0 - u) * sin(a), sqrt(1.0 - u) * cos(a), sqrt(u) * sin(b),
                          sqrt(u) * cos(b)};
  memcpy(q, turn, sizeof turn);
}

static int check_place(const dem_t *dem, const dem_seed *place, int64_t number) {
  const part_box *box = &dem->box;
  for (int c = 0; c < 3; c++) {
    const double length = box->hi[c] - box->lo[c];
    if (!isfinite(place->x[c]) || !isfinite(place->v[c]))
      return part_fail(PART_ERR_NUMERIC, "clump %lld: position or velocity is not finite",
                       (long long)number);
    if (place->x[c] < box->lo[c] || place->x[c] > box->hi[c])
      return part_fail(PART_ERR_OUTSIDE,
                       "clump %lld at (%g %g %g) m is outside the domain (%g %g %g) to (%g %g %g) "
                       "m",
                       (long long)number, place->x[0], place->x[1], place->x[2], box->lo[0],
                       box->lo[1], box->lo[2], box->hi[0], box->hi[1], box->hi[2]);
    /* Ghosts over a periodic border are found up to a quarter of its length outside. */
    if (box->periodic[c] && 4.0 * place->r > length)
      return part_fail(PART_ERR_RANGE,
                       "clump %lld reaches %g m from its centre of mass; that may be a quarter of "
                       "the periodic length in %c, %g m, at most",
                       (long long)number, place->r, "xyz"[c], length);
  }
  return PART_OK;
}

/* Members of one clump as seeds. */
static void expand(const dem_clump_shape *shape, const dem_clump_seed *clump, int number,
                   const dem_seed *place, dem_seed *member) {
  double m[3][3], arm[3], wa[3];
  dem_turn_matrix(clump->q, m);
  for (int k = 0; k < shape->spheres; k++, member++) {
    const double *s = shape->sphere + 4 * (size_t)k;
    *member = *place;
    dem_to_space((const double(*)[3])m, s, arm);
    for (int c = 0; c < 3; c++)
      arm[c] *= clump->scale;
    dem_cross(clump->w, arm, wa);
    for (int c = 0; c < 3; c++) {
      member->x[c] = clump->x[c] + arm[c];
      member->v[c] = clump->v[c] + wa[c];
    }
    member->r = clump->scale * s[3];
    member->block = number;
  }
}

int dem_clumps_expand(dem_t *dem, const dem_insert *insert, int shape_number, int64_t n,
                      const dem_seed *place, const double *turn, dem_seed **seed, int64_t *count) {
  dem_clumps *c = &dem->clumps;
  const dem_clump_shape *shape = &c->shape[shape_number];
  if (c->seeds + n > INT32_MAX)
    return part_fail(PART_ERR_RANGE, "%lld clumps are more than %d", (long long)(c->seeds + n),
                     INT32_MAX);
  PART_TRY(dem_grow((size_t)(c->seeds + n), sizeof *c->seed, &c->seed_capacity, &c->seed));
  PART_TRY(dem_allocate((size_t)n * (size_t)shape->spheres, sizeof **seed, seed));
  for (int64_t k = 0; k < n; k++) {
    dem_clump_seed *clump = &c->seed[c->seeds + k];
    double attitude[4] = {1.0, 0.0, 0.0, 0.0};
    PART_TRY(check_place(dem, &place[k], c->seeds + k));
    memset(clump, 0, sizeof *clump);
    clump->first = dem->seeds + k * shape->spheres;
    clump->shape = shape_number;
    clump->scale = place[k].r / shape->bound;
    memcpy(clump->x, place[k].x, sizeof clump->x);
    memcpy(clump->v, place[k].v, sizeof clump->v);
    memcpy(clump->w, place[k].w, sizeof clump->w);
    if (turn != NULL && dem_dot(turn + 4 * k + 1, turn + 4 * k + 1) + turn[4 * k] * turn[4 * k] > 0)
      memcpy(attitude, turn + 4 * k, sizeof attitude);
    else if (insert->orientation == DEM_ORIENTATION_RANDOM)
      random_turn(insert->seed, k, attitude);
    dem_turn_product(attitude, shape->axes, clump->q);
    dem_turn_normalise(clump->q);
    expand(shape, clump, (int)(c->seeds + k), &place[k], *seed + k * shape->spheres);
  }
  *count = n * shape->spheres;
  return PART_OK;
}

/* State of a clump from how it was inserted. */
static void first_state(const dem_t *dem, int64_t number, int material, dem_clump *clump) {
  const dem_clump_seed *from = &dem->clumps.seed[number];
  const dem_clump_shape *shape = &dem->clumps.shape[from->shape];
  const double density = dem->material[material].density, s = from->scale, s3 = s * s * s;
  double m[3][3], w[3], spin[3];
  memset(clump, 0, sizeof *clump);
  clump->number = number;
  clump->count = shape->spheres;
  clump->mass = density * shape->volume * s3;
  clump->light = shape->light / (density * s3);
  memcpy(clump->x, from->x, sizeof clump->x);
  memcpy(clump->q, from->q, sizeof clump->q);
  memcpy(clump->v, from->v, sizeof clump->v);
  dem_turn_matrix(from->q, m);
  dem_to_body((const double(*)[3])m, from->w, w);
  for (int c = 0; c < 3; c++) {
    clump->inertia[c] = density * shape->inertia[c] * s3 * s * s;
    spin[c] = clump->inertia[c] * w[c];
  }
  dem_to_space((const double(*)[3])m, spin, clump->spin);
}

/* What a member knows of its clump: the mass to move, and its own share of it by volume. */
static void set_member(dem_t *dem, int i, const dem_clump *clump, const dem_clump_shape *shape,
                       int part) {
  double *v = dem_vm(dem) + DEM_VM * (size_t)i, volume = 0.0;
  for (int k = 0; k < shape->spheres; k++)
    volume += pow(shape->sphere[4 * k + 3], 3);
  v[3] = 1.0 / clump->mass;
  dem_fluid(dem)[DEM_FLUID * (size_t)i + 7] =
      volume / (clump->mass * pow(shape->sphere[4 * part + 3], 3));
}

int dem_clumps_populate(dem_t *dem, int64_t first) {
  size_t used = 0, capacity = 0;
  const dem_clumps *c = &dem->clumps;
  dem_entry *entry = NULL;
  if (c->seeds == 0)
    return PART_OK;
  PART_TRY(dem_allocate((size_t)dem->store->local, sizeof *dem->kept_count, &dem->kept_count));
  PART_TRY(dem_grow(1, sizeof *entry, &capacity, &entry));
  dem->kept = entry;
  for (int i = 0; i < dem->store->local; i++) {
    if (dem_kind_of(dem, i) != DEM_CLUMP)
      continue;
    dem_clump clump;
    double arm[3];
    const int number = dem_block_of(dem, i);
    const dem_clump_shape *shape = &c->shape[c->seed[number].shape];
    const int part = (int)(first + i - c->seed[number].first);
    first_state(dem, number, dem_material_of(dem, i), &clump);
    set_member(dem, i, &clump, shape, part);
    for (int d = 0; d < 3; d++)
      arm[d] = c->seed[number].scale * shape->sphere[4 * part + d];
    PART_TRY(dem_grow(used + DEM_CLUMP_ENTRIES, sizeof *entry, &capacity, &entry));
    dem->kept = entry;
    const dem_entry *end = dem_clump_put(&clump, arm, part == 0, entry + used);
    dem->kept_count[i] = (int)(end - (entry + used));
    used = (size_t)(end - entry);
  }
  return PART_OK;
}
