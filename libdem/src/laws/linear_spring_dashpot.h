/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Linear spring and dashpot (Cundall and Strack 1979), the law of Markauskas et al. 2017 sec. 2.
 *
 *   F_n = k_n delta - c_n v_n                  v_n = v . n, positive when the two move apart
 *   F_t = -k_t xi - c_t v_t,  |F_t| <= mu max(F_n, 0)
 *
 * c_n = 2 zeta sqrt(k_n m_eff) with zeta = -ln e / sqrt(pi^2 + ln^2 e): the closed form of a
 * head-on collision that lasts until delta = 0 again (F_n may pull shortly before that). The
 * tangential mass of two solid spheres that may turn is 2/7 m_eff (of discs 1/3), so c_t = 2 zeta
 * sqrt(k_t 2/7 m_eff) gives the tangential oscillation the same damping ratio. The limit holds for the whole
 * tangential force; when it slides, the spring is cut back so that -k_t xi - c_t v_t is that force.
 */
#ifndef DEM_LAW_LINEAR_SPRING_DASHPOT_H
#define DEM_LAW_LINEAR_SPRING_DASHPOT_H

#include "../law.h"

static inline void dem_law_linear_spring_dashpot_coefs(const dem_contact *contact,
                                                       dem_coefs *coefs) {
  const double pi = 3.14159265358979323846;
  const double log_e = log(contact->restitution);
  const double zeta = -log_e / sqrt(pi * pi + log_e * log_e);
  coefs->k_n = contact->normal_stiffness;
  coefs->k_t = contact->tangential_ratio * contact->normal_stiffness;
  /* Times sqrt(m_eff) in the law. */
  coefs->c_n = 2.0 * zeta * sqrt(coefs->k_n);
  coefs->c_t = 2.0 * zeta * sqrt(coefs->k_t * coefs->tangential_mass);
  coefs->mu = contact->friction;
}

/* Half period of the undamped contact, normal or tangential, whichever is shorter (s). */
static inline double dem_law_linear_spring_dashpot_time(const dem_coefs *coefs,
                                                        double inverse_mass) {
  const double pi = 3.14159265358979323846;
  const double k_t = coefs->mu > 0.0 ? coefs->k_t / coefs->tangential_mass : 0.0;
  return pi / sqrt(inverse_mass * (k_t > coefs->k_n ? k_t : coefs->k_n));
}

/* Normal force (N) for the step from half a step ago to half a step ahead; v_n is the velocity
 * half a step ago, so dt v_n is how the overlap shrank since the last step, exactly.
 *
 * Damping goes with the mean velocity over the step, v_n + dt F_n/(2 m_eff): second order.
 *
 * Contacts begin and end inside a step. With the velocity v of that event, s = delta/(|v| dt) steps
 * lie between it and now. The steps at s and s + 1 (0 < s < 1) then have to give together the
 * damping of s + 3/2 steps, and the spring that of the integral of the overlap over this time,
 * |v| dt^2 ((s + 1/2)^2/2 + s + 1). They do so with the weights
 *   damping  w(s) = 3/2 s for s < 1, 2 - s/2 for 1 < s < 2
 *   overlap  s + s^2/4 - s/8,  s + (2 - s)(3/8 - s/4)
 * which are continuous and vanish at s = 0, so that nothing depends on which side of an event a
 * step falls. Restitution then does not depend on where in a step two bodies meet, but for dt^2.
 *
 * *since: time (s) that the contact has existed of the last step, for the tangential spring. */
