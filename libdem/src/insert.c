/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Insertion: lattice, and the checks that hold for every method. Until dem_start every rank knows
 * every particle, so that the result does not depend on the number of ranks. */
#include "internal.h"

static void turn(const double axis[3], double angle, double d[3]) {
  /* Rodrigues' rotation of d about the unit vector axis. */
  const double c = cos(angle), s = sin(angle);
  const double along = (axis[0] * d[0] + axis[1] * d[1] + axis[2] * d[2]) * (1.0 - c);
  const double cross[3] = {axis[1] * d[2] - axis[2] * d[1], axis[2] * d[0] - axis[0] * d[2],
                           axis[0] * d[1] - axis[1] * d[0]};
  for (int k = 0; k < 3; k++)
    d[k] = c * d[k] + s * cross[k] + along * axis[k];
}

static int lattice_check(const dem_insert *insert, double axis[3]) {
  const char *table = dem_insert_table.name;
  const double *a = insert->rotation_axis;
  const double length = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
  if (!(insert->diameter > 0.0))
    return part_fail(PART_ERR_RANGE, "%s: entry diameter: %g m is not allowed; must be positive",
                     table, insert->diameter);
  for (int c = 0; c < 3; c++) {
    if (insert->count[c] != floor(insert->count[c]))
      return part_fail(PART_ERR_RANGE, "%s: entry count: %g is not a whole number", table,
                       insert->count[c]);
    if (insert->count[c] > 1.0 && !(insert->spacing[c] > 0.0))
      return part_fail(PART_ERR_RANGE,
                       "%s: entry spacing: %g m is not allowed; must be positive where count is "
                       "above 1",
                       table, insert->spacing[c]);
  }
  if (insert->count[0] * insert->count[1] * insert->count[2] < 1.0)
    return part_fail(PART_ERR_RANGE, "%s: entry count: zero particles requested", table);
  if (insert->rotation_angle != 0.0 && !(length > 0.0))
    return part_fail(PART_ERR_RANGE, "%s: entry rotationAxis: must not be zero with rotationAngle",
                     table);
  for (int c = 0; c < 3; c++)
    axis[c] = length > 0.0 ? a[c] / length : 0.0;
  return PART_OK;
}

int dem_insert_lattice(const dem_insert *insert, dem_seed **seed, int64_t *count) {
  double axis[3];
  size_t n = 0;
  PART_TRY(lattice_check(insert, axis));
  PART_TRY(dem_allocate((size_t)(insert->count[0] * insert->count[1] * insert->count[2]),
                        sizeof **seed, seed));
  for (double k = 0; k < insert->count[2]; k++)
    for (double j = 0; j < insert->count[1]; j++)
      for (double i = 0; i < insert->count[0]; i++) {
        double d[3] = {i * insert->spacing[0], j * insert->spacing[1], k * insert->spacing[2]};
        if (insert->rotation_angle != 0.0)
          turn(axis, insert->rotation_angle, d);
        for (int c = 0; c < 3; c++) {
          (*seed)[n].x[c] = insert->origin[c] + d[c];
          (*seed)[n].v[c] = insert->velocity[c];
        }
        (*seed)[n++].r = 0.5 * insert->diameter;
      }
  *count = (int64_t)n;
  return PART_OK;
}

static int check_plane(const dem_t *dem, const dem_seed *seed, int64_t id) {
  if (seed->x[2] != dem->shape.plane)
    return part_fail(PART_ERR_RANGE,
                     "particle %lld at (%g %g %g) m: z differs by %g m from that of the first "
                     "particle; with dimensions 2 all centres have the same z",
                     (long long)id, seed->x[0], seed->x[1], seed->x[2],
                     seed->x[2] - dem->shape.plane);
  if (seed->v[2] != 0.0)
    return part_fail(PART_ERR_RANGE,
                     "particle %lld: velocity %g m/s along z; must be 0 with dimensions 2",
                     (long long)id, seed->v[2]);
  if (seed->w[0] != 0.0 || seed->w[1] != 0.0)
    return part_fail(PART_ERR_RANGE,
                     "particle %lld: angular velocity (%g %g %g) rad/s; must be about z with "
                     "dimensions 2",
                     (long long)id, seed->w[0], seed->w[1], seed->w[2]);
  return PART_OK;
}

/* One particle by itself: a size, a place in the box, room in the domain. Members of a clump may be
 * over a periodic border. */
