/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bonds of a few particles against closed forms: stiffness, turns, energy, damping, breaking. */
#include "common.h"

static const double r = 0.01;

static dem_bond bond_default(void) {
  dem_bond b;
  part_params_default(&dem_bond_table, &b);
  b.normal_stiffness = 2e9;
  b.shear_stiffness = 5e8;
  return b;
}

/* Section of a bond of radius R. */
static double area(double R) {
  return PI * R * R;
}
static double inertia(double R) {
  return 0.25 * PI * R * R * R * R;
}

static dem_t *two(const scene *s, const dem_bond *bond, int kind, double rb) {
  const double xa[3] = {0.0, 0.0, 0.0}, xb[3] = {r + rb, 0.0, 0.0}, v[3] = {0.0, 0.0, 0.0};
  dem_t *dem = scene_create(s);
  OK(dem_add_bonds(dem, -1, -1, bond));
  add_sphere(dem, kind, -1, xa, r, v);
  add_sphere(dem, DEM_FREE, -1, xb, rb, v);
  return dem;
}

/* Run particle 1 under a force to rest; everything else has drag only. */
static void settle(dem_t *dem, int64_t loaded, const double force[3], double drag, double time,
                   int advances) {
  for (int k = 0; k < advances; k++) {
    part_store *store = dem_store(dem);
    double *fluid = part_field_double(store, DEM_FIELD_FLUID_SU);
    const int64_t *id = part_field_int64(store, DEM_FIELD_ID);
    for (int i = 0; i < store->local; i++) {
      double *f = fluid + (size_t)i * (size_t)part_field_stride(store, DEM_FIELD_FLUID_SU);
      const int on = id[(size_t)i * (size_t)part_field_stride(store, DEM_FIELD_ID)] == loaded;
      for (int c = 0; c < 3; c++)
        f[c] = on ? force[c] : 0.0;
      f[3] = drag;
    }
    OK(dem_advance(dem, time / advances, NULL));
  }
}

/* Static response of one bond to a fixed sphere, unequal radii: normal F/k_n; across, with the
 * bond's springs at the contact point, which is at rb from the loaded centre:
 *   turn = F rb/k_b,   way = F/k_s + turn rb */
static void static_response(void **state) {
  (void)state;
  const double rb = 0.015, F = 0.02;
  dem_bond bond = bond_default();
  bond.damping = 0.7;
  const double k_n = bond.normal_stiffness * area(r), k_s = bond.shear_stiffness * area(r);
  const double k_b = bond.normal_stiffness * inertia(r);
  const double m = sphere_mass(2500.0, rb), omega = sqrt(k_s / m);
  for (int c = 0; c < 3; c++) {
    scene s = scene_default();
    double force[3] = {0.0, 0.0, 0.0};
    const dem_bond_state *now;
    size_t n;
    dem_t *dem = two(&s, &bond, DEM_FIXED, rb);
    force[c] = F;
    OK(dem_start(dem));
    settle(dem, 1, force, 2.0 * m * omega, 200.0 / omega, 1);
    const body b = find(dem, s.comm, 1);
    const double turn = F * rb / k_b, way = c == 0 ? F / k_n : F / k_s + turn * rb;
    /* Second order in the angles (1e-6) and the rest of the motion. */
    CLOSE(b.x[c] - (c == 0 ? r + rb : 0.0), way, 1e-4 * way);
    OK(dem_bond_states(dem, &now, &n));
    assert_int_equal(n, 1);
    assert_int_equal(now->a, 0);
    assert_int_equal(now->b, 1);
    CLOSE(now->force[c], -F, 1e-4 * F);
    CLOSE(now->tensile_stress, c == 0 ? F / area(r) : 0.0, 1e-4 * F / area(r));
    CLOSE(now->shear_stress, c == 0 ? 0.0 : F / area(r), 1e-4 * F / area(r));
    const double moment =
        sqrt(pow(now->moment[0], 2.0) + pow(now->moment[1], 2.0) + pow(now->moment[2], 2.0));
    CLOSE(moment, c == 0 ? 0.0 : F * rb, 1e-4 * F * rb);
    dem_destroy(dem);
  }
}

