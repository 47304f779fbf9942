/* ranks: 1 3 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Flow driven through a fixed bed, linear drag -k u with k = K between 1/3 and 2/3 of the length, periodic: what comes
 * through the clear fluid must go through the bed. Density diffusion carries delta h c grad p/(rho c^2) past its drag
 * unless what the drag balances is taken off (S.5): here half of the flow. */
#include "common.h"

enum { COLUMNS = 60, ROWS = 12 };
static const double length = 0.6, dx = 0.01, rho = 1000.0, sound = 1.0, flux = 2e-4;

typedef struct bed {
  double past; /* share of the flow that diffusion carries past the drag unless it knows of it */
  int width, skip, variable;
} bed;

static double drag_of(const bed *b, double x) {
  x -= length * floor(x / length);
  const double most = b->past * rho * sound / (0.1 * 1.5 * dx);
  return most * 0.5 * (tanh((x - 0.2) / 0.03) - tanh((x - 0.4) / 0.03));
}

/* Pressure of the steady flow at the middle of columns, grad p = rho g - k u; returns g. */
static double steady(const bed *b, double p[COLUMNS]) {
  enum { PARTS = 100 };
  const double d = length / (COLUMNS * PARTS);
  double all = 0.0, now = 0.0, mean = 0.0;
  for (int k = 0; k < COLUMNS * PARTS; k++)
    all += drag_of(b, (k + 0.5) * d) * flux * d;
  for (int k = 0; k < COLUMNS * PARTS; k++) {
    if (k % PARTS == PARTS / 2)
      mean += (p[k / PARTS] = now) / COLUMNS;
    now += (all / length - drag_of(b, (k + 0.5) * d) * flux) * d;
  }
  for (int c = 0; c < COLUMNS; c++)
    p[c] -= mean;
  return all / length / rho;
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
  s.params.density_diffusion = 0.1;
  s.params.background_pressure = 0.02 * rho * sound * sound;
  s.params.skip = b->skip;
  s.params.variable_smoothing = b->variable;
  sph_t *sph = scene_create(&s);
  for (int c = 0; c < COLUMNS; c++)
    for (int row = 0; row < ROWS; row++, n++) {
      x[3 * n] = (c + 0.5) * dx;
      x[3 * n + 1] = (row + 0.5) * dx;
      v[3 * n] = flux;
      p[n] = column[c] + s.params.background_pressure;
    }
  MPI_Comm_rank(comm, &rank);
  OK(sph_insert_points(sph, rank == 0 ? n : 0, x, v, NULL, p, NULL));
  OK(sph_limit_width(sph, b->width));
  OK(sph_start(sph));
  return sph;
}

static void set_drag(const bed *b, sph_t *sph) {
  sph_view view;
  OK(sph_get_view(sph, &view));
  for (int i = 0; i < view.own; i++) {
    const double *u = view.velocity + view.xv_stride * i;
    const double k = drag_of(b, view.position[view.xv_stride * i]);
    for (int c = 0; c < 2; c++)
      view.force[view.force_stride * i + c] = -k * view.volume[view.xv_stride * i] * u[c];
  }
}

/* Mean velocity in the clear fluid and in the bed, over the steady one. */
static void flows(sph_t *sph, MPI_Comm comm, double flow[2]) {
  double sums[4] = {0.0, 0.0, 0.0, 0.0};
  sph_view view;
  OK(sph_get_view(sph, &view));
  for (int i = 0; i < view.own; i++) {
    double x = view.position[view.xv_stride * i] / length;
    x -= floor(x);
    if (fabs(x - 0.5) > 0.35) { /* clear by a length of 0.09 m */
      sums[0] += view.velocity[view.xv_stride * i];
      sums[1] += 1.0;
    } else if (fabs(x - 0.5) < 0.1) {
      sums[2] += view.velocity[view.xv_stride * i];
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
    const bed b = {0.5, 0, 1, variable};
    double flow[2];
    sph_t *sph = run(&b, MPI_COMM_WORLD, 3000, 0.001);
    flows(sph, MPI_COMM_WORLD, flow);
    sph_destroy(sph);
    print_message("variable %d: clear %.4f, bed %.4f of the flow\n", variable, flow[0], flow[1]);
    CLOSE(flow[0], 1.0, 0.01);
    CLOSE(flow[1], 1.0, 0.01);
  }
}

/* What one particle gains the other loses, whatever the forces: the rate of the sum of V rho_bar by S.5 is 0. The step is so
 * short that S.4 is nothing: velocities are 1e-9 of sound. */
static void conserves(void **state) {
  (void)state;
  const bed b = {0.5, 0, 1, 0};
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
    bed b = {0.5, 1, 1, variable};
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
  const struct CMUnitTest one[] = {cmocka_unit_test(through)};
  const struct CMUnitTest any[] = {cmocka_unit_test(conserves), cmocka_unit_test(ways)};
  MPI_Init(&argc, &argv);
  int failed = cmocka_run_group_tests(any, NULL, NULL);
  if (world_size() == 1)
    failed += cmocka_run_group_tests(one, NULL, NULL);
  MPI_Finalize();
  return failed;
}
