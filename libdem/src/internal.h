/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of libdem share. */
#ifndef DEM_INTERNAL_H
#define DEM_INTERNAL_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "bonds.h"
#include "clumps.h"
#include "dem/dem.h"
#include "fast.h"
#include "law.h"
#include "lubrication.h"
#include "particle/neighbours.h"
#include "particle/sum.h"
#include "walls.h"
#include "wear.h"

/* Strides of the records, as in particle_fields.def. */
enum { DEM_XR = 4, DEM_VM = 8, DEM_FT = 8, DEM_FLUID = 8, DEM_META = 4 };

typedef struct dem_given_contact {
  int a, b;
  dem_contact contact;
} dem_given_contact;

/* A rigid block: one translation. Same on every rank, bit for bit. */
typedef struct dem_block {
  int64_t members;   /* 0: the number is not used */
  double mass;       /* kg */
  double x[3];       /* m, mean of the members, unwrapped */
  double v[3];       /* m/s */
  double force[3];   /* N, contact force on all members */
  double su[3], sp;  /* sums over all members, constant over an advance */
  double shift[3];   /* m, displacement in the current substep */
  double path[3];    /* m, integral of v dt over the current advance */
  double impulse[3]; /* N s, received from the fluid over the current advance */
} dem_block;

/* One inserted particle, known to every rank until dem_start. */
typedef struct dem_seed {
  double x[3], r, v[3], w[3];
  int material, kind, block;
} dem_seed;

/* How evenly the ranks are loaded, from the lists built last; the same on every rank. */
typedef struct dem_load {
  double ratio, mean; /* largest cost of a rank over the mean; that mean (balance.c) */
  double reached;     /* least ratio since the last balancing by cost */
  int balanced;       /* the parts were made by cost since ratio was worked out */
} dem_load;

/* What can be left out, worked out by dem_start. */
typedef struct dem_plan {
  int tangential; /* friction or rolling resistance somewhere: rotation and tangential history */
  int rolling;    /* rolling resistance somewhere */
  int cohesion;   /* attraction somewhere */
  int pairs;      /* two bodies that can touch: neighbour lists and ghosts */
  int walls;      /* walls and something that moves */
  int horizon;    /* one step when no contact can happen before its end */
  int blocks;     /* blocks exist */
  int bonds;      /* there are rules of bonds */
  int lubrication; /* it is asked for, and two bodies can be near */
  int clumps;     /* clumps exist */
  int all_free;   /* no fixed particles, blocks or clumps */
  int movable;    /* something moves */
} dem_plan;

/* Solids of revolution about the axis they turn about: spheres in space, discs in two dimensions. */
typedef struct dem_shape {
  int flat;               /* discs in a plane of constant z */
  double plane;           /* m, that z: of the first particle */
  double depth;           /* m, length of discs */
  double spin;            /* m r^2/I: 5/2, 2 */
  double tangential_mass; /* of m_eff when both may turn, 1/(1 + spin): 2/7, 1/3 */
} dem_shape;

enum dem_stage {
  DEM_STAGE_INTEGRATE,
  DEM_STAGE_CONTACT,
  DEM_STAGE_WALLS,
  DEM_STAGE_NEIGHBOURS,
  DEM_STAGE_GHOSTS,
  DEM_STAGE_BLOCKS,
  DEM_STAGE_CLUMPS,
  DEM_STAGE_BONDS,
  DEM_STAGE_LUBRICATION,
  DEM_STAGE_COUNT
};

typedef struct dem_wet_row dem_wet_row;

struct dem_t {
  MPI_Comm comm;
  int rank, ranks;
  dem_params params;
  dem_shape shape;
  part_domain *domain;
  part_box box;
  part_store *store;
  part_pairs *pairs;
  part_timers *timers;
  int stage[DEM_STAGE_COUNT];

  int materials;
  dem_material *material;
  int given_contacts;
  dem_given_contact *given;
  dem_coefs *coefs; /* [materials][materials] */
  dem_walls walls;
  dem_wear wear;
  dem_bonds bonds;
  dem_film film;

  int64_t seeds; /* inserted so far */
  size_t seed_capacity;
  dem_seed *seed;

  int blocks; /* largest number + 1 */
  dem_block *block;
  double *block_gravity; /* [blocks][materials] kg, mass of each material */
  dem_clumps clumps;
  struct {         /* dem_carry */
    int vectors;   /* per particle, 0: none */
    int count;     /* particles in value */
    double *value; /* [count][vectors][3] */
  } carried;

