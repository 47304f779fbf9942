/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Materials and their contacts: every entry out of its range, entries that do not go together, and
 * what follows from them against closed forms (doc/equations.md D.4, D.11). */
#include "common.h"

static dem_material glass_of(double young, double poisson) {
  dem_material m;
  part_params_default(&dem_material_table, &m);
  strcpy(m.name, "glass");
  m.density = 2500.0;
  m.youngs_modulus = young;
  m.poisson_ratio = poisson;
  return m;
}

static dem_t *created(void) {
  const scene s = scene_default();
  dem_t *dem;
  OK(dem_create(s.comm, &s.box, &s.params, &dem));
  return dem;
}

/* One value into a row: material or contact is refused, and the message names entry and range. */
static void refused(const part_param_table *table, const part_param *row, double value) {
  const dem_material glass = glass_of(0.0, (double)NAN);
  dem_material m = glass_of(2e8, 0.3);
  scene s = scene_default();
  const int contact = table == &dem_contact_table;
  char *values = contact ? (char *)&s.contact : (char *)&m, range[200];
  dem_t *dem = created();
  if (row->type == PART_PARAM_SCALAR)
    memcpy(values + row->offset, &value, sizeof value);
  else
    memcpy(values + row->offset, &(int){(int)value}, sizeof(int));
  if (contact)
    OK(dem_add_material(dem, &glass, NULL));
  const int status =
      contact ? dem_set_contact(dem, 0, 0, &s.contact) : dem_add_material(dem, &m, NULL);
  if (status == PART_OK)
    print_error("entry %s: %g is taken\n", row->name, value);
  assert_int_not_equal(status, PART_OK);
  assert_non_null(strstr(part_last_error(), row->name));
  if (row->type == PART_PARAM_SCALAR && !isnan(value))
    assert_non_null(strstr(part_last_error(), part_param_range_text(row, sizeof range, range)));
  dem_destroy(dem);
}

static void out_of_range(void **state) {
  (void)state;
  const part_param_table *tables[] = {&dem_contact_table, &dem_material_table};
  int scalars = 0;
  for (int t = 0; t < 2; t++)
    for (int k = 0; k < tables[t]->count; k++) {
      const part_param *row = &tables[t]->rows[k];
      if (row->type == PART_PARAM_CHOICE) {
        refused(tables[t], row, LAWS);
        refused(tables[t], row, -1);
        continue;
      }
      assert_int_equal(row->type, PART_PARAM_SCALAR);
      scalars++;
      refused(tables[t], row, row->low_open ? row->low : row->low - 1e-3);
      refused(tables[t], row, row->high_open ? row->high : row->high + 1e-3);
      refused(tables[t], row, (double)INFINITY);
      refused(tables[t], row, -(double)INFINITY);
      if (!isnan(row->def[0])) /* otherwise it is how not given is said */
        refused(tables[t], row, (double)NAN);
    }
  assert_true(scalars > 8);
}

/* Values at the ends that belong to the range are taken. */
static void ends_of_ranges(void **state) {
  (void)state;
  dem_t *dem = created();
  dem_material m = glass_of(2e8, 0.5);
  OK(dem_add_material(dem, &m, NULL));
  strcpy(m.name, "cork");
  m.poisson_ratio = 0.0;
  OK(dem_add_material(dem, &m, NULL));
  scene s = scene_default();
  s.contact.restitution = 1.0;
  s.contact.tangential_ratio = 1.0;
  s.contact.friction = s.contact.rolling_friction = s.contact.work_of_adhesion = 0.0;
  OK(dem_set_contact(dem, 0, 1, &s.contact));
  s.contact.restitution = 1e-6;
  OK(dem_set_contact(dem, 0, 1, &s.contact));
  dem_destroy(dem);
}

static void names(void **state) {
  (void)state;
  dem_t *dem = created();
  dem_material m = glass_of(0.0, (double)NAN);
  OK(dem_add_material(dem, &m, NULL));
  FAILS(PART_ERR_ARGUMENT, "glass is given twice", dem_add_material(dem, &m, NULL));
  m.name[0] = '\0';
  FAILS(PART_ERR_ARGUMENT, "needs a name", dem_add_material(dem, &m, NULL));
  memset(m.name, 'x', sizeof m.name);
  FAILS(PART_ERR_ARGUMENT, "needs a name", dem_add_material(dem, &m, NULL));
  int number;
  FAILS(PART_ERR_ARGUMENT, "did you mean 'glass'", dem_find_material(dem, "glas", &number));
  scene s = scene_default();
  FAILS(PART_ERR_RANGE, "materials 0 and 1", dem_set_contact(dem, 0, 1, &s.contact));
  FAILS(PART_ERR_RANGE, "materials -1 and 0", dem_set_contact(dem, -1, 0, &s.contact));
  dem_destroy(dem);
}

