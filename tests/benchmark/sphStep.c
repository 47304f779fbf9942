/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Noise of the pressure where the porosity changes. Used by tests/benchmark/sphStep.
 *
 *   sphStep [ENTRY=VALUE ...]
 *
 * Flow without friction through a fixed region of porosity `low`, periodic, two dimensions, 60 x 12
 * particles: the flux eps u is U everywhere and p + rho U u is constant (S.1 with f = 0,
 * Bernoulli). Entries: low 0.7, width 0.04 m (eps = 1 to low as tanh(x/width)), delta 0.1 (S.5),
 * alpha 0.05 (S.10), h 1.5 (over dx), background 0 (over rho U^2), xsph, shifting, antiClump,
 * artificialPressure 0, rate 1 (eps follows the particles between settings, S.18; 0: it does not),
 * sub 1 (steps between settings), refine 1, kernel 2 (row of kernels.def), sound 15 m/s, time 0.9
 * s. Prints noise of p about its mean in a column at one moment: everywhere, where eps changes; rms
 * error of the mean p; error of the mean flux: all over rho U^2 and U, from the later half. */
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../libsph/src/internal.h"

enum { COLUMNS = 60, ROWS = 12 };
static const double length = 0.6, flux = 1.0, rho = 1000.0;

typedef struct option {
  const char *name;
  double value;
} option;
enum {
  LOW,
  WIDTH,
  DELTA,
  ALPHA,
  H,
  BACKGROUND,
  XSPH,
  RATE,
  SUB,
  REFINE,
  KERNEL,
  TIME,
  SOUND,
  SHIFT,
  REPEL,
  CLUMP,
  CONSISTENT,
  OPTIONS
};
static option options[OPTIONS] = {{"low", 0.7},
                                  {"width", 0.04},
                                  {"delta", 0.1},
                                  {"alpha", 0.05},
                                  {"h", 1.5},
                                  {"background", 0.0},
                                  {"xsph", 0.0},
                                  {"rate", 1.0},
                                  {"sub", 1.0},
                                  {"refine", 1.0},
                                  {"kernel", SPH_KERNEL_wendland_c2},
                                  {"time", 0.9},
                                  {"sound", 15.0},
                                  {"shifting", 0.0},
                                  {"artificialPressure", 0.0},
                                  {"antiClump", 0.0},
                                  {"consistent", 1.0}};

static void check(int status) {
  if (status == PART_OK)
    return;
  fprintf(stderr, "sphStep: %s\n", part_last_error());
  MPI_Abort(MPI_COMM_WORLD, 1);
}

static double value(int k) {
  return options[k].value;
}

static void read_options(int argc, char **argv) {
  for (int a = 1; a < argc; a++) {
    const char *equals = strchr(argv[a], '=');
    int k = 0;
    while (k < OPTIONS &&
           (equals == NULL || strlen(options[k].name) != (size_t)(equals - argv[a]) ||
            strncmp(options[k].name, argv[a], (size_t)(equals - argv[a])) != 0))
      k++;
    if (k == OPTIONS) {
      fprintf(stderr, "sphStep: %s is not an entry=value\n", argv[a]);
      exit(2);
    }
    options[k].value = atof(equals + 1);
  }
}

static double eps_of(double x) {
  x -= length * floor(x / length);
  const double w = value(WIDTH);
  return 1.0 - 0.5 * (1.0 - value(LOW)) * (tanh((x - 0.2) / w) - tanh((x - 0.4) / w));
}

static double slope_of(double x) {
  x -= length * floor(x / length);
  const double w = value(WIDTH), a = 1.0 / cosh((x - 0.2) / w), b = 1.0 / cosh((x - 0.4) / w);
  return -0.5 * (1.0 - value(LOW)) / w * (a * a - b * b);
}

/* Columns of equal mass, farther apart where eps is less, with the velocity of the steady flow. */
static void fill(sph_t *sph) {
  enum { PARTS = 60000 };
  const int refine = (int)value(REFINE), rows = ROWS * refine;
  const double dx = 0.01 / refine;
  double *x = calloc((size_t)(8 * COLUMNS * ROWS * refine * refine), sizeof *x), all = 0.0,
         so_far = 0.0;
  double *v = x + 3 * COLUMNS * ROWS * refine * refine,
         *volume = v + 3 * COLUMNS * ROWS * refine * refine,
         *p = volume + COLUMNS * ROWS * refine * refine;
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
    for (int row = 0; row < rows; row++, n++) {
      x[3 * n] = at;
      x[3 * n + 1] = (row + 0.5) * dx;
      v[3 * n] = flux / eps;
      volume[n] = dx * all / columns / eps * sph->params.depth;
      p[n] = sph->params.background_pressure + rho * flux * (flux - flux / eps);
    }
  }
  check(sph_insert_points(sph, n, x, v, volume, p, NULL));
  free(x);
}

