/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Oblique impact (Foerster et al. 1994; Kharaz et al. 2001: rebound angle and spin against the
 * angle of impact) against closed forms of sliding and sticking. */
#include "shot.h"

/* After the tangential impulse J against the motion along y: velocities of the first, spins. */
typedef struct rebound {
  double angle, v_t[2], w[2];
} rebound;

static rebound after_impulse(const shot *s, const outcome *o, double impulse) {
  rebound r;
  const double m_eff = 1.0 / (1.0 / o->m[0] + 1.0 / o->m[1]);
  for (int k = 0; k < 2; k++) {
    const double push = impulse / o->m[k];
    r.v_t[k] = k == 0 ? s->v[1] - push : push;
    r.w[k] = s->r[k] > 0.0 ? 2.5 * push / s->r[k] : 0.0;
  }
  r.angle = atan2(r.v_t[0], (1.0 + s->e) * m_eff / o->m[0] * s->v[0] - s->v[0]);
  return r;
}

static rebound measured(const outcome *o) {
  const body *b = o->after;
  return (rebound){
      atan2(b[0].v[1], -b[0].v[0]), {b[0].v[1], b[1].v[1]}, {fabs(b[0].w[2]), fabs(b[1].w[2])}};
}

static double off(double value, double wanted, double size) {
  return fabs(value - wanted) / fmax(fabs(wanted), size);
}

/* Worst of angle, tangential velocities and spins, relative; what passes through zero relative to a
 * tenth of the velocity before. */
static double worst(const shot *s, const rebound *r, const rebound *wanted) {
  double most = off(r->angle, wanted->angle, 0.1);
  for (int k = 0; k < 2 && s->r[k] > 0.0; k++) {
    most = fmax(most, off(r->v_t[k], wanted->v_t[k], 0.1 * s->v[1]));
    most = fmax(most, off(r->w[k], wanted->w[k], 0.1 * s->v[1] / s->r[k]));
  }
  return most;
}

static const double sizes[][2] = {{0.01, 0.0}, {0.01, 0.01}, {0.01, 0.004}, {0.004, 0.01}};

/* speed along the line of centres */
static shot shot_at(int law, int k, double degrees, double e, double mu, double fraction) {
  shot s = {.law = law, .e = e, .mu = mu, .fraction = fraction, .stiff = 1e5};
  memcpy(s.r, sizes[k % 4], sizeof s.r);
  s.triangle = k >= 4;
  s.v[0] = 0.1;
  s.v[1] = s.v[0] * tan(degrees * PI / 180.0);
  return s;
}

/* k_t/k_n = 2/7: normal and tangential oscillation are one, so that F_t/F_n is the same throughout.
 * It sticks all the time when 2/7 v_t < mu v_n, and the surface velocity is turned round with the
 * same coefficient as the normal one, but for the pull at the end, when there is no friction; else
 * it slides all the time. Walton's two regimes, exactly. */
static double linear_impulse(const shot *s, const outcome *o) {
  const double m_eff = 1.0 / (1.0 / o->m[0] + 1.0 / o->m[1]), q = peak_rebound(s->e);
  return m_eff * (1.0 + q) * fmin(2.0 / 7.0 * s->v[1], s->mu * s->v[0]);
}

/* Worst of four phases and the sizes above, on a plane and on a triangle. */
typedef double impulse_of(const shot *s, const outcome *o);
static double worst_of_phases(shot s, impulse_of *closed_form) {
  double most = 0.0;
  for (int phase = 0; phase < 4; phase++) {
    s.phase = phase / 4.0;
    const outcome o = shoot(&s);
    const rebound r = measured(&o), wanted = after_impulse(&s, &o, closed_form(&s, &o));
    most = fmax(most, worst(&s, &r, &wanted));
  }
  return most;
}

static const double restitutions[] = {1.0, 0.9, 0.5}, fractions[] = {1.0 / 20, 1.0 / 50, 1.0 / 100};
/* Asked for: 1 %. Second order in the step; what is left at t_c/100 is the turn of the line of
 * centres during the contact at 85 degrees. */
static const double bounds[] = {4e-3, 1e-3, 6e-4};

static void linear_all_angles(void **state) {
  (void)state;
  for (int n = 0; n < 9; n++) {
    double most = 0.0;
    for (int k = 0; k < 5; k++)
      for (double degrees = 5.0; degrees < 86.0; degrees += 5.0) {
        const shot s = shot_at(LINEAR, k, degrees, restitutions[n % 3], 0.3, fractions[n / 3]);
        most = fmax(most, worst_of_phases(s, linear_impulse));
      }
    assert_true(most < bounds[n / 3]);
  }
}

