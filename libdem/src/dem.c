/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Life of a dem_t, its materials and contacts, and the small queries. */
#include "internal.h"
#include "laws.h"

static const char *const stage_names[DEM_STAGE_COUNT] = {"integrate",  "contact", "walls",
                                                         "neighbours", "ghosts",  "blocks",
                                                         "clumps",     "bonds",   "lubrication"};

static int create_parts(dem_t *dem, MPI_Comm comm, const part_box *box) {
  if (MPI_Comm_dup(comm, &dem->comm) != MPI_SUCCESS)
    return part_fail(PART_ERR_MPI, "the communicator cannot be duplicated");
  MPI_Comm_rank(dem->comm, &dem->rank);
  MPI_Comm_size(dem->comm, &dem->ranks);
  dem->box = *box;
  PART_TRY(part_domain_create(dem->comm, box, &dem->domain));
  PART_TRY(part_store_create(&dem_layout, &dem->store));
  PART_TRY(part_timers_create(&dem->timers));
  for (int s = 0; s < DEM_STAGE_COUNT; s++)
    PART_TRY(part_timers_stage(dem->timers, stage_names[s], &dem->stage[s]));
  return PART_OK;
}

static void set_shape(dem_t *dem) {
  dem_shape *shape = &dem->shape;
  shape->flat = dem->params.dimensions == 2;
  shape->depth = dem->params.depth;
  shape->spin = shape->flat ? 2.0 : 2.5;
  shape->tangential_mass = 1.0 / (1.0 + shape->spin);
}

int dem_create(MPI_Comm comm, const part_box *box, const dem_params *params, dem_t **result) {
  dem_t *dem = NULL;
  *result = NULL;
  PART_TRY(part_params_check(&dem_params_table, params));
  if (params->ramp_time > 0.0 && !(params->ramp_fluid_density > 0.0))
    return part_fail(PART_ERR_RANGE,
                     "%s: entry rampFluidDensity must be given and positive with rampTime %g s",
                     dem_params_table.name, params->ramp_time);
  PART_TRY(part_box_check_dimensions(box, dem_params_table.name, params->dimensions, params->depth,
                                     params->gravity));
  PART_TRY(dem_allocate(1, sizeof *dem, &dem));
  dem->params = *params;
  dem->comm = MPI_COMM_NULL;
  set_shape(dem);
  const int status = create_parts(dem, comm, box);
  if (status != PART_OK) {
    dem_destroy(dem);
    return status;
  }
  dem->stable_step = HUGE_VAL;
  dem->clumps.parts = 1;
  *result = dem;
  return PART_OK;
}

void dem_destroy(dem_t *dem) {
  if (dem == NULL)
    return;
  if (dem->pairs != NULL)
    part_pairs_destroy(dem->pairs);
  if (dem->store != NULL)
    part_store_destroy(dem->store);
  if (dem->domain != NULL)
    part_domain_destroy(dem->domain);
  if (dem->timers != NULL)
    part_timers_destroy(dem->timers);
  dem_walls_free(&dem->walls);
  dem_wear_free(&dem->wear);
  dem_fast_free(&dem->fast);
  dem_bonds_free(&dem->bonds);
  dem_film_free(&dem->film);
  free(dem->material);
  free(dem->given);
  free(dem->coefs);
  free(dem->seed);
  dem_clumps_free(&dem->clumps);
  dem_clumps_free_seeds(&dem->clumps);
  free(dem->carried.value);
  free(dem->block);
  free(dem->block_gravity);
  free(dem->mass_of);
  free(dem->gravity_now);
  free(dem->wet.row);
  free(dem->x_built);
  free(dem->kept_count);
  free(dem->kept);
  if (dem->comm != MPI_COMM_NULL)
    MPI_Comm_free(&dem->comm);
  free(dem);
}

static int not_started(const dem_t *dem, const char *call) {
  if (dem->started)
    return part_fail(PART_ERR_STATE, "%s comes before dem_start", call);
  return PART_OK;
}

int dem_add_material(dem_t *dem, const dem_material *material, int *number) {
  PART_TRY(not_started(dem, "dem_add_material"));
  if (memchr(material->name, '\0', sizeof material->name) == NULL || material->name[0] == '\0')
    return part_fail(PART_ERR_ARGUMENT, "a material needs a name of 1 to %d characters",
                     PART_PARAM_WORD_LENGTH - 1);
  if (part_params_check(&dem_material_table, material) != PART_OK)
    return part_fail_context(PART_ERR_RANGE, "material %s", material->name);
  const double nu = material->poisson_ratio;
  if (!(material->youngs_modulus > 0.0) && !isnan(nu) && nu != 0.0)
    return part_fail(PART_ERR_RANGE,
                     "material %s: entry poissonRatio is given without youngsModulus",
                     material->name);
  for (int m = 0; m < dem->materials; m++)
    if (strcmp(dem->material[m].name, material->name) == 0)
      return part_fail(PART_ERR_ARGUMENT, "material %s is given twice", material->name);
  dem_material *more = realloc(dem->material, ((size_t)dem->materials + 1) * sizeof *dem->material);
  if (more == NULL)
    return part_fail(PART_ERR_MEMORY, "no memory for material %s", material->name);
  dem->material = more;
  dem->material[dem->materials] = *material;
  dem->material[dem->materials].density += dem->added_density;
  if (number != NULL)
    *number = dem->materials;
  dem->materials++;
  return PART_OK;
}

