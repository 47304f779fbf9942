/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Smoothing lengths that follow the particles' volumes (S.26): h = (smoothingLength/spacing) (m/rho_bar)^(1/d), so that h
 * is a function of mass and density alone and nothing else has to be kept. */
#include "internal.h"

/* Lists hold until a length has grown by this. */
static const double margin = 1.02;
enum { OMEGA = 7 /* of FORCE */ };

double sph_unit_volume(const sph_t *sph) {
  const sph_params *p = &sph->params;
  const double per = p->spacing / p->smoothing_length;
  return p->dimensions == 2 ? per * per * p->depth : per * per * per;
}

static double length_of(const sph_t *sph, int i) {
  const double *m = sph_mass(sph) + SPH_MASS * (size_t)i;
  const double part = m[0] / (m[1] * sph_unit_volume(sph));
  return sph->params.dimensions == 2 ? sqrt(part) : cbrt(part);
}

void sph_set_lengths(sph_t *sph) {
  if (sph->lens_room < 2 * (size_t)sph->store->local)
    return; /* there are no lists yet; with them come the lengths */
  for (int i = 0; i < sph->store->local; i++) {
    sph->lens[2 * (size_t)i] = 1.0 / length_of(sph, i);
    sph->lens[2 * (size_t)i + 1] = sph_force(sph)[SPH_FORCE * (size_t)i + OMEGA];
  }
}

int sph_copy_lengths(sph_t *sph) {
  return part_domain_copy_to_ghosts(sph->domain, sph->store, 2 * sizeof *sph->lens, sph->lens,
                                    sph->lens + 2 * (size_t)sph->store->local);
}

void sph_set_omega(sph_t *sph, int i, double omega) {
  const double inverse = 1.0 / omega;
  sph->lens[2 * (size_t)i + 1] = inverse;
  sph_force(sph)[SPH_FORCE * (size_t)i + OMEGA] = inverse;
}

/* 1 + h/d sum V dW/dh, with h dW/dh = -(d W + r dW/dr) and the particle itself. */
void sph_set_omegas(sph_t *sph) {
  const double own = sph_shape(sph->params.kernel, 0.0), d = (double)sph->params.dimensions;
  for (int i = 0; i < sph->store->local; i++) {
    const double *s = sph->sum + SPH_SUMS * (size_t)i;
    const double volume = sph_xv(sph)[SPH_XV * (size_t)i + 3];
    const double all = s[7] + volume * own * sph_norm_at(sph, sph_length(sph, i));
    sph_set_omega(sph, i, 1.0 - all + s[6] / d);
  }
}

static int too_long(const sph_t *sph, int i) {
  const double *x = sph_xv(sph) + SPH_XV * (size_t)i;
  return part_fail(PART_ERR_RANGE,
                   "%s: entry largestSmoothing: particle %lld at (%g %g %g) m, time %g s, has the smoothing "
                   "length %g m, %g times smoothingLength; at most %g was asked for",
                   sph_params_table.name, (long long)sph_id(sph, i), x[0], x[1], x[2], sph->time,
                   length_of(sph, i), length_of(sph, i) / sph->params.smoothing_length,
                   sph->params.largest_smoothing);
}

int sph_check_lengths(const sph_t *sph) {
  const double most = sph->params.largest_smoothing * sph->params.smoothing_length;
  for (int i = 0; i < sph->store->local; i++)
    if (!(length_of(sph, i) <= most))
      return too_long(sph, i);
  return PART_OK;
}

/* Two particles are partners when nearer than s_i + s_j = S_i + S_j - least, which is no less than the longer of their
 * supports S. */
int sph_list_supports(sph_t *sph, double range[2]) {
  const double support = sph_kernel_support(sph->params.kernel);
  double both[2] = {-HUGE_VAL, 0.0}; /* -least, most */
  PART_TRY(part_agree(sph->comm, sph_check_lengths(sph)));
  for (int i = 0; i < sph->store->local; i++) {
    const double s = fmin(margin * support * length_of(sph, i), sph->reach);
    sph_mass(sph)[SPH_MASS * (size_t)i + 3] = s;
    both[0] = fmax(both[0], -s);
    both[1] = fmax(both[1], s);
  }
  if (MPI_Allreduce(MPI_IN_PLACE, both, 2, MPI_DOUBLE, MPI_MAX, sph->comm) != MPI_SUCCESS)
    return part_fail(PART_ERR_MPI, "a maximum over ranks failed");
  sph->least_support = -both[0];
  for (int i = 0; i < sph->store->local; i++)
    sph_mass(sph)[SPH_MASS * (size_t)i + 3] -= 0.5 * sph->least_support;
  range[0] = 0.5 * sph->least_support;
  range[1] = both[1] - 0.5 * sph->least_support;
  return PART_OK;
}

int sph_outgrown(const sph_t *sph, int *is) {
  const double support = sph_kernel_support(sph->params.kernel);
  *is = 0;
  for (int i = 0; i < sph->store->local && !*is; i++) {
    const double listed = sph_mass(sph)[SPH_MASS * (size_t)i + 3] + 0.5 * sph->least_support;
    *is = !(support * length_of(sph, i) <= listed * (1.0 + 1e-12));
  }
  return MPI_Allreduce(MPI_IN_PLACE, is, 1, MPI_INT, MPI_MAX, sph->comm) == MPI_SUCCESS
             ? PART_OK
             : part_fail(PART_ERR_MPI, "a maximum over ranks failed");
}

int sph_least_length(const sph_t *sph, double *h) {
  double most = 0.0;
  for (int i = 0; i < sph->store->local; i++)
    most = fmax(most, sph->lens[2 * (size_t)i]);
  if (MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_DOUBLE, MPI_MAX, sph->comm) != MPI_SUCCESS)
    return part_fail(PART_ERR_MPI, "a maximum over ranks failed");
  *h = 1.0 / most;
  return PART_OK;
}
