/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lubrication: what was asked for, and the list of pairs near enough. */
#ifndef DEM_LUBRICATION_H
#define DEM_LUBRICATION_H

#include "dem/dem.h"
#include "particle/neighbours.h"

typedef struct dem_film {
  int given;
  dem_lubrication params;
  double range;      /* m, largest gap with a force; 0: there is none */
  part_pairs *pairs; /* gaps up to that of the pair and the skin */
} dem_film;

struct dem_t;
void dem_film_free(dem_film *film);
/* Range, once radii and dem->plan.lubrication are known. ERR_RANGE: innerGap is too large. */
int dem_film_plan(struct dem_t *dem);
int dem_film_list(struct dem_t *dem);
/* Forces of all films, added; dt (s): of the step, 0: at the start. */
void dem_film_forces(struct dem_t *dem, double dt);
/* Smallest way (m) that a listed pair has to go until there is a force; negative: there is one. */
double dem_film_gap(const struct dem_t *dem);

#endif
