/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rules of bonds, the bonds of the particles as inserted, and what follows from a rule for a pair.
 */
#include "internal.h"

static const double pi = 3.14159265358979323846;

/* ---- rules -------------------------------------------------------------------------------------
 */
static int check_bond(const dem_t *dem, const dem_bond *bond) {
  const char *table = dem_bond_table.name;
  PART_TRY(part_params_check(&dem_bond_table, bond));
  const int stiffness = bond->normal_stiffness > 0.0, modulus = bond->youngs_modulus > 0.0;
  if (stiffness == modulus)
    return part_fail(PART_ERR_RANGE, "%s: entry %s or youngsModulus must be positive, not both",
                     table, "normalStiffness");
  if (modulus && bond->shear_stiffness > 0.0)
    return part_fail(PART_ERR_RANGE,
                     "%s: entry shearStiffness belongs to normalStiffness; with youngsModulus it "
                     "follows from poissonRatio",
                     table);
  if (stiffness && bond->poisson_ratio != 0.0)
    return part_fail(PART_ERR_RANGE, "%s: entry poissonRatio belongs to youngsModulus", table);
  if (modulus && dem->shape.flat && !(bond->poisson_ratio < 1.0 / 3.0))
    return part_fail(PART_ERR_RANGE,
                     "%s: entry poissonRatio: %g is not allowed; must be below 1/3 with dimensions "
                     "2, where the shear stiffness of a hexagonal packing vanishes",
                     table, bond->poisson_ratio);
  return PART_OK;
}

int dem_add_bonds(dem_t *dem, int a, int b, const dem_bond *bond) {
  dem_bonds *bonds = &dem->bonds;
  const int every = a == -1 && b == -1;
  if (dem->started)
    return part_fail(PART_ERR_STATE, "dem_add_bonds comes before dem_start");
  PART_TRY(check_bond(dem, bond));
  if (!every && (a < 0 || b < 0 || a >= dem->materials || b >= dem->materials))
    return part_fail(PART_ERR_RANGE,
                     "bonds of materials %d and %d: numbers are 0 to %d, or -1 and -1 for all", a,
                     b, dem->materials - 1);
  for (int k = 0; k < bonds->rules; k++) {
    const dem_bond_rule *r = &bonds->rule[k];
    if ((r->a == a && r->b == b) || (r->a == b && r->b == a))
      return part_fail(PART_ERR_ARGUMENT, "bonds of materials %d and %d are given twice", a, b);
  }
  dem_bond_rule *more = realloc(bonds->rule, ((size_t)bonds->rules + 1) * sizeof *more);
  if (more == NULL)
    return part_fail(PART_ERR_MEMORY, "no memory for rule %d of bonds", bonds->rules);
  bonds->rule = more;
  bonds->rule[bonds->rules++] = (dem_bond_rule){a, b, *bond};
  return PART_OK;
}

int dem_bond_rule_of(const dem_bonds *bonds, int a, int b) {
  int general = -1;
  for (int k = 0; k < bonds->rules; k++) {
    const dem_bond_rule *r = &bonds->rule[k];
    if ((r->a == a && r->b == b) || (r->a == b && r->b == a))
      return k;
    if (r->a == -1)
      general = k;
  }
  return general;
}

/* ---- coefficients ------------------------------------------------------------------------------
 */
/* Stiffness per area (N/m3): as given, or from Young's modulus and Poisson ratio, B.7 and B.8. */
static void stiffness(const dem_t *dem, const dem_bond *bond, double radius, double length,
                      double *normal, double *shear) {
  const double E = bond->youngs_modulus, nu = bond->poisson_ratio;
  *normal = bond->normal_stiffness;
  *shear = bond->shear_stiffness;
  if (!(E > 0.0))
    return;
  if (dem->shape.flat) { /* over 2 R depth: k_n = E depth/(sqrt(3) (1 - nu)) */
    *normal = E / (sqrt(3.0) * (1.0 - nu) * 2.0 * radius);
    *shear = *normal * (1.0 - 3.0 * nu) / (1.0 + nu);
  } else {
    *normal = E / length;
    *shear = E / (2.0 * (1.0 + nu) * length);
  }
}

