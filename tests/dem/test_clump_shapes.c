/* ranks: 1 3 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shape files of clumps: volume, centre and inertia of unions of spheres against closed forms, and
 * every kind of bad file. */
#include "common.h"

static const char *path_of(const char *name) {
  static char path[300];
  const char *folder = getenv("TMPDIR");
  snprintf(path, sizeof path, "%s/dem-%s-%d.txt", folder != NULL ? folder : "/tmp", name,
           world_size());
  return path;
}

static void write_text(const char *path, const char *text) {
  if (world_rank() == 0) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
  }
  MPI_Barrier(MPI_COMM_WORLD);
}

static dem_clump_shape_report shape_of_text(const char *text) {
  scene s = scene_default();
  dem_t *dem = scene_create(&s);
  dem_clump_shape_report report;
  const char *path = path_of("shape");
  write_text(path, text);
  OK(dem_get_clump_shape(dem, path, &report));
  dem_destroy(dem);
  MPI_Barrier(MPI_COMM_WORLD);
  if (world_rank() == 0)
    remove(path);
  MPI_Barrier(MPI_COMM_WORLD);
  return report;
}

static dem_clump_shape_report shape_of(int n, double (*sphere)[4]) {
  static char text[100000];
  int used = 0;
  for (int k = 0; k < n; k++)
    used += snprintf(text + used, sizeof text - (size_t)used, "%.17g %.17g %.17g %.17g\n",
                     sphere[k][0], sphere[k][1], sphere[k][2], 2.0 * sphere[k][3]);
  return shape_of_text(text);
}

/* Within the stated accuracy: 1e-10 of the volume times the size to the power of length. */
static void same_shape(const dem_clump_shape_report *a, const dem_clump_shape_report *b,
                       double size) {
  CLOSE(a->volume, b->volume, 1e-10 * b->volume);
  for (int c = 0; c < 3; c++)
    CLOSE(a->centre[c], b->centre[c], 1e-10 * size);
  for (int c = 0; c < 6; c++)
    CLOSE(a->inertia[c], b->inertia[c], 1e-10 * b->volume * size * size);
}

static void one_sphere(void **state) {
  (void)state;
  double sphere[1][4] = {{0.3, -2.0, 5.0, 0.02}};
  const dem_clump_shape_report a = shape_of(1, sphere);
  const double v = 4.0 / 3.0 * PI * 8e-6;
  dem_clump_shape_report wanted = {.volume = v, .centre = {0.3, -2.0, 5.0}};
  for (int c = 0; c < 3; c++)
    wanted.inertia[c] = 0.4 * v * 4e-4;
  same_shape(&a, &wanted, 0.02);
  for (int c = 0; c < 3; c++)
    CLOSE(a.principal[c], 0.4 * v * 4e-4, 1e-13 * v * 4e-4);
  CLOSE(a.bound, 0.02, 1e-15);
  assert_int_equal(a.spheres, 1);
}

static void touching_pair(void **state) {
  (void)state;
  const double r = 0.5, v = 4.0 / 3.0 * PI * r * r * r;
  double sphere[2][4] = {{1.0, 2.0, 3.0, r}, {1.0, 2.0, 4.0, r}};
  const dem_clump_shape_report a = shape_of(2, sphere);
  const double along = 2.0 * 0.4 * v * r * r, across = along + 2.0 * v * r * r;
  const dem_clump_shape_report wanted = {
      .volume = 2.0 * v, .centre = {1.0, 2.0, 3.5}, .inertia = {across, across, along}};
  same_shape(&a, &wanted, 1.0);
  CLOSE(a.principal[2], along, 1e-10 * v); /* the distinct one comes third */
  CLOSE(a.bound, 1.0, 1e-12);
}

/* Integral of x^k pi (r^2 - x^2) from a to b: antiderivatives of a sphere's slices. */
static double slices(double r, int k, double a, double b) {
  return PI * (r * r * (pow(b, k + 1) - pow(a, k + 1)) / (k + 1) -
               (pow(b, k + 3) - pow(a, k + 3)) / (k + 3));
}
/* Integral of pi/4 (r^2 - x^2)^2: second moment across. */
static double across(double r, double a, double b) {
  const double r2 = r * r;
  return PI / 4.0 *
         (r2 * r2 * (b - a) - 2.0 / 3.0 * r2 * (pow(b, 3) - pow(a, 3)) +
          (pow(b, 5) - pow(a, 5)) / 5.0);
}

