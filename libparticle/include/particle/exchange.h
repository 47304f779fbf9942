/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Exchange: every item names the rank it goes to. A plan is made once and used for any number of
 * messages forth and back. Law (tested): reverse(forward(x)) = x for any plan. Only ranks that have
 * items for each other exchange messages; forward and reverse synchronise no others (Zoltan's
 * communication package makes an MPI_Allreduce in each, and counts bytes in int). Items for the own
 * rank are copied without a message, and a plan on one rank makes no MPI call after its creation. */
#ifndef PARTICLE_EXCHANGE_H
#define PARTICLE_EXCHANGE_H

#include <mpi.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct part_exchange part_exchange;

/* Collective. Item k of n_send goes to rank destination[k]. Received items are ordered by source
 * rank, then by the sender's order, so that results do not depend on message timing.
 * ERR_RANGE: a destination is not a rank of comm. comm is used, not duplicated: it must outlive
 * the plan and carry no other traffic meanwhile. */
int part_exchange_create(MPI_Comm comm, int n_send, const int *destination, part_exchange **plan);
void part_exchange_destroy(part_exchange *plan);

int part_exchange_send_count(const part_exchange *plan);
int part_exchange_receive_count(const part_exchange *plan);
/* Source rank of each received item; [receive_count], owned by the plan. */
const int *part_exchange_source(const part_exchange *plan);

/* All ranks call. Items of item_size bytes: send[send_count] -> received[receive_count]. */
int part_exchange_forward(part_exchange *plan, size_t item_size, const void *send, void *received);
/* All ranks call. The way back: send[receive_count] -> received[send_count], in the sender's order. */
int part_exchange_reverse(part_exchange *plan, size_t item_size, const void *send, void *received);

/* Collective. Items of different sizes: item k has count[k] elements of element_size bytes, packed
 * one after the other. *received_count[receive_count] and *received are allocated here and freed
 * by the caller with free(). ERR_RANGE: more than 2^31 - 1 elements on one rank. */
int part_exchange_forward_variable(part_exchange *plan, size_t element_size, const int *count,
                                   const void *send, int **received_count, void **received);

/* Bytes this rank has sent to other ranks through this plan so far. */
long long part_exchange_bytes(const part_exchange *plan);

#ifdef __cplusplus
}
#endif
#endif
