/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From cells given by their outward faces to a mesh as OpenFOAM stores it; its geometry; its split
 * over ranks; the dual of a tetrahedral mesh. See mesh_maker.h. */
#include "mesh_maker.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- matching faces -------------------------------------------------------------------------- */

void mesh_add_face(mesh_builder *b, int cell, int n, const int *corner) {
  if (b->faces == b->capacity) {
    b->capacity = 2 * b->capacity + 64;
    b->start = realloc(b->start, ((size_t)b->capacity + 1) * sizeof *b->start);
    b->cell = realloc(b->cell, (size_t)b->capacity * sizeof *b->cell);
  }
  if (b->corner_count + n > b->corner_capacity) {
    b->corner_capacity = 2 * b->corner_capacity + 256;
    b->corner = realloc(b->corner, (size_t)b->corner_capacity * sizeof *b->corner);
  }
  if (b->start == NULL || b->cell == NULL || b->corner == NULL)
    abort();
  b->start[b->faces] = b->corner_count;
  memcpy(b->corner + b->corner_count, corner, (size_t)n * sizeof *corner);
  b->corner_count += n;
  b->cell[b->faces++] = cell;
  b->start[b->faces] = b->corner_count;
}

typedef struct { /* a face as one cell sees it */
  int n, cell, index;
  int *key; /* its points, sorted */
} half_face;

static int compare_int(const void *a, const void *b) {
  const int x = *(const int *)a, y = *(const int *)b;
  return (x > y) - (x < y);
}

static int compare_key(const half_face *a, const half_face *b) {
  if (a->n != b->n)
    return a->n < b->n ? -1 : 1;
  for (int i = 0; i < a->n; i++)
    if (a->key[i] != b->key[i])
      return a->key[i] < b->key[i] ? -1 : 1;
  return 0;
}

static int compare_half(const void *pa, const void *pb) {
  const half_face *a = pa, *b = pb;
  const int c = compare_key(a, b);
  return c != 0 ? c : a->cell != b->cell ? (a->cell < b->cell ? -1 : 1) : a->index - b->index;
}

typedef struct {
  int owner, neighbour, index; /* neighbour -1: boundary */
} full_face;

static int compare_full(const void *pa, const void *pb) {
  const full_face *a = pa, *b = pb;
  const int outer = (a->neighbour < 0) - (b->neighbour < 0);
  if (outer != 0)
    return outer;
  if (a->owner != b->owner)
    return a->owner < b->owner ? -1 : 1;
  if (a->neighbour != b->neighbour)
    return a->neighbour < b->neighbour ? -1 : 1;
  return a->index - b->index;
}

static int match_faces(const mesh_builder *b, full_face *full) {
  half_face *half = mesh_alloc((size_t)b->faces, sizeof *half);
  int *key = mesh_alloc((size_t)b->corner_count, sizeof *key);
  memcpy(key, b->corner, (size_t)b->corner_count * sizeof *key);
  for (int f = 0; f < b->faces; f++) {
    half[f] = (half_face){b->start[f + 1] - b->start[f], b->cell[f], f, key + b->start[f]};
    qsort(half[f].key, (size_t)half[f].n, sizeof *key, compare_int);
  }
  qsort(half, (size_t)b->faces, sizeof *half, compare_half);
  int count = 0;
  for (int f = 0; f < b->faces; f++) {
    if (f + 1 < b->faces && compare_key(&half[f], &half[f + 1]) == 0) {
      if (half[f].cell != half[f + 1].cell) /* else: inside an agglomerated cell */
        full[count++] = (full_face){half[f].cell, half[f + 1].cell, half[f].index};
      f++;
    } else {
      full[count++] = (full_face){half[f].cell, -1, half[f].index};
    }
  }
  qsort(full, (size_t)count, sizeof *full, compare_full);
  free(key);
  free(half);
  return count;
}

/* ---- geometry, as primitiveMesh -------------------------------------------------------------- */

static void triangle_about(const double p[3], const double q[3], const double c[3], double n[3]) {
  double u[3], v[3];
  for (int d = 0; d < 3; d++) {
    u[d] = q[d] - p[d];
    v[d] = c[d] - p[d];
  }
  n[0] = u[1] * v[2] - u[2] * v[1];
  n[1] = u[2] * v[0] - u[0] * v[2];
  n[2] = u[0] * v[1] - u[1] * v[0];
}

