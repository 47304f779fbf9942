/* ranks: 1 2 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
/* STL files: both kinds give the triangles that are in them; what is wrong with a file is said. */
#include "common.h"

static const double still[3] = {0.0, 0.0, 0.0};

static const char *path_of(const char *name) {
  static char path[300];
  const char *folder = getenv("TMPDIR");
  snprintf(path, sizeof path, "%s/dem-%s-%d.stl", folder != NULL ? folder : "/tmp", name,
           world_size());
  return path;
}

/* A box 20 x 20 x 10 with its lower corner at (-10 -10 -10): 12 triangles. */
static int box_triangles(double t[12][9]) {
  const double lo[3] = {-10.0, -10.0, -10.0}, hi[3] = {10.0, 10.0, 0.0};
  int n = 0;
  for (int d = 0; d < 3; d++)
    for (int side = 0; side < 2; side++) {
      double p[4][3];
      for (int k = 0; k < 4; k++) {
        p[k][d] = side ? hi[d] : lo[d];
        p[k][(d + 1) % 3] = k == 1 || k == 2 ? hi[(d + 1) % 3] : lo[(d + 1) % 3];
        p[k][(d + 2) % 3] = k >= 2 ? hi[(d + 2) % 3] : lo[(d + 2) % 3];
      }
      const int corner[6] = {0, 1, 2, 0, 2, 3};
      for (int k = 0; k < 6; k++)
        memcpy(&t[n + k / 3][3 * (k % 3)], p[corner[k]], sizeof p[0]);
      n += 2;
    }
  return n;
}

static void write_bytes(const char *path, const void *bytes, size_t size) {
  if (world_rank() == 0) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    fclose(file);
  }
  MPI_Barrier(MPI_COMM_WORLD);
}

static size_t as_text(int n, double (*t)[9], char *text, size_t size) {
  size_t used = (size_t)snprintf(text, size, "solid a box\n");
  for (int k = 0; k < n; k++) {
    used += (size_t)snprintf(text + used, size - used, " facet normal 0 0 0\n  outer loop\n");
    for (int m = 0; m < 3; m++)
      used += (size_t)snprintf(text + used, size - used, "   vertex %.9g %.9g %.9g\n", t[k][3 * m],
                               t[k][3 * m + 1], t[k][3 * m + 2]);
    used += (size_t)snprintf(text + used, size - used, "  endloop\n endfacet\n");
  }
  return used + (size_t)snprintf(text + used, size - used, "endsolid a box\n");
}

/* Little-endian, whatever the machine. */
static void put(unsigned char *to, uint32_t bits) {
  for (int k = 0; k < 4; k++)
    to[k] = (unsigned char)(bits >> 8 * k);
}

static size_t as_binary(int n, double (*t)[9], unsigned char *bytes) {
  memset(bytes, 0, 84 + 50 * (size_t)n);
  memcpy(bytes, "solid that is binary", 20); /* some programs write this */
  put(bytes + 80, (uint32_t)n);
  for (int k = 0; k < n; k++)
    for (int c = 0; c < 9; c++) {
      const float value = (float)t[k][c];
      uint32_t bits;
      memcpy(&bits, &value, sizeof bits);
      put(bytes + 84 + 50 * k + 12 + 4 * c, bits);
    }
  return 84 + 50 * (size_t)n;
}

static dem_wall_params stl(const char *path) {
  dem_wall_params wall = wall_of(DEM_WALL_STL);
  strcpy(wall.file, path);
  wall.scale = 0.01;
  return wall;
}

/* Force on a sphere that lies on the top of the box at z = 0, and rolls over its edge. */
static body rolls_off(const dem_wall_params *wall, int count, const double *vertices) {
  scene s = scene_default();
  const double x[3] = {0.05, 0.03, 0.0099}, v[3] = {1.0, 0.2, 0.0};
  s.params.gravity[2] = -9.81;
  s.contact.normal_stiffness = 1e3;
  s.contact.friction = 0.5;
  s.contact.restitution = 0.5;
  s.params.max_overlap = 0.1;
  dem_t *dem = scene_create(&s);
  add_sphere(dem, DEM_FREE, -1, x, 0.01, v);
  OK(dem_add_wall(dem, "box", wall, count, vertices));
  OK(dem_start(dem));
  for (int k = 0; k < 130; k++)
    OK(dem_advance(dem, 1e-3, NULL));
  const body b = find(dem, s.comm, 0);
  dem_destroy(dem);
  return b;
}

static void both_kinds(void **state) {
  (void)state;
  double t[12][9], scaled[12][9];
  char text[8000];
  unsigned char bytes[84 + 50 * 12];
  const int n = box_triangles(t);
  for (int k = 0; k < n; k++)
    for (int c = 0; c < 9; c++)
      scaled[n - 1 - k][c] = 0.01 * t[k][c]; /* the order does not matter */
  const dem_wall_params given = wall_of(DEM_WALL_TRIANGLES);
  const body wanted = rolls_off(&given, n, scaled[0]);
  const char *path = path_of("box");
  const dem_wall_params wall = stl(path);
  write_bytes(path, text, as_text(n, t, text, sizeof text));
  const body from_text = rolls_off(&wall, 0, NULL);
  write_bytes(path, bytes, as_binary(n, t, bytes));
  const body from_binary = rolls_off(&wall, 0, NULL);
  assert_true(wanted.x[2] < -1e-3); /* it has gone over the edge */
  assert_memory_equal(&from_text, &wanted, sizeof wanted);
  assert_memory_equal(&from_binary, &wanted, sizeof wanted);
  if (world_rank() == 0)
    remove(path);
}

