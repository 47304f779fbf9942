/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Walls of triangles against planes, and contacts at edges and vertices. */
#include "common.h"

static const double still[3] = {0.0, 0.0, 0.0};

typedef struct track {
  double angle; /* direction of travel in the wall's plane */
  double friction, restitution;
  double normal[3];
  double offset; /* of the centre of the square along the plane */
} track;

/* A sphere thrown onto a wall so that it slides, then rolls; 2000 steps. */
static body run_track(const track *t, int triangles, double *vertices, int *most_contacts) {
  scene s = scene_default();
  s.comm = MPI_COMM_SELF;
  s.contact.friction = t->friction;
  s.contact.restitution = t->restitution;
  const double r = 0.01, *n = t->normal;
  const double other[3] = {fabs(n[0]) < 0.6, fabs(n[0]) >= 0.6, 0.0};
  double e[3] = {n[1] * other[2] - n[2] * other[1], n[2] * other[0] - n[0] * other[2],
                 n[0] * other[1] - n[1] * other[0]};
  const double length = sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2]);
  double x[3], v[3];
  for (int c = 0; c < 3; c++)
    e[c] /= length;
  const double f[3] = {n[1] * e[2] - n[2] * e[1], n[2] * e[0] - n[0] * e[2],
                       n[0] * e[1] - n[1] * e[0]};
  for (int c = 0; c < 3; c++) {
    s.params.gravity[c] = -9.81 * n[c];
    x[c] = 0.998 * r * n[c] + t->offset * e[c];
    v[c] = 0.4 * (cos(t->angle) * e[c] + sin(t->angle) * f[c]) - 0.01 * n[c];
  }
  dem_t *dem = scene_create(&s);
  add_sphere(dem, DEM_FREE, -1, x, r, v);
  if (triangles > 0)
    OK(dem_add_triangles(dem, "wall", 0, triangles, vertices));
  else
    OK(dem_add_plane(dem, "wall", 0, still, n));
  OK(dem_start(dem));
  *most_contacts = 0;
  dem_report report;
  for (int k = 0; k < 200; k++) {
    OK(dem_advance(dem, 1e-3, NULL));
    OK(dem_get_report(dem, &report));
    if (report.wall_contacts > *most_contacts)
      *most_contacts = (int)report.wall_contacts;
  }
  CLOSE(report.budget_error, 0.0, 1e-12);
  const body result = find(dem, s.comm, 0);
  dem_destroy(dem);
  return result;
}

/* The same trajectory over triangles (smaller and larger than the sphere) as over a plane, through
 * edges and vertices at any angle: the only difference is rounding, 1e-16 m in positions of the
 * corners, amplified by the stiffness over 2e4 steps; bound 1e-9 of the way of 0.1 m. */
static void same_as_plane(void **state) {
  (void)state;
  const double third = 1.0 / sqrt(3.0);
  const track tracks[] = {
      {0.0, 0.3, 0.8, {0.0, 0.0, 1.0}, 0.0},       {0.3, 0.3, 0.8, {0.0, 0.0, 1.0}, 0.0},
      {PI / 4, 0.5, 1.0, {0.0, 0.0, 1.0}, 0.0},    {1.1, 0.3, 0.3, {0.6, 0.0, 0.8}, 0.001},
      {2.0, 0.2, 0.8, {third, third, third}, 0.0}, {PI / 2, 0.0, 0.8, {0.0, -1.0, 0.0}, 0.0},
  };
  const int cells[] = {3, 10, 40, 120};
  const double at[3] = {0.0, 0.0, 0.0};
  double *vertices = malloc(18 * 120 * 120 * sizeof *vertices);
  for (size_t k = 0; k < sizeof tracks / sizeof tracks[0]; k++) {
    int contacts;
    const body plane = run_track(&tracks[k], 0, NULL, &contacts);
    for (int m = 0; m < 4; m++) {
      const int n = triangulated_square(at, tracks[k].normal, 0.3, cells[m], vertices);
      const body b = run_track(&tracks[k], n, vertices, &contacts);
      assert_int_equal(contacts, 1);
      for (int c = 0; c < 3; c++) {
        CLOSE(b.x[c], plane.x[c], 1e-10);
        CLOSE(b.v[c], plane.v[c], 1e-9);
        CLOSE(b.w[c], plane.w[c], 1e-7);
      }
    }
  }
  free(vertices);
}