  int started, restored;
  double added_density; /* kg/m3, in every material's density: dem_add_mass */
  int kicked; /* since the last advance: velocityEnded is that before the kick */
  int restored_elsewhere; /* read on another number of ranks than wrote */
  dem_plan plan;
  dem_fast fast;
  double time, stable_step;
  double impact_speed; /* m/s, given or worked out */
  double contact_time; /* s, the shortest */
  int shortest[2];     /* materials that have it */
  double r_min, r_max, r_mean, skin;
  part_levels levels;       /* of radii */
  double skin_most;         /* m, largest that adapt_skin may choose */
  double skin_wide;         /* m, the same for dilute scenes */
  long long substeps_built; /* substeps when the lists were built */
  int64_t listed;           /* pairs then, of all ranks */
  double *mass_of;          /* [materials] kg, own free particles */
  double *gravity_now;      /* [2][materials][3] m/s2, mean over this half step and the next */
  struct dem_wet {          /* integrate.c; h = 0: none */
    double h;               /* s, substep it was made for */
    long long generation;   /* order of particles */
    int room;
    struct dem_wet_row *row;
  } wet;
  double *x_built;          /* [3 local] where particles were when the lists were built */
  double travel;            /* m, bound of the largest displacement of any particle since then */

  double wall_force[3], support_force[3]; /* N, on own movable particles, now */
  part_sum wall_impulse, support_impulse, gravity_impulse, fluid_impulse;
  double initial_momentum[3]; /* of the own share; the sum over ranks counts */
  long long generation, substeps, rebuilds;
  dem_load load;
  int64_t total;

  /* History kept between dem_read and dem_start: pairs and walls, per own particle. */
  int *kept_count;
  void *kept;
};

/* ---- access ---------------------------------------------------------------------------------- */
static inline double *dem_xr(const dem_t *dem) {
  return part_record_double(dem->store, DEM_RECORD_XR);
}
static inline double *dem_vm(const dem_t *dem) {
  return part_record_double(dem->store, DEM_RECORD_VM);
}
static inline double *dem_ft(const dem_t *dem) {
  return part_record_double(dem->store, DEM_RECORD_FT);
}
static inline double *dem_fluid(const dem_t *dem) {
  return part_record_double(dem->store, DEM_RECORD_FLUID);
}
static inline int64_t *dem_meta(const dem_t *dem) {
  return part_record_int64(dem->store, DEM_RECORD_META);
}
static inline int64_t dem_id(const dem_t *dem, int i) {
  return dem_meta(dem)[DEM_META * (size_t)i];
}
static inline int dem_kind_of(const dem_t *dem, int i) {
  return (int)dem_meta(dem)[DEM_META * (size_t)i + 1];
}
static inline int dem_block_of(const dem_t *dem, int i) {
  return (int)dem_meta(dem)[DEM_META * (size_t)i + 2];
}
/* Parts of contacts that the scene needs (law.h). */
static inline int dem_parts(const dem_t *dem) {
  return (dem->plan.tangential ? DEM_SLIDING : 0) | (dem->plan.rolling ? DEM_ROLLING : 0) |
         (dem->plan.cohesion ? DEM_COHESION : 0);
}
static inline int dem_material_of(const dem_t *dem, int i) {
  return (int)dem_vm(dem)[DEM_VM * (size_t)i + 7];
}
/* Share of the inertia of a material that is its own: weight and spin go with it (dem_add_mass). */
static inline double dem_own_part(const dem_t *dem, int material) {
  return dem->added_density > 0.0 ? 1.0 - dem->added_density / dem->material[material].density : 1.0;
}
/* Mass of a sphere or disc (kg), added mass included. */
static inline double dem_mass(const dem_t *dem, int material, double r) {
  const double pi = 3.14159265358979323846, density = dem->material[material].density;
  return dem->shape.flat ? density * pi * r * r * dem->shape.depth
                         : density * (4.0 / 3.0 * pi) * r * r * r;
}
/* Mass of the particle itself (kg): INVERSE_MASS is zero when fixed and the block's in a block. */
static inline double dem_own_mass(const dem_t *dem, int i) {
  return dem_mass(dem, dem_material_of(dem, i), dem_xr(dem)[DEM_XR * (size_t)i + 3]);
}

/* ---- memory.c: ERR_MEMORY; items are zero ------------------------------------------------------
 */
int dem_allocate(size_t count, size_t size, void *pointer_to_pointer);
int dem_grow(size_t count, size_t size, size_t *capacity, void *pointer_to_pointer);

/* ---- plan.c ------------------------------------------------------------------------------------
 */
