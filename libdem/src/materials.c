/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Contacts of pairs of materials: what is given for each, the coefficients that follow from it, and
 * the contact time. */
#include <stdio.h>

#include "internal.h"
#include "laws.h"

/* Contact of a pair: of those given for it the last, else the last one for all; NULL: none. */
static const dem_contact *given_for(const dem_t *dem, int a, int b) {
  const dem_contact *found = NULL;
  int own = 0;
  for (int k = 0; k < dem->given_contacts; k++) {
    const dem_given_contact *g = &dem->given[k];
    const int mine = (g->a == a && g->b == b) || (g->a == b && g->b == a);
    if (mine || (g->a == -1 && !own))
      found = &g->contact;
    own |= mine;
  }
  return found;
}

static int is_elastic(const dem_t *dem, int a, int b) {
  const dem_contact *given = given_for(dem, a, b);
  return given != NULL && dem_laws_elastic(given);
}

/* What is given and used by no contact is an error. */
static int check_use(const dem_t *dem) {
  int any = 0;
  for (int a = 0; a < dem->materials; a++) {
    int used = 0;
    for (int b = 0; b < dem->materials; b++)
      used |= is_elastic(dem, a, b);
    any |= used;
    if (dem->material[a].youngs_modulus > 0.0 && !used)
      return part_fail(
          PART_ERR_RANGE,
          "material %s: entry youngsModulus is used by none of its contacts: they have "
          "normalStiffness",
          dem->material[a].name);
  }
  if (dem->params.impact_speed > 0.0 && !any)
    return part_fail(PART_ERR_RANGE,
                     "%s: entry impactSpeed is used by no contact: all have normalStiffness",
                     dem_params_table.name);
  return PART_OK;
}

/* Discs meet along lines, for which neither Hertz nor attraction between spheres holds. */
static int check_flat(const dem_t *dem, int a, int b) {
  const dem_contact *given = given_for(dem, a, b);
  if (!dem->shape.flat)
    return PART_OK;
  if (is_elastic(dem, a, b))
    return part_fail(
        PART_ERR_RANGE,
        "contact of %s and %s: discs need law linearSpringDashpot with normalStiffness; "
        "youngsModulus is for contacts of spheres",
        dem->material[a].name, dem->material[b].name);
  if (given->work_of_adhesion > 0.0)
    return part_fail(PART_ERR_RANGE,
                     "contact of %s and %s: entry workOfAdhesion is for spheres, not for discs",
                     dem->material[a].name, dem->material[b].name);
  return PART_OK;
}

/* Twice the largest speed now, plus that of a fall through the domain. */
static double hardest_impact(const dem_t *dem, double speed) {
  double energy = 0.0;
  for (int c = 0; c < 3; c++)
    energy += fabs(dem->params.gravity[c]) * (dem->box.hi[c] - dem->box.lo[c]);
  return 2.0 * speed + sqrt(2.0 * energy);
}

int dem_materials_begin(dem_t *dem, double speed) {
  const size_t n = (size_t)dem->materials;
  PART_TRY(check_use(dem));
  if (dem->params.impact_speed > 0.0)
    dem->impact_speed = dem->params.impact_speed;
  else if (!(dem->impact_speed > 0.0)) /* else from a restart file */
    dem->impact_speed = hardest_impact(dem, speed);
  PART_TRY(dem_allocate(n * n, sizeof *dem->coefs, &dem->coefs));
  for (size_t k = 0; k < n * n; k++) {
    dem->coefs[k].law = -1;
    dem->coefs[k].tangential_mass = dem->shape.tangential_mass;
  }
  return PART_OK;
}

static int coefs_of(const dem_t *dem, int a, int b, dem_coefs *coefs) {
  const dem_pairing pairing = {given_for(dem, a, b),
                               {&dem->material[a], &dem->material[b]},
                               dem->shape.tangential_mass,
                               dem->r_mean,
                               dem->impact_speed};
  if (pairing.contact == NULL)
    return part_fail(PART_ERR_RANGE, "no contact is given for materials %s and %s",
                     dem->material[a].name, dem->material[b].name);
  PART_TRY(check_flat(dem, a, b));
  if (is_elastic(dem, a, b) && !(dem->impact_speed > 0.0))
    return part_fail(
        PART_ERR_RANGE,
        "%s: entry impactSpeed must be given: nothing moves and there is no gravity, so "
        "that it cannot be worked out",
        dem_params_table.name);
  return dem_laws_coefs(&pairing, coefs);
}

