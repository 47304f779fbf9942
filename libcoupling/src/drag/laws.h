/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every drag law: beta(|u - v|, d, eps, rho, mu) in kg/s of F = beta (u - v), with u and v
 * interstitial. Each file cites its source; the rows are in coupling/drag_laws.def. */
#ifndef COUPLING_DRAG_LAWS_H
#define COUPLING_DRAG_LAWS_H

#include "di_felice.h"
#include "stokes.h"

#endif
