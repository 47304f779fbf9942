/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "rendezvous.h"
#include <math.h>
#include <string.h>
#include "memory.h"
#include "particle/exchange.h"
#include "rendezvous_bins.h"

/* Components per visit that the buffers hold without asking all ranks for memory again. */
enum { USUAL_WIDTH = 10 };

struct cpl_rendezvous {
  MPI_Comm comm;
  int size, rank;
  part_box box;
  double reach; /* how far a sphere is felt, over its radius */
  cpl_bins bins;
  int *stamp; /* [size] number of the last image that visits the rank */
  int stamp_now;
  int own;                  /* visits to this rank */
  int away;                 /* visits to other ranks */
  int received;             /* visits from other ranks */
  CPL_ARRAY(int) particle;  /* [own + away] */
  CPL_ARRAY(double) sphere; /* [own + received][4] */
  CPL_ARRAY(int) away_particle;
  CPL_ARRAY(int) destination;
  CPL_ARRAY(double) away_sphere;
  part_exchange *plan; /* of the visits to other ranks; NULL with one rank */
  CPL_ARRAY(double) away_buffer;
  CPL_ARRAY(double) received_buffer;
};

int cpl_rendezvous_create(MPI_Comm comm, int cells, const cpl_search *search, const part_box *box,
                          double reach, cpl_rendezvous **rendezvous) {
  cpl_rendezvous *r = calloc(1, sizeof *r);
  int status = r ? PART_OK : part_fail(PART_ERR_MEMORY, "coupling: no memory for the rendezvous");
  PART_TRY(part_agree(comm, status));
  r->comm = comm;
  r->box = *box;
  r->reach = reach;
  MPI_Comm_size(comm, &r->size);
  MPI_Comm_rank(comm, &r->rank);
  r->stamp = calloc((size_t)r->size, sizeof *r->stamp);
  if (!r->stamp)
    status = part_fail(PART_ERR_MEMORY, "coupling: no memory for %d ranks", r->size);
  for (int k = 0; k < 3; k++)
    if (box->periodic[k] && !(box->hi[k] > box->lo[k]))
      status = part_fail(PART_ERR_RANGE,
                         "coupling: periodic direction %d of the box has no length "
                         "(from %g to %g m)",
                         k, box->lo[k], box->hi[k]);
  status = part_agree(comm, status);
  if (status == PART_OK)
    status = cpl_bins_create(comm, cells, search, &r->bins);
  if (status != PART_OK) {
    cpl_rendezvous_destroy(r);
    return status;
  }
  *rendezvous = r;
  return PART_OK;
}

static void destroy_plan(cpl_rendezvous *r) {
  if (r->plan) {
    part_exchange_destroy(r->plan);
    r->plan = NULL;
  }
}

void cpl_rendezvous_destroy(cpl_rendezvous *r) {
  if (!r)
    return;
  destroy_plan(r);
  cpl_bins_free(&r->bins);
  free(r->stamp);
  CPL_FREE(r->particle);
  CPL_FREE(r->sphere);
  CPL_FREE(r->away_particle);
  CPL_FREE(r->destination);
  CPL_FREE(r->away_sphere);
  CPL_FREE(r->away_buffer);
  CPL_FREE(r->received_buffer);
  free(r);
}

/* ---- visits --------------------------------------------------------------------------------- */
static int add_visit(cpl_rendezvous *r, int particle, int destination, const double sphere[4]) {
  if (destination == r->rank) {
    const size_t k = (size_t)r->own;
    PART_TRY(CPL_RESERVE(r->particle, k + 1));
    PART_TRY(CPL_RESERVE(r->sphere, 4 * (k + 1)));
    r->particle.data[k] = particle;
    memcpy(r->sphere.data + 4 * k, sphere, 4 * sizeof *sphere);
    r->own++;
  } else {
    const size_t k = (size_t)r->away;
    PART_TRY(CPL_RESERVE(r->away_particle, k + 1));
    PART_TRY(CPL_RESERVE(r->destination, k + 1));
    PART_TRY(CPL_RESERVE(r->away_sphere, 4 * (k + 1)));
    r->away_particle.data[k] = particle;
    r->destination.data[k] = destination;
    memcpy(r->away_sphere.data + 4 * k, sphere, 4 * sizeof *sphere);
    r->away++;
  }
  return PART_OK;
}

