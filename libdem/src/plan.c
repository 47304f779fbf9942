/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The scene plan: what is there, what can touch, what can be left out, and the stable step. */
#include <stdio.h>

#include "internal.h"

/* What one material is part of, over all ranks. */
typedef struct presence {
  double free, fixed, blocks; /* numbers of bodies; fixed particles are one body; clumps are free */
  double light[2];            /* 1/kg, the two largest inverse masses of movable spheres */
} presence;

typedef struct scene {
  double free, fixed, blocks, clumps, r_max, r_sum, r_min, v_max;
  presence *of; /* [materials] */
} scene;

static void take_light(presence *p, double inverse_mass) {
  if (inverse_mass > p->light[0]) {
    p->light[1] = p->light[0];
    p->light[0] = inverse_mass;
  } else if (inverse_mass > p->light[1]) {
    p->light[1] = inverse_mass;
  }
}

/* Clumps count once, with their first member, whose payload has the lightest contact of all. */
static void survey_clump(presence *p, scene *s, int n, const dem_entry *entry) {
  const double light = dem_clump_light(n, entry);
  if (!(light > 0.0))
    return;
  take_light(p, light);
  p->free++;
  s->free++;
  s->clumps++;
}

/* Own particles; blocks are known everywhere and are counted by join_ranks. */
static void survey_own(const dem_t *dem, scene *s) {
  const dem_entry *entry = dem->kept;
  for (int i = 0; i < dem->store->local; i++) {
    const int entries = dem->kept_count != NULL ? dem->kept_count[i] : 0;
    const double r = dem_xr(dem)[DEM_XR * (size_t)i + 3];
    presence *p = &s->of[dem_material_of(dem, i)];
    s->r_sum += r;
    s->r_max = fmax(s->r_max, r);
    s->r_min = fmin(s->r_min, r);
    const double *v = dem_vm(dem) + DEM_VM * (size_t)i;
    s->v_max = fmax(s->v_max, sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]));
    if (dem_kind_of(dem, i) == DEM_FIXED) {
      p->fixed = s->fixed = 1.0;
    } else if (dem_kind_of(dem, i) == DEM_CLUMP) {
      survey_clump(p, s, entries, entry);
    } else {
      /* Any number of a block's members may touch at once, so each stands for its own mass. */
      take_light(p, 1.0 / dem_own_mass(dem, i));
      p->free += dem_kind_of(dem, i) == DEM_FREE;
      s->free += dem_kind_of(dem, i) == DEM_FREE;
    }
    if (entry != NULL)
      entry += entries;
  }
}

static int join_ranks(const dem_t *dem, scene *s, double *all) {
  const int n = dem->materials;
  double sums[3] = {s->free, s->r_sum, s->clumps};
  double most[4] = {s->fixed, s->r_max, -s->r_min, s->v_max};
  MPI_Allgather(s->of, (int)sizeof(presence) * n, MPI_BYTE, all, (int)sizeof(presence) * n,
                MPI_BYTE, dem->comm);
  MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPI_DOUBLE, MPI_SUM, dem->comm);
  MPI_Allreduce(MPI_IN_PLACE, most, 4, MPI_DOUBLE, MPI_MAX, dem->comm);
  *s = (scene){.free = sums[0],
               .fixed = most[0],
               .clumps = sums[2],
               .r_max = most[1],
               .r_sum = sums[1],
               .r_min = -most[2],
               .v_max = most[3],
               .of = s->of};
  memset(s->of, 0, (size_t)n * sizeof *s->of);
  for (int k = 0; k < n * dem->ranks; k++) {
    presence *p = &s->of[k % n], q;
    memcpy(&q, all + (size_t)k * (sizeof q / sizeof *all), sizeof q);
    p->free += q.free;
    p->fixed = fmax(p->fixed, q.fixed);
    take_light(p, q.light[0]);
    take_light(p, q.light[1]);
  }
  for (int b = 0; b < dem->blocks; b++) {
    s->blocks += dem->block[b].members > 0;
    for (int m = 0; m < n; m++)
      s->of[m].blocks += dem->block_gravity[b * n + m] > 0.0;
  }
  return PART_OK;
}