static inline vec dem_law_normal(const dem_lane_coefs *coefs, const dem_touch *touch, vec v_n,
                                 double dt, vec *since) {
  const vec h = vec_all(dt), overlap = touch->overlap, c_n = coefs->c_n * touch->root_mass;
  const vec speed_up = h * touch->inverse_root;
  const vec lag = vec_all(0.5) * coefs->c_n * speed_up;   /* c_n dt/(2 m_eff) */
  const vec damped = vec_all(1.0) / (vec_all(1.0) + lag); /* the same for all of equal spheres */
  const vec f_n = (coefs->k_n * overlap - c_n * v_n) * damped;
  const vec after = v_n + speed_up * touch->inverse_root * f_n;
  const vec way = h * vec_max(-v_n, after);
  const vec_mask edge = vec_both(touch->touches, vec_less(overlap, way + way));
  *since = h;
  if (!vec_bits(edge))
    return f_n;
  const vec s = overlap / way, two = vec_all(2.0) - s;
  const vec_mask first = vec_less(s, vec_all(1.0));
  const vec w = vec_choose(first, vec_all(1.5) * s, vec_all(1.0) + vec_all(0.5) * two);
  const vec more = vec_choose(first, s * (vec_all(0.25) * s - vec_all(0.125)),
                              two * (vec_all(0.375) - vec_all(0.25) * s));
  const vec part = (coefs->k_n * way * (s + more) - w * c_n * v_n) / (vec_all(1.0) + w * lag);
  *since = vec_choose(vec_both(edge, vec_both(first, vec_less(v_n, vec_all(0.0)))), s * h, h);
  return vec_choose(edge, part, f_n);
}

/* Rotate the spring into the contact plane, its length kept, and stretch it by v_t times
 * the time. Where the
 * turn would change the length by less than half a rounding error, the length is left alone: with
 * a = s_n/|s| it is a^2/2. */
static inline void dem_law_spring(const dem_touch *touch, const vec v_t[3], vec since,
                                  vec spring[3]) {
  const vec *n = touch->n;
  const vec s2 = spring[0] * spring[0] + spring[1] * spring[1] + spring[2] * spring[2];
  const vec s_n = spring[0] * n[0] + spring[1] * n[1] + spring[2] * n[2];
  for (int c = 0; c < 3; c++)
    spring[c] -= s_n * n[c];
  const vec_mask turns = vec_both(touch->touches, vec_less(vec_all(1e-16) * s2, s_n * s_n));
  if (vec_bits(turns)) {
    const vec p2 = spring[0] * spring[0] + spring[1] * spring[1] + spring[2] * spring[2];
    const vec scale = vec_keep(vec_less(vec_all(0.0), p2), vec_sqrt(s2 / p2));
    for (int c = 0; c < 3; c++)
      spring[c] = vec_choose(turns, scale * spring[c], spring[c]);
  }
  for (int c = 0; c < 3; c++)
    spring[c] += v_t[c] * since;
}

static inline void dem_law_linear_spring_dashpot(const dem_lane_coefs *coefs,
                                                 const dem_touch *touch, int tangential, double dt,
                                                 vec spring[3], vec force[3]) {
  const vec *n = touch->n, *v = touch->v;
  const vec v_n = v[0] * n[0] + v[1] * n[1] + v[2] * n[2];
  vec since;
  const vec f_n = dem_law_normal(coefs, touch, v_n, dt, &since);
  for (int c = 0; c < 3; c++)
    force[c] = f_n * n[c];
  if (!tangential)
    return;

  const vec c_t = coefs->c_t * touch->root_mass;
  vec v_t[3], f_t[3];
  for (int c = 0; c < 3; c++)
    v_t[c] = v[c] - v_n * n[c];
  dem_law_spring(touch, v_t, since, spring);
  for (int c = 0; c < 3; c++)
    f_t[c] = -coefs->k_t * spring[c] - c_t * v_t[c];
  const vec f2 = f_t[0] * f_t[0] + f_t[1] * f_t[1] + f_t[2] * f_t[2];
  const vec limit = coefs->mu * vec_max(f_n, vec_all(0.0));
  const vec_mask slides = vec_both(touch->touches, vec_less(limit * limit, f2));
  if (vec_bits(slides)) {
    const vec cut = limit / vec_sqrt(f2), per_k_t = vec_all(-1.0) / coefs->k_t;
    for (int c = 0; c < 3; c++) {
      const vec less = cut * f_t[c];
      spring[c] = vec_choose(slides, per_k_t * (less + c_t * v_t[c]), spring[c]);
      f_t[c] = vec_choose(slides, less, f_t[c]);
    }
  }
  for (int c = 0; c < 3; c++)
    force[c] += f_t[c];
}

#endif
