/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Wear of walls and impacts on particles (Gao and Sun 2011, eq. 12 and 13; doc/equations.md D.19, D.20).
 * Only when a coefficient is given. */
#ifndef DEM_WEAR_H
#define DEM_WEAR_H

#include <stddef.h>

#include "law.h"

/* Sums over own particles, by material of the particle. */
typedef struct dem_wear {
  int shear_asked, impact_asked;
  double *shear;  /* [elements][materials] J; NULL: not asked */
  double *impact; /* [materials] J; NULL: not asked */
} dem_wear;

struct dem_t;
/* Room for what the coefficients ask for; a second call changes nothing. Local. */
int dem_wear_prepare(struct dem_t *dem);
void dem_wear_free(dem_wear *wear);
/* A contact with a wall during the step dt; new: it was not there before. */
void dem_wear_contact(struct dem_t *dem, int element, int material, const dem_touch *touch,
                      const double force[3], int new_contact, double dt);
/* Impacts of particles on each other in the step dt before the present positions. */
void dem_wear_pairs(struct dem_t *dem, double dt);
/* Sums as one array, for files: [elements * materials + materials], missing parts left out. */
size_t dem_wear_size(const struct dem_t *dem);
void dem_wear_pack(const struct dem_t *dem, double *value);
void dem_wear_unpack(struct dem_t *dem, const double *value); /* adds */

#endif
