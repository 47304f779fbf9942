/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every drag law: beta(|u - v|, d, eps, rho, mu, mean_d) in kg/s of F = beta (u - v), with u and v
 * interstitial; mean_d: Sauter mean diameter of the spheres around. Each file cites its source; the
 * rows are in coupling/drag_laws.def. */
#ifndef COUPLING_DRAG_LAWS_H
#define COUPLING_DRAG_LAWS_H

#include "beetstra.h"
#include "coulson_richardson.h"
#include "di_felice.h"
#include "ergun.h"
#include "gidaspow.h"
#include "koch_hill.h"
#include "schiller_naumann.h"
#include "stokes.h"
#include "syamlal_o_brien.h"
#include "wen_yu.h"

#endif