/* 1/mass and 1/inertia that a bond has to move. */
static void inverses(const dem_t *dem, int i, double *mass, double *inertia) {
  const double r = dem_xr(dem)[DEM_XR * (size_t)i + 3];
  *mass = dem_vm(dem)[DEM_VM * (size_t)i + 3];
  *inertia = dem_kind_of(dem, i) == DEM_FREE
                 ? dem->shape.spin * *mass / (dem_own_part(dem, dem_material_of(dem, i)) * r * r)
                 : 0.0;
}

/* 1/kg and 1/(kg m2) of the relative motions: along the bond, across it, relative turn. */
static void mobilities(const dem_t *dem, const dem_link *link, double w[3]) {
  double mass[2], inertia[2];
  w[1] = 0.0;
  for (int k = 0; k < 2; k++) {
    const double arm = link->share[k] * link->length;
    inverses(dem, link->end[k], &mass[k], &inertia[k]);
    w[1] += mass[k] + arm * arm * inertia[k];
  }
  w[0] = mass[0] + mass[1];
  w[2] = inertia[0] + inertia[1];
}

static double dashpot(double damping, double stiffness_of, double mobility) {
  return mobility > 0.0 ? 2.0 * damping * sqrt(stiffness_of / mobility) : 0.0;
}

void dem_link_coefs(const dem_t *dem, dem_link *link) {
  const dem_bond *bond = &dem->bonds.rule[link->rule].bond;
  const double *xr = dem_xr(dem);
  const double r0 = xr[DEM_XR * (size_t)link->end[0] + 3];
  const double r1 = xr[DEM_XR * (size_t)link->end[1] + 3];
  const double R = bond->radius_fraction * fmin(r0, r1), beta = bond->moment_contribution;
  double normal, shear, I, J, w[3];
  link->length = sqrt(dem_dot(link->rest, link->rest));
  link->share[0] = r0 / (r0 + r1);
  link->share[1] = r1 / (r0 + r1);
  stiffness(dem, bond, R, link->length, &normal, &shear);
  if (dem->shape.flat) { /* a rectangle of 2 R times depth */
    link->area = 2.0 * R * dem->shape.depth;
    I = 2.0 / 3.0 * R * R * R * dem->shape.depth;
    J = 0.0;
  } else {
    link->area = pi * R * R;
    I = 0.25 * pi * R * R * R * R;
    J = 2.0 * I;
  }
  link->k_n = normal * link->area;
  link->k_s = shear * link->area;
  link->k_b = normal * I;
  link->k_t = shear * J;
  link->bend = beta * R / I;
  link->twist = J > 0.0 ? beta * R / J : 0.0;
  mobilities(dem, link, w);
  link->c_n = dashpot(bond->damping, link->k_n, w[0]);
  link->c_s = dashpot(bond->damping, link->k_s, w[1]);
  link->c_b = dashpot(bond->damping, link->k_b, w[2]);
  link->c_t = dashpot(bond->damping, link->k_t, w[2]);
}

/* Largest square of a frequency (1/s2) of one bond between its two ends alone. */
static double link_rate(const dem_t *dem, const dem_link *link) {
  double w[3];
  mobilities(dem, link, w);
  return fmax(link->k_n * w[0], fmax(link->k_s * w[1] + link->k_b * w[2], link->k_t * w[2]));
}

/* The square of no frequency of the whole is above the largest sum, over the bonds of a particle,
 * of those of each bond alone (doc/equations.md, B.9). Bonds only break, so the start is the worst;
 * a restart goes on with the step it had. */
int dem_bonds_step(dem_t *dem) {
  dem_bonds *bonds = &dem->bonds;
  double most = 0.0;
  for (int i = 0; i < dem->store->local; i++) {
    double sum = 0.0;
    for (int k = bonds->start[i]; k < bonds->start[i + 1]; k++)
      sum += link_rate(dem, &bonds->link[bonds->item[k]]);
    most = fmax(most, sum);
  }
  MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_DOUBLE, MPI_MAX, dem->comm);
  if (!dem->restored)
    bonds->rate = most;
  if (bonds->rate > 0.0)
    dem->stable_step =
        fmin(dem->stable_step, dem->params.time_step_fraction * pi / sqrt(bonds->rate));
  return dem_bonds_settle(dem);
}