/* Spin about the bond: period of k_t and the spheres' inertia, twist stress with
 * momentContribution. */
static void twist(void **state) {
  (void)state;
  scene s = scene_default();
  dem_bond bond = bond_default();
  bond.moment_contribution = 0.5;
  bond.radius_fraction = 0.8;
  const double R = 0.8 * r, J = 2.0 * inertia(R), I = 0.4 * sphere_mass(2500.0, r) * r * r;
  const double omega = sqrt(bond.shear_stiffness * J / I), spin = 1e-3 * omega;
  dem_t *dem = two(&s, &bond, DEM_FIXED, r);
  const dem_bond_state *now;
  size_t n;
  OK(dem_start(dem));
  part_store *store = dem_store(dem);
  for (int i = 0; i < 2; i++)
    if (part_field_int64(store, DEM_FIELD_ID)[i * part_field_stride(store, DEM_FIELD_ID)] == 1)
      part_field_double(
          store, DEM_FIELD_ANGULAR_VELOCITY)[i * part_field_stride(store, DEM_FIELD_VELOCITY)] =
          spin;
  /* Verlet's period is shorter by (omega dt)^2/24. */
  const double dt = dem_stable_step(dem), slow = 1.0 - pow(omega * dt, 2.0) / 24.0;
  OK(dem_advance(dem, slow * 20.25 * 2.0 * PI / omega, NULL));
  CLOSE(find(dem, s.comm, 1).w[0], 0.0, 1e-3 * spin);
  OK(dem_bond_states(dem, &now, &n));
  const double M = bond.shear_stiffness * J * spin / omega;
  CLOSE(fabs(now->moment[0]), M, 1e-3 * M);
  CLOSE(now->shear_stress, 0.5 * M * R / J, 1e-3 * M * R / J);
  dem_destroy(dem);
}

/* Three spheres in an L, spun about an oblique axis through many turns. */
static dem_t *spinning(double w0, double spin[3], const dem_bond *bond) {
  scene s = scene_default();
  const double x[3][3] = {{0.0, 0.0, 0.0}, {2.0 * r, 0.0, 0.0}, {0.0, 2.0 * r, 0.0}};
  const double axis[3] = {1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0},
               centre[3] = {2.0 / 3.0 * r, 2.0 / 3.0 * r, 0.0};
  s.params.time_step_fraction = 0.1;
  dem_t *dem = scene_create(&s);
  OK(dem_add_bonds(dem, -1, -1, bond));
  for (int c = 0; c < 3; c++)
    spin[c] = w0 * axis[c];
  for (int k = 0; k < 3; k++) {
    const double d[3] = {x[k][0] - centre[0], x[k][1] - centre[1], x[k][2] - centre[2]};
    const double v[3] = {spin[1] * d[2] - spin[2] * d[1], spin[2] * d[0] - spin[0] * d[2],
                         spin[0] * d[1] - spin[1] * d[0]};
    add_sphere(dem, DEM_FREE, -1, x[k], r, v);
  }
  OK(dem_start(dem));
  part_store *store = dem_store(dem);
  for (int i = 0; i < store->local; i++)
    memcpy(part_field_double(store, DEM_FIELD_ANGULAR_VELOCITY) +
               i * part_field_stride(store, DEM_FIELD_ANGULAR_VELOCITY),
           spin, 3 * sizeof *spin);
  return dem;
}

/* Angular momentum and energy, and largest force and moment in a bond. */
typedef struct sums {
  double momentum[3], angular[3], energy, force, moment;
} sums;
static sums sum_of(dem_t *dem, int n) {
  sums total;
  dem_report report;
  body b[8];
  const dem_bond_state *now;
  size_t bonds;
  memset(&total, 0, sizeof total);
  OK(dem_get_report(dem, &report));
  find_all(dem, MPI_COMM_WORLD, n, b);
  const double m = sphere_mass(2500.0, r);
  for (int k = 0; k < n; k++)
    for (int c = 0; c < 3; c++) {
      const int d = (c + 1) % 3, e = (c + 2) % 3;
      total.momentum[c] += m * b[k].v[c];
      total.angular[c] +=
          m * (b[k].x[d] * b[k].v[e] - b[k].x[e] * b[k].v[d]) + 0.4 * m * r * r * b[k].w[c];
    }
  total.energy = report.kinetic_energy + report.bond_energy;
  OK(dem_bond_states(dem, &now, &bonds));
  for (size_t k = 0; k < bonds; k++)
    for (int c = 0; c < 3; c++) {
      total.force = fmax(total.force, fabs(now[k].force[c]));
      total.moment = fmax(total.moment, fabs(now[k].moment[c]));
    }
  return total;
}

