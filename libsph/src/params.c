/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables made from the .def lists: particle fields, parameters, names of kernels and schemes. */
#include "internal.h"

static const part_record record_rows[] = {
#define SPH_RECORD(name, type, width) {#name, type, width},
#define SPH_FIELD(name, key, record, offset, comps, flags, unit, meaning)
#include "sph/particle_fields.def"
#undef SPH_RECORD
#undef SPH_FIELD
};

static const part_field field_rows[] = {
#define SPH_RECORD(name, type, width)
#define SPH_FIELD(name, key, record, offset, comps, flags, unit, meaning)                          \
  {key, SPH_RECORD_##record, offset, comps, flags, unit, meaning},
#include "sph/particle_fields.def"
#undef SPH_RECORD
#undef SPH_FIELD
};

const part_layout sph_layout = {SPH_RECORD_COUNT, record_rows, SPH_FIELD_COUNT, field_rows,
                                SPH_FIELD_ID};

static const char *const sph_kernel_names[] = {
#define SPH_KERNEL(name, key, support, meaning) key,
#include "sph/kernels.def"
#undef SPH_KERNEL
    NULL};
static const char *const sph_density_schemes[] = {"continuity", "summation", NULL};
static const char *const sph_viscosity_models[] = {"morris", "monaghan", NULL};
static const char *const sph_time_schemes[] = {"symplectic", "predictorCorrector", NULL};
static const char *const sph_wall_types[] = {"plane", "triangles", NULL};
static const char *const sph_wall_models[] = {
#define SPH_WALL_POINTS(name, key, meaning) key,
#define SPH_WALL_PUSH(name, key, meaning) key,
#include "sph/wall_models.def"
#undef SPH_WALL_POINTS
#undef SPH_WALL_PUSH
    NULL};
static const char *const sph_wall_slips[] = {"noSlip", "freeSlip", NULL};

#define SPH_DIMS PART_PARAM_DIMS
#define SPH_THREE PART_PARAM_THREE
#define SPH_PARAM PART_PARAM_ROW

static const part_param params_rows[] = {
#define PART_PARAM_STRUCT sph_params
#include "sph/main_params.def"
#undef PART_PARAM_STRUCT
};
static const part_param insert_rows[] = {
#define PART_PARAM_STRUCT sph_insert
#include "sph/insert_params.def"
#undef PART_PARAM_STRUCT
};
static const part_param wall_rows[] = {
#define PART_PARAM_STRUCT sph_wall_params
#include "sph/wall_params.def"
#undef PART_PARAM_STRUCT
};

const part_param_table sph_params_table = PART_PARAM_TABLE("sphProperties", params_rows);
const part_param_table sph_insert_table = PART_PARAM_TABLE("fill", insert_rows);
const part_param_table sph_wall_table = PART_PARAM_TABLE("wall", wall_rows);
