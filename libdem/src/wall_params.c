/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Entries of a wall: those that its type needs, none that it does not have, and what a periodic box
 * allows. */
#include "internal.h"

enum { PLANE = 1 << DEM_WALL_PLANE, CYLINDER = 1 << DEM_WALL_CYLINDER, STL = 1 << DEM_WALL_STL };

/* Entries that not every type has. */
static const struct belongs {
  const char *entry;
  int types;
} belongs[] = {
    {"point", PLANE | CYLINDER},
    {"normal", PLANE},
    {"axis", CYLINDER},
    {"radius", CYLINDER},
    {"side", CYLINDER},
    {"length", CYLINDER},
    {"file", STL},
    {"scale", STL},
    {"open", STL},
};

static int given(const part_param *row, const dem_wall_params *params) {
  const unsigned char *at = (const unsigned char *)params + row->offset;
  double numbers[3] = {0.0, 0.0, 0.0};
  int number = 0;
  switch (row->type) {
  case PART_PARAM_WORD:
    return *at != '\0';
  case PART_PARAM_CHOICE:
  case PART_PARAM_BOOL:
    memcpy(&number, at, sizeof number);
    return number != (int)row->def[0];
  default:
    memcpy(numbers, at, sizeof(double) * (row->type == PART_PARAM_VECTOR ? 3 : 1));
    return numbers[0] != row->def[0] ||
           numbers[1] != row->def[1] * (row->type == PART_PARAM_VECTOR) ||
           numbers[2] != row->def[2] * (row->type == PART_PARAM_VECTOR);
  }
}

static int check_type(const dem_wall_params *params) {
  const part_param *type = part_params_find(&dem_wall_table, "type");
  for (size_t k = 0; k < sizeof belongs / sizeof belongs[0]; k++)
    if (!(belongs[k].types >> params->type & 1) &&
        given(part_params_find(&dem_wall_table, belongs[k].entry), params))
      return part_fail(PART_ERR_ARGUMENT, "entry %s does not belong to type %s", belongs[k].entry,
                       type->choices[params->type]);
  return PART_OK;
}

/* To unit length; 0 stays. Returns the length. */
static double unit(double v[3]) {
  const double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  for (int c = 0; c < 3 && length > 0.0; c++)
    v[c] /= length;
  return length;
}

static int direction(double v[3], int needed, const char *entry, const char *why) {
  const double length = unit(v);
  if (needed && !(length > 0.0 && isfinite(length)))
    return part_fail(PART_ERR_RANGE, "entry %s: a vector that is not zero is needed for %s", entry,
                     why);
  return PART_OK;
}

static int check_shape(dem_wall_params *p) {
  PART_TRY(direction(p->normal, p->type == DEM_WALL_PLANE, "normal", "a plane"));
  PART_TRY(direction(p->axis, p->type == DEM_WALL_CYLINDER, "axis", "a cylinder"));
  if (p->type == DEM_WALL_CYLINDER && !(p->radius > 0.0))
    return part_fail(PART_ERR_RANGE, "entry radius: %g m is not allowed; must be positive",
                     p->radius);
  if (p->type == DEM_WALL_STL && p->file[0] == '\0')
    return part_fail(PART_ERR_ARGUMENT, "entry file is missing (path of an STL file)");
  return PART_OK;
}

part_motion dem_wall_motion(const dem_wall_params *p) {
  return PART_MOTION_OF(p);
}

static int check_motion(dem_wall_params *p) {
  part_motion m = dem_wall_motion(p);
  PART_TRY(part_motion_check(&m));
  memcpy(p->rotation_axis, m.rotation_axis, sizeof m.rotation_axis);
  memcpy(p->oscillation_direction, m.oscillation_direction, sizeof m.oscillation_direction);
  return PART_OK;
}

static int is_infinite_cylinder(const dem_wall_params *p) {
  return p->type == DEM_WALL_CYLINDER && p->length == 0.0;
}

