/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Flow without friction through a fixed region of porosity 0.7 or 0.5, periodic: the flux eps u is
 * the same everywhere, the pressure follows Bernoulli, p + rho (eps u) u = const (S.1 with f = 0),
 * and density diffusion takes out the noise that particles make as they are squeezed. A table of
 * many cases: tests/benchmark/sphStep. */
#include "common.h"

enum { COLUMNS = 60, ROWS = 12 };
static const double length = 0.6, dx = 0.01, flux = 1.0, rho = 1000.0;

typedef struct trial {
  double low, delta, h, xsph; /* porosity, S.5, over dx, S.11 */
  int steps;                  /* of 3e-4 s between settings of eps */
  int gradient;               /* eps moves with the particles (S.18) */
  int ahead;                  /* eps is that of where particles will be (P.9) */
  int variable;               /* a smoothing length for each (S.26) */
} trial;
static trial now;

static double eps_of(double x) {
  x -= length * floor(x / length);
  return 1.0 - 0.5 * (1.0 - now.low) * (tanh((x - 0.2) / 0.04) - tanh((x - 0.4) / 0.04));
}

static double slope_of(double x) {
  x -= length * floor(x / length);
  const double a = 1.0 / cosh((x - 0.2) / 0.04), b = 1.0 / cosh((x - 0.4) / 0.04);
  return -0.5 * (1.0 - now.low) / 0.04 * (a * a - b * b);
}

/* Columns of equal mass, farther apart where eps is less, with the velocity of the steady flow. */
static void fill(sph_t *sph, const scene *s) {
  enum { PARTS = 60000 };
  static double x[3 * COLUMNS * ROWS], v[3 * COLUMNS * ROWS], volume[COLUMNS * ROWS],
      p[COLUMNS * ROWS];
  double all = 0.0, so_far = 0.0;
  int n = 0, column = 0;
  for (int k = 0; k < PARTS; k++)
    all += eps_of((k + 0.5) * length / PARTS) * length / PARTS;
  const int columns = (int)(all / dx + 0.5);
  for (int k = 0; k < PARTS; k++) {
    const double at = (k + 0.5) * length / PARTS, eps = eps_of(at);
    so_far += eps * length / PARTS;
    if (column == columns || so_far < (column + 0.5) * all / columns)
      continue;
    column++;
    for (int row = 0; row < ROWS; row++, n++) {
      x[3 * n] = at;
      x[3 * n + 1] = (row + 0.5) * dx;
      v[3 * n] = flux / eps;
      volume[n] = dx * all / columns / eps * s->params.depth;
      p[n] = rho * flux * (flux - flux / eps);
    }
  }
  OK(sph_insert_points(sph, world_rank() == 0 ? n : 0, x, v, volume, p, NULL));
}

static void set_eps(sph_t *sph) {
  sph_view view;
  OK(sph_get_view(sph, &view));
  for (int i = 0; i < view.own; i++) {
    double x = view.position[view.xv_stride * i];
    if (now.ahead) {
      const double v = view.velocity[view.xv_stride * i];
      x += 3e-4 * (v + 0.5 * 3e-4 * view.acceleration[view.rate_stride * i]);
    }
    view.eps[view.mass_stride * i] = eps_of(x);
    view.eps_gradient[view.force_stride * i] = now.gradient ? slope_of(x) : 0.0;
  }
}

typedef struct bins {
  double n[COLUMNS], p[COLUMNS], p2[COLUMNS], u[COLUMNS];
} bins;

/* p + rho (eps u) u and eps u of a moment. */
static void sample(sph_t *sph, bins *b) {
  sph_view view;
  memset(b, 0, sizeof *b);
  OK(sph_get_view(sph, &view));
  for (int i = 0; i < view.own; i++) {
    const double *x = view.position + view.xv_stride * i, eps = eps_of(x[0]);
    const int k = (int)(COLUMNS * (x[0] / length - floor(x[0] / length))) % COLUMNS;
    const double p = view.pressure[view.xv_stride * i] + rho * flux * flux / eps;
    b->n[k]++;
    b->p[k] += p;
    b->p2[k] += p * p;
    b->u[k] += eps * view.velocity[view.xv_stride * i];
  }
}

