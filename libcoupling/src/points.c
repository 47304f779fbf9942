/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Life, locate and porosity of the exchange with fluid points. */
#include "coupling/points.h"
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include "param_rows.h"
#include "points_type.h"

static const char *const forms[] = {"combined", "gradient", "pairwise", NULL};
static const char *const porosities[] = {"exact", "centre", NULL};

static const part_param rows[] = {
#define CPL_STRUCT cpl_points_params
#include "coupling/points_params.def"
#undef CPL_STRUCT
};

const part_param_table cpl_points_table = {"points", (int)(sizeof rows / sizeof *rows), rows};

/* ---- life ----------------------------------------------------------------------------------- */
static int check(const cpl_points_params *params, const cpl_fluid *fluid,
                 const cpl_points_kernel *kernel) {
  PART_TRY(part_params_check(&cpl_points_table, params));
  if (!cpl_drag_function(params->drag))
    return part_fail(PART_ERR_RANGE, "coupling: drag law %d; there are %d", params->drag,
                     cpl_drag_count());
  if (!kernel->value || !isfinite(kernel->support) || kernel->support <= 0.0)
    return part_fail(PART_ERR_RANGE, "coupling: the kernel's support is %g m; it must be > 0",
                     kernel->support);
  if (!isfinite(fluid->density) || fluid->density <= 0.0)
    return part_fail(PART_ERR_RANGE, "coupling: fluid density %g kg/m3; it must be > 0",
                     fluid->density);
  if (!isfinite(fluid->viscosity) || fluid->viscosity <= 0.0)
    return part_fail(PART_ERR_RANGE, "coupling: fluid viscosity %g Pa s; it must be > 0",
                     fluid->viscosity);
  if (!isfinite(fluid->gravity[0] + fluid->gravity[1] + fluid->gravity[2]))
    return part_fail(PART_ERR_NUMERIC, "coupling: gravity (%g %g %g) m/s2 is not finite",
                     fluid->gravity[0], fluid->gravity[1], fluid->gravity[2]);
  if (params->self_disturbance && (params->form != CPL_POINTS_COMBINED || !params->two_way))
    return part_fail(PART_ERR_RANGE, "coupling: selfDisturbance needs form combined and twoWay on");
  if (!isfinite(params->still[0] + params->still[1] + params->still[2]))
    return part_fail(PART_ERR_NUMERIC, "coupling: gravity at rest (%g %g %g) m/s2 is not finite",
                     params->still[0], params->still[1], params->still[2]);
  return PART_OK;
}

static int create_local(cpl_points_t *p, int planes, const cpl_points_plane *plane) {
  static const char *const names[POINTS_STAGES] = {"pairs", "porosity", "fluid force", "reaction"};
  PART_TRY(part_timers_create(&p->timers));
  for (int k = 0; k < POINTS_STAGES; k++)
    PART_TRY(part_timers_stage(p->timers, names[k], &p->stage[k]));
  PART_TRY(CPL_RESERVE(p->bounds, 6 * (size_t)p->size));
  PART_TRY(points_wake_make(p));
  if (p->params.form == CPL_POINTS_PAIRWISE && planes > 0)
    return part_fail(PART_ERR_ARGUMENT, "coupling: form pairwise has no planes at which spheres are mirrored: a force "
                                        "between a point and an image would be none on the sphere");
  return points_check_planes(p, planes, plane);
}

int cpl_points_create(MPI_Comm comm, const part_box *box, const cpl_points_params *params,
                      const cpl_fluid *fluid, const cpl_points_kernel *kernel, int planes,
                      const cpl_points_plane *plane, cpl_points_t **points) {
  PART_TRY(part_agree(comm, check(params, fluid, kernel)));
  cpl_points_t *p = calloc(1, sizeof *p);
  PART_TRY(part_agree(
      comm, p ? PART_OK : part_fail(PART_ERR_MEMORY, "coupling: no memory for the coupling")));
  p->comm = MPI_COMM_NULL;
  p->box = *box;
  p->params = *params;
  p->fluid = *fluid;
  p->kernel = *kernel;
  p->located = 0;
  p->force_count = -1;
  int status = MPI_Comm_dup(comm, &p->comm) == MPI_SUCCESS
                   ? PART_OK
                   : part_fail(PART_ERR_MPI, "coupling: MPI_Comm_dup failed");
  MPI_Comm_size(comm, &p->size);
  MPI_Comm_rank(comm, &p->rank);
  if (status == PART_OK)
    status = create_local(p, planes, plane);
  status = part_agree(comm, status);
  if (status != PART_OK) {
    cpl_points_destroy(p);
    return status;
  }
  *points = p;
  return PART_OK;
}

