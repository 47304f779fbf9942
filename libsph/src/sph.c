/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Life of an sph_t, and the small queries. */
#include "internal.h"

static const char *const stage_names[SPH_STAGE_COUNT] = {"density", "force",      "walls",
                                                         "move",    "neighbours", "ghosts"};

static int create_parts(sph_t *sph, MPI_Comm comm, const part_box *box) {
  if (MPI_Comm_dup(comm, &sph->comm) != MPI_SUCCESS)
    return part_fail(PART_ERR_MPI, "the communicator cannot be duplicated");
  MPI_Comm_rank(sph->comm, &sph->rank);
  MPI_Comm_size(sph->comm, &sph->ranks);
  sph->box = *box;
  PART_TRY(part_domain_create(sph->comm, box, &sph->domain));
  PART_TRY(part_store_create(&sph_layout, &sph->store));
  PART_TRY(part_pairs_create(0, &sph->pairs));
  PART_TRY(part_timers_create(&sph->timers));
  for (int s = 0; s < SPH_STAGE_COUNT; s++)
    PART_TRY(part_timers_stage(sph->timers, stage_names[s], &sph->stage[s]));
  return PART_OK;
}

static int not_with_variable(const char *entry, int is_on) {
  return is_on ? part_fail(PART_ERR_RANGE,
                           "%s: entry %s is not allowed with variableSmoothing on, which has terms of "
                           "its own for the change of h; must be off, 0 or left out",
                           sph_params_table.name, entry)
               : PART_OK;
}

static int check_variable(const sph_params *p) {
  if (!p->variable_smoothing)
    return PART_OK;
  PART_TRY(not_with_variable("shifting", p->shifting > 0.0));
  PART_TRY(not_with_variable("gradientCorrection", p->gradient_correction));
  PART_TRY(not_with_variable("artificialPressure", p->artificial_pressure > 0.0));
  PART_TRY(not_with_variable("antiClump", p->anti_clump > 0.0));
  if (p->time_scheme != SPH_SYMPLECTIC)
    return part_fail(PART_ERR_RANGE,
                     "%s: entry timeScheme: predictorCorrector is not allowed with variableSmoothing "
                     "on; must be symplectic",
                     sph_params_table.name);
  return PART_OK;
}

static int check_scheme(const sph_params *p) {
  const char *table = sph_params_table.name;
  const double ratio = p->smoothing_length / p->spacing;
  if (ratio < 0.9 || ratio > 3.0)
    return part_fail(PART_ERR_RANGE,
                     "%s: entry smoothingLength: %g m is %g spacings; must be in [0.9, 3]", table,
                     p->smoothing_length, ratio);
  PART_TRY(check_variable(p));
  if (p->density_scheme == SPH_CONTINUITY)
    return PART_OK;
  /* NaN, left out, must not be compared: whoever traps floating point exceptions would stop here. */
  if (!isnan(p->density_diffusion) && p->density_diffusion > 0.0)
    return part_fail(PART_ERR_RANGE,
                     "%s: entry densityDiffusion: %g is not allowed with densityScheme summation, "
                     "must be 0 or left out",
                     table, p->density_diffusion);
  if (p->shifting > 0.0)
    return part_fail(
        PART_ERR_RANGE,
        "%s: entry shifting: %g is not allowed with densityScheme summation, must be 0", table,
        p->shifting);
  if (p->gradient_correction)
    return part_fail(PART_ERR_RANGE,
                     "%s: entry gradientCorrection: on is not allowed with densityScheme summation",
                     table);
  if (p->xsph > 0.0)
    return part_fail(PART_ERR_RANGE,
                     "%s: entry xsph: %g is not allowed with densityScheme summation, must be 0",
                     table, p->xsph);
  return PART_OK;
}

/* What follows from the parameters. */
static void derive(sph_t *sph) {
  sph_params *p = &sph->params;
  const int dim = (int)p->dimensions;
  const double depth = dim == 2 ? p->depth : 1.0, h = p->smoothing_length;
  if (isnan(p->density_diffusion))
    p->density_diffusion = p->density_scheme == SPH_CONTINUITY ? 0.1 : 0.0;
  sph->reach = sph_kernel_support(p->kernel) * h;
  sph->skin = p->skin_fraction * sph->reach;
  if (p->variable_smoothing)
    sph->reach *= p->largest_smoothing;
  sph->unit_norm = sph_kernel_norm(p->kernel, dim) / depth;
  sph->norm = sph_kernel_norm(p->kernel, dim) / pow(h, dim) / depth;
  sph->walls.tie = 1e-9 * p->spacing;
  sph->cell = pow(p->spacing, dim) * depth;
  sph->monaghan =
      p->viscosity * sph_kernel_monaghan(p->kernel, dim) / (p->density * h * p->sound_speed);
  for (int c = 0; c < 3; c++)
    sph->hydrostatic[c] = sph->box.periodic[c] ? 0.0 : p->density * p->gravity[c];
  sph->least_eps = 1.0;
}