typedef struct found {
  double noise, mean; /* rms of p about its mean in a column at one moment, of that mean's error */
  double flux;        /* largest error of the mean eps u, over U */
} found;

static sph_t *make(void) {
  scene s = scene_2d(length, ROWS * dx, dx);
  double eps[COLUMNS * ROWS];
  sph_view view;
  s.box.periodic[0] = s.box.periodic[1] = 1;
  s.params.sound_speed = 15.0;
  s.params.density_diffusion = now.delta;
  s.params.artificial_viscosity = 0.05;
  s.params.smoothing_length = now.h * dx;
  s.params.xsph = now.xsph;
  s.params.variable_smoothing = now.variable;
  if (now.variable)
    s.params.skin_fraction = 0.2; /* U/0.4 */
  sph_t *sph = scene_create(&s);
  fill(sph, &s);
  OK(sph_start(sph));
  OK(sph_get_view(sph, &view));
  for (int i = 0; i < view.own; i++)
    eps[i] = eps_of(view.position[view.xv_stride * i]);
  OK(sph_displace(sph, eps));
  sph_set_eps_ahead(sph, now.ahead);
  return sph;
}

static void summarise(const double n[COLUMNS], const double p[COLUMNS], const double u[COLUMNS],
                      found *f) {
  double mean = 0.0, square = 0.0;
  for (int c = 0; c < COLUMNS; c++)
    mean += p[c] / n[c] / COLUMNS;
  for (int c = 0; c < COLUMNS; c++) {
    square += pow(p[c] / n[c] - mean, 2.0) / COLUMNS;
    f->flux = fmax(f->flux, fabs(u[c] / n[c] - flux));
  }
  f->mean = sqrt(square) / (rho * flux * flux);
}

/* From 0.45 to 0.9 s; U is a column of particles in 0.01 s. */
static found flow(trial t) {
  const int rounds = 3000 / t.steps;
  double squares = 0.0, number = 0.0, n[COLUMNS] = {0.0}, p[COLUMNS] = {0.0}, u[COLUMNS] = {0.0};
  found f = {0.0, 0.0, 0.0};
  now = t;
  sph_t *sph = make();
  for (int k = 0; k < rounds; k++) {
    bins b;
    set_eps(sph);
    OK(sph_advance(sph, 3e-4 * t.steps, NULL));
    if (k < rounds / 2 || k % (50 / t.steps) != 0)
      continue;
    sample(sph, &b);
    for (int c = 0; c < COLUMNS; c++) {
      squares += b.n[c] > 0.0 ? fmax(b.p2[c] - b.p[c] * b.p[c] / b.n[c], 0.0) : 0.0;
      number += b.n[c];
      n[c] += b.n[c];
      p[c] += b.p[c];
      u[c] += b.u[c];
    }
  }
  summarise(n, p, u, &f);
  f.noise = sqrt(squares / number) / (rho * flux * flux);
  sph_destroy(sph);
  print_message(
      "eps %.1f, delta %.1f, h %.1f dx, xsph %.1f, %d steps, gradient %d, ahead %d, variable %d: noise %.4f, mean "
      "%.4f, flux %.4f\n",
      t.low, t.delta, t.h, t.xsph, t.steps, t.gradient, t.ahead, t.variable, f.noise, f.mean, f.flux);
  return f;
}

static void diffusion(void **state) {
  (void)state;
  const found with = flow((trial){0.7, 0.1, 1.5, 0.0, 1, 1, 0, 0});
  const found without = flow((trial){0.7, 0.0, 1.5, 0.0, 1, 1, 0, 0});
  CLOSE(with.noise, 0.0, 0.01);
  assert_true(without.noise > 5.0 * with.noise);
  CLOSE(with.mean, 0.0, 0.03);
  CLOSE(with.flux, 0.0, 0.03);
}

/* The steep step: XSPH, which takes eps along, and h = 2 dx. Bars: the mean's error is of order
 * (h/width)^2, 0.03 at 0.7 with h = 1.5 dx. */
static void steep_step(void **state) {
  (void)state;
  const found f = flow((trial){0.5, 0.1, 2.0, 0.5, 1, 1, 0, 0});
  CLOSE(f.noise, 0.0, 0.01);
  CLOSE(f.mean, 0.0, 0.05);
  CLOSE(f.flux, 0.0, 0.05);
}

