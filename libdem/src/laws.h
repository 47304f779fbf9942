/* SPDX-License-Identifier: GPL-3.0-or-later */
/* All contact laws, and the choice of one by its number where a loop is not stamped per law. */
#ifndef DEM_LAWS_H
#define DEM_LAWS_H

#include "law.h"

#include "laws/linear_spring_dashpot.h"

enum dem_law_number {
#define DEM_LAW(name, key, meaning) DEM_LAW_##name,
#include "dem/contact_laws.def"
#undef DEM_LAW
  DEM_LAW_COUNT
};

static inline void dem_laws_coefs(const dem_contact *contact, dem_coefs *coefs) {
  coefs->law = contact->law;
  switch (contact->law) {
#define DEM_LAW(name, key, meaning)                                                                \
  case DEM_LAW_##name:                                                                             \
    dem_law_##name##_coefs(contact, coefs);                                                        \
    break;
#include "dem/contact_laws.def"
#undef DEM_LAW
  default:
    break;
  }
}

static inline double dem_laws_time(const dem_coefs *coefs, double inverse_mass) {
  switch (coefs->law) {
#define DEM_LAW(name, key, meaning)                                                                \
  case DEM_LAW_##name:                                                                             \
    return dem_law_##name##_time(coefs, inverse_mass);
#include "dem/contact_laws.def"
#undef DEM_LAW
  default:
    return HUGE_VAL;
  }
}

#if DEM_WIDTH == 1
static inline dem_lane_coefs dem_lane_coefs_of(const dem_coefs *coefs) {
  return (dem_lane_coefs){coefs->k_n, coefs->k_t, coefs->c_n, coefs->c_t, coefs->mu};
}

static inline void dem_laws_any(const dem_coefs *coefs, const dem_touch *touch, int tangential,
                                double dt, double spring[3], double force[3]) {
  const dem_lane_coefs lane = dem_lane_coefs_of(coefs);
  switch (coefs->law) {
#define DEM_LAW(name, key, meaning)                                                                \
  case DEM_LAW_##name:                                                                             \
    dem_law_##name(&lane, touch, tangential, dt, spring, force);                                   \
    break;
#include "dem/contact_laws.def"
#undef DEM_LAW
  default:
    force[0] = force[1] = force[2] = 0.0;
    break;
  }
}
#endif

#endif
