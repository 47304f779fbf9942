/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Contact of particles: one loop over the pair list, stamped for every law and combination of parts
 * (law.h).
 *
 * The contact point divides the distance of the centres as the radii do (the middle of the overlap
 * of equal spheres), so that force and torque conserve angular momentum exactly: the two arms add
 * up to the distance.
 *
 * This is the plain loop, for any scene and any processor; fast.c has the vector one. */
#include "internal.h"
#include "laws.h"
#include "rotation.h"

#if defined(__GNUC__)
#define DEM_ALWAYS_INLINE static inline __attribute__((always_inline))
#else
#define DEM_ALWAYS_INLINE static inline
#endif

typedef void pair_law(const dem_coefs *, const dem_touch *, int parts, double dt, double *history,
                      double *force, double *moment);

/* v_i - v_j at the contact point; the arms are those of the two particles. */
DEM_ALWAYS_INLINE void surface_velocity(const double *vi, const double *vj, const double n[3],
                                        double arm_i, double arm_j, int tangential, double v[3]) {
  for (int c = 0; c < 3; c++)
    v[c] = vi[c] - vj[c];
  if (tangential) {
    const double u[3] = {arm_i * vi[4] + arm_j * vj[4], arm_i * vi[5] + arm_j * vj[5],
                         arm_i * vi[6] + arm_j * vj[6]};
    v[0] -= u[1] * n[2] - u[2] * n[1];
    v[1] -= u[2] * n[0] - u[0] * n[2];
    v[2] -= u[0] * n[1] - u[1] * n[0];
  }
}

/* sign: 1 for i, -1 for j. */
DEM_ALWAYS_INLINE void add_force(double *ft, const double f[3], const double torque[3],
                                 const double moment[3], double sign, double arm, int parts) {
  for (int c = 0; c < 3; c++) {
    ft[c] += sign * f[c];
    if (parts & DEM_SLIDING)
      ft[4 + c] += arm * torque[c];
    if (parts & DEM_ROLLING)
      ft[4 + c] += sign * moment[c];
  }
}

/* Arrays of the loop, named once: a store to a force cannot change them. */
typedef struct loop {
  const double *restrict xr, *restrict vm;
  double *restrict ft;
  const dem_coefs *restrict coefs;
  const dem_t *mixed;          /* blocks, clumps or fixed particles are there; NULL: all are free */
  const double *restrict turn; /* clumps.h; NULL: there are no clumps */
  int materials, local;
} loop;

/* Does it move as a whole, or with what else touches at the same time? See blocks.c. */
DEM_ALWAYS_INLINE int is_single(const dem_t *dem, int i) {
  const int kind = dem_kind_of(dem, i);
  return kind == DEM_FREE || kind == DEM_CLUMP;
}

/* 1/m_eff of the damping; see blocks.c for members of blocks, R.4 for those of clumps. */
DEM_ALWAYS_INLINE double inverse_mass(const loop *in, int i, int j, const double n[3]) {
  const double *vi = in->vm + DEM_VM * (size_t)i, *vj = in->vm + DEM_VM * (size_t)j;
  if (in->mixed != NULL && !is_single(in->mixed, i) && !is_single(in->mixed, j))
    return (vi[3] > 0.0 ? 1.0 / dem_own_mass(in->mixed, i) : 0.0) +
           (vj[3] > 0.0 ? 1.0 / dem_own_mass(in->mixed, j) : 0.0);
  if (in->turn != NULL)
    return vi[3] + vj[3] + dem_form(in->turn + 6 * (size_t)i, n) +
           dem_form(in->turn + 6 * (size_t)j, n);
  return vi[3] + vj[3];
}

DEM_ALWAYS_INLINE void one_pair(const loop *in, int i, int j, double d2, const double d[3],
                                double *history, pair_law *law, int parts, double dt) {
  const double *vi = in->vm + DEM_VM * (size_t)i, *vj = in->vm + DEM_VM * (size_t)j;
  const double ri = in->xr[DEM_XR * (size_t)i + 3], rj = in->xr[DEM_XR * (size_t)j + 3];
  const double distance = sqrt(d2), inverse = 1.0 / distance;
  dem_touch touch;
  double force[3], torque[3] = {0.0, 0.0, 0.0}, moment[3] = {0.0, 0.0, 0.0};
  touch.overlap = ri + rj - distance;
  touch.radius = ri * rj / (ri + rj);
  touch.touches = 1;
  for (int c = 0; c < 3; c++) {
    touch.n[c] = d[c] * inverse;
    touch.spin[c] = vi[4 + c] - vj[4 + c];
  }
  touch.inverse_root = sqrt(inverse_mass(in, i, j, touch.n));
  touch.root_mass = 1.0 / touch.inverse_root;
  const double share = distance / (ri + rj), arm_i = share * ri, arm_j = share * rj;
  surface_velocity(vi, vj, touch.n, arm_i, arm_j, parts & DEM_SLIDING, touch.v);
  law(&in->coefs[(int)vi[7] * in->materials + (int)vj[7]], &touch, parts, dt, history, force,
      moment);
  if (parts & DEM_SLIDING) {
    /* -n x F: the normal part of F drops out. */
    torque[0] = touch.n[2] * force[1] - touch.n[1] * force[2];
    torque[1] = touch.n[0] * force[2] - touch.n[2] * force[0];
    torque[2] = touch.n[1] * force[0] - touch.n[0] * force[1];
  }
  add_force(in->ft + DEM_FT * (size_t)i, force, torque, moment, 1.0, arm_i, parts);
  if (j < in->local)
    add_force(in->ft + DEM_FT * (size_t)j, force, torque, moment, -1.0, arm_j, parts);
}

