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

static scene scene_of(double dx) {
  scene s;
  memset(&s, 0, sizeof s);
  s.comm = MPI_COMM_WORLD;
  part_params_default(&sph_params_table, &s.params);
  s.params.spacing = dx;
  s.params.smoothing_length = 1.5 * dx;
  s.params.density = 1000.0;
  s.params.viscosity = 0.0;
  s.params.sound_speed = 10.0;
  return s;
}

scene scene_2d(double length_x, double length_y, double dx) {
  scene s = scene_of(dx);
  s.box.hi[0] = length_x;
  s.box.hi[1] = length_y;
  s.box.lo[2] = -dx;
  s.box.hi[2] = dx;
  s.params.dimensions = 2;
  s.params.depth = 0.1;
  return s;
}

scene scene_3d(const double length[3], double dx) {
  scene s = scene_of(dx);
  memcpy(s.box.hi, length, sizeof s.box.hi);
  return s;
}

sph_t *scene_create(const scene *s) {
  sph_t *sph;
  OK(sph_create(s->comm, &s->box, &s->params, &sph));
  return sph;
}

static sph_insert whole(const scene *s) {
  sph_insert insert;
  part_params_default(&sph_insert_table, &insert);
  for (int c = 0; c < 3; c++) {
    insert.origin[c] = s->box.lo[c];
    insert.extent[c] = s->box.hi[c] - s->box.lo[c];
  }
  if (s->params.dimensions == 2)
    insert.origin[2] = 0.0;
  return insert;
}

void fill_box(sph_t *sph, const scene *s) {
  const sph_insert insert = whole(s);
  OK(sph_insert_box(sph, &insert, NULL));
}

void fill_water(sph_t *sph, const scene *s, double level, int direction) {
  sph_insert insert = whole(s);
  insert.extent[direction] = level - insert.origin[direction];
  insert.hydrostatic = 1;
  insert.surface[direction] = level;
  OK(sph_insert_box(sph, &insert, NULL));
}

void add_planes(sph_t *sph, const scene *s, int direction, int slip) {
  for (int end = 0; end < 2; end++) {
    sph_wall_params wall;
    char name[32];
    part_params_default(&sph_wall_table, &wall);
    wall.type = SPH_PLANE;
    wall.slip = slip;
    wall.point[direction] = end ? s->box.hi[direction] : s->box.lo[direction];
    wall.normal[direction] = end ? -1.0 : 1.0;
    snprintf(name, sizeof name, "%s%c", end ? "upper" : "lower", "XYZ"[direction]);
    OK(sph_add_wall(sph, name, &wall, 0, NULL));
  }
}

static double draw(int64_t id, int c) {
  uint64_t x = (uint64_t)id * 4u + (uint64_t)c + 1u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return (double)((x ^ (x >> 31)) >> 11) / 9007199254740992.0 - 0.5;
}

void stir(sph_t *sph, const scene *s, double speed) {
  const part_store *store = sph_store(sph);
  const int64_t *id = part_field_int64(store, SPH_FIELD_ID);
  double *v = part_field_double(store, SPH_FIELD_VELOCITY);
  const size_t is = (size_t)part_field_stride(store, SPH_FIELD_ID);
  const size_t vs = (size_t)part_field_stride(store, SPH_FIELD_VELOCITY);
  for (size_t i = 0; i < (size_t)store->local; i++)
    for (int c = 0; c < (int)s->params.dimensions; c++)
      v[vs * i + (size_t)c] += 2.0 * speed * draw(id[is * i], c);
}

void find_all(sph_t *sph, MPI_Comm comm, int64_t first, int64_t n, body *bodies) {
  sph_view view;
  OK(sph_get_view(sph, &view));
  const part_store *store = sph_store(sph);
  const int64_t *id = part_field_int64(store, SPH_FIELD_ID);
  const size_t is = (size_t)part_field_stride(store, SPH_FIELD_ID);
  memset(bodies, 0, (size_t)n * sizeof *bodies);
  for (size_t i = 0; i < (size_t)view.own; i++) {
    assert_in_range(id[is * i] - first, 0, (uintmax_t)n - 1);
    body *b = &bodies[id[is * i] - first];
    memcpy(b->x, view.position + (size_t)view.xv_stride * i, sizeof b->x);
    memcpy(b->v, view.velocity + (size_t)view.xv_stride * i, sizeof b->v);
    memcpy(b->a, view.acceleration + (size_t)view.rate_stride * i, sizeof b->a);
    b->p = view.pressure[(size_t)view.xv_stride * i];
    b->density = view.density[(size_t)view.mass_stride * i];
    b->count = 1.0;
  }
  MPI_Allreduce(MPI_IN_PLACE, bodies, (int)((size_t)n * sizeof *bodies / sizeof(double)),
                MPI_DOUBLE, MPI_SUM, comm);
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

const char *path_of(const char *name) {
  static char path[300];
  const char *folder = getenv("TMPDIR");
  snprintf(path, sizeof path, "%s/sph-%s-%d.vtkhdf", folder != NULL ? folder : "/tmp", name,
           world_size());
  return path;
}
