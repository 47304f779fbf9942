/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Particles and fluid points are decomposed each on their own: a sphere visits every rank whose points'
 * bounding box it reaches, as itself, as its periodic images and as its images behind plane walls. Visits are
 * received by rank and there in the sender's order, so nothing depends on message timing. */
#include <math.h>
#include "points_type.h"

/* ---- planes --------------------------------------------------------------------------------- */
static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static int check_plane(const part_box *box, int k, const cpl_points_plane *q, double length) {
  if (!(length > 0.0) || !isfinite(length) || !isfinite(q->point[0] + q->point[1] + q->point[2]))
    return part_fail(PART_ERR_RANGE, "coupling: plane %d has the normal (%g %g %g)", k, q->normal[0],
                     q->normal[1], q->normal[2]);
  for (int c = 0; c < 3; c++)
    if (box->periodic[c] && fabs(q->normal[c]) > 1e-9 * length)
      return part_fail(PART_ERR_ARGUMENT,
                       "coupling: plane %d with the normal (%g %g %g) is across the periodic direction %d",
                       k, q->normal[0], q->normal[1], q->normal[2], c);
  return PART_OK;
}

/* The group of planes that this one is parallel to; -1: at right angles to all. */
static int find_group(const cpl_points_t *p, const double normal[3], int k, int *group) {
  for (*group = 0; *group < p->groups; ++*group) {
    const double c = fabs(dot(p->plane[*group][0].normal, normal));
    if (c > 1.0 - 1e-9)
      return PART_OK;
    if (c > 1e-9)
      return part_fail(PART_ERR_ARGUMENT,
                       "coupling: plane %d with the normal (%g %g %g) is neither at right angles to another "
                       "one nor parallel to it",
                       k, normal[0], normal[1], normal[2]);
  }
  return PART_OK;
}

int points_check_planes(cpl_points_t *p, int planes, const cpl_points_plane *plane) {
  for (int k = 0; k < planes; k++) {
    cpl_points_plane q = plane[k];
    const double length = sqrt(dot(q.normal, q.normal));
    int g;
    PART_TRY(check_plane(&p->box, k, &q, length));
    for (int c = 0; c < 3; c++)
      q.normal[c] /= length;
    PART_TRY(find_group(p, q.normal, k, &g));
    if (p->in_group[g] == 2)
      return part_fail(PART_ERR_ARGUMENT, "coupling: plane %d is the third one of its direction", k);
    if (g == p->groups)
      p->groups++;
    p->plane[g][p->in_group[g]++] = q;
  }
  for (int g = 0; g < p->groups; g++)
    if (p->in_group[g] == 2 && dot(p->plane[g][0].normal, p->plane[g][1].normal) > 0.0)
      return part_fail(PART_ERR_ARGUMENT, "coupling: two parallel planes have the fluid on the same side");
  return PART_OK;
}

static double distance(const cpl_points_plane *q, const double x[3]) {
  const double d[3] = {x[0] - q->point[0], x[1] - q->point[1], x[2] - q->point[2]};
  return dot(d, q->normal);
}

/* ---- images --------------------------------------------------------------------------------- */
enum { IMAGES = 1000 };
typedef struct image_list {
  int count;
  double x[IMAGES][3]; /* m */
} image_list;

static int add_image(image_list *list, const double x[3]) {
  if (list->count == IMAGES)
    return part_fail(PART_ERR_RANGE,
                     "coupling: a sphere at (%g %g %g) m has more than %d images: the coupling length is much "
                     "longer than the domain is wide",
                     x[0], x[1], x[2], IMAGES);
  double *to = list->x[list->count++];
  to[0] = x[0];
  to[1] = x[1];
  to[2] = x[2];
  return PART_OK;
}

/* From plane to plane of a group, as long as the image is within reach of the fluid. */
static int mirror_chain(const cpl_points_t *p, image_list *list, int group, int first, const double *from,
                        double reach) {
  double x[3] = {from[0], from[1], from[2]};
  for (int k = first;; k = 1 - k) {
    if (k >= p->in_group[group])
      return PART_OK;
    const cpl_points_plane *q = &p->plane[group][k];
    const double d = distance(q, x);
    if (!(d < reach))
      return PART_OK;
    for (int c = 0; c < 3; c++)
      x[c] -= 2.0 * d * q->normal[c];
    if (d > 0.0)
      PART_TRY(add_image(list, x));
    else
      return PART_OK; /* behind the wall already */
  }
}

static int mirror_images(const cpl_points_t *p, image_list *list, double reach) {
  for (int g = 0; g < p->groups; g++) {
    const int before = list->count;
    for (int k = 0; k < before; k++)
      for (int first = 0; first < p->in_group[g]; first++)
        PART_TRY(mirror_chain(p, list, g, first, list->x[k], reach));
  }
  return PART_OK;
}

static int periodic_images(const cpl_points_t *p, image_list *list) {
  for (int c = 0; c < 3; c++) {
    const int before = list->count;
    const double length = p->box.hi[c] - p->box.lo[c];
    for (int k = 0; k < before && p->box.periodic[c]; k++)
      for (int side = -1; side <= 1; side += 2) {
        double x[3] = {list->x[k][0], list->x[k][1], list->x[k][2]};
        x[c] += side * length;
        PART_TRY(add_image(list, x));
      }
  }
  return PART_OK;
}

