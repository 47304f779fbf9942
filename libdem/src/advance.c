/* SPDX-License-Identifier: GPL-3.0-or-later */
/* dem_advance: as many substeps as contact needs. */
#include <fenv.h>
#include <string.h>
#include "internal.h"

enum { BEGAN = 0, ENDED = 4, BEFORE_WIDTH = 8 }; /* of the record BEFORE */

static void keep_velocity(dem_t *dem, int at) {
  double *before = part_record_double(dem->store, DEM_RECORD_BEFORE) + at;
  for (size_t i = 0; i < (size_t)dem->store->local; i++)
    memcpy(before + BEFORE_WIDTH * i, dem_vm(dem) + DEM_VM * i, 3 * sizeof *before);
}

/* When nothing moved it since the last advance, this is also how that one ended. */
static void keep_before_advance(dem_t *dem) {
  keep_velocity(dem, BEGAN);
  if (!dem->kicked)
    keep_velocity(dem, ENDED);
  dem->kicked = 0;
}

static void keep_before_kick(dem_t *dem) {
  if (!dem->kicked)
    keep_velocity(dem, ENDED);
  dem->kicked = 1;
}

/* Does any own particle feel a fluid? Also clears the impulses of the last advance and keeps the
 * velocities it begins with. */
static int begin_fluid(dem_t *dem) {
  double *fluid = dem_fluid(dem);
  int any = 0;
  dem->wet.h = 0.0; /* Sp may be another */
  keep_before_advance(dem);
  for (int i = 0; i < dem->store->local; i++) {
    double *f = fluid + DEM_FLUID * (size_t)i;
    f[4] = f[5] = f[6] = 0.0;
    any |= f[0] != 0.0 || f[1] != 0.0 || f[2] != 0.0 || f[3] != 0.0;
  }
  return any || !dem->params.skip;
}

static int check_fluid(const dem_t *dem) {
  for (int i = 0; i < dem->store->local; i++) {
    const double *f = dem_fluid(dem) + DEM_FLUID * (size_t)i;
    const double *x = dem_xr(dem) + DEM_XR * (size_t)i;
    if (!isfinite(f[0] + f[1] + f[2] + f[3]) || f[3] < 0.0)
      return part_fail(
          PART_ERR_NUMERIC,
          "fluid force on particle %lld at (%g %g %g) m, time %g s: Su = (%g %g %g) N, "
          "Sp = %g kg/s; must be finite, Sp >= 0",
          (long long)dem_id(dem, i), x[0], x[1], x[2], dem->time, f[0], f[1], f[2], f[3]);
    if (dem->shape.flat && f[2] != 0.0)
      return part_fail(PART_ERR_RANGE,
                       "fluid force on particle %lld at (%g %g %g) m, time %g s: its z component "
                       "is %g N; must be 0 with dimensions 2",
                       (long long)dem_id(dem, i), x[0], x[1], x[2], dem->time, f[2]);
  }
  return PART_OK;
}

static int check_state(const dem_t *dem) {
  for (int i = 0; i < dem->store->local; i++) {
    const double *x = dem_xr(dem) + DEM_XR * (size_t)i, *v = dem_vm(dem) + DEM_VM * (size_t)i;
    if (!isfinite(x[0] + x[1] + x[2] + v[0] + v[1] + v[2] + v[4] + v[5] + v[6]))
      return part_fail(PART_ERR_NUMERIC,
                       "particle %lld at (%g %g %g) m, time %g s, velocity (%g %g %g) m/s is not "
                       "finite",
                       (long long)dem_id(dem, i), x[0], x[1], x[2], dem->time, v[0], v[1], v[2]);
  }
  return PART_OK;
}

static void add_impulses(dem_t *dem, double h) {
  part_sum_add(&dem->wall_impulse, dem->wall_force, h);
  part_sum_add(&dem->support_impulse, dem->support_force, h);
  dem_walls_add_impulse(dem, h);
}

/* One substep from t. first, last: of those that follow each other without a look in between; where
 * nothing but spheres moves, the half step at its end is left to the beginning of the next. */