static int check_seed(const dem_t *dem, const dem_seed *seed, int64_t id) {
  const part_box *box = &dem->box;
  if (!(seed->r > 0.0) || !isfinite(seed->r))
    return part_fail(PART_ERR_RANGE,
                     "particle %lld: diameter %g m is not allowed; must be positive", (long long)id,
                     2.0 * seed->r);
  for (int c = 0; c < 3; c++) {
    if (!isfinite(seed->x[c]) || !isfinite(seed->v[c]))
      return part_fail(PART_ERR_NUMERIC, "particle %lld: position or velocity is not finite",
                       (long long)id);
    if (2.0 * seed->r > box->hi[c] - box->lo[c] && !(c == 2 && dem->shape.flat))
      return part_fail(PART_ERR_RANGE,
                       "particle %lld: diameter %g m is larger than the domain (%g m in %c)",
                       (long long)id, 2.0 * seed->r, box->hi[c] - box->lo[c], "xyz"[c]);
    if (seed->kind == DEM_CLUMP && box->periodic[c])
      continue;
    if (seed->x[c] < box->lo[c] || seed->x[c] > box->hi[c])
      return part_fail(PART_ERR_OUTSIDE,
                       "particle %lld at (%g %g %g) m is outside the domain (%g %g %g) to "
                       "(%g %g %g) m",
                       (long long)id, seed->x[0], seed->x[1], seed->x[2], box->lo[0], box->lo[1],
                       box->lo[2], box->hi[0], box->hi[1], box->hi[2]);
  }
  return dem->shape.flat ? check_plane(dem, seed, id) : PART_OK;
}

/* One past the last seed of the body that begins at k. */
static int64_t end_of_body(const dem_seed *seed, int64_t count, int64_t k) {
  int64_t end = k + 1;
  while (seed[k].kind == DEM_CLUMP && end < count && seed[end].kind == DEM_CLUMP &&
         seed[end].block == seed[k].block)
    end++;
  return end;
}

static int check_one(const dem_t *dem, const dem_grid *grid, const dem_seed *seed, int64_t id) {
  double overlap = 0.0;
  const int64_t other = dem_grid_overlap(grid, seed->x, seed->r, dem->params.max_overlap, &overlap);
  if (other < 0)
    return PART_OK;
  return part_fail(PART_ERR_OVERLAP,
                   "particles %lld and %lld overlap by %g m at (%g %g %g) m; allowed is "
                   "maxOverlap = %g of the smaller radius",
                   (long long)(dem->params.first_id + other), (long long)id, overlap, seed->x[0], seed->x[1], seed->x[2],
                   dem->params.max_overlap);
}

/* New particles against each other and against those that are there, but not against others of the
 * same clump. */
static int check_overlap(const dem_t *dem, const dem_seed *seed, int64_t count) {
  dem_grid *grid;
  int status = PART_OK;
  double r_min = HUGE_VAL, r_max = 0.0;
  for (int64_t k = 0; k < dem->seeds + count; k++) {
    const double r = k < dem->seeds ? dem->seed[k].r : seed[k - dem->seeds].r;
    r_min = r < r_min ? r : r_min;
    r_max = r > r_max ? r : r_max;
  }
  PART_TRY(dem_grid_create(&dem->box, r_min, r_max, dem->seeds + count, &grid));
  for (int64_t k = 0; k < dem->seeds && status == PART_OK; k++)
    status = dem_grid_add(grid, dem->seed[k].x, dem->seed[k].r);
  for (int64_t k = 0, end; k < count && status == PART_OK; k = end) {
    end = end_of_body(seed, count, k);
    for (int64_t m = k; m < end && status == PART_OK; m++)
      status = check_one(dem, grid, &seed[m], dem->params.first_id + dem->seeds + m);
    for (int64_t m = k; m < end && status == PART_OK; m++)
      status = dem_grid_add(grid, seed[m].x, seed[m].r);
  }
  dem_grid_destroy(grid);
  return status;
}

static int check_insert(const dem_t *dem, const dem_insert *insert, int block) {
  const double *v = insert->velocity, *w = insert->angular_velocity;
  if (dem->started || dem->restored)
    return part_fail(PART_ERR_STATE, "dem_insert_particles comes before dem_start, and not after "
                                     "dem_read");
  if (part_params_check(&dem_insert_table, insert) != PART_OK)
    return PART_ERR_RANGE;
  if (insert->kind == DEM_BLOCK && (block < 0 || block >= 1000000))
    return part_fail(PART_ERR_RANGE, "%s: block number %d is not allowed; 0 to 999999",
                     dem_insert_table.name, block);
  if ((insert->kind == DEM_FIXED || insert->kind == DEM_BLOCK) &&
      (w[0] != 0.0 || w[1] != 0.0 || w[2] != 0.0))
    return part_fail(PART_ERR_RANGE,
                     "%s: entry angularVelocity: must be zero for fixed particles and blocks",
                     dem_insert_table.name);
  if (insert->kind == DEM_CLUMP && dem->shape.flat)
    return part_fail(PART_ERR_RANGE, "%s: entry kind: clump is not allowed with dimensions 2",
                     dem_insert_table.name);
  if ((insert->kind == DEM_CLUMP) != (insert->shape[0] != '\0'))
    return part_fail(PART_ERR_RANGE, "%s: entry shape: must be given for kind clump, and only then",
                     dem_insert_table.name);
  if (insert->kind == DEM_FIXED && (v[0] != 0.0 || v[1] != 0.0 || v[2] != 0.0))
    return part_fail(PART_ERR_RANGE, "%s: entry velocity: must be zero for fixed particles",
                     dem_insert_table.name);
  return PART_OK;
}