/* ---- bonds of the particles as inserted
 * ---------------------------------------------------------- */
typedef struct maker {
  dem_grid *grid;
  double widest; /* largest gapFraction */
  int64_t *near;
  size_t near_room, entries, room;
  int *count;
  dem_entry *entry;
  double widest_gap, *found; /* found: [rules] bonds whose lower id is of this rank */
} maker;

static int open_grid(const dem_t *dem, maker *m) {
  double r_min = HUGE_VAL, r_max = 0.0;
  m->widest = 0.0;
  for (int k = 0; k < dem->bonds.rules; k++)
    m->widest = fmax(m->widest, dem->bonds.rule[k].bond.gap_fraction);
  for (int64_t k = 0; k < dem->seeds; k++) {
    r_min = fmin(r_min, dem->seed[k].r);
    r_max = fmax(r_max, dem->seed[k].r);
  }
  PART_TRY(dem_grid_create(&dem->box, r_min, r_max, dem->seeds, &m->grid));
  for (int64_t k = 0; k < dem->seeds; k++)
    PART_TRY(dem_grid_add(m->grid, dem->seed[k].x, dem->seed[k].r));
  return PART_OK;
}

static long long id_of(const dem_t *dem, int64_t number) {
  return (long long)(dem->params.first_id + number);
}

/* Rule for two inserted particles, -1: no bond. rest: from the lower to the higher id. */
static int bond_of(const dem_t *dem, int64_t a, int64_t b, double rest[3]) {
  const dem_seed *p = &dem->seed[a < b ? a : b], *q = &dem->seed[a < b ? b : a];
  if (p->kind == q->kind &&
      (p->kind == DEM_FIXED ||
       ((p->kind == DEM_BLOCK || p->kind == DEM_CLUMP) && p->block == q->block)))
    return -1;
  const int rule = dem_bond_rule_of(&dem->bonds, p->material, q->material);
  if (rule < 0)
    return -1;
  part_box_difference(&dem->box, q->x, p->x, rest);
  const double gap = sqrt(dem_dot(rest, rest)) - p->r - q->r;
  return gap <= dem->bonds.rule[rule].bond.gap_fraction * fmin(p->r, q->r) ? rule : -1;
}

static int check_pair(const dem_t *dem, int rule, int64_t a, int64_t b) {
  if (dem->seed[a].kind == DEM_CLUMP || dem->seed[b].kind == DEM_CLUMP)
    return part_fail(
        PART_ERR_RANGE,
        "%s: particles %lld and %lld are near enough for a bond, but spheres of clumps "
        "can not be bonded; give the clumps a material without bonds",
        dem_bond_table.name, id_of(dem, a < b ? a : b), id_of(dem, a < b ? b : a));
  const double r = dem->seed[a].r, s = dem->seed[b].r;
  if (!dem->shape.flat || !(dem->bonds.rule[rule].bond.youngs_modulus > 0.0) ||
      fabs(r - s) <= 1e-6 * r)
    return PART_OK;
  return part_fail(PART_ERR_RANGE,
                   "%s: entry youngsModulus: particles %lld and %lld have radii %g and %g m; with "
                   "dimensions 2 it is that of a packing of equal discs. Give normalStiffness and "
                   "shearStiffness",
                   dem_bond_table.name, id_of(dem, a < b ? a : b), id_of(dem, a < b ? b : a), r, s);
}

static int add_entry(maker *m, int64_t number, double x, double y, double z) {
  PART_TRY(dem_grow(m->entries + 1, sizeof *m->entry, &m->room, &m->entry));
  m->entry[m->entries++] = (dem_entry){DEM_KEY(DEM_KEY_BOND, number), {x, y, z}};
  return PART_OK;
}

/* Entries of one particle (number as inserted), sorted by key as history.c leaves them; its
 * orientation is the identity, which need not be said. */