static void face_geometry(const cpl_mesh *m, int f, double centre[3], double area[3]) {
  const int *p = m->face_point + m->face_start[f], n = m->face_start[f + 1] - m->face_start[f];
  double average[3] = {0, 0, 0}, sum[3] = {0, 0, 0}, magnitude = 0.0;
  memset(area, 0, 3 * sizeof *area);
  for (int i = 0; i < n; i++)
    for (int d = 0; d < 3; d++)
      average[d] += m->point[3 * p[i] + d] / n;
  for (int i = 0; i < n; i++) {
    const double *a = m->point + 3 * p[i], *b = m->point + 3 * p[(i + 1) % n];
    double t[3];
    triangle_about(a, b, average, t);
    const double size = sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]);
    magnitude += size;
    for (int d = 0; d < 3; d++) {
      area[d] += 0.5 * t[d];
      sum[d] += size * (a[d] + b[d] + average[d]) / 3.0;
    }
  }
  for (int d = 0; d < 3; d++)
    centre[d] = n == 3 ? average[d] : sum[d] / magnitude;
}

void mesh_face_area(const cpl_mesh *mesh, int f, double area[3]) {
  double centre[3];
  face_geometry(mesh, f, centre, area);
}

static void cell_geometry(made_mesh *mesh) {
  const cpl_mesh *m = &mesh->view;
  double *guess = mesh_alloc((size_t)m->cells, 4 * sizeof *guess);
  for (int f = 0; f < m->faces; f++)
    for (int side = 0; side < (f < m->internal ? 2 : 1); side++) {
      double *g = guess + 4 * (side == 0 ? m->owner[f] : m->neighbour[f]);
      for (int d = 0; d < 3; d++)
        g[d] += m->face_centre[3 * f + d];
      g[3] += 1.0;
    }
  for (int f = 0; f < m->faces; f++) {
    double area[3];
    mesh_face_area(m, f, area);
    for (int side = 0; side < (f < m->internal ? 2 : 1); side++) {
      const int c = side == 0 ? m->owner[f] : m->neighbour[f];
      const double *g = guess + 4 * c;
      double v3 = 0.0;
      for (int d = 0; d < 3; d++)
        v3 += (side == 0 ? 1.0 : -1.0) * area[d] * (m->face_centre[3 * f + d] - g[d] / g[3]);
      for (int d = 0; d < 3; d++)
        mesh->cell_centre[3 * c + d] +=
            v3 * (0.75 * m->face_centre[3 * f + d] + 0.25 * g[d] / g[3]);
      mesh->volume[c] += v3;
    }
  }
  for (int c = 0; c < m->cells; c++) {
    for (int d = 0; d < 3; d++)
      mesh->cell_centre[3 * c + d] /= mesh->volume[c];
    mesh->volume[c] /= 3.0;
  }
  free(guess);
}

/* Arrays of the given sizes exist and are set, except the geometry. */
static void complete(made_mesh *mesh, int points, int faces, int internal, int cells) {
  mesh->face_centre = mesh_alloc((size_t)faces, 3 * sizeof(double));
  mesh->cell_centre = mesh_alloc((size_t)cells, 3 * sizeof(double));
  mesh->volume = mesh_alloc((size_t)cells, sizeof(double));
  mesh->view = (cpl_mesh){.points = points,
                          .faces = faces,
                          .internal = internal,
                          .cells = cells,
                          .point = mesh->point,
                          .face_start = mesh->face_start,
                          .face_point = mesh->face_point,
                          .owner = mesh->owner,
                          .neighbour = mesh->neighbour,
                          .face_centre = mesh->face_centre,
                          .cell_centre = mesh->cell_centre,
                          .volume = mesh->volume};
  for (int f = 0; f < faces; f++) {
    double area[3];
    face_geometry(&mesh->view, f, mesh->face_centre + 3 * f, area);
  }
  cell_geometry(mesh);
}

static void allocate_faces(made_mesh *mesh, int faces, int internal, int corners) {
  mesh->face_start = mesh_alloc((size_t)faces + 1, sizeof(int));
  mesh->face_point = mesh_alloc((size_t)corners, sizeof(int));
  mesh->owner = mesh_alloc((size_t)faces, sizeof(int));
  mesh->neighbour = mesh_alloc((size_t)internal, sizeof(int));
}

