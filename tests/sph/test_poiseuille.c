/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Start-up of the flow between two plates (Markauskas et al. 2017, sec. 5.2.1 and fig. 3): 5 mm
 * wide, 25 particles across, against the series solution (Morris, Fox and Zhu 1997, eq. 21). */
#include "common.h"

static const double width = 5e-3, nu = 5e-4, drive = 10.0;

static double series(double y, double t) {
  double u = drive / (2.0 * nu) * y * (width - y);
  for (int n = 0; n < 200; n++) {
    const double k = PI * (2 * n + 1) / width;
    u -= 4.0 * drive * width * width / (nu * pow(PI * (2 * n + 1), 3.0)) * sin(k * y) *
         exp(-k * k * nu * t);
  }
  return u;
}

static scene channel(int kernel, int across) {
  const double dx = width / across;
  scene s = scene_2d(19 * 2e-4, width, dx);
  s.box.periodic[0] = 1;
  s.params.kernel = kernel;
  s.params.smoothing_length = 1.2 * dx;
  s.params.viscosity = 0.5;
  s.params.sound_speed = 10.0;
  s.params.gravity[0] = drive;
  return s;
}

/* rms over particles of u less the series, over the peak of the series at that time. */
static double error_at(sph_t *sph, double t) {
  sph_view view;
  double sums[2] = {0.0, 0.0}, peak = series(0.5 * width, t);
  OK(sph_get_view(sph, &view));
  for (int i = 0; i < view.own; i++) {
    const size_t at = (size_t)view.xv_stride * (size_t)i;
    const double d = view.velocity[at] - series(view.position[at + 1], t);
    sums[0] += d * d;
    sums[1] += 1.0;
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  return sqrt(sums[0] / sums[1]) / peak;
}

static void run(const scene *s, const double *times, int n, double *errors) {
  sph_report report;
  sph_t *sph = scene_create(s);
  add_planes(sph, s, 1, SPH_NO_SLIP);
  fill_box(sph, s);
  OK(sph_start(sph));
  for (int k = 0; k < n; k++) {
    OK(sph_advance(sph, times[k] - sph_time(sph), NULL));
    errors[k] = error_at(sph, times[k]);
  }
  OK(sph_get_report(sph, &report));
  CLOSE(report.budget_error, 0.0, 1e-12);
  if (getenv("SPH_SHOW") != NULL)
    print_message("steps %lld rebuilds %lld density %g to %g\n", report.steps, report.rebuilds,
                  report.least_density, report.most_density);
  sph_destroy(sph);
}

/* Figure 3: the bar is 1 % of the peak, with h = 1.2 dx as in the paper for the splines; the
 * Wendland kernels need more neighbours (h = 1.6 dx). */
static void profiles(void **state) {
  (void)state;
  const double times[3] = {1.2e-3, 6e-3, 30e-3};
  for (int k = 0; k < SPH_KERNEL_COUNT; k++) {
    double errors[3];
    scene s = channel(k, 25);
    if (k == SPH_KERNEL_wendland_c2 || k == SPH_KERNEL_wendland_c4)
      s.params.smoothing_length = 1.6 * s.params.spacing;
    run(&s, times, 3, errors);
    print_message("kernel %d: error %.4f %.4f %.4f of the peak\n", k, errors[0], errors[1],
                  errors[2]);
    for (int m = 0; m < 3; m++)
      CLOSE(errors[m], 0.0, 0.01);
  }
}

/* The same with a length for each particle, which differs from the others by the cube root of what density does. */
static void variable_lengths(void **state) {
  (void)state;
  const double times[3] = {1.2e-3, 6e-3, 30e-3};
  double fixed[3], variable[3];
  scene s = channel(SPH_KERNEL_wendland_c2, 25);
  s.params.smoothing_length = 1.6 * s.params.spacing;
  run(&s, times, 3, fixed);
  s.params.variable_smoothing = 1;
  s.params.largest_smoothing = 1.05;
  run(&s, times, 3, variable);
  for (int m = 0; m < 3; m++) {
    print_message("%g s: error %.5f of the peak, with variable h %.5f\n", times[m], fixed[m], variable[m]);
    CLOSE(variable[m], 0.0, 0.01);
    CLOSE(variable[m], fixed[m], 1e-3);
  }
}

/* At fixed h/dx the sums over neighbours keep an error that no refinement takes away; that of the
 * quintic spline at 1.2 dx (0.04 %, test_kernels) is far below the others here, so its order shows:
 * at least 1.5. */
static void order_of_refinement(void **state) {
  (void)state;
  const double times[3] = {1.2e-3, 6e-3, 30e-3};
  double errors[2][3];
  for (int variable = 0; variable < 2; variable++) {
    for (int k = 0; k < 2; k++) {
      scene s = channel(SPH_KERNEL_quintic_spline, k == 0 ? 13 : 26);
      s.params.variable_smoothing = variable;
      s.params.largest_smoothing = 1.05;
      run(&s, times, 3, errors[k]);
    }
    for (int m = 0; m < 3; m++) {
      const double order = log2(errors[0][m] / errors[1][m]);
      print_message("%s h, %g s: order %.2f\n", variable ? "variable" : "fixed", times[m], order);
      assert_true(order > 1.5);
    }
  }
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(profiles),
      cmocka_unit_test(variable_lengths),
      cmocka_unit_test(order_of_refinement),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
