/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Wear and impact energy (wear.h). A group of eq. 12 and 13 is a material: size classes that wear
 * or break differently are given as materials of their own.
 *
 * Shear energy of an element: what the tangential force takes out of the motion of particles
 * relative to the wall, -F_t . v_t dt with the mean velocity of the step. Over a whole contact the
 * spring gives back what it stored, so that what was dissipated is left.
 *
 * Impact energy: m_eff v_n^2/2 of the approach when a contact begins (as a drop weight is rated by
 * its energy when it hits); a wall's whole, that of two particles by halves. */
#include "wear.h"

#include "internal.h"

int dem_wear_prepare(dem_t *dem) {
  dem_wear *wear = &dem->wear;
  const size_t m = (size_t)dem->materials;
  for (int k = 0; k < dem->given_contacts; k++)
    wear->shear_asked |= dem->given[k].contact.wear_coefficient > 0.0 && dem->walls.count > 0;
  for (int k = 0; k < dem->materials; k++)
    wear->impact_asked |= dem->material[k].breakage_coefficient > 0.0;
  if (wear->shear_asked && wear->shear == NULL)
    PART_TRY(dem_allocate(dem->walls.elements * m, sizeof *wear->shear, &wear->shear));
  if (wear->impact_asked && wear->impact == NULL)
    PART_TRY(dem_allocate(m, sizeof *wear->impact, &wear->impact));
  return PART_OK;
}

void dem_wear_free(dem_wear *wear) {
  free(wear->shear);
  free(wear->impact);
}

void dem_wear_contact(dem_t *dem, int element, int material, const dem_touch *touch,
                      const double force[3], int new_contact, double dt) {
  const double *n = touch->n, *v = touch->v, m = touch->root_mass * touch->root_mass;
  const double f_n = force[0] * n[0] + force[1] * n[1] + force[2] * n[2];
  const double v_n = v[0] * n[0] + v[1] * n[1] + v[2] * n[2];
  if (dem->wear.impact_asked && new_contact && dt > 0.0 && v_n < 0.0)
    dem->wear.impact[material] += 0.5 * m * v_n * v_n;
  if (!dem->wear.shear_asked)
    return;
  double power = 0.0, f2 = 0.0;
  for (int c = 0; c < 3; c++) {
    const double f = force[c] - f_n * n[c];
    power += f * (v[c] - v_n * n[c]);
    f2 += f * f;
  }
  /* The force itself changes the velocity over the step by dt f/(tangential mass). */
  const double mean = power + 0.5 * dt * f2 / (dem->shape.tangential_mass * m);
  dem->wear.shear[element * dem->materials + material] -= mean * dt;
}

/* Square of the distance of centres a step ago. */
static double before(const double d[3], const double v[3], double dt) {
  double sum = 0.0;
  for (int c = 0; c < 3; c++)
    sum += (d[c] - dt * v[c]) * (d[c] - dt * v[c]);
  return sum;
}

static void add_half(dem_t *dem, int i, double energy) {
  if (i < dem->store->local)
    dem->wear.impact[dem_material_of(dem, i)] += 0.5 * energy;
}

void dem_wear_pairs(dem_t *dem, double dt) {
  const double *xr = dem_xr(dem), *vm = dem_vm(dem);
  const part_pairs *pairs = dem->pairs;
  if (!dem->wear.impact_asked || !dem->plan.pairs || !(dt > 0.0))
    return;
  for (int i = 0; i < pairs->rows; i++)
    for (int k = pairs->start[i]; k < pairs->start[i + 1]; k++) {
      const int j = pairs->partner[k];
      const double *x = xr + DEM_XR * (size_t)i, *y = xr + DEM_XR * (size_t)j;
      const double *u = vm + DEM_VM * (size_t)i, *w = vm + DEM_VM * (size_t)j;
      const double d[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
      const double v[3] = {u[0] - w[0], u[1] - w[1], u[2] - w[2]};
      const double d2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2], reach = x[3] + y[3];
      if (!(d2 < reach * reach) || before(d, v, dt) < reach * reach || !(u[3] + w[3] > 0.0))
        continue;
      const double distance = sqrt(d2);
      const double n[3] = {d[0] / distance, d[1] / distance, d[2] / distance};
      const double closing = v[0] * n[0] + v[1] * n[1] + v[2] * n[2];
      const double energy = 0.5 * closing * closing / dem_mobility(dem, i, j, n);
      add_half(dem, i, energy);
      add_half(dem, j, energy);
    }
}

void dem_wear_counted(const dem_t *dem, int *shear, int *impacts) {
  *shear = dem->wear.shear_asked;
  *impacts = dem->wear.impact_asked;
}

/* ---- queries -----------------------------------------------------------------------------------
 */
static double wear_coefficient(const dem_t *dem, int a, int b) {
  double value = 0.0;
  for (int every = 1; every >= 0; every--) /* as set_coefs in plan.c */
    for (int k = 0; k < dem->given_contacts; k++) {
      const dem_given_contact *g = &dem->given[k];
      if (every ? g->a == -1 : (g->a == a && g->b == b) || (g->a == b && g->b == a))
        value = g->contact.wear_coefficient;
    }
  return value;
}

