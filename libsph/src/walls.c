/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Walls as they are given. */
#include "internal.h"

static double length_of(const double a[3]) {
  return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

static const char *model_name(const sph_wall_params *p) {
  static const char *const names[] = {
#define SPH_WALL_POINTS(name, key, meaning) key,
#define SPH_WALL_PUSH(name, key, meaning) key,
#include "sph/wall_models.def"
#undef SPH_WALL_POINTS
#undef SPH_WALL_PUSH
  };
  return names[p->model];
}

static int check_plane(const sph_t *sph, const sph_wall_params *p, double n[3]) {
  const double length = length_of(p->normal);
  if (!(length > 0.0))
    return part_fail(PART_ERR_RANGE, "entry normal must be given and not zero with type plane");
  for (int c = 0; c < 3; c++) {
    n[c] = p->normal[c] / length;
    if (sph->box.periodic[c] && n[c] != 0.0)
      return part_fail(
          PART_ERR_RANGE,
          "entry normal: its component %d must be 0, because the domain is periodic in "
          "that direction",
          c);
  }
  if (sph->params.dimensions == 2 && n[2] != 0.0)
    return part_fail(PART_ERR_RANGE, "entry normal: its z component must be 0 with dimensions 2");
  return PART_OK;
}

static int check_triangles(const sph_wall_params *p, int count, const double *vertices) {
  if (count <= 0 || vertices == NULL)
    return part_fail(PART_ERR_ARGUMENT, "type triangles needs triangles");
  if (length_of(p->normal) > 0.0 || length_of(p->point) > 0.0)
    return part_fail(PART_ERR_RANGE, "entries point and normal belong to type plane");
  for (int k = 0; k < 9 * count; k++)
    if (!isfinite(vertices[k]))
      return part_fail(PART_ERR_NUMERIC, "triangle %d is not finite", k / 9);
  return PART_OK;
}

static int refuse(const sph_wall_params *p, const char *entry, const char *why) {
  return part_fail(PART_ERR_RANGE, "entry %s: %s with model %s", entry, why, model_name(p));
}

/* What the models have no use for is an error. */
static int check_model(const sph_t *sph, const sph_wall_params *p) {
  const int points = p->model == SPH_WALL_ghost || p->model == SPH_WALL_fixed;
  if (!points && p->slip != SPH_FREE_SLIP)
    return refuse(p, "slip", "must be freeSlip, because the wall acts along its normal alone,");
  if (p->model == SPH_WALL_fixed && p->slip != SPH_NO_SLIP)
    return refuse(p, "slip", "must be noSlip, because the points are at rest,");
  if (p->model != SPH_WALL_ghost && sph->params.density_scheme == SPH_SUMMATION)
    return part_fail(
        PART_ERR_RANGE,
        "entry model: with densityScheme summation it must be ghostPoints, whose share of "
        "the kernel is known");
  if (p->model != SPH_WALL_fixed && p->layers > 0)
    return refuse(p, "layers", "is not allowed");
  if (p->model == SPH_WALL_spring && !(p->stiffness > 0.0))
    return refuse(p, "stiffness", "must be given and positive");
  if (p->model != SPH_WALL_spring && p->stiffness > 0.0)
    return refuse(p, "stiffness", "is not allowed");
  if (p->model != SPH_WALL_spring && p->restitution != 1.0)
    return refuse(p, "restitution", "is not allowed");
  const sph_wall *first = sph->walls.wall;
  if (sph->walls.count > 0 && first->params.model != p->model)
    return part_fail(
        PART_ERR_RANGE,
        "entry model: differs from that of wall %s; all walls of a scene have one model",
        first->name);
  return PART_OK;
}

static int set_triangle(const double *v, int number, sph_face *face) {
  double p[3], q[3];
  memcpy(face->a, v, sizeof face->a);
  memcpy(face->b, v + 3, sizeof face->b);
  memcpy(face->c, v + 6, sizeof face->c);
  for (int c = 0; c < 3; c++) {
    p[c] = face->b[c] - face->a[c];
    q[c] = face->c[c] - face->a[c];
  }
  const double n[3] = {p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2],
                       p[0] * q[1] - p[1] * q[0]};
  const double area = length_of(n);
  if (!(area > 1e-14 * (length_of(p) * length_of(p) + length_of(q) * length_of(q))))
    return part_fail(PART_ERR_RANGE, "triangle %d has no area", number);
  for (int c = 0; c < 3; c++)
    face->n[c] = n[c] / area;
  return PART_OK;
}