/* A free L turns as one body: beside the forces that keep it on its way (m w^2 r), bonds feel
 * nothing, however often it turns. Those forces are of order w^2, so the turn is slow; what is left
 * is compared with k_n r, the force of a strain of one. */
static void turns_freely(void **state) {
  (void)state;
  double spin[3];
  const dem_bond bond = bond_default();
  const double k_n = bond.normal_stiffness * area(r), m = sphere_mass(2500.0, r);
  const double w0 = 2e-3 * sqrt(k_n / m);
  dem_t *dem = spinning(w0, spin, &bond);
  const sums before = sum_of(dem, 3);
  double most = 0.0, bending = 0.0;
  const double turn = 2.0 * PI / w0;
  for (int k = 0; k < 40; k++) { /* 50 turns */
    OK(dem_advance(dem, 1.25 * turn, NULL));
    const sums now = sum_of(dem, 3);
    most = fmax(most, now.force);
    bending = fmax(bending, now.moment);
    for (int c = 0; c < 3; c++) {
      CLOSE(now.momentum[c], 0.0, 1e-12 * m * w0 * r);
      CLOSE(now.angular[c], before.angular[c], 1e-10 * m * w0 * r * r);
    }
    CLOSE(now.energy, before.energy, 1e-5 * before.energy);
  }
  /* m w^2 r = 4e-6 k_n r: it is suddenly there, so up to twice; in 50 turns no more. */
  assert_true(most < 3.0 * m * w0 * w0 * 2.0 * r);
  assert_true(bending < 3.0 * m * w0 * w0 * 2.0 * r * r);
  dem_destroy(dem);
}

/* Wild motion without damping: momentum and angular momentum to rounding, energy without drift. */
static void conserves(void **state) {
  (void)state;
  double spin[3];
  const dem_bond bond = bond_default();
  const double k_n = bond.normal_stiffness * area(r), m = sphere_mass(2500.0, r);
  const double w0 = 0.02 * sqrt(k_n / m), turn = 2.0 * PI / w0;
  dem_t *dem = spinning(w0, spin, &bond);
  stir(dem, 0.02 * sqrt(k_n / m) * r); /* strains of about 1 % in every mode */
  const sums before = sum_of(dem, 3);
  double mean[2] = {0.0, 0.0}, most = 0.0;
  for (int k = 0; k < 400; k++) { /* 200 turns, about 1e4 vibrations */
    OK(dem_advance(dem, 0.5 * turn, NULL));
    const sums now = sum_of(dem, 3);
    for (int c = 0; c < 3; c++) {
      CLOSE(now.momentum[c], before.momentum[c], 1e-11 * m * w0 * r);
      CLOSE(now.angular[c], before.angular[c], 1e-9 * m * w0 * r * r);
    }
    if (k < 100 || k >= 300)
      mean[k >= 300] += now.energy / 100.0;
    most = fmax(most, fabs(now.energy / before.energy - 1.0));
  }
  /* Verlet: a bounded wiggle of order (omega dt)^2, and no drift of the mean. */
  assert_true(most < 2e-2);
  CLOSE(mean[1] / mean[0], 1.0, 1e-3);
  dem_destroy(dem);
}

