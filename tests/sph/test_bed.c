/* ranks: 1 3 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Flow driven through a fixed bed, linear drag -k u with k = K between 1/3 and 2/3 of the length, periodic: what comes
 * through the clear fluid must go through the bed. Density diffusion carries delta h c grad p/(rho c^2) past its drag
 * unless what the drag balances is taken off (S.5): here half of the flow. Where the porosity falls in the bed, too, the
 * velocity must rise by as much as it does, not by what its smoothed divergence makes of that (S.27). */
#include "common.h"

enum { COLUMNS = 60, ROWS = 12 };
static const double length = 0.6, dx = 0.01, rho = 1000.0, sound = 1.0, flux = 2e-4;

typedef struct bed {
  double past; /* share of the flow that diffusion carries past the drag unless it knows of it */
  int width, skip, variable;
  double low; /* porosity in the bed, 1 elsewhere */
  int thin;
  int plain;  /* without S.27 */
} bed;

/* Near 1 in the bed, 0 elsewhere. */
static double in_bed(const bed *b, double x) {
  const double half = b->thin ? 0.03 : 0.1, width = b->thin ? 0.02 : 0.03;
  x -= length * floor(x / length) + 0.5 * length;
  return 0.5 * (tanh((x + half) / width) - tanh((x - half) / width));
}

static double drag_of(const bed *b, double x) {
  return b->past * rho * sound / (0.1 * 1.5 * dx) * in_bed(b, x);
}

static double eps_of(const bed *b, double x) {
  return 1.0 - (1.0 - b->low) * in_bed(b, x);
}

static double slope_of(const bed *b, double x) {
  return (eps_of(b, x + 1e-5) - eps_of(b, x - 1e-5)) / 2e-5;
}

/* Pressure of the steady flow at the middle of columns, grad p = eps rho g - k u, eps u the flux; returns g. */
static double steady(const bed *b, double p[COLUMNS]) {
  enum { PARTS = 100 };
  const double d = length / (COLUMNS * PARTS);
  double all = 0.0, fluid = 0.0, now = 0.0, mean = 0.0;
  for (int k = 0; k < COLUMNS * PARTS; k++) {
    all += drag_of(b, (k + 0.5) * d) * flux / eps_of(b, (k + 0.5) * d) * d;
    fluid += eps_of(b, (k + 0.5) * d) * d;
  }
  for (int k = 0; k < COLUMNS * PARTS; k++) {
    const double eps = eps_of(b, (k + 0.5) * d);
    if (k % PARTS == PARTS / 2)
      mean += (p[k / PARTS] = now) / COLUMNS;
    now += (all / fluid * eps - drag_of(b, (k + 0.5) * d) * flux / eps) * d;
  }
  for (int c = 0; c < COLUMNS; c++)
    p[c] -= mean;
  return all / fluid / rho;
}

static void displace(const bed *b, sph_t *sph) {
  double eps[COLUMNS * ROWS];
  sph_view view;
  OK(sph_get_view(sph, &view));
  for (int i = 0; i < view.own; i++)
    eps[i] = eps_of(b, view.position[view.xv_stride * i]);
  OK(sph_displace(sph, eps));
}

static sph_t *make(const bed *b, MPI_Comm comm) {
  static double x[3 * COLUMNS * ROWS], v[3 * COLUMNS * ROWS], p[COLUMNS * ROWS];
  double column[COLUMNS];
  scene s = scene_2d(length, ROWS * dx, dx);
  int n = 0, rank;
  s.comm = comm;
  s.box.periodic[0] = s.box.periodic[1] = 1;
  s.params.gravity[0] = steady(b, column);
  s.params.sound_speed = sound;
  s.params.density_diffusion = b->thin ? 0.01 : 0.1;
  s.params.background_pressure = 0.02 * rho * sound * sound;
  s.params.skip = b->skip;
  s.params.variable_smoothing = b->variable;
  s.params.consistent_porosity = !b->plain;
  s.params.gradient_correction = b->thin; /* or the divergence is 0.98 of what it should be */
  sph_t *sph = scene_create(&s);
  for (int c = 0; c < COLUMNS; c++)
    for (int row = 0; row < ROWS; row++, n++) {
      x[3 * n] = (c + 0.5) * dx;
      x[3 * n + 1] = (row + 0.5) * dx;
      v[3 * n] = flux / eps_of(b, x[3 * n]);
      p[n] = column[c] + s.params.background_pressure;
    }
  MPI_Comm_rank(comm, &rank);
  OK(sph_insert_points(sph, rank == 0 ? n : 0, x, v, NULL, p, NULL));
  OK(sph_limit_width(sph, b->width));
  OK(sph_start(sph));
  if (b->low < 1.0)
    displace(b, sph);
  return sph;
}

