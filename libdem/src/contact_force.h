/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From the response of a law to force and torque: attraction, tangential spring, rolling. */
#ifndef DEM_CONTACT_FORCE_H
#define DEM_CONTACT_FORCE_H

#include "law.h"

/* push: attraction, < 0, or -0 without: adding -0 is nothing to compilers, too. */
typedef dem_response dem_law_function(const dem_lane_coefs *, const dem_touch *, vec v_n, vec push,
                                      double dt);

/* Rotate the spring into the contact plane, its length kept, then let it change by way. Where the
 * turn would change the length by less than half a rounding error, the length is left alone: with
 * a = s_n/|s| it is a^2/2. */
PART_LANES void dem_spring_turn(const dem_touch *touch, vec keep, const vec way[3], vec spring[3]) {
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
    spring[c] = keep * spring[c] + way[c];
}

/* A spring k and a dashpot c that act against v, together at most limit: f = -k xi - c v. The
 * dashpot goes with the mean velocity over the step, v + f dt/(2 m), so that k and c are both
 * divided by 1 + c dt/(2 m). When it slips, the spring is cut back by a factor,
 * such that along f it and the dashpot make the limit; to zero when the dashpot alone exceeds it,
 * and not at all when it is the dashpot against the spring. So a cut only takes energy. (Setting
 * the spring to what makes the limit, whatever its sign, loads it backwards when two bodies meet.)
 */
PART_LANES void dem_spring_force(const dem_touch *touch, vec stiffness, vec damping, double mass,
                                double dt, vec limit, const vec v[3], vec spring[3], vec f[3]) {
  const vec inverse_mass = vec_all(0.5 * dt / mass) * touch->inverse_root * touch->inverse_root;
  const vec damped = vec_all(1.0) / (vec_all(1.0) + damping * inverse_mass);
  const vec k = stiffness * damped, c = damping * damped;
  for (int a = 0; a < 3; a++)
    f[a] = -k * spring[a] - c * v[a];
  const vec f2 = f[0] * f[0] + f[1] * f[1] + f[2] * f[2];
  const vec_mask slips = vec_both(touch->touches, vec_less(limit * limit, f2));
  if (vec_bits(slips)) {
    const vec size = vec_sqrt(f2), cut = limit / size, zero = vec_all(0.0);
    const vec dashed = c * (v[0] * f[0] + v[1] * f[1] + v[2] * f[2]), sprung = f2 + dashed;
    const vec_mask shorter = vec_both(slips, vec_less(zero, sprung));
    const vec back = vec_max(limit * size + dashed, zero) / vec_choose(shorter, sprung, f2);
    for (int a = 0; a < 3; a++) {
      spring[a] = vec_choose(shorter, back * spring[a], spring[a]);
      f[a] = vec_choose(slips, cut * f[a], f[a]);
    }
  }
}

/* The tangential spring, k_t and c_t of the law, limit mu times the normal force. */
PART_LANES void dem_slide(const dem_lane_coefs *coefs, const dem_touch *touch, const dem_response *r,
                         vec squeeze, vec v_n, double dt, vec spring[3], vec force[3]) {
  vec v[3], way[3], f[3];
  for (int c = 0; c < 3; c++) {
    v[c] = touch->v[c] - v_n * touch->n[c];
    way[c] = v[c] * r->stretch * r->since;
  }
  dem_spring_turn(touch, r->keep, way, spring);
  dem_spring_force(touch, r->k_t, r->c_t, coefs->tangential_mass, dt, coefs->mu * squeeze, v,
                   spring, f);
  for (int c = 0; c < 3; c++)
    force[c] += f[c];
}

/* Rolling resistance: the same with the rotation R (omega_i - omega_j) about axes in the contact
 * plane in place of the displacement. The stiffness is k_t, the damping the same part of critical
 * for the least mass that rolling moves, 2/5 m_eff of spheres, the limit mu_roll times the normal
 * force. moment: torque on i, N m. */
PART_LANES void dem_roll(const dem_lane_coefs *coefs, const dem_touch *touch, const dem_response *r,
                        vec squeeze, double dt, vec spring[3], vec moment[3]) {
  const double rolling_mass = coefs->tangential_mass / (1.0 - coefs->tangential_mass);
  const vec c_r = vec_all(sqrt(rolling_mass / coefs->tangential_mass)) * r->c_t;
  const vec *n = touch->n, *spin = touch->spin;
  const vec s_n = spin[0] * n[0] + spin[1] * n[1] + spin[2] * n[2];
  vec v[3], way[3];
  for (int c = 0; c < 3; c++) {
    v[c] = touch->radius * (spin[c] - s_n * n[c]);
    way[c] = v[c] * r->stretch * r->since;
  }
  dem_spring_turn(touch, r->keep, way, spring);
  dem_spring_force(touch, r->k_t, c_r, rolling_mass, dt, coefs->mu_roll * squeeze, v, spring,
                   moment);
  for (int c = 0; c < 3; c++)
    moment[c] *= touch->radius;
}

/* Force (N) and, with rolling, torque (N m) on i; the partner gets their negatives (and both the
 * torque of the force). history: 3 or 6 values, DEM_HISTORY_WIDTH(parts). */
PART_LANES void dem_contact_force(dem_law_function *law, const dem_lane_coefs *coefs,
                                 const dem_touch *touch, int parts, double dt, vec *history,
                                 vec force[3], vec moment[3]) {
  const vec *n = touch->n, *v = touch->v;
  const vec v_n = v[0] * n[0] + v[1] * n[1] + v[2] * n[2];
  vec push = vec_all(-0.0);
  if (parts & DEM_COHESION)
    push = -coefs->pull * touch->radius;
  const dem_response r = law(coefs, touch, v_n, push, dt);
  vec squeeze = r.force; /* without attraction: what limits friction */
  if (parts & DEM_COHESION)
    squeeze -= r.share * push;
  squeeze = vec_max(squeeze, vec_all(0.0));
  for (int c = 0; c < 3; c++)
    force[c] = r.force * n[c];
  if (parts & DEM_SLIDING)
    dem_slide(coefs, touch, &r, squeeze, v_n, dt, history, force);
  if (parts & DEM_ROLLING)
    dem_roll(coefs, touch, &r, squeeze, dt, history + DEM_SPRING, moment);
}

#endif
