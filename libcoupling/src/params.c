/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The coupling dictionary, and the drag laws by row. */
#include <stddef.h>
#include "coupling/coupling.h"
#include "drag/laws.h"
#include "param_rows.h"
#include "void_fractions.h"

static const char *const models[] = {"A", "B", "Bfull", NULL};

static const char *const overfulls[] = {"spread", "error", NULL};

static const char *const smoothings[] = {"off", "diffusion", NULL};

static const char *const void_fractions[] = {
#define CPL_VOID_FRACTION(name, meaning) #name,
#include "coupling/void_fractions.def"
#undef CPL_VOID_FRACTION
    NULL};

static const char *const drag_laws[] = {
#define CPL_DRAG(name, function, re_low, re_high, eps_low, eps_high, sizes, meaning) #name,
#include "coupling/drag_laws.def"
#undef CPL_DRAG
    NULL};

static const cpl_drag_law drag_functions[] = {
#define CPL_DRAG(name, function, re_low, re_high, eps_low, eps_high, sizes, meaning) function,
#include "coupling/drag_laws.def"
#undef CPL_DRAG
};

static const unsigned char law_needs_sizes[] = {
#define CPL_DRAG(name, function, re_low, re_high, eps_low, eps_high, sizes, meaning) sizes,
#include "coupling/drag_laws.def"
#undef CPL_DRAG
};

static const cpl_drag_range drag_ranges[] = {
#define CPL_DRAG(name, function, re_low, re_high, eps_low, eps_high, sizes, meaning)               \
  {re_low, re_high, eps_low, eps_high},
#include "coupling/drag_laws.def"
#undef CPL_DRAG
};

static const part_param rows[] = {
#define CPL_STRUCT cpl_params
#include "coupling/coupling_params.def"
#undef CPL_STRUCT
};

const part_param_table cpl_params_table = {"coupling", (int)(sizeof rows / sizeof *rows), rows};

int cpl_drag_count(void) {
  return (int)(sizeof drag_functions / sizeof *drag_functions);
}

const char *cpl_drag_name(int law) {
  return law >= 0 && law < cpl_drag_count() ? drag_laws[law] : NULL;
}

cpl_drag_law cpl_drag_function(int law) {
  return law >= 0 && law < cpl_drag_count() ? drag_functions[law] : NULL;
}

const cpl_drag_range *cpl_drag_range_of(int law) {
  return law >= 0 && law < cpl_drag_count() ? &drag_ranges[law] : NULL;
}

int cpl_drag_needs_sizes(int law) {
  return law >= 0 && law < cpl_drag_count() && law_needs_sizes[law];
}
