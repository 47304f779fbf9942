/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fixed points behind walls (S.23; Wu et al. 2018, sec. 5): a lattice over the domain, of which
 * those nodes are kept that are behind a wall, but not farther than the layers. They never move and
 * never change. A wall that is not along the lattice has steps. */
#include "internal.h"

/* Nodes of the lattice, first and one beyond the last in each direction. */
typedef struct nodes {
  double lo[3], side[3];
  int from[3], to[3];
} nodes;

static int layers_of(const sph_t *sph) {
  const int64_t layers = sph->walls.wall[0].params.layers;
  return layers > 0 ? (int)layers : 2;
}

/* Cells of the domain about one spacing long, as those in which the fluid is put, and beyond its
 * borders the layers, or as far as the support where it goes on. */
static nodes lattice_of(const sph_t *sph) {
  nodes l;
  for (int c = 0; c < 3; c++) {
    const double dx = sph->params.spacing, length = sph->box.hi[c] - sph->box.lo[c];
    const double cells = fmax(floor(length / dx + 0.5), 1.0);
    const int more =
        sph->box.periodic[c] ? (int)ceil((sph->reach + sph->skin) / dx) + 1 : layers_of(sph);
    l.lo[c] = sph->box.lo[c];
    l.side[c] = length / cells;
    l.from[c] = -more;
    l.to[c] = (int)cells + more;
  }
  if (sph->params.dimensions == 2) {
    l.lo[2] = sph->plane;
    l.side[2] = 0.0;
    l.from[2] = 0;
    l.to[2] = 1;
  }
  return l;
}

/* Is a node behind a wall, within the layers? face: the nearest. */
static int behind(const sph_t *sph, const double x[3], int *near, int *face) {
  const sph_walls *walls = &sph->walls;
  const double deep = layers_of(sph) * sph->params.spacing;
  int n = 0;
  double distance;
  for (int f = 0; f < walls->planes; f++)
    near[n++] = f;
  n += sph_walls_in_bin(walls, x, near + n);
  if (n == 0)
    return 0;
  *face = sph_faces_nearest(walls, n, near, x, &distance);
  return distance <= walls->tie && distance > -deep - walls->tie;
}

static int add_point(sph_walls *walls, const double x[3], int face) {
  PART_TRY(sph_grow((size_t)walls->fixed_count + 1, sizeof *walls->fixed, &walls->fixed_room,
                    &walls->fixed));
  sph_fixed *p = &walls->fixed[walls->fixed_count++];
  memcpy(p->x, x, sizeof p->x);
  p->face = face;
  return PART_OK;
}

static int make_points(sph_t *sph, const nodes *l, int *near) {
  for (int k = l->from[2]; k < l->to[2]; k++)
    for (int j = l->from[1]; j < l->to[1]; j++)
      for (int i = l->from[0]; i < l->to[0]; i++) {
        const double x[3] = {l->lo[0] + (i + 0.5) * l->side[0], l->lo[1] + (j + 0.5) * l->side[1],
                             l->lo[2] + (k + 0.5) * l->side[2]};
        int face;
        if (behind(sph, x, near, &face))
          PART_TRY(add_point(&sph->walls, x, face));
      }
  return PART_OK;
}

/* ---- looking them up ---------------------------------------------------------------------------
 */
static int cell_of(const sph_fixed_grid *g, const double x[3], int at[3]) {
  for (int c = 0; c < 3; c++) {
    const double k = floor((x[c] - g->lo[c]) / g->edge);
    at[c] = (int)fmin(fmax(k, 0.0), g->cells[c] - 1.0);
  }
  return (at[2] * g->cells[1] + at[1]) * g->cells[0] + at[0];
}

/* Cells no smaller than the support, so that those of a particle's and the next ones hold all it
 * sees. */