/* Meshes on which the track z = 0, x = t (cos, sin) runs exactly along edges and through vertices,
 * made of slivers, or with all triangles meeting in one vertex on the track. */
static int regular(int nx, int ny, double *v) {
  double *to = v;
  for (int j = 0; j < ny; j++)
    for (int i = 0; i < nx; i++) {
      const int corner[6][2] = {{i, j}, {i + 1, j},     {i + 1, j + 1},
                                {i, j}, {i + 1, j + 1}, {i, j + 1}};
      for (int k = 0; k < 6; k++) {
        *to++ = 0.3 * ((double)corner[k][0] / nx - 0.5);
        *to++ = 0.3 * ((double)corner[k][1] / ny - 0.5);
        *to++ = 0.0;
      }
    }
  return 2 * nx * ny;
}

static int fan(int n, double *v) {
  double *to = v;
  const double hub[3] = {0.04, 0.0, 0.0};
  for (int k = 0; k < n; k++) {
    const double a[2] = {2.0 * PI * k / n, 2.0 * PI * (k + 1) / n};
    memcpy(to, hub, sizeof hub);
    for (int m = 0; m < 2; m++) {
      to[3 + 3 * m] = hub[0] + 0.2 * cos(a[m]);
      to[4 + 3 * m] = hub[1] + 0.2 * sin(a[m]);
      to[5 + 3 * m] = 0.0;
    }
    to += 9;
  }
  return n;
}

static void along_edges(void **state) {
  (void)state;
  const double angle[] = {0.0, PI / 2, PI / 4, 0.4};
  double *v = malloc(18 * 60 * 60 * sizeof *v);
  for (int k = 0; k < 4; k++) {
    int contacts;
    const track t = {angle[k], 0.3, 0.8, {0.0, 0.0, 1.0}, 0.0};
    const body plane = run_track(&t, 0, NULL, &contacts);
    for (int m = 0; m < 6; m++) {
      const int n = m == 0   ? regular(60, 60, v) /* 5 mm, half the radius */
                    : m == 1 ? regular(6, 6, v)
                    : m == 2 ? regular(1500, 1, v) /* 0.2 mm wide, 300 mm long */
                    : m == 3 ? regular(2, 1500, v)
                    : m == 4 ? fan(8, v)
                             : fan(720, v);
      const body b = run_track(&t, n, v, &contacts);
      assert_int_equal(contacts, 1);
      for (int c = 0; c < 3; c++) {
        CLOSE(b.x[c], plane.x[c], 1e-10);
        CLOSE(b.v[c], plane.v[c], 1e-9);
        CLOSE(b.w[c], plane.w[c], 1e-7);
      }
    }
  }
  free(v);
}

/* A sphere that rolls off a sharp edge pivots about it without slip, 7/10 v^2 + g r cos constant,
 * and leaves it where v^2 = g r cos. */
