/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef COUPLING_SMOOTHING_TYPE_H
#define COUPLING_SMOOTHING_TYPE_H

#include "links.h"
#include "smoothing.h"

struct cpl_smoother {
  MPI_Comm comm;
  int size, passes;
  cpl_links links;
  CPL_ARRAY(double) share;    /* of the difference to a neighbour taken in one pass */
  CPL_ARRAY(double) variance; /* [cells] m2 */
  CPL_ARRAY(double) shape;    /* [cells][CPL_SHAPE]; empty until it is asked for */
  CPL_ARRAY(double) now;
  CPL_ARRAY(double) next;
};

#endif
