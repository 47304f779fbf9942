/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A glass sphere is dropped 0.1 m onto a floor. Prints the height of its first rebound, over e^2 times that of the drop. */
#include <dem/dem.h>
#include <stdio.h>

#define TRY(call) do { if ((call) != PART_OK) { fprintf(stderr, "%s\n", part_last_error()); return 1; } } while (0)

int main(int argc, char **argv) {
  const double d = 0.01, drop = 0.1, e = 0.8, origin[3] = {0, 0, 0}, up[3] = {0, 0, 1};
  const part_box box = {.lo = {-1, -1, 0}, .hi = {1, 1, 1}};
  const dem_material glass = {.name = "glass", .density = 2500};
  dem_params params;   /* gravity, time step ... */
  dem_contact contact; /* of any two materials */
  dem_insert insert;
  dem_t *dem;
  double z = d / 2 + drop, before = z, rebound = 0;

  MPI_Init(&argc, &argv);
  part_params_default(&dem_params_table, &params);
  params.gravity[2] = -9.81;
  part_params_default(&dem_contact_table, &contact);
  contact.normal_stiffness = 1e7;
  contact.restitution = e;
  part_params_default(&dem_insert_table, &insert);
  TRY(part_params_set(&dem_insert_table, "method", NULL, "lattice", &insert));
  TRY(part_params_set(&dem_insert_table, "material", NULL, "glass", &insert));
  TRY(part_params_set(&dem_insert_table, "diameter", &d, NULL, &insert));
  insert.origin[2] = z;
  insert.count[0] = insert.count[1] = insert.count[2] = 1;

  TRY(dem_create(MPI_COMM_WORLD, &box, &params, &dem));
  TRY(dem_add_material(dem, &glass, NULL));
  TRY(dem_set_contact(dem, -1, -1, &contact)); /* -1: any material */
  TRY(dem_add_plane(dem, "floor", 0, origin, up));
  TRY(dem_insert_particles(dem, &insert, -1, NULL));
  TRY(dem_start(dem));
  for (int rising = 0; z >= before || !rising; rising |= z > before) {
    before = z;
    TRY(dem_advance(dem, 1e-4, NULL)); /* as many contact steps as it takes */
    z = part_field_double(dem_store(dem), DEM_FIELD_POSITION)[2];
    rebound = z - d / 2;
  }
  printf("rebound %.6f m, over e^2 drop: %.5f\n", rebound, rebound / (e * e * drop));
  dem_destroy(dem);
  return MPI_Finalize();
}