static void make_grid(const sph_t *sph, const nodes *l, sph_fixed_grid *g) {
  double cells = HUGE_VAL;
  for (g->edge = sph->reach; cells > 1e6; g->edge *= cells > 1e6 ? 1.5 : 1.0) {
    cells = 1.0;
    for (int c = 0; c < 3; c++) {
      g->lo[c] = l->lo[c] + l->from[c] * l->side[c];
      g->cells[c] = (int)fmin(floor((l->to[c] - l->from[c]) * l->side[c] / g->edge) + 1.0, 1e6);
      cells *= g->cells[c];
    }
  }
}

/* In the order of cells. */
static int sort_points(sph_walls *walls) {
  sph_fixed_grid *g = &walls->fixed_grid;
  const size_t cells = (size_t)g->cells[0] * (size_t)g->cells[1] * (size_t)g->cells[2];
  const size_t n = (size_t)walls->fixed_count;
  size_t start_room = 0, sorted_room = 0;
  sph_fixed *sorted = NULL;
  int at[3];
  PART_TRY(sph_grow(cells + 2, sizeof *g->start, &start_room, &g->start));
  PART_TRY(sph_grow(n, sizeof *sorted, &sorted_room, &sorted));
  for (size_t k = 0; k < n; k++)
    g->start[cell_of(g, walls->fixed[k].x, at) + 2]++;
  for (size_t c = 2; c < cells + 2; c++)
    g->start[c] += g->start[c - 1];
  for (size_t k = 0; k < n; k++)
    sorted[g->start[cell_of(g, walls->fixed[k].x, at) + 1]++] = walls->fixed[k];
  free(walls->fixed);
  walls->fixed = sorted;
  return PART_OK;
}

static int take(const sph_t *sph, const sph_fixed *fixed, const double x[3], sph_point *p) {
  double r2 = 0.0;
  for (int c = 0; c < 3; c++) {
    p->r[c] = p->q[c] = fixed->x[c] - x[c];
    r2 += p->r[c] * p->r[c];
  }
  p->volume = sph->walls.fixed_volume;
  p->mirror = 1.0;
  p->face = fixed->face;
  p->pushed = 0.0; /* the point moves with its wall */
  for (int c = 0; c < 3; c++)
    p->pushed += p->q[c] * sph->walls.wall[sph->walls.face[fixed->face].wall].pose.drift[c];
  return r2 < sph->reach * sph->reach && r2 > 0.0;
}

int sph_walls_fixed_points(sph_t *sph, const sph_seer *s) {
  sph_walls *walls = &sph->walls;
  const sph_fixed_grid *g = &walls->fixed_grid;
  int at[3], lo[3], hi[3], n = 0;
  cell_of(g, s->x, at);
  for (int c = 0; c < 3; c++) {
    lo[c] = at[c] > 0 ? at[c] - 1 : 0;
    hi[c] = at[c] + 1 < g->cells[c] ? at[c] + 1 : at[c];
  }
  for (int z = lo[2]; z <= hi[2]; z++)
    for (int y = lo[1]; y <= hi[1]; y++) {
      const int row = (z * g->cells[1] + y) * g->cells[0];
      for (int k = g->start[row + lo[0]]; k < g->start[row + hi[0] + 1]; k++)
        n += take(sph, &walls->fixed[k], s->x, &walls->point[n]);
    }
  return n;
}

int sph_walls_fix(sph_t *sph) {
  sph_walls *walls = &sph->walls;
  size_t room = 0;
  int *near = NULL;
  if (walls->count == 0 || walls->wall[0].params.model != SPH_WALL_fixed)
    return PART_OK;
  const nodes l = lattice_of(sph);
  PART_TRY(sph_grow((size_t)walls->faces + 1, sizeof *near, &room, &near));
  int status = make_points(sph, &l, near);
  free(near);
  walls->fixed_volume =
      l.side[0] * l.side[1] * (sph->params.dimensions == 2 ? sph->params.depth : l.side[2]);
  if (status == PART_OK && walls->fixed_count == 0)
    status = part_fail(PART_ERR_RANGE, "there is no point of the lattice behind any wall");
  make_grid(sph, &l, &walls->fixed_grid);
  return status == PART_OK ? sort_points(walls) : status;
}
