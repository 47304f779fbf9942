/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Life, locate, void fraction and the plan. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "coupling_type.h"
#include "exchange.h"
#include "sphere.h"

/* ---- life ----------------------------------------------------------------------------------- */
static int check_fluid(const cpl_fluid *fluid) {
  if (!isfinite(fluid->density) || fluid->density <= 0.0)
    return part_fail(PART_ERR_RANGE, "coupling: fluid density %g kg/m3; it must be > 0",
                     fluid->density);
  if (!isfinite(fluid->viscosity) || fluid->viscosity <= 0.0)
    return part_fail(PART_ERR_RANGE, "coupling: fluid viscosity %g Pa s; it must be > 0",
                     fluid->viscosity);
  for (int k = 0; k < 3; k++)
    if (!isfinite(fluid->gravity[k]))
      return part_fail(PART_ERR_NUMERIC, "coupling: gravity (%g %g %g) m/s2 is not finite",
                       fluid->gravity[0], fluid->gravity[1], fluid->gravity[2]);
  return PART_OK;
}

static int check(const cpl_mesh *mesh, const cpl_params *params, const cpl_fluid *fluid) {
  PART_TRY(part_params_check(&cpl_params_table, params));
  if (params->model == CPL_MODEL_B && params->viscous_stress)
    return part_fail(PART_ERR_ARGUMENT,
                     "coupling: viscousStress is on with model B, whose drag contains that force: "
                     "it would count twice; use model A or viscousStress off");
  if (params->model == CPL_MODEL_BFULL && !params->pressure_gradient)
    return part_fail(PART_ERR_ARGUMENT,
                     "coupling: pressureGradient is off with model Bfull, whose exchange contains "
                     "that force; use pressureGradient on, or model A or B");
  if (params->self_disturbance && !(params->smoothing && params->two_way))
    return part_fail(PART_ERR_ARGUMENT,
                     "coupling: selfDisturbance is on, but %s: its formula is that of the smooth "
                     "kernel of two-way coupling; use smoothing diffusion and twoWay on, or "
                     "selfDisturbance off",
                     params->two_way ? "smoothing is off" : "twoWay is off");
  if (params->virtual_mass && params->model == CPL_MODEL_B)
    return part_fail(
        PART_ERR_ARGUMENT,
        "coupling: virtualMass is on with model B, whose drag takes the pressure gradient "
        "for that of a steady uniform flow; use model A or Bfull, or virtualMass off");
  PART_TRY(check_fluid(fluid));
  for (int c = 0; c < mesh->cells; c++)
    if (!(isfinite(mesh->volume[c]) && mesh->volume[c] > 0.0))
      return part_fail(PART_ERR_RANGE, "coupling: cell %d has the volume %g m3; it must be > 0", c,
                       mesh->volume[c]);
  return PART_OK;
}

static int create_local(cpl_t *cpl) {
  static const char *const names[CPL_STAGES] = {"locate",      "void fraction",   "sample fluid",
                                                "fluid force", "momentum source", "reaction"};
  PART_TRY(part_timers_create(&cpl->timers));
  for (int k = 0; k < CPL_STAGES; k++)
    PART_TRY(part_timers_stage(cpl->timers, names[k], &cpl->stage[k]));
  PART_TRY(CPL_RESERVE(cpl->solid, cpl->mesh.cells));
  PART_TRY(CPL_RESERVE(cpl->share, cpl->mesh.cells));
  if (cpl->params.self_disturbance) {
    cpl->wake = malloc(sizeof *cpl->wake);
    if (!cpl->wake)
      return part_fail(PART_ERR_MEMORY, "coupling: no memory for the table of wakes");
    cpl_disturbance_make(cpl->wake);
  }
  return cpl_search_create(&cpl->mesh, &cpl->search);
}

int cpl_create(MPI_Comm comm, const cpl_mesh *mesh, const part_box *box, const cpl_params *params,
               const cpl_fluid *fluid, cpl_t **result) {
  PART_TRY(part_agree(comm, check(mesh, params, fluid)));
  cpl_t *cpl = calloc(1, sizeof *cpl);
  PART_TRY(part_agree(
      comm, cpl ? PART_OK : part_fail(PART_ERR_MEMORY, "coupling: no memory for the coupling")));
  cpl->comm = MPI_COMM_NULL;
  cpl->mesh = *mesh;
  cpl->params = *params;
  cpl->fluid = *fluid;
  cpl->force_count = -1;
  int status = MPI_Comm_dup(comm, &cpl->comm) == MPI_SUCCESS
                   ? PART_OK
                   : part_fail(PART_ERR_MPI, "coupling: MPI_Comm_dup failed");
  MPI_Comm_size(comm, &cpl->size);
  if (status == PART_OK)
    status = create_local(cpl);
  status = part_agree(comm, status);
  if (status == PART_OK)
    status = cpl_weights_create(cpl->comm, &cpl->mesh, cpl->search, box, params, &cpl->weights);
  if (status == PART_OK && params->overfull == CPL_OVERFULL_SPREAD)
    status = cpl_relief_create(cpl->comm, &cpl->mesh, &cpl->relief);
  if (status != PART_OK) {
    cpl_destroy(cpl);
    return status;
  }
  *result = cpl;
  return PART_OK;
}

