/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The coupling dictionary: defaults, names, ranges, and what cpl_create refuses. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>
#include "scene.h"

static void test_defaults(void **state) {
  (void)state;
  cpl_params p;
  part_params_default(&cpl_params_table, &p);
  assert_int_equal(p.model, CPL_MODEL_A);
  assert_int_equal(p.void_fraction, 0); /* exact is the first row */
  assert_int_equal(p.sub_cells, 40);
  assert_true(p.minimum_eps == 0.05);
  assert_int_equal(p.pressure_gradient, 1);
  assert_int_equal(p.viscous_stress, 0);
  assert_int_equal(p.two_way, 1);
  assert_int_equal(part_params_check(&cpl_params_table, &p),
                   PART_ERR_ARGUMENT); /* drag not given */
  assert_non_null(strstr(part_last_error(), "drag"));
}

static void test_names(void **state) {
  (void)state;
  cpl_params p = scene_params();
  const struct {
    const char *entry, *word;
    int value;
  } choice[] = {{"model", "B", CPL_MODEL_B},         {"model", "A", CPL_MODEL_A},
                {"model", "Bfull", CPL_MODEL_BFULL}, {"voidFraction", "exact", 0},
                {"voidFraction", "subCell", 1},      {"voidFraction", "centre", 2},
                {"voidFraction", "kernel", 3}};
  for (size_t k = 0; k < sizeof choice / sizeof *choice; k++) {
    assert_int_equal(part_params_set(&cpl_params_table, choice[k].entry, NULL, choice[k].word, &p),
                     PART_OK);
    assert_int_equal(k < 3 ? p.model : p.void_fraction, choice[k].value);
  }
  for (int k = 0; k < cpl_drag_count(); k++) {
    assert_int_equal(part_params_set(&cpl_params_table, "drag", NULL, cpl_drag_name(k), &p),
                     PART_OK);
    assert_int_equal(p.drag, k);
  }
  assert_int_equal(part_params_check(&cpl_params_table, &p), PART_OK);
}

/* Drag force per slip, and eps at least, are those of the new parameters; what can not change
 * leaves all as it was. */
static void test_change(void **state) {
  (void)state;
  scene s;
  const mesh_options o = MESH_UNIT(MESH_HEX, 3, 3, 3);
  const particle one = {.x = {0.5, 0.5, 0.5}, .r = 0.15, .density = 2500.0};
  const cpl_fluid water = {1000.0, 1e-3, {0.0, 0.0, 0.0}};
  cpl_params p = scene_params();
  assert_int_equal(part_params_set(&cpl_params_table, "drag", NULL, "stokes", &p), PART_OK);
  scene_mesh(&s, MPI_COMM_WORLD, &o, 0);
  assert_int_equal(scene_start(&s, &p, &water), PART_OK);
  scene_particles(&s, 1, &one, 0, 0);
  scene_fluid(&s);
  double before[2];
  for (int k = 0; k < 2; k++) {
    assert_int_equal(cpl_locate(s.cpl, &s.view), PART_OK);
    assert_int_equal(cpl_void_fraction(s.cpl, &s.view, &s.cells, NULL), PART_OK);
    assert_int_equal(cpl_sample_fluid(s.cpl, &s.view, &s.cells), PART_OK);
    assert_int_equal(cpl_fluid_force(s.cpl, &s.view), PART_OK);
    before[k] = s.view.count > 0 ? s.view.fluid_sp[0] : 0.0;
    assert_int_equal(part_params_set(&cpl_params_table, "drag", NULL, "schillerNaumann", &p),
                     PART_OK);
    assert_int_equal(cpl_change_params(s.cpl, &p), PART_OK);
  }
  assert_true(s.view.count == 0 || before[1] > 1.5 * before[0]);
  cpl_params other = p;
  other.model = CPL_MODEL_B;
  other.drag = 0;
  assert_int_equal(cpl_change_params(s.cpl, &other), PART_ERR_ARGUMENT);
  assert_non_null(strstr(part_last_error(), "'model'"));
  assert_int_equal(cpl_fluid_force(s.cpl, &s.view), PART_OK);
  assert_true(s.view.count == 0 || s.view.fluid_sp[0] == before[1]); /* nothing has changed */
  p.minimum_eps = 0.999;
  p.overfull = CPL_OVERFULL_ERROR;
  assert_int_equal(cpl_change_params(s.cpl, &p), PART_OK);
  assert_int_equal(cpl_void_fraction(s.cpl, &s.view, &s.cells, NULL), PART_ERR_RANGE);
  p.overfull = CPL_OVERFULL_SPREAD;
  assert_int_equal(cpl_change_params(s.cpl, &p), PART_OK);
  p.minimum_eps = 2.0;
  assert_int_equal(cpl_change_params(s.cpl, &p), PART_ERR_RANGE);
  scene_free(&s);
}