/* Two spheres with centres d apart along x, cut at the plane of their circle: each gives a cap. */
static dem_clump_shape_report pair_closed_form(double r, double s, double d) {
  dem_clump_shape_report w = {.spheres = 2};
  const double p = (d * d + r * r - s * s) / (2.0 * d), q = p - d; /* from either centre */
  const double first = slices(r, 1, -r, p) + slices(s, 1, q, s) + d * slices(s, 0, q, s);
  const double xx = slices(r, 2, -r, p) + slices(s, 2, q, s) + 2.0 * d * slices(s, 1, q, s) +
                    d * d * slices(s, 0, q, s);
  const double yy = across(r, -r, p) + across(s, q, s);
  w.volume = slices(r, 0, -r, p) + slices(s, 0, q, s);
  w.centre[0] = first / w.volume;
  w.inertia[0] = 2.0 * yy;
  w.inertia[1] = w.inertia[2] = xx - w.volume * w.centre[0] * w.centre[0] + yy;
  return w;
}

static void overlapping_pairs(void **state) {
  (void)state;
  const double radii[3] = {1.0, 0.7, 0.05}, distances[4] = {0.3, 0.9, 0.97, 1.02};
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 4; b++) {
      const double s = radii[a], d = distances[b];
      if (d >= 1.0 + s || d + s <= 1.0)
        continue;
      const dem_clump_shape_report wanted = pair_closed_form(1.0, s, d);
      double sphere[2][4] = {{0.0, 0.0, 0.0, 1.0}, {d, 0.0, 0.0, s}};
      dem_clump_shape_report one = shape_of(2, sphere);
      same_shape(&one, &wanted, 1.0);
      /* Along another axis: other slices, the same body. */
      memcpy(sphere[1], (double[4]){0.0, 0.0, d, s}, sizeof sphere[1]);
      one = shape_of(2, sphere);
      CLOSE(one.volume, wanted.volume, 1e-10 * wanted.volume);
      CLOSE(one.centre[2], wanted.centre[0], 1e-10);
      CLOSE(one.inertia[2], wanted.inertia[0], 1e-10 * wanted.volume);
      CLOSE(one.inertia[0], wanted.inertia[1], 1e-10 * wanted.volume);
    }
}

/* A ring of spheres, each over its neighbours, with a corner where three meet. */
static int cluster(double (*sphere)[4]) {
  const double at[7][4] = {{0.0, 0.0, 0.0, 1.0},   {1.1, 0.2, 0.1, 0.8}, {0.4, 1.0, -0.3, 0.9},
                           {-0.2, 0.5, 1.0, 0.6},  {0.9, 0.9, 0.6, 0.7}, {0.1, 0.1, 0.1, 0.3},
                           {-0.9, -0.4, 0.3, 0.25}};
  memcpy(sphere, at, sizeof at);
  return 7;
}

/* Rotated, so that all slices are others: the same volume and principal moments. */
static void rotated_cluster(void **state) {
  (void)state;
  double sphere[9][4], turned[9][4];
  const int n = cluster(sphere);
  const dem_clump_shape_report a = shape_of(n, sphere);
  for (int t = 1; t < 4; t++) {
    const double c = cos(0.7 * t), s = sin(0.7 * t), e = cos(1.1 * t), f = sin(1.1 * t);
    for (int k = 0; k < n; k++) {
      const double x = c * sphere[k][0] - s * sphere[k][1];
      const double y = s * sphere[k][0] + c * sphere[k][1], z = sphere[k][2];
      const double at[4] = {e * x - f * z, y, f * x + e * z, sphere[k][3]};
      memcpy(turned[k], at, sizeof at);
    }
    const dem_clump_shape_report b = shape_of(n, turned);
    CLOSE(b.volume, a.volume, 1e-10 * a.volume);
    for (int d = 0; d < 3; d++)
      CLOSE(b.principal[d], a.principal[d], 1e-10 * a.volume);
    CLOSE(b.bound, a.bound, 1e-10);
  }
  /* What lies inside, and what is there twice, changes nothing. */
  memcpy(sphere[n], sphere[2], sizeof sphere[2]);
  memcpy(sphere[n + 1], (double[4]){0.2, 0.1, 0.0, 0.5}, sizeof sphere[0]);
  const dem_clump_shape_report b = shape_of(n + 2, sphere);
  same_shape(&b, &a, 1.0);
}

