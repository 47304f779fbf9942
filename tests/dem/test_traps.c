/* ranks: 1 2 */
/* timeout: 300 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Nothing that the library does raises a floating point exception that its caller sees: OpenFOAM
 * traps invalid operations, divisions by zero and overflow. Every law and part of a scene, every
 * width of vectors; spheres that touch to the bit without moving, and spheres that collide. */
#define _GNU_SOURCE /* feenableexcept */
#include <fenv.h>
#include "clump_scenes.h"

#include "../../libdem/src/fast.h"

enum {
  TRIANGLES = 1,
  CYLINDER = 2,
  CLUMPS = 4,
  BONDS = 8,
  FILM = 16,
  FIXED = 32,
  FLUID = 64,
  FLAT = 128,
  KINDS = 256, /* of sizes */
  SIDE = 6,
  LOOSE = 60
};

typedef struct variant {
  const char *name;
  int law, parts;
  double friction, rolling, adhesion;
} variant;

static const variant variants[] = {
    {"frictionless", LINEAR, 0, 0.0, 0.0, 0.0},
    {"friction", LINEAR, 0, 0.4, 0.0, 0.0},
    {"rolling, cohesion", LINEAR, FIXED, 0.4, 0.1, 0.05},
    {"sizes", LINEAR, KINDS, 0.4, 0.0, 0.0},
    {"Hertz, frictionless", HERTZ, 0, 0.0, 0.0, 0.0},
    {"Hertz, friction", HERTZ, KINDS, 0.4, 0.0, 0.0},
    {"Hertz, rolling, cohesion", HERTZ, FIXED | KINDS, 0.4, 0.1, 0.05},
    {"fluid", LINEAR, FLUID, 0.4, 0.0, 0.0},
    {"triangles", LINEAR, TRIANGLES, 0.4, 0.1, 0.05},
    {"triangles, Hertz", HERTZ, TRIANGLES, 0.4, 0.1, 0.0},
    {"cylinder", LINEAR, CYLINDER, 0.4, 0.0, 0.0},
    {"clumps", LINEAR, CLUMPS | TRIANGLES, 0.4, 0.0, 0.0},
    {"clumps, Hertz, fluid", HERTZ, CLUMPS | FLUID, 0.4, 0.0, 0.0},
    {"bonds", LINEAR, BONDS, 0.4, 0.0, 0.0},
    {"bonds, fluid", LINEAR, BONDS | FLUID | TRIANGLES, 0.4, 0.0, 0.0},
    {"lubrication", LINEAR, FILM | KINDS, 0.4, 0.0, 0.0},
    {"discs", LINEAR, FLAT | KINDS, 0.4, 0.1, 0.0},
    {"discs, bonds", LINEAR, FLAT | BONDS | FILM, 0.4, 0.0, 0.0},
};
enum { VARIANTS = sizeof variants / sizeof *variants };

static const double d = 0.004, height = 0.05;

static void add_walls(dem_t *dem, int parts) {
  double vertices[18 * 16];
  const double corner[3] = {0.0, 0.0, 0.0}, up[3] = {0.0, 0.0, 1.0}, along[3] = {0.0, 1.0, 0.0};
  const double middle[3] = {0.5 * height, 0.5 * height, 0.0};
  if (parts & TRIANGLES) {
    dem_wall_params wall = wall_of(DEM_WALL_TRIANGLES);
    wall.oscillation_amplitude = 1e-4;
    wall.oscillation_frequency = 100.0;
    memcpy(wall.oscillation_direction, up, sizeof up);
    OK(dem_add_wall(dem, "floor", &wall, triangulated_square(middle, up, height, 4, vertices),
                    vertices));
  } else if (parts & CYLINDER) {
    dem_wall_params wall = wall_of(DEM_WALL_CYLINDER);
    memcpy(wall.axis, up, sizeof up);
    memcpy(wall.point, middle, sizeof middle);
    memcpy(wall.centre, middle, sizeof middle);
    memcpy(wall.rotation_axis, up, sizeof up);
    wall.rotation_rate = 30.0;
    wall.radius = 0.5 * height;
    OK(dem_add_wall(dem, "drum", &wall, 0, NULL));
    OK(dem_add_plane(dem, "floor", 0, corner, up));
  } else {
    OK(dem_add_plane(dem, "floor", 0, corner, parts & FLAT ? along : up));
  }
}

static dem_t *create(const variant *v) {
  scene s = scene_with_law(v->law);
  const int flat = v->parts & FLAT;
  s.params.gravity[flat ? 1 : 2] = -9.81;
  if (flat) {
    s.params.dimensions = 2;
    s.params.depth = d;
  }
  for (int c = 0; c < 3; c++) {
    s.box.lo[c] = 0.0;
    s.box.hi[c] = height;
    s.box.periodic[c] = !(v->parts & CYLINDER) && c < (flat ? 1 : 2);
  }
  s.box.lo[flat ? 1 : 2] = -0.001;
  s.contact.friction = v->friction;
  s.contact.rolling_friction = v->rolling;
  s.contact.work_of_adhesion = v->adhesion;
  s.contact.restitution = 0.7;
  dem_t *dem = scene_create(&s);
  add_walls(dem, v->parts);
  if (v->parts & BONDS) {
    dem_bond bond;
    part_params_default(&dem_bond_table, &bond);
    bond.youngs_modulus = 1e7;
    bond.poisson_ratio = 0.25;
    bond.tensile_strength = bond.shear_strength = 1e4;
    OK(dem_add_bonds(dem, -1, -1, &bond));
  }
  if (v->parts & FILM) {
    dem_lubrication film;
    part_params_default(&dem_lubrication_table, &film);
    film.viscosity = 0.01;
    film.inner_gap = 1e-6;
    OK(dem_set_lubrication(dem, &film));
  }
  return dem;
}

