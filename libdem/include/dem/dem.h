/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libdem: discrete elements. A dem_t holds particles, walls and contact laws, and advances them in
 * time under gravity, contact and a fluid force F = Su - Sp v that whoever couples puts in.
 *
 * SI units. Status returns as in particle/status.h. Calls marked collective are made by all ranks
 * of the communicator together; the others are local. */
#ifndef DEM_DEM_H
#define DEM_DEM_H

#include <mpi.h>
#include <stdint.h>
#include "particle/domain.h"
#include "particle/params.h"
#include "particle/status.h"
#include "particle/store.h"
#include "particle/timers.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- particle quantities: rows in dem/particle_fields.def ----------------------------------- */
enum dem_record {
#define DEM_RECORD(name, type, width) DEM_RECORD_##name,
#define DEM_FIELD(name, key, record, offset, comps, flags, unit, meaning)
#include "dem/particle_fields.def"
#undef DEM_RECORD
#undef DEM_FIELD
  DEM_RECORD_COUNT
};
enum dem_field {
#define DEM_RECORD(name, type, width)
#define DEM_FIELD(name, key, record, offset, comps, flags, unit, meaning) DEM_FIELD_##name,
#include "dem/particle_fields.def"
#undef DEM_RECORD
#undef DEM_FIELD
  DEM_FIELD_COUNT
};
extern const part_layout dem_layout;

/* How a particle moves (field KIND). */
typedef enum {
  DEM_FREE = 0,  /* by its own forces */
  DEM_FIXED = 1, /* not at all: its support takes every force */
  DEM_BLOCK = 2, /* with its block: one translation, no rotation (field BLOCK numbers the block) */
  DEM_CLUMP = 3  /* with its clump: a rigid body that turns (field BLOCK numbers the clump) */
} dem_kind;

/* ---- parameters: rows in dem/<name>_params.def ---------------------------------------------- */
typedef struct dem_params {
  double gravity[3];         /* m/s2 */
  double ramp_time;          /* s; Markauskas et al. 2017 eq. 3-4; 0: no ramp */
  double ramp_fluid_density; /* kg/m3, rho_f of eq. 3; needed with ramp_time > 0 */
  double time_step_fraction; /* of the shortest contact time, default 1/50 */
  double impact_speed;       /* m/s, of the hardest impact expected; 0: worked out by dem_start */
  double skin_fraction;      /* Verlet skin over the mean radius, to begin with */
  double max_overlap;        /* of the smaller radius: ERR_OVERLAP at insertion, reported later */
  int64_t dimensions;        /* 3: spheres; 2: discs in a plane of constant z */
  double depth;              /* m, length of discs; positive with two dimensions, else 0 */
  double balance_ratio; /* repartition when the largest cost of a rank over the mean exceeds it */
  int64_t first_id;     /* of the first particle inserted; up to 2^47 */
  int skip;             /* 1: leave out what the scene does not need (scene plan) */
} dem_params;
extern const part_param_table dem_params_table;

/* One material. */
typedef struct dem_material {
  char name[PART_PARAM_WORD_LENGTH];
  double density;        /* kg/m3 */
  double youngs_modulus; /* Pa; 0: not given */
  double poisson_ratio;  /* NaN: not given; needed with youngs_modulus */
  double
      breakage_coefficient; /* kg/J, C_br of Gao and Sun 2011 eq. 13; 0: impacts are not counted */
} dem_material;
extern const part_param_table dem_material_table;

/* Contact of two materials; begin with part_params_default(&dem_contact_table, ...). */
typedef struct dem_contact {
  int law;                 /* row of dem/contact_laws.def */
  double normal_stiffness; /* N/m; NaN: not given */
  double tangential_ratio; /* k_t/k_n; NaN: not given */
  double restitution;      /* (0, 1]; damping is derived from it */
  double friction;         /* Coulomb coefficient, >= 0 */
  double rolling_friction; /* largest rolling moment over (reduced radius x normal force), >= 0 */
  double work_of_adhesion; /* J/m2, >= 0 */
  double wear_coefficient; /* m3/J, C_wr of Gao and Sun 2011 eq. 12, of the wall; 0: not counted */
} dem_contact;
extern const part_param_table dem_contact_table;

/* Linear parallel bonds between particles of two materials (doc/equations.md, B.1 to B.10; Wu et
 * al. 2018, sec. 3.2). */