int dem_materials_pair(dem_t *dem, int a, int b, int can_happen) {
  dem_coefs coefs = {0};
  const int status = coefs_of(dem, a, b, &coefs);
  if (status !=
      PART_OK) /* without skip all pairs are asked for: what cannot happen may lack things */
    return can_happen ? status : PART_OK;
  dem->coefs[a * dem->materials + b] = dem->coefs[b * dem->materials + a] = coefs;
  dem->plan.tangential |= coefs.mu > 0.0 || coefs.mu_roll > 0.0;
  dem->plan.rolling |= coefs.mu_roll > 0.0;
  dem->plan.cohesion |= coefs.pull > 0.0;
  return PART_OK;
}

static double radius_of(const dem_t *dem, int material, double inverse_mass) {
  return cbrt(3.0 /
              (4.0 * 3.14159265358979323846 * dem->material[material].density * inverse_mass));
}

/* The lightest sphere of a with the lightest of b, and each with a body so large that it has no
 * curvature and does not give way: no contact of larger spheres is shorter. (With the size of one
 * fixed, m_eff^2/R of Hertz first grows with that of the other and then falls.) */
void dem_materials_time(dem_t *dem, int a, int b, double inverse_a, double inverse_b) {
  const dem_coefs *coefs = &dem->coefs[a * dem->materials + b];
  const double inverse[2] = {inverse_a, inverse_b};
  double curvature = 0.0, least = HUGE_VAL;
  if (coefs->law < 0)
    return;
  for (int k = 0; k < 2; k++) {
    if (!(inverse[k] > 0.0))
      continue;
    const double r = radius_of(dem, k == 0 ? a : b, inverse[k]);
    curvature += 1.0 / r;
    least = fmin(least, dem_laws_time(coefs, inverse[k], r, dem->impact_speed));
  }
  if (curvature > 0.0)
    least = fmin(least,
                 dem_laws_time(coefs, inverse_a + inverse_b, 1.0 / curvature, dem->impact_speed));
  if (least >= dem->contact_time)
    return;
  dem->contact_time = least;
  dem->shortest[0] = a;
  dem->shortest[1] = b;
}

int dem_step_text(const dem_t *dem, size_t size, char *text) {
  if (!dem->started)
    return part_fail(PART_ERR_STATE, "dem_step_text comes after dem_start");
  int n;
  if (isinf(dem->stable_step)) {
    n = snprintf(text, size, "any step is stable: nothing can touch");
  } else {
    const int a = dem->shortest[0], b = dem->shortest[1];
    const int law = dem->coefs[a * dem->materials + b].law;
    char speed[64] = "";
    if (is_elastic(dem, a, b))
      snprintf(speed, sizeof speed, " at impactSpeed %g m/s", dem->impact_speed);
    n = snprintf(text, size,
                 "stable step %g s = timeStepFraction %g x contact time %g s of %s and %s (%s%s)",
                 dem->stable_step, dem->params.time_step_fraction, dem->contact_time,
                 dem->material[a].name, dem->material[b].name,
                 part_params_find(&dem_contact_table, "law")->choices[law], speed);
  }
  return n >= 0 && (size_t)n < size
             ? PART_OK
             : part_fail(PART_ERR_RANGE, "the step text needs more than %zu characters", size);
}

/* ---- by number and name ---------------------------------------------------------------------- */
int dem_material_count(const dem_t *dem) {
  return dem->materials;
}
const char *dem_material_name(const dem_t *dem, int number) {
  return number >= 0 && number < dem->materials ? dem->material[number].name : NULL;
}

int dem_find_material(const dem_t *dem, const char *name, int *number) {
  const char **names = NULL;
  for (int m = 0; m < dem->materials; m++)
    if (strcmp(dem->material[m].name, name) == 0) {
      *number = m;
      return PART_OK;
    }
  PART_TRY(dem_allocate((size_t)dem->materials, sizeof *names, &names));
  for (int m = 0; m < dem->materials; m++)
    names[m] = dem->material[m].name;
  const char *near = part_nearest_name(name, dem->materials, names);
  const int status = part_fail(PART_ERR_ARGUMENT, "there is no material '%s'%s%s%s", name,
                               near != NULL ? "; did you mean '" : "", near != NULL ? near : "",
                               near != NULL ? "'?" : "");
  free(names);
  return status;
}