static int substep(dem_t *dem, double t, double h, int fluid, int first, int last) {
  const int joined = !dem->plan.blocks && !dem->plan.clumps;
  add_impulses(dem, 0.5 * h);
  double way = first || !joined ? dem_free_kick_drift(dem, t, h, fluid)
                                : dem_free_two_kicks_drift(dem, t, h, fluid);
  if (dem->plan.blocks)
    way = fmax(way, dem_blocks_kick_drift(dem, t, h));
  if (dem->plan.clumps) {
    dem_clumps_kick_drift(dem, t, h, fluid);
    way = -1.0; /* members turn */
  }
  dem_walls_move(dem, t + h, h);
  PART_TRY(dem_refresh(dem, way));
  PART_TRY(dem_forces(dem, h));
  add_impulses(dem, 0.5 * h);
  if (last || !joined)
    dem_free_kick(dem, t + 0.5 * h, h, fluid);
  if (dem->plan.blocks)
    dem_blocks_kick(dem, t + 0.5 * h, h);
  if (dem->plan.clumps)
    dem_clumps_kick(dem, t + 0.5 * h, h, fluid);
  dem->substeps++;
  return PART_OK;
}

/* n substeps with the two half kicks between drifts taken as one, in the contact loop's own pass
 * over the particles (fast.h). */
static int fused_substeps(dem_t *dem, double t0, double h, int n) {
  add_impulses(dem, 0.5 * h);
  double way = dem_free_kick_drift(dem, t0, h, 0);
  dem_walls_move(dem, t0 + h, h);
  PART_TRY(dem_refresh(dem, way));
  dem_no_forces(dem);
  for (int s = 0; s < n - 1; s++) {
    dem_wall_stage(dem, h);
    add_impulses(dem, h);
    part_timers_start(dem->timers, dem->stage[DEM_STAGE_CONTACT]);
    dem_fast_step(dem, t0 + (s + 0.5) * h, h, &way);
    part_timers_stop(dem->timers, dem->stage[DEM_STAGE_CONTACT]);
    dem->substeps++;
    dem->time = t0 + (s + 1) * h;
    dem_walls_move(dem, t0 + (s + 2) * h, h);
    PART_TRY(dem_refresh(dem, way));
  }
  PART_TRY(dem_forces(dem, h));
  add_impulses(dem, 0.5 * h);
  dem_free_kick(dem, t0 + (n - 0.5) * h, h, 0);
  dem->substeps++;
  return PART_OK;
}

static int plain_substeps(dem_t *dem, double t0, double h, int n, int fluid) {
  for (int s = 0; s < n; s++) {
    PART_TRY(substep(dem, t0 + s * h, h, fluid, s == 0, s == n - 1));
    dem->time = t0 + (s + 1) * h;
  }
  return PART_OK;
}

/* The grid of substeps: dt in *n equal ones. */
static int count_substeps(const dem_t *dem, double dt, int *n) {
  *n = 1;
  if (dt <= dem->stable_step)
    return PART_OK;
  /* A ratio that is whole but for rounding is meant to be whole. */
  const double ratio = ceil(dt / dem->stable_step * (1.0 - 1e-12));
  if (ratio > 1e9)
    return part_fail(PART_ERR_RANGE, "advance by %g s: more than 1e9 substeps of %g s", dt,
                     dem->stable_step);
  *n = (int)ratio;
  return PART_OK;
}

static int contact_substeps(dem_t *dem, double t0, double h, int n, int fluid) {
  if (dem->fast.kernels != NULL && !fluid && !(dem->added_density > 0.0)) /* one spin factor */
    return fused_substeps(dem, t0, h, n);
  return plain_substeps(dem, t0, h, n, fluid);
}

/* As many substeps of the grid in one as no contact can begin in. The turn of a clump is not exact:
 * it takes its steps alone. */
static int free_substeps(dem_t *dem, double t0, double h, int n, int fluid, int *taken) {
  double time = 0.0;
  *taken = 0;
  PART_TRY(dem_horizon(dem, n * h, &time));
  const int steps = time >= n * h ? n : (int)(time / h);
  if (steps < 2)
    return PART_OK;
  dem->clumps.parts = steps;
  PART_TRY(plain_substeps(dem, t0, steps * h, 1, fluid));
  dem->clumps.parts = 1;
  *taken = steps;
  return PART_OK;
}

/* Whether contact is near is asked again after more and more substeps with contact, so that dense
 * scenes do not pay for it. */
static int substeps(dem_t *dem, double dt, int n, int fluid) {
  const double t0 = dem->time, h = dt / (n > 0 ? n : 1);
  dem->clumps.parts = 1;
  for (int done = 0, patience = 16, taken = 0; done < n; done += taken) {
    if (n > 1)
      PART_TRY(free_substeps(dem, t0 + done * h, h, n - done, fluid, &taken));
    if (taken > 0) {
      patience = 16;
      continue;
    }
    taken = dem->plan.horizon && patience < n - done ? patience : n - done;
    patience *= patience < n ? 2 : 1;
    PART_TRY(contact_substeps(dem, t0 + done * h, h, taken, fluid));
    dem->time = t0 + (done + taken) * h;
  }
  return PART_OK;
}

