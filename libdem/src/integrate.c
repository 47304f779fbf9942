/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Time integration of free particles: velocity Verlet with the linear fluid force in closed form.
 *
 * Half a step with the contact force of the beginning (kick), the displacement of the whole step
 * with it (drift), contact forces at the new positions, half a step with those (kick). Between
 * contacts the forces are constant and any step is exact; without drag it is velocity Verlet. The
 * fluid's impulse is what changed the momentum beside contact and gravity. */
#include <stdlib.h>
#include "flow.h"
#include "internal.h"

/* Integral of xi(t) from 0 to t, Markauskas et al. 2017 eq. 4; xi = 1 after the ramp. */
static double ramp_integral(double ramp, double t) {
  const double pi = 3.14159265358979323846;
  if (t <= 0.0)
    return 0.0;
  const double end = t < ramp ? t : ramp;
  return 0.5 * (end - ramp / pi * sin(pi * end / ramp)) + (t > ramp ? t - ramp : 0.0);
}

double dem_gravity_factor(const dem_t *dem, int material, double t, double h) {
  const double ramp = dem->params.ramp_time, own = dem_own_part(dem, material);
  if (!(ramp > 0.0) || t >= ramp || !(h > 0.0))
    return own;
  /* Eq. 3 over the weight: rho_f/rho_s + (1 - rho_f/rho_s) xi, mean over the interval. */
  const double ratio = dem->params.ramp_fluid_density / (own * dem->material[material].density);
  const double xi = (ramp_integral(ramp, t + h) - ramp_integral(ramp, t)) / h;
  return own * (ratio + (1.0 - ratio) * xi);
}

/* What drag makes of a step of one particle (flow.h), the same in every substep of an advance:
 *   dx = v path_v + (a + s) path_a,  by fluid: dv = s push - v lost - a keep
 * with a of contact and gravity, s = Su/m. */
struct dem_wet_row {
  double path_v, path_a, push, lost, keep, mass;
};

static dem_wet_row wet_row(double sp, double w, double h, double drift_h) {
  const double b = sp * w * h;
  const dem_flow half = dem_flow_of(b), whole = dem_flow_of(sp * w * drift_h);
  /* phi1 - 1 = -b phi2: what drag takes of the gain by contact and gravity. */
  return (dem_wet_row){.path_v = drift_h * whole.phi1,
                       .path_a = drift_h * drift_h * whole.phi2,
                       .push = h * half.phi1,
                       .lost = half.lost,
                       .keep = h * b * half.phi2,
                       .mass = 1.0 / w};
}

/* Rows for kicks of h/2 and a displacement of h, unless they are there. Two exponentials each: made
 * once an advance, and the kicks between drifts joined, the motion of 24,750 spheres in five
 * substeps takes 2.9 ms instead of 6.1 ms. Without memory for them each kick works out its own. */
static void make_wet_rows(dem_t *dem, double h) {
  struct dem_wet *wet = &dem->wet;
  const int n = dem->store->local;
  if (wet->h == h && wet->generation == dem->generation)
    return;
  if (n > wet->room) {
    free(wet->row);
    wet->row = malloc((size_t)n * sizeof *wet->row);
    wet->room = wet->row != NULL ? n : 0;
  }
  wet->h = wet->room >= n ? h : 0.0;
  wet->generation = dem->generation;
  for (int i = 0; i < n && wet->h > 0.0; i++)
    if (dem->plan.all_free || dem_kind_of(dem, i) == DEM_FREE)
      wet->row[i] = wet_row(dem_fluid(dem)[DEM_FLUID * (size_t)i + 3],
                            dem_vm(dem)[DEM_VM * (size_t)i + 3], 0.5 * h, h);
}

typedef struct kick_step {
  double h;              /* s, of the kick */
  double drift_h;        /* s, of the displacement; 0: kick only */
  const double *gravity; /* [materials][3] m/s2 */
} kick_step;

/* One particle without fluid force. */
static inline void move_dry(const kick_step *step, double *x, double *v, const double *f) {
  const double *g = step->gravity + 3 * (int)v[7];
  for (int c = 0; c < 3; c++)
    v[c] += step->h * (f[c] * v[3] + g[c]);
  if (step->drift_h > 0.0)
    for (int c = 0; c < 3; c++)
      x[c] += step->drift_h * v[c];
}

/* One particle in a fluid: Su = fluid[0..2], impulse = fluid[4..6]. */
static inline void move_wet(const kick_step *step, const dem_wet_row *row, double *x, double *v,
                            const double *f, double *fluid) {
  const double *g = step->gravity + 3 * (int)v[7], w = v[3];
  for (int c = 0; c < 3; c++) {
    const double a = f[c] * w + g[c], s = fluid[c] * w;
    if (step->drift_h > 0.0)
      x[c] += v[c] * row->path_v + (a + s) * row->path_a;
    const double by_fluid = s * row->push - v[c] * row->lost - a * row->keep;
    v[c] += a * step->h + by_fluid;
    fluid[4 + c] += by_fluid * row->mass;
  }
}

static inline double square_distance(const double *a, const double *b) {
  const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
}

