/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Forces of bonds, breaking, and what all ranks must know of it. */
#include "internal.h"

void dem_bonds_free(dem_bonds *bonds) {
  free(bonds->rule);
  free(bonds->link);
  free(bonds->start);
  free(bonds->item);
  free(bonds->q);
  free(bonds->turns);
  free(bonds->event);
  free(bonds->list);
  free(bonds->state);
}

/* Angular velocity; see fast.h for what the records hold. */
static void spin_of(const dem_t *dem, int i, double w[3]) {
  const double *v = dem_vm(dem) + DEM_VM * (size_t)i;
  const double unit = dem->fast.spins ? 1.0 / dem_xr(dem)[DEM_XR * (size_t)i + 3] : 1.0;
  for (int c = 0; c < 3; c++)
    w[c] = unit * v[4 + c];
}

static void turn_all(dem_t *dem, double dt) {
  for (int k = 0; k < dem->bonds.turning; k++) {
    const int i = dem->bonds.turns[k];
    double h[3];
    spin_of(dem, i, h);
    for (int c = 0; c < 3; c++)
      h[c] *= 0.5 * dt;
    dem_turn_by(dem->bonds.q + 4 * (size_t)i, h);
  }
}

/* Vector between the ends, from the lower to the higher id. */
static void line_of(const dem_t *dem, const dem_link *link, double d[3]) {
  const double *x = dem_xr(dem) + DEM_XR * (size_t)link->end[0];
  const double *y = dem_xr(dem) + DEM_XR * (size_t)link->end[1];
  for (int c = 0; c < 3; c++)
    d[c] = y[c] - x[c];
}

static void elastic(const dem_t *dem, const dem_link *link, dem_bond_load *load) {
  double d[3], q[2][4];
  line_of(dem, link, d);
  for (int k = 0; k < 2; k++)
    memcpy(q[k], dem->bonds.q + 4 * (size_t)link->end[k], sizeof q[k]);
  dem_bond_elastic(link, d, (const double(*)[4])q, load);
}

/* Sum of the radii (m). */
static double reach_of(const dem_t *dem, const dem_link *link) {
  const double *xr = dem_xr(dem);
  return xr[DEM_XR * (size_t)link->end[0] + 3] + xr[DEM_XR * (size_t)link->end[1] + 3];
}

/* The distance from which the ends of a broken bond are an ordinary pair: neither its spring nor a
 * contact acts there, so force and energy do not jump. */
static double free_distance(const dem_t *dem, const dem_link *link) {
  return fmax(link->length, reach_of(dem, link));
}

/* A change of state that the other ranks have to learn. Without memory for it the run goes on with
 * what it has room for; dem_bonds_settle reports the error. */
static void change(dem_t *dem, dem_link *link, int state, int mode, double time, double stress) {
  dem_bonds *bonds = &dem->bonds;
  link->state = state;
  bonds->stale |= state == DEM_LINK_GONE;
  if (dem_grow((size_t)bonds->events + 1, sizeof *bonds->event, &bonds->event_room,
               &bonds->event) == PART_OK)
    bonds->event[bonds->events] = (dem_bond_event){
        {dem_id(dem, link->end[0]), dem_id(dem, link->end[1]), mode, time, stress}, state};
  bonds->events++;
}

/* Break when a stress is over the strength: tension before shear (Wu et al. 2018, sec. 3.2.2).
 * Returns whether it broke. */
static int breaks(dem_t *dem, dem_link *link, const dem_bond_load *load, double time) {
  const dem_bond *bond = &dem->bonds.rule[link->rule].bond;
  double tensile, shear;
  dem_bond_stress(link, load, &tensile, &shear);
  const int by_tension = tensile >= bond->tensile_strength;
  if (!by_tension && !(shear >= bond->shear_strength))
    return 0;
  const int apart = load->length >= free_distance(dem, link);
  change(dem, link, apart ? DEM_LINK_GONE : DEM_LINK_PRESSED,
         by_tension ? DEM_BROKEN_BY_TENSION : DEM_BROKEN_BY_SHEAR, time,
         by_tension ? tensile : shear);
  return 1;
}

static void press(dem_t *dem, dem_link *link, const double *const v[2], const double w[2][3],
                  double dt, double time, dem_bond_load *load) {
  const int a = dem_material_of(dem, link->end[0]), b = dem_material_of(dem, link->end[1]);
  double d[3];
  line_of(dem, link, d);
  dem_bond_pressed(link, d, v, w, dem->coefs[a * dem->materials + b].mu, dt, load);
  if (load->length >= free_distance(dem, link))
    change(dem, link, DEM_LINK_GONE, -1, time, 0.0);
}