/* By counting points, which needs no geometry: 160^3 of them are good for 1e-4 here (the surface
 * cuts 1 in 60 cells, and their errors, +-1/2 each, add up as the root of their number). */
static void counted_cluster(void **state) {
  (void)state;
  enum { N = 160 };
  double sphere[9][4];
  const int n = cluster(sphere);
  const dem_clump_shape_report a = shape_of(n, sphere);
  const double lo = -1.5, edge = 3.6 / N;
  double count = 0.0, sum[3] = {0.0, 0.0, 0.0}, xx = 0.0, xy = 0.0;
  for (int k = 0; k < N * N * N; k++) {
    const double x = lo + (k % N + 0.5) * edge, y = lo + (k / N % N + 0.5) * edge,
                 z = lo + (k / N / N + 0.5) * edge;
    int inside = 0;
    for (int m = 0; m < n && !inside; m++)
      inside = (x - sphere[m][0]) * (x - sphere[m][0]) + (y - sphere[m][1]) * (y - sphere[m][1]) +
                   (z - sphere[m][2]) * (z - sphere[m][2]) <
               sphere[m][3] * sphere[m][3];
    if (!inside)
      continue;
    count++;
    sum[0] += x;
    sum[1] += y;
    sum[2] += z;
    xx += y * y + z * z;
    xy -= x * y;
  }
  const double v = count * edge * edge * edge;
  CLOSE(a.volume, v, 2e-4 * v);
  for (int c = 0; c < 3; c++)
    CLOSE(a.centre[c], sum[c] / count, 2e-4);
  const double c[3] = {sum[0] / count, sum[1] / count, sum[2] / count};
  CLOSE(a.inertia[0], v * (xx / count - c[1] * c[1] - c[2] * c[2]), 4e-4 * v);
  CLOSE(a.inertia[3], v * (xy / count + c[0] * c[1]), 4e-4 * v);
}

static void given_properties(void **state) {
  (void)state;
  const dem_clump_shape_report a = shape_of_text("0 0 0 0.1 # two apart: a rod that is not seen\n"
                                                 "1 0 0 0.1\n"
                                                 "volume 0.25\ncentre 0.5 0.01 0 # off the line\n"
                                                 "inertia 0.3 2 2.1 0.1 0 -0.05\n");
  CLOSE(a.volume, 0.25, 0.0);
  CLOSE(a.centre[1], 0.01, 0.0);
  const double tensor[6] = {0.3, 2.0, 2.1, 0.1, 0.0, -0.05};
  for (int c = 0; c < 6; c++)
    CLOSE(a.inertia[c], tensor[c], 1e-14);
  CLOSE(a.principal[0] + a.principal[1] + a.principal[2], 4.4, 1e-14);
  assert_true(a.principal[2] < 1.0); /* two are near 2 */
}

/* Ten spheres that fill a regular tetrahedron of edge 1: a spherical top about its middle. */
static void tetrahedron(void **state) {
  (void)state;
  char path[400];
  const char *folder = getenv("CFDDEM_DIR");
  scene s = scene_default();
  dem_t *dem = scene_create(&s);
  dem_clump_shape_report a;
  snprintf(path, sizeof path, "%s/tests/dem/data/tetrahedron.txt", folder != NULL ? folder : ".");
  OK(dem_get_clump_shape(dem, path, &a));
  dem_destroy(dem);
  assert_int_equal(a.spheres, 10);
  for (int c = 0; c < 3; c++) {
    CLOSE(a.centre[c], 0.0, 1e-12);
    CLOSE(a.principal[c], a.principal[0], 1e-9 * a.principal[0]);
  }
  /* Of the full one, V = sqrt(2)/12, by counting 4e5 random points (8e-4): 0.5849. */
  CLOSE(a.volume / (sqrt(2.0) / 12.0), 0.5849, 3e-3);
  /* I = V edge^2/20 for the full one; what is rounded off is far out. */
  assert_true(a.principal[0] < a.volume / 20.0 && a.principal[0] > 0.6 * a.volume / 20.0);
}