/* The only rank in bins from .. to, at most two each way; -1: perhaps several or none. */
static int only_rank(const cpl_bins *bins, const int from[3], const int to[3]) {
  for (int k = 0; k < 3; k++)
    if (to[k] < from[k] || to[k] > from[k] + 1)
      return -1;
  return bins->alone[(from[2] * bins->n[1] + from[1]) * bins->n[0] + from[0]];
}

/* One image of a sphere: a visit to every rank that has cells in a bin that the sphere's bounding
 * box touches. */
static int visit_ranks(cpl_rendezvous *r, int particle, const double sphere[4]) {
  const cpl_bins *bins = &r->bins;
  int from[3], to[3];
  for (int k = 0; k < 3; k++) {
    const double felt = r->reach * sphere[3], lo = sphere[k] - felt, hi = sphere[k] + felt;
    /* a sphere outside the mesh is lost, however far its kernel reaches */
    if (sphere[k] + sphere[3] < bins->lo[k] - (felt - sphere[3]) * r->box.periodic[k] ||
        sphere[k] - sphere[3] > bins->hi[k] + (felt - sphere[3]) * r->box.periodic[k])
      return PART_OK;
    /* the part of a bin covers the round-off of the bins' own borders */
    const double a = (lo - bins->lo[k]) / bins->edge[k] - 1e-9;
    const double b = (hi - bins->lo[k]) / bins->edge[k] + 1e-9;
    from[k] = a <= 0.0 ? 0 : (int)a;
    to[k] = b >= bins->n[k] ? bins->n[k] - 1 : (int)b;
  }
  if (r->size == 1)
    return add_visit(r, particle, r->rank, sphere);
  const int alone = only_rank(bins, from, to);
  if (alone >= 0)
    return add_visit(r, particle, alone, sphere);
  r->stamp_now++;
  for (int z = from[2]; z <= to[2]; z++)
    for (int y = from[1]; y <= to[1]; y++)
      for (int x = from[0]; x <= to[0]; x++) {
        const int b = (z * bins->n[1] + y) * bins->n[0] + x;
        for (int k = bins->start[b]; k < bins->start[b + 1]; k++) {
          const int rank = bins->rank[k];
          if (r->stamp[rank] == r->stamp_now)
            continue;
          r->stamp[rank] = r->stamp_now;
          PART_TRY(add_visit(r, particle, rank, sphere));
        }
      }
  return PART_OK;
}

/* Wrap x into the box; shift[0..n-1]: 0 and, when the sphere crosses a border, the image there. */
static int images(const part_box *box, int k, double *x, double radius, double shift[2]) {
  shift[0] = 0.0;
  if (!box->periodic[k])
    return 1;
  const double length = box->hi[k] - box->lo[k];
  if (*x < box->lo[k] || *x >= box->hi[k])
    *x -= length * floor((*x - box->lo[k]) / length);
  if (*x - radius < box->lo[k])
    shift[1] = length;
  else if (*x + radius > box->hi[k])
    shift[1] = -length;
  else
    return 1;
  return 2;
}

static int check_sphere(const cpl_rendezvous *r, const double *x, double radius, int64_t id) {
  if (!isfinite(x[0]) || !isfinite(x[1]) || !isfinite(x[2]) || !isfinite(radius))
    return part_fail(PART_ERR_NUMERIC,
                     "coupling: particle %lld is at (%g %g %g) m with radius %g m", (long long)id,
                     x[0], x[1], x[2], radius);
  if (radius <= 0.0)
    return part_fail(PART_ERR_RANGE,
                     "coupling: the radius of particle %lld is %g m; it must be > 0", (long long)id,
                     radius);
  for (int k = 0; k < 3; k++) {
    const double length = r->box.hi[k] - r->box.lo[k];
    if (r->box.periodic[k] && 2.0 * r->reach * radius > length)
      return part_fail(PART_ERR_RANGE,
                       "coupling: the diameter %g m of particle %lld%s is larger than the periodic "
                       "length %g m of direction %d",
                       2.0 * r->reach * radius, (long long)id,
                       r->reach > 1.0 ? " with its kernel (2 bandwidth/0.45)" : "", length, k);
  }
  return PART_OK;
}

