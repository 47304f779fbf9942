/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Contact of particles with walls: the same laws with a partner of infinite mass that moves as the
 * wall does.
 *
 * A sphere may meet several triangles at once. The nearest place comes first, at one distance a
 * face before an edge before a vertex (how far an edge is hardly tells a place beside it from one
 * below the centre: the direction would be wrong by the root of rounding); a further place p counts
 * only when it lies above the plane through the contact q of every contact taken before, with
 * normal n_q: (p - q) . n_q > 0. On coplanar or
 * convex neighbours all other places are on or below that plane (it supports a convex body), so
 * exactly one contact is left; a place above it is a second surface that the sphere really meets.
 *
 * The tangential spring goes with the contact, not with the triangle: an element that becomes
 * active takes over the spring of one of the same material that was active a step ago in nearly
 * the same direction and is not any more, so rolling over an edge changes nothing. */
#include "internal.h"
#include "laws.h"
#include "rotation.h"

static const double covered_height = 1e-6; /* of the radius: single precision of STL files */
static const double same_direction = 0.9;  /* cosine */
static const double touch_margin =
    1e-9; /* of the radius: what is closer to a border is not rejected */

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* At one distance. */
static int before(const dem_candidate *a, const dem_candidate *b) {
  if (a->feature != b->feature)
    return a->feature < b->feature;
  if (a->gap != b->gap)
    return a->gap < b->gap;
  return a->order < b->order;
}

/* Frame of a wall, seen with one shift: neighbours in a row mostly share it. */
typedef struct frame {
  int wall, shift;
  double seen[3];
} frame;

/* Can the sphere touch a planar element, and where? Squares the distance that it is away at least.
 * 0: no; 1: on its face, *height above it; 2: to be looked at closely. */
static int reject(const dem_facet *facet, const double seen[3], double r, double *height,
                  double *least) {
  const double d[3] = {seen[0] - facet->a[0], seen[1] - facet->a[1], seen[2] - facet->a[2]};
  double s[4];
  for (int k = 0; k < 4; k++)
    s[k] = d[0] * facet->n[0][k] + d[1] * facet->n[1][k] + d[2] * facet->n[2][k] - facet->o[k];
  const double up = s[0] > 0.0 ? s[0] : facet->back * s[0];
  const double edge = s[1] > s[2] ? s[1] : s[2], out = edge > s[3] ? edge : s[3];
  const double away = up * up + (out > 0.0 ? out * out : 0.0);
  *height = s[0];
  if (away < *least)
    *least = away;
  if (away >= r * r * (1.0 + touch_margin))
    return 0;
  return out < -touch_margin * r ? 1 : 2;
}

/* Place on the face of a planar element, as dem_element_nearest has it. */
static void on_face(const dem_t *dem, const dem_element *e, double height, dem_candidate *found) {
  const double sign = e->shape == DEM_SHAPE_TRIANGLE && height < 0.0 ? -1.0 : 1.0;
  found->feature = 0;
  found->gap = sign * height;
  for (int c = 0; c < 3; c++) {
    found->n[c] = sign * e->n[c];
    found->p[c] = -found->gap * found->n[c];
  }
  dem_wall_direct(&dem->walls.wall[e->wall], found->p);
  dem_wall_direct(&dem->walls.wall[e->wall], found->n);
}

/* Nearest place of an entry: 0 when it is out of reach. *least as in reject. */
static int place_of(const dem_t *dem, const dem_near *near, const double *x, frame *at,
                    double *least, dem_candidate *found) {
  const dem_walls *walls = &dem->walls;
  const dem_element *e = &walls->element[near->element];
  if (e->shape != DEM_SHAPE_CYLINDER && dem->params.skip) {
    double height;
    if (at->wall != e->wall || at->shift != near->shift) {
      at->wall = e->wall;
      at->shift = near->shift;
      dem_wall_see(dem, &walls->wall[e->wall], near->shift, x, at->seen);
    }
    const int close = reject(&walls->facet[near->element], at->seen, x[3], &height, least);
    if (close == 1)
      on_face(dem, e, height, found);
    if (close < 2)
      return close == 1 && found->gap < x[3];
  }
  found->feature =
      dem_wall_nearest(dem, near->element, near->shift, x, found->p, found->n, &found->gap);
  const double away = found->gap > 0.0 ? found->gap * found->gap : 0.0;
  if (away < *least)
    *least = away;
  return found->gap < x[3];
}