/* Sticks to the end, e = 1: an oscillator with the mass 2/7 m_eff for the time of the contact, for
 * any k_t/k_n. The limit goes to zero with F_n, so that it slips in the end: mu large. */
static double oscillator_impulse(const shot *s, const outcome *o) {
  const double m_eff = 1.0 / (1.0 / o->m[0] + 1.0 / o->m[1]);
  return 2.0 / 7.0 * m_eff * (1.0 - cos(PI * sqrt(3.5 * s->ratio))) * s->v[1];
}

static void linear_other_ratios(void **state) {
  (void)state;
  const double ratios[] = {0.1, 0.5, 0.8, 1.0};
  for (int n = 0; n < 20; n++) {
    double off_by[3];
    for (int f = 0; f < 3; f++) {
      shot s = shot_at(LINEAR, n % 5, 30.0, 1.0, 1e4, fractions[f]);
      s.ratio = ratios[n / 5];
      off_by[f] = worst_of_phases(s, oscillator_impulse);
    }
    assert_true(off_by[1] < 3e-3);
    assert_true(off_by[2] < off_by[0] / 25.0 * 1.34); /* second order; four phases are few */
  }
}

/* Hertz and Mindlin, e = 1, sticking to the end. With u = (delta/deepest)^(5/2), v_t while the
 * overlap grows and xi while it shrinks obey the hypergeometric equation u (1 - u) y'' + (3/5 -
 * 11/10 u) y' + lambda y = 0,   lambda = 21/5 G* / E* and the values at its ends are Gamma
 * functions: with a, b = 1/20 +- sqrt(1/400 + lambda), after over before is  pi Gamma(3/5)^2
 * (1/(Gamma(a+1/2) Gamma(b+1/2))^2 - 1/(lambda (Gamma(a) Gamma(b))^2)). Of a free sphere on a wall
 * or another; does not depend on speed or size. */
static double hertz_stick_impulse(const shot *s, const outcome *o) {
  const double m_eff = 1.0 / (1.0 / o->m[0] + 1.0 / o->m[1]), nu = 0.3;
  const double lambda = 4.2 * (1.0 - nu) / (2.0 * (2.0 - nu));
  const double root = sqrt(1.0 / 400 + lambda), a = 0.05 + root, b = 0.05 - root;
  const double middle = tgamma(a + 0.5) * tgamma(b + 0.5), ends = tgamma(a) * tgamma(b);
  const double left =
      PI * tgamma(0.6) * tgamma(0.6) * (1.0 / (middle * middle) - 1.0 / (lambda * ends * ends));
  return 2.0 / 7.0 * m_eff * (1.0 - left) * s->v[1];
}

static void hertz_sticking(void **state) {
  (void)state;
  for (int n = 0; n < 45; n++) {
    const double degrees[] = {5.0, 25.0, 45.0};
    const shot s = shot_at(HERTZ, n % 5, degrees[n / 5 % 3], 1.0, 1e6, fractions[n / 15]);
    assert_true(worst_of_phases(s, hertz_stick_impulse) < 2.0 * bounds[n / 15]);
  }
}

/* The friction of a contact that slides throughout, any law. It does when it begins to
 * (4 G* / E* tan > mu, more with damping) and v_t is left at the end. */
static double slide_impulse(const shot *s, const outcome *o) {
  return (1.0 + peak_rebound(s->e)) * s->mu * s->v[0] / (1.0 / o->m[0] + 1.0 / o->m[1]);
}

static void hertz_sliding(void **state) {
  (void)state;
  for (int n = 0; n < 9; n++) {
    double most = 0.0;
    for (int k = 0; k < 5; k++)
      for (double degrees = 66.0; degrees < 86.0; degrees += 4.0) {
        const shot s = shot_at(HERTZ, k, degrees, restitutions[n % 3], 0.3, fractions[n / 3]);
        most = fmax(most, worst_of_phases(s, slide_impulse));
      }
    assert_true(most < 2e-3);
  }
}

/* The law of D.4 to D.7 in one dimension each way, integrated with 1/40000 of the contact time:
 * partly sticking impacts have no closed form. */