static int visit_images(cpl_rendezvous *r, int particle, const double *position, double radius) {
  double x[3] = {position[0], position[1], position[2]}, shift[3][2];
  int n[3];
  for (int k = 0; k < 3; k++)
    n[k] = images(&r->box, k, &x[k], r->reach * radius, shift[k]);
  for (int c = 0; c < n[2]; c++)
    for (int b = 0; b < n[1]; b++)
      for (int a = 0; a < n[0]; a++) {
        const double sphere[4] = {x[0] + shift[0][a], x[1] + shift[1][b], x[2] + shift[2][c],
                                  radius};
        PART_TRY(visit_ranks(r, particle, sphere));
      }
  return PART_OK;
}

int cpl_rendezvous_visits(cpl_rendezvous *r, const cpl_particles *p) {
  r->own = r->away = r->received = 0;
  r->stamp_now = 0;
  memset(r->stamp, 0, (size_t)r->size * sizeof *r->stamp);
  for (int i = 0; i < p->count; i++) {
    const double *x = p->position + (size_t)i * (size_t)p->position_stride;
    const double radius = p->radius[(size_t)i * (size_t)p->radius_stride];
    PART_TRY(check_sphere(r, x, radius, p->id[(size_t)i * (size_t)p->id_stride]));
    PART_TRY(visit_images(r, i, x, radius));
  }
  PART_TRY(CPL_RESERVE(r->particle, r->own + r->away));
  if (r->away > 0)
    memcpy(r->particle.data + r->own, r->away_particle.data,
           (size_t)r->away * sizeof *r->particle.data);
  return PART_OK;
}

/* ---- exchange ------------------------------------------------------------------------------- */
static int make_plan(cpl_rendezvous *r) {
  destroy_plan(r);
  PART_TRY(part_exchange_create(r->comm, r->away, r->destination.data, &r->plan));
  r->received = part_exchange_receive_count(r->plan);
  return PART_OK;
}

/* Room for n doubles per visit on both sides. */
static int buffers(cpl_rendezvous *r, int n) {
  PART_TRY(CPL_RESERVE(r->away_buffer, (size_t)r->away * (size_t)n));
  return CPL_RESERVE(r->received_buffer, (size_t)r->received * (size_t)n);
}

int cpl_rendezvous_send(cpl_rendezvous *r) {
  if (r->size == 1)
    return PART_OK;
  PART_TRY(make_plan(r));
  int status = CPL_RESERVE(r->sphere, 4 * ((size_t)r->own + (size_t)r->received));
  if (status == PART_OK)
    status = buffers(r, USUAL_WIDTH);
  PART_TRY(part_agree(r->comm, status));
  return part_exchange_forward(r->plan, 4 * sizeof(double), r->away_sphere.data,
                               r->sphere.data + 4 * (size_t)r->own);
}

int cpl_rendezvous_sent(const cpl_rendezvous *r) {
  return r->own + r->away;
}
int cpl_rendezvous_own(const cpl_rendezvous *r) {
  return r->own;
}
const int *cpl_rendezvous_particle(const cpl_rendezvous *r) {
  return r->particle.data;
}
int cpl_rendezvous_received(const cpl_rendezvous *r) {
  return r->own + r->received;
}
const double *cpl_rendezvous_spheres(const cpl_rendezvous *r) {
  return r->sphere.data;
}

static int ready(cpl_rendezvous *r, int n, double *value, cpl_visit_range range[2]) {
  if (r->size > 1 && n > USUAL_WIDTH)
    PART_TRY(part_agree(r->comm, buffers(r, n)));
  range[0] = (cpl_visit_range){0, r->own, value, r->particle.data};
  range[1] = (cpl_visit_range){r->own, r->received, r->received_buffer.data, NULL};
  return PART_OK;
}

