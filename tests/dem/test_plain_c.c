/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libdem from plain C, without any helper: the whole of a small program. A sphere dropped from
 * 0.1 m rises to e^2 of that height. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "dem/dem.h"

static int drop(double restitution, double *height) {
  const part_box box = {{-1, -1, 0}, {1, 1, 1}, {0, 0, 0}, {0, 0, 0}};
  const double floor_at[3] = {0, 0, 0}, up[3] = {0, 0, 1};
  dem_params params;
  dem_material glass = {.name = "glass", .density = 2500.0};
  dem_contact contact;
  dem_insert insert;
  dem_t *dem;
  double z = 0.0, highest = 0.0, before = 1.0;
  int risen = 0;

  part_params_default(&dem_params_table, &params);
  part_params_default(&dem_contact_table, &contact);
  part_params_default(&dem_insert_table, &insert);
  params.gravity[2] = -9.81;
  params.time_step_fraction = 1.0 / 200;
  contact.normal_stiffness = 1e6;
  contact.restitution = restitution;
  PART_TRY(part_params_set(&dem_insert_table, "method", NULL, "lattice", &insert));
  PART_TRY(part_params_set(&dem_insert_table, "material", NULL, "glass", &insert));
  insert.diameter = 0.01;
  insert.origin[2] = 0.105;
  insert.count[0] = insert.count[1] = insert.count[2] = 1;

  PART_TRY(dem_create(MPI_COMM_WORLD, &box, &params, &dem));
  PART_TRY(dem_add_material(dem, &glass, NULL));
  PART_TRY(dem_set_contact(dem, 0, 0, &contact));
  PART_TRY(dem_add_plane(dem, "floor", 0, floor_at, up));
  PART_TRY(dem_insert_particles(dem, &insert, -1, NULL));
  PART_TRY(dem_start(dem));
  for (int k = 0; k < 400; k++) {
    PART_TRY(dem_advance(dem, 1e-3, NULL));
    z = part_field_double(dem_store(dem), DEM_FIELD_POSITION)[2];
    risen |= z > before;
    highest = risen && z > highest ? z : highest;
    before = z;
    if (risen && z < highest)
      break;
  }
  *height = highest - 0.005;
  dem_destroy(dem);
  return PART_OK;
}

static void rises_to_e_squared(void **state) {
  (void)state;
  double height;
  for (double e = 0.5; e < 0.95; e += 0.2) {
    assert_int_equal(drop(e, &height), PART_OK);
    /* The damping force jumps to its largest value within one step of the touch: e is known to
     * 2 zeta pi dt/tc (first order; see test_collision). The top is seen every 1 ms. */
    const double zeta = -log(e) / sqrt(9.8696 + log(e) * log(e));
    const double error = 2.0 * zeta * 3.1416 / 200 + 1e-3;
    assert_true(fabs(height - 0.1 * e * e) < 0.1 * 2.0 * e * error + 9.81 * 1e-6);
  }
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(rises_to_e_squared)};
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