/* Starts two spheres that may touch, of a material and a contact; the status of it. */
static int begin(const dem_material *m, const scene *s, dem_t **dem) {
  const double still[3] = {0.0, 0.0, 0.0}, other[3] = {0.1, 0.0, 0.0};
  OK(dem_create(s->comm, &s->box, &s->params, dem));
  OK(dem_add_material(*dem, m, NULL));
  OK(dem_set_contact(*dem, 0, 0, &s->contact));
  add_sphere(*dem, DEM_FREE, -1, still, 0.01, still);
  add_sphere(*dem, DEM_FREE, -1, other, 0.01, still);
  return dem_start(*dem);
}

static void at_start(const dem_material *m, const scene *s, const char *words) {
  dem_t *dem;
  FAILS(PART_ERR_RANGE, words, begin(m, s, &dem));
  dem_destroy(dem);
}

/* What contradicts itself, what is missing, what nothing would use. */
static void entries_together(void **state) {
  (void)state;
  scene hertz = scene_with_law(HERTZ), linear = scene_default();
  hertz.params.impact_speed = 1.0;
  dem_material m = glass_of(2e8, 0.3);
  dem_t *dem = created();
  OK(dem_add_material(dem, &m, NULL));
  hertz.contact.normal_stiffness = 1e5;
  FAILS(PART_ERR_RANGE, "normalStiffness is not used by law hertzMindlin",
        dem_set_contact(dem, 0, 0, &hertz.contact));
  hertz.contact.normal_stiffness = (double)NAN;
  hertz.contact.tangential_ratio = 0.2;
  FAILS(PART_ERR_RANGE, "tangentialRatio is not used by law hertzMindlin",
        dem_set_contact(dem, 0, 0, &hertz.contact));
  hertz.contact.tangential_ratio = (double)NAN;
  strcpy(m.name, "b");
  m.youngs_modulus = 0.0;
  FAILS(PART_ERR_RANGE, "poissonRatio is given without youngsModulus",
        dem_add_material(dem, &m, NULL));
  dem_destroy(dem);

  m = glass_of(0.0, (double)NAN);
  at_start(&m, &hertz, "material glass: entries youngsModulus and poissonRatio must be given");
  m = glass_of(2e8, (double)NAN);
  at_start(&m, &hertz, "material glass: entries youngsModulus and poissonRatio must be given");
  m = glass_of(2e8, 0.3);
  at_start(&m, &linear, "youngsModulus is used by none of its contacts");
  hertz.params.impact_speed = 0.0;
  at_start(&m, &hertz, "impactSpeed must be given");
  linear.contact.normal_stiffness = (double)NAN;
  at_start(&m, &linear, "impactSpeed must be given");
  linear.params.impact_speed = 1.0;
  m = glass_of(0.0, (double)NAN);
  at_start(&m, &linear, "normalStiffness is not given");
  linear.contact.normal_stiffness = 1e5;
  at_start(&m, &linear, "impactSpeed is used by no contact");
}

static double contact_time(const dem_material *m, const scene *s) {
  dem_t *dem;
  OK(begin(m, s, &dem));
  const double time = dem_stable_step(dem) / s->params.time_step_fraction;
  dem_destroy(dem);
  return time;
}

/* Of two spheres of 1 cm radius, and of one against a body without curvature that does not give
 * way, the shorter one. Hertz: Johnson, Contact Mechanics, 1985, eq. 11.23 and 11.24. */
static void contact_times(void **state) {
  (void)state;
  const double mass = sphere_mass(2500.0, 0.01), v = 0.7, e_star = 0.5 * 2e8 / (1.0 - 0.09);
  scene s = scene_default();
  dem_material m = glass_of(0.0, (double)NAN);
  const double linear = PI * sqrt(0.5 * mass / 1e5);
  CLOSE(contact_time(&m, &s), linear, 1e-12 * linear);
  s.contact.friction = 0.3; /* k_t = k_n: the tangential spring is the faster one */
  s.contact.tangential_ratio = 1.0;
  CLOSE(contact_time(&m, &s), linear * sqrt(2.0 / 7.0), 1e-12 * linear);
  s = scene_with_law(HERTZ);
  s.params.impact_speed = v;
  m = glass_of(2e8, 0.3);
  double least = HUGE_VAL, deepest = 0.0;
  for (int k = 0; k < 2; k++) {
    const double m_eff = mass / (2 - k), r = 0.01 / (2 - k);
    const double deep = pow(15.0 * m_eff * v * v / (16.0 * sqrt(r) * e_star), 0.4);
    least = fmin(least, 2.94 * deep / v);
    deepest = k == 0 ? deep : deepest;
  }
  CLOSE(contact_time(&m, &s), least, 2e-3 * least); /* 2.94 */
  /* A linear spring from the same constants is as deep at the same speed: m v^2 = k d^2. */
  s.contact.law = LINEAR;
  const double k_n = 0.5 * mass * v * v / (deepest * deepest);
  const double stiff = PI * sqrt(0.5 * mass / k_n);
  CLOSE(contact_time(&m, &s), stiff, 1e-12 * stiff);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(out_of_range),     cmocka_unit_test(ends_of_ranges), cmocka_unit_test(names),
      cmocka_unit_test(entries_together), cmocka_unit_test(contact_times),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
