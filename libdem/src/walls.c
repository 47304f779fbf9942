/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Walls as they are given. */
#include "internal.h"

void dem_walls_free(dem_walls *walls) {
  free(walls->wall);
  free(walls->element);
  for (int g = 0; g < walls->groups; g++) {
    free(walls->bins[g].start);
    free(walls->bins[g].item);
  }
  free(walls->bins);
  free(walls->particle);
  free(walls->start);
  free(walls->near);
  free(walls->scratch);
  free(walls->facet);
  free(walls->checked);
}

static int check_name(const dem_t *dem, const char *name) {
  const dem_walls *walls = &dem->walls;
  if (dem->started)
    return part_fail(PART_ERR_STATE, "walls are added before dem_start");
  if (name == NULL || name[0] == '\0' || strlen(name) >= sizeof walls->wall->name)
    return part_fail(PART_ERR_ARGUMENT, "a wall needs a name of 1 to 255 characters");
  for (int w = 0; w < walls->count; w++)
    if (strcmp(walls->wall[w].name, name) == 0)
      return part_fail(PART_ERR_ARGUMENT, "wall %s is given twice", name);
  return PART_OK;
}

/* Corners and unit normal; ERR_RANGE for a triangle without area. */
static int set_triangle(dem_element *e, int k, const double *v) {
  double ab[3], ac[3], longest = 0.0;
  memcpy(e->a, v, sizeof e->a);
  memcpy(e->b, v + 3, sizeof e->b);
  memcpy(e->c, v + 6, sizeof e->c);
  for (int c = 0; c < 3; c++) {
    ab[c] = e->b[c] - e->a[c];
    ac[c] = e->c[c] - e->a[c];
    longest = fmax(longest, fmax(fabs(ab[c]), fabs(ac[c])));
  }
  const double n[3] = {ab[1] * ac[2] - ab[2] * ac[1], ab[2] * ac[0] - ab[0] * ac[2],
                       ab[0] * ac[1] - ab[1] * ac[0]};
  const double area = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  if (!(area > 1e-12 * longest * longest) || !isfinite(area))
    return part_fail(PART_ERR_RANGE, "triangle %d at (%g %g %g) m has no area or is not finite", k,
                     v[0], v[1], v[2]);
  for (int c = 0; c < 3; c++)
    e->n[c] = n[c] / area;
  return PART_OK;
}

/* By corners. Files then do not depend on the order in which triangles are given, which a
 * decomposition of the mesh changes. */
static int by_corners(const void *p, const void *q) {
  const dem_element *e = p, *f = q;
  const double *const x[3] = {e->a, e->b, e->c}, *const y[3] = {f->a, f->b, f->c};
  for (int k = 0; k < 3; k++)
    for (int c = 0; c < 3; c++)
      if (x[k][c] != y[k][c])
        return x[k][c] < y[k][c] ? -1 : 1;
  return (e->given > f->given) - (e->given < f->given);
}

/* In two dimensions: triangles parallel to the plane only bound the depth and are left out; others
 * must be at right angles to it. Single precision of STL files is allowed for. */
static int stand_up(dem_element *e, int *count) {
  int kept = 0;
  for (int k = 0; k < *count; k++) {
    if (fabs(e[k].n[2]) > 1.0 - 1e-6)
      continue;
    if (fabs(e[k].n[2]) > 1e-5)
      return part_fail(PART_ERR_RANGE,
                       "triangle %d at (%g %g %g) m is inclined to the plane of the particles; "
                       "with dimensions 2 walls stand on it",
                       k, e[k].a[0], e[k].a[1], e[k].a[2]);
    e[kept++] = e[k];
  }
  *count = kept;
  if (kept == 0)
    return part_fail(PART_ERR_RANGE,
                     "no triangle stands on the plane of the particles (dimensions 2)");
  return PART_OK;
}

/* *count: those that are left. */
static int set_triangles(const dem_t *dem, dem_element *element, int *count,
                         const double *vertices) {
  if (*count < 1)
    return part_fail(PART_ERR_RANGE, "it has no triangles");
  for (int k = 0; k < *count; k++) {
    element[k].shape = DEM_SHAPE_TRIANGLE;
    element[k].given = k;
    PART_TRY(set_triangle(&element[k], k, vertices + 9 * (size_t)k));
  }
  if (dem->shape.flat)
    PART_TRY(stand_up(element, count));
  qsort(element, (size_t)*count, sizeof *element, by_corners);
  return PART_OK;
}

static void set_one(dem_element *e, const dem_wall_params *p) {
  const int plane = p->type == DEM_WALL_PLANE;
  e->shape = plane ? DEM_SHAPE_PLANE : DEM_SHAPE_CYLINDER;
  memcpy(e->a, p->point, sizeof e->a);
  memcpy(e->n, plane ? p->normal : p->axis, sizeof e->n);
  e->radius = p->radius;
  e->length = p->length;
  e->side = p->side;
}

