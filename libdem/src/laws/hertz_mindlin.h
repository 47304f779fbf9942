/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hertz (1882) in normal and Mindlin (1949, no micro-slip) in tangential direction.
 *
 *   F_n = K delta^(3/2) - alpha sqrt(m_eff K) delta^(1/4) v_n,      K = 4/3 E* sqrt(R)
 *   dF_t = -k_t v_t dt - damping,  k_t = 8 G* sqrt(R delta),  |F_t| <= mu max(F_n, 0)
 *
 * The damping is that of Tsuji et al. 1992; its restitution does not depend on the velocity. With
 * y = delta^(5/4) in place of the overlap the motion is that of a linear spring (Antypov and
 * Elliott 2011), so that alpha = sqrt(5) zeta exactly, zeta as for linear_spring_dashpot. c_t = 2
 * sqrt(5/6) zeta sqrt(k_t 2/7 m_eff), the same over the stiffness k_n = dF_n/ddelta = 3/2 K
 * sqrt(delta).
 *
 * While the overlap grows, the force of the tangential spring stays, because what comes into
 * contact is not strained; while it shrinks, the force shrinks with the stiffness, because what
 * leaves the contact takes its part along (Thornton, Cummins and Cleary 2013). With the force
 * written as -k_t xi: the first shortens xi by the ratio of stiffnesses, the second leaves it
 * alone. A force -k_t xi without this rule gains energy from slides that begin early and end late.
 */
#ifndef DEM_LAW_HERTZ_MINDLIN_H
#define DEM_LAW_HERTZ_MINDLIN_H

#include "../law.h"

static inline int dem_law_hertz_mindlin_check(const dem_contact *contact) {
  const char *law = "hertzMindlin", *instead = ", which has the elastic constants of the materials";
  PART_TRY(dem_not_used(law, "normalStiffness", contact->normal_stiffness, instead));
  return dem_not_used(law, "tangentialRatio", contact->tangential_ratio, instead);
}

static inline int dem_law_hertz_mindlin_elastic(const dem_contact *contact) {
  (void)contact;
  return 1;
}

/* Without the factors that the law adds: sqrt(R delta) in the stiffness, the root of that times
 * sqrt(m_eff) in the damping. */
static inline int dem_law_hertz_mindlin_coefs(const dem_pairing *pairing, dem_coefs *coefs) {
  const double zeta = dem_damping_ratio(pairing->contact->restitution);
  double young = 0.0, shear = 0.0;
  PART_TRY(dem_elastic(pairing, &young, &shear));
  coefs->k_n = 4.0 / 3.0 * young;
  coefs->k_t = 8.0 * shear;
  coefs->c_n = sqrt(5.0 * coefs->k_n) * zeta;
  coefs->c_t = 2.0 * sqrt(5.0 / 6.0 * coefs->tangential_mass * coefs->k_t) * zeta;
  return PART_OK;
}

/* Duration of an undamped impact with the speed, 2.94 d/V at the depth d, or half a period of the
 * tangential spring at this depth, whichever is shorter (s). Goes with speed^(-1/5). */
static inline double dem_law_hertz_mindlin_time(const dem_coefs *coefs, double inverse_mass,
                                                double radius, double speed) {
  const double pi = 3.14159265358979323846;
  const double deep = pow(1.25 * speed * speed / (inverse_mass * coefs->k_n * sqrt(radius)), 0.4);
  /* 2 int_0^1 dz/sqrt(1 - z^(5/2)) = 4/5 sqrt(pi) Gamma(2/5)/Gamma(9/10) */
  const double normal = 2.9432751843247047 * deep / speed;
  const double k_t = coefs->k_t * sqrt(radius * deep) / coefs->tangential_mass;
  const double tangential =
      coefs->mu > 0.0 || coefs->mu_roll > 0.0 ? pi / sqrt(inverse_mass * k_t) : HUGE_VAL;
  return normal < tangential ? normal : tangential;
}