/* Fixed particles hand everything on: F = Su, because v = 0. */
static void end_fluid(dem_t *dem, double dt) {
  double *fluid = dem_fluid(dem);
  for (int i = 0; i < dem->store->local; i++) {
    double *f = fluid + DEM_FLUID * (size_t)i;
    if (dem_kind_of(dem, i) != DEM_FIXED) {
      part_sum_add(&dem->fluid_impulse, f + 4, 1.0);
      continue;
    }
    for (int c = 0; c < 3; c++)
      f[4 + c] = f[c] * dt;
  }
}

static int run(dem_t *dem, double dt, int n, int fluid) {
  const double t0 = dem->time;
  if (!dem->plan.movable && dem->params.skip)
    n = 0;
  dem_fast_enter(dem);
  const int status = substeps(dem, dt, n, fluid);
  dem_fast_leave(dem);
  PART_TRY(status);
  dem->time = t0 + dt;
  dem_walls_move(dem, dem->time, 0.0);
  if (dem->plan.blocks)
    PART_TRY(dem_blocks_end(dem, dt));
  end_fluid(dem, dt);
  PART_TRY(part_agree(dem->comm, check_state(dem)));
  return dem->plan.bonds ? dem_bonds_settle(dem) : PART_OK;
}

int dem_advance(dem_t *dem, double dt, int *taken) {
  int n;
  if (taken != NULL)
    *taken = 0;
  if (!dem->started)
    return part_fail(PART_ERR_STATE, "dem_advance comes after dem_start");
  if (!(dt > 0.0) || !isfinite(dt))
    return part_fail(PART_ERR_RANGE, "advance by %g s: must be positive and finite", dt);
  PART_TRY(part_agree(dem->comm, check_fluid(dem)));
  const int fluid = begin_fluid(dem);
  if (dem->plan.blocks)
    PART_TRY(dem_blocks_begin(dem));
  PART_TRY(count_substeps(dem, dt, &n));
  const long long before = dem->substeps;
  /* Lanes without a contact compute too, and may divide by zero before they are masked: whoever
   * traps floating point exceptions (OpenFOAM does) must not see that. */
  fenv_t environment;
  feholdexcept(&environment);
  const int status = run(dem, dt, n, fluid);
  fesetenv(&environment);
  if (taken != NULL)
    *taken = (int)(dem->substeps - before);
  return status;
}

int dem_kick(dem_t *dem, const double *impulse) {
  double *sums = NULL;
  if (!dem->started)
    return part_fail(PART_ERR_STATE, "dem_kick comes after dem_start");
  keep_before_kick(dem);
  int status = dem_allocate(3 * (size_t)dem->blocks, sizeof *sums, &sums);
  for (int i = 0; status == PART_OK && i < dem->store->local; i++) {
    const double *j = impulse + 3 * (size_t)i;
    double *v = dem_vm(dem) + DEM_VM * (size_t)i;
    const int kind = dem_kind_of(dem, i);
    if (!isfinite(j[0] + j[1] + j[2]))
      status = part_fail(PART_ERR_NUMERIC, "the impulse on particle %lld is not finite",
                         (long long)dem_id(dem, i));
    if (dem->shape.flat && j[2] != 0.0)
      status = part_fail(PART_ERR_RANGE,
                         "the impulse on particle %lld has a z component of %g N s; must be 0 "
                         "with dimensions 2",
                         (long long)dem_id(dem, i), j[2]);
    if (kind != DEM_FIXED)
      part_sum_add(&dem->fluid_impulse, j, 1.0);
    for (int c = 0; c < 3; c++) {
      if (kind == DEM_FREE)
        v[c] += j[c] * v[3];
      else if (kind == DEM_BLOCK)
        sums[3 * dem_block_of(dem, i) + c] += j[c];
    }
  }
  status = part_agree(dem->comm, status);
  if (status == PART_OK)
    status = dem_rank_sum(dem, 3 * dem->blocks, sums);
  if (status == PART_OK) {
    dem_blocks_add(dem, sums);
    dem_clumps_add(dem, impulse);
  }
  free(sums);
  return status;
}