void cpl_destroy(cpl_t *cpl) {
  if (!cpl)
    return;
  cpl_smoother_destroy(cpl->smoother);
  cpl_relief_destroy(cpl->relief);
  cpl_weights_destroy(cpl->weights);
  cpl_search_destroy(cpl->search);
  part_timers_destroy(cpl->timers);
  CPL_FREE(cpl->id);
  CPL_FREE(cpl->sphere);
  CPL_FREE(cpl->volume);
  CPL_FREE(cpl->solid);
  CPL_FREE(cpl->share);
  CPL_FREE(cpl->implicit);
  CPL_FREE(cpl->eps);
  CPL_FREE(cpl->superficial);
  CPL_FREE(cpl->constant);
  CPL_FREE(cpl->curl);
  CPL_FREE(cpl->acceleration);
  CPL_FREE(cpl->extra);
  CPL_FREE(cpl->turning);
  CPL_FREE(cpl->told);
  CPL_FREE(cpl->cell_told);
  CPL_FREE(cpl->inverse_eps);
  CPL_FREE(cpl->reps);
  CPL_FREE(cpl->cell_flow);
  CPL_FREE(cpl->resampled);
  CPL_FREE(cpl->mean_d);
  CPL_FREE(cpl->spread);
  CPL_FREE(cpl->disturbance);
  free(cpl->wake);
  CPL_FREE(cpl->force_id);
  CPL_FREE(cpl->force);
  CPL_FREE(cpl->smooth_work);
  CPL_FREE(cpl->cell_work);
  CPL_FREE(cpl->particle_work);
  CPL_FREE(cpl->particle_work2);
  CPL_FREE(cpl->id_work);
  if (cpl->comm != MPI_COMM_NULL)
    MPI_Comm_free(&cpl->comm);
  free(cpl);
}

part_timers *cpl_timers(cpl_t *cpl) {
  return cpl->timers;
}

/* ---- locate --------------------------------------------------------------------------------- */
/* Whether every particle of every rank is where, and in the order in which, it was located. */
static int nothing_moved(const cpl_t *cpl, const cpl_particles *p) {
  int same = cpl->stamp > 0 && p->count == cpl->count;
  for (int i = 0; same && i < p->count; i++) {
    const double *x = cpl_at(p->position, p->position_stride, i);
    const double *old = cpl->sphere.data + 4 * (size_t)i;
    same = p->id[(size_t)i * (size_t)p->id_stride] == cpl->id.data[i] &&
           memcmp(x, old, 3 * sizeof *x) == 0 &&
           memcmp(cpl_at(p->radius, p->radius_stride, i), old + 3, sizeof *x) == 0;
  }
  if (cpl->size > 1)
    MPI_Allreduce(MPI_IN_PLACE, &same, 1, MPI_INT, MPI_MIN, cpl->comm);
  return same;
}

static int remember(cpl_t *cpl, const cpl_particles *p) {
  PART_TRY(CPL_RESERVE(cpl->id, p->count));
  PART_TRY(CPL_RESERVE(cpl->sphere, 4 * (size_t)p->count));
  PART_TRY(CPL_RESERVE(cpl->volume, p->count));
  for (int i = 0; i < p->count; i++) {
    double *sphere = cpl->sphere.data + 4 * (size_t)i;
    memcpy(sphere, cpl_at(p->position, p->position_stride, i), 3 * sizeof *sphere);
    sphere[3] = *cpl_at(p->radius, p->radius_stride, i);
    cpl->id.data[i] = p->id[(size_t)i * (size_t)p->id_stride];
    cpl->volume.data[i] = cpl_sphere_volume(sphere[3]);
  }
  cpl->count = p->count;
  return PART_OK;
}

static int locate(cpl_t *cpl, const cpl_particles *particles) {
  cpl->locates++;
  if (nothing_moved(cpl, particles)) {
    cpl->reused++;
    return PART_OK;
  }
  const long long stamp = cpl->locates; /* differs from all before */
  cpl->stamp = 0;
  PART_TRY(cpl_agree(cpl, remember(cpl, particles)));
  PART_TRY(cpl_weights_locate(cpl->weights, particles));
  PART_TRY(cpl_update_smoothing(cpl));
  cpl->stamp = stamp;
  return PART_OK;
}