static void add_load(dem_t *dem, const dem_link *link, const dem_bond_load *load) {
  for (int k = 0; k < 2; k++) {
    const size_t i = (size_t)link->end[k];
    if (link->end[k] >= dem->store->local)
      continue;
    double *ft = dem_ft(dem) + DEM_FT * i;
    const double unit = dem->fast.spins ? 1.0 / dem_xr(dem)[DEM_XR * i + 3] : 1.0;
    const double sign = k == 1 ? 1.0 : -1.0;
    for (int c = 0; c < 3; c++) {
      ft[c] += sign * load->force[c];
      ft[4 + c] += unit * load->torque[k][c];
    }
  }
}

void dem_bond_forces(dem_t *dem, double dt) {
  dem_bonds *bonds = &dem->bonds;
  const double time = dem->time + dt;
  turn_all(dem, dt);
  for (int m = 0; m < bonds->links; m++) {
    dem_link *link = &bonds->link[m];
    const double *v[2];
    double w[2][3];
    dem_bond_load load;
    if (link->state == DEM_LINK_GONE)
      continue;
    for (int k = 0; k < 2; k++) {
      v[k] = dem_vm(dem) + DEM_VM * (size_t)link->end[k];
      spin_of(dem, link->end[k], w[k]);
    }
    if (link->state == DEM_LINK_HOLDS) {
      elastic(dem, link, &load);
      if (!breaks(dem, link, &load, time)) {
        if (link->c_n > 0.0)
          dem_bond_damp(link, v, (const double(*)[3])w, &load);
        add_load(dem, link, &load);
        continue;
      }
    }
    if (link->state == DEM_LINK_PRESSED) {
      press(dem, link, v, (const double(*)[3])w, dt, time, &load);
      add_load(dem, link, &load);
    }
  }
}

/* ---- what all ranks must know ---------------------------------------------------------------- */
static int by_time(const void *a, const void *b) {
  const dem_bond_event *x = a, *y = b;
  if (x->broken.a != y->broken.a)
    return x->broken.a < y->broken.a ? -1 : 1;
  if (x->broken.b != y->broken.b)
    return x->broken.b < y->broken.b ? -1 : 1;
  return (x->broken.time > y->broken.time) - (x->broken.time < y->broken.time);
}

static int by_break(const void *a, const void *b) {
  const dem_broken_bond *x = a, *y = b;
  if (x->time != y->time)
    return x->time < y->time ? -1 : 1;
  if (x->a != y->a)
    return x->a < y->a ? -1 : 1;
  return (x->b > y->b) - (x->b < y->b);
}

/* Events of all ranks; with one rank, the own ones. */
static int gather_events(dem_t *dem, dem_bond_event **all, int *count) {
  const int width = (int)sizeof **all;
  int *sizes = NULL, *offsets = NULL, total = 0;
  int status = dem_allocate((size_t)dem->ranks, sizeof *sizes, &sizes);
  if (status == PART_OK)
    status = dem_allocate((size_t)dem->ranks, sizeof *offsets, &offsets);
  status = part_agree(dem->comm, status);
  if (status == PART_OK) {
    const int own = dem->bonds.events * width;
    MPI_Allgather(&own, 1, MPI_INT, sizes, 1, MPI_INT, dem->comm);
    for (int r = 0; r < dem->ranks; r++) {
      offsets[r] = total;
      total += sizes[r];
    }
    status = part_agree(dem->comm, dem_allocate((size_t)total, 1, all));
  }
  if (status == PART_OK)
    MPI_Allgatherv(dem->bonds.event, dem->bonds.events * width, MPI_BYTE, *all, sizes, offsets,
                   MPI_BYTE, dem->comm);
  *count = total / width;
  free(sizes);
  free(offsets);
  return status;
}

/* Own links follow the events: an end on another rank may have seen a stress that differs in the
 * last bit. event: sorted by ids. */
static void follow(dem_t *dem, const dem_bond_event *event, int count) {
  for (int m = 0; m < dem->bonds.links; m++) {
    dem_link *link = &dem->bonds.link[m];
    const int64_t a = dem_id(dem, link->end[0]), b = dem_id(dem, link->end[1]);
    int low = 0, high = count;
    while (low < high) {
      const int middle = low + (high - low) / 2;
      const dem_broken_bond *at = &event[middle].broken;
      if (at->a < a || (at->a == a && at->b < b))
        low = middle + 1;
      else
        high = middle;
    }
    for (; low < count && event[low].broken.a == a && event[low].broken.b == b; low++)
      if (event[low].state > link->state) {
        link->state = (int)event[low].state;
        dem->bonds.stale |= link->state == DEM_LINK_GONE;
      }
  }
}

