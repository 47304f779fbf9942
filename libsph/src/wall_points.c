/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ghost points behind walls (Markauskas et al. 2017, sec. 5.1), made anew for every particle near
 * one whenever sums are taken: doc/equations.md, S.16. */
#include "internal.h"

/* Lattice about the foot of the particle on its nearest wall. */
typedef struct lattice {
  double n[3], t[2][3]; /* unit normal and directions in the wall; the last is 0 in the plane */
  int across[2];        /* nodes either way along t */
} lattice;

/* Faces within some 15 degrees of each other are one side. */
static const double same_side = 0.966;

/* Nearer than this to the wall the factor of the mirrored velocity does not grow any more: it would
 * be infinite at the wall. Particles begin at half a spacing. */
static const double nearest_mirror = 0.1;

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Sides in front of which the particle is: of a block's edge that it looks at from one side, only
 * that side counts. */
static void find_sides(const sph_t *sph, sph_seer *s) {
  double from[SPH_SIDES];
  s->sides = 0;
  for (int k = 0; k < s->count; k++) {
    const sph_face *face = &sph->walls.face[s->near[k]];
    const double d[3] = {s->x[0] - face->a[0], s->x[1] - face->a[1], s->x[2] - face->a[2]};
    double tilt;
    const double height = dot(d, face->n), away = fabs(sph_face_distance(face, s->x, &tilt));
    int at = 0;
    if (height < sph->walls.tie && face->type == SPH_TRIANGLES)
      continue;
    while (at < s->sides && dot(s->side[at].n, face->n) < same_side)
      at++;
    if (at == SPH_SIDES || (at < s->sides && from[at] <= away + sph->walls.tie))
      continue;
    s->sides += at == s->sides;
    s->side[at] = (sph_side){face->n, height, s->near[k], 0.0};
    if (sph->walls.wall[face->wall].moves) {
      double u[3];
      sph_face_velocity(sph, face, s->x, u);
      s->side[at].speed = dot(u, face->n);
    }
    from[at] = away;
  }
}

static void make_frame(const sph_t *sph, lattice *l) {
  const double *n = l->n;
  if (sph->params.dimensions == 2) {
    l->t[0][0] = -n[1];
    l->t[0][1] = n[0];
    l->t[0][2] = 0.0;
    memset(l->t[1], 0, sizeof l->t[1]);
    return;
  }
  /* Along the axis that is most across, so that planes along axes have lattices along axes. */
  int least = 0;
  for (int c = 1; c < 3; c++)
    if (fabs(n[c]) < fabs(n[least]))
      least = c;
  double length = 0.0;
  for (int c = 0; c < 3; c++) {
    l->t[0][c] = (c == least) - n[least] * n[c];
    length += l->t[0][c] * l->t[0][c];
  }
  for (int c = 0; c < 3; c++)
    l->t[0][c] /= sqrt(length);
  for (int c = 0; c < 3; c++)
    l->t[1][c] = n[(c + 1) % 3] * l->t[0][(c + 2) % 3] - n[(c + 2) % 3] * l->t[0][(c + 1) % 3];
}

static void make_lattice(const sph_t *sph, const sph_seer *s, lattice *l) {
  memcpy(l->n, sph->walls.face[s->nearest].n, sizeof l->n);
  make_frame(sph, l);
  l->across[0] = (int)ceil(sph->reach / sph->params.spacing);
  l->across[1] = sph->params.dimensions == 2 ? 0 : l->across[0];
}

/* Share of a lattice cell that is solid, and the wall it belongs to: partly where another surface
 * cuts through, so that nothing jumps when the particle moves along its own wall. */
