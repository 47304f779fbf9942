/* SPDX-License-Identifier: GPL-3.0-or-later */
/* All smoothing kernels. */
#ifndef SPH_KERNELS_H
#define SPH_KERNELS_H

#include "kernels/cubic_spline.h"
#include "kernels/quintic_spline.h"
#include "kernels/wendland_c2.h"
#include "kernels/wendland_c4.h"

#endif
