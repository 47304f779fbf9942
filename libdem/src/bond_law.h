/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The linear parallel bond (Potyondy and Cundall 2004; Wu et al. 2018, sec. 3.2) as a potential of
 * the two positions and orientations, so that it follows any turn of the pair exactly, nothing is
 * summed up from step to step, and energy has a bounded error (doc/equations.md, B.1 to B.6).
 *
 * With e the unit vector from a to b, L their distance, n the direction of the bond when it was
 * made, t = q n q^-1 its image fixed to each end, (w, v) = q_b q_a^-1, shares s_a + s_b = 1 of the
 * radii:
 *
 *   U = k_n (L - L0)^2/2 + S [s_a (1 - t_a.e) + s_b (1 - t_b.e)] + C (1 - t_a.t_b) + 2 k_t |v|^2
 *   S = k_s L0^2,   C = k_b - k_t - s_a s_b S
 *
 * For small turns th of the ends and al of the line that is k_s L0^2 (al - s_a th_a - s_b th_b)^2/2
 * + k_b (th_a - th_b)^2/2 + k_t (twist)^2/2: springs at the contact point. It is of the family of
 * Kuzkin and Asonov (2012), with the shear spring at the contact point of unequal spheres. */
#ifndef DEM_BOND_LAW_H
#define DEM_BOND_LAW_H

#include <math.h>

#include "rotation.h"

/* A bond with at least one own end. End 0 has the lower id. */
typedef struct dem_link {
  int end[2]; /* particles; one of them may be a ghost */
  int rule, state;
  double rest[3];            /* m, from end 0 to end 1 when the bond was made */
  double length;             /* m, of rest */
  double share[2];           /* r/(sum of radii) */
  double k_n, k_s, k_b, k_t; /* N/m normal and shear, N m bending and twist */
  double c_n, c_s, c_b, c_t; /* kg/s, kg m2/s */
  double area, bend, twist;  /* m2, section; 1/m3, stress per moment as it counts for breaking */
  double spring[3];          /* m, tangential, of a broken bond that is still pressed */
} dem_link;

/* What a bond does at an instant. */
typedef struct dem_bond_load {
  double e[3], length; /* unit vector from end 0 to end 1, m */
  double force[3];     /* N, on end 1 */
  double torque[2][3]; /* N m, on the ends about their centres */
  double moment[3];    /* N m, on end 1 about the contact point */
  double energy;       /* J */
} dem_bond_load;

/* Vector turned by the unit quaternion q = (w, x, y, z). */
static inline void dem_turned(const double q[4], const double n[3], double t[3]) {
  double c[3], cc[3];
  dem_cross(q + 1, n, c);
  dem_cross(q + 1, c, cc);
  for (int k = 0; k < 3; k++)
    t[k] = n[k] + 2.0 * (q[0] * c[k] + cc[k]);
}

/* Turn q by the vector h (half the angle, rad), |h| small: the Cayley map, of second order, and a
 * canonical one for spheres, as the angle depends on |h| alone. */
static inline void dem_turn_by(double q[4], const double h[3]) {
  const double step[4] = {1.0, h[0], h[1], h[2]};
  dem_turn_product(step, q, q);
  dem_turn_normalise(q);
}

static inline void dem_bond_line(const double d[3], dem_bond_load *load) {
  load->length = sqrt(dem_dot(d, d));
  for (int c = 0; c < 3; c++)
    load->e[c] = d[c] / load->length;
}

/* Vector part of q_b q_a^-1 times its scalar part: sin(angle)/2 along the axis of the relative
 * turn. */
static inline void dem_relative_turn(const double a[4], const double b[4], double half_sine[3],
                                     double *v2) {
  double c[3], v[3];
  const double w = a[0] * b[0] + dem_dot(a + 1, b + 1);
  dem_cross(a + 1, b + 1, c);
  for (int k = 0; k < 3; k++) {
    v[k] = a[0] * b[k + 1] - b[0] * a[k + 1] + c[k];
    half_sine[k] = w * v[k];
  }
  *v2 = dem_dot(v, v);
}

static inline double dem_half_square(const double a[3], const double b[3]) {
  const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  return 0.5 * dem_dot(d, d); /* 1 - a.b of unit vectors, without cancellation */
}

/* Elastic part: forces, torques, moment and energy from the distance d and the orientations. */
static inline void dem_bond_elastic(const dem_link *link, const double d[3], const double q[2][4],
                                    dem_bond_load *load) {
  double t[2][3], n[3], m[3], turn[3], v2, cross[3], te[2][3], across[3];
  const double *s = link->share, L0 = link->length, k_t = link->k_t;
  const double S = link->k_s * L0 * L0, C = link->k_b - k_t - s[0] * s[1] * S;
  dem_bond_line(d, load);
  for (int c = 0; c < 3; c++)
    n[c] = link->rest[c] / L0;
  for (int k = 0; k < 2; k++)
    dem_turned(q[k], n, t[k]);
  for (int c = 0; c < 3; c++)
    m[c] = s[0] * t[0][c] + s[1] * t[1][c];
  dem_relative_turn(q[0], q[1], turn, &v2);
  dem_cross(t[0], t[1], cross);
  for (int k = 0; k < 2; k++)
    dem_cross(t[k], load->e, te[k]);
  for (int c = 0; c < 3; c++)
    across[c] = te[1][c] - te[0][c];
  const double stretch = load->length - L0, me = dem_dot(m, load->e), shear = S / load->length;
  for (int c = 0; c < 3; c++) {
    load->force[c] = -link->k_n * stretch * load->e[c] + shear * (m[c] - me * load->e[c]);
    const double couple = C * cross[c] + 2.0 * k_t * turn[c];
    load->torque[0][c] = S * s[0] * te[0][c] + couple;
    load->torque[1][c] = S * s[1] * te[1][c] - couple;
    load->moment[c] = s[0] * s[1] * S * across[c] - couple;
  }
  load->energy =
      0.5 * link->k_n * stretch * stretch +
      S * (s[0] * dem_half_square(t[0], load->e) + s[1] * dem_half_square(t[1], load->e)) +
      C * dem_half_square(t[0], t[1]) + 2.0 * k_t * v2;
}

