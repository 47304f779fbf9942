/* ranks: 1 2 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A smoothing length for each particle (S.26; Robinson et al. 2014, eq. 10-12, 19): lengths against sums over all pairs,
 * the pressure force against differences of the internal energy, the work of the pressure, momentum. */
#include "common.h"

enum { N = 12, MOST = N * N };
static const double side = 0.12, dx = 0.01;

/* Volumes from 1 to 2.5 across the box, as those of a fluid around a block of porosity 0.4; stretch 0: a lattice. */
static double place_of(double cell, double stretch) {
  return cell + stretch * side / (2.0 * PI) * sin(2.0 * PI * cell / side);
}

static scene box_of(int dimensions, int density_scheme) {
  const double length[3] = {side, side, side};
  scene s = dimensions == 2 ? scene_2d(side, side, dx) : scene_3d(length, dx);
  s.box.periodic[0] = s.box.periodic[1] = 1;
  s.box.periodic[2] = dimensions == 3;
  s.params.variable_smoothing = 1;
  s.params.smoothing_length = 1.6 * dx;
  s.params.largest_smoothing = 1.45;
  s.params.skin_fraction = 0.02;
  s.params.density_scheme = density_scheme;
  s.params.density_diffusion = 0.0;
  return s;
}

/* The sums smooth what varies over 7 lengths by 9 %: volumes are given that much larger, for summation takes less than 0.93
 * of a density that was given for a free surface. */
static const double given = 1.1;

/* The points of one layer or of as many as the box is high; `push` moves one of them (m). */
static sph_t *start(const scene *s, double stretch, double jitter, int pushed, int c, double push) {
  const int layers = s->params.dimensions == 3 ? N : 1, n = N * N * layers;
  double *x = calloc(3 * (size_t)n, sizeof *x), *volume = calloc((size_t)n, sizeof *volume);
  double *p = calloc((size_t)n, sizeof *p);
  assert_true(x && volume && p);
  for (int k = 0; k < n; k++) {
    const int at[3] = {k % N, k / N % N, k / (N * N)};
    for (int d = 0; d < (layers > 1 ? 3 : 2); d++)
      x[3 * k + d] = (at[d] + 0.5) * dx + jitter * dx * sin(12.9898 * (k + 1) + 78.233 * d);
    volume[k] = given * dx * dx * (layers > 1 ? dx : s->params.depth) *
                (1.0 + stretch * cos(2.0 * PI * (at[0] + 0.5) / N));
    x[3 * k] = fmod(place_of(x[3 * k], stretch) + side, side);
    x[3 * k + c] += k == pushed ? push : 0.0;
    p[k] = 100.0 * sin(2.0 * PI * at[1] / N);
  }
  sph_t *sph = scene_create(s);
  OK(sph_insert_points(sph, world_rank() == 0 ? n : 0, x, NULL, volume, p, NULL));
  free(x);
  free(volume);
  free(p);
  return sph;
}

static void porous(sph_t *sph) {
  sph_view view;
  OK(sph_get_view(sph, &view));
  double *eps = malloc(((size_t)view.own + 1) * sizeof *eps);
  assert_non_null(eps);
  for (int i = 0; i < view.own; i++)
    eps[i] = 0.7 + 0.3 * cos(2.0 * PI * view.position[view.xv_stride * i] / side);
  OK(sph_displace(sph, eps));
  free(eps);
}

typedef struct full {
  double x[3], m, rho, eps, p, a[3], h, omega;
} full;

/* All particles by id on every rank. */
static void gather(sph_t *sph, full *all, int n) {
  sph_view view;
  OK(sph_get_view(sph, &view));
  const int64_t *id = part_field_int64(sph_store(sph), SPH_FIELD_ID);
  const int stride = part_field_stride(sph_store(sph), SPH_FIELD_ID);
  memset(all, 0, (size_t)n * sizeof *all);
  assert_non_null(view.lens);
  for (int i = 0; i < view.own; i++) {
    full *f = &all[id[stride * i]];
    const double *xv = view.position + view.xv_stride * i, *a = view.acceleration + view.rate_stride * i;
    *f = (full){{xv[0], xv[1], xv[2]}, view.mass[view.mass_stride * i], view.density[view.mass_stride * i],
                view.eps[view.mass_stride * i], xv[7], {a[0], a[1], a[2]}, 1.0 / view.lens[2 * i],
                1.0 / view.lens[2 * i + 1]};
  }
  MPI_Allreduce(MPI_IN_PLACE, all, n * (int)(sizeof *all / sizeof(double)), MPI_DOUBLE, MPI_SUM,
                MPI_COMM_WORLD);
}