static int reaches(const double *bounds, const double x[3], double reach) {
  double d2 = 0.0;
  for (int c = 0; c < 3; c++) {
    const double d = fmax(fmax(bounds[c] - x[c], x[c] - bounds[3 + c]), 0.0);
    d2 += d * d;
  }
  return d2 < reach * reach;
}

static int add_visit(cpl_points_t *p, int particle, int rank, const cpl_points_visit *visit) {
  const size_t k = (size_t)p->sent;
  PART_TRY(CPL_RESERVE(p->particle, k + 1));
  PART_TRY(CPL_RESERVE(p->destination, k + 1));
  PART_TRY(CPL_RESERVE(p->sent_visit, k + 1));
  p->particle.data[k] = particle;
  p->destination.data[k] = rank;
  p->sent_visit.data[k] = *visit;
  p->sent++;
  return PART_OK;
}

static int visit_ranks(cpl_points_t *p, int i, const image_list *list, double radius, double diameter,
                       double reach) {
  for (int k = 0; k < list->count; k++)
    for (int r = 0; r < p->size; r++)
      if (reaches(p->bounds.data + 6 * (size_t)r, list->x[k], reach)) {
        const double *x = list->x[k];
        const cpl_points_visit visit = {{x[0], x[1], x[2]}, radius, diameter};
        PART_TRY(add_visit(p, i, r, &visit));
      }
  return PART_OK;
}

static int check_sphere(const cpl_points_t *p, const double *x, double radius, double reach, int64_t id) {
  if (!isfinite(x[0] + x[1] + x[2]) || !isfinite(radius))
    return part_fail(PART_ERR_NUMERIC, "coupling: particle %lld is at (%g %g %g) m with radius %g m",
                     (long long)id, x[0], x[1], x[2], radius);
  if (radius <= 0.0)
    return part_fail(PART_ERR_RANGE, "coupling: the radius of particle %lld is %g m; it must be > 0",
                     (long long)id, radius);
  for (int c = 0; c < 3; c++)
    if (p->box.periodic[c] && reach > p->box.hi[c] - p->box.lo[c])
      return part_fail(PART_ERR_RANGE,
                       "coupling: particle %lld reaches %g m (its radius and the support of the kernel); the "
                       "periodic direction %d is only %g m long",
                       (long long)id, reach, c, p->box.hi[c] - p->box.lo[c]);
  return PART_OK;
}

int points_make_visits(cpl_points_t *p, const cpl_particles *particles) {
  p->sent = 0;
  image_list *list = malloc(sizeof *list);
  if (!list)
    return part_fail(PART_ERR_MEMORY, "coupling: no memory for images");
  int status = PART_OK;
  for (int i = 0; status == PART_OK && i < particles->count; i++) {
    const double *x = points_at(particles->position, particles->position_stride, i);
    const double radius = *points_at(particles->radius, particles->radius_stride, i);
    const double reach = p->kernel.support + (p->params.porosity == CPL_POINTS_EXACT ? radius : 0.0);
    const double diameter =
        2.0 * (particles->drag_radius
                   ? *points_at(particles->drag_radius, particles->drag_radius_stride, i)
                   : radius);
    status = check_sphere(p, x, radius, reach, p->id.data[i]);
    if (status != PART_OK)
      break;
    double wrapped[3] = {x[0], x[1], x[2]};
    part_box_wrap(&p->box, wrapped, NULL);
    list->count = 0;
    status = add_image(list, wrapped);
    if (status == PART_OK)
      status = mirror_images(p, list, reach);
    if (status == PART_OK)
      status = periodic_images(p, list);
    if (status == PART_OK)
      status = visit_ranks(p, i, list, radius, diameter, reach);
  }
  free(list);
  return status;
}

/* ---- exchange ------------------------------------------------------------------------------- */
enum { USUAL_WIDTH = 9 };

int points_send_visits(cpl_points_t *p) {
  if (p->plan)
    part_exchange_destroy(p->plan);
  p->plan = NULL;
  PART_TRY(part_exchange_create(p->comm, p->sent, p->destination.data, &p->plan));
  p->received = part_exchange_receive_count(p->plan);
  int status = CPL_RESERVE(p->visit, p->received);
  if (status == PART_OK)
    status = CPL_RESERVE(p->send_buffer, (size_t)p->sent * USUAL_WIDTH);
  if (status == PART_OK)
    status = CPL_RESERVE(p->receive_buffer, (size_t)p->received * USUAL_WIDTH);
  PART_TRY(part_agree(p->comm, status));
  return part_exchange_forward(p->plan, sizeof(cpl_points_visit), p->sent_visit.data, p->visit.data);
}

int points_forward(cpl_points_t *p, int n, const double *value, double **received) {
  const size_t width = (size_t)n;
  for (size_t k = 0; k < (size_t)p->sent; k++)
    memcpy(p->send_buffer.data + k * width, value + (size_t)p->particle.data[k] * width,
           width * sizeof *value);
  *received = p->receive_buffer.data;
  return part_exchange_forward(p->plan, width * sizeof *value, p->send_buffer.data,
                               p->receive_buffer.data);
}

int points_back(cpl_points_t *p, int n, double *received, double *value) {
  const size_t width = (size_t)n;
  PART_TRY(part_exchange_reverse(p->plan, width * sizeof *value, received, p->send_buffer.data));
  memset(value, 0, (size_t)p->count * width * sizeof *value);
  for (size_t k = 0; k < (size_t)p->sent; k++)
    for (size_t d = 0; d < width; d++)
      value[(size_t)p->particle.data[k] * width + d] += p->send_buffer.data[k * width + d];
  return PART_OK;
}