static void bad_shapes(void **state) {
  (void)state;
  scene s = scene_default();
  dem_clump_shape_report report;
  const char *path = path_of("bad-shape");
  const struct {
    const char *text, *words;
    int status;
  } bad[] = {
      {"", "zero spheres", PART_ERR_RANGE},
      {"# x y z d\n\n", "zero spheres", PART_ERR_RANGE},
      {"0 0 0 0.1\n0.05 nan 0 0.1\n", "line 2: 'nan", PART_ERR_FORMAT},
      {"0 0 0 inf\n", "line 1: 'inf", PART_ERR_FORMAT},
      {"0 0 0 0.1\n\n0 y 0 0.1\n", "line 3: 'y 0 0.1' is not a finite number", PART_ERR_FORMAT},
      {"0 0 0\n", "line 1: 3 numbers; must be 4 (x y z diameter)", PART_ERR_FORMAT},
      {"0 0 0 0\n", "line 1: diameter 0 m is not allowed", PART_ERR_RANGE},
      {"0 0 0 -1\n", "line 1: diameter -1 m is not allowed", PART_ERR_RANGE},
      {"0 0 0 1\n1.8 0 0 1\n0.9 0 0 1\n4 0 0 1\n", "sphere 4 does not hang together with sphere 1",
       PART_ERR_RANGE},
      {"0 0 0 1\nvolumes 1\n", "line 2: 'volumes' is not known", PART_ERR_FORMAT},
      {"0 0 0 1\ncenter 1\n", "did you mean 'centre'", PART_ERR_FORMAT},
      {"0 0 0 1\nvolume 1 2\n", "line 2: volume has 2 numbers; must be 1", PART_ERR_FORMAT},
      {"0 0 0 1\nvolume x\n", "line 2: 'x' is not a finite number", PART_ERR_FORMAT},
      {"0 0 0 1\nvolume 1\nvolume 1\n", "line 3: volume is given twice", PART_ERR_FORMAT},
      {"0 0 0 1\nvolume 1\ncentre 0 0 0\n", "inertia is missing", PART_ERR_FORMAT},
      {"0 0 0 1\nvolume 0\ncentre 0 0 0\ninertia 1 1 1 0 0 0\n", "not those of a body",
       PART_ERR_RANGE},
      {"0 0 0 1\nvolume 1\ncentre 0 0 0\ninertia 1 1 2.1 0 0 0\n", "no moment above the sum",
       PART_ERR_RANGE},
      {"0 0 0 1\nvolume 1\ncentre 0 0 0\ninertia 1 1 1 2 0 0\n", "all must be positive",
       PART_ERR_RANGE},
  };
  dem_t *dem = scene_create(&s);
  for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
    write_text(path, bad[k].text);
    FAILS(bad[k].status, bad[k].words, dem_get_clump_shape(dem, path, &report));
    MPI_Barrier(MPI_COMM_WORLD);
  }
  if (world_rank() == 0)
    remove(path);
  MPI_Barrier(MPI_COMM_WORLD);
  FAILS(PART_ERR_IO, "cannot be opened", dem_get_clump_shape(dem, path, &report));
  dem_destroy(dem);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(one_sphere),        cmocka_unit_test(touching_pair),
      cmocka_unit_test(overlapping_pairs), cmocka_unit_test(rotated_cluster),
      cmocka_unit_test(counted_cluster),   cmocka_unit_test(given_properties),
      cmocka_unit_test(tetrahedron),       cmocka_unit_test(bad_shapes),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