/* Tensile and shear stress (Pa), Wu et al. 2018 eq. 37-38, of the elastic part. */
static inline void dem_bond_stress(const dem_link *link, const dem_bond_load *load, double *tensile,
                                   double *shear) {
  const double f_n = -dem_dot(load->force, load->e), m_t = dem_dot(load->moment, load->e);
  double f2 = 0.0, m2 = 0.0;
  for (int c = 0; c < 3; c++) {
    const double f = load->force[c] + f_n * load->e[c], m = load->moment[c] - m_t * load->e[c];
    f2 += f * f;
    m2 += m * m;
  }
  *tensile = f_n / link->area + link->bend * sqrt(m2);
  *shear = sqrt(f2) / link->area + link->twist * fabs(m_t);
}

/* Velocity of end 1 against end 0 at the contact point; v, w: of the ends. */
static inline void dem_bond_slip(const dem_link *link, const dem_bond_load *load,
                                 const double *const v[2], const double w[2][3], double slip[3]) {
  double u[3], c[3];
  for (int k = 0; k < 3; k++)
    u[k] = load->length * (link->share[0] * w[0][k] + link->share[1] * w[1][k]);
  dem_cross(u, load->e, c);
  for (int k = 0; k < 3; k++)
    slip[k] = v[1][k] - v[0][k] - c[k];
}

/* A force on end 1 at the contact point, and its reaction. */
static inline void dem_bond_push(const dem_link *link, const double f[3], dem_bond_load *load) {
  double c[3];
  dem_cross(load->e, f, c);
  for (int k = 0; k < 3; k++) {
    load->force[k] += f[k];
    load->torque[0][k] -= link->share[0] * load->length * c[k];
    load->torque[1][k] -= link->share[1] * load->length * c[k];
  }
}

/* Dashpots beside the four springs. */
static inline void dem_bond_damp(const dem_link *link, const double *const v[2],
                                 const double w[2][3], dem_bond_load *load) {
  double slip[3], turn[3], f[3];
  dem_bond_slip(link, load, v, w, slip);
  for (int c = 0; c < 3; c++)
    turn[c] = w[1][c] - w[0][c];
  const double along = dem_dot(slip, load->e), about = dem_dot(turn, load->e);
  for (int c = 0; c < 3; c++) {
    f[c] = -link->c_s * slip[c] + (link->c_s - link->c_n) * along * load->e[c];
    const double couple = -link->c_b * turn[c] + (link->c_b - link->c_t) * about * load->e[c];
    load->torque[0][c] -= couple;
    load->torque[1][c] += couple;
  }
  dem_bond_push(link, f, load);
}

/* A broken bond whose ends are still pressed together keeps its normal spring in compression, and
 * slides with friction mu. */
static inline void dem_bond_pressed(dem_link *link, const double d[3], const double *const v[2],
                                    const double w[2][3], double mu, double dt,
                                    dem_bond_load *load) {
  double slip[3], f[3], *s = link->spring;
  *load = (dem_bond_load){.energy = 0.0};
  dem_bond_line(d, load);
  dem_bond_slip(link, load, v, w, slip);
  const double press = link->length - load->length, apart = dem_dot(slip, load->e);
  const double f_n = press > 0.0 ? fmax(link->k_n * press - link->c_n * apart, 0.0) : 0.0;
  const double s_n = dem_dot(s, load->e), s2 = dem_dot(s, s);
  double p2 = 0.0, f2 = 0.0;
  for (int c = 0; c < 3; c++) {
    s[c] -= s_n * load->e[c];
    p2 += s[c] * s[c];
  }
  const double scale = p2 > 0.0 ? sqrt(s2 / p2) : 0.0;
  for (int c = 0; c < 3; c++) {
    const double v_t = slip[c] - apart * load->e[c];
    s[c] = scale * s[c] + dt * v_t;
    f[c] = -link->k_s * s[c] - link->c_s * v_t;
    f2 += f[c] * f[c];
  }
  const double limit = mu * f_n, cut = f2 > limit * limit ? limit / sqrt(f2) : 1.0;
  for (int c = 0; c < 3; c++) {
    if (cut < 1.0) {
      const double c_v = -link->k_s * s[c] - f[c];
      s[c] = link->k_s > 0.0 ? -(cut * f[c] + c_v) / link->k_s : 0.0;
    }
    f[c] = cut * f[c] + f_n * load->e[c];
  }
  dem_bond_push(link, f, load);
  load->energy =
      0.5 * (link->k_n * fmax(press, 0.0) * fmax(press, 0.0) + link->k_s * dem_dot(s, s));
}

#endif