/* Free pair, stretched: decay exp(-zeta omega t) of the amplitude. */
static void damped(void **state) {
  (void)state;
  scene s = scene_default();
  dem_bond bond = bond_default();
  bond.damping = 0.05;
  dem_t *dem = two(&s, &bond, DEM_FREE, r);
  const double k_n = bond.normal_stiffness * area(r), m = sphere_mass(2500.0, r);
  const double omega = sqrt(2.0 * k_n / m), v0 = 1e-3 * omega * r;
  double impulse[6] = {0.0};
  OK(dem_start(dem));
  for (int i = 0; i < 2; i++)
    impulse[3 * i] = part_field_int64(dem_store(dem), DEM_FIELD_ID)[4 * i] == 1 ? m * v0 : -m * v0;
  OK(dem_kick(dem, impulse));
  const double omega_d = omega * sqrt(1.0 - 0.05 * 0.05), t = 10.0 * 2.0 * PI / omega_d;
  OK(dem_advance(dem, t, NULL));
  /* The dashpot sees the velocity of half a step before: first order in omega dt = 0.03. */
  CLOSE(find(dem, s.comm, 1).v[0] / v0, exp(-0.05 * omega * t), 3e-3);
  dem_destroy(dem);
}

/* A horizontal row held at one end, loaded at the other. Each bond shears by F/k_s and bends by
 * F d/k_b, d its distance from the loaded centre: the way is the sum of F/k_s + F d^2/k_b. With
 * Young's modulus E and Poisson ratio nu that is the beam of section pi R^2 cut into pieces. */
static void beam_of_spheres(void **state) {
  (void)state;
  enum { BONDS = 8 };
  scene s = scene_default();
  dem_bond bond;
  part_params_default(&dem_bond_table, &bond);
  bond.youngs_modulus = 2e7;
  bond.poisson_ratio = 0.25;
  bond.damping = 1.0;
  const double L = 2.0 * r, E = bond.youngs_modulus, G = E / 2.5;
  const double k_s = G * area(r) / L, k_b = E * inertia(r) / L, F = 1e-4;
  const double at[3] = {0.0, 0.0, 0.0}, next[3] = {L, 0.0, 0.0}, force[3] = {0.0, 0.0, -F};
  s.params.time_step_fraction = 0.1;
  dem_t *dem = scene_create(&s);
  OK(dem_add_bonds(dem, -1, -1, &bond));
  add_sphere(dem, DEM_FIXED, -1, at, r, at);
  dem_insert row = lattice(DEM_FREE, 2.0 * r, next, L, BONDS, 1, 1);
  OK(dem_insert_particles(dem, &row, -1, NULL));
  OK(dem_start(dem));
  double way = 0.0;
  for (int k = 0; k < BONDS; k++) {
    const double d = (k + 0.5) * L;
    way += F / k_s + F * d * d / k_b;
  }
  /* First frequency of the cantilever, 3.516 sqrt(EI/(m/L l^4)); drag near critical. */
  const double m = sphere_mass(2500.0, r), l = BONDS * L;
  const double omega = 3.516 * sqrt(E * inertia(r) * L / (m * pow(l, 4.0)));
  settle(dem, BONDS, force, 2.0 * m * omega, 30.0 / omega, 1);
  const body end = find(dem, s.comm, BONDS);
  CLOSE(end.x[2], -way, 1e-3 * way); /* angles of 1e-3, rest of the motion exp(-30) */
  /* Euler and Bernoulli with shear: F l^3/(3 E I) + F l/(G A); pieces differ by 1/(4 BONDS^2). */
  const double theory = F * pow(l, 3.0) / (3.0 * E * inertia(r)) + F * l / (G * area(r));
  CLOSE(way, theory, 0.005 * theory);
  const dem_bond_state *now;
  size_t n;
  OK(dem_bond_states(dem, &now, &n));
  assert_int_equal(n, BONDS);
  for (size_t k = 0; k < n; k++) {
    const double M = F * (BONDS - 0.5 - (double)now[k].a) * L;
    CLOSE(fabs(now[k].moment[1]), M, 1e-3 * M);
  }
  dem_destroy(dem);
}