static double solid_share(const sph_t *sph, const sph_seer *s, const double r[3], int *face,
                          double *behind) {
  double distance = HUGE_VAL;
  if (s->planes) {
    for (int k = 0; k < s->sides; k++) {
      const double one = s->side[k].distance + dot(s->side[k].n, r);
      if (one < distance - sph->walls.tie)
        *face = s->side[k].face;
      distance = fmin(distance, one);
    }
  } else {
    const double y[3] = {s->x[0] + r[0], s->x[1] + r[1], s->x[2] + r[2]};
    *face = sph_faces_nearest(&sph->walls, s->count, s->near, y, &distance);
  }
  const double share = 0.5 - distance / sph->params.spacing;
  *behind = distance < 0.0 ? -distance : 0.0;
  return share < 0.0 ? 0.0 : share < 1.0 ? share : 1.0;
}

double sph_walls_mirror(const sph_t *sph, double behind, double distance) {
  const double least = nearest_mirror * sph->params.spacing;
  return 1.0 + behind / (distance > least ? distance : least);
}

/* Eq. 26 for a point behind one side or, in a corner, several: each mirrors its own normal part of
 * the velocity. A side counts with what of its normal the sides before it do not have, so that two
 * that look nearly the same way are not counted twice. Were only one counted in a corner, density
 * would not follow the work that the pressure of the corner's points does. */
static void mirror_sides(const sph_t *sph, const sph_seer *s, const double r[3], sph_point *p) {
  double before[SPH_SIDES][3];
  int n = 0;
  p->q[0] = p->q[1] = p->q[2] = p->pushed = 0.0;
  for (int k = 0; k < s->sides; k++) {
    const sph_side *one = &s->side[k];
    const double along = dot(one->n, r), behind = -(one->distance + along);
    double m[3] = {one->n[0], one->n[1], one->n[2]};
    if (behind <= 0.0)
      continue;
    for (int b = 0; b < n; b++) {
      const double size2 = dot(before[b], before[b]);
      const double part = size2 > 0.0 ? dot(one->n, before[b]) / size2 : 0.0;
      for (int c = 0; c < 3; c++)
        m[c] -= part * before[b][c];
    }
    const double weight =
        sph_walls_mirror(sph, behind, one->distance) * (n > 0 ? dot(m, r) : along);
    for (int c = 0; c < 3; c++) {
      p->q[c] += weight * m[c];
      before[n][c] = m[c];
    }
    p->pushed += weight * one->speed * dot(m, one->n);
    n++;
  }
}

/* Distance of the particle from the wall that a point is behind. Of a surface of triangles it is that
 * from the plane of the triangle: the triangle itself may be next to the one below the particle, in the
 * same plane or round a bend, and then its nearest point is far off along the wall. Round an edge, where
 * that plane is nearer than the wall, or behind the particle, it is that from the wall. */
static double distance_before(const sph_t *sph, const sph_seer *s, int face) {
  const sph_face *f = &sph->walls.face[face];
  const double d[3] = {s->x[0] - f->a[0], s->x[1] - f->a[1], s->x[2] - f->a[2]};
  return face == s->nearest ? s->distance : fmax(dot(d, f->n), s->distance);
}

/* A point of a corner, an edge or a curved wall; 0: it is in the fluid. */
static int general_point(const sph_t *sph, const sph_seer *s, const double r[3], sph_point *p) {
  double behind;
  const double share = solid_share(sph, s, r, &p->face, &behind);
  if (!(share > 0.0))
    return 0;
  p->volume = share * sph->cell;
  p->mirror = sph_walls_mirror(sph, behind, distance_before(sph, s, p->face));
  mirror_sides(sph, s, r, p);
  return 1;
}

/* A point behind the only wall. */
static void plane_point(const sph_t *sph, const sph_seer *s, const lattice *l, double depth,
                        sph_point *p) {
  p->face = s->nearest;
  p->volume = sph->cell;
  p->mirror = sph_walls_mirror(sph, depth, s->distance);
  for (int c = 0; c < 3; c++)
    p->q[c] = -p->mirror * (depth + s->distance) * l->n[c];
  p->pushed = -p->mirror * (depth + s->distance) * s->side[0].speed;
}