typedef struct dem_bond {
  double normal_stiffness;    /* N/m3, per area; with the next, or 0 and youngs_modulus > 0 */
  double shear_stiffness;     /* N/m3 */
  double youngs_modulus;      /* Pa */
  double poisson_ratio;       /* with youngs_modulus */
  double radius_fraction;     /* radius of the bond over the smaller radius */
  double tensile_strength;    /* Pa; infinite: it never breaks so */
  double shear_strength;      /* Pa */
  double moment_contribution; /* 0 to 1, of bending and twist to the stress that breaks it */
  double damping;             /* damping ratio */
  double gap_fraction;        /* pairs with a smaller gap over the smaller radius are bonded */
} dem_bond;
extern const part_param_table dem_bond_table;

/* Lubrication between spheres, or discs: Wu et al. 2018, eq. 24 (doc/equations.md, B.11 to B.13).
 */
typedef struct dem_lubrication {
  double viscosity; /* Pa s, of the fluid */
  double inner_gap; /* m, roughness: below it the force grows no more */
  double cut_off;   /* gap above which there is none, over the harmonic mean of the diameters */
} dem_lubrication;
extern const part_param_table dem_lubrication_table;

/* Insertion of particles. */
typedef enum { DEM_INSERT_LATTICE, DEM_INSERT_RANDOM, DEM_INSERT_FILE } dem_insert_method;
typedef enum { DEM_ORIENTATION_RANDOM, DEM_ORIENTATION_AS_IN_FILE } dem_orientation;
typedef struct dem_insert {
  int method; /* lattice | random | file */
  int kind;   /* free | fixed | block | clump */
  char material[PART_PARAM_WORD_LENGTH];
  double diameter;         /* m; lattice and random; clump: of the sphere of equal volume, 0: as in
                              the shape file */
  double diameter_max;     /* m; random: uniform between diameter and this; default: diameter */
  double origin[3];        /* m; lattice: centre of the first particle; random: lower corner */
  double spacing[3];       /* m; lattice */
  double count[3];         /* lattice: numbers per direction, whole */
  double extent[3];        /* m; random: size of the box (spheres lie fully inside) */
  double rotation_axis[3]; /* lattice: turned about origin by angle; default none */
  double rotation_angle;   /* rad */
  int64_t number;          /* random */
  int64_t seed;            /* random */
  double velocity[3];      /* m/s */
  double angular_velocity[3];         /* rad/s; free and clump */
  char shape[PART_PARAM_WORD_LENGTH]; /* clump: path of a shape file, see dem_get_clump_shape */
  int orientation;                    /* clump: random | asInFile; random goes by seed */
  char file[PART_PARAM_WORD_LENGTH];  /* file: text, one particle a line: x y z d [vx vy vz], #
                                         comments; clump: centre of mass, d as diameter, and may end
                                         with qw qx qy qz, axes of the shape file to space */
} dem_insert;
extern const part_param_table dem_insert_table;

/* A wall and its motion: rows of dem/wall_params.def say what belongs to what. The place of a
 * moving wall is a function of time alone: s = min(max(t, start_time), stop_time) - start_time,
 * displacement velocity s + amplitude sin(2 pi frequency s) direction, angle rotation_rate s. */
typedef enum { DEM_WALL_PLANE, DEM_WALL_CYLINDER, DEM_WALL_TRIANGLES, DEM_WALL_STL } dem_wall_type;
typedef enum { DEM_WALL_INSIDE, DEM_WALL_OUTSIDE } dem_wall_side;
typedef struct dem_wall_params {
  int type;
  char material[PART_PARAM_WORD_LENGTH];
  double point[3], normal[3]; /* m, 1 */
  double axis[3], radius;     /* 1, m */
  int side;
  double length; /* m */
  char file[PART_PARAM_WORD_LENGTH];
  double scale; /* m */
  int open;
  double velocity[3], centre[3];                          /* m/s, m */
  double rotation_axis[3], rotation_rate;                 /* 1, rad/s */
  double oscillation_amplitude, oscillation_frequency;    /* m, Hz */
  double oscillation_direction[3], start_time, stop_time; /* 1, s */
} dem_wall_params;
extern const part_param_table dem_wall_table;

/* ---- life ----------------------------------------------------------------------------------- */
typedef struct dem_t dem_t;

/* Collective. Copies params and box, duplicates comm. */
int dem_create(MPI_Comm comm, const part_box *box, const dem_params *params, dem_t **dem);
void dem_destroy(dem_t *dem);