void mesh_finish(mesh_builder *b, made_mesh *mesh) {
  full_face *full = mesh_alloc((size_t)b->faces, sizeof *full);
  const int faces = match_faces(b, full);
  int internal = 0;
  while (internal < faces && full[internal].neighbour >= 0)
    internal++;
  memset(mesh, 0, sizeof *mesh);
  allocate_faces(mesh, faces, internal, b->corner_count);
  for (int f = 0, at = 0; f < faces; f++) {
    const int from = b->start[full[f].index], n = b->start[full[f].index + 1] - from;
    memcpy(mesh->face_point + at, b->corner + from, (size_t)n * sizeof(int));
    mesh->face_start[f + 1] = at += n;
    mesh->owner[f] = full[f].owner;
    if (f < internal)
      mesh->neighbour[f] = full[f].neighbour;
  }
  mesh->point = b->point;
  complete(mesh, b->points, faces, internal, b->cells);
  free(full);
  free(b->start);
  free(b->corner);
  free(b->cell);
}

void mesh_free(made_mesh *mesh) {
  free(mesh->point);
  free(mesh->face_start);
  free(mesh->face_point);
  free(mesh->owner);
  free(mesh->neighbour);
  free(mesh->face_centre);
  free(mesh->cell_centre);
  free(mesh->volume);
  free(mesh->global_cell);
  memset(mesh, 0, sizeof *mesh);
}

/* ---- split over ranks ------------------------------------------------------------------------ */

void mesh_part_blocks(const made_mesh *whole, int ranks, int *rank_of_cell) {
  for (int c = 0; c < whole->view.cells; c++)
    rank_of_cell[c] = (int)((int64_t)c * ranks / whole->view.cells);
}

void mesh_part_random(const made_mesh *whole, int ranks, uint64_t seed, int *rank_of_cell) {
  for (int c = 0; c < whole->view.cells; c++)
    rank_of_cell[c] = (int)(mesh_random(&seed) * ranks);
}

typedef struct {
  const cpl_mesh *from;
  made_mesh *to;
  int *new_point, *new_cell; /* -1: not on this rank */
  int points, faces, corners;
} splitter;

/* flip: the owner is elsewhere; keep the first point, as face::reverseFace does. */
static void split_face(splitter *s, int f, int flip) {
  const int *p = s->from->face_point + s->from->face_start[f];
  const int n = s->from->face_start[f + 1] - s->from->face_start[f];
  for (int i = 0; i < n; i++) {
    const int old = p[flip ? (n - i) % n : i];
    if (s->new_point[old] < 0) {
      memcpy(s->to->point + 3 * s->points, s->from->point + 3 * old, 3 * sizeof(double));
      s->new_point[old] = s->points++;
    }
    s->to->face_point[s->corners++] = s->new_point[old];
  }
  s->to->owner[s->faces] = s->new_cell[flip ? s->from->neighbour[f] : s->from->owner[f]];
  s->to->face_start[++s->faces] = s->corners;
}

void mesh_split(const made_mesh *whole, const int *rank_of_cell, int rank, made_mesh *part) {
  const cpl_mesh *m = &whole->view;
  splitter s = {.from = m, .to = part};
  memset(part, 0, sizeof *part);
  part->box = whole->box;
  part->point = mesh_alloc((size_t)m->points, 3 * sizeof(double));
  part->global_cell = mesh_alloc((size_t)m->cells, sizeof(int));
  allocate_faces(part, m->faces, m->internal, m->face_start[m->faces]);
  s.new_point = mesh_alloc((size_t)m->points, sizeof(int));
  s.new_cell = mesh_alloc((size_t)m->cells, sizeof(int));
  memset(s.new_point, -1, (size_t)m->points * sizeof(int));
  int cells = 0, internal = 0;
  for (int c = 0; c < m->cells; c++) {
    s.new_cell[c] = rank_of_cell[c] == rank ? cells : -1;
    if (rank_of_cell[c] == rank)
      part->global_cell[cells++] = c;
  }
  for (int f = 0; f < m->internal; f++)
    if (s.new_cell[m->owner[f]] >= 0 && s.new_cell[m->neighbour[f]] >= 0) {
      part->neighbour[internal++] = s.new_cell[m->neighbour[f]];
      split_face(&s, f, 0);
    }
  for (int f = m->internal; f < m->faces; f++)
    if (s.new_cell[m->owner[f]] >= 0)
      split_face(&s, f, 0);
  for (int f = 0; f < m->internal; f++) {
    const int own = s.new_cell[m->owner[f]] >= 0, nei = s.new_cell[m->neighbour[f]] >= 0;
    if (own != nei)
      split_face(&s, f, nei);
  }
  complete(part, s.points, s.faces, internal, cells);
  free(s.new_point);
  free(s.new_cell);
}
