/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which particles another rank, or this one across a periodic border, needs a copy of.
 *
 * Two spheres meet when they are nearer than r_i + r_j + skin. Every rank tells the box around its
 * own spheres of each level, and the largest radius there. A sphere goes where it may meet one of its
 * own level or of a smaller one: copies of a level fill a layer as thick as its own spheres. Of
 * pairs of a small and a large sphere, the large one's copy then is where the small one is; the
 * small one goes back to where the large one is owned only if it does meet that copy
 * (ghost_partners.c). So a layer as thick as the largest sphere is not filled with small ones. */
#ifndef PART_GHOSTS_H
#define PART_GHOSTS_H

#include "cells.h"
#include "domain.h"
#include "particle/levels.h"

/* Around the own spheres of a level; empty: lo > hi. r: the largest. */
typedef struct level_box {
  part_region box;
  double r;
} level_box;

/* A rank and a periodic image of own particles that may be near it. */
typedef struct ghost_target {
  int rank;
  double shift[3];
} ghost_target;

typedef struct ghost_choice {
  const part_domain *domain;
  const part_store *store;
  part_points points; /* r_stride 0: all alike */
  part_levels levels;
  double skin;        /* m, widened by the rounding of shifted positions */
  level_box *boxes;   /* [ranks][levels] */
  int targets, items; /* targets by rank, then by shift z, y, x; items by own particle, then target */
  ghost_target *target;
  struct ghost_item {
    int particle, target;
  } *item;
  size_t target_room, item_room;
} ghost_choice;

/* Collective. Levels, boxes of all ranks, targets and items by boxes. ERR_RANGE: a periodic
 * direction is shorter than two longest reaches. */
int part_ghost_boxes(ghost_choice *choice);
/* Collective. Adds the small partners of large copies. */
int part_ghost_partners(ghost_choice *choice);
void part_ghost_choice_free(ghost_choice *choice);

static inline double part_ghost_radius(const ghost_choice *c, int i) {
  return c->points.r[(size_t)i * (size_t)c->points.r_stride];
}
static inline const double *part_ghost_place(const ghost_choice *c, int i) {
  return c->points.x + (size_t)i * (size_t)c->points.x_stride;
}
int part_ghost_choice_add(ghost_choice *choice, int particle, int target);

#endif