void cpl_points_destroy(cpl_points_t *p) {
  if (!p)
    return;
  if (p->plan)
    part_exchange_destroy(p->plan);
  part_timers_destroy(p->timers);
  CPL_FREE(p->table.value);
  CPL_FREE(p->id);
  CPL_FREE(p->volume);
  CPL_FREE(p->particle);
  CPL_FREE(p->destination);
  CPL_FREE(p->sent_visit);
  CPL_FREE(p->visit);
  CPL_FREE(p->bounds);
  CPL_FREE(p->send_buffer);
  CPL_FREE(p->receive_buffer);
  CPL_FREE(p->order);
  CPL_FREE(p->place);
  CPL_FREE(p->start);
  CPL_FREE(p->partner);
  CPL_FREE(p->weight);
  CPL_FREE(p->bin_start);
  CPL_FREE(p->bin_of);
  CPL_FREE(p->solid);
  CPL_FREE(p->by_size);
  CPL_FREE(p->eps);
  CPL_FREE(p->share);
  CPL_FREE(p->sum);
  CPL_FREE(p->sampled_eps);
  CPL_FREE(p->velocity);
  CPL_FREE(p->wet);
  CPL_FREE(p->work);
  CPL_FREE(p->work2);
  CPL_FREE(p->id_work);
  CPL_FREE(p->wake);
  CPL_FREE(p->pressure);
  CPL_FREE(p->paired);
  CPL_FREE(p->carried);
  CPL_FREE(p->place_at);
  if (p->comm != MPI_COMM_NULL)
    MPI_Comm_free(&p->comm);
  free(p);
}

part_timers *cpl_points_timers(cpl_points_t *p) {
  return p->timers;
}

/* ---- locate --------------------------------------------------------------------------------- */
/* Radii of all ranks; a new table when it does not hold them. */
static int make_table(cpl_points_t *p, const cpl_particles *particles) {
  double range[2] = {-HUGE_VAL, -HUGE_VAL}; /* -least, most */
  for (int i = 0; i < particles->count; i++) {
    const double r = *points_at(particles->radius, particles->radius_stride, i);
    range[0] = fmax(range[0], -r);
    range[1] = fmax(range[1], r);
  }
  if (MPI_Allreduce(MPI_IN_PLACE, range, 2, MPI_DOUBLE, MPI_MAX, p->comm) != MPI_SUCCESS)
    return part_fail(PART_ERR_MPI, "coupling: a maximum over ranks failed");
  if (!isfinite(range[1]) || !(range[0] < 0.0))
    return PART_OK; /* no particles, or an error that each rank will tell */
  const int exact = p->params.porosity == CPL_POINTS_EXACT;
  p->reach = p->kernel.support + (exact ? range[1] : 0.0);
  if (p->table.rows > 0 && -range[0] >= p->table.least && range[1] <= p->table.most)
    return PART_OK;
  return part_agree(p->comm, points_table_make(&p->table, &p->kernel, -range[0], range[1], exact));
}