/* Sine of the angle of two unit vectors. */
static double sine(const double a[3], const double b[3]) {
  double n[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  return sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

static int check_rotation(const part_box *box, const dem_wall_params *p) {
  static const double small = 1e-9;
  if (p->rotation_rate == 0.0)
    return PART_OK;
  if (p->type == DEM_WALL_PLANE && sine(p->rotation_axis, p->normal) > small)
    return part_fail(
        PART_ERR_RANGE,
        "entry rotationAxis: a plane has no end, so it can turn only about its normal");
  if (is_infinite_cylinder(p) && sine(p->rotation_axis, p->axis) > small)
    return part_fail(PART_ERR_RANGE, "entry rotationAxis: a cylinder without length has no end, so "
                                     "it can turn only about the direction of its axis");
  for (int c = 0; c < 3; c++) {
    const double along[3] = {c == 0, c == 1, c == 2};
    if (box->periodic[c] && sine(p->rotation_axis, along) > small)
      return part_fail(PART_ERR_RANGE,
                       "entry rotationAxis: the domain is periodic in %c, so a wall can turn only "
                       "about an axis along %c",
                       "xyz"[c], "xyz"[c]);
  }
  return PART_OK;
}

/* What has no end, or has particles inside, must go on through a periodic border as it is. */
static int check_periodic(const part_box *box, const dem_wall_params *p) {
  for (int c = 0; c < 3; c++) {
    const double along[3] = {c == 0, c == 1, c == 2};
    if (!box->periodic[c])
      continue;
    if (p->type == DEM_WALL_PLANE && fabs(p->normal[c]) > 1e-12)
      return part_fail(PART_ERR_RANGE,
                       "its normal has a component along %c, in which the domain is periodic",
                       "xyz"[c]);
    if (p->type != DEM_WALL_CYLINDER)
      continue;
    const double off = sine(p->axis, along);
    const int across = p->side == DEM_WALL_OUTSIDE && fabs(p->axis[c]) <= 1e-12;
    if (off > 1e-12 && !across && (p->side == DEM_WALL_INSIDE || p->length == 0.0))
      return part_fail(PART_ERR_RANGE,
                       "entry axis: the domain is periodic in %c, so the axis must be along %c%s",
                       "xyz"[c], "xyz"[c],
                       p -> side == DEM_WALL_OUTSIDE ? " or at right angles to it" : "");
  }
  return PART_OK;
}

/* With dimensions 2 walls stand on the plane of the particles and move in it. */
static int check_flat(const dem_wall_params *p) {
  const double *turns = p->rotation_axis;
  if (p->type == DEM_WALL_PLANE && p->normal[2] != 0.0)
    return part_fail(PART_ERR_RANGE, "its normal has a z component; with dimensions 2 walls stand "
                                     "on the plane of the particles");
  if (p->type == DEM_WALL_CYLINDER && (p->axis[0] != 0.0 || p->axis[1] != 0.0 || p->length > 0.0))
    return part_fail(PART_ERR_RANGE, "entry axis: with dimensions 2 a cylinder is along z, without "
                                     "length");
  if (p->rotation_rate != 0.0 && (turns[0] != 0.0 || turns[1] != 0.0))
    return part_fail(PART_ERR_RANGE, "entry rotationAxis: with dimensions 2 walls turn about z");
  if (p->velocity[2] != 0.0 ||
      (p->oscillation_amplitude > 0.0 && p->oscillation_direction[2] != 0.0))
    return part_fail(PART_ERR_RANGE, "entry %s: with dimensions 2 walls do not move along z",
                     p->velocity[2] != 0.0 ? "velocity" : "oscillationDirection");
  return PART_OK;
}

int dem_wall_check(const dem_t *dem, dem_wall_params *params) {
  PART_TRY(part_params_check(&dem_wall_table, params));
  PART_TRY(check_type(params));
  PART_TRY(check_shape(params));
  PART_TRY(check_motion(params));
  PART_TRY(check_rotation(&dem->box, params));
  if (dem->shape.flat)
    PART_TRY(check_flat(params));
  return check_periodic(&dem->box, params);
}