/* Places of a row within the sphere; *least: square of a distance within which there is no element.
 */
static int find(const dem_t *dem, int row, const double *x, dem_candidate *place, double *least) {
  const dem_walls *walls = &dem->walls;
  frame at = {.wall = -1};
  int count = 0;
  *least = HUGE_VAL;
  for (int k = walls->start[row]; k < walls->start[row + 1]; k++) {
    const dem_near *near = &walls->near[k];
    dem_candidate found = {.entry = k, .order = near->element * DEM_SHIFTS + near->shift};
    if (!place_of(dem, near, x, &at, least, &found))
      continue;
    place[count++] = found;
  }
  return count;
}

/* The place that is taken next. */
static int next_place(const dem_candidate *place, int count, double r) {
  double nearest = HUGE_VAL;
  int best = -1;
  for (int k = 0; k < count; k++)
    nearest = fmin(nearest, place[k].gap);
  for (int k = 0; k < count; k++)
    if (place[k].gap <= nearest + touch_margin * r && (best < 0 || before(&place[k], &place[best])))
      best = k;
  return best;
}

/* Keep the places that are not covered by one before; returns how many. */
static int select(dem_candidate *place, int count, double r) {
  int kept = 0;
  while (kept < count) {
    const int best = kept + (count - kept > 1 ? next_place(place + kept, count - kept, r) : 0);
    const dem_candidate one = place[best];
    int left = kept + 1;
    place[best] = place[kept];
    place[kept] = one;
    for (int k = kept + 1; k < count; k++)
      if (dot(place[k].p, one.n) + one.gap > covered_height * r)
        place[left++] = place[k];
    kept++;
    count = left;
  }
  return kept;
}

static int is_active(const dem_near *near) {
  return dot(near->n, near->n) > 0.0;
}

static int is_kept(const dem_candidate *place, int kept, int entry) {
  for (int m = 0; m < kept; m++)
    if (place[m].entry == entry)
      return 1;
  return 0;
}

/* Springs of contacts that have moved on to another element; then forget what is not active. */
static void hand_over(dem_walls *walls, int row, const dem_candidate *place, int kept) {
  for (int m = 0; m < kept; m++) {
    dem_near *to = &walls->near[place[m].entry], *from = NULL;
    double best = same_direction;
    if (is_active(to))
      continue;
    for (int k = walls->start[row]; k < walls->start[row + 1]; k++) {
      dem_near *old = &walls->near[k];
      if (!is_active(old) || is_kept(place, kept, k) ||
          walls->element[old->element].material != walls->element[to->element].material)
        continue;
      if (dot(old->n, place[m].n) > best) {
        best = dot(old->n, place[m].n);
        from = old;
      }
    }
    if (from != NULL) {
      memcpy(to->spring, from->spring, sizeof to->spring);
      memcpy(to->roll, from->roll, sizeof to->roll);
      memcpy(to->n, from->n, sizeof to->n); /* it goes on: no new contact */
      memset(from->n, 0, sizeof from->n);
      memset(from->spring, 0, sizeof from->spring);
      memset(from->roll, 0, sizeof from->roll);
    }
  }
  for (int k = walls->start[row]; k < walls->start[row + 1]; k++)
    if (is_active(&walls->near[k]) && !is_kept(place, kept, k)) {
      memset(walls->near[k].n, 0, sizeof walls->near[k].n);
      memset(walls->near[k].spring, 0, sizeof walls->near[k].spring);
      memset(walls->near[k].roll, 0, sizeof walls->near[k].roll);
    }
}

/* Force and moment of a contact on the particle into the sums of the wall; lever: contact point from
 * `from`. */