/* Collective. Radii, skin, coefficients, plan and stable step from the particles present. */
int dem_make_plan(dem_t *dem);

/* ---- materials.c -------------------------------------------------------------------------------
 */
/* Checks what is given, works out impact_speed from the largest speed now (m/s), empties coefs. */
int dem_materials_begin(dem_t *dem, double speed);
/* Coefficients of a pair, and what it needs of the plan. ERR_RANGE when something lacks and
 * can_happen. */
int dem_materials_pair(dem_t *dem, int a, int b, int can_happen);
/* Shortens contact_time to that of a pair. Inverse masses (1/kg) of the lightest that may meet, 0:
 * does not give way. */
void dem_materials_time(dem_t *dem, int a, int b, double inverse_a, double inverse_b);

/* ---- report.c ----------------------------------------------------------------------------------
 */
/* Momentum of own free particles, and on rank 0 of all blocks; size: sum of m |v| (NULL: not). */
void dem_own_momentum(const dem_t *dem, double momentum[3], double *size);

/* ---- balance.c ---------------------------------------------------------------------------------
 */
/* Collective. New parts when the load has drifted, or anyway; before the lists of own particles are
 * dropped. home: see part_domain_balance_home. */
int dem_balance(dem_t *dem, int anyway, const double *home);
/* Collective. The load, from the lists just built. */
int dem_balance_note(dem_t *dem);

/* ---- rebuild.c ---------------------------------------------------------------------------------
 */
/* Collective. Migrate, sort, ghosts, lists; history is carried over. count/payload: history that
 * does not come from the present lists (after dem_read); NULL otherwise; taken over and freed. */
int dem_rebuild(dem_t *dem, int balance, int *count, void *payload);
/* Collective. After a drift by at most `way` (m, own particles of this rank; negative: not known):
 * refresh ghosts, or rebuild when particles may have left the lists. */
int dem_refresh(dem_t *dem, double way);
/* The payload: what particles carry along when they are sorted, migrate or are written, as entries
 * of three doubles. The key says what it is: < 0 a wall contact (walls.h), else DEM_KEY of one of
 * these kinds and a number < 2^56. A reader passes over keys that are not its own. */
enum dem_key_kind {
  DEM_KEY_PAIR,  /* number: id of the partner; what part_pairs_gather makes */
  DEM_KEY_ROLL,  /* number: id of the partner; second half of a pair's data */
  DEM_KEY_BOND,  /* number: id of the partner * 256 + part */
  DEM_KEY_CLUMP, /* number: part */
  DEM_KEY_CARRIED, /* number: of the vector */
};
#define DEM_KEY(kind, number) ((int64_t)(kind) << 56 | (int64_t)(number))
#define DEM_KEY_KIND(key) ((int)((key) >> 56))
#define DEM_KEY_NUMBER(key) ((key) & (((int64_t)1 << 56) - 1))
typedef struct dem_entry {
  int64_t key;
  double value[DEM_SPRING];
} dem_entry;

/* Something that puts entries into the payload. The same file takes them out again after the
 * particles are in their new order (make_lists in rebuild.c). */
typedef struct dem_carrier {
  int (*active)(const dem_t *dem);             /* the same on every rank */
  void (*count)(const dem_t *dem, int *count); /* add own entries of each own particle */
  dem_entry *(*put)(const dem_t *dem, int i, dem_entry *to); /* those of particle i; the end */
} dem_carrier;
extern const dem_carrier dem_walls_carrier, dem_bonds_carrier, dem_clumps_carrier,
    dem_carried_carrier;
/* The carried vectors out of the payload (NULL: zeros), in the present order. */
int dem_carried_list(dem_t *dem, const int *count, const void *payload);

int dem_history_needed(const dem_t *dem); /* the same on every rank */
int dem_history_gather(const dem_t *dem, int **count, void **payload);
/* Entries of pairs into the list of pairs. */
int dem_history_scatter(dem_t *dem, const int *count, const void *payload);
/* Sort own particles by cells; the payload comes along. */
int dem_history_sort(dem_t *dem, int *count, void *payload);

/* ---- contact.c ---------------------------------------------------------------------------------
 */
/* Contact forces and torques of pairs into FORCE, TORQUE of own particles, which start at zero. */
void dem_pair_forces(dem_t *dem, double dt);
/* Own particle i and particle j share neither a body nor a bond. */
int dem_pair_wanted(const dem_t *dem, int i, int j);
int dem_pair_list_filter(dem_t *dem); /* drop the others */
/* The law that all given contacts have in common, -1: they differ, or there is none. */
int dem_common_law(const dem_t *dem);