static int survey(const dem_t *dem, scene *s) {
  double *all;
  PART_TRY(part_agree(dem->comm,
                      dem_allocate((size_t)(dem->materials * dem->ranks), sizeof(presence), &all)));
  survey_own(dem, s);
  const int status = join_ranks(dem, s, all);
  free(all);
  return status;
}

/* Coefficients and shortest time of the contacts that can happen; least: of motions of walls. */
static int walk_contacts(dem_t *dem, const scene *s, int pairs, double *least) {
  const int all = !dem->params.skip;
  for (int a = 0; a < dem->materials; a++)
    for (int b = 0; b <= a; b++) {
      const presence *p = &s->of[a], *q = &s->of[b];
      const double bodies = p->free + p->fixed + p->blocks, others = q->free + q->fixed + q->blocks;
      const int can = pairs && (a == b ? bodies >= 2.0 : bodies > 0.0 && others > 0.0);
      const int moves = p->light[0] + q->light[0] > 0.0;
      if (!moves || !(can || all))
        continue;
      PART_TRY(dem_materials_pair(dem, a, b, can));
      dem_materials_time(dem, a, b, p->light[0], a == b ? p->light[1] : q->light[0]);
    }
  for (int w = 0; w < dem->walls.count; w++) {
    PART_TRY(dem_wall_fits(dem, &dem->walls.wall[w], least));
    for (int a = 0; a < dem->materials; a++) {
      const int b = dem->walls.wall[w].material;
      if (!(s->of[a].light[0] > 0.0))
        continue;
      PART_TRY(dem_materials_pair(dem, a, b, 1));
      dem_materials_time(dem, a, b, s->of[a].light[0], 0.0);
    }
  }
  return PART_OK;
}

/* Only spheres, planes and cylinders: what a wide skin costs are pairs. */
static int has_triangles(const dem_t *dem) {
  int any = 0;
  for (int e = 0; e < (int)dem->walls.elements; e++)
    any |= dem->walls.element[e].shape == DEM_SHAPE_TRIANGLE;
  return any;
}

static double fit_skin(const dem_t *dem, double skin) {
  for (int c = 0; c < 3; c++)
    if (dem->box.periodic[c])
      skin = fmin(skin, 0.49 * (dem->box.hi[c] - dem->box.lo[c]) - 2.0 * dem->r_max -
                            fmax(dem->bonds.widest, dem->film.range));
  return skin;
}

/* First skin, and the largest: a fifth of a diameter, four in dilute scenes, whose particles fly
 * far; less where a periodic box is too short for ghosts that far. A restart goes on with the skin
 * it had. */
static void set_skin(dem_t *dem, int clumps) {
  const double first = dem->params.skin_fraction * dem->r_mean;
  const int simple =
      !clumps && !has_triangles(dem) && dem->film.range == 0.0 && dem->bonds.widest == 0.0;
  dem->skin_most = fmax(fit_skin(dem, 0.4 * dem->r_mean), first);
  dem->skin_wide = simple ? fmax(fit_skin(dem, 8.0 * dem->r_mean), first) : dem->skin_most;
  if (!dem->restored || !dem->params.skip)
    dem->skin = first;
  dem->substeps_built = dem->substeps;
}

