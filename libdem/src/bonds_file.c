/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What files keep of bonds beside the payload (bonds.h), for dem_write and dem_read. */
#include "internal.h"
#include "particle/vtkhdf.h"

enum { BROKEN_VALUES = 5 };

int dem_bonds_values(const dem_t *dem) {
  return dem->plan.bonds ? 2 + BROKEN_VALUES * (int)dem->bonds.broken : 0;
}

/* Widest bond, bound of the frequencies, [broken][BROKEN_VALUES]; the same on every rank. */
static int pack_bonds(const dem_t *dem, double **values) {
  const dem_bonds *bonds = &dem->bonds;
  PART_TRY(dem_allocate((size_t)dem_bonds_values(dem), sizeof **values, values));
  double *to = *values;
  *to++ = bonds->widest;
  *to++ = bonds->rate;
  for (int64_t k = 0; k < bonds->broken; k++, to += BROKEN_VALUES) {
    const dem_broken_bond *b = &bonds->list[k];
    const double packed[BROKEN_VALUES] = {(double)b->a, (double)b->b, (double)b->mode, b->time,
                                          b->stress};
    memcpy(to, packed, sizeof packed);
  }
  return PART_OK;
}

static int unpack_bonds(dem_t *dem, const double *from, int n) {
  dem_bonds *bonds = &dem->bonds;
  bonds->widest = from[0];
  bonds->rate = from[1];
  bonds->broken = (n - 2) / BROKEN_VALUES;
  PART_TRY(dem_grow((size_t)bonds->broken, sizeof *bonds->list, &bonds->list_room, &bonds->list));
  from += 2;
  for (int64_t k = 0; k < bonds->broken; k++, from += BROKEN_VALUES)
    bonds->list[k] =
        (dem_broken_bond){(int64_t)from[0], (int64_t)from[1], (int64_t)from[2], from[3], from[4]};
  return PART_OK;
}

int dem_bonds_write(const dem_t *dem, part_file *file) {
  double *values = NULL;
  int status = part_agree(dem->comm, pack_bonds(dem, &values));
  if (status == PART_OK)
    status = part_file_write_values(file, "demBonds", dem_bonds_values(dem), values);
  free(values);
  return status;
}

int dem_bonds_read(dem_t *dem, part_file *file, int wanted) {
  double *values = NULL;
  int n = wanted;
  int status = part_agree(dem->comm, dem_allocate((size_t)wanted, sizeof *values, &values));
  if (status == PART_OK)
    status = part_file_read_values(file, "demBonds", &n, values);
  if (status == PART_OK && (n != wanted || n < 2 || (n - 2) % BROKEN_VALUES != 0))
    status = part_fail(PART_ERR_FORMAT, "demBonds has %d values, not %d", n, wanted);
  if (status == PART_OK)
    status = unpack_bonds(dem, values, n);
  free(values);
  return part_agree(dem->comm, status);
}