/* And the porosity. */
static void set_drag(const bed *b, sph_t *sph) {
  sph_view view;
  OK(sph_get_view(sph, &view));
  for (int i = 0; i < view.own; i++) {
    const double *u = view.velocity + view.xv_stride * i;
    const double k = drag_of(b, view.position[view.xv_stride * i]);
    for (int c = 0; c < 2; c++)
      view.force[view.force_stride * i + c] = -k * view.volume[view.xv_stride * i] * u[c];
    view.eps[view.mass_stride * i] = eps_of(b, view.position[view.xv_stride * i]);
    view.eps_gradient[view.force_stride * i] = slope_of(b, view.position[view.xv_stride * i]);
  }
}

/* Mean superficial velocity in the clear fluid and in the bed, over the steady one. */
static void flows(const bed *b, sph_t *sph, MPI_Comm comm, double flow[2]) {
  double sums[4] = {0.0, 0.0, 0.0, 0.0};
  sph_view view;
  OK(sph_get_view(sph, &view));
  for (int i = 0; i < view.own; i++) {
    const double in = in_bed(b, view.position[view.xv_stride * i]);
    if (in < 1e-3) {
      sums[0] += view.velocity[view.xv_stride * i] * view.eps[view.mass_stride * i];
      sums[1] += 1.0;
    } else if (in > 0.98 * in_bed(b, 0.5 * length)) {
      sums[2] += view.velocity[view.xv_stride * i] * view.eps[view.mass_stride * i];
      sums[3] += 1.0;
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 4, MPI_DOUBLE, MPI_SUM, comm);
  flow[0] = sums[0] / sums[1] / flux;
  flow[1] = sums[2] / sums[3] / flux;
}

static sph_t *run(const bed *b, MPI_Comm comm, int rounds, double dt) {
  sph_t *sph = make(b, comm);
  for (int k = 0; k < rounds; k++) {
    set_drag(b, sph);
    OK(sph_advance(sph, dt, NULL));
  }
  return sph;
}

/* Sound goes five times along the periodic length; the drag is explicit, so steps are k dt/rho = 0.3. */
static void through(void **state) {
  (void)state;
  for (int variable = 0; variable < 2; variable++) {
    const bed b = {0.5, 0, 1, variable, 1.0, 0, 0};
    double flow[2];
    sph_t *sph = run(&b, MPI_COMM_WORLD, 3000, 0.001);
    flows(&b, sph, MPI_COMM_WORLD, flow);
    sph_destroy(sph);
    print_message("variable %d: clear %.4f, bed %.4f of the flow\n", variable, flow[0], flow[1]);
    CLOSE(flow[0], 1.0, 0.01);
    CLOSE(flow[1], 1.0, 0.01);
  }
}

/* Porosity 0.8 or 0.5 in a bed four h wide: what flows in it is what flows beside it. Of second order in 1/eps - 1. Little
 * diffusion, which here would carry 1 % past the drag: the slope of p is that of a kernel, too. */
static void loose(void **state) {
  (void)state;
  for (int k = 0; k < 2; k++) {
    double gap[2];
    for (int plain = 0; plain < 2; plain++) {
      const bed b = {0.03, 0, 1, 0, k ? 0.5 : 0.8, 1, plain};
      double flow[2];
      sph_t *sph = run(&b, MPI_COMM_WORLD, 3000, 0.001);
      flows(&b, sph, MPI_COMM_WORLD, flow);
      sph_destroy(sph);
      gap[plain] = fabs(flow[1] - flow[0]);
      print_message("eps %.1f, S.27 %d: clear %.4f, bed %.4f of the flow\n", b.low, !plain, flow[0], flow[1]);
    }
    CLOSE(gap[0], 0.0, k ? 0.005 : 0.001);
    assert_true(gap[1] > 4.0 * gap[0]);
  }
}

/* What one particle gains the other loses, whatever the forces: the rate of the sum of V rho_bar by S.5 is 0. The step is so
 * short that S.4 is nothing: velocities are 1e-9 of sound. */
static void conserves(void **state) {
  (void)state;
  const bed b = {0.5, 0, 1, 0, 1.0, 0, 0};
  double sums[2] = {0.0, 0.0};
  sph_view view;
  sph_t *sph = make(&b, MPI_COMM_WORLD);
  OK(sph_get_view(sph, &view));
  const int64_t *id = part_field_int64(sph_store(sph), SPH_FIELD_ID);
  const int stride = part_field_stride(sph_store(sph), SPH_FIELD_ID);
  for (int i = 0; i < view.own; i++) {
    double *v = part_field_double(sph_store(sph), SPH_FIELD_VELOCITY) + view.xv_stride * i;
    v[0] = v[1] = 0.0;
    for (int c = 0; c < 2; c++)
      view.force[view.force_stride * i + c] =
          0.01 * view.mass[view.mass_stride * i] * sin(1.0 + 7.0 * (double)id[stride * i] + c);
  }
  OK(sph_advance(sph, 1e-12, NULL));
  OK(sph_get_view(sph, &view));
  const double *rate = part_field_double(sph_store(sph), SPH_FIELD_DENSITY_RATE);
  const int rates = part_field_stride(sph_store(sph), SPH_FIELD_DENSITY_RATE);
  for (int i = 0; i < view.own; i++) {
    sums[0] += view.volume[view.xv_stride * i] * rate[rates * i];
    sums[1] += view.volume[view.xv_stride * i] * fabs(rate[rates * i]);
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  sph_destroy(sph);
  assert_true(sums[1] > 0.0);
  CLOSE(sums[0] / sums[1], 0.0, 1e-9);
}

static void same(const bed *b, MPI_Comm comm, const body *wanted) {
  static body found[COLUMNS * ROWS];
  sph_t *sph = run(b, comm, 50, 0.001);
  find_all(sph, comm, 0, COLUMNS * ROWS, found);
  sph_destroy(sph);
  for (int k = 0; k < COLUMNS * ROWS; k++)
    for (int c = 0; c < 2; c++) {
      CLOSE(found[k].v[c], wanted[k].v[c], 1e-11 * sound);
      CLOSE(found[k].density, wanted[k].density, 1e-10 * rho);
    }
}

/* Plain and vector loops, nothing skipped, one rank for itself: all the same to round-off. */
static void ways(void **state) {
  (void)state;
  static body wanted[COLUMNS * ROWS];
  for (int variable = 0; variable < 2; variable++) {
    bed b = {0.5, 1, 1, variable, 0.6, 0, 0};
    sph_t *sph = run(&b, MPI_COMM_WORLD, 50, 0.001);
    find_all(sph, MPI_COMM_WORLD, 0, COLUMNS * ROWS, wanted);
    sph_destroy(sph);
    same(&b, MPI_COMM_SELF, wanted);
    for (b.width = 4; b.width <= 8; b.width += 4)
      same(&b, MPI_COMM_WORLD, wanted);
    b.width = 0;
    b.skip = 0;
    same(&b, MPI_COMM_WORLD, wanted);
  }
}

/* On several ranks only what compares them with one. */
int main(int argc, char **argv) {
  const struct CMUnitTest one[] = {cmocka_unit_test(through), cmocka_unit_test(loose)};
  const struct CMUnitTest any[] = {cmocka_unit_test(conserves), cmocka_unit_test(ways)};
  MPI_Init(&argc, &argv);
  int failed = cmocka_run_group_tests(any, NULL, NULL);
  if (world_size() == 1)
    failed += cmocka_run_group_tests(one, NULL, NULL);
  MPI_Finalize();
  return failed;
}