/* Elements and wall at the end of the lists; they count only when all is well. */
static int append(dem_t *dem, const char *name, int material, const dem_wall_params *params,
                  int count, const double *vertices) {
  dem_walls *walls = &dem->walls;
  const int triangles = params->type == DEM_WALL_TRIANGLES || params->type == DEM_WALL_STL;
  size_t n = triangles && count > 0 ? (size_t)count : 1;
  PART_TRY(dem_grow((size_t)walls->count + 1, sizeof *walls->wall, &walls->capacity, &walls->wall));
  PART_TRY(dem_grow(walls->elements + n, sizeof *walls->element, &walls->element_capacity,
                    &walls->element));
  if (walls->elements + n > INT32_MAX / DEM_SHIFTS)
    return part_fail(PART_ERR_RANGE, "there are more than %d wall elements",
                     INT32_MAX / DEM_SHIFTS);
  dem_wall *wall = &walls->wall[walls->count];
  dem_element *element = &walls->element[walls->elements];
  memset(wall, 0, sizeof *wall);
  memset(element, 0, n * sizeof *element);
  strcpy(wall->name, name);
  wall->material = material;
  wall->first = (int)walls->elements;
  wall->params = *params;
  wall->given = (int)n;
  if (triangles)
    PART_TRY(set_triangles(dem, element, &count, vertices));
  else
    set_one(element, params);
  n = triangles ? (size_t)count : 1;
  wall->count = (int)n;
  for (size_t k = 0; k < n; k++) {
    element[k].wall = walls->count;
    element[k].material = material;
  }
  dem_wall_prepare(wall, element);
  walls->moving |= wall->moves;
  walls->elements += n;
  walls->count++;
  return PART_OK;
}

/* Rank 0 reads and tells the others. */
static int read_stl(const dem_t *dem, const dem_wall_params *params, int *count,
                    double **vertices) {
  int status = PART_OK;
  *vertices = NULL;
  *count = 0;
  if (dem->rank == 0)
    status = dem_stl_read(params->file, params->scale, count, vertices);
  PART_TRY(part_agree(dem->comm, status));
  MPI_Bcast(count, 1, MPI_INT, 0, dem->comm);
  if (dem->rank > 0)
    status = dem_allocate(9 * (size_t)*count, sizeof **vertices, vertices);
  PART_TRY(part_agree(dem->comm, status));
  return MPI_Bcast(*vertices, 9 * *count, MPI_DOUBLE, 0, dem->comm) == MPI_SUCCESS
             ? PART_OK
             : part_fail(PART_ERR_MPI, "triangles could not be sent to all ranks");
}

static int add_stl(dem_t *dem, const char *name, int material, const dem_wall_params *params) {
  double *vertices = NULL;
  int count = 0, status = read_stl(dem, params, &count, &vertices);
  /* First a triangle without area: it would leave the surface open, too. */
  dem_element e;
  for (int k = 0; k < count && status == PART_OK; k++) {
    status = set_triangle(&e, k, vertices + 9 * (size_t)k);
    if (status != PART_OK)
      status = part_fail_context(status, "STL file %s", params->file);
  }
  if (status == PART_OK && !params->open)
    status = dem_stl_closed(params->file, count, vertices);
  if (status == PART_OK)
    status = append(dem, name, material, params, count, vertices);
  free(vertices);
  return status;
}

static int add_checked(dem_t *dem, const char *name, int material, dem_wall_params *params,
                       int count, const double *vertices) {
  if (params->type == DEM_WALL_STL)
    return add_stl(dem, name, material, params);
  return append(dem, name, material, params, count, vertices);
}

int dem_add_wall(dem_t *dem, const char *name, const dem_wall_params *given, int count,
                 const double *vertices) {
  dem_wall_params params = *given;
  int material = 0;
  int status = check_name(dem, name);
  if (status == PART_OK) {
    status = dem_wall_check(dem, &params);
    if (status == PART_OK)
      status = dem_find_material(dem, params.material, &material);
    if (status != PART_OK)
      status = part_fail_context(status, "wall %s", name);
  }
  PART_TRY(part_agree(dem->comm, status));
  status = add_checked(dem, name, material, &params, count, vertices);
  if (status != PART_OK)
    status = part_fail_context(status, "wall %s", name);
  return part_agree(dem->comm, status);
}

static int add_still(dem_t *dem, const char *name, int material, dem_wall_params *params, int count,
                     const double *vertices) {
  PART_TRY(check_name(dem, name));
  if (material < 0 || material >= dem->materials)
    return part_fail(PART_ERR_RANGE, "wall %s: material %d is not one of 0 to %d", name, material,
                     dem->materials - 1);
  strcpy(params->material, dem->material[material].name);
  int status = dem_wall_check(dem, params);
  if (status == PART_OK)
    status = append(dem, name, material, params, count, vertices);
  return status == PART_OK ? status : part_fail_context(status, "wall %s", name);
}

int dem_add_plane(dem_t *dem, const char *name, int material, const double point[3],
                  const double normal[3]) {
  dem_wall_params params;
  part_params_default(&dem_wall_table, &params);
  params.type = DEM_WALL_PLANE;
  memcpy(params.point, point, sizeof params.point);
  memcpy(params.normal, normal, sizeof params.normal);
  return add_still(dem, name, material, &params, 0, NULL);
}

int dem_add_triangles(dem_t *dem, const char *name, int material, int count,
                      const double *vertices) {
  dem_wall_params params;
  part_params_default(&dem_wall_table, &params);
  params.type = DEM_WALL_TRIANGLES;
  return add_still(dem, name, material, &params, count, vertices);
}

int dem_wall_count(const dem_t *dem) {
  return dem->walls.count;
}

int dem_find_wall(const dem_t *dem, const char *name, int *number) {
  const dem_walls *walls = &dem->walls;
  const char **names = NULL;
  for (int w = 0; w < walls->count; w++)
    if (strcmp(walls->wall[w].name, name) == 0) {
      *number = w;
      return PART_OK;
    }
  PART_TRY(dem_allocate((size_t)walls->count, sizeof *names, &names));
  for (int w = 0; w < walls->count; w++)
    names[w] = walls->wall[w].name;
  const char *near = part_nearest_name(name, walls->count, names);
  const int status = part_fail(PART_ERR_ARGUMENT, "there is no wall '%s'%s%s%s", name,
                               near != NULL ? "; did you mean '" : "", near != NULL ? near : "",
                               near != NULL ? "'?" : "");
  free(names);
  return status;
}