/* ---- wall_contact.c ----------------------------------------------------------------------------
 */
void dem_wall_forces(dem_t *dem, double dt);
/* Contacts of a row of the wall list; place has room for the row. Returns how many. */
int dem_walls_touched(const dem_t *dem, int row, dem_candidate *place);

/* ---- forces.c ----------------------------------------------------------------------------------
 */
/* Collective. All contact forces at the present positions; dt stretches the springs. */
int dem_forces(dem_t *dem, double dt);
/* Parts of it, for fused steps: forces and torques to zero; those of walls added. */
void dem_no_forces(dem_t *dem);
void dem_wall_stage(dem_t *dem, double dt);

/* ---- integrate.c -------------------------------------------------------------------------------
 */
/* Gravity on a material over its weight, mean over [t, t+h] (Markauskas et al. 2017 eq. 3-4). */
double dem_gravity_factor(const dem_t *dem, int material, double t, double h);
/* Half step from t and the displacement of the whole step h, whose longest is returned (m); half
 * step from t to t + h/2. */
double dem_free_kick_drift(dem_t *dem, double t, double h, int fluid);
void dem_free_kick(dem_t *dem, double t, double h, int fluid);
/* Half step to t and, with the same forces, all of dem_free_kick_drift. */
double dem_free_two_kicks_drift(dem_t *dem, double t, double h, int fluid);

/* ---- blocks.c ----------------------------------------------------------------------------------
 */
int dem_blocks_begin(dem_t *dem); /* collective: fluid sums */
/* The same; returns the longest displacement (m). */
double dem_blocks_kick_drift(dem_t *dem, double t, double h);
void dem_blocks_kick(dem_t *dem, double t, double h);
int dem_blocks_forces(dem_t *dem);         /* collective */
int dem_blocks_end(dem_t *dem, double dt); /* collective: impulse shares of the members */
/* Impulses (N s) [blocks][3], the same on every rank, on the blocks. */
void dem_blocks_add(dem_t *dem, const double *impulse);
/* Collective. The state of all blocks in a file; nothing is written or read when there are none. */
struct part_file;
int dem_blocks_write(const dem_t *dem, struct part_file *file);
int dem_blocks_read(dem_t *dem, struct part_file *file); /* dem->blocks is known */
/* Collective. Sum of n doubles over ranks in rank order: the same bits on every rank. */
int dem_rank_sum(const dem_t *dem, int n, double *values);

/* ---- horizon.c ---------------------------------------------------------------------------------
 */
/* Collective. Time (s) from now within which no contact can exist or begin; looks as far as dt. */
int dem_horizon(dem_t *dem, double dt, double *free_time);

/* ---- insert*.c ---------------------------------------------------------------------------------
 */
int dem_insert_lattice(const dem_insert *insert, dem_seed **seed, int64_t *count);
int dem_insert_random(const dem_t *dem, const dem_insert *insert, dem_seed **seed, int64_t *count);
/* *turn: [count][4] attitudes of clumps, zero where the line has none. */
int dem_insert_file(const dem_t *dem, const dem_insert *insert, dem_seed **seed, double **turn,
                    int64_t *count);
/* Next number of a sequence in [0, 1). */
double dem_draw(uint64_t *state);
/* Collective. Content of a file on every rank, ended by a 0; the caller frees. */
int dem_text_share(const dem_t *dem, const char *path, char **text);
/* Numbers of one line, the first `most` into value; # begins a comment. Returns how many there are,
 * -1 when something (*bad) is not a finite number. */
int dem_text_numbers(char *line, int most, double *value, const char **bad);

/* Grid of about `expected` spheres of radii r_min .. r_max for overlap tests, periodic as the box. */
typedef struct dem_grid dem_grid;
int dem_grid_create(const part_box *box, double r_min, double r_max, int64_t expected,
                    dem_grid **grid);
void dem_grid_destroy(dem_grid *grid);
int dem_grid_add(dem_grid *grid, const double x[3], double r);
/* Numbers of the spheres with a gap to x, r of at most `fraction` of the smaller radius, increasing. */
int dem_grid_near(const dem_grid *grid, const double x[3], double r, double fraction,
                  size_t *capacity, int64_t **found, size_t *count);
/* Number of a sphere that x, r overlaps by more than `allowed` of the smaller radius, -1: none. */
int64_t dem_grid_overlap(const dem_grid *grid, const double x[3], double r, double allowed,
                         double *overlap);

#endif