static int generate(const dem_t *dem, const dem_insert *insert, dem_seed **seed, double **turn,
                    int64_t *count) {
  switch (insert->method) {
  case DEM_INSERT_LATTICE:
    return dem_insert_lattice(insert, seed, count);
  case DEM_INSERT_RANDOM:
    return dem_insert_random(dem, insert, seed, count);
  default:
    return dem_insert_file(dem, insert, seed, turn, count);
  }
}

static int accept(dem_t *dem, const dem_insert *insert, int block, int material, dem_seed *seed,
                  int64_t count) {
  if (dem->seeds == 0)
    dem->shape.plane = seed[0].x[2];
  for (int64_t k = 0; k < count; k++) {
    seed[k].material = material;
    seed[k].kind = insert->kind;
    if (insert->kind != DEM_CLUMP) /* numbered by dem_clumps_expand */
      seed[k].block = insert->kind == DEM_BLOCK ? block : -1;
    PART_TRY(check_seed(dem, &seed[k], dem->params.first_id + dem->seeds + k));
  }
  PART_TRY(check_overlap(dem, seed, count));
  PART_TRY(
      dem_grow((size_t)(dem->seeds + count), sizeof *dem->seed, &dem->seed_capacity, &dem->seed));
  memcpy(&dem->seed[dem->seeds], seed, (size_t)count * sizeof *seed);
  dem->seeds += count;
  if (insert->kind == DEM_CLUMP)
    dem->clumps.seeds = seed[count - 1].block + 1;
  return PART_OK;
}

/* Places of clumps, with their bounding spheres, and from them the member spheres. */
static int generate_clumps(dem_t *dem, const dem_insert *insert, dem_seed **seed, int64_t *count) {
  const double pi = 3.14159265358979323846;
  dem_insert bounds = *insert;
  dem_seed *place = NULL;
  double *turn = NULL;
  int64_t n = 0;
  int shape;
  PART_TRY(dem_clumps_shape(dem, insert->shape, &shape));
  const dem_clump_shape *s = &dem->clumps.shape[shape];
  const double equal = cbrt(6.0 / pi * s->volume), per_diameter = 2.0 * s->bound / equal;
  const int from_file = insert->method == DEM_INSERT_FILE;
  bounds.diameter = (insert->diameter > 0.0 ? insert->diameter : equal) * per_diameter;
  bounds.diameter_max = insert->diameter_max * per_diameter;
  int status = generate(dem, &bounds, &place, &turn, &n);
  for (int64_t k = 0; status == PART_OK && k < n; k++) {
    if (from_file)
      place[k].r = (place[k].r > 0.0 ? place[k].r : 0.5 * equal) * per_diameter;
    memcpy(place[k].w, insert->angular_velocity, sizeof place[k].w);
  }
  if (status == PART_OK)
    status = dem_clumps_expand(dem, insert, shape, n, place, turn, seed, count);
  free(place);
  free(turn);
  return status;
}

static int generate_spheres(const dem_t *dem, const dem_insert *insert, dem_seed **seed,
                            int64_t *count) {
  double *turn = NULL;
  PART_TRY(generate(dem, insert, seed, &turn, count));
  for (int64_t k = 0; k < *count; k++)
    memcpy((*seed)[k].w, insert->angular_velocity, sizeof(*seed)[k].w);
  return PART_OK;
}

int dem_insert_particles(dem_t *dem, const dem_insert *insert, int block, int64_t *inserted) {
  dem_seed *seed = NULL;
  int64_t count = 0;
  int material = 0;
  PART_TRY(check_insert(dem, insert, block));
  PART_TRY(dem_find_material(dem, insert->material, &material));
  int status = insert->kind == DEM_CLUMP ? generate_clumps(dem, insert, &seed, &count)
                                         : generate_spheres(dem, insert, &seed, &count);
  if (status == PART_OK)
    status = accept(dem, insert, block, material, seed, count);
  free(seed);
  if (inserted != NULL)
    *inserted = status == PART_OK ? count : 0;
  return part_agree(dem->comm, status);
}