static void add_to_wall(dem_t *dem, dem_wall *wall, const double lever[3], const double force[3],
                        const double moment[3]) {
  for (int c = 0; c < 3; c++) {
    const int d = (c + 1) % 3, e = (c + 2) % 3;
    dem->wall_force[c] += force[c];
    wall->force[c] -= force[c];
    wall->torque[c] -= lever[d] * force[e] - lever[e] * force[d] + moment[c];
  }
}

/* Velocity of the wall's surface at the contact point. */
static void surface_velocity(const dem_wall *wall, const double lever[3], double v[3]) {
  for (int c = 0; c < 3; c++)
    v[c] = wall->pose.body.drift[c] + (wall->turns ? dot(wall->pose.body.gain[c], lever) : 0.0);
}

/* Contact point seen from the centre of the wall, whose image the shift names. */
static void lever_of(const dem_t *dem, const dem_wall *wall, int shift, const double *x,
                     const double n[3], double arm, double lever[3]) {
  const double *lo = dem->box.lo, *hi = dem->box.hi;
  for (int c = 0; c < 3; c++)
    lever[c] = x[c] - arm * n[c] - wall->pose.from[c];
  if (shift == DEM_NO_SHIFT)
    return;
  const int s[3] = {shift % 3 - 1, shift / 3 % 3 - 1, shift / 9 - 1};
  for (int c = 0; c < 3; c++)
    lever[c] -= s[c] * (hi[c] - lo[c]);
}

/* The own mass of a member of a block, see blocks.c; for clumps see R.4. */
static double inverse_mass(const dem_t *dem, int i, const double n[3]) {
  if (dem->plan.all_free)
    return dem_vm(dem)[DEM_VM * (size_t)i + 3];
  const int kind = dem_kind_of(dem, i);
  if (kind == DEM_BLOCK)
    return 1.0 / dem_own_mass(dem, i);
  return dem_vm(dem)[DEM_VM * (size_t)i + 3] +
         (kind == DEM_CLUMP ? dem_form(dem->clumps.turn + 6 * (size_t)i, n) : 0.0);
}

/* Of a contact with the surface. The curvature of a cylinder is along one direction; the area of a
 * Hertzian contact goes with the root of the product of both. Edges and vertices count as flat. */
static double reduced_radius(const dem_t *dem, const dem_near *near, const dem_candidate *place,
                             const double *x) {
  const dem_element *e = &dem->walls.element[near->element];
  if (e->shape != DEM_SHAPE_CYLINDER || place->feature != 0)
    return x[3];
  double along = 0.0, from = 0.0, seen[3];
  dem_wall_see(dem, &dem->walls.wall[e->wall], near->shift, x, seen);
  for (int c = 0; c < 3; c++) {
    along += (seen[c] - e->a[c]) * e->n[c];
    from += (seen[c] - e->a[c]) * (seen[c] - e->a[c]);
  }
  if (e->length > 0.0 && !(along >= 0.0 && along <= e->length)) /* flat end of a rod */
    return x[3];
  const int inside = e->side == DEM_WALL_INSIDE &&
                     (e->length == 0.0 || from - along * along < e->radius * e->radius);
  return 1.0 / sqrt((1.0 / x[3]) * (1.0 / x[3] + (inside ? -1.0 : 1.0) / e->radius));
}