static int work_out(dem_t *dem, const scene *s) {
  dem_plan *plan = &dem->plan;
  const int all = !dem->params.skip, movable = s->free + s->blocks > 0.0;
  const int pairs = movable && s->free + s->blocks + s->fixed >= 2.0;
  double least = HUGE_VAL;
  dem->r_max = s->r_max;
  dem->r_min = s->r_min;
  part_levels_set(&dem->levels, dem->r_min, dem->r_max);
  if (!dem->restored) /* a sum over ranks has other bits on other ranks: the file has it */
    dem->r_mean = s->r_sum / (double)dem->total;
  plan->lubrication = dem->film.given && (pairs || all);
  PART_TRY(dem_film_plan(dem));
  set_skin(dem, s->clumps > 0.0);
  plan->bonds = dem->bonds.rules > 0;
  plan->rolling = plan->cohesion = all;
  plan->tangential = all || plan->bonds;
  dem->contact_time = HUGE_VAL;
  PART_TRY(dem_materials_begin(dem, s->v_max));
  PART_TRY(walk_contacts(dem, s, pairs, &least));
  dem->stable_step = dem->params.time_step_fraction * fmin(least, dem->contact_time);
  plan->pairs = pairs || all;
  plan->walls = dem->walls.count > 0 && (movable || all);
  plan->horizon = !all;
  plan->blocks = s->blocks > 0.0;
  plan->clumps = s->clumps > 0.0;
  plan->all_free = s->fixed + s->blocks + s->clumps == 0.0;
  plan->movable = movable;
  return PART_OK;
}

int dem_make_plan(dem_t *dem) {
  scene s = {.r_min = HUGE_VAL};
  int status = dem_allocate((size_t)dem->materials, sizeof *s.of, &s.of);
  PART_TRY(part_agree(dem->comm, status));
  status = survey(dem, &s);
  if (status == PART_OK)
    status = work_out(dem, &s);
  free(s.of);
  return part_agree(dem->comm, status);
}

static int add_line(size_t size, char *text, const char *what, const char *why, const char *saves) {
  const size_t used = strlen(text);
  const int n = snprintf(text + used, size - used, "%s | %s | %s\n", what, why, saves);
  return n >= 0 && (size_t)n < size - used
             ? PART_OK
             : part_fail(PART_ERR_RANGE, "the scene plan needs more than %zu characters", size);
}

int dem_plan_text(const dem_t *dem, size_t size, char *text) {
  const dem_plan *plan = &dem->plan;
  if (size == 0)
    return part_fail(PART_ERR_RANGE, "the scene plan needs room");
  text[0] = '\0';
  if (!dem->started)
    return part_fail(PART_ERR_STATE, "dem_plan_text comes after dem_start");
  if (!dem->params.skip)
    return add_line(size, text, "nothing skipped", "skip is off", "-");
  if (!plan->tangential)
    PART_TRY(add_line(size, text, "rotation and tangential history", "no friction in any contact",
                      "half of the contact law, 24 bytes a pair"));
  if (!plan->rolling)
    PART_TRY(add_line(size, text, "rolling resistance", "no rollingFriction in any contact",
                      "a third of the contact law, 24 bytes a pair"));
  if (!plan->cohesion)
    PART_TRY(add_line(size, text, "cohesion", "no workOfAdhesion in any contact",
                      "a few operations a pair"));
  if (!plan->pairs)
    PART_TRY(add_line(size, text, "neighbour lists and ghosts",
                      plan->movable ? "one body alone" : "nothing moves", "all of pair contact"));
  if (!plan->walls)
    PART_TRY(add_line(size, text, "wall contact",
                      plan->movable ? "there are no walls" : "nothing moves",
                      "all of wall contact"));
  else
    PART_TRY(add_line(
        size, text,
        dem->walls.moving ? "walls, some moving, for far particles" : "walls for far particles",
        "no wall within the skin when lists were built", "wall contact of these particles"));
  if (!plan->movable)
    PART_TRY(add_line(size, text, "time integration", "nothing moves", "all of it"));
  else if (isinf(dem->stable_step))
    PART_TRY(
        add_line(size, text, "contact substeps", "nothing can touch", "one substep an advance"));
  else if (!plan->bonds)
    PART_TRY(add_line(size, text, "contact substeps before a contact can happen",
                      "bound on gap over closing speed", "all but one of these substeps"));
  return PART_OK;
}