/* Materials get numbers 0, 1, ... in the order they are added; names are unique. */
int dem_add_material(dem_t *dem, const dem_material *material, int *number);
int dem_find_material(const dem_t *dem, const char *name, int *number); /* error: nearest name */
int dem_material_count(const dem_t *dem);
const char *dem_material_name(const dem_t *dem, int number); /* NULL: no such material */
/* Contact of a pair of materials (both orders); a pair without one uses that of (-1, -1). ERR_RANGE
 * when it gives what its law does not use; what it lacks is found by dem_start. */
int dem_set_contact(dem_t *dem, int a, int b, const dem_contact *contact);

/* Bonds between all pairs of particles of materials a and b (-1 and -1: any; a particular rule goes
 * before the general one) that are near enough when dem_start is called; ERR_RANGE there when there
 * is none. Not between fixed particles or members of one block; members of
 * clumps near enough are ERR_RANGE. A bonded pair has no contact; when
 * its bond breaks it is an ordinary pair, once it is not pressed together any more. With dem_read
 * the bonds come from the file, but the rules must be given again, in the same order. */
int dem_add_bonds(dem_t *dem, int a, int b, const dem_bond *bond);

/* Lubrication between all particles that are not in contact, not to walls. */
int dem_set_lubrication(dem_t *dem, const dem_lubrication *lubrication);

/* Collective. A wall, known by its name; the materials are there. Triangles [count][3][3] (m, the
 * same on every rank, in any order) for type triangles, 0 and NULL otherwise. The elements of a
 * wall are numbered as its triangles were given; files do not depend on that order. ERR_RANGE,
 * ERR_ARGUMENT, ERR_IO, ERR_FORMAT: the text names the wall and the entry, or what is wrong with
 * the STL file (line, triangle, edge).
 *
 * In a periodic box a plane, and a cylinder with particles inside, go on through the border: the
 * normal is at right angles to every periodic direction, the axis along it. Other walls are seen
 * again one box length away, and move on without end. A wall turns only about an axis along the one
 * periodic direction; a plane only about its normal, an infinite cylinder about its own direction.
 */
int dem_add_wall(dem_t *dem, const char *name, const dem_wall_params *params, int count,
                 const double *vertices);
/* Short forms for walls at rest. Local. normal points to the side where particles are. */
int dem_add_plane(dem_t *dem, const char *name, int material, const double point[3],
                  const double normal[3]);
int dem_add_triangles(dem_t *dem, const char *name, int material, int count,
                      const double *vertices);

/* Collective. Insert; ids go on from the largest so far. ERR_OVERLAP: the text names two ids (or a
 * wall) and the overlap; ERR_OUTSIDE: outside the box. block: number for kind block. Clumps are
 * numbered 0, 1, ... as they come; *inserted counts their spheres. */
int dem_insert_particles(dem_t *dem, const dem_insert *insert, int block, int64_t *inserted);

/* A shape of clumps: a text file with one sphere a line, x y z diameter (m), # comments. Mass
 * properties are those of the union of the spheres (to 1e-10 of volume and size), or given by lines
 * `volume V`, `centre x y z`, `inertia xx yy zz xy xz yz` (m3, m, m5), all three. */
typedef struct dem_clump_shape_report {
  int spheres;
  double volume;       /* m3 */
  double centre[3];    /* m, centre of mass, axes of the file */
  double inertia[6];   /* m5, tensor xx yy zz xy xz yz over density about the centre, same axes */
  double principal[3]; /* m5, principal moments over density; the third differs most */
  double bound;        /* m, reach of the spheres from the centre of mass */
} dem_clump_shape_report;
/* Collective. ERR_IO, ERR_FORMAT, ERR_RANGE (empty, sphere of no size, spheres that do not hang
 * together without given mass properties, moments that no body has). */
int dem_get_clump_shape(dem_t *dem, const char *path, dem_clump_shape_report *report);

/* Local, the same on every rank; after the materials, before insertion or dem_read. Free spheres
 * have the inertia of so much more density (kg/m3, >= 0): the virtual mass of a fluid around them.
 * Contacts, fluid forces and kicks move it, INVERSE_MASS and momentum contain it; weight, spin and
 * kinetic energy do not. ERR_RANGE here, or in dem_start with blocks or clumps, whose added mass
 * has another form. */
int dem_add_mass(dem_t *dem, double density);
/* Share of the inertia of a material that is its own, 1 without dem_add_mass. */
double dem_own_share(const dem_t *dem, int material);

/* Collective. Once after all of the above: distributes, sorts, lists, works out the plan. */
int dem_start(dem_t *dem);

