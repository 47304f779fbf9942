/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A layout, random numbers and checks that the tests of libparticle share. */
#ifndef TEST_PARTICLE_COMMON_H
#define TEST_PARTICLE_COMMON_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "particle/domain.h"
#include "particle/status.h"
#include "particle/store.h"

/* Records: {x y z r} moves, ghost; {v, spare} moves, ghost; {force} stays; {id}; {code, code2}. */
enum { REC_XR, REC_V, REC_F, REC_ID, REC_CODE };
enum { F_X, F_R, F_V, F_FORCE, F_ID, F_CODE };
extern const part_layout test_layout;

/* Fails the test with the library's message. */
#define OK(call) check_ok((call), #call, __FILE__, __LINE__)
void check_ok(int status, const char *call, const char *file, int line);

/* The call fails with this status, and the message contains the words. */
#define FAILS(wanted, words, call) check_fails((wanted), (words), (call), #call, __FILE__, __LINE__)
void check_fails(int wanted, const char *words, int status, const char *call, const char *file,
                 int line);

/* Repeatable: uniform in [0, 1). */
double uniform(uint64_t *state);
int below(uint64_t *state, int n);

double *position(const part_store *store, int i);
double *radius(const part_store *store, int i);
double *velocity(const part_store *store, int i);
int64_t *id_of(const part_store *store, int i);
int64_t *code_of(const part_store *store, int i);

/* Sets every field from the id and the position. */
void fill_particle(part_store *store, int i, int64_t id, const double x[3], double r);
/* 1 when velocity and code are those that fill_particle gave this id. */
int intact(const part_store *store, int i);

/* n particles at random in the box, ids first_id .. , radii in [r0, r1]. */
void fill_random(part_store *store, int n, int64_t first_id, const part_box *box, double r0,
                 double r1, uint64_t *state);

/* MPI_Init, run, MPI_Finalize. */
#define RUN_WITH_MPI(tests)                                                                        \
  int main(int argc, char **argv) {                                                                \
    MPI_Init(&argc, &argv);                                                                        \
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);                                  \
    MPI_Finalize();                                                                                \
    return failed;                                                                                 \
  }

int world_rank(void);
int world_size(void);
long long sum_over_ranks(long long value);

/* Domain, balanced and migrated, with so many particles of each rank, radii in [r0, r1]. */
void each_domain(const part_box *box, int each, double r0, double r1, part_domain **domain,
                 part_store **store);
/* The same with n particles in all, made on rank 0 (scattered = 0) or on all. */
void shared_domain(const part_box *box, int n, int scattered, part_domain **domain,
                   part_store **store);
void drop_domain(part_domain *domain, part_store *store);
/* Own particles of all ranks, on every rank: x, y, z, r, id as five doubles. Free it. */
double *all_particles(const part_store *store, int *n);

#endif