static sph_t *make(void) {
  sph_params params;
  sph_t *sph;
  const int refine = (int)value(REFINE);
  const double dx = 0.01 / refine;
  part_box box = {{0.0, 0.0, -dx}, {length, ROWS * 0.01, dx}, {1, 1, 0}, {0}};
  part_params_default(&sph_params_table, &params);
  params.dimensions = 2;
  params.depth = 0.1;
  params.spacing = dx;
  params.smoothing_length = value(H) * dx;
  params.kernel = (int)value(KERNEL);
  params.density = rho;
  params.viscosity = 0.0;
  params.sound_speed = value(SOUND);
  params.density_diffusion = value(DELTA);
  params.artificial_viscosity = value(ALPHA);
  params.background_pressure = value(BACKGROUND) * rho * flux * flux;
  params.xsph = value(XSPH);
  params.shifting = value(SHIFT);
  params.artificial_pressure = value(REPEL);
  params.anti_clump = value(CLUMP);
  params.consistent_porosity = (int)value(CONSISTENT);
  check(sph_create(MPI_COMM_WORLD, &box, &params, &sph));
  fill(sph);
  check(sph_start(sph));
  return sph;
}

static void displace(sph_t *sph) {
  sph_view view;
  check(sph_get_view(sph, &view));
  double *eps = calloc((size_t)view.own, sizeof *eps);
  for (int i = 0; i < view.own; i++)
    eps[i] = eps_of(view.position[view.xv_stride * i]);
  check(sph_displace(sph, eps));
  free(eps);
}

static void set_eps(sph_t *sph) {
  sph_view view;
  check(sph_get_view(sph, &view));
  for (int i = 0; i < view.own; i++) {
    const double x = view.position[view.xv_stride * i];
    view.eps[view.mass_stride * i] = eps_of(x);
    view.eps_gradient[view.force_stride * i] = value(RATE) * slope_of(x);
  }
}

typedef struct bins {
  double n[COLUMNS], p[COLUMNS], p2[COLUMNS], u[COLUMNS];
} bins;

/* p + rho (eps u) u and eps u of a moment. */
static void sample(sph_t *sph, bins *b) {
  sph_view view;
  memset(b, 0, sizeof *b);
  check(sph_get_view(sph, &view));
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

typedef struct sums {
  double n[COLUMNS], p[COLUMNS], u[COLUMNS], squares[2], number[2];
} sums;

static int changes(int column) {
  const double x = (column + 0.5) * length / COLUMNS;
  return fabs(slope_of(x)) > 0.1 * 0.5 * (1.0 - value(LOW)) / value(WIDTH);
}

static void add(sums *s, const bins *b) {
  for (int c = 0; c < COLUMNS; c++) {
    const double q = b->n[c] > 0.0 ? fmax(b->p2[c] - b->p[c] * b->p[c] / b->n[c], 0.0) : 0.0;
    for (int k = 0; k <= changes(c); k++) {
      s->squares[k] += q;
      s->number[k] += b->n[c];
    }
    s->n[c] += b->n[c];
    s->p[c] += b->p[c];
    s->u[c] += b->u[c];
  }
}

static void print(const sums *s, const sph_report *report) {
  const double unit = rho * flux * flux;
  double mean = 0.0, flux_error = 0.0, square = 0.0, all = 0.0;
  for (int c = 0; c < COLUMNS; c++)
    mean += s->p[c] / s->n[c] / COLUMNS, all += s->u[c] / s->n[c] / COLUMNS;
  for (int c = 0; c < COLUMNS; c++) {
    square += pow(s->p[c] / s->n[c] - mean, 2.0) / COLUMNS;
    flux_error = fmax(flux_error, fabs(s->u[c] / s->n[c] - all));
  }
  printf("noise %.4f step %.4f mean %.4f flux %.4f spread %.4f density %.3f %.3f\n",
         sqrt(s->squares[0] / s->number[0]) / unit, sqrt(s->squares[1] / s->number[1]) / unit,
         sqrt(square) / unit, all, flux_error, report->least_density, report->most_density);
}

int main(int argc, char **argv) {
  sums s = {.n = {0.0}};
  sph_report report;
  MPI_Init(&argc, &argv);
  read_options(argc, argv);
  sph_t *sph = make();
  displace(sph);
  const int sub = (int)value(SUB);
  const double dt = 3e-4 / value(REFINE) * sub * 15.0 / value(SOUND);
  const int rounds = (int)(value(TIME) / dt + 0.5);
  for (int k = 0; k < rounds; k++) {
    bins b;
    set_eps(sph);
    check(sph_advance(sph, dt, NULL));
    if (k < rounds / 2 || k % (50 / sub) != 0)
      continue;
    sample(sph, &b);
    add(&s, &b);
  }
  check(sph_get_report(sph, &report));
  print(&s, &report);
  sph_destroy(sph);
  MPI_Finalize();
  return 0;
}