/* ---- running -------------------------------------------------------------------------------- */
/* Contact: two particles touch unless both are fixed or belong to one block or clump. Contact
 * force, torque and history are described in doc/equations.md and libdem/src/laws. Between rebuilds
 * of the neighbour lists positions may lie outside a periodic box by up to half the skin (one mean
 * radius when nothing can touch), spheres of a clump by its size besides: part_box_wrap brings a
 * copy inside.
 *
 * Collective. Advance by dt (s) in equal substeps no longer than the stable one, except that those
 * in which no contact can begin are taken as one (unless skip is off). *substeps (may be NULL): how
 * many were taken. The order of own particles may change (migration, sorting): ask dem_store and
 * its records again. ERR_NUMERIC, ERR_OUTSIDE: the text names id, place and time. */
int dem_advance(dem_t *dem, double dt, int *substeps);

/* The particles. Fluid force of own particle i: fields FLUID_SU (N) and FLUID_SP (kg/s), constant
 * over dem_advance; field FLUID_IMPULSE (N s) is what the particle received from it, summed over
 * the substeps of the last dem_advance to round-off: sum m dv = contact + gravity + this. */
part_store *dem_store(dem_t *dem);
/* Vectors that each particle carries for its user (the coupling's memory of forces): they are zero
 * at first, then go wherever their particle goes, also to another rank and through restart files,
 * and libdem does not look at them. dem_carry before dem_start, the same on every rank; dem_carried
 * is [own particles][vectors][3] in the present order (dem_generation), NULL before dem_start. */
int dem_carry(dem_t *dem, int vectors);
double *dem_carried(dem_t *dem);
/* Counts calls that changed the order of own particles, for caches outside. */
long long dem_generation(const dem_t *dem);

/* Local. Spin of free spheres relaxes for dt towards turn[0..2] (1/s) of turn[own particles][4], by
 * the torque turn[3] (N m s, >= 0) times the difference, in closed form. Other kinds are left
 * alone. */
int dem_relax_spin(dem_t *dem, const double *turn, double dt);
/* Add impulse[3*i] (N s) to own particle i at once: dv = impulse/m (blocks: sum over all members,
 * collective; clumps: at the member's centre, so the clump turns; fixed: to the support). Counts as
 * fluid impulse in the budget. Field VELOCITY_ENDED keeps the velocity before the first kick after an
 * advance. Collective. */
int dem_kick(dem_t *dem, const double *impulse);

double dem_time(const dem_t *dem); /* s, since the start of the simulation */
/* Walls that move go to where they are then. */
void dem_set_time(dem_t *dem, double time);
double dem_stable_step(const dem_t *dem); /* s; infinite when nothing can touch */

typedef struct dem_report {
  int64_t particles, contacts, wall_contacts; /* particles: spheres, those of clumps one by one */
  int64_t clumps;
  double max_overlap;    /* of the smaller radius */
  double max_speed;      /* m/s */
  double kinetic_energy; /* J */
  double momentum[3];    /* kg m/s, of free particles, blocks and clumps */
  /* impulses since the start (N s); momentum - initial momentum = gravity + fluid + walls +
   * contact with fixed particles, to round-off */
  double gravity_impulse[3], fluid_impulse[3], wall_impulse[3], support_impulse[3];
  /* |momentum change - impulses| over the largest of them and of sum m|v|. Fixed particles are not
   * in the budget: what they get, from the fluid too, goes to their support. */
  double budget_error;
  long long substeps, rebuilds;
  double
      load_ratio; /* largest cost of a rank over the mean, when lists were built last; 1 rank: 0 */
  int64_t bonds, broken_bonds; /* intact, broken since the beginning */
  double bond_energy;          /* J, elastic */
} dem_report;
/* Collective. */
int dem_get_report(dem_t *dem, dem_report *report);

/* Own particles as a fluid sees them (equations R.8), [local] m each: the sphere whose volume the
 * particle takes up, and the sphere whose drag law it follows. Both are its own radius, but for
 * members of clumps: those share the volume of the union by the volumes of the spheres, and the
 * second is the sphere of the clump's volume. ERR_STATE before dem_start. Local. */
int dem_fluid_spheres(const dem_t *dem, double *volume_radius, double *drag_radius);

/* An intact bond between particles a and b, a < b. */
typedef struct dem_bond_state {
  int64_t a, b;
  int rule;                            /* number of the dem_add_bonds call, from 0 */
  double arm[3];                       /* m, from a to b */
  double force[3];                     /* N, elastic, on b */
  double moment[3];                    /* N m, elastic, on b about the contact point */
  double tensile_stress, shear_stress; /* Pa, Wu et al. 2018 eq. 37-38; break at the strengths */
} dem_bond_state;
/* Those whose particle a is an own one. Valid until the next call that moves particles. Local. */
int dem_bond_states(dem_t *dem, const dem_bond_state **states, size_t *count);