/* Write what is given and expect an error with these words. */
static void refused(int status, const char *words, int open, const void *bytes, size_t size) {
  const char *path = path_of("bad");
  scene s = scene_default();
  dem_wall_params wall = stl(path);
  wall.open = open;
  dem_t *dem = scene_create(&s);
  write_bytes(path, bytes, size);
  FAILS(status, words, dem_add_wall(dem, "box", &wall, 0, NULL));
  FAILS(status, path, dem_add_wall(dem, "box", &wall, 0, NULL));
  FAILS(status, "wall box", dem_add_wall(dem, "box", &wall, 0, NULL));
  dem_destroy(dem);
  MPI_Barrier(MPI_COMM_WORLD);
}

static void refused_text(const char *words, int open, const char *text) {
  refused(PART_ERR_FORMAT, words, open, text, strlen(text));
}

#define FACET(a)                                                                                   \
  "facet normal 0 0 1 outer loop vertex " a " vertex 1 0 0 vertex 0 1 0 endloop endfacet\n"

static void bad_text(void **state) {
  (void)state;
  refused_text("empty", 1, "");
  refused_text("no STL file", 1, "# a comment\nv 0 0 0\n");
  refused_text("no triangles", 1, "solid nothing\nendsolid\n");
  refused_text("line 3: the file ends where 'endsolid'", 1, "solid\n" FACET("0 0 0"));
  refused_text("cut short", 1, "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1");
  refused_text("line 2: 'fact'", 1, "solid\nfact normal 0 0 1\n");
  refused_text("'1,5' where 'a number'", 1, "solid\n" FACET("1,5 0 0") "endsolid\n");
  refused_text("triangle 1: a coordinate is not finite", 1,
               "solid\n" FACET("0 0 0") FACET("nan 0 0") "endsolid\n");
  refused_text("not closed: the edge from (0 0 0) to (0 0.01 0) m of triangle 0", 0,
               "solid\n" FACET("0 0 0") "endsolid\n");
  const char *flat = "solid\n" FACET("0 0 0") FACET("0.5 0.5 0") "endsolid\n";
  refused(PART_ERR_RANGE, "triangle 1", 1, flat, strlen(flat));
  refused(PART_ERR_RANGE, "triangle 1", 0, flat, strlen(flat));
}

static void bad_binary(void **state) {
  (void)state;
  double t[12][9];
  unsigned char bytes[84 + 50 * 12];
  const int n = box_triangles(t);
  const size_t size = as_binary(n, t, bytes);
  memset(bytes, 0, 20); /* no "solid": then only the size tells */
  refused(PART_ERR_FORMAT, "12 triangles it would have 684 bytes, not 683", 0, bytes, size - 1);
  refused(PART_ERR_FORMAT, "not closed", 0, bytes, as_binary(n - 1, t, bytes));
  t[4][0] = (double)INFINITY;
  refused(PART_ERR_FORMAT, "triangle 4: a coordinate is not finite", 0, bytes,
          as_binary(n, t, bytes));
  refused(PART_ERR_FORMAT, "no triangles", 1, bytes, as_binary(0, t, bytes));
}

/* With `open yes` a surface may have edges; then it is a wall as any other. */
static void open_surface(void **state) {
  (void)state;
  const char *path = path_of("open"), *text = "solid\n" FACET("0 0 0") "endsolid\n";
  const double x[3] = {0.003, 0.003, 0.0099};
  scene s = scene_default();
  dem_wall_params wall = stl(path);
  wall.open = 1;
  dem_t *dem = scene_create(&s);
  dem_wall_report report;
  write_bytes(path, text, strlen(text));
  add_sphere(dem, DEM_FREE, -1, x, 0.01, still);
  s.params.max_overlap = 0.1;
  OK(dem_add_wall(dem, "chute", &wall, 0, NULL));
  OK(dem_start(dem));
  OK(dem_get_wall_report(dem, 0, &report));
  assert_int_equal(report.elements, 1);
  CLOSE(report.force[2], -s.contact.normal_stiffness * 1e-4, 1e-9);
  dem_destroy(dem);
  MPI_Barrier(MPI_COMM_WORLD);
  if (world_rank() == 0)
    remove(path);
}

static void no_file(void **state) {
  (void)state;
  scene s = scene_default();
  dem_wall_params wall = stl("/no/such/file.stl");
  dem_t *dem = scene_create(&s);
  FAILS(PART_ERR_IO, "/no/such/file.stl", dem_add_wall(dem, "box", &wall, 0, NULL));
  strcpy(wall.file, "."); /* a folder */
  FAILS(PART_ERR_IO, "STL file .", dem_add_wall(dem, "box", &wall, 0, NULL));
  wall.file[0] = '\0';
  FAILS(PART_ERR_ARGUMENT, "entry file is missing", dem_add_wall(dem, "box", &wall, 0, NULL));
  wall.scale = 0.0;
  FAILS(PART_ERR_RANGE, "scale", dem_add_wall(dem, "box", &wall, 0, NULL));
  dem_destroy(dem);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(both_kinds),   cmocka_unit_test(bad_text), cmocka_unit_test(bad_binary),
      cmocka_unit_test(open_surface), cmocka_unit_test(no_file),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  remove(path_of("bad"));
  MPI_Finalize();
  return failed;
}