static void over_the_edge(void **state) {
  (void)state;
  const double g = 9.81, r = 0.01, v0 = 0.15;
  const double top[3] = {-0.1, 0.0, 0.0}, up[3] = {0.0, 0.0, 1.0};
  const double front[3] = {0.0, 0.0, -0.1}, out[3] = {1.0, 0.0, 0.0};
  const double x[3] = {-0.02, 0.003, r}, v[3] = {v0, 0.0, 0.0};
  static double vertices[2 * 18 * 900];
  scene s = scene_default();
  s.comm = MPI_COMM_SELF;
  s.params.gravity[2] = -g;
  s.contact.normal_stiffness = 1e6;
  s.contact.friction = 50.0;
  s.contact.restitution = 0.2;
  dem_t *dem = scene_create(&s);
  dem_report report;
  add_sphere(dem, DEM_FREE, -1, x, r, v);
  int n = triangulated_square(top, up, 0.2, 30, vertices);
  n += triangulated_square(front, out, 0.2, 30, vertices + 9 * n);
  OK(dem_add_triangles(dem, "table", 0, n, vertices));
  OK(dem_start(dem));
  part_store *store = dem_store(dem);
  part_field_double(store, DEM_FIELD_ANGULAR_VELOCITY)[1] = v0 / r;
  OK(dem_advance(dem, 1e-2, NULL));
  do {
    OK(dem_advance(dem, 5e-4, NULL));
    OK(dem_get_report(dem, &report));
    assert_true(report.wall_contacts <= 1);
  } while (report.wall_contacts > 0);
  const double cosine = (0.7 * v0 * v0 / (g * r) + 1.0) / 1.7, speed = sqrt(g * r * cosine);
  const body b = find(dem, s.comm, 0);
  CLOSE(b.v[0], speed * cosine, 5e-3 * speed);
  CLOSE(b.w[1] * r, speed, 5e-3 * speed);
  CLOSE(b.v[1], 0.0, 1e-9);
  dem_destroy(dem);
}

/* Number of contacts of a sphere with r = 1 cm at x. */
static int contacts_at(const double x[3], int triangles, const double *vertices) {
  scene s = scene_default();
  s.comm = MPI_COMM_SELF;
  s.params.max_overlap = 1.0;
  dem_t *dem = scene_create(&s);
  dem_report report;
  add_sphere(dem, DEM_FREE, -1, x, 0.01, still);
  OK(dem_add_triangles(dem, "wall", 0, triangles, vertices));
  OK(dem_start(dem));
  OK(dem_get_report(dem, &report));
  dem_destroy(dem);
  return (int)report.wall_contacts;
}

/* A roof of two faces with ridge along y at z = 0, slopes -/+ (convex) or + (concave: a valley). */
static void roof(double slope, double v[36]) {
  const double w = 0.5, z = slope * w;
  const double corners[12][3] = {{0, -w, 0},  {w, -w, z}, {w, w, z},  {0, -w, 0},
                                 {w, w, z},   {0, w, 0},  {0, -w, 0}, {-w, w, z},
                                 {-w, -w, z}, {0, -w, 0}, {0, w, 0},  {-w, w, z}};
  memcpy(v, corners, sizeof corners);
}

static void edges_and_vertices(void **state) {
  (void)state;
  double v[36];
  const double depth = 1e-5, r = 0.01;
  /* Convex ridge: one contact, straight above it and beside it. */
  for (double slope = -1e-3; slope > -20.0; slope *= 3.0) {
    roof(slope, v);
    for (int k = -4; k <= 4; k++) {
      const double tilt = k / 4.0 * 1.2 * atan(-slope);
      const double x[3] = {(r - depth) * sin(tilt), 0.013 * k, (r - depth) * cos(tilt)};
      assert_int_equal(contacts_at(x, 4, v), 1);
    }
  }
  /* A valley is two walls. */
  for (double slope = 0.1; slope < 10.0; slope *= 2.0) {
    roof(slope, v);
    const double x[3] = {0.0, 0.003, (r - depth) * sqrt(1.0 + slope * slope)};
    assert_int_equal(contacts_at(x, 4, v), 2);
  }
  /* Apex of a pyramid from straight above: one. */
  const double w = 0.1, z = -0.05;
  const double apex[36] = {0, 0, 0, w,  -w, z, w,  w,  z, 0, 0, 0, w,  w,  z, -w, w,  z,
                           0, 0, 0, -w, w,  z, -w, -w, z, 0, 0, 0, -w, -w, z, w,  -w, z};
  const double above[3] = {0.0, 0.0, r - depth}, beside[3] = {1e-4, -2e-4, r - depth};
  assert_int_equal(contacts_at(above, 4, apex), 1);
  assert_int_equal(contacts_at(beside, 4, apex), 1);
  /* Two sides and floor of a corner: three. */
  const double l = 0.3;
  const double corner[27] = {-l, -l, 0,  l, -l, 0, -l, l, 0, 0,  -l, -l, 0, l,
                             -l, 0,  -l, l, -l, 0, -l, l, 0, -l, -l, 0,  l};
  const double inside[3] = {-(r - depth), -(r - depth), r - depth};
  assert_int_equal(contacts_at(inside, 3, corner), 3);
}

