/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Linear spring and dashpot (Cundall and Strack 1979), the law of Markauskas et al. 2017 sec. 2.
 *
 *   F_n = k_n delta - c_n v_n                  v_n = v . n, positive when the two move apart
 *   F_t = -k_t xi - c_t v_t,  |F_t| <= mu max(F_n, 0)
 *
 * c_n = 2 zeta sqrt(k_n m_eff) with zeta = -ln e / sqrt(pi^2 + ln^2 e): the closed form of a
 * head-on collision that lasts until delta = 0 again (F_n may pull shortly before that). The
 * tangential mass of two solid spheres that may turn is 2/7 m_eff, so c_t = 2 zeta sqrt(k_t 2/7
 * m_eff) gives the tangential oscillation the same damping ratio. The limit holds for the whole
 * tangential force; when it slides, the spring is cut back so that -k_t xi - c_t v_t is that force.
 */
#ifndef DEM_LAW_LINEAR_SPRING_DASHPOT_H
#define DEM_LAW_LINEAR_SPRING_DASHPOT_H

#include "../law.h"

#define DEM_TANGENTIAL_MASS (2.0 / 7.0) /* of m_eff, solid spheres */

static inline void dem_law_linear_spring_dashpot_coefs(const dem_contact *contact,
                                                       dem_coefs *coefs) {
  const double pi = 3.14159265358979323846;
  const double log_e = log(contact->restitution);
  const double zeta = -log_e / sqrt(pi * pi + log_e * log_e);
  coefs->k_n = contact->normal_stiffness;
  coefs->k_t = contact->tangential_ratio * contact->normal_stiffness;
  /* Times sqrt(m_eff) in the law. */
  coefs->c_n = 2.0 * zeta * sqrt(coefs->k_n);
  coefs->c_t = 2.0 * zeta * sqrt(coefs->k_t * DEM_TANGENTIAL_MASS);
  coefs->mu = contact->friction;
}

/* Half period of the undamped contact, normal or tangential, whichever is shorter (s). */
static inline double dem_law_linear_spring_dashpot_time(const dem_coefs *coefs,
                                                        double inverse_mass) {
  const double pi = 3.14159265358979323846;
  const double k_t = coefs->mu > 0.0 ? coefs->k_t / DEM_TANGENTIAL_MASS : 0.0;
  return pi / sqrt(inverse_mass * (k_t > coefs->k_n ? k_t : coefs->k_n));
}

/* Rotate the spring into the contact plane, its length kept, and stretch it by v_t dt. */
static inline void dem_law_spring(const double n[3], const double v_t[3], double dt,
                                  double spring[3]) {
  const double s2 = spring[0] * spring[0] + spring[1] * spring[1] + spring[2] * spring[2];
  double scale = 1.0;
  if (s2 > 0.0) {
    const double s_n = spring[0] * n[0] + spring[1] * n[1] + spring[2] * n[2];
    for (int c = 0; c < 3; c++)
      spring[c] -= s_n * n[c];
    const double p2 = spring[0] * spring[0] + spring[1] * spring[1] + spring[2] * spring[2];
    scale = p2 > 0.0 ? sqrt(s2 / p2) : 0.0;
  }
  for (int c = 0; c < 3; c++)
    spring[c] = scale * spring[c] + v_t[c] * dt;
}

static inline void dem_law_linear_spring_dashpot(const dem_coefs *coefs, const dem_touch *touch,
                                                 int tangential, double dt, double spring[3],
                                                 double force[3]) {
  const double *n = touch->n, *v = touch->v;
  const double root_mass = 1.0 / sqrt(touch->inverse_mass);
  const double v_n = v[0] * n[0] + v[1] * n[1] + v[2] * n[2];
  const double f_n = coefs->k_n * touch->overlap - coefs->c_n * root_mass * v_n;
  for (int c = 0; c < 3; c++)
    force[c] = f_n * n[c];
  if (!tangential)
    return;

  const double c_t = coefs->c_t * root_mass;
  double v_t[3], f_t[3];
  for (int c = 0; c < 3; c++)
    v_t[c] = v[c] - v_n * n[c];
  dem_law_spring(n, v_t, dt, spring);
  for (int c = 0; c < 3; c++)
    f_t[c] = -coefs->k_t * spring[c] - c_t * v_t[c];
  const double f2 = f_t[0] * f_t[0] + f_t[1] * f_t[1] + f_t[2] * f_t[2];
  const double limit = f_n > 0.0 ? coefs->mu * f_n : 0.0;
  if (f2 > limit * limit) {
    const double cut = limit / sqrt(f2);
    for (int c = 0; c < 3; c++) {
      f_t[c] *= cut;
      spring[c] = -(f_t[c] + c_t * v_t[c]) / coefs->k_t;
    }
  }
  for (int c = 0; c < 3; c++)
    force[c] += f_t[c];
}

#endif
