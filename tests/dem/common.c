/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common.h"

void check_ok(int status, const char *call, const char *file, int line) {
  if (status == PART_OK)
    return;
  print_error("%s: %s: %s\n", call, part_status_name(status), part_last_error());
  _fail(file, line);
}

void check_fails(int wanted, const char *words, int status, const char *call, const char *file,
                 int line) {
  if (status == wanted && strstr(part_last_error(), words) != NULL)
    return;
  print_error("%s: wanted %s with '%s', got %s: %s\n", call, part_status_name(wanted), words,
              part_status_name(status), status == PART_OK ? "" : part_last_error());
  _fail(file, line);
}

void check_close(double value, double wanted, double tolerance, const char *what, const char *file,
                 int line) {
  if (fabs(value - wanted) <= tolerance)
    return;
  print_error("%s = %.17g, wanted %.17g within %.3g, differs by %.3g\n", what, value, wanted,
              tolerance, value - wanted);
  _fail(file, line);
}

scene scene_default(void) {
  scene s;
  memset(&s, 0, sizeof s);
  s.comm = MPI_COMM_WORLD;
  for (int c = 0; c < 3; c++) {
    s.box.lo[c] = -1.0;
    s.box.hi[c] = 1.0;
  }
  part_params_default(&dem_params_table, &s.params);
  part_params_default(&dem_contact_table, &s.contact);
  s.density = 2500.0;
  s.contact.normal_stiffness = 1e5;
  s.contact.restitution = 1.0;
  return s;
}

scene scene_with_law(int law) {
  scene s = scene_default();
  s.contact.law = law;
  if (law == HERTZ) {
    s.young = 2e8;
    s.poisson = 0.3;
    s.contact.normal_stiffness = (double)NAN;
  }
  return s;
}

dem_t *scene_create(const scene *s) {
  dem_t *dem;
  dem_material glass = {.name = "glass", .density = s->density, .youngs_modulus = s->young,
                        .poisson_ratio = s->poisson, .breakage_coefficient = s->breakage};
  OK(dem_create(s->comm, &s->box, &s->params, &dem));
  OK(dem_add_material(dem, &glass, NULL));
  OK(dem_set_contact(dem, -1, -1, &s->contact));
  return dem;
}

dem_insert lattice(int kind, double diameter, const double origin[3], double spacing, int nx,
                   int ny, int nz) {
  const double count[3] = {nx, ny, nz};
  dem_insert insert;
  part_params_default(&dem_insert_table, &insert);
  insert.method = DEM_INSERT_LATTICE;
  insert.kind = kind;
  insert.diameter = diameter;
  strcpy(insert.material, "glass");
  for (int c = 0; c < 3; c++) {
    insert.origin[c] = origin[c];
    insert.spacing[c] = spacing;
    insert.count[c] = count[c];
  }
  return insert;
}

dem_insert random_spheres(int64_t number, double diameter, double diameter_max, const double lo[3],
                          double extent, int64_t seed) {
  dem_insert insert;
  part_params_default(&dem_insert_table, &insert);
  insert.method = DEM_INSERT_RANDOM;
  insert.number = number;
  insert.seed = seed;
  insert.diameter = diameter;
  insert.diameter_max = diameter_max;
  strcpy(insert.material, "glass");
  for (int c = 0; c < 3; c++) {
    insert.origin[c] = lo[c];
    insert.extent[c] = extent;
  }
  return insert;
}

dem_wall_params wall_of(int type) {
  dem_wall_params wall;
  part_params_default(&dem_wall_table, &wall);
  wall.type = type;
  strcpy(wall.material, "glass");
  return wall;
}

void add_sphere(dem_t *dem, int kind, int block, const double x[3], double r, const double v[3]) {
  dem_insert insert = lattice(kind, 2.0 * r, x, 0.0, 1, 1, 1);
  memcpy(insert.velocity, v, sizeof insert.velocity);
  OK(dem_insert_particles(dem, &insert, block, NULL));
}

static void copy_field(const part_store *store, int field, int i, double to[3]) {
  memcpy(to, part_field_double(store, field) + (size_t)i * (size_t)part_field_stride(store, field),
         3 * sizeof(double));
}