static void test_errors(void **state) {
  (void)state;
  cpl_params p = scene_params();
  const double zero = 0.0, one = 1.0, many = 2000.0, negative = -0.1;
  assert_int_equal(part_params_set(&cpl_params_table, "drag", NULL, "diFelix", &p), PART_ERR_RANGE);
  assert_non_null(strstr(part_last_error(), "diFelice"));
  assert_int_equal(part_params_set(&cpl_params_table, "minimumEps", &zero, NULL, &p),
                   PART_ERR_RANGE);
  assert_int_equal(part_params_set(&cpl_params_table, "minimumEps", &one, NULL, &p),
                   PART_ERR_RANGE);
  assert_int_equal(part_params_set(&cpl_params_table, "minimumEps", &negative, NULL, &p),
                   PART_ERR_RANGE);
  assert_int_equal(part_params_set(&cpl_params_table, "subCells", &zero, NULL, &p), PART_ERR_RANGE);
  assert_int_equal(part_params_set(&cpl_params_table, "subCells", &many, NULL, &p), PART_ERR_RANGE);
  assert_null(part_params_find(&cpl_params_table, "twoways"));
  assert_string_equal(part_params_nearest(&cpl_params_table, "twoways"), "twoWay");
}

static void test_create_refuses(void **state) {
  (void)state;
  const mesh_options options = MESH_UNIT(MESH_HEX, 2, 2, 2);
  scene s;
  scene_mesh(&s, MPI_COMM_SELF, &options, 0);
  cpl_params params = scene_params();
  cpl_fluid fluid = scene_water();
  params.model = CPL_MODEL_B;
  params.viscous_stress = 1;
  assert_int_equal(scene_start(&s, &params, &fluid), PART_ERR_ARGUMENT);
  assert_non_null(strstr(part_last_error(), "viscousStress"));
  params = scene_params();
  params.model = CPL_MODEL_BFULL;
  params.pressure_gradient = 0;
  assert_int_equal(scene_start(&s, &params, &fluid), PART_ERR_ARGUMENT);
  assert_non_null(strstr(part_last_error(), "pressureGradient"));
  params = scene_params();
  params.drag = -1;
  assert_int_equal(scene_start(&s, &params, &fluid), PART_ERR_ARGUMENT);
  params = scene_params();
  fluid.density = 0.0;
  assert_int_equal(scene_start(&s, &params, &fluid), PART_ERR_RANGE);
  fluid = scene_water();
  fluid.viscosity = -1.0;
  assert_int_equal(scene_start(&s, &params, &fluid), PART_ERR_RANGE);
  fluid = scene_water();
  const double volume = s.mesh.volume[3];
  s.mesh.volume[3] = 0.0;
  assert_int_equal(scene_start(&s, &params, &fluid), PART_ERR_RANGE);
  assert_non_null(strstr(part_last_error(), "cell 3"));
  s.mesh.volume[3] = volume;
  assert_int_equal(scene_start(&s, &params, &fluid), PART_OK);
  scene_free(&s);
}

static void test_no_cells(void **state) {
  (void)state;
  const cpl_mesh empty = {0};
  const part_box box = {{0, 0, 0}, {1, 1, 1}, {0, 0, 0}, {0, 0, 0}};
  const cpl_params params = scene_params();
  const cpl_fluid fluid = scene_water();
  cpl_t *cpl = NULL;
  assert_int_equal(cpl_create(MPI_COMM_SELF, &empty, &box, &params, &fluid, &cpl),
                   PART_ERR_ARGUMENT);
  assert_non_null(strstr(part_last_error(), "no cells"));
}

static void test_plan(void **state) {
  (void)state;
  const mesh_options options = MESH_UNIT(MESH_HEX, 2, 2, 2);
  scene s;
  scene_mesh(&s, MPI_COMM_SELF, &options, 0);
  cpl_params params = scene_params();
  params.two_way = 0;
  params.model = CPL_MODEL_B;
  const cpl_fluid fluid = scene_water();
  assert_int_equal(scene_start(&s, &params, &fluid), PART_OK);
  char text[2048];
  assert_int_equal(cpl_plan_text(s.cpl, sizeof text, text), PART_OK);
  assert_non_null(strstr(text, "twoWay off"));
  assert_non_null(strstr(text, "model B"));
  assert_int_equal(cpl_plan_text(s.cpl, 20, text), PART_ERR_RANGE);
  scene_free(&s);
}

int main(int argc, char **argv) {
  MPI_Init(&argc, &argv);
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_defaults),       cmocka_unit_test(test_names),
      cmocka_unit_test(test_change),         cmocka_unit_test(test_errors),
      cmocka_unit_test(test_create_refuses), cmocka_unit_test(test_no_cells),
      cmocka_unit_test(test_plan),
  };
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