static int find_bounds(cpl_points_t *p, const cpl_fluid_points *fluid) {
  double own[6] = {HUGE_VAL, HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  int status = PART_OK;
  for (int a = 0; a < fluid->count; a++) {
    const double *x = points_at(fluid->position, fluid->position_stride, a);
    if (!isfinite(x[0] + x[1] + x[2]) && status == PART_OK)
      status = part_fail(PART_ERR_NUMERIC, "coupling: fluid point %d is at (%g %g %g) m", a, x[0],
                         x[1], x[2]);
    for (int c = 0; c < 3; c++) {
      own[c] = fmin(own[c], x[c]);
      own[3 + c] = fmax(own[3 + c], x[c]);
    }
  }
  PART_TRY(part_agree(p->comm, status));
  if (MPI_Allgather(own, 6, MPI_DOUBLE, p->bounds.data, 6, MPI_DOUBLE, p->comm) != MPI_SUCCESS)
    return part_fail(PART_ERR_MPI, "coupling: the bounds of the ranks could not be gathered");
  return PART_OK;
}

static int remember_particles(cpl_points_t *p, const cpl_particles *particles) {
  PART_TRY(CPL_RESERVE(p->id, particles->count));
  PART_TRY(CPL_RESERVE(p->volume, particles->count));
  p->count = particles->count;
  for (int i = 0; i < p->count; i++) {
    const double r = *points_at(particles->radius, particles->radius_stride, i);
    p->id.data[i] = particles->id[(size_t)i * (size_t)particles->id_stride];
    p->volume.data[i] = points_sphere_volume(r);
  }
  return PART_OK;
}

static int locate(cpl_points_t *p, const cpl_particles *particles, const cpl_fluid_points *fluid) {
  p->located = 0;
  PART_TRY(part_agree(p->comm, remember_particles(p, particles)));
  p->points = fluid->count;
  PART_TRY(make_table(p, particles));
  PART_TRY(find_bounds(p, fluid));
  PART_TRY(part_agree(p->comm, points_make_visits(p, particles)));
  PART_TRY(points_send_visits(p));
  PART_TRY(part_agree(p->comm, points_make_pairs(p, fluid)));
  if (p->params.form == CPL_POINTS_PAIRWISE) {
    PART_TRY(part_agree(p->comm, CPL_RESERVE(p->place_at, 3 * (size_t)p->points)));
    for (int a = 0; a < p->points; a++)
      memcpy(p->place_at.data + 3 * (size_t)a, points_at(fluid->position, fluid->position_stride, a),
             3 * sizeof(double));
  }
  p->located = 1;
  return PART_OK;
}

int cpl_points_locate(cpl_points_t *p, const cpl_particles *particles,
                      const cpl_fluid_points *fluid) {
  part_timers_start(p->timers, p->stage[POINTS_LOCATE]);
  const int status = locate(p, particles, fluid);
  part_timers_stop(p->timers, p->stage[POINTS_LOCATE]);
  return status;
}

/* ---- porosity ------------------------------------------------------------------------------- */
static int low_eps(const cpl_points_t *p, const double *x, double eps) {
  return part_fail(
      PART_ERR_RANGE,
      "coupling: the porosity at (%g %g %g) m is %g, below minimumEps %g: particles overlap, or "
      "the coupling length is too short",
      x[0], x[1], x[2], eps, p->params.minimum_eps);
}

static int porosity(cpl_points_t *p, cpl_fluid_points *fluid) {
  PART_TRY(CPL_RESERVE(p->eps, p->points));
  for (int a = 0; a < p->points; a++) {
    const double *x = points_at(fluid->position, fluid->position_stride, a);
    const double solid = p->solid.data[a];
    const double eps = solid > 0.0 ? 1.0 - solid / points_inside(p, x) : 1.0;
    if (!(eps >= p->params.minimum_eps))
      return low_eps(p, x, eps);
    p->eps.data[a] = eps;
    if (p->params.two_way)
      fluid->eps[(size_t)a * (size_t)fluid->eps_stride] = eps;
  }
  if (p->params.two_way && fluid->eps_gradient)
    points_eps_gradient(p, fluid);
  return PART_OK;
}

int cpl_points_porosity(cpl_points_t *p, cpl_fluid_points *fluid) {
  part_timers_start(p->timers, p->stage[POINTS_POROSITY]);
  int status = PART_OK;
  if (!p->located || fluid->count != p->points)
    status = part_fail(PART_ERR_STATE, "cpl_points_porosity: call cpl_points_locate first");
  else if (p->params.two_way && !fluid->eps && fluid->count > 0)
    status = part_fail(PART_ERR_ARGUMENT, "cpl_points_porosity: eps of the points is NULL");
  else
    status = porosity(p, fluid);
  status = part_agree(p->comm, status);
  part_timers_stop(p->timers, p->stage[POINTS_POROSITY]);
  if (status == PART_OK)
    p->located = 2;
  return status;
}

long long cpl_points_pairs(const cpl_points_t *p) {
  return p->located ? (long long)p->start.data[p->received] : 0;
}

double cpl_points_sphere_kernel(const cpl_points_t *p, double s, double radius) {
  double share;
  if (p->table.rows == 0 || s * s >= p->table.end2)
    return 0.0;
  const double *row = points_table_row(&p->table, radius, &share);
  return points_table_at(row, share, s * s * p->table.per_s2);
}