/* Pulled slowly: it holds below the strength and breaks above, in tension or in shear. */
static void breaks_at_strength(void **state) {
  (void)state;
  for (int c = 0; c < 2; c++)
    for (int over = 0; over < 2; over++) {
      scene s = scene_default();
      dem_bond bond = bond_default();
      bond.damping = 0.7;
      bond.tensile_strength = 100.0;
      bond.shear_strength = 60.0;
      double force[3] = {0.0, 0.0, 0.0};
      const double strength = c == 0 ? bond.tensile_strength : bond.shear_strength;
      const double limit = strength * area(r), m = sphere_mass(2500.0, r);
      const double omega = sqrt(bond.shear_stiffness * area(r) / m);
      dem_report report;
      const dem_broken_bond *broken;
      size_t n;
      dem_t *dem = two(&s, &bond, DEM_FIXED, r);
      OK(dem_start(dem));
      for (int k = 1; k <= 20; k++) { /* in steps of 5 %, so that nothing swings */
        force[c] = 0.05 * k * limit * (over ? 1.01 : 0.99);
        settle(dem, 1, force, 2.0 * m * omega, 40.0 / omega, 1);
      }
      OK(dem_get_report(dem, &report));
      assert_int_equal(report.bonds, over ? 0 : 1);
      assert_int_equal(report.broken_bonds, over);
      OK(dem_broken_bonds(dem, &broken, &n));
      assert_int_equal(n, over);
      if (over) {
        assert_int_equal(broken->a, 0);
        assert_int_equal(broken->b, 1);
        assert_int_equal(broken->mode, c == 0 ? DEM_BROKEN_BY_TENSION : DEM_BROKEN_BY_SHEAR);
        assert_true(broken->stress >= strength && broken->stress < 1.01 * strength);
        assert_true(broken->time > 19 * 40.0 / omega && broken->time < dem_time(dem));
      }
      dem_destroy(dem);
    }
}

/* Bending breaks too, as much as momentContribution says: sigma = beta M R/I. */
static void breaks_by_bending(void **state) {
  (void)state;
  for (int over = 0; over < 2; over++) {
    scene s = scene_default();
    dem_bond bond = bond_default();
    bond.damping = 0.7;
    bond.moment_contribution = 0.5;
    const double F = 0.01, m = sphere_mass(2500.0, r), force[3] = {0.0, 0.0, F};
    bond.tensile_strength = 0.5 * F * r * r / inertia(r) * (over ? 0.99 : 1.01);
    const double omega = sqrt(bond.shear_stiffness * area(r) / m);
    dem_report report;
    dem_t *dem = two(&s, &bond, DEM_FIXED, r);
    OK(dem_start(dem));
    settle(dem, 1, force, 20.0 * m * omega, 400.0 / omega, 1);
    OK(dem_get_report(dem, &report));
    assert_int_equal(report.broken_bonds, over);
    dem_destroy(dem);
  }
}

/* After breaking the pair is an ordinary one: thrown back, it bounces as two spheres do. */
static void contact_afterwards(void **state) {
  (void)state;
  scene s = scene_default();
  dem_bond bond = bond_default();
  bond.tensile_strength = 1000.0;
  s.contact.restitution = 0.5;
  dem_t *dem = two(&s, &bond, DEM_FREE, r);
  const double m = sphere_mass(2500.0, r);
  double impulse[6] = {0.0};
  dem_report report;
  OK(dem_start(dem));
  for (int turn = 0; turn < 2; turn++) {
    const int64_t *id = part_field_int64(dem_store(dem), DEM_FIELD_ID);
    const body b = find(dem, s.comm, 1), a = find(dem, s.comm, 0);
    for (int i = 0; i < 2; i++) {
      const double v = turn == 0 ? 0.5 : -0.2;
      impulse[3 * i] = id[4 * i] == 1 ? m * (v - b.v[0]) : m * (-v - a.v[0]);
    }
    OK(dem_kick(dem, impulse));
    OK(dem_advance(dem, 0.01, NULL));
    OK(dem_get_report(dem, &report));
    assert_int_equal(report.bonds, 0);
    assert_int_equal(report.broken_bonds, 1);
  }
  OK(dem_advance(dem, 0.1, NULL));
  CLOSE(find(dem, s.comm, 1).v[0], 0.5 * 0.2, 1e-3 * 0.2);
  CLOSE(find(dem, s.comm, 0).v[0], -0.5 * 0.2, 1e-3 * 0.2);
  dem_destroy(dem);
}