void find_all(dem_t *dem, MPI_Comm comm, int64_t n, body *bodies) {
  const part_store *store = dem_store(dem);
  const int64_t *id = part_field_int64(store, DEM_FIELD_ID);
  const int stride = part_field_stride(store, DEM_FIELD_ID);
  memset(bodies, 0, (size_t)n * sizeof *bodies);
  for (int i = 0; i < store->local; i++) {
    assert_in_range(id[(size_t)i * (size_t)stride], 0, (uintmax_t)n - 1);
    body *b = &bodies[id[(size_t)i * (size_t)stride]];
    copy_field(store, DEM_FIELD_POSITION, i, b->x);
    copy_field(store, DEM_FIELD_VELOCITY, i, b->v);
    copy_field(store, DEM_FIELD_ANGULAR_VELOCITY, i, b->w);
    copy_field(store, DEM_FIELD_FORCE, i, b->force);
    copy_field(store, DEM_FIELD_FLUID_IMPULSE, i, b->impulse);
  }
  MPI_Allreduce(MPI_IN_PLACE, bodies, (int)(n * 15), MPI_DOUBLE, MPI_SUM, comm);
}

body find(dem_t *dem, MPI_Comm comm, int64_t id) {
  dem_report report;
  OK(dem_get_report(dem, &report));
  body *all = calloc((size_t)report.particles, sizeof *all), one;
  find_all(dem, comm, report.particles, all);
  one = all[id];
  free(all);
  return one;
}

void set_fluid(dem_t *dem, const double su[3], double sp) {
  const part_store *store = dem_store(dem);
  double *fluid = part_field_double(store, DEM_FIELD_FLUID_SU);
  const size_t stride = (size_t)part_field_stride(store, DEM_FIELD_FLUID_SU);
  for (int i = 0; i < store->local; i++) {
    memcpy(fluid + stride * (size_t)i, su, 3 * sizeof(double));
    fluid[stride * (size_t)i + 3] = sp;
  }
}

void stir(dem_t *dem, double speed) {
  const part_store *store = dem_store(dem);
  const int64_t *id = part_field_int64(store, DEM_FIELD_ID);
  double *v = part_field_double(store, DEM_FIELD_VELOCITY);
  const size_t is = (size_t)part_field_stride(store, DEM_FIELD_ID);
  const size_t vs = (size_t)part_field_stride(store, DEM_FIELD_VELOCITY);
  double *impulse = calloc(3 * (size_t)store->local + 1, sizeof *impulse);
  const double *w = part_field_double(store, DEM_FIELD_INVERSE_MASS);
  for (int i = 0; i < store->local; i++)
    for (int c = 0; c < 3; c++) {
      const double phase = 12.9898 * (double)id[is * (size_t)i] + 78.233 * (c + 1);
      const double wanted = speed * sin(phase * phase);
      const double mass = w[vs * (size_t)i] > 0.0 ? 1.0 / w[vs * (size_t)i] : 0.0;
      impulse[3 * i + c] = mass * (wanted - v[vs * (size_t)i + (size_t)c]);
    }
  OK(dem_kick(dem, impulse));
  free(impulse);
}

static double jitter(int i, int j, int c, int n) {
  if (i == 0 || j == 0 || i == n || j == n)
    return 0.0;
  const double s = sin(12.9898 * i + 78.233 * j + 37.719 * c) * 43758.5453;
  return 0.6 * (s - floor(s) - 0.5); /* +- 0.3 of a cell: no triangle turns over */
}

int triangulated_square(const double at[3], const double normal[3], double size, int n,
                        double *vertices) {
  const double other[3] = {fabs(normal[0]) < 0.6 ? 1.0 : 0.0, fabs(normal[0]) < 0.6 ? 0.0 : 1.0,
                           0.0};
  double s[3] = {normal[1] * other[2] - normal[2] * other[1],
                 normal[2] * other[0] - normal[0] * other[2],
                 normal[0] * other[1] - normal[1] * other[0]};
  const double length = sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]);
  for (int c = 0; c < 3; c++)
    s[c] /= length;
  const double t[3] = {normal[1] * s[2] - normal[2] * s[1], normal[2] * s[0] - normal[0] * s[2],
                       normal[0] * s[1] - normal[1] * s[0]};
  double *to = vertices;
  for (int j = 0; j < n; j++)
    for (int i = 0; i < n; i++) {
      const int corner[6][2] = {{i, j}, {i + 1, j},     {i + 1, j + 1},
                                {i, j}, {i + 1, j + 1}, {i, j + 1}};
      for (int k = 0; k < 6; k++) {
        const int a = corner[k][0], b = corner[k][1];
        const double p = size * ((a + jitter(a, b, 0, n)) / n - 0.5);
        const double q = size * ((b + jitter(a, b, 1, n)) / n - 0.5);
        for (int c = 0; c < 3; c++)
          *to++ = at[c] + p * s[c] + q * t[c];
      }
    }
  return 2 * n * n;
}

double sphere_mass(double density, double r) {
  return density * 4.0 / 3.0 * PI * r * r * r;
}

int world_rank(void) {
  int rank;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  return rank;
}

int world_size(void) {
  int size;
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  return size;
}
