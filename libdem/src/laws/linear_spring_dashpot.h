/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Linear spring and dashpot (Cundall and Strack 1979), the law of Markauskas et al. 2017 sec. 2.
 *
 *   F_n = k_n delta - c_n v_n                  v_n = v . n, positive when the two move apart
 *   F_t = -k_t xi - c_t v_t,  |F_t| <= mu max(F_n, 0)
 *
 * c_n = 2 zeta sqrt(k_n m_eff) with zeta = -ln e / sqrt(pi^2 + ln^2 e): the closed form of a
 * head-on collision that lasts until delta = 0 again (F_n may pull shortly before that). The
 * tangential mass of two solid spheres that may turn is 2/7 m_eff (of discs 1/3), so c_t = 2 zeta
 * sqrt(k_t 2/7 m_eff) gives the tangential oscillation the same damping ratio.
 *
 * k_n is given, or follows from the elastic constants: two spheres of the mean radius that meet
 * with the impact speed V come as deep as Hertz says (D.4), k_n = 4/5 K sqrt(d),  K = 4/3 E*
 * sqrt(R),  d = (5 m_eff V^2/(4 K))^(2/5)
 */
#ifndef DEM_LAW_LINEAR_SPRING_DASHPOT_H
#define DEM_LAW_LINEAR_SPRING_DASHPOT_H

#include "../law.h"

static inline int dem_law_linear_spring_dashpot_check(const dem_contact *contact) {
  (void)contact; /* every entry is used */
  return PART_OK;
}

static inline int dem_law_linear_spring_dashpot_elastic(const dem_contact *contact) {
  return isnan(contact->normal_stiffness);
}

static inline int dem_law_linear_stiffness(const dem_pairing *pairing, double *k_n) {
  const double r = pairing->radius, volume = 4.0 / 3.0 * 3.14159265358979323846 * r * r * r;
  double young = 0.0, shear = 0.0;
  *k_n = pairing->contact->normal_stiffness;
  if (!isnan(*k_n))
    return PART_OK;
  if (dem_elastic(pairing, &young, &shear) != PART_OK)
    return part_fail_context(PART_ERR_RANGE, "%s: entry normalStiffness is not given",
                             dem_contact_table.name);
  const double m_eff =
      volume / (1.0 / pairing->material[0]->density + 1.0 / pairing->material[1]->density);
  const double k = 4.0 / 3.0 * young * sqrt(0.5 * r);
  *k_n = 0.8 * k * pow(1.25 * m_eff * pairing->speed * pairing->speed / k, 0.2);
  return PART_OK;
}

static inline int dem_law_linear_spring_dashpot_coefs(const dem_pairing *pairing,
                                                      dem_coefs *coefs) {
  const double ratio = pairing->contact->tangential_ratio;
  const double zeta = dem_damping_ratio(pairing->contact->restitution);
  PART_TRY(dem_law_linear_stiffness(pairing, &coefs->k_n));
  coefs->k_t = (isnan(ratio) ? 2.0 / 7.0 : ratio) * coefs->k_n;
  /* Times sqrt(m_eff) in the law. */
  coefs->c_n = 2.0 * zeta * sqrt(coefs->k_n);
  coefs->c_t = 2.0 * zeta * sqrt(coefs->k_t * coefs->tangential_mass);
  return PART_OK;
}

/* Half period of the undamped contact, normal or tangential, whichever is shorter (s). */
static inline double dem_law_linear_spring_dashpot_time(const dem_coefs *coefs, double inverse_mass,
                                                        double radius, double speed) {
  const double pi = 3.14159265358979323846;
  const double k_t =
      coefs->mu > 0.0 || coefs->mu_roll > 0.0 ? coefs->k_t / coefs->tangential_mass : 0.0;
  (void)radius;
  (void)speed;
  return pi / sqrt(inverse_mass * (k_t > coefs->k_n ? k_t : coefs->k_n));
}

/* For the step from half a step ago to half a step ahead; v_n is the velocity half a step ago, so
 * dt v_n is how the overlap shrank since the last step, exactly.
 *
 * Damping goes with the mean velocity over the step, v_n + dt F_n/(2 m_eff): second order.
 *
 * Contacts begin and end inside a step. With the velocity v of that event, s = delta/(|v| dt) steps
 * lie between it and now. The steps at s and s + 1 (0 < s < 1) then have to give together the
 * damping of s + 3/2 steps, and the spring that of the integral of the overlap over this time,
 * |v| dt^2 ((s + 1/2)^2/2 + s + 1). They do so with the weights
 *   damping, attraction  w(s) = 3/2 s for s < 1, 2 - s/2 for 1 < s < 2
 *   overlap              s + s^2/4 - s/8,  s + (2 - s)(3/8 - s/4)
 * which are continuous and vanish at s = 0, so that nothing depends on which side of an event a
 * step falls. Restitution then does not depend on where in a step two bodies meet, but for dt^2.
 *
 * The tangential spring begins with the overlap (weight of the overlap). At the end it is what it
 * is (weight of a constant) but for the way v_t s dt until then, which goes with the overlap. What
 * these differ by from the spring as it is now is in proportion to v_t: `lead`, part of c_t. */
PART_LANES dem_response dem_law_linear_spring_dashpot(const dem_lane_coefs *coefs,
                                                     const dem_touch *touch, vec v_n, vec push,
                                                     double dt) {
  const vec h = vec_all(dt), one = vec_all(1.0), c_n = coefs->c_n * touch->root_mass;
  const vec speed_up = h * touch->inverse_root;
  const vec lag = vec_all(0.5) * coefs->c_n * speed_up; /* c_n dt/(2 m_eff) */
  const vec damped = one / (one + lag);                 /* the same for all of equal spheres */
  dem_response r = {.since = h,
                    .k_t = coefs->k_t,
                    .c_t = coefs->c_t * touch->root_mass,
                    .share = one,
                    .keep = one,
                    .stretch = one};
  r.force = (coefs->k_n * touch->overlap - c_n * v_n + push) * damped;
  const vec after = v_n + speed_up * touch->inverse_root * r.force;
  const vec way = h * vec_max(-v_n, after);
  if (!vec_bits(vec_both(touch->touches, vec_less(touch->overlap, way + way))))
    return r;
  const dem_edge edge = dem_edge_of(touch, way);
  const vec s = edge.s, two = vec_all(2.0) - s;
  const vec w = dem_edge_weights(&edge, s + vec_all(0.5), 1.5);
  const vec more = vec_choose(edge.first, s * (vec_all(0.25) * s - vec_all(0.125)),
                              two * (vec_all(0.375) - vec_all(0.25) * s));
  const vec part = (coefs->k_n * way * (s + more) + w * (-c_n * v_n + push)) / (one + w * lag);
  r.since =
      vec_choose(vec_both(edge.at, vec_both(edge.first, vec_less(v_n, vec_all(0.0)))), s * h, h);
  r.force = vec_choose(edge.at, part, r.force);
  r.share = vec_choose(edge.at, w, one);
  const vec_mask ends = vec_both(edge.at, vec_less(vec_all(0.0), v_n));
  const vec lead = h * r.k_t * vec_choose(ends, w * s - s - more, more);
  r.c_t = vec_choose(edge.at, w * r.c_t + lead, r.c_t);
  r.k_t = vec_choose(ends, w * r.k_t, r.k_t);
  return r;
}

#endif