/* Broken in shear while pressed together: the normal force goes on without a jump, energy does not
 * grow, the pair slides with friction, and once apart it is an ordinary pair. */
static void pressed(void **state) {
  (void)state;
  scene s = scene_default();
  dem_bond bond = bond_default();
  bond.damping = 0.3;
  bond.shear_strength = 60.0;
  s.contact.friction = 0.3;
  dem_t *dem = two(&s, &bond, DEM_FIXED, r);
  const double m = sphere_mass(2500.0, r), omega = sqrt(bond.shear_stiffness * area(r) / m);
  const double press = 20.0 * 60.0 * area(r), side = 0.9 * 60.0 * area(r);
  const double hold[3] = {-press, 0.0, side}, slip[3] = {-press, 0.0, 1.2 * side};
  const double pull[3] = {press, 0.0, 0.0};
  dem_report report;
  OK(dem_start(dem));
  settle(dem, 1, hold, 2.0 * m * omega, 100.0 / omega, 1);
  OK(dem_get_report(dem, &report));
  assert_int_equal(report.bonds, 1);
  const body before = find(dem, s.comm, 1);
  settle(dem, 1, slip, 2.0 * m * omega, 100.0 / omega, 1);
  OK(dem_get_report(dem, &report));
  assert_int_equal(report.bonds, 0);
  assert_int_equal(report.broken_bonds, 1);
  assert_int_equal(report.contacts, 0); /* not an ordinary pair yet */
  const body after = find(dem, s.comm, 1);
  /* Shear is below friction, 0.3 x 20: it rests where the friction spring holds it; no turn back to
   * the bonded state is left over, since the new spring begins at zero: it rolls on. */
  const double d0 = hypot(before.x[0], before.x[2]), d1 = hypot(after.x[0], after.x[2]);
  CLOSE(d1, d0, 0.02 * (2.0 * r - d0));
  assert_true(after.x[2] > before.x[2]);
  const double k_n = bond.normal_stiffness * area(r);
  CLOSE(k_n * (2.0 * r - d1), press, 0.02 * press);
  settle(dem, 1, pull, 0.0, 20.0 / omega, 1);
  assert_true(hypot(find(dem, s.comm, 1).x[0], find(dem, s.comm, 1).x[2]) > 2.0 * r);
  OK(dem_get_report(dem, &report));
  CLOSE(report.bond_energy, 0.0, 0.0);
  dem_destroy(dem);
}

/* Bonded spheres are always in contact: a long advance is not taken as one step. */
static void no_long_steps(void **state) {
  (void)state;
  scene s = scene_default();
  const dem_bond bond = bond_default();
  dem_t *dem = two(&s, &bond, DEM_FREE, r);
  int substeps;
  OK(dem_start(dem));
  const double dt = 40.5 * dem_stable_step(dem);
  OK(dem_advance(dem, dt, &substeps));
  assert_int_equal(substeps, 41);
  /* pi/sqrt(rate): both ends have the one bond. */
  const double m = sphere_mass(2500.0, r), k_n = bond.normal_stiffness * area(r);
  const double k_s = bond.shear_stiffness * area(r), k_b = bond.normal_stiffness * inertia(r);
  const double I = 0.4 * m * r * r;
  const double rate = fmax(2.0 * k_n / m, k_s * (2.0 / m + 2.0 * r * r / I) + 2.0 * k_b / I);
  CLOSE(dem_stable_step(dem), 0.02 * PI / sqrt(rate), 1e-12 * dem_stable_step(dem));
  dem_destroy(dem);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(static_response),
      cmocka_unit_test(twist),
      cmocka_unit_test(turns_freely),
      cmocka_unit_test(conserves),
      cmocka_unit_test(damped),
      cmocka_unit_test(beam_of_spheres),
      cmocka_unit_test(breaks_at_strength),
      cmocka_unit_test(breaks_by_bending),
      cmocka_unit_test(contact_afterwards),
      cmocka_unit_test(pressed),
      cmocka_unit_test(no_long_steps),
  };
  MPI_Init(&argc, &argv);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