static int add_faces(sph_t *sph, const sph_wall_params *p, const double n[3], int count,
                     const double *vertices) {
  sph_walls *walls = &sph->walls;
  const int more = p->type == SPH_PLANE ? 1 : count,
            at = p->type == SPH_PLANE ? walls->planes : walls->faces;
  sph_face *face = realloc(walls->face, (size_t)(walls->faces + more) * sizeof *face);
  if (face == NULL)
    return part_fail(PART_ERR_MEMORY, "no memory for %d faces", walls->faces + more);
  walls->face = face;
  memmove(face + at + more, face + at, (size_t)(walls->faces - at) * sizeof *face);
  for (int k = 0; k < more; k++) {
    face[at + k] = (sph_face){.wall = walls->count, .type = p->type};
    if (p->type == SPH_TRIANGLES) {
      PART_TRY(set_triangle(vertices + 9 * (size_t)k, k, &face[at + k]));
    } else {
      memcpy(face[at].a, p->point, sizeof face[at].a);
      memcpy(face[at].n, n, sizeof face[at].n);
    }
  }
  walls->planes += p->type == SPH_PLANE;
  walls->faces += more;
  return PART_OK;
}

static int add_wall(sph_t *sph, const char *name, const sph_wall_params *given, int count,
                    const double *vertices) {
  sph_walls *walls = &sph->walls;
  sph_wall_params own = *given, *params = &own;
  double n[3] = {0.0, 0.0, 0.0};
  PART_TRY(part_params_check(&sph_wall_table, params));
  PART_TRY(params->type == SPH_PLANE ? check_plane(sph, params, n)
                                     : check_triangles(params, count, vertices));
  PART_TRY(check_model(sph, params));
  PART_TRY(sph_wall_check_motion(sph, params));
  if (params->type == SPH_PLANE && count > 0)
    return part_fail(PART_ERR_ARGUMENT, "type plane has no triangles");
  sph_wall *wall = realloc(walls->wall, ((size_t)walls->count + 1) * sizeof *wall);
  if (wall == NULL)
    return part_fail(PART_ERR_MEMORY, "no memory for %d walls", walls->count + 1);
  walls->wall = wall;
  memset(&wall[walls->count], 0, sizeof *wall);
  strcpy(wall[walls->count].name, name);
  wall[walls->count].params = *params;
  const int faces = walls->faces, planes = walls->planes;
  const int status = add_faces(sph, params, n, count, vertices);
  if (status != PART_OK) {
    walls->faces = faces;
    walls->planes = planes;
    return status;
  }
  walls->count++;
  return PART_OK;
}

int sph_add_wall(sph_t *sph, const char *name, const sph_wall_params *params, int count,
                 const double *vertices) {
  if (sph->started)
    return part_fail(PART_ERR_STATE, "sph_add_wall comes before sph_start");
  if (strlen(name) == 0 || strlen(name) >= PART_PARAM_WORD_LENGTH)
    return part_fail(PART_ERR_ARGUMENT, "a wall needs a name of 1 to %d characters",
                     PART_PARAM_WORD_LENGTH - 1);
  for (int w = 0; w < sph->walls.count; w++)
    if (strcmp(sph->walls.wall[w].name, name) == 0)
      return part_fail(PART_ERR_ARGUMENT, "wall %s is given twice", name);
  const int status = add_wall(sph, name, params, count, vertices);
  return status == PART_OK ? PART_OK : part_fail_context(status, "wall %s", name);
}

double sph_wall_distance(const sph_t *sph, const double x[3]) {
  double distance = HUGE_VAL;
  const sph_walls *walls = &sph->walls;
  for (int f = 0; f < walls->faces; f++) {
    double one;
    sph_faces_nearest(walls, 1, &f, x, &one);
    distance = fabs(one) < fabs(distance) ? one : distance;
  }
  return distance;
}

double sph_wall_gamma(const sph_t *sph, const double x[3]) {
  return sph_kernel_gamma(sph->params.kernel, (int)sph->params.dimensions,
                          sph_wall_distance(sph, x) / sph->params.smoothing_length);
}
