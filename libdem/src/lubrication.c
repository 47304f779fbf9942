/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lubrication between particles, the normal part (Wu et al. 2018, eq. 24): F = -lambda(h) v_n over
 * a list of its own, since it reaches farther than contact. doc/equations.md, B.11 to B.13.
 *
 * The velocity is that of half a step ago, so lambda must not be above what a step can take: it is
 * held at 1/(6 dt (1/m_i + 1/m_j)). With up to twelve close neighbours the coefficients of a
 * particle then add up to at most m/dt, so that by Gershgorin's circles no motion is damped by more
 * than twice its velocity in a step, and none can grow. */
#include "internal.h"

static const double share_of_step = 1.0 / 6.0;

int dem_set_lubrication(dem_t *dem, const dem_lubrication *lubrication) {
  if (dem->started)
    return part_fail(PART_ERR_STATE, "dem_set_lubrication comes before dem_start");
  if (dem->film.given)
    return part_fail(PART_ERR_ARGUMENT, "lubrication is given twice");
  PART_TRY(part_params_check(&dem_lubrication_table, lubrication));
  dem->film.params = *lubrication;
  dem->film.given = 1;
  return PART_OK;
}

void dem_film_free(dem_film *film) {
  if (film->pairs != NULL)
    part_pairs_destroy(film->pairs);
}

int dem_film_plan(dem_t *dem) {
  dem_film *film = &dem->film;
  film->range = 0.0;
  if (!dem->plan.lubrication)
    return PART_OK;
  if (film->params.inner_gap >= film->params.cut_off * 2.0 * dem->r_min)
    return part_fail(PART_ERR_RANGE,
                     "%s: entry innerGap: %g m is not allowed; must be below cutOff times the "
                     "smallest diameter, %g m",
                     dem_lubrication_table.name, film->params.inner_gap,
                     film->params.cut_off * 2.0 * dem->r_min);
  film->range = film->params.cut_off * 2.0 * dem->r_max;
  return film->pairs == NULL ? part_pairs_create(0, &film->pairs) : PART_OK;
}

/* 1/R = 1/r_i + 1/r_j; 4 R is the harmonic mean of the diameters. */
static double reduced_radius(double r, double s) {
  return r * s / (r + s);
}

/* Gap (m), and the largest one with a force. d: from j to i. */
static double gap_of(const dem_t *dem, int i, int j, double d[3], double *cut) {
  const double *x = dem_xr(dem) + DEM_XR * (size_t)i, *y = dem_xr(dem) + DEM_XR * (size_t)j;
  for (int c = 0; c < 3; c++)
    d[c] = x[c] - y[c];
  *cut = dem->film.params.cut_off * 4.0 * reduced_radius(x[3], y[3]);
  return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) - x[3] - y[3];
}

int dem_film_list(dem_t *dem) {
  part_pairs *pairs = dem->film.pairs;
  int used = 0, begin = 0;
  PART_TRY(part_pairs_build(pairs, dem->store, DEM_FIELD_RADIUS, &dem->levels,
                            dem->skin + dem->film.range));
  for (int i = 0; i < pairs->rows; i++) {
    const int end = pairs->start[i + 1];
    for (int k = begin; k < end; k++) {
      const int j = pairs->partner[k];
      double d[3], cut;
      const double gap = gap_of(dem, i, j, d, &cut);
      if (gap < cut + dem->skin && dem_pair_wanted(dem, i, j))
        pairs->partner[used++] = j;
    }
    begin = end;
    pairs->start[i + 1] = used;
  }
  return PART_OK;
}

/* kg/s. Spheres: 6 pi mu R^2/h (eq. 24 with the harmonic mean diameter for d_ij, which is Reynolds'
 * theory for unequal ones too); discs: 3 sqrt(2) pi mu depth (R/h)^(3/2). */
static double coefficient(const dem_t *dem, double R, double h) {
  const double pi = 3.14159265358979323846, mu = dem->film.params.viscosity;
  if (dem->shape.flat)
    return 3.0 * sqrt(2.0) * pi * mu * dem->shape.depth * R / h * sqrt(R / h);
  return 6.0 * pi * mu * R * R / h;
}

static void one_film(dem_t *dem, int i, int j, double dt) {
  const double *xr = dem_xr(dem), *v = dem_vm(dem) + DEM_VM * (size_t)i;
  const double *u = dem_vm(dem) + DEM_VM * (size_t)j;
  const double r = xr[DEM_XR * (size_t)i + 3], s = xr[DEM_XR * (size_t)j + 3];
  double n[3], cut;
  const double gap = gap_of(dem, i, j, n, &cut);
  if (!(gap > 0.0 && gap < cut))
    return;
  for (int c = 0; c < 3; c++)
    n[c] /= gap + r + s;
  const double v_n = (v[0] - u[0]) * n[0] + (v[1] - u[1]) * n[1] + (v[2] - u[2]) * n[2];
  const double most = share_of_step / (dt * dem_mobility(dem, i, j, n));
  const double lambda =
      fmin(coefficient(dem, reduced_radius(r, s), fmax(gap, dem->film.params.inner_gap)), most);
  double *fi = dem_ft(dem) + DEM_FT * (size_t)i, *fj = dem_ft(dem) + DEM_FT * (size_t)j;
  for (int c = 0; c < 3; c++) {
    fi[c] -= lambda * v_n * n[c];
    if (j < dem->store->local)
      fj[c] += lambda * v_n * n[c];
  }
}

void dem_film_forces(dem_t *dem, double dt) {
  const part_pairs *pairs = dem->film.pairs;
  const double step = dt > 0.0 ? dt : dem->stable_step; /* the first forces are for half a step */
  for (int i = 0; i < pairs->rows; i++)
    for (int k = pairs->start[i]; k < pairs->start[i + 1]; k++)
      one_film(dem, i, pairs->partner[k], step);
}

double dem_film_gap(const dem_t *dem) {
  const part_pairs *pairs = dem->film.pairs;
  double least = HUGE_VAL, d[3], cut;
  for (int i = 0; i < pairs->rows; i++)
    for (int k = pairs->start[i]; k < pairs->start[i + 1]; k++) {
      const double gap = gap_of(dem, i, pairs->partner[k], d, &cut);
      least = fmin(least, gap - cut);
    }
  return least;
}