/* A lattice of spheres that touch, on the floor where there is one; loose ones above. */
static void insert(dem_t *dem, const variant *v, const char *shape) {
  const int flat = v->parts & FLAT, kind = v->parts & FIXED ? DEM_FIXED : DEM_FREE;
  const double at[3] = {0.013, flat ? 0.5 * d : 0.013, 0.5 * d};
  const double above[3] = {0.014, flat ? 0.03 : 0.014, flat ? 0.5 * d : 0.028};
  dem_insert some = lattice(DEM_FREE, d, at, d, SIDE, SIDE, flat ? 1 : SIDE - 1);
  const double bottom[3] = {0.002, 0.002, 0.5 * d}, corner[3] = {0.003, 0.003, 0.022};
  OK(dem_insert_particles(dem, &some, -1, NULL));
  some = random_spheres(flat ? LOOSE / 6 : LOOSE, 0.7 * d, v->parts & KINDS ? d : 0.0, above, 0.021,
                        3);
  if (flat) {
    some.extent[2] = 0.0;
    some.extent[1] = 0.018;
    some.velocity[0] = 0.3; /* stir is for three dimensions */
    some.velocity[1] = -1.0;
  }
  if (v->parts & CLUMPS) {
    some = random_clumps(shape, 6, 0.004, 0.0, corner, 0.044, 3);
    some.extent[2] = 0.024;
    OK(dem_insert_particles(dem, &some, -1, NULL));
  } else {
    OK(dem_insert_particles(dem, &some, -1, NULL));
  }
  if (kind == DEM_FIXED) {
    some = lattice(DEM_FIXED, d, bottom, d, 1, 1, 3);
    OK(dem_insert_particles(dem, &some, -1, NULL));
  }
}

static void advance(dem_t *dem, const variant *v, int advances) {
  const double su[3] = {1e-5, 0.0, 0.0};
  for (int k = 0; k < advances; k++) {
    if (v->parts & FLUID)
      set_fluid(dem, su, k % 2 ? 1e-4 : 1e3); /* also drag far stiffer than the step */
    OK(dem_advance(dem, 15.0 * fmin(dem_stable_step(dem), 1e-4), NULL));
  }
}

static void no_trap(const variant *v, int width, int stirred, const char *shape, double *sum) {
  char path[300];
  const char *folder = getenv("TMPDIR");
  dem_report report;
  snprintf(path, sizeof path, "%s/dem-traps-%d.vtkhdf", folder != NULL ? folder : "/tmp",
           world_size());
  feclearexcept(FE_ALL_EXCEPT);
  feenableexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW);
  dem_t *dem = create(v);
  OK(dem_fast_limit(dem, width));
  insert(dem, v, shape);
  OK(dem_start(dem));
  OK(dem_get_report(dem, &report)); /* spheres that touch to the bit */
  advance(dem, v, 1);
  if (stirred && !(v->parts & FLAT))
    stir(dem, 1.0);
  advance(dem, v, 25);
  OK(dem_get_report(dem, &report));
  sum[0] += (double)(report.contacts + report.bonds);
  sum[1] += (double)report.wall_contacts;
  OK(dem_write(dem, path, NULL));
  dem_destroy(dem);
  dem = create(v);
  OK(dem_fast_limit(dem, width));
  OK(dem_read(dem, path));
  OK(dem_start(dem));
  advance(dem, v, 2);
  dem_destroy(dem);
  fedisableexcept(FE_ALL_EXCEPT);
  MPI_Barrier(MPI_COMM_WORLD);
  if (world_rank() == 0)
    remove(path);
}

static void traps(void **state) {
  (void)state;
  static const int widths[] = {8, 4, 1};
  const char *shape = ell_shape();
  for (int k = 0; k < VARIANTS; k++)
    for (int w = 0; w < 3; w++) {
      double sum[2] = {0.0, 0.0};
      print_message("# %s, width %d\n", variants[k].name, widths[w]);
      no_trap(&variants[k], widths[w], 0, shape, sum);
      no_trap(&variants[k], widths[w], 1, shape, sum);
      print_message("# %g pairs in contact or bonded, %g on walls\n", sum[0], sum[1]);
      assert_true(sum[0] + sum[1] > 20.0 && sum[1] > 2.0);
    }
}

/* The test can fail: traps are on. */
static void traps_work(void **state) {
  (void)state;
  volatile double zero = 0.0;
  fenv_t environment;
  feholdexcept(&environment);
  zero = 1.0 / zero;
  assert_true(fetestexcept(FE_DIVBYZERO) != 0);
  fesetenv(&environment);
  feenableexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW);
  assert_int_equal(fegetexcept(), FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW);
  fedisableexcept(FE_ALL_EXCEPT);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(traps_work),
      cmocka_unit_test(traps),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, remove_clump_files);
  MPI_Finalize();
  return failed;
}
