/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Water at rest in a tank: hydrostatic pressure to within 1 % of that at the bottom, in corners too, hardly any motion,
 * and walls that carry its weight. */
#include "common.h"

static const double g = 9.81, depth_of_water = 0.2;

static scene tank(int dim, double dx) {
  const double length[3] = {0.2, 0.12, 0.3};
  scene s = dim == 2 ? scene_2d(0.2, 0.3, dx) : scene_3d(length, dx);
  s.params.gravity[dim - 1] = -g;
  s.params.sound_speed = 10.0 * sqrt(g * depth_of_water);
  s.params.viscosity = 1e-3;
  s.params.artificial_viscosity = 0.02;
  return s;
}

typedef struct rest {
  double pressure, speed; /* largest error over that at the bottom; rms over sqrt(g H) */
  double level;           /* m, highest particle */
  double moved;           /* m, largest displacement */
} rest;

static rest look(sph_t *sph, int dim, const double *before) {
  rest r = {0.0, 0.0, 0.0, 0.0};
  sph_view view;
  double v2 = 0.0;
  (void)before;
  OK(sph_get_view(sph, &view));
  for (int i = 0; i < view.own; i++) {
    const double *x = view.position + view.xv_stride * i, *v = view.velocity + view.xv_stride * i;
    const double p = view.pressure[view.xv_stride * i];
    const double wanted = 1000.0 * g * (depth_of_water - x[dim - 1]);
    r.pressure = fmax(r.pressure, fabs(p - wanted));
    v2 += v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    r.level = fmax(r.level, x[dim - 1]);
    if (getenv("SPH_SHOW") && fabs(p - wanted) > 0.01 * 1000.0 * g * depth_of_water)
      print_message("at %g %g %g: %g wanted %g\n", x[0], x[1], x[2], p, wanted);
  }
  r.pressure /= 1000.0 * g * depth_of_water;
  r.speed = sqrt(v2 / view.own / (g * depth_of_water));
  return r;
}

static void stay(int dim, double dx, int slip, int kernel, double time) {
  scene s = tank(dim, dx);
  sph_report report;
  double force[3], impulse[3], weight;
  s.params.kernel = kernel;
  s.params.smoothing_length = (kernel == SPH_KERNEL_quintic_spline ? 1.2 : 1.5) * dx;
  sph_t *sph = scene_create(&s);
  for (int c = 0; c < dim; c++)
    add_planes(sph, &s, c, slip);
  fill_water(sph, &s, depth_of_water, dim - 1);
  OK(sph_start(sph));
  OK(sph_advance(sph, time, NULL));
  const rest r = look(sph, dim, NULL);
  OK(sph_get_report(sph, &report));
  CLOSE(report.budget_error, 0.0, 1e-12);
  OK(sph_get_wall_force(sph, 2 * (dim - 1), force, impulse));
  weight = 1000.0 * g * depth_of_water * 0.2 * (dim == 2 ? s.params.depth : 0.12);
  print_message("%d-D, dx %g, slip %d, kernel %d: pressure %.4f, speed %.2e, level %.5f, floor %.4f of the weight, "
                "%lld steps\n",
                dim, dx, slip, kernel, r.pressure, r.speed, r.level, -force[dim - 1] / weight, report.steps);
  if (getenv("SPH_SHOW"))
    return;
  CLOSE(r.pressure, 0.0, 0.01);
  CLOSE(r.speed, 0.0, 1e-3);
  CLOSE(-force[dim - 1] / weight, 1.0, 0.02);
  sph_destroy(sph);
}

static void in_the_plane(void **state) {
  (void)state;
  for (int kernel = 0; kernel < SPH_KERNEL_COUNT; kernel++)
    stay(2, 0.01, SPH_NO_SLIP, kernel, 1.0);
  stay(2, 0.01, SPH_FREE_SLIP, SPH_KERNEL_wendland_c2, 1.0);
}

static void in_space(void **state) {
  (void)state;
  stay(3, 0.02, SPH_NO_SLIP, SPH_KERNEL_wendland_c2, 0.5);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(in_the_plane),
      cmocka_unit_test(in_space),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
