/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a contact law is given, and what it says. A law is the normal force and the tangential
 * stiffness; the springs that follow from them are in contact_force.h, once for all laws. */
#ifndef DEM_LAW_H
#define DEM_LAW_H

#include <math.h>
#include "dem/dem.h"
#include "particle/lanes.h"

/* Parts of a contact that a scene may do without; rolling needs sliding. Loops are stamped for the
 * six combinations. */
enum { DEM_SLIDING = 1, DEM_ROLLING = 2, DEM_COHESION = 4, DEM_PARTS = 8 };

#define DEM_VARIANTS(X, name)                                                                      \
  X(name, 0)                                                                                       \
  X(name, 1) X(name, 3) X(name, 4) X(name, 5) X(name, 7)

/* History of a pair: 3 doubles for the tangential spring (m), then 3 for that of rolling (m). */
enum { DEM_SPRING = 3, DEM_HISTORY = 6 };
#define DEM_HISTORY_WIDTH(parts)                                                                   \
  ((parts)&DEM_ROLLING ? DEM_HISTORY : (parts)&DEM_SLIDING ? DEM_SPRING : 0)

/* What the coefficients of a pair of materials are worked out from. */
typedef struct dem_pairing {
  const dem_contact *contact;
  const dem_material *material[2];
  double tangential_mass; /* of m_eff, when surfaces slide: 2/7 of spheres, 1/3 of discs */
  double radius;          /* m, mean of the scene */
  double speed;           /* m/s, of the hardest impact that is expected; 0: not known */
} dem_pairing;

/* Coefficients of a pair of materials. */
typedef struct dem_coefs {
  int law;                   /* row of contact_laws.def, -1: the pair has no contact given */
  double k_n, k_t, c_n, c_t; /* as the law needs them */
  double mu, mu_roll;        /* limits of tangential force and of rolling, over the normal force */
  double pull;               /* N/m, attraction over the reduced radius */
  double tangential_mass;    /* as in dem_pairing; of rolling: t/(1 - t), 2/5 and 1/2 */
} dem_coefs;

/* The same for the pairs of all lanes. */
typedef struct dem_lane_coefs {
  vec k_n, k_t, c_n, c_t, mu, mu_roll, pull;
  double tangential_mass; /* of all */
} dem_lane_coefs;

/* Two bodies that touch, as the first one (i) sees it. */
typedef struct dem_touch {
  vec n[3];         /* unit vector from the partner to i */
  vec overlap;      /* m, > 0 */
  vec v[3];         /* m/s, surface velocity of i minus that of the partner, at the contact point */
  vec spin[3];      /* rad/s, angular velocity of i minus that of the partner; rolling only */
  vec radius;       /* m, reduced: 1/R = 1/r_i + 1/r_j; a wall has none */
  vec root_mass;    /* kg^1/2, sqrt(m_eff), 1/m_eff = 1/m_i + 1/m_j */
  vec inverse_root; /* one over it */
  vec_mask touches; /* other lanes may hold anything */
} dem_touch;

/* What a law says. */
typedef struct dem_response {
  vec force;    /* N, along n: > 0 drives them apart */
  vec share;    /* part of the attraction in it */
  vec since;    /* s, how long of the last step the contact existed */
  vec k_t, c_t; /* N/m, kg/s, of the tangential spring now */
  /* Factors on the spring of before and on its stretch of the last step, for a stiffness that has
   * changed meanwhile. */
  vec keep, stretch;
} dem_response;

/* Damping ratio of a contact that gives back the part e of the velocity: of a linear spring, and,
 * in the variable overlap^(5/4), of a Hertzian one. */
static inline double dem_damping_ratio(double restitution) {
  const double pi = 3.14159265358979323846, log_e = log(restitution);
  return -log_e / sqrt(pi * pi + log_e * log_e);
}

/* Elastic constants of two bodies in contact (Pa):
 * 1/E* = sum (1 - nu^2)/E, 1/G* = sum (2 - nu)/G with G = E/2(1 + nu).
 * ERR_RANGE when a material has none. */
static inline int dem_elastic(const dem_pairing *pairing, double *young, double *shear) {
  double soft_n = 0.0, soft_t = 0.0;
  for (int k = 0; k < 2; k++) {
    const dem_material *m = pairing->material[k];
    const double nu = m->poisson_ratio;
    if (!(m->youngs_modulus > 0.0) || isnan(nu))
      return part_fail(PART_ERR_RANGE,
                       "material %s: entries youngsModulus and poissonRatio must be given: its "
                       "contact with %s follows from them",
                       m->name, pairing->material[1 - k]->name);
    soft_n += (1.0 - nu * nu) / m->youngs_modulus;
    soft_t += 2.0 * (2.0 - nu) * (1.0 + nu) / m->youngs_modulus;
  }
  *young = 1.0 / soft_n;
  *shear = 1.0 / soft_t;
  return PART_OK;
}

/* ERR_RANGE when an optional entry is given that the law does not use. */
static inline int dem_not_used(const char *law, const char *entry, double value,
                               const char *instead) {
  if (isnan(value))
    return PART_OK;
  return part_fail(PART_ERR_RANGE, "%s: entry %s is not used by law %s%s", dem_contact_table.name,
                   entry, law, instead);
}

/* The ends of a contact, which fall inside a step. Of the step that ends or begins s = overlap/way
 * steps from touch or release, the next one has s + 1. `at`: lanes with s < 2; first: s < 1. */
typedef struct dem_edge {
  vec_mask at, first;
  vec s;
} dem_edge;

/* way (m): of one step, with the velocity of the end that is near. */
PART_LANES dem_edge dem_edge_of(const dem_touch *touch, vec way) {
  dem_edge edge;
  edge.at = vec_both(touch->touches, vec_less(touch->overlap, way + way));
  edge.s = touch->overlap / way;
  edge.first = vec_less(edge.s, vec_all(1.0));
  return edge;
}

/* Weights of the steps at s and s + 1 (0 < s < 1) that add up to T(s), what both have to give for
 * the part of a force that goes with some power of the overlap: s T(0) and, with its own s,
 * T(s - 1) - (s - 1) T(0). They vanish where the contact does and are continuous. total: T(s - 1);
 * start: T(0). Of a constant, T(s) = s + 3/2. */
PART_LANES vec dem_edge_weights(const dem_edge *edge, vec total, double start) {
  return vec_choose(edge->first, edge->s * vec_all(start),
                    total - (edge->s - vec_all(1.0)) * vec_all(start));
}

#endif