typedef enum { DEM_BROKEN_BY_TENSION, DEM_BROKEN_BY_SHEAR } dem_break_mode;
typedef struct dem_broken_bond {
  int64_t a, b, mode;
  double time;   /* s */
  double stress; /* Pa */
} dem_broken_bond;
/* All that broke, by time and ids, the same on every rank. Valid until the next dem_advance. */
int dem_broken_bonds(const dem_t *dem, const dem_broken_bond **bonds, size_t *count);

/* ---- what walls feel --------------------------------------------------------------------------
 */
int dem_wall_count(const dem_t *dem); /* numbers 0, 1, ... in the order they were added */
int dem_find_wall(const dem_t *dem, const char *name, int *number); /* error: nearest name */

typedef struct dem_wall_report {
  const char *name; /* valid as long as dem */
  int elements;
  double centre[3];       /* m, now */
  double velocity[3];     /* m/s, of centre, now */
  double spin[3];         /* rad/s */
  double force[3];        /* N, of particles on the wall, now */
  double torque[3];       /* N m, about centre, now */
  double impulse[3];      /* N s, of force since the start */
  double spin_impulse[3]; /* N m s, of torque since the start */
  double work;            /* J, done by the moving wall on particles since the start */
} dem_wall_report;
/* Collective. The impulses of all walls together are -wall_impulse of dem_report to round-off. */
int dem_get_wall_report(dem_t *dem, int wall, dem_wall_report *report);

/* Wear (Gao and Sun 2011, eq. 12), with a wear_coefficient in some contact. Collective. For each
 * element of a wall as given (dem_wall_report.elements of them): shear[elements][materials], energy
 * (J) that particles of each material left on it since the start; volume[elements] (m3) worn off;
 * area[elements] (m2), infinite for what has no end: volume/area is the thickness. Any may be NULL.
 */
int dem_get_wear(dem_t *dem, int wall, double *shear, double *volume, double *area);

/* Is wear counted, are impacts? Known from dem_start on. Local. */
void dem_wear_counted(const dem_t *dem, int *shear, int *impacts);

typedef struct dem_impact {
  double
      energy;  /* J, m_eff v_n^2/2 of all impacts since the start; of two particles half to each */
  double mass; /* kg, of the particles now */
  double breakage; /* eq. 13: C_br energy/mass */
} dem_impact;
/* Breakage (eq. 13) of the particles of a material, with a breakage_coefficient in some material.
 * Collective. */
int dem_get_impact(dem_t *dem, int material, dem_impact *impact);

/* Position (m, of the mean of the members, unwrapped) and velocity (m/s) of a block. Collective. */
int dem_block_state(dem_t *dem, int block, double position[3], double velocity[3]);
/* After dem_start. Blocks have the numbers below the count; one without members has no mass. */
int dem_block_count(const dem_t *dem);
double dem_block_mass(const dem_t *dem, int block); /* kg */

/* State of a clump, on every rank; ERR_RANGE: there is none of this number. Collective. */
typedef struct dem_clump_report {
  int64_t members;
  double mass;                /* kg */
  double position[3];         /* m, centre of mass, in the box when the lists were built */
  double velocity[3];         /* m/s */
  double attitude[4];         /* unit quaternion w x y z, principal to space axes */
  double angular_velocity[3]; /* rad/s, space axes */
  double angular_momentum[3]; /* kg m2/s, about the centre of mass, space axes */
  double inertia[3];          /* kg m2, principal */
} dem_clump_report;
int dem_clump_state(dem_t *dem, int64_t clump, dem_clump_report *report);

/* The scene plan as text lines "what | why | saves". Local. */
int dem_plan_text(const dem_t *dem, size_t size, char *text);
/* One line: the stable step and where it comes from. Local. */
int dem_step_text(const dem_t *dem, size_t size, char *text);
part_timers *dem_timers(dem_t *dem);

/* ---- files ---------------------------------------------------------------------------------- */
/* Collective. Write the particles (VTKHDF, with everything restart needs). The state in memory is
 * brought into the canonical form a restart would find (sorted, lists rebuilt), so that going on
 * and restarting are the same computation bit for bit. series: see part_file_commit. */
int dem_write(dem_t *dem, const char *path, const char *series);
/* Collective. In place of insertion, before dem_start. */
int dem_read(dem_t *dem, const char *path);

#ifdef __cplusplus
}
#endif
#endif
