/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Particles to begin with. They go to the rank that makes them; sph_start sends them on. */
#include "internal.h"

double sph_density_at(const sph_params *p, double pressure) {
  const double k = p->density * p->sound_speed * p->sound_speed / p->gamma;
  const double base = (pressure - p->background_pressure) / k + 1.0;
  return base > 0.0 ? p->density * pow(base, 1.0 / p->gamma) : 0.0;
}

static int begin(const sph_t *sph, const char *call) {
  if (sph->started || sph->restored)
    return part_fail(PART_ERR_STATE, "%s comes before sph_start, and not after sph_read", call);
  return PART_OK;
}

/* One particle at the end of the store, which has room. */
static int put(sph_t *sph, int at, int64_t id, const double x[3], const double v[3], double volume,
               double pressure) {
  double *xv = sph_xv(sph) + SPH_XV * (size_t)at, *m = sph_mass(sph) + SPH_MASS * (size_t)at;
  const double density = sph_density_at(&sph->params, pressure);
  if (!(density > 0.0))
    return part_fail(PART_ERR_RANGE, "particle %lld at (%g %g %g) m: no density gives %g Pa",
                     (long long)id, x[0], x[1], x[2], pressure);
  memcpy(xv, x, 3 * sizeof *xv);
  memcpy(xv + 4, v, 3 * sizeof *xv);
  m[0] = density * volume;
  m[1] = density;
  m[2] = 1.0;
  sph_seen(sph)[SPH_SEEN * (size_t)at] = 1.0;
  m[3] = 0.5 * sph->reach;
  sph_force(sph)[SPH_FORCE * (size_t)at + 7] = 1.0;
  part_record_int64(sph->store, SPH_RECORD_META)[SPH_META * (size_t)at] = id;
  return PART_OK;
}

static int check_place(const sph_t *sph, const double x[3], const char *what, long long number) {
  const part_box *box = &sph->box;
  for (int c = 0; c < 3; c++)
    if (!(x[c] >= box->lo[c] && x[c] <= box->hi[c]))
      return part_fail(
          PART_ERR_OUTSIDE,
          "%s %lld at (%g %g %g) m is outside the domain from (%g %g %g) to (%g %g %g) m", what,
          number, x[0], x[1], x[2], box->lo[0], box->lo[1], box->lo[2], box->hi[0], box->hi[1],
          box->hi[2]);
  if (sph->params.dimensions == 2 && !isnan(sph->plane) && x[2] != sph->plane)
    return part_fail(PART_ERR_RANGE,
                     "%s %lld: z is %g m; with dimensions 2 it must be %g m, as that of the first",
                     what, number, x[2], sph->plane);
  return PART_OK;
}

/* Whole cells in each direction, and their sides. */
static int divide(const sph_t *sph, const sph_insert *insert, int64_t n[3], double side[3]) {
  const int dim = (int)sph->params.dimensions;
  double all = 1.0;
  n[2] = 1;
  side[2] = 0.0;
  for (int c = 0; c < dim; c++) {
    const double cells = floor(insert->extent[c] / sph->params.spacing + 0.5);
    if (!(cells >= 1.0))
      return part_fail(PART_ERR_RANGE,
                       "%s: entry extent: component %d is %g m, less than half a spacing",
                       sph_insert_table.name, c, insert->extent[c]);
    all *= cells;
    if (all > 1e15)
      return part_fail(PART_ERR_RANGE, "%s: entry extent: more than 1e15 particles",
                       sph_insert_table.name);
    n[c] = (int64_t)cells;
    side[c] = insert->extent[c] / cells;
  }
  return PART_OK;
}

static int check_box(sph_t *sph, const sph_insert *insert, int64_t n[3], double side[3]) {
  double far[3];
  PART_TRY(part_params_check(&sph_insert_table, insert));
  PART_TRY(divide(sph, insert, n, side));
  if (sph->params.dimensions == 2 && insert->velocity[2] != 0.0)
    return part_fail(PART_ERR_RANGE,
                     "%s: entry velocity: its z component must be 0 with dimensions 2",
                     sph_insert_table.name);
  for (int c = 0; c < 3; c++)
    far[c] = insert->origin[c] + ((double)n[c] - 0.5) * side[c];
  PART_TRY(check_place(sph, insert->origin, "corner", 0));
  return check_place(sph, far, "particle", n[0] * n[1] * n[2] - 1);
}