DEM_ALWAYS_INLINE void pair_loop(dem_t *dem, pair_law *law, int parts, double dt) {
  const loop in = {.xr = dem_xr(dem),
                   .vm = dem_vm(dem),
                   .ft = dem_ft(dem),
                   .coefs = dem->coefs,
                   .mixed = dem->plan.all_free ? NULL : dem,
                   .turn = dem->plan.clumps ? dem->clumps.turn : NULL,
                   .materials = dem->materials,
                   .local = dem->store->local};
  const part_pairs *pairs = dem->pairs;
  const int *restrict start = pairs->start, *restrict partner = pairs->partner;
  double *restrict data = pairs->data;
  const int rows = pairs->rows;
  double nothing[DEM_HISTORY] = {0.0};
  const size_t width = DEM_HISTORY_WIDTH(parts);
  for (int i = 0; i < rows; i++) {
    const double *xi = in.xr + DEM_XR * (size_t)i;
    const int end = start[i + 1];
    for (int k = start[i]; k < end; k++) {
      const int j = partner[k];
      const double *xj = in.xr + DEM_XR * (size_t)j;
      const double d[3] = {xi[0] - xj[0], xi[1] - xj[1], xi[2] - xj[2]};
      const double d2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2], reach = xi[3] + xj[3];
      double *history = width > 0 ? &data[width * (size_t)k] : nothing;
      if (d2 < reach * reach && d2 > 0.0)
        one_pair(&in, i, j, d2, d, history, law, parts, dt);
      else
        for (size_t c = 0; c < width; c++)
          history[c] = 0.0;
    }
  }
}

#define DEM_VARIANT(name, parts)                                                                   \
  static void pairs_##name##_##parts(dem_t *dem, double dt) {                                      \
    pair_loop(dem, law_##name, parts, dt);                                                         \
  }
#define DEM_LAW(name, key, meaning)                                                                \
  DEM_ALWAYS_INLINE void law_##name(const dem_coefs *coefs, const dem_touch *touch, int parts,     \
                                    double dt, double *history, double *force, double *moment) {   \
    const dem_lane_coefs lane = dem_lane_coefs_of(coefs);                                          \
    dem_contact_force(dem_law_##name, &lane, touch, parts, dt, history, force, moment);            \
  }                                                                                                \
  DEM_VARIANTS(DEM_VARIANT, name)
#include "dem/contact_laws.def"
#undef DEM_LAW
#undef DEM_VARIANT

static void (*const stamped[DEM_LAW_COUNT][DEM_PARTS])(dem_t *, double) = {
#define DEM_VARIANT(name, parts) [parts] = pairs_##name##_##parts,
#define DEM_LAW(name, key, meaning) {DEM_VARIANTS(DEM_VARIANT, name)},
#include "dem/contact_laws.def"
#undef DEM_LAW
#undef DEM_VARIANT
};

void dem_pair_forces(dem_t *dem, double dt) {
  const int law = dem_common_law(dem), parts = dem_parts(dem);
  if (dem->fast.kernels != NULL)
    dem_fast_forces(dem, dt);
  else if (law >= 0)
    stamped[law][parts](dem, dt);
  else
    pair_loop(dem, dem_laws_any, parts, dt);
}

int dem_pair_wanted(const dem_t *dem, int i, int j) {
  const int kind = dem_kind_of(dem, i);
  const int same = kind == dem_kind_of(dem, j) &&
                   (kind == DEM_FIXED || ((kind == DEM_BLOCK || kind == DEM_CLUMP) &&
                                          dem_block_of(dem, i) == dem_block_of(dem, j)));
  return !same && !(dem->plan.bonds && dem_bonds_join(dem, i, j));
}

int dem_pair_list_filter(dem_t *dem) {
  part_pairs *pairs = dem->pairs;
  int used = 0, begin = 0;
  if (dem->plan.all_free && !dem->plan.bonds)
    return PART_OK;
  for (int i = 0; i < pairs->rows; i++) {
    const int end = pairs->start[i + 1];
    for (int k = begin; k < end; k++)
      if (dem_pair_wanted(dem, i, pairs->partner[k]))
        pairs->partner[used++] = pairs->partner[k];
    begin = end;
    pairs->start[i + 1] = used;
  }
  return PART_OK;
}
