/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Near faces of every own particle: those within the support and the skin when lists are built. */
#include "internal.h"

static int bin_of(const sph_bins *bins, const double x[3]) {
  int at[3];
  for (int c = 0; c < 3; c++) {
    const double k = floor((x[c] - bins->lo[c]) / bins->edge);
    if (!(k >= 0.0 && k < bins->cells[c]))
      return -1;
    at[c] = (int)k;
  }
  return (at[2] * bins->cells[1] + at[1]) * bins->cells[0] + at[0];
}

int sph_walls_in_bin(const sph_walls *walls, const double x[3], int *near) {
  const int bin = walls->planes < walls->faces ? bin_of(&walls->bins, x) : -1;
  const int begin = bin >= 0 ? walls->bins.start[bin] : 0,
            count = bin >= 0 ? walls->bins.start[bin + 1] - begin : 0;
  for (int k = 0; k < count; k++)
    near[k] = walls->bins.item[begin + k];
  return count;
}

/* near[] has room for all faces from `used` on. */
static int take_if_near(sph_walls *walls, int face, const double x[3], double reach, int used) {
  double tilt;
  if (sph_face_distance(&walls->face[face], x, &tilt) > reach)
    return used;
  walls->near[used] = face;
  return used + 1;
}

static int add_row(sph_t *sph, int i, int *used) {
  sph_walls *walls = &sph->walls;
  const double *x = sph_xv(sph) + SPH_XV * (size_t)i, reach = sph->reach + sph->skin;
  const int first = *used, bin = walls->planes < walls->faces ? bin_of(&walls->bins, x) : -1;
  const int begin = bin >= 0 ? walls->bins.start[bin] : 0,
            end = bin >= 0 ? walls->bins.start[bin + 1] : 0;
  PART_TRY(sph_grow((size_t)(first + walls->planes + end - begin) + 1, sizeof *walls->near,
                    &walls->near_room, &walls->near));
  for (int f = 0; f < walls->planes; f++)
    *used = take_if_near(walls, f, x, reach, *used);
  for (int k = begin; k < end; k++)
    *used = take_if_near(walls, walls->bins.item[k], x, reach, *used);
  if (*used == first)
    return PART_OK;
  walls->particle[walls->rows] = i;
  walls->start[walls->rows++] = first;
  return PART_OK;
}

/* Most ghost points of one particle: a cube of the lattice around the support. */
static size_t most_points(const sph_t *sph) {
  const double side = 2.0 * ceil(sph->reach / sph->params.spacing) + 3.0;
  return (size_t)(sph->params.dimensions == 2 ? side * side : side * side * side);
}

int sph_walls_list(sph_t *sph) {
  sph_walls *walls = &sph->walls;
  const size_t n = (size_t)sph->store->local;
  int used = 0;
  walls->rows = 0;
  if (walls->travelling && walls->planes < walls->faces) {
    free(walls->bins.start);
    free(walls->bins.item);
    walls->bins = (sph_bins){.edge = 0.0};
    PART_TRY(sph_walls_bins(walls, sph->reach + sph->skin));
  }
  PART_TRY(sph_grow(n + 1, sizeof *walls->particle, &walls->row_room, &walls->particle));
  PART_TRY(sph_grow(n + 1, sizeof *walls->start, &walls->start_room, &walls->start));
  PART_TRY(sph_grow(n + 1, sizeof *sph->shade, &sph->shade_room, &sph->shade));
  PART_TRY(sph_grow(most_points(sph), sizeof *walls->point, &walls->point_room, &walls->point));
  for (int i = 0; i < sph->store->local; i++)
    PART_TRY(add_row(sph, i, &used));
  PART_TRY(sph_grow((size_t)used + 1, sizeof *walls->within, &walls->within_room, &walls->within));
  walls->start[walls->rows] = used;
  return PART_OK;
}
