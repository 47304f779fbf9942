/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parameters that may change in a run. */
#include <string.h>
#include "coupling_type.h"

/* The others say what fields or particle state there are (model, smoothing, selfDisturbance, forces
 * that need a field of the flow), or would let the void fraction jump where no solid moves
 * (voidFraction, subCells, the bandwidth). */
static const char *const changeable[] = {"drag", "minimumEps", "overfull", NULL};

int cpl_may_change(const char *entry) {
  for (int k = 0; changeable[k]; k++)
    if (strcmp(entry, changeable[k]) == 0)
      return 1;
  return 0;
}

int cpl_param_differs(const part_param *row, const cpl_params *a, const cpl_params *b) {
  static const size_t width[] = {
      [PART_PARAM_SCALAR] = sizeof(double), [PART_PARAM_VECTOR] = 3 * sizeof(double),
      [PART_PARAM_INT] = sizeof(int64_t),   [PART_PARAM_BOOL] = sizeof(int),
      [PART_PARAM_CHOICE] = sizeof(int),    [PART_PARAM_WORD] = PART_PARAM_WORD_LENGTH};
  return memcmp((const char *)a + row->offset, (const char *)b + row->offset, width[row->type]) !=
         0;
}

static int check_change(const cpl_t *cpl, const cpl_params *params) {
  PART_TRY(part_params_check(&cpl_params_table, params));
  for (int k = 0; k < cpl_params_table.count; k++) {
    const part_param *row = &cpl_params_table.rows[k];
    if (cpl_param_differs(row, &cpl->params, params) && !cpl_may_change(row->name))
      return part_fail(PART_ERR_ARGUMENT,
                       "coupling: entry '%s' can not change in a run; those that can: drag, "
                       "minimumEps, overfull",
                       row->name);
  }
  return PART_OK;
}

int cpl_change_params(cpl_t *cpl, const cpl_params *params) {
  PART_TRY(cpl_agree(cpl, check_change(cpl, params)));
  if (params->overfull == CPL_OVERFULL_SPREAD && !cpl->relief)
    PART_TRY(cpl_relief_create(cpl->comm, &cpl->mesh, &cpl->relief));
  if (params->overfull != CPL_OVERFULL_SPREAD) {
    cpl_relief_destroy(cpl->relief);
    cpl->relief = NULL;
  }
  cpl->params = *params;
  cpl->solid_stamp = 0; /* deposited again, also where nothing has moved */
  return PART_OK;
}