/* A floor of triangles over a periodic box carries on over the border. */
static void periodic_floor(void **state) {
  (void)state;
  scene s = scene_default();
  const double at[3] = {0.0, 0.0, 0.0}, normal[3] = {0.0, 0.0, 1.0};
  const double x[3] = {0.09, 0.02, 0.00998}, v[3] = {0.4, 0.13, 0.0};
  double *vertices = malloc(18 * 64 * sizeof *vertices);
  body end[2];
  for (int c = 0; c < 2; c++) {
    s.box.lo[c] = -0.1;
    s.box.hi[c] = 0.1;
    s.box.periodic[c] = 1;
  }
  s.contact.friction = 0.6;
  s.params.gravity[0] = 3.0; /* rolls downhill: the spring is loaded when it crosses the border */
  s.contact.restitution = 0.6;
  s.params.gravity[2] = -9.81;
  const int n = triangulated_square(at, normal, 0.2, 8, vertices);
  for (int k = 0; k < 2; k++) {
    dem_t *dem = scene_create(&s);
    add_sphere(dem, DEM_FREE, -1, x, 0.01, v);
    if (k == 0)
      OK(dem_add_plane(dem, "wall", 0, still, normal));
    else
      OK(dem_add_triangles(dem, "wall", 0, n, vertices));
    OK(dem_start(dem));
    for (int j = 0; j < 500; j++)
      OK(dem_advance(dem, 1e-3, NULL));
    end[k] = find(dem, s.comm, 0);
    dem_destroy(dem);
  }
  free(vertices);
  for (int c = 0; c < 3; c++) {
    CLOSE(end[1].x[c], end[0].x[c], 1e-10);
    CLOSE(end[1].v[c], end[0].v[c], 1e-9);
    CLOSE(end[1].w[c], end[0].w[c], 1e-7);
  }
}

static void bad_walls(void **state) {
  (void)state;
  scene s = scene_default();
  s.box.periodic[0] = 1;
  dem_t *dem = scene_create(&s);
  const double n[3] = {1.0, 0.0, 0.0}, up[3] = {0.0, 0.0, 1.0};
  const double flat[9] = {0, 0, 0, 1, 1, 1, 2, 2, 2}, x[3] = {0.0, 0.0, 0.005};
  FAILS(PART_ERR_RANGE, "normal", dem_add_plane(dem, "a", 0, still, still));
  FAILS(PART_ERR_RANGE, "periodic", dem_add_plane(dem, "a", 0, still, n));
  FAILS(PART_ERR_RANGE, "material 3", dem_add_plane(dem, "a", 3, still, up));
  FAILS(PART_ERR_RANGE, "triangle 0", dem_add_triangles(dem, "a", 0, 1, flat));
  FAILS(PART_ERR_RANGE, "no triangles", dem_add_triangles(dem, "a", 0, 0, flat));
  OK(dem_add_plane(dem, "a", 0, still, up));
  FAILS(PART_ERR_ARGUMENT, "twice", dem_add_plane(dem, "a", 0, still, up));
  add_sphere(dem, DEM_FREE, -1, x, 0.01, still);
  FAILS(PART_ERR_OVERLAP, "particle 0", dem_start(dem));
  dem_destroy(dem);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(same_as_plane),  cmocka_unit_test(along_edges),
      cmocka_unit_test(over_the_edge),  cmocka_unit_test(edges_and_vertices),
      cmocka_unit_test(periodic_floor), cmocka_unit_test(bad_walls),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