/* Five steps with eps set once: without its gradient the fluid in between flows as if eps were that
 * where the particle was. */
static void eps_in_between(void **state) {
  (void)state;
  const found with = flow((trial){0.7, 0.1, 1.5, 0.0, 5, 1, 0, 0});
  const found without = flow((trial){0.7, 0.1, 1.5, 0.0, 5, 0, 0, 0});
  CLOSE(with.noise, 0.0, 0.01);
  CLOSE(with.mean, 0.0, 0.03);
  assert_true(without.mean > 4.0 * with.mean);
}

/* eps of the end of each step, as the exchange with solids gives it. */
static void eps_ahead(void **state) {
  (void)state;
  const found f = flow((trial){0.5, 0.1, 2.0, 0.5, 1, 1, 1, 0});
  CLOSE(f.noise, 0.0, 0.01);
  CLOSE(f.mean, 0.0, 0.05);
  CLOSE(f.flux, 0.0, 0.05);
}

/* Superficial density falls to 0.4, where the fluid's particles are drawn out and their lengths grow (Robinson et al. 2014,
 * sec. 3.2). With h = 2 dx for all: mean 0.13, flux 0.07. */
static void variable_lengths(void **state) {
  (void)state;
  const found f = flow((trial){0.4, 0.1, 1.5, 0.5, 1, 1, 0, 1});
  CLOSE(f.noise, 0.0, 0.01);
  CLOSE(f.mean, 0.0, 0.08);
  CLOSE(f.flux, 0.0, 0.05);
}

typedef struct moved {
  double x, eps, p;
} moved;

/* One step of stirred water with a slope of eps; by id. */
static void one_step(double xsph, int ahead, double slope, moved *to) {
  enum { N = 20 };
  scene s = scene_2d(N * dx, N * dx, dx);
  sph_view view;
  s.box.periodic[0] = s.box.periodic[1] = 1;
  s.params.xsph = xsph;
  sph_t *sph = scene_create(&s);
  fill_box(sph, &s);
  stir(sph, &s, 0.5);
  OK(sph_start(sph));
  OK(sph_get_view(sph, &view));
  sph_set_eps_ahead(sph, ahead);
  for (int i = 0; i < view.own; i++) {
    view.eps[view.mass_stride * i] = 0.8;
    view.eps_gradient[view.force_stride * i] = slope;
  }
  OK(sph_advance(sph, 3e-4, NULL));
  OK(sph_get_view(sph, &view));
  const int64_t *id = part_field_int64(sph_store(sph), SPH_FIELD_ID);
  const int stride = part_field_stride(sph_store(sph), SPH_FIELD_ID);
  for (int i = 0; i < view.own; i++)
    to[id[stride * i]] = (moved){view.position[view.xv_stride * i], view.eps[view.mass_stride * i],
                                 view.pressure[view.xv_stride * i]};
  sph_destroy(sph);
}

/* The way of XSPH alone changes eps when it is ahead, by its part of the gradient, and p not at all; otherwise the whole
 * way does. */
static void ways_besides(void **state) {
  (void)state;
  static moved without[400], with[400], all[400];
  const double slope = 2.0;
  double most = 0.0;
  one_step(0.0, 1, slope, without);
  one_step(0.5, 1, slope, with);
  one_step(0.5, 0, slope, all);
  for (int k = 0; k < 400; k++) {
    const double way = with[k].x - without[k].x;
    most = fmax(most, fabs(way));
    CLOSE(without[k].eps, 0.8, 0.0);
    CLOSE(with[k].eps, 0.8 + slope * way, 1e-15);
    CLOSE(with[k].p, without[k].p, 1e-10 * 1000.0 * 10.0 * 10.0);
    assert_true(fabs(all[k].eps - with[k].eps) > 0.0);
  }
  assert_true(most > 1e-5);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(diffusion),
      cmocka_unit_test(steep_step),
      cmocka_unit_test(eps_in_between),
      cmocka_unit_test(eps_ahead),
      cmocka_unit_test(ways_besides),
      cmocka_unit_test(variable_lengths),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