int dem_add_mass(dem_t *dem, double density) {
  PART_TRY(not_started(dem, "dem_add_mass"));
  if (!isfinite(density) || density < 0.0)
    return part_fail(PART_ERR_RANGE, "added mass of %g kg/m3 of particle: must be finite, >= 0",
                     density);
  if (dem->seeds > 0)
    return part_fail(PART_ERR_STATE, "dem_add_mass comes before insertion");
  if (density > 0.0 && dem->shape.flat)
    return part_fail(PART_ERR_RANGE,
                     "an added mass is that of spheres, not of discs (dimensions 2)");
  for (int m = 0; m < dem->materials; m++)
    dem->material[m].density += density - dem->added_density;
  dem->added_density = density;
  return PART_OK;
}

double dem_own_share(const dem_t *dem, int material) {
  return dem_own_part(dem, material);
}

/* Hertz' stiffness and adhesion are those of spheres. */
static int check_flat_contact(const dem_contact *contact) {
  const char *table = dem_contact_table.name;
  if (contact->law != DEM_LAW_linear_spring_dashpot)
    return part_fail(PART_ERR_RANGE,
                     "%s: entry law: must be linearSpringDashpot with dimensions 2, the others are "
                     "those of spheres",
                     table);
  if (isnan(contact->normal_stiffness))
    return part_fail(
        PART_ERR_RANGE,
        "%s: entry normalStiffness must be given with dimensions 2, it does not follow "
        "from the elastic constants as that of spheres does",
        table);
  if (contact->work_of_adhesion > 0.0)
    return part_fail(PART_ERR_RANGE,
                     "%s: entry workOfAdhesion: %g J/m^2 is not allowed with dimensions 2, must be "
                     "0",
                     table, contact->work_of_adhesion);
  return PART_OK;
}

int dem_set_contact(dem_t *dem, int a, int b, const dem_contact *contact) {
  PART_TRY(not_started(dem, "dem_set_contact"));
  PART_TRY(part_params_check(&dem_contact_table, contact));
  PART_TRY(dem_laws_check(contact));
  if (dem->shape.flat)
    PART_TRY(check_flat_contact(contact));
  const int every = a == -1 && b == -1;
  if (!every && (a < 0 || b < 0 || a >= dem->materials || b >= dem->materials))
    return part_fail(PART_ERR_RANGE,
                     "contact of materials %d and %d: numbers are 0 to %d, or -1 and -1 for all", a,
                     b, dem->materials - 1);
  dem_given_contact *more =
      realloc(dem->given, ((size_t)dem->given_contacts + 1) * sizeof *dem->given);
  if (more == NULL)
    return part_fail(PART_ERR_MEMORY, "no memory for contact %d", dem->given_contacts);
  dem->given = more;
  dem->given[dem->given_contacts++] = (dem_given_contact){a, b, *contact};
  return PART_OK;
}

part_store *dem_store(dem_t *dem) {
  return dem->store;
}
long long dem_generation(const dem_t *dem) {
  return dem->generation;
}
double dem_time(const dem_t *dem) {
  return dem->time;
}
void dem_set_time(dem_t *dem, double time) {
  dem->time = time;
  if (dem->started)
    dem_walls_move(dem, time, 0.0);
}
double dem_stable_step(const dem_t *dem) {
  return dem->stable_step;
}
part_timers *dem_timers(dem_t *dem) {
  return dem->timers;
}

int dem_block_state(dem_t *dem, int block, double position[3], double velocity[3]) {
  if (!dem->started)
    return part_fail(PART_ERR_STATE, "dem_block_state comes after dem_start");
  if (block < 0 || block >= dem->blocks || dem->block[block].members == 0)
    return part_fail(PART_ERR_RANGE, "there is no block %d", block);
  memcpy(position, dem->block[block].x, 3 * sizeof(double));
  memcpy(velocity, dem->block[block].v, 3 * sizeof(double));
  return PART_OK;
}

int dem_block_count(const dem_t *dem) {
  return dem->started ? dem->blocks : 0;
}

double dem_block_mass(const dem_t *dem, int block) {
  const int known = block >= 0 && block < dem_block_count(dem);
  return known && dem->block[block].members > 0 ? dem->block[block].mass : 0.0;
}

int dem_clump_state(dem_t *dem, int64_t number, dem_clump_report *report) {
  double found[21] = {0.0};
  if (!dem->started)
    return part_fail(PART_ERR_STATE, "dem_clump_state comes after dem_start");
  for (int b = 0; b < dem->clumps.count; b++) {
    const dem_clump *clump = &dem->clumps.clump[b];
    if (clump->number != number)
      continue;
    found[0] = clump->count;
    found[1] = clump->mass;
    memcpy(found + 2, clump->x, sizeof clump->x);
    memcpy(found + 5, clump->v, sizeof clump->v);
    memcpy(found + 8, clump->q, sizeof clump->q);
    dem_clump_rotation(clump, found + 12);
    memcpy(found + 15, clump->spin, sizeof clump->spin);
    memcpy(found + 18, clump->inertia, sizeof clump->inertia);
  }
  PART_TRY(dem_rank_sum(dem, 21, found)); /* zeros but for one rank */
  if (!(found[0] > 0.0))
    return part_fail(PART_ERR_RANGE, "there is no clump %lld", (long long)number);
  report->members = (int64_t)found[0];
  report->mass = found[1];
  memcpy(report->position, found + 2, sizeof report->position);
  memcpy(report->velocity, found + 5, sizeof report->velocity);
  memcpy(report->attitude, found + 8, sizeof report->attitude);
  memcpy(report->angular_velocity, found + 12, sizeof report->angular_velocity);
  memcpy(report->angular_momentum, found + 15, sizeof report->angular_momentum);
  memcpy(report->inertia, found + 18, sizeof report->inertia);
  return PART_OK;
}
