/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a contact law sees of a contact, and what it keeps per pair of materials. */
#ifndef DEM_LAW_H
#define DEM_LAW_H

#include <math.h>
#include "dem/dem.h"
#include "vec.h"

/* Coefficients of a pair of materials, derived from dem_contact by the law. */
typedef struct dem_coefs {
  int law;                /* row of contact_laws.def, -1: the pair has no contact given */
  double tangential_mass; /* of m_eff: 2/7 of spheres, 1/3 of discs; set before the law's coefs */
  double k_n, k_t;        /* N/m */
  double c_n, c_t;        /* as the law needs them */
  double mu;
} dem_coefs;

/* The same for the pairs of all lanes. */
typedef struct dem_lane_coefs {
  vec k_n, k_t, c_n, c_t, mu;
} dem_lane_coefs;

/* Two bodies that touch, as the first one (i) sees it. */
typedef struct dem_touch {
  vec n[3];         /* unit vector from the partner to i */
  vec overlap;      /* m, > 0 */
  vec v[3];         /* m/s, surface velocity of i minus that of the partner, at the contact point */
  vec root_mass;    /* kg^1/2, sqrt(m_eff), 1/m_eff = 1/m_i + 1/m_j */
  vec inverse_root; /* one over it */
  vec_mask touches; /* other lanes may hold anything */
} dem_touch;

#endif
