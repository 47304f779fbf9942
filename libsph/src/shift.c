/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Particles that do not move with the fluid: S.11 and the shift of S.19. They take what the fluid
 * is at their new place, so that p does not jump when eps is set there. */
#include "internal.h"

/* A shift is at most this share of the particle's own way. */
static const double most_share = 0.1;

/* Of the sum that is 1 inside the fluid: no shift or correction below the first (free surface), all
 * of it above the second. On lattices the outermost layer has 0.5 to 0.6 and the third 1. */
static const double surface = 0.85, inside = 0.95;

double sph_shift_room(const sph_t *sph) {
  return sph->plan.shifting ? most_share : 0.0;
}

double sph_share_inside(double sum) {
  const double share = (sum - surface) / (inside - surface);
  return share < 0.0 ? 0.0 : share < 1.0 ? share : 1.0;
}

/* From the sums of a particle, its way in h and the changes of pressure and eps along it. */
static void shift_of(const sph_t *sph, int i, double h, double way[3], double *p, double *eps) {
  const double *s = sph->shift + SPH_SHIFTS * (size_t)i;
  const double *v = sph_xv(sph) + SPH_XV * (size_t)i + 4;
  const double *f = sph_force(sph) + SPH_FORCE * (size_t)i;
  const double speed = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  const double moment = s[6] / (double)sph->params.dimensions, share = sph_share_inside(moment);
  const double size = sph->params.shifting * sph->params.smoothing_length *
                      sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]);
  const double limit = size > most_share ? most_share / size : 1.0;
  const double factor =
      -share * limit * h * speed * sph->params.shifting * sph->params.smoothing_length;
  *p = *eps = 0.0;
  for (int c = 0; c < 3; c++) {
    way[c] = factor * s[c];
    *p += way[c] * s[3 + c];
    *eps += way[c] * f[4 + c];
  }
  if (share > 0.0) {
    *p /= moment;
  }
}

/* Superficial density of the fluid at the new place, of pressure p + dp and porosity eps + deps. */
static double moved_density(const sph_t *sph, double density, double eps, double dp, double deps) {
  const sph_params *p = &sph->params;
  const double own = density / eps, c2 = p->sound_speed * p->sound_speed;
  const double moved = own + dp / (c2 * pow(own / p->density, p->gamma - 1.0));
  return moved * (eps + deps);
}

double sph_moved_eps(double eps, double change) {
  return fmin(fmax(eps + change, 0.5 * eps), 1.0);
}

void sph_carry(const sph_t *sph, int i, double factor, const double way[3], double x[3],
               double *density, double *eps) {
  const double *slope = sph_force(sph) + SPH_FORCE * (size_t)i + 4;
  double change = 0.0;
  for (int c = 0; c < 3; c++) {
    x[c] += factor * way[c];
    change += factor * way[c] * slope[c];
  }
  if (change == 0.0)
    return;
  const double moved = sph_moved_eps(*eps, change);
  *density *= moved / *eps;
  *eps = moved;
}

void sph_shift_one(const sph_t *sph, int i, double h, double x[3], double *density, double *eps) {
  double way[3], dp, deps;
  shift_of(sph, i, h, way, &dp, &deps);
  deps = sph_moved_eps(*eps, deps) - *eps;
  *density = moved_density(sph, *density, *eps, dp, deps);
  *eps += deps;
  for (int c = 0; c < 3; c++)
    x[c] += way[c];
}

void sph_shift(sph_t *sph, double h) {
  for (int i = 0; i < sph->store->local && sph->plan.shifting; i++) {
    double *m = sph_mass(sph) + SPH_MASS * (size_t)i;
    sph_shift_one(sph, i, h, sph_xv(sph) + SPH_XV * (size_t)i, m + 1, m + 2);
  }
}