/* Those that broke, each once. */
static int note_broken(dem_bonds *bonds, const dem_bond_event *event, int count) {
  const int64_t before = bonds->broken;
  for (int k = 0; k < count; k++) {
    const dem_broken_bond *one = &event[k].broken;
    const dem_broken_bond *last = bonds->broken > before ? &bonds->list[bonds->broken - 1] : NULL;
    if (one->mode < 0 || (last != NULL && last->a == one->a && last->b == one->b))
      continue;
    PART_TRY(
        dem_grow((size_t)bonds->broken + 1, sizeof *bonds->list, &bonds->list_room, &bonds->list));
    bonds->list[bonds->broken++] = *one;
  }
  qsort(bonds->list + before, (size_t)(bonds->broken - before), sizeof *bonds->list, by_break);
  return PART_OK;
}

static int share_events(dem_t *dem) {
  dem_bonds *bonds = &dem->bonds;
  dem_bond_event *all = NULL;
  int count = 0;
  int status = (size_t)bonds->events > bonds->event_room
                   ? part_fail(PART_ERR_MEMORY, "no memory for %d broken bonds", bonds->events)
                   : PART_OK;
  PART_TRY(part_agree(dem->comm, status));
  status = gather_events(dem, &all, &count);
  if (status == PART_OK) {
    qsort(all, (size_t)count, sizeof *all, by_time);
    follow(dem, all, count);
    status = note_broken(bonds, all, count);
  }
  bonds->events = 0;
  free(all);
  return part_agree(dem->comm, status);
}

int dem_bonds_settle(dem_t *dem) {
  dem_bonds *bonds = &dem->bonds;
  double most[2] = {(double)bonds->events, 0.0};
  int64_t counts[2] = {0, 0};
  for (int m = 0; m < bonds->links; m++) {
    double d[3];
    line_of(dem, &bonds->link[m], d);
    if (bonds->link[m].state != DEM_LINK_GONE)
      most[1] = fmax(most[1], sqrt(dem_dot(d, d)) - reach_of(dem, &bonds->link[m]));
  }
  if (dem->ranks > 1)
    MPI_Allreduce(MPI_IN_PLACE, most, 2, MPI_DOUBLE, MPI_MAX, dem->comm);
  bonds->widest = most[1];
  if (most[0] > 0.0)
    PART_TRY(share_events(dem));
  for (int m = 0; m < bonds->links; m++) {
    const int counted = bonds->link[m].end[0] < dem->store->local;
    counts[0] += counted && bonds->link[m].state != DEM_LINK_GONE;
    counts[1] += counted && bonds->link[m].state == DEM_LINK_HOLDS;
  }
  if (dem->ranks > 1)
    MPI_Allreduce(MPI_IN_PLACE, counts, 2, MPI_INT64_T, MPI_SUM, dem->comm);
  bonds->alive = counts[0];
  bonds->intact = counts[1];
  return PART_OK;
}

double dem_bonds_energy(const dem_t *dem) {
  double energy = 0.0;
  for (int m = 0; m < dem->bonds.links; m++) {
    const dem_link *link = &dem->bonds.link[m];
    dem_bond_load load;
    double d[3];
    if (link->end[0] >= dem->store->local || link->state == DEM_LINK_GONE)
      continue;
    elastic(dem, link, &load);
    if (link->state == DEM_LINK_PRESSED) {
      line_of(dem, link, d);
      const double in = fmax(link->length - sqrt(dem_dot(d, d)), 0.0);
      load.energy = 0.5 * (link->k_n * in * in + link->k_s * dem_dot(link->spring, link->spring));
    }
    energy += load.energy;
  }
  return energy;
}

/* ---- for output ------------------------------------------------------------------------------ */
int dem_bond_states(dem_t *dem, const dem_bond_state **states, size_t *count) {
  dem_bonds *bonds = &dem->bonds;
  *count = 0;
  *states = NULL;
  if (!dem->started)
    return part_fail(PART_ERR_STATE, "dem_bond_states comes after dem_start");
  PART_TRY(dem_grow((size_t)bonds->links, sizeof *bonds->state, &bonds->state_room, &bonds->state));
  for (int m = 0; m < bonds->links; m++) {
    const dem_link *link = &bonds->link[m];
    dem_bond_load load;
    if (link->end[0] >= dem->store->local || link->state != DEM_LINK_HOLDS)
      continue;
    elastic(dem, link, &load);
    dem_bond_state *to = &bonds->state[(*count)++];
    *to = (dem_bond_state){
        .a = dem_id(dem, link->end[0]), .b = dem_id(dem, link->end[1]), .rule = link->rule};
    line_of(dem, link, to->arm);
    memcpy(to->force, load.force, sizeof to->force);
    memcpy(to->moment, load.moment, sizeof to->moment);
    dem_bond_stress(link, &load, &to->tensile_stress, &to->shear_stress);
  }
  *states = bonds->state;
  return PART_OK;
}

int dem_broken_bonds(const dem_t *dem, const dem_broken_bond **list, size_t *count) {
  *count = (size_t)dem->bonds.broken;
  *list = dem->bonds.list;
  if (!dem->started)
    return part_fail(PART_ERR_STATE, "dem_broken_bonds comes after dem_start");
  return PART_OK;
}
