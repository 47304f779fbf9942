/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables made from the .def lists: particle fields, parameters, names of laws and kinds. */
#include "internal.h"

static const part_record record_rows[] = {
#define DEM_RECORD(name, type, width) {#name, type, width},
#define DEM_FIELD(name, key, record, offset, comps, flags, unit, meaning)
#include "dem/particle_fields.def"
#undef DEM_RECORD
#undef DEM_FIELD
};

static const part_field field_rows[] = {
#define DEM_RECORD(name, type, width)
#define DEM_FIELD(name, key, record, offset, comps, flags, unit, meaning)                          \
  {key, DEM_RECORD_##record, offset, comps, flags, unit, meaning},
#include "dem/particle_fields.def"
#undef DEM_RECORD
#undef DEM_FIELD
};

const part_layout dem_layout = {DEM_RECORD_COUNT, record_rows, DEM_FIELD_COUNT, field_rows,
                                DEM_FIELD_ID};

static const char *const dem_law_names[] = {
#define DEM_LAW(name, key, meaning) key,
#include "dem/contact_laws.def"
#undef DEM_LAW
    NULL};
static const char *const dem_insert_methods[] = {"lattice", "random", "file", NULL};
static const char *const dem_wall_types[] = {"plane", "cylinder", "triangles", "stl", NULL};
static const char *const dem_wall_sides[] = {"inside", "outside", NULL};
static const char *const dem_kinds[] = {"free", "fixed", "block", "clump", NULL};
static const char *const dem_orientations[] = {"random", "asInFile", NULL};

#define DEM_DIMS PART_PARAM_DIMS
#define DEM_THREE PART_PARAM_THREE
#define DEM_PARAM PART_PARAM_ROW

static const part_param params_rows[] = {
#define PART_PARAM_STRUCT dem_params
#include "dem/main_params.def"
#undef PART_PARAM_STRUCT
};
static const part_param material_rows[] = {
#define PART_PARAM_STRUCT dem_material
#include "dem/material_params.def"
#undef PART_PARAM_STRUCT
};
static const part_param contact_rows[] = {
#define PART_PARAM_STRUCT dem_contact
#include "dem/contact_params.def"
#undef PART_PARAM_STRUCT
};
static const part_param bond_rows[] = {
#define PART_PARAM_STRUCT dem_bond
#include "dem/bond_params.def"
#undef PART_PARAM_STRUCT
};
static const part_param lubrication_rows[] = {
#define PART_PARAM_STRUCT dem_lubrication
#include "dem/lubrication_params.def"
#undef PART_PARAM_STRUCT
};
static const part_param insert_rows[] = {
#define PART_PARAM_STRUCT dem_insert
#include "dem/insert_params.def"
#undef PART_PARAM_STRUCT
};
static const part_param wall_rows[] = {
#define PART_PARAM_STRUCT dem_wall_params
#include "dem/wall_params.def"
#undef PART_PARAM_STRUCT
};

const part_param_table dem_params_table = PART_PARAM_TABLE("demProperties", params_rows);
const part_param_table dem_material_table = PART_PARAM_TABLE("material", material_rows);
const part_param_table dem_contact_table = PART_PARAM_TABLE("contact", contact_rows);
const part_param_table dem_bond_table = PART_PARAM_TABLE("bond", bond_rows);
const part_param_table dem_lubrication_table = PART_PARAM_TABLE("lubrication", lubrication_rows);
const part_param_table dem_insert_table = PART_PARAM_TABLE("insert", insert_rows);
const part_param_table dem_wall_table = PART_PARAM_TABLE("wall", wall_rows);