int cpl_locate(cpl_t *cpl, const cpl_particles *particles) {
  part_timers_start(cpl->timers, cpl->stage[CPL_LOCATE]);
  const int status = locate(cpl, particles);
  part_timers_stop(cpl->timers, cpl->stage[CPL_LOCATE]);
  return status;
}

int cpl_check_order(const cpl_t *cpl, const cpl_particles *p, const char *caller) {
  if (cpl->stamp == 0)
    return part_fail(PART_ERR_STATE, "%s: call cpl_locate first", caller);
  if (p->count != cpl->count)
    return part_fail(PART_ERR_STATE, "%s: %d particles, but cpl_locate had %d", caller, p->count,
                     cpl->count);
  for (int i = 0; i < p->count; i++)
    if (p->id[(size_t)i * (size_t)p->id_stride] != cpl->id.data[i])
      return part_fail(
          PART_ERR_STATE,
          "%s: the order of particles has changed since cpl_locate (number %d is %lld, "
          "was %lld)",
          caller, i, (long long)p->id[(size_t)i * (size_t)p->id_stride],
          (long long)cpl->id.data[i]);
  return PART_OK;
}

/* ---- void fraction -------------------------------------------------------------------------- */
/* solid_c = sum_i w_ic V_i; unchanged as long as the weights are. */
static int deposit_solid(cpl_t *cpl) {
  if (cpl->solid_stamp == cpl->stamp)
    return PART_OK;
  memset(cpl->solid.data, 0, (size_t)cpl->mesh.cells * sizeof(double));
  if (cpl->relief)
    cpl_relief_reset(cpl->relief);
  PART_TRY(cpl_spread(cpl, 1, cpl->volume.data, cpl->solid.data));
  PART_TRY(cpl_relieve(cpl, cpl->solid.data));
  cpl->solid_stamp = cpl->stamp;
  return PART_OK;
}

static int write_eps(const cpl_t *cpl, double *eps) {
  int lowest = -1;
  /* relief leaves no cell below it but for round-off of 1 - (1 - minimumEps) */
  double low = cpl->params.minimum_eps - 1e-12;
  for (int c = 0; c < cpl->mesh.cells; c++) {
    const double e = 1.0 - cpl->solid.data[c] / cpl->mesh.volume[c];
    if (eps)
      eps[c] = e;
    if (e < low) {
      low = e;
      lowest = c;
    }
  }
  if (lowest < 0)
    return PART_OK;
  const double *x = cpl->mesh.cell_centre + 3 * (size_t)lowest;
  return part_fail(PART_ERR_RANGE,
                   "coupling: void fraction %g in cell %d at (%g %g %g) m is below minimumEps %g: "
                   "the particles there are too large or overlap too much for the mesh",
                   low, lowest, x[0], x[1], x[2], cpl->params.minimum_eps);
}

/* sum_i w_ic V_i v_i / sum_i w_ic V_i; 0 in cells without particles, and without a deposit when
 * nothing moves. */
static int solid_velocity(cpl_t *cpl, const cpl_particles *p, double *velocity) {
  const size_t cells = (size_t)cpl->mesh.cells;
  int moving = 0;
  int status = CPL_RESERVE(cpl->particle_work, 3 * (size_t)p->count);
  for (int i = 0; status == PART_OK && i < p->count; i++) {
    const double *v = cpl_at(p->velocity, p->velocity_stride, i);
    for (int d = 0; d < 3; d++) {
      cpl->particle_work.data[3 * (size_t)i + (size_t)d] = cpl->volume.data[i] * v[d];
      moving |= !(v[d] == 0.0);
    }
  }
  PART_TRY(cpl_agree(cpl, status));
  memset(velocity, 0, 3 * cells * sizeof *velocity);
  if (cpl->size > 1)
    MPI_Allreduce(MPI_IN_PLACE, &moving, 1, MPI_INT, MPI_MAX, cpl->comm);
  if (!moving)
    return PART_OK;
  PART_TRY(cpl_spread(cpl, 3, cpl->particle_work.data, velocity));
  for (size_t c = 0; c < cells; c++)
    for (size_t d = 0; d < 3 && cpl->solid.data[c] > 0.0; d++)
      velocity[3 * c + d] /= cpl->solid.data[c];
  return PART_OK;
}

/* From the deposited volumes, not from eps, whose round-off would hide them in a dilute domain. */
static void volume_conservation(const cpl_t *cpl, double *error) {
  double sum[2] = {0.0, 0.0};
  for (int c = 0; c < cpl->mesh.cells; c++)
    sum[0] += cpl->solid.data[c];
  for (int i = 0; i < cpl->count; i++)
    sum[1] += cpl->volume.data[i];
  if (cpl->size > 1)
    MPI_Allreduce(MPI_IN_PLACE, sum, 2, MPI_DOUBLE, MPI_SUM, cpl->comm);
  *error = sum[1] > 0.0 ? fabs(sum[0] - sum[1]) / sum[1] : 0.0;
}