int cpl_rendezvous_forward(cpl_rendezvous *r, int n, const double *value,
                           cpl_visit_range range[2]) {
  const size_t width = (size_t)n;
  PART_TRY(ready(r, n, (double *)(uintptr_t)value, range)); /* const is kept by the caller */
  if (r->size == 1)
    return PART_OK;
  const int *particle = r->particle.data + r->own;
  for (size_t k = 0; k < (size_t)r->away; k++)
    memcpy(r->away_buffer.data + k * width, value + (size_t)particle[k] * width,
           width * sizeof *value);
  return part_exchange_forward(r->plan, width * sizeof *value, r->away_buffer.data,
                               r->received_buffer.data);
}

int cpl_rendezvous_begin(cpl_rendezvous *r, int n, int particles, double *value,
                         cpl_visit_range range[2]) {
  const size_t width = (size_t)n;
  PART_TRY(ready(r, n, value, range));
  if (particles > 0)
    memset(value, 0, (size_t)particles * width * sizeof *value);
  if (r->received > 0)
    memset(r->received_buffer.data, 0, (size_t)r->received * width * sizeof *value);
  return PART_OK;
}

int cpl_rendezvous_end(cpl_rendezvous *r, int n, double *value) {
  if (r->size == 1)
    return PART_OK;
  const size_t width = (size_t)n;
  PART_TRY(part_exchange_reverse(r->plan, width * sizeof *value, r->received_buffer.data,
                                 r->away_buffer.data));
  const int *particle = r->particle.data + r->own;
  for (size_t k = 0; k < (size_t)r->away; k++) {
    double *sum = value + (size_t)particle[k] * width;
    const double *part = r->away_buffer.data + k * width;
    for (size_t d = 0; d < width; d++)
      sum[d] += part[d];
  }
  return PART_OK;
}

int cpl_rendezvous_reverse_visits(cpl_rendezvous *r, int n, const double *received, double *sent) {
  const size_t own = (size_t)r->own * (size_t)n;
  if (own > 0)
    memcpy(sent, received, own * sizeof *sent);
  return r->size == 1
             ? PART_OK
             : part_exchange_reverse(r->plan, (size_t)n * sizeof *sent, received + own, sent + own);
}

int cpl_rendezvous_forward_visits(cpl_rendezvous *r, int n, const double *sent, double *received) {
  const size_t own = (size_t)r->own * (size_t)n;
  if (own > 0)
    memcpy(received, sent, own * sizeof *sent);
  return r->size == 1
             ? PART_OK
             : part_exchange_forward(r->plan, (size_t)n * sizeof *sent, sent + own, received + own);
}

int cpl_rendezvous_drop(cpl_rendezvous *r, const double *keep, const double *keep_received,
                        int *dropped) {
  *dropped = 0;
  if (r->size == 1)
    return PART_OK;
  long long mine[2] = {0, r->away}, all[2];
  keep += r->own;
  for (int k = 0; k < r->away; k++)
    mine[0] += keep[k] == 0.0;
  MPI_Allreduce(mine, all, 2, MPI_LONG_LONG, MPI_SUM, r->comm);
  if (all[0] == 0 || 4 * all[0] < all[1]) /* a new plan has the latency of two messages */
    return PART_OK;
  int n = 0;
  for (int k = 0; k < r->away; k++)
    if (keep[k] != 0.0) {
      r->particle.data[r->own + n] = r->particle.data[r->own + k];
      r->destination.data[n++] = r->destination.data[k];
    }
  r->away = n;
  n = 0;
  keep_received += r->own;
  double *sphere = r->sphere.data + 4 * (size_t)r->own;
  for (int k = 0; k < r->received; k++)
    if (keep_received[k] != 0.0)
      memmove(sphere + 4 * (size_t)n++, sphere + 4 * (size_t)k, 4 * sizeof *sphere);
  PART_TRY(make_plan(r));
  *dropped = 1;
  return part_agree(
      r->comm, r->received == n
                   ? PART_OK
                   : part_fail(PART_ERR_STATE, "coupling: %d visits left of %d", r->received, n));
}