/* With x = s + 3/2 and its fourth root q: T(s) = -zeta(-1/4, s + 2) and -zeta(-1/2, s + 2) by Euler
 * and Maclaurin: the integral of x^(1/4), x^(1/2) up to x, and what the sum over the steps after it
 * lacks. To 1e-5 for x >= 3/2. */
PART_LANES vec dem_hertz_fourth_root(vec x, vec q) {
  const vec i = vec_all(1.0) / x;
  return q * (vec_all(0.8) * x + i * (vec_all(7.0 / 5760 * 21 / 64) * i * i - vec_all(1.0 / 96)));
}
PART_LANES vec dem_hertz_square_root(vec x, vec q) {
  const vec i = vec_all(1.0) / x;
  return q * q *
         (vec_all(2.0 / 3.0) * x + i * (vec_all(7.0 / 5760 * 3 / 8) * i * i - vec_all(1.0 / 48)));
}

/* The ends of a contact, as in linear_spring_dashpot, for the powers of the overlap that the parts
 * of the force go with: damping 1/4, the spring in tangential direction at the end 1/2. The normal
 * spring vanishes with 3/2 and needs nothing. */
PART_LANES void dem_hertz_edge(const dem_touch *touch, vec h, vec way, vec v_n, vec spring,
                              vec damping, vec lag, vec push, dem_response *r) {
  const dem_edge edge = dem_edge_of(touch, way);
  const vec s = vec_choose(edge.at, edge.s, vec_all(1.0)), one = vec_all(1.0);
  const vec x = s + vec_all(0.5), q = vec_sqrt(vec_sqrt(x)), root = vec_sqrt(s);
  const vec w = dem_edge_weights(&edge, x, 1.5);
  const vec fourth =
      dem_edge_weights(&edge, dem_hertz_fourth_root(x, q), 1.32045126422858) / vec_sqrt(root);
  const vec square = dem_edge_weights(&edge, dem_hertz_square_root(x, q), 1.20788622497735) / root;
  const vec_mask ends = vec_both(edge.at, vec_less(vec_all(0.0), v_n));
  const vec_mask begins = vec_both(edge.first, vec_less(v_n, vec_all(0.0)));
  r->since = vec_choose(vec_both(edge.at, begins), s * h, h);
  r->force =
      vec_choose(edge.at, (spring - fourth * damping + w * push) / (one + fourth * lag), r->force);
  r->share = vec_choose(edge.at, w, one);
  r->c_t = vec_choose(edge.at, fourth * r->c_t, r->c_t);
  r->k_t = vec_choose(ends, square * r->k_t, r->k_t);
}

PART_LANES dem_response dem_law_hertz_mindlin(const dem_lane_coefs *coefs, const dem_touch *touch,
                                             vec v_n, vec push, double dt) {
  const vec h = vec_all(dt), one = vec_all(1.0), half = vec_all(0.5);
  const vec contact = vec_sqrt(touch->radius * touch->overlap), root = vec_sqrt(contact);
  const vec damping = coefs->c_n * touch->root_mass * root * v_n;
  const vec speed_up = h * touch->inverse_root, lag = half * coefs->c_n * root * speed_up;
  const vec before = vec_max(touch->overlap + h * v_n, vec_all(0.0)); /* overlap, a step ago */
  const vec shallow = one / touch->overlap;
  const vec_mask deeper = vec_less(before, touch->overlap);
  const vec spring = coefs->k_n * contact * touch->overlap;
  dem_response r = {.since = h, .share = one, .k_t = coefs->k_t * contact};
  r.keep = vec_choose(deeper, vec_sqrt(before * shallow), one);
  r.stretch = vec_choose(deeper, vec_sqrt(half * (before + touch->overlap) * shallow), one);
  r.c_t = coefs->c_t * touch->root_mass * root;
  r.force = (spring - damping + push) / (one + lag);
  const vec after = v_n + speed_up * touch->inverse_root * r.force;
  const vec way = h * vec_max(-v_n, after);
  if (vec_bits(vec_both(touch->touches, vec_less(touch->overlap, way + way))))
    dem_hertz_edge(touch, h, way, v_n, spring, damping, lag, push, &r);
  return r;
}

#endif