static double area_of(const dem_element *e) {
  const double pi = 3.14159265358979323846;
  if (e->shape == DEM_SHAPE_PLANE || (e->shape == DEM_SHAPE_CYLINDER && e->length == 0.0))
    return HUGE_VAL;
  if (e->shape == DEM_SHAPE_CYLINDER)
    return 2.0 * pi * e->radius *
           (e->length + (e->side == DEM_WALL_OUTSIDE ? e->radius : 0.0)); /* a rod has ends */
  const double p[3] = {e->b[0] - e->a[0], e->b[1] - e->a[1], e->b[2] - e->a[2]};
  const double q[3] = {e->c[0] - e->a[0], e->c[1] - e->a[1], e->c[2] - e->a[2]};
  const double n[3] = {p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2],
                       p[0] * q[1] - p[1] * q[0]};
  return 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

int dem_get_wear(dem_t *dem, int number, double *shear, double *volume, double *area) {
  const int m = dem->materials;
  double *sums = NULL;
  if (!dem->started || !dem->wear.shear_asked)
    return part_fail(PART_ERR_STATE,
                     "dem_get_wear comes after dem_start, with a wearCoefficient in a contact");
  if (number < 0 || number >= dem->walls.count)
    return part_fail(PART_ERR_RANGE, "there is no wall %d; numbers are 0 to %d", number,
                     dem->walls.count - 1);
  const dem_wall *wall = &dem->walls.wall[number];
  const size_t own = (size_t)wall->given * (size_t)m;
  int status = dem_allocate(own, sizeof *sums, &sums);
  for (int k = 0; status == PART_OK && k < wall->count; k++)
    memcpy(sums + dem->walls.element[wall->first + k].given * m,
           dem->wear.shear + (wall->first + k) * m, (size_t)m * sizeof *sums);
  status = part_agree(dem->comm, status);
  if (status == PART_OK)
    status = dem_rank_sum(dem, (int)own, sums);
  for (int k = 0; status == PART_OK && k < wall->given * m; k++) {
    if (shear != NULL)
      shear[k] = sums[k];
    if (volume != NULL)
      volume[k / m] = (k % m == 0 ? 0.0 : volume[k / m]) +
                      wear_coefficient(dem, k % m, wall->material) * sums[k];
  }
  for (int k = 0; status == PART_OK && area != NULL && k < wall->count; k++)
    area[dem->walls.element[wall->first + k].given] = area_of(&dem->walls.element[wall->first + k]);
  free(sums);
  return status;
}

int dem_get_impact(dem_t *dem, int material, dem_impact *impact) {
  double sums[2] = {0.0, 0.0};
  const double *inverse_mass = part_field_double(dem->store, DEM_FIELD_SPHERE_INVERSE_MASS);
  const size_t stride = (size_t)part_field_stride(dem->store, DEM_FIELD_SPHERE_INVERSE_MASS);
  if (!dem->started || !dem->wear.impact_asked)
    return part_fail(PART_ERR_STATE, "dem_get_impact comes after dem_start, with a "
                                     "breakageCoefficient in a material");
  if (material < 0 || material >= dem->materials)
    return part_fail(PART_ERR_RANGE, "there is no material %d; numbers are 0 to %d", material,
                     dem->materials - 1);
  sums[0] = dem->wear.impact[material];
  for (int i = 0; i < dem->store->local; i++)
    if (dem_material_of(dem, i) == material)
      sums[1] +=
          dem_own_part(dem, material) / inverse_mass[stride * (size_t)i]; /* a clump's: share */
  PART_TRY(dem_rank_sum(dem, 2, sums));
  impact->energy = sums[0];
  impact->mass = sums[1];
  impact->breakage =
      sums[1] > 0.0 ? dem->material[material].breakage_coefficient * sums[0] / sums[1] : 0.0;
  return PART_OK;
}

/* ---- files -------------------------------------------------------------------------------------
 */
size_t dem_wear_size(const dem_t *dem) {
  const size_t m = (size_t)dem->materials;
  return (dem->wear.shear_asked ? dem->walls.elements * m : 0) + (dem->wear.impact_asked ? m : 0);
}

void dem_wear_pack(const dem_t *dem, double *value) {
  const size_t m = (size_t)dem->materials, n = dem->wear.shear_asked ? dem->walls.elements * m : 0;
  for (size_t k = 0; k < n; k++)
    value[k] = dem->wear.shear[k];
  for (size_t k = 0; k < m && dem->wear.impact_asked; k++)
    value[n + k] = dem->wear.impact[k];
}

void dem_wear_unpack(dem_t *dem, const double *value) {
  const size_t m = (size_t)dem->materials, n = dem->wear.shear_asked ? dem->walls.elements * m : 0;
  for (size_t k = 0; k < n; k++)
    dem->wear.shear[k] += value[k];
  for (size_t k = 0; k < m && dem->wear.impact_asked; k++)
    dem->wear.impact[k] += value[n + k];
}