static void touch_wall(dem_t *dem, int i, const dem_candidate *place, double dt) {
  dem_near *near = &dem->walls.near[place->entry];
  const dem_element *element = &dem->walls.element[near->element];
  dem_wall *wall = &dem->walls.wall[element->wall];
  const int parts = dem_parts(dem);
  const double *vm = dem_vm(dem) + DEM_VM * (size_t)i, *n = place->n;
  const double *x = dem_xr(dem) + DEM_XR * (size_t)i;
  double *ft = dem_ft(dem) + DEM_FT * (size_t)i, force[3], moment[3] = {0.0, 0.0, 0.0}, lever[3];
  double history[DEM_HISTORY];
  dem_touch touch;
  memcpy(touch.n, n, sizeof touch.n);
  memcpy(history, near->spring, sizeof near->spring);
  memcpy(history + DEM_SPRING, near->roll, sizeof near->roll);
  touch.inverse_root = sqrt(inverse_mass(dem, i, n));
  touch.root_mass = 1.0 / touch.inverse_root;
  touch.touches = 1;
  /* See fast.h for the units of spin and torque. */
  const double unit = dem->fast.spins ? 1.0 / x[3] : 1.0;
  const double w[3] = {vm[4] * unit, vm[5] * unit, vm[6] * unit};
  memcpy(touch.spin, w, sizeof touch.spin);
  touch.radius = reduced_radius(dem, near, place, x);
  touch.overlap = x[3] - place->gap;
  const double arm = place->gap + 0.5 * touch.overlap;
  touch.v[0] = vm[0] - arm * (w[1] * n[2] - w[2] * n[1]);
  touch.v[1] = vm[1] - arm * (w[2] * n[0] - w[0] * n[2]);
  touch.v[2] = vm[2] - arm * (w[0] * n[1] - w[1] * n[0]);
  lever_of(dem, wall, near->shift, x, n, arm, lever);
  if (wall->moves) {
    double v[3];
    surface_velocity(wall, lever, v);
    for (int c = 0; c < 3; c++) {
      touch.v[c] -= v[c];
      touch.spin[c] -= wall->spin[c];
    }
  }
  dem_laws_any(&dem->coefs[(int)vm[7] * dem->materials + element->material], &touch, parts, dt,
               history, force, moment);
  memcpy(near->spring, history, sizeof near->spring);
  memcpy(near->roll, history + DEM_SPRING, sizeof near->roll);
  if (dem->wear.shear_asked || dem->wear.impact_asked)
    dem_wear_contact(dem, near->element, (int)vm[7], &touch, force, !is_active(near), dt);
  for (int c = 0; c < 3; c++) {
    ft[c] += force[c];
    near->n[c] = n[c];
  }
  add_to_wall(dem, wall, lever, force, moment);
  if (parts & DEM_SLIDING) {
    ft[4] += unit * (moment[0] + arm * (n[2] * force[1] - n[1] * force[2]));
    ft[5] += unit * (moment[1] + arm * (n[0] * force[2] - n[2] * force[0]));
    ft[6] += unit * (moment[2] + arm * (n[1] * force[0] - n[0] * force[1]));
  }
}

int dem_walls_touched(const dem_t *dem, int row, dem_candidate *place) {
  const double *x = dem_xr(dem) + DEM_XR * (size_t)dem->walls.particle[row];
  double least;
  return select(place, find(dem, row, x, place, &least), x[3]);
}

/* Can a row that had a gap when it was last looked at touch now? The particle has moved, and the
 * walls have on their path. */
static int is_due(const dem_walls *walls, int row, const double *x) {
  const double *was = walls->checked + 4 * (size_t)row;
  const double d[3] = {x[0] - was[0], x[1] - was[1], x[2] - was[2]}, left = was[3] - walls->path;
  return !(left > 0.0 && d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < left * left);
}

/* Contacts of a row now, and the springs of those that were. */
static int take_row(dem_t *dem, int row, const double *x) {
  dem_walls *walls = &dem->walls;
  double *was = walls->checked + 4 * (size_t)row, least;
  const int found = find(dem, row, x, walls->scratch, &least);
  const int kept = select(walls->scratch, found, x[3]);
  hand_over(walls, row, walls->scratch, kept);
  memcpy(was, x, 3 * sizeof *was);
  was[3] = kept > 0 || !dem->params.skip
               ? -1.0
               : walls->path + (sqrt(least) * (1.0 - touch_margin) - x[3]);
  return kept;
}

void dem_wall_forces(dem_t *dem, double dt) {
  dem_walls *walls = &dem->walls;
  const double *xr = dem_xr(dem);
  for (int row = 0; row < walls->rows; row++) {
    const double *x = xr + DEM_XR * (size_t)walls->particle[row];
    if (!is_due(walls, row, x))
      continue;
    const int kept = take_row(dem, row, x);
    for (int m = 0; m < kept; m++)
      touch_wall(dem, walls->particle[row], &walls->scratch[m], dt);
  }
}
