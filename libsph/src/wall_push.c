/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Walls that push (S.24, S.25): each side in front of which a particle is, along its normal. */
#include "internal.h"
#include "wall_models/repulsive.h"
#include "wall_models/spring.h"

typedef double (*place_function)(const sph_wall_place *at);

static const place_function push_of[] = {
#define SPH_WALL_POINTS(name, key, meaning) NULL,
#define SPH_WALL_PUSH(name, key, meaning) sph_wall_push_##name,
#include "sph/wall_models.def"
#undef SPH_WALL_POINTS
#undef SPH_WALL_PUSH
};
static const place_function step_of[] = {
#define SPH_WALL_POINTS(name, key, meaning) NULL,
#define SPH_WALL_PUSH(name, key, meaning) sph_wall_step_##name,
#include "sph/wall_models.def"
#undef SPH_WALL_POINTS
#undef SPH_WALL_PUSH
};

int sph_walls_push(const sph_t *sph) {
  return sph->walls.count > 0 && push_of[sph->walls.wall[0].params.model] != NULL;
}

static sph_wall_place place_at(const sph_t *sph, const sph_wall *wall, double mass) {
  return (sph_wall_place){.mass = mass,
                          .spacing = sph->params.spacing,
                          .h = sph->params.smoothing_length,
                          .sound_speed = sph->params.sound_speed,
                          .wall = &wall->params};
}

void sph_walls_push_force(sph_t *sph, int row, sph_seer *s, double force[3], int side) {
  const int i = sph->walls.particle[row];
  const double *v = sph_xv(sph) + SPH_XV * (size_t)i + 4, *m = sph_mass(sph) + SPH_MASS * (size_t)i;
  const sph_side *one = &s->side[side];
  const sph_wall *wall = &sph->walls.wall[sph->walls.face[one->face].wall];
  sph_wall_place at = place_at(sph, wall, m[0]);
  at.distance = one->distance;
  at.leaving = v[0] * one->n[0] + v[1] * one->n[1] + v[2] * one->n[2];
  const double push = m[1] * push_of[wall->params.model](&at);
  for (int c = 0; c < 3; c++)
    force[c] = push * one->n[c];
}

double sph_walls_longest_step(const sph_t *sph) {
  double step = HUGE_VAL;
  if (!sph_walls_push(sph))
    return step;
  for (int w = 0; w < sph->walls.count; w++) {
    const sph_wall *wall = &sph->walls.wall[w];
    const sph_wall_place at = place_at(sph, wall, sph->least_eps * sph->params.density * sph->cell);
    step = fmin(step, step_of[wall->params.model](&at));
  }
  return step;
}
