/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "shot.h"

double peak_rebound(double restitution) {
  const double log_e = log(restitution), zeta = -log_e / sqrt(PI * PI + log_e * log_e);
  const double root = sqrt(1.0 - zeta * zeta);
  const double angle = atan2(2.0 * zeta * root, 1.0 - 2.0 * zeta * zeta);
  return exp(-zeta * (PI - angle) / root);
}

static dem_t *prepare(const shot *t, const double x[3], const double y[3]) {
  const double still[3] = {0.0, 0.0, 0.0}, normal[3] = {-1.0, 0.0, 0.0};
  const double corners[9] = {0, -1, -1, 0, 1, -1, 0, 0, 1}, stiff = t->stiff > 0.0 ? t->stiff : 1.0;
  scene s = scene_with_law(t->law);
  s.comm = MPI_COMM_SELF;
  s.contact.normal_stiffness *= stiff;
  s.young *= stiff;
  s.contact.restitution = t->e;
  s.contact.friction = t->mu;
  s.contact.rolling_friction = t->mu_roll;
  if (t->ratio > 0.0)
    s.contact.tangential_ratio = t->ratio;
  s.params.time_step_fraction = 0.2; /* so that an advance is one step of the test's choice */
  s.params.impact_speed = isnan(s.contact.normal_stiffness) ? t->v[0] : 0.0;
  dem_t *dem = scene_create(&s);
  add_sphere(dem, DEM_FREE, -1, x, t->r[0], t->v);
  if (t->r[1] > 0.0)
    add_sphere(dem, DEM_FREE, -1, y, t->r[1], still);
  else if (t->triangle)
    OK(dem_add_triangles(dem, "wall", 0, 1, corners));
  else
    OK(dem_add_plane(dem, "wall", 0, still, normal));
  OK(dem_start(dem));
  const part_store *store = dem_store(dem);
  double *w = part_field_double(store, DEM_FIELD_ANGULAR_VELOCITY);
  const int stride = part_field_stride(store, DEM_FIELD_ANGULAR_VELOCITY);
  const int64_t *id = part_field_int64(store, DEM_FIELD_ID);
  const int step = part_field_stride(store, DEM_FIELD_ID);
  for (int i = 0; i < store->local; i++)
    memcpy(w + stride * i, t->spin[id[step * i]], 3 * sizeof *w);
  return dem;
}

static void look(dem_t *dem, const shot *s, body bodies[2]) {
  bodies[0] = find(dem, MPI_COMM_SELF, 0);
  if (s->r[1] > 0.0)
    bodies[1] = find(dem, MPI_COMM_SELF, 1);
}

outcome shoot(const shot *s) {
  outcome o;
  memset(&o, 0, sizeof o);
  o.m[0] = sphere_mass(2500.0, s->r[0]);
  o.m[1] = s->r[1] > 0.0 ? sphere_mass(2500.0, s->r[1]) : (double)INFINITY;
  /* The contact time does not depend on the gap: once to ask for it, once to collide. */
  double gap = 1e-3 * s->r[0];
  for (int k = 0; k < 2; k++) {
    const double x[3] = {-s->r[0] - gap, -gap * s->v[1] / s->v[0], -gap * s->v[2] / s->v[0]};
    const double y[3] = {s->r[1], 0.0, 0.0};
    dem_t *dem = prepare(s, x, y);
    o.contact_time = dem_stable_step(dem) / 0.2;
    const double h = s->fraction * o.contact_time;
    gap = (1.0 + s->phase) * h * s->v[0];
    look(dem, s, o.before);
    dem_report report;
    for (int n = 0, met = 0; k == 1 && n < (int)(20.0 / s->fraction) + 10; n++) {
      OK(dem_advance(dem, h, NULL));
      OK(dem_get_report(dem, &report));
      const int64_t contacts = report.contacts + report.wall_contacts;
      met |= contacts > 0;
      if (met && contacts == 0)
        break;
    }
    if (k == 1) {
      assert_int_equal(report.contacts + report.wall_contacts, 0);
      CLOSE(report.budget_error, 0.0, 1e-13);
      look(dem, s, o.after);
    }
    dem_destroy(dem);
  }
  return o;
}
