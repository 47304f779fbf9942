/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Water at rest with solids at rest in its lower half: a step of porosity under gravity. The solids
 * carry (1 - eps) of the pressure gradient (model B of S.1: f = (1 - eps) rho g), so that the
 * pressure is that of water alone. */
#include "common.h"

static const double depth = 0.3, rho = 1000.0, g = 9.81, dx = 0.01;

/* 1 above, `low` below; the step is 4 dx wide from 10 to 90 %, slanted. */
static double eps_of(double low, const double x[3], double gradient[3]) {
  const double width = 0.02, s = (x[1] + 0.3 * x[0] - 0.5 * depth) / width, e = 1.0 / cosh(s);
  gradient[1] = 0.5 * (1.0 - low) * e * e / width;
  gradient[0] = 0.3 * gradient[1];
  gradient[2] = 0.0;
  return low + 0.5 * (1.0 - low) * (1.0 + tanh(s));
}

static void set_solids(sph_t *sph, double low) {
  sph_view view;
  OK(sph_get_view(sph, &view));
  for (int i = 0; i < view.own; i++) {
    double *force = view.force + view.force_stride * i;
    const double eps =
        eps_of(low, view.position + view.xv_stride * i, view.eps_gradient + view.force_stride * i);
    view.eps[view.mass_stride * i] = eps;
    force[1] = -g * view.mass[view.mass_stride * i] * (1.0 / eps - 1.0);
  }
}

static void put_solids(sph_t *sph, double low) {
  sph_view view;
  double gradient[3];
  OK(sph_get_view(sph, &view));
  double *eps = calloc((size_t)view.own + 1, sizeof *eps);
  for (int i = 0; i < view.own; i++)
    eps[i] = eps_of(low, view.position + view.xv_stride * i, gradient);
  OK(sph_displace(sph, eps));
  free(eps);
}

/* Largest error of the pressure over rho g depth, two spacings below the surface, and rms velocity
 * over sqrt(g depth). */
static void measure(sph_t *sph, double *pressure, double *velocity) {
  sph_view view;
  double v2 = 0.0;
  *pressure = 0.0;
  OK(sph_get_view(sph, &view));
  for (int i = 0; i < view.own; i++) {
    const double *x = view.position + view.xv_stride * i, *v = view.velocity + view.xv_stride * i;
    v2 += v[0] * v[0] + v[1] * v[1];
    if (x[1] < depth - 2.0 * dx)
      *pressure = fmax(*pressure,
                       fabs(view.pressure[view.xv_stride * i] / (rho * g) - depth + x[1]) / depth);
  }
  *velocity = sqrt(v2 / view.own / (g * depth));
}

static void still(double low, double time, double *p, double *v) {
  scene s = scene_2d(0.2, 0.5, dx);
  s.params.gravity[1] = -g;
  s.params.sound_speed = 20.0;
  s.params.viscosity = 1e-3;
  s.params.artificial_viscosity = 0.05;
  sph_t *sph = scene_create(&s);
  add_planes(sph, &s, 0, SPH_NO_SLIP);
  add_planes(sph, &s, 1, SPH_NO_SLIP);
  fill_water(sph, &s, depth, 1);
  OK(sph_start(sph));
  put_solids(sph, low);
  while (sph_time(sph) < time) {
    set_solids(sph, low);
    OK(sph_advance(sph, 0.005, NULL));
  }
  measure(sph, p, v);
  sph_destroy(sph);
}

/* The slow up and down of all the water (test_still) has gone after 2 s; without a step, too, 0.006
 * and 0.0003 are left at 3 s. */
static void step_at_rest(void **state) {
  (void)state;
  static const double low[] = {1.0, 0.7, 0.4};
  for (int k = 0; k < 3; k++) {
    double p, v;
    still(low[k], 3.0, &p, &v);
    print_message("eps 1 to %.1f: pressure off by %.4f of rho g H, rms velocity %.6f sqrt(g H)\n",
                  low[k], p, v);
    CLOSE(p, 0.0, 0.01);
    CLOSE(v, 0.0, 1e-3);
  }
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(step_at_rest),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