int sph_create(MPI_Comm comm, const part_box *box, const sph_params *params, sph_t **result) {
  sph_t *sph = NULL;
  size_t room = 0;
  *result = NULL;
  PART_TRY(part_params_check(&sph_params_table, params));
  PART_TRY(part_box_check_dimensions(box, sph_params_table.name, params->dimensions, params->depth,
                                     params->gravity));
  PART_TRY(check_scheme(params));
  PART_TRY(sph_grow(1, sizeof *sph, &room, &sph));
  sph->params = *params;
  sph->comm = MPI_COMM_NULL;
  sph->plane = NAN;
  const int status = create_parts(sph, comm, box);
  if (status != PART_OK) {
    sph_destroy(sph);
    return status;
  }
  derive(sph);
  *result = sph;
  return PART_OK;
}

void sph_destroy(sph_t *sph) {
  if (sph == NULL)
    return;
  if (sph->pairs != NULL)
    part_pairs_destroy(sph->pairs);
  if (sph->store != NULL)
    part_store_destroy(sph->store);
  if (sph->domain != NULL)
    part_domain_destroy(sph->domain);
  if (sph->timers != NULL)
    part_timers_destroy(sph->timers);
  sph_walls_free(&sph->walls);
  free(sph->lists.start);
  free(sph->lists.partner);
  free(sph->sum);
  free(sph->shift);
  free(sph->shade);
  free(sph->factor);
  free(sph->balance);
  free(sph->lens);
  free(sph->saved);
  if (sph->comm != MPI_COMM_NULL)
    MPI_Comm_free(&sph->comm);
  free(sph);
}

part_store *sph_store(sph_t *sph) {
  return sph->store;
}
long long sph_generation(const sph_t *sph) {
  return sph->generation;
}
double sph_time(const sph_t *sph) {
  return sph->time;
}
void sph_set_eps_ahead(sph_t *sph, int ahead) {
  sph->eps_ahead = ahead != 0;
}
void sph_set_time(sph_t *sph, double time) {
  sph->time = time;
  if (sph->started)
    sph_walls_move(sph, time);
}
part_timers *sph_timers(sph_t *sph) {
  return sph->timers;
}
int sph_width(const sph_t *sph) {
  return sph->loops != NULL ? sph->loops->width : 1;
}

int sph_stable_step(sph_t *sph, double *step) {
  double speed;
  if (!sph->started)
    return part_fail(PART_ERR_STATE, "sph_stable_step comes after sph_start");
  PART_TRY(sph_plan_fields(sph));
  return sph_limits(sph, step, &speed);
}

int sph_get_view(sph_t *sph, sph_view *view) {
  if (!sph->started)
    return part_fail(PART_ERR_STATE, "sph_get_view comes after sph_start");
  double *xv = sph_xv(sph), *mass = sph_mass(sph);
  *view = (sph_view){.own = sph->store->local,
                     .all = sph->store->local + sph->store->ghost,
                     .position = xv,
                     .velocity = xv + 4,
                     .volume = xv + 3,
                     .pressure = xv + 7,
                     .xv_stride = SPH_XV,
                     .eps = mass + 2,
                     .mass = mass,
                     .density = mass + 1,
                     .mass_stride = SPH_MASS,
                     .acceleration = sph_rate(sph),
                     .rate_stride = SPH_RATE,
                     .force = sph_force(sph),
                     .eps_rate = sph_force(sph) + 3,
                     .eps_gradient = sph_force(sph) + 4,
                     .force_stride = SPH_FORCE,
                     .kernel = sph->params.kernel,
                     .dimensions = (int)sph->params.dimensions,
                     .lens = sph->plan.variable ? sph->lens : NULL,
                     .h = sph->params.smoothing_length,
                     .depth = sph->params.depth};
  return PART_OK;
}