static int void_fraction(cpl_t *cpl, const cpl_particles *particles, cpl_cells *cells,
                         double *volume_error) {
  PART_TRY(cpl_agree(cpl, cpl_check_order(cpl, particles, "cpl_void_fraction")));
  PART_TRY(deposit_solid(cpl));
  PART_TRY(cpl_agree(cpl, write_eps(cpl, cells->eps)));
  if (cells->solid_velocity)
    PART_TRY(solid_velocity(cpl, particles, cells->solid_velocity));
  if (volume_error)
    volume_conservation(cpl, volume_error);
  return PART_OK;
}

int cpl_void_fraction(cpl_t *cpl, const cpl_particles *particles, cpl_cells *cells,
                      double *volume_error) {
  part_timers_start(cpl->timers, cpl->stage[CPL_VOID]);
  const int status = void_fraction(cpl, particles, cells, volume_error);
  part_timers_stop(cpl->timers, cpl->stage[CPL_VOID]);
  return status;
}

/* ---- primitives ----------------------------------------------------------------------------- */
static int check_primitive(const cpl_t *cpl, int n, const char *caller) {
  if (cpl->stamp == 0)
    return part_fail(PART_ERR_STATE, "%s: call cpl_locate first", caller);
  return n > 0 ? PART_OK : part_fail(PART_ERR_ARGUMENT, "%s: %d components; at least 1", caller, n);
}

int cpl_deposit(cpl_t *cpl, int n, const double *value, double *cell) {
  PART_TRY(cpl_agree(cpl, check_primitive(cpl, n, "cpl_deposit")));
  return cpl_spread(cpl, n, value, cell);
}

int cpl_sample(cpl_t *cpl, int n, const double *cell, double *value) {
  PART_TRY(cpl_agree(cpl, check_primitive(cpl, n, "cpl_sample")));
  return cpl_gather(cpl, n, cell, value);
}

/* ---- plan ----------------------------------------------------------------------------------- */
/* Append one line "what | why | saves". */
static void line(size_t size, char *text, const char *what, const char *why, const char *saves) {
  const size_t used = strlen(text);
  if (used < size)
    snprintf(text + used, size - used, "%s | %s | %s\n", what, why, saves);
}

int cpl_plan_text(const cpl_t *cpl, size_t size, char *text) {
  if (size == 0)
    return part_fail(PART_ERR_ARGUMENT, "cpl_plan_text: no room for the text");
  const cpl_params *p = &cpl->params;
  text[0] = '\0';
  if (cpl->size == 1)
    line(size, text, "messages between particles and cells", "one rank",
         "all exchange; particle data is used in place");
  if (cpl->reused > 0) {
    char why[96];
    snprintf(why, sizeof why, "no particle moved in %lld of %lld calls", cpl->reused, cpl->locates);
    line(size, text, "locate, weights and void fraction", why, "overlaps and volume deposit");
  } else {
    line(size, text, "locate, weights and void fraction", "only while no particle moves",
         "overlaps and volume deposit");
  }
  if (!p->smoothing)
    line(size, text, "smoothing of what is exchanged", "smoothing off", "its passes over the mesh");
  if (!p->self_disturbance)
    line(size, text, "memory of own forces", "selfDisturbance off", "8 vectors per particle");
  if (!p->saffman_lift && !p->magnus_lift && !p->rotational_drag)
    line(size, text, "lift and turning drag", "all of them off", "sampling of 3 components");
  if (!p->virtual_mass)
    line(size, text, "virtual mass", "virtualMass off", "Du/Dt, sampling of 3 components");
  if (!p->two_way)
    line(size, text, "momentum source and reaction", "twoWay off", "one deposit and one sample");
  if (p->model == CPL_MODEL_B)
    line(size, text, "pressure gradient force", "model B: its drag contains it",
         "sampling of 3 components");
  else if (!p->pressure_gradient)
    line(size, text, "pressure gradient force", "pressureGradient off", "sampling of 3 components");
  if (!p->viscous_stress)
    line(size, text, "viscous stress force", "viscousStress off", "sampling of 3 components");
  return strlen(text) + 1 < size
             ? PART_OK
             : part_fail(PART_ERR_RANGE, "cpl_plan_text: %zu bytes are too few", size);
}

void cpl_overfull_of(const cpl_t *cpl, long long *cells, double *volume) {
  *cells = 0;
  *volume = 0.0;
  if (cpl->relief)
    cpl_relief_report(cpl->relief, cells, volume);
}
