/* SPDX-License-Identifier: GPL-3.0-or-later */
/* All contact laws, and the choice of one by its number where a loop is not stamped per law. */
#ifndef DEM_LAWS_H
#define DEM_LAWS_H

#include "contact_force.h"

#include "laws/hertz_mindlin.h"
#include "laws/linear_spring_dashpot.h"

enum dem_law_number {
#define DEM_LAW(name, key, meaning) DEM_LAW_##name,
#include "dem/contact_laws.def"
#undef DEM_LAW
  DEM_LAW_COUNT
};

/* ERR_RANGE: the contact gives what its law does not use. */
static inline int dem_laws_check(const dem_contact *contact) {
  switch (contact->law) {
#define DEM_LAW(name, key, meaning)                                                                \
  case DEM_LAW_##name:                                                                             \
    return dem_law_##name##_check(contact);
#include "dem/contact_laws.def"
#undef DEM_LAW
  default:
    return PART_OK;
  }
}

/* Does the law take elastic constants from the materials? */
static inline int dem_laws_elastic(const dem_contact *contact) {
  switch (contact->law) {
#define DEM_LAW(name, key, meaning)                                                                \
  case DEM_LAW_##name:                                                                             \
    return dem_law_##name##_elastic(contact);
#include "dem/contact_laws.def"
#undef DEM_LAW
  default:
    return 0;
  }
}

/* ERR_RANGE: a material lacks what the law needs. */
static inline int dem_laws_coefs(const dem_pairing *pairing, dem_coefs *coefs) {
  const double pi = 3.14159265358979323846;
  const dem_contact *contact = pairing->contact;
  coefs->law = contact->law;
  coefs->tangential_mass = pairing->tangential_mass;
  coefs->mu = contact->friction;
  coefs->mu_roll = contact->rolling_friction;
  coefs->pull = 2.0 * pi * contact->work_of_adhesion;
  switch (contact->law) {
#define DEM_LAW(name, key, meaning)                                                                \
  case DEM_LAW_##name:                                                                             \
    return dem_law_##name##_coefs(pairing, coefs);
#include "dem/contact_laws.def"
#undef DEM_LAW
  default:
    return PART_OK;
  }
}

/* Contact time (s): inverse_mass 1/m_eff, reduced radius, impact speed. */
static inline double dem_laws_time(const dem_coefs *coefs, double inverse_mass, double radius,
                                   double speed) {
  switch (coefs->law) {
#define DEM_LAW(name, key, meaning)                                                                \
  case DEM_LAW_##name:                                                                             \
    return dem_law_##name##_time(coefs, inverse_mass, radius, speed);
#include "dem/contact_laws.def"
#undef DEM_LAW
  default:
    return HUGE_VAL;
  }
}

#if PART_WIDTH == 1
static inline dem_lane_coefs dem_lane_coefs_of(const dem_coefs *coefs) {
  return (dem_lane_coefs){coefs->k_n, coefs->k_t,     coefs->c_n,  coefs->c_t,
                          coefs->mu,  coefs->mu_roll, coefs->pull, coefs->tangential_mass};
}

static inline void dem_laws_any(const dem_coefs *coefs, const dem_touch *touch, int parts,
                                double dt, double *history, double force[3], double moment[3]) {
  const dem_lane_coefs lane = dem_lane_coefs_of(coefs);
  switch (coefs->law) {
#define DEM_LAW(name, key, meaning)                                                                \
  case DEM_LAW_##name:                                                                             \
    dem_contact_force(dem_law_##name, &lane, touch, parts, dt, history, force, moment);            \
    break;
#include "dem/contact_laws.def"
#undef DEM_LAW
  default:
    force[0] = force[1] = force[2] = 0.0;
    moment[0] = moment[1] = moment[2] = 0.0;
    break;
  }
}
#endif

#endif