/* Points of row a of a layer at a depth, behind `n` others; `left`: reach^2 less the squares of
 * down and of the row's distance. Returns how many there are now. */
static int make_row(const sph_t *sph, const sph_seer *s, const lattice *l, double depth, int a,
                    double left, int n) {
  const double dx = sph->params.spacing, down = depth + s->distance;
  const int across = l->across[1] > 0 ? (int)(sqrt(left) / dx) : 0;
  double foot[3];
  for (int c = 0; c < 3; c++)
    foot[c] = -down * l->n[c] + dx * a * l->t[0][c];
  for (int b = -across; b <= across; b++) {
    sph_point *p = &sph->walls.point[n];
    for (int c = 0; c < 3; c++)
      p->r[c] = foot[c] + dx * b * l->t[1][c];
    if (s->alone)
      plane_point(sph, s, l, depth, p);
    else if (!general_point(sph, s, p->r, p))
      continue;
    n++;
  }
  return n;
}

/* Ghost points within the support; returns how many. Layers at depths (k + 1/2) dx below the wall,
 * from the top of the support where another wall may be met, to its bottom. */
static int make_points(const sph_t *sph, const sph_seer *s) {
  const double dx = sph->params.spacing, reach2 = sph->reach * sph->reach;
  const int first = s->alone ? 0 : (int)floor((-sph->reach - s->distance) / dx - 0.5);
  lattice l;
  int n = 0;
  make_lattice(sph, s, &l);
  for (int k = first; (k + 0.5) * dx + s->distance < sph->reach; k++) {
    const double depth = (k + 0.5) * dx, down = depth + s->distance;
    for (int a = -l.across[0]; a <= l.across[0]; a++) {
      const double left = reach2 - down * down - dx * dx * a * a;
      if (left > 0.0)
        n = make_row(sph, s, &l, depth, a, left, n);
    }
  }
  return n;
}

/* Faces of a row that are within the support now. */
static void find_within(const sph_t *sph, int row, sph_seer *s) {
  const sph_walls *walls = &sph->walls;
  s->count = 0;
  s->planes = 1;
  for (int k = walls->start[row]; k < walls->start[row + 1]; k++) {
    double tilt;
    const sph_face *face = &walls->face[walls->near[k]];
    const double distance = sph_face_distance(face, s->x, &tilt);
    if (distance >= sph->reach || (face->type == SPH_TRIANGLES && distance <= -sph->reach))
      continue;
    s->near[s->count++] = walls->near[k];
    s->planes &= face->type == SPH_PLANE;
  }
}

int sph_walls_see(sph_t *sph, int row, sph_seer *s) {
  const sph_walls *walls = &sph->walls;
  const int i = walls->particle[row];
  *s = (sph_seer){.x = sph_xv(sph) + SPH_XV * (size_t)i, .near = walls->within};
  find_within(sph, row, s);
  if (s->count == 0)
    return PART_OK;
  s->alone = s->count == 1 && s->planes;
  s->nearest = sph_faces_nearest(walls, s->count, s->near, s->x, &s->distance);
  if (s->distance < -sph->params.spacing)
    return part_fail(PART_ERR_OUTSIDE,
                     "particle %lld at (%g %g %g) m, time %g s, is %g m behind wall %s",
                     (long long)sph_id(sph, i), s->x[0], s->x[1], s->x[2], sph->time, -s->distance,
                     walls->wall[walls->face[s->nearest].wall].name);
  return PART_OK;
}

void sph_walls_sides(const sph_t *sph, sph_seer *s) {
  find_sides(sph, s);
}

int sph_walls_points(sph_t *sph, sph_seer *s) {
  if (sph->plan.fixed)
    return sph_walls_fixed_points(sph, s);
  find_sides(sph, s);
  return make_points(sph, s);
}
