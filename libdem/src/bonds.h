/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bonds between particles: what was asked for (rules), the bonds with an own end (links), and the
 * orientations of bonded particles.
 *
 * Both ends carry a bond in the payload (internal.h), in terms of the lower and the higher id, so
 * that two ranks compute with the same numbers: DEM_KEY_BOND with the partner's id and
 *   part 0: rest vector, part 1: {rule, state, 0}, part 2: spring of a broken, pressed bond
 * and, with its own id in place of the partner's, its orientation in parts 0 and 1.
 * Ghosts get orientations from their owners when lists are built, and then turn as the owner does,
 * with the velocity records that every step refreshes. */
#ifndef DEM_BONDS_H
#define DEM_BONDS_H

#include <stddef.h>
#include <stdint.h>

#include "bond_law.h"
#include "dem/dem.h"

enum dem_link_state {
  DEM_LINK_HOLDS,
  DEM_LINK_PRESSED, /* broken, its ends have not been apart since */
  DEM_LINK_GONE     /* an ordinary pair again, when the lists are built */
};

typedef struct dem_bond_rule {
  int a, b; /* materials, -1 -1: all */
  dem_bond bond;
} dem_bond_rule;

/* A bond changed its state on this rank, and the others do not know yet. */
typedef struct dem_bond_event {
  dem_broken_bond broken;
  int64_t state; /* the new one */
} dem_bond_event;

typedef struct dem_bonds {
  int rules;
  dem_bond_rule *rule;
  int links;
  dem_link *link;
  int *start, *item;     /* [local+1], links of each own particle */
  double *q;             /* [local+ghost][4] orientation, unit quaternion (w x y z) */
  int turning;           /* ends of links */
  int *turns;            /* [turning] */
  int stale;             /* a link has gone since the lists were built */
  double widest;         /* m, largest gap of a bond, of all ranks, when last settled */
  double rate;           /* 1/s2, bound of the square of the highest frequency at the start */
  int64_t alive, intact; /* links not gone, and bonds not broken, of all ranks, when last settled */
  int events;
  dem_bond_event *event;
  int64_t broken; /* in all, the same on every rank */
  dem_broken_bond *list;
  dem_bond_state *state; /* for dem_bond_states */
  size_t link_room, item_room, turn_room, event_room, list_room, state_room;
} dem_bonds;

struct dem_t;
struct dem_entry;

void dem_bonds_free(dem_bonds *bonds);

/* ---- bonds_make.c ---------------------------------------------------------------------------- */
/* Bonds between the inserted particles, as kept payload of those of this rank. Collective. */
int dem_bonds_make(struct dem_t *dem);
/* Rule of two materials, -1: none. */
int dem_bond_rule_of(const dem_bonds *bonds, int a, int b);
/* What follows from the rule and the two particles. */
void dem_link_coefs(const struct dem_t *dem, dem_link *link);
/* After the lists were built: the stable step of the bonds. Collective. */
int dem_bonds_step(struct dem_t *dem);

/* ---- bonds_list.c ---------------------------------------------------------------------------- */
/* ERR_FORMAT: the payload has bonds that no rule made. Local. */
int dem_bonds_check(const struct dem_t *dem, const int *count, const void *payload);
/* Orientations from the payload, and of the ghosts. Collective. */
int dem_bonds_orient(struct dem_t *dem, const int *count, const void *payload);
/* Links from the payload. Local. */
int dem_bonds_list(struct dem_t *dem, const int *count, const void *payload);
/* Is there a link between own particle i and particle j? */
int dem_bonds_join(const struct dem_t *dem, int i, int j);

/* ---- bonds_file.c ---------------------------------------------------------------------------- */
struct part_file;
/* Doubles that dem_bonds_write keeps: two and five for each broken bond; 0 without bonds. */
int dem_bonds_values(const struct dem_t *dem);
/* Collective. Widest bond, bound of the frequencies and the list of broken bonds, which are the
 * same on every rank; the bonds themselves are in the payload. */
int dem_bonds_write(const struct dem_t *dem, struct part_file *file);
/* Collective. ERR_FORMAT: the file does not hold `wanted` values, the number that the state names.
 */
int dem_bonds_read(struct dem_t *dem, struct part_file *file, int wanted);

/* ---- bonds.c --------------------------------------------------------------------------------- */
/* Forces and torques of all links, added; orientations go on by dt. */
void dem_bond_forces(struct dem_t *dem, double dt);
/* Collective. What changed on one rank is known to all: list of broken bonds, widest, counts. */
int dem_bonds_settle(struct dem_t *dem);
double dem_bonds_energy(const struct dem_t *dem); /* J, each bond once over all ranks */

#endif