static int bond_particle(const dem_t *dem, maker *m, int64_t id, int *count) {
  size_t n;
  const dem_seed *seed = &dem->seed[id];
  PART_TRY(dem_grid_near(m->grid, seed->x, seed->r, m->widest, &m->near_room, &m->near, &n));
  for (size_t k = 0; k < n; k++) {
    double rest[3];
    const int64_t other = m->near[k];
    const int rule = other != id ? bond_of(dem, id, other, rest) : -1;
    if (rule < 0)
      continue;
    PART_TRY(check_pair(dem, rule, id, other));
    const int64_t partner = dem->params.first_id + other;
    PART_TRY(add_entry(m, partner * 256, rest[0], rest[1], rest[2]));
    PART_TRY(add_entry(m, partner * 256 + 1, rule, DEM_LINK_HOLDS, 0.0));
    *count += 2;
    m->widest_gap = fmax(m->widest_gap, sqrt(dem_dot(rest, rest)) - seed->r - dem->seed[other].r);
    m->found[rule] += other > id;
  }
  return PART_OK;
}

static int bond_own(const dem_t *dem, maker *m) {
  PART_TRY(open_grid(dem, m));
  PART_TRY(dem_allocate((size_t)dem->bonds.rules, sizeof *m->found, &m->found));
  PART_TRY(dem_allocate((size_t)dem->store->local, sizeof *m->count, &m->count));
  PART_TRY(dem_grow(1, sizeof *m->entry, &m->room, &m->entry));
  for (int i = 0; i < dem->store->local; i++)
    PART_TRY(bond_particle(dem, m, dem_id(dem, i) - dem->params.first_id, &m->count[i]));
  return PART_OK;
}

static int check_found(const dem_t *dem, const double *found) {
  for (int k = 0; k < dem->bonds.rules; k++) {
    const dem_bond_rule *r = &dem->bonds.rule[k];
    if (!(found[k] > 0.0))
      return part_fail(PART_ERR_RANGE,
                       "%s: no two particles of materials %s and %s have a gap of at most "
                       "gapFraction = %g of the smaller radius",
                       dem_bond_table.name, r->a < 0 ? "any" : dem->material[r->a].name,
                       r->b < 0 ? "any" : dem->material[r->b].name, r->bond.gap_fraction);
  }
  return PART_OK;
}

/* Entries of bonds before those of clumps that are kept already, as their keys are. */
static int keep(dem_t *dem, const maker *m) {
  const int n = dem->store->local, old = dem->kept_count != NULL;
  const dem_entry *bond = m->entry, *other = dem->kept;
  size_t total = m->entries;
  dem_entry *all;
  for (int i = 0; old && i < n; i++)
    total += (size_t)dem->kept_count[i];
  PART_TRY(dem_allocate(total, sizeof *all, &all));
  dem_entry *to = all;
  for (int i = 0; i < n; i++) {
    const size_t bonds = (size_t)m->count[i], others = old ? (size_t)dem->kept_count[i] : 0;
    memcpy(to, bond, bonds * sizeof *to);
    if (others > 0)
      memcpy(to + bonds, other, others * sizeof *to);
    to += bonds + others;
    bond += bonds;
    other += others;
    m->count[i] += (int)others;
  }
  if (!old)
    PART_TRY(dem_allocate((size_t)n, sizeof *dem->kept_count, &dem->kept_count));
  memcpy(dem->kept_count, m->count, (size_t)n * sizeof *m->count);
  free(dem->kept);
  dem->kept = all;
  return PART_OK;
}

int dem_bonds_make(dem_t *dem) {
  maker m = {.grid = NULL};
  int status = part_agree(dem->comm, bond_own(dem, &m));
  if (status == PART_OK) {
    MPI_Allreduce(MPI_IN_PLACE, m.found, dem->bonds.rules, MPI_DOUBLE, MPI_SUM, dem->comm);
    MPI_Allreduce(MPI_IN_PLACE, &m.widest_gap, 1, MPI_DOUBLE, MPI_MAX, dem->comm);
    status = part_agree(dem->comm, check_found(dem, m.found));
  }
  dem->bonds.widest = m.widest_gap;
  dem_grid_destroy(m.grid);
  free(m.near);
  free(m.found);
  if (status != PART_OK) {
    free(m.count);
    free(m.entry);
    return status;
  }
  status = part_agree(dem->comm, keep(dem, &m));
  free(m.count);
  free(m.entry);
  return status;
}