/* sum_b W_ab(h_a), the particle with it, and its h-derivative by differences; per m3. */
static double number_at(const scene *s, const full *all, int n, int a, double h) {
  const int dim = (int)s->params.dimensions;
  double sum = 0.0;
  for (int b = 0; b < n; b++) {
    double r2 = 0.0;
    for (int c = 0; c < dim; c++) {
      double d = all[a].x[c] - all[b].x[c];
      d -= side * floor(d / side + 0.5);
      r2 += d * d;
    }
    sum += sph_kernel_value(s->params.kernel, dim, h, sqrt(r2));
  }
  return sum / (dim == 2 ? s->params.depth : 1.0);
}

static double volume_at(const scene *s, double h) {
  const double k = h * s->params.spacing / s->params.smoothing_length;
  return s->params.dimensions == 2 ? k * k * s->params.depth : k * k * k;
}

/* Density, length and Omega are those of the sums over all pairs. */
static void lengths_and_sums(void **state) {
  (void)state;
  for (int dim = 2; dim <= 3; dim++) {
    const int n = dim == 3 ? N * N * N : N * N;
    static full all[N * N * N];
    const scene s = box_of(dim, SPH_SUMMATION);
    sph_t *sph = start(&s, 0.43, 0.05, -1, 0, 0.0);
    OK(sph_start(sph));
    gather(sph, all, n);
    double least = HUGE_VAL, most = 0.0;
    for (int a = 0; a < n; a += dim == 3 ? 7 : 1) {
      const double h = all[a].h, step = 1e-5 * h, volume = all[a].m / all[a].rho;
      const double slope = (number_at(&s, all, n, a, h + step) - number_at(&s, all, n, a, h - step)) / (2.0 * step);
      CLOSE(number_at(&s, all, n, a, h) * volume, 1.0, 1e-9);
      CLOSE(volume_at(&s, h) / volume, 1.0, 1e-12);
      CLOSE(all[a].omega, 1.0 + h / dim * volume * slope, 1e-7); /* differences */
      least = fmin(least, h);
      most = fmax(most, h);
    }
    assert_true(most / least > (dim == 3 ? 1.15 : 1.25));
    sph_destroy(sph);
  }
}

/* On a lattice Omega is 1 but for the error of the sums there, with both schemes, and the length is that asked for. */
static void lattice(void **state) {
  (void)state;
  static full all[N * N * N];
  for (int k = 0; k < 4; k++) {
    const int dim = 2 + k % 2, n = dim == 3 ? N * N * N : N * N;
    scene s = box_of(dim, k / 2 ? SPH_CONTINUITY : SPH_SUMMATION);
    s.params.smoothing_length = 1.5 * dx;
    sph_t *sph = start(&s, 0.0, 0.0, -1, 0, 0.0);
    OK(sph_start(sph));
    gather(sph, all, n);
    for (int a = 0; a < n; a++) {
      CLOSE(all[a].omega, 1.0, 0.01);
      CLOSE(all[a].omega, all[0].omega, 1e-6);
      CLOSE(all[a].h, s.params.smoothing_length * (k / 2 ? pow(given, 1.0 / dim) : 1.0), 0.01 * s.params.smoothing_length);
    }
    sph_destroy(sph);
  }
}

/* Internal energy per mass for the exponent 1, p = c^2 (rho_bar/eps - rho_0): its derivative by rho_bar is p/rho_bar^2. */
static double energy(const scene *s, const full *all, int n) {
  const double c2 = s->params.sound_speed * s->params.sound_speed;
  double sum = 0.0;
  for (int a = 0; a < n; a++)
    sum += all[a].m * c2 * (log(all[a].rho / s->params.density) / all[a].eps + s->params.density / all[a].rho);
  return sum;
}

static double energy_with(const scene *s, int pushed, int c, double push) {
  static full all[MOST];
  sph_t *sph = start(s, 0.43, 0.05, pushed, c, push);
  OK(sph_start(sph));
  porous(sph);
  gather(sph, all, N * N);
  sph_destroy(sph);
  return energy(s, all, N * N);
}

/* The pressure force is minus the derivative of the internal energy, which it is only with Omega. eps of a particle stays
 * as it is moved (not along x, along which eps_of depends on the place). */
