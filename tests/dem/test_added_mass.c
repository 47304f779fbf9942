/* ranks: 1 2 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inertia of the fluid that spheres take along (dem_add_mass), and the velocity that kicks keep. */
#include <unistd.h>

#include "common.h"

static const double origin[3] = {0.1, -0.2, 0.3}, still[3] = {0.0, 0.0, 0.0}, r = 0.01;

static dem_t *with_added(scene *s, double added) {
  dem_t *dem = scene_create(s);
  OK(dem_add_mass(dem, added));
  return dem;
}

/* (rho_s - rho_f) g/(rho_s + rho_f/2), exact for any step, for a stone and for a bubble. */
static void released(void **state) {
  (void)state;
  const double rho = 1000.0, t = 0.02, density[] = {2500.0, 10.0};
  for (int k = 0; k < 2; k++) {
    scene s = scene_default();
    s.params.gravity[2] = -9.81;
    s.density = density[k];
    dem_t *dem = with_added(&s, 0.5 * rho);
    add_sphere(dem, DEM_FREE, -1, origin, r, still);
    OK(dem_start(dem));
    const double buoyancy[3] = {0.0, 0.0, sphere_mass(rho, r) * 9.81};
    for (int n = 0; n < 4; n++) {
      set_fluid(dem, buoyancy, 0.0);
      OK(dem_advance(dem, t / 4, NULL));
    }
    const body b = find(dem, s.comm, 0);
    const double a = -9.81 * (s.density - rho) / (s.density + 0.5 * rho);
    CLOSE(b.v[2], a * t, 1e-14 * fabs(a) * t);
    CLOSE(b.x[2], origin[2] + 0.5 * a * t * t, 1e-15);
    dem_report report;
    OK(dem_get_report(dem, &report));
    CLOSE(report.kinetic_energy, 0.5 * sphere_mass(s.density, r) * a * a * t * t,
          1e-12 * report.kinetic_energy);
    assert_true(report.budget_error < 1e-13);
    CLOSE(dem_own_share(dem, 0), s.density / (s.density + 0.5 * rho), 1e-15);
    dem_destroy(dem);
  }
}

/* Contacts move m + m_a: equal spheres swap velocities, restitution stays, and the contact is
 * longer by sqrt((m + m_a)/m). */
static void collision(void **state) {
  (void)state;
  double step[2];
  for (int k = 0; k < 2; k++) {
    scene s = scene_default();
    s.contact.restitution = 0.7;
    const double x[2][3] = {{-0.0101, 0, 0}, {0.0101, 0, 0}};
    const double v[2][3] = {{0.1, 0, 0}, {-0.1, 0, 0}};
    dem_t *dem = with_added(&s, k ? 3.0 * s.density : 0.0);
    for (int i = 0; i < 2; i++)
      add_sphere(dem, DEM_FREE, -1, x[i], r, v[i]);
    OK(dem_start(dem));
    step[k] = dem_stable_step(dem);
    OK(dem_advance(dem, 0.02, NULL));
    const body b = find(dem, s.comm, 0);
    CLOSE(b.v[0], -0.07, 0.07 * 2e-2); /* steps of a tenth of the contact time or so */
    dem_destroy(dem);
  }
  CLOSE(step[1] / step[0], 2.0, 1e-9);
}

/* Fluid around a sphere does not turn with it: dw/dt = k (w_f - w)/I, I = 2/5 m r2 without m_a. */
static void spin(void **state) {
  (void)state;
  scene s = scene_default();
  s.contact.friction = 0.3; /* or nothing turns */
  const double dt = 1e-3, inertia = 0.4 * sphere_mass(s.density, r) * r * r;
  dem_t *dem = with_added(&s, 0.5 * s.density);
  add_sphere(dem, DEM_FREE, -1, origin, r, still);
  OK(dem_start(dem));
  const double turn[4] = {1.0, 2.0, 3.0, inertia / (2.0 * dt)};
  if (dem_store(dem)->local == 1)
    OK(dem_relax_spin(dem, turn, dt));
  const body b = find(dem, s.comm, 0);
  for (int c = 0; c < 3; c++)
    CLOSE(b.w[c], turn[c] * -expm1(-0.5), 1e-14);
  dem_destroy(dem);
}

static const double *before_of(dem_t *dem) {
  return part_field_double(dem_store(dem), DEM_FIELD_VELOCITY_ENDED);
}

/* velocityEnded: with a kick since the last advance that before the kick, else that before the
 * advance; a restart in between changes nothing. velocityBefore has the kick. */
static void velocity_before(void **state) {
  (void)state;
  char path[64];
  snprintf(path, sizeof path, "/tmp/added_mass_%d.vtkhdf", world_size());
  for (int restart = 0; restart < 2; restart++) {
    scene s = scene_default();
    s.params.gravity[0] = 10.0;
    const double impulse[3] = {0.0, 1e-3, 0.0}, dt = 1e-2;
    dem_t *dem = with_added(&s, 500.0);
    add_sphere(dem, DEM_FREE, -1, origin, r, still);
    OK(dem_start(dem));
    const double gain = 10.0 * dt * dem_own_share(dem, 0);
    const double kick = 1e-3 / sphere_mass(s.density + 500.0, r);
    OK(dem_advance(dem, dt, NULL));
    if (dem_store(dem)->local == 1)
      CLOSE(before_of(dem)[0], 0.0, 0.0);
    OK(dem_advance(dem, dt, NULL));
    if (dem_store(dem)->local == 1)
      CLOSE(before_of(dem)[0], gain, 1e-15);
    OK(dem_kick(dem, impulse));
    if (restart) {
      OK(dem_write(dem, path, NULL));
      dem_destroy(dem);
      dem = with_added(&s, 400.0);
      FAILS(PART_ERR_FORMAT, "virtualMass", dem_read(dem, path));
      dem_destroy(dem);
      dem = with_added(&s, 500.0);
      OK(dem_read(dem, path));
      OK(dem_start(dem));
    }
    OK(dem_advance(dem, dt, NULL));
    const body b = find(dem, s.comm, 0);
    CLOSE(b.v[0], 3.0 * gain, 1e-14);
    CLOSE(b.v[1], kick, 1e-14);
    if (dem_store(dem)->local == 1) {
      CLOSE(before_of(dem)[0], 2.0 * gain, 1e-15);
      CLOSE(before_of(dem)[1], 0.0, 0.0);
      CLOSE(part_field_double(dem_store(dem), DEM_FIELD_VELOCITY_BEFORE)[1], kick, 1e-14);
    }
    dem_destroy(dem);
  }
  if (world_rank() == 0)
    unlink(path);
}

static void refused(void **state) {
  (void)state;
  scene s = scene_default();
  dem_t *dem = scene_create(&s);
  FAILS(PART_ERR_RANGE, "added mass", dem_add_mass(dem, -1.0));
  FAILS(PART_ERR_RANGE, "added mass", dem_add_mass(dem, NAN));
  add_sphere(dem, DEM_BLOCK, 0, origin, r, still);
  FAILS(PART_ERR_STATE, "before insertion", dem_add_mass(dem, 1.0));
  dem_destroy(dem);
  dem = with_added(&s, 1.0);
  add_sphere(dem, DEM_BLOCK, 0, origin, r, still);
  FAILS(PART_ERR_RANGE, "rigid blocks", dem_start(dem));
  dem_destroy(dem);
}

int main(int argc, char **argv) {
  MPI_Init(&argc, &argv);
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(released), cmocka_unit_test(collision),       cmocka_unit_test(spin),
      cmocka_unit_test(refused),  cmocka_unit_test(velocity_before),
  };
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
