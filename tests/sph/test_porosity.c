/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Flow without friction through a fixed region of porosity 0.7, periodic: the flux eps u is the
 * same everywhere, the pressure follows Bernoulli, p + rho (eps u) u = const (S.1 with f = 0), and
 * density diffusion takes out the noise that particles make as they are squeezed. */
#include "common.h"

enum { COLUMNS = 60, ROWS = 12 };
static const double length = 0.6, dx = 0.01, flux = 1.0, rho = 1000.0;

static double eps_of(double x) {
  x -= length * floor(x / length);
  return 1.0 - 0.15 * (tanh((x - 0.2) / 0.04) - tanh((x - 0.4) / 0.04));
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
  for (int i = 0; i < view.own; i++)
    view.eps[view.mass_stride * i] = eps_of(view.position[view.xv_stride * i]);
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

/* rms of p about its mean in a column at one moment, over rho flux^2; largest error of the mean eps
 * u. */
static double noise(double delta, double *flux_error) {
  scene s = scene_2d(length, ROWS * dx, dx);
  double squares = 0.0, number = 0.0, n[COLUMNS] = {0.0}, u[COLUMNS] = {0.0}, eps[COLUMNS * ROWS];
  s.box.periodic[0] = s.box.periodic[1] = 1;
  s.params.sound_speed = 15.0;
  s.params.density_diffusion = delta;
  s.params.artificial_viscosity = 0.05;
  sph_t *sph = scene_create(&s);
  fill(sph, &s);
  OK(sph_start(sph));
  sph_view view;
  OK(sph_get_view(sph, &view));
  for (int i = 0; i < view.own; i++)
    eps[i] = eps_of(view.position[view.xv_stride * i]);
  OK(sph_displace(sph, eps));
  for (int k = 0; k < 3000; k++) {
    bins b;
    OK(sph_advance(sph, 3e-4, NULL));
    set_eps(sph);
    if (k < 1500 || k % 50 != 0)
      continue;
    sample(sph, &b);
    for (int c = 0; c < COLUMNS; c++) {
      squares += b.n[c] > 0.0 ? fmax(b.p2[c] - b.p[c] * b.p[c] / b.n[c], 0.0) : 0.0;
      number += b.n[c];
      n[c] += b.n[c];
      u[c] += b.u[c];
    }
  }
  *flux_error = 0.0;
  for (int c = 0; c < COLUMNS; c++)
    *flux_error = fmax(*flux_error, fabs(u[c] / n[c] - flux));
  sph_destroy(sph);
  return sqrt(squares / number) / (rho * flux * flux);
}

static void step_of_porosity(void **state) {
  (void)state;
  double error[2];
  const double with = noise(0.1, &error[0]), without = noise(0.0, &error[1]);
  print_message("noise %.4f with density diffusion, %.4f without; flux off by %.4f and %.4f\n",
                with, without, error[0], error[1]);
  CLOSE(with, 0.0, 0.02);
  assert_true(without > 5.0 * with);
  CLOSE(error[0], 0.0, 0.03);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(step_of_porosity),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