static void force_is_slope_of_energy(void **state) {
  (void)state;
  static full all[MOST];
  scene s = box_of(2, SPH_SUMMATION);
  s.params.gamma = 1.0;
  sph_t *sph = start(&s, 0.43, 0.05, -1, 0, 0.0);
  OK(sph_start(sph));
  porous(sph);
  gather(sph, all, N * N);
  sph_destroy(sph);
  double largest = 0.0, error = 0.0, without = 0.0;
  const int every = world_size() == 1 ? 5 : 67; /* the energy is that of new scenes, started on all ranks */
  for (int k = 0; k < N * N; k += every) {
    const double step = 1e-3 * dx;
    /* fourth order */
    const double slope = (8.0 * (energy_with(&s, k, 1, step) - energy_with(&s, k, 1, -step)) -
                          (energy_with(&s, k, 1, 2.0 * step) - energy_with(&s, k, 1, -2.0 * step))) /
                         (12.0 * step);
    const double force = all[k].m * all[k].a[1];
    largest = fmax(largest, fabs(force));
    error = fmax(error, fabs(force + slope));
    without = fmax(without, fabs(force * all[k].omega + slope));
  }
  print_message("largest force %g N, minus the slope of the energy %g, with Omega off %g\n", largest, error, without);
  assert_true(error < 1e-6 * largest);
}

/* With continuity: the power of the pressure is what the densities take up, and momentum is kept, whatever Omega is. */
static void work(void **state) {
  (void)state;
  const scene s = box_of(2, SPH_CONTINUITY);
  sph_t *sph = start(&s, 0.43, 0.05, -1, 0, 0.0);
  sph_view view;
  double sum[5] = {0.0};
  stir(sph, &s, 0.2);
  OK(sph_start(sph));
  porous(sph);
  OK(sph_get_view(sph, &view));
  const double *rate = part_field_double(sph_store(sph), SPH_FIELD_DENSITY_RATE);
  const int stride = part_field_stride(sph_store(sph), SPH_FIELD_DENSITY_RATE);
  for (int i = 0; i < view.own; i++) {
    const double *xv = view.position + view.xv_stride * i, *a = view.acceleration + view.rate_stride * i;
    const double m = view.mass[view.mass_stride * i], density = view.density[view.mass_stride * i];
    const double one = xv[3] * xv[7] * rate[stride * i] / density;
    const double two = m * (a[0] * xv[4] + a[1] * xv[5]);
    sum[0] += one + two;
    sum[1] += fabs(one) + fabs(two);
    sum[2] += m * a[0];
    sum[3] += m * a[1];
    sum[4] += m * sqrt(a[0] * a[0] + a[1] * a[1]);
  }
  MPI_Allreduce(MPI_IN_PLACE, sum, 5, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  CLOSE(sum[0] / sum[1], 0.0, 1e-12);
  CLOSE(sum[2] / sum[4], 0.0, 1e-12);
  CLOSE(sum[3] / sum[4], 0.0, 1e-12);
  sph_destroy(sph);
}

/* An expanding gas passes the largest length that was asked for; what does not go with it is refused. */
static void errors(void **state) {
  (void)state;
  scene s = box_of(2, SPH_CONTINUITY);
  s.params.largest_smoothing = 1.05;
  sph_t *sph = start(&s, 0.43, 0.05, -1, 0, 0.0);
  FAILS(PART_ERR_RANGE, "entry largestSmoothing: particle", sph_start(sph));
  sph_destroy(sph);
  s = box_of(2, SPH_CONTINUITY);
  const scene good = s;
  s.params.shifting = 1.0;
  FAILS(PART_ERR_RANGE, "entry shifting is not allowed with variableSmoothing",
        sph_create(s.comm, &s.box, &s.params, &sph));
  s = good;
  s.params.gradient_correction = 1;
  FAILS(PART_ERR_RANGE, "entry gradientCorrection is not allowed",
        sph_create(s.comm, &s.box, &s.params, &sph));
  s = good;
  s.params.artificial_pressure = 0.1;
  FAILS(PART_ERR_RANGE, "entry artificialPressure is not allowed",
        sph_create(s.comm, &s.box, &s.params, &sph));
  s = good;
  s.params.anti_clump = 0.1;
  FAILS(PART_ERR_RANGE, "entry antiClump is not allowed", sph_create(s.comm, &s.box, &s.params, &sph));
  s = good;
  s.params.time_scheme = SPH_PREDICTOR_CORRECTOR;
  FAILS(PART_ERR_RANGE, "predictorCorrector is not allowed", sph_create(s.comm, &s.box, &s.params, &sph));
  s = good;
  s.params.density_scheme = SPH_SUMMATION;
  s.box.periodic[1] = 0;
  sph = scene_create(&s);
  add_planes(sph, &s, 1, SPH_NO_SLIP);
  fill_box(sph, &s);
  FAILS(PART_ERR_RANGE, "variableSmoothing: on with densityScheme summation has no walls", sph_start(sph));
  sph_destroy(sph);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(lengths_and_sums),
      cmocka_unit_test(lattice),
      cmocka_unit_test(force_is_slope_of_energy),
      cmocka_unit_test(work),
      cmocka_unit_test(errors),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