static double integrated_impulse(const shot *s, const outcome *o) {
  const double m = 1.0 / (1.0 / o->m[0] + 1.0 / o->m[1]), nu = 0.3, young = s->stiff * 2e8;
  const double r = 1.0 / (1.0 / s->r[0] + (s->r[1] > 0.0 ? 1.0 / s->r[1] : 0.0));
  const double e_star = 0.5 * young / (1.0 - nu * nu);
  const double g_star = 0.25 * young / ((1.0 + nu) * (2.0 - nu));
  const double log_e = log(s->e), zeta = -log_e / sqrt(PI * PI + log_e * log_e);
  const double dt = o->contact_time / 40000;
  double depth = 0.0, v_n = s->v[0], v_t = s->v[1], spring = 0.0, sum = 0.0;
  do {
    const double was = depth;
    depth += dt * v_n;
    if (!(depth > 0.0))
      break;
    const double k_n = 2.0 * e_star * sqrt(r * depth), k_t = 8.0 * g_star * sqrt(r * depth);
    const double c = 2.0 * sqrt(5.0 / 6.0) * zeta;
    const double f_n = 2.0 / 3.0 * k_n * depth + c * sqrt(m * k_n) * v_n;
    const double c_t = c * sqrt(2.0 / 7.0 * m * k_t), limit = s->mu * fmax(f_n, 0.0);
    if (depth > was)
      spring *= sqrt(was / depth);
    spring += dt * v_t;
    double f_t = k_t * spring + c_t * v_t;
    if (fabs(f_t) > limit) {
      const double cut = (copysign(limit, f_t) - c_t * v_t) / k_t;
      spring = cut * spring < 0.0 ? 0.0 : fabs(cut) < fabs(spring) ? cut : spring;
      f_t = copysign(limit, f_t);
    }
    v_n -= dt * f_n / m;
    v_t -= dt * 3.5 * f_t / m;
    sum += dt * f_t;
  } while (depth > 0.0);
  return sum;
}

static void hertz_all_angles(void **state) {
  (void)state;
  for (int n = 0; n < 3; n++)
    for (int k = 0; k < 5; k += 2)
      for (double degrees = 5.0; degrees < 86.0; degrees += 8.0) {
        const shot s = shot_at(HERTZ, k, degrees, restitutions[n], 0.3, 1.0 / 50);
        assert_true(worst_of_phases(s, integrated_impulse) < 4e-3);
      }
}

/* The experiments, at their sizes, speeds and coefficients. Bodies are ten times as stiff as glass,
 * because the closed forms are for an overlap that is small against the radius; with the modulus of
 * glass arm and turn of the contact are off by up to 1.5 %. Bound: what is asked for, 1 %. */
typedef struct experiment {
  double r[2], speed, e, mu; /* speed: of the whole velocity, m/s */
} experiment;
static const experiment experiments[] = {
    {{0.0025, 0.0}, 3.85, 0.98, 0.092},   /* Kharaz: aluminium oxide on a glass anvil */
    {{0.0015, 0.0015}, 1.0, 0.97, 0.092}, /* Foerster: glass on glass */
    {{0.003, 0.003}, 1.0, 0.87, 0.25},    /* Foerster: cellulose acetate */
    {{0.0015, 0.0}, 1.0, 0.97, 0.092},
};

static void published_conditions(void **state) {
  (void)state;
  for (int law = LINEAR; law <= HERTZ; law++)
    for (int k = 0; k < 5; k++)
      for (double degrees = 5.0; degrees < 81.0; degrees += 5.0) {
        const experiment *x = &experiments[k % 4];
        shot s = {.law = law, .e = x->e, .mu = x->mu, .fraction = 1.0 / 50, .triangle = k == 4};
        memcpy(s.r, x->r, sizeof s.r);
        s.stiff = law == HERTZ ? 3500.0 : 1000.0;
        s.v[0] = x->speed * cos(degrees * PI / 180.0);
        s.v[1] = x->speed * sin(degrees * PI / 180.0);
        const int slides = s.v[1] > 3.6 * (1.0 + s.e) * s.mu * s.v[0];
        assert_true(worst_of_phases(s, law == LINEAR ? linear_impulse
                                       : slides      ? slide_impulse
                                                     : integrated_impulse) < 1e-2);
      }
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(linear_all_angles), cmocka_unit_test(linear_other_ratios),
      cmocka_unit_test(hertz_sticking),    cmocka_unit_test(hertz_sliding),
      cmocka_unit_test(hertz_all_angles),  cmocka_unit_test(published_conditions),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