static inline void turn(const dem_t *dem, double h, double r, double *v, const double *f) {
  /* for spins see fast.h */
  const double own = dem_own_part(dem, (int)v[7]);
  const double gain = dem->shape.spin * h * v[3] / (own * (dem->fast.spins ? 1.0 : r * r));
  for (int c = 4; c < 7; c++)
    v[c] += gain * f[c];
}

/* Mean gravity of each material over [t, t + h], and its impulse. */
static void set_gravity(dem_t *dem, double t, double h, double *gravity) {
  for (int m = 0; m < dem->materials; m++) {
    const double factor = dem_gravity_factor(dem, m, t, h);
    for (int c = 0; c < 3; c++)
      gravity[3 * m + c] = factor * dem->params.gravity[c];
    part_sum_add(&dem->gravity_impulse, &gravity[3 * m], dem->mass_of[m] * h);
  }
}

/* Kicks of h, one after the other with the same forces, the last with a displacement of drift_h.
 * Returns the longest way of a particle (m). What is not a number is found by check_state. */
static inline __attribute__((always_inline)) double
kicks(dem_t *dem, int count, const kick_step step[2], double wet_h, int fluid) {
  double *xr = dem_xr(dem), *vm = dem_vm(dem), *fl = dem_fluid(dem);
  const double *ft = dem_ft(dem);
  double most = 0.0;
  if (fluid)
    make_wet_rows(dem, wet_h);
  for (int i = 0; i < dem->store->local; i++) {
    double *x = xr + DEM_XR * (size_t)i, *v = vm + DEM_VM * (size_t)i;
    const double *f = ft + DEM_FT * (size_t)i;
    if (!dem->plan.all_free && dem_kind_of(dem, i) != DEM_FREE)
      continue;
    const double from[3] = {x[0], x[1], x[2]};
    for (int k = 0; k < count; k++) {
      if (fluid) {
        double *own = fl + DEM_FLUID * (size_t)i;
        const dem_wet_row row =
            dem->wet.h > 0.0 ? dem->wet.row[i] : wet_row(own[3], v[3], 0.5 * wet_h, wet_h);
        move_wet(&step[k], &row, x, v, f, own);
      } else {
        move_dry(&step[k], x, v, f);
      }
      if (dem->plan.tangential)
        turn(dem, step[k].h, x[3], v, f);
    }
    const double way2 = square_distance(x, from);
    most = way2 > most ? way2 : most;
  }
  return sqrt(most);
}

double dem_free_kick_drift(dem_t *dem, double t, double h, int fluid) {
  part_timers_start(dem->timers, dem->stage[DEM_STAGE_INTEGRATE]);
  const kick_step step[2] = {{0.5 * h, h, dem->gravity_now}};
  set_gravity(dem, t, 0.5 * h, dem->gravity_now);
  const double way = kicks(dem, 1, step, h, fluid);
  part_timers_stop(dem->timers, dem->stage[DEM_STAGE_INTEGRATE]);
  return way;
}

void dem_free_kick(dem_t *dem, double t, double h, int fluid) {
  part_timers_start(dem->timers, dem->stage[DEM_STAGE_INTEGRATE]);
  const kick_step step[2] = {{0.5 * h, 0.0, dem->gravity_now}};
  set_gravity(dem, t, 0.5 * h, dem->gravity_now);
  kicks(dem, 1, step, h, fluid);
  part_timers_stop(dem->timers, dem->stage[DEM_STAGE_INTEGRATE]);
}

double dem_free_two_kicks_drift(dem_t *dem, double t, double h, int fluid) {
  part_timers_start(dem->timers, dem->stage[DEM_STAGE_INTEGRATE]);
  double *second = dem->gravity_now + 3 * dem->materials;
  const kick_step step[2] = {{0.5 * h, 0.0, dem->gravity_now}, {0.5 * h, h, second}};
  set_gravity(dem, t - 0.5 * h, 0.5 * h, dem->gravity_now);
  set_gravity(dem, t, 0.5 * h, second);
  const double way = kicks(dem, 2, step, h, fluid);
  part_timers_stop(dem->timers, dem->stage[DEM_STAGE_INTEGRATE]);
  return way;
}

int dem_relax_spin(dem_t *dem, const double *turn, double dt) {
  for (int i = 0; i < dem->store->local; i++, turn += 4) {
    if (dem_kind_of(dem, i) != DEM_FREE)
      continue;
    double *v = dem_vm(dem) + DEM_VM * (size_t)i;
    const double r = dem_xr(dem)[DEM_XR * (size_t)i + 3];
    if (!isfinite(turn[0] + turn[1] + turn[2] + turn[3]) || turn[3] < 0.0)
      return part_fail(PART_ERR_NUMERIC,
                       "dem_relax_spin: particle %lld: towards (%g %g %g) 1/s by %g N m s",
                       (long long)dem_id(dem, i), turn[0], turn[1], turn[2], turn[3]);
    const double inverse = dem->shape.spin * v[3] / (dem_own_part(dem, (int)v[7]) * r * r);
    const double part = -expm1(-turn[3] * dt * inverse);
    for (int c = 0; c < 3; c++)
      v[4 + c] += part * (turn[c] - v[4 + c]);
  }
  return PART_OK;
}