static int fill(sph_t *sph, const sph_insert *insert, const int64_t n[3], const double side[3]) {
  const int64_t count = n[0] * n[1] * n[2];
  const int64_t first = count * sph->rank / sph->ranks, last = count * (sph->rank + 1) / sph->ranks;
  const double depth = sph->params.dimensions == 2 ? sph->params.depth : side[2];
  const double volume = side[0] * side[1] * depth;
  int at;
  if (last - first > INT32_MAX / 2)
    return part_fail(PART_ERR_RANGE, "%lld particles are too many for %d ranks", (long long)count,
                     sph->ranks);
  PART_TRY(part_store_append(sph->store, (int)(last - first), &at));
  for (int64_t k = first; k < last; k++, at++) {
    const double cell[3] = {(double)(k % n[0]), (double)(k / n[0] % n[1]),
                            (double)(k / (n[0] * n[1]))};
    double x[3], pressure = sph->params.background_pressure;
    for (int c = 0; c < 3; c++) {
      x[c] = insert->origin[c] + (side[c] > 0.0 ? (cell[c] + 0.5) * side[c] : 0.0);
      if (insert->hydrostatic)
        pressure += sph->params.density * sph->params.gravity[c] * (x[c] - insert->surface[c]);
    }
    PART_TRY(
        put(sph, at, sph->params.first_id + sph->total + k, x, insert->velocity, volume, pressure));
  }
  return PART_OK;
}

int sph_insert_box(sph_t *sph, const sph_insert *insert, int64_t *inserted) {
  int64_t n[3];
  double side[3];
  PART_TRY(begin(sph, "sph_insert_box"));
  PART_TRY(part_agree(sph->comm, check_box(sph, insert, n, side)));
  PART_TRY(part_agree(sph->comm, fill(sph, insert, n, side)));
  if (sph->params.dimensions == 2)
    sph->plane = insert->origin[2];
  sph->total += n[0] * n[1] * n[2];
  if (inserted != NULL)
    *inserted = n[0] * n[1] * n[2];
  return PART_OK;
}

static int check_points(const sph_t *sph, int count, const double *position, const double *velocity,
                        const double *volume) {
  for (int k = 0; k < count; k++) {
    const double *v = velocity != NULL ? velocity + 3 * (size_t)k : NULL;
    PART_TRY(check_place(sph, position + 3 * (size_t)k, "point", k));
    if (v != NULL && !isfinite(v[0] + v[1] + v[2]))
      return part_fail(PART_ERR_NUMERIC, "point %d: its velocity is not finite", k);
    if (v != NULL && sph->params.dimensions == 2 && v[2] != 0.0)
      return part_fail(PART_ERR_RANGE,
                       "point %d: its velocity has a z component of %g m/s; must be "
                       "0 with dimensions 2",
                       k, v[2]);
    if (volume != NULL && !(volume[k] > 0.0 && isfinite(volume[k])))
      return part_fail(PART_ERR_RANGE, "point %d: its volume is %g m^3; must be in (0, inf)", k,
                       volume[k]);
  }
  return PART_OK;
}

/* Plane of all points with two dimensions: that of the lowest rank that has some. */
static int find_plane(sph_t *sph, int count, const double *position) {
  double z = count > 0 ? position[2] : HUGE_VAL;
  if (sph->params.dimensions == 3 || !isnan(sph->plane))
    return PART_OK;
  if (MPI_Allreduce(MPI_IN_PLACE, &z, 1, MPI_DOUBLE, MPI_MIN, sph->comm) != MPI_SUCCESS)
    return part_fail(PART_ERR_MPI, "a minimum over ranks failed");
  if (isfinite(z))
    sph->plane = z;
  return PART_OK;
}

static int put_points(sph_t *sph, int count, const double *position, const double *velocity,
                      const double *volume, const double *pressure, int64_t first) {
  const double rest[3] = {0.0, 0.0, 0.0};
  int at;
  PART_TRY(part_store_append(sph->store, count, &at));
  for (int k = 0; k < count; k++)
    PART_TRY(put(sph, at + k, first + k, position + 3 * (size_t)k,
                 velocity != NULL ? velocity + 3 * (size_t)k : rest,
                 volume != NULL ? volume[k] : sph->cell,
                 pressure != NULL ? pressure[k] : sph->params.background_pressure));
  return PART_OK;
}

int sph_insert_points(sph_t *sph, int count, const double *position, const double *velocity,
                      const double *volume, const double *pressure, int64_t *inserted) {
  int64_t mine = count, before = 0, all = 0;
  PART_TRY(begin(sph, "sph_insert_points"));
  PART_TRY(find_plane(sph, count, position));
  PART_TRY(part_agree(sph->comm, check_points(sph, count, position, velocity, volume)));
  if (MPI_Exscan(&mine, &before, 1, MPI_INT64_T, MPI_SUM, sph->comm) != MPI_SUCCESS ||
      MPI_Allreduce(&mine, &all, 1, MPI_INT64_T, MPI_SUM, sph->comm) != MPI_SUCCESS)
    return part_fail(PART_ERR_MPI, "a sum over ranks failed");
  if (sph->rank == 0)
    before = 0;
  PART_TRY(part_agree(sph->comm, put_points(sph, count, position, velocity, volume, pressure,
                                            sph->params.first_id + sph->total + before)));
  sph->total += all;
  if (inserted != NULL)
    *inserted = all;
  return PART_OK;
}
