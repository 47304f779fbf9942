#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# doc/parameters.md from the tables that the libraries check dictionaries with (lib*/include/*/*.def).
#
#   doc/parameters.sh           write doc/parameters.md
#   doc/parameters.sh --check   change nothing; exit status 1 if it is out of date, or README.md lacks an entry
#
# Needs what `make` needs.

set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
case ${1:-} in
  '' | --check) ;;
  *) sed -n '4,9s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" >&2; exit 2 ;;
esac

make --no-print-directory -s all >&2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cat >"$work/tables.c" <<'END'
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "coupling/points.h"
#include "dem/dem.h"
#include "sph/sph.h"

static const char *const types[] = {"number", "vector", "whole number", "switch", "word", "word"};

static void print_default(const part_param *p) {
  if (p->required) {
    printf("required");
  } else if (p->type == PART_PARAM_VECTOR) {
    printf("(%.6g %.6g %.6g)", p->def[0], p->def[1], p->def[2]);
  } else if (p->type == PART_PARAM_CHOICE) {
    printf("%s", p->choices[(int)p->def[0]]);
  } else if (p->type == PART_PARAM_BOOL) {
    printf("%s", p->def[0] != 0.0 ? "on" : "off");
  } else if (p->type == PART_PARAM_WORD || (p->type == PART_PARAM_SCALAR && isnan(p->def[0]))) {
    printf("none");
  } else {
    printf("%.6g", p->def[0]);
  }
}

static void print_table(const char *title, const part_param_table *table) {
  char unit[64], range[512];
  printf("\n## %s\n\n| entry | type | unit | default | allowed | meaning |\n|---|---|---|---|---|---|\n",
         title);
  for (int k = 0; k < table->count; k++) {
    const part_param *p = &table->rows[k];
    const int number = p->type == PART_PARAM_SCALAR || p->type == PART_PARAM_VECTOR;
    part_param_unit_text(p->dims, sizeof unit, unit);
    part_param_range_text(p, sizeof range, range);
    const size_t n = strlen(range), m = strlen(unit);
    if (number && n > m && strcmp(range + n - m, unit) == 0) /* the unit has a column of its own */
      range[n - m - (n > m + 1 && range[n - m - 1] == ' ')] = '\0';
    printf("| `%s` | %s | %s | ", p->name, types[p->type], number ? unit : "");
    print_default(p);
    printf(" | %s | %s |\n", p->type == PART_PARAM_BOOL ? "on, off" : range, p->meaning);
  }
}

static void print_row(const char *name, const char *meaning) {
  printf("| `%s` | %s |\n", name, meaning);
}

int main(void) {
  printf("# Parameters\n\nMade by `doc/parameters.sh` from the tables that the code checks dictionaries "
         "with; do not edit.\nAn interval excludes the end with a round bracket. How the dictionaries "
         "look: [README](../README.md).\n");
  print_table("constant/demProperties, top level", &dem_params_table);
  print_table("constant/demProperties, each entry of `materials`", &dem_material_table);
  print_table("constant/demProperties, each entry of `contacts`", &dem_contact_table);
  print_table("constant/demProperties, each entry of `bonds`", &dem_bond_table);
  print_table("constant/demProperties, `lubrication`", &dem_lubrication_table);
  print_table("constant/demProperties, each entry of `walls`", &dem_wall_table);
  print_table("constant/demProperties, each entry of `insertion`", &dem_insert_table);
  print_table("constant/couplingProperties", &cpl_params_table);
  printf("\n## Contact laws\n\n| `law` | meaning |\n|---|---|\n");
#define DEM_LAW(name, key, meaning) print_row(key, meaning);
#include "dem/contact_laws.def"
  printf("\n## Drag laws\n\n| `drag` | Re | eps | meaning |\n|---|---|---|---|\n");
#define CPL_DRAG(name, function, re_low, re_high, eps_low, eps_high, sizes, meaning) \
  printf("| `%s` | %g to %g | %g to %g | %s |\n", #name, (double)re_low, (double)re_high, (double)eps_low, (double)eps_high, meaning);
#include "coupling/drag_laws.def"
  printf("\n## Void fraction\n\n| `voidFraction` | meaning |\n|---|---|\n");
#define CPL_VOID_FRACTION(name, meaning) print_row(#name, meaning);
#include "coupling/void_fractions.def"
  printf("\n## Particle quantities in files\n\n| array | components | unit | meaning |\n|---|---|---|---|\n");
  for (int k = 0; k < dem_layout.field_count; k++) {
    const part_field *f = &dem_layout.fields[k];
    if (f->flags & PART_WRITTEN)
      printf("| `%s` | %d | %s | %s |\n", f->name, f->comps, f->unit, f->meaning);
  }
  printf("\n# Smoothed particles\n");
  print_table("`sph_params`", &sph_params_table);
  print_table("exchange with particles (`cpl_points_params`)", &cpl_points_table);
  print_table("`sph_wall_params`", &sph_wall_table);
  print_table("`sph_insert`", &sph_insert_table);
  printf("\n## Kernels\n\n| `kernel` | meaning |\n|---|---|\n");
#define SPH_KERNEL(name, key, support, meaning) print_row(key, meaning);
#include "sph/kernels.def"
  printf("\n## Walls of a fluid of smoothed particles\n\n`model` of `sph_wall_params`.\n\n| model | meaning |\n|---|---|\n");
#define SPH_WALL_POINTS(name, key, meaning) printf("| `%s` | %s |\n", key, meaning);
#define SPH_WALL_PUSH(name, key, meaning) printf("| `%s` | %s |\n", key, meaning);
#include "sph/wall_models.def"
  printf("\n## Particle quantities in files of libsph\n\n| array | components | unit | meaning |\n|---|---|---|---|\n");
  for (int k = 0; k < sph_layout.field_count; k++) {
    const part_field *f = &sph_layout.fields[k];
    if (f->flags & PART_WRITTEN)
      printf("| `%s` | %d | %s | %s |\n", f->name, f->comps, f->unit, f->meaning);
  }
  return 0;
}
END

includes=$(pkg-config --cflags ompi-c 2>/dev/null || mpicc -showme:compile)
# shellcheck disable=SC2086
"${CC:-cc}" -std=c11 -Ilibparticle/include -Ilibdem/include -Ilibcoupling/include -Ilibsph/include $includes "$work/tables.c" \
  -Lbuild/lib -Wl,-rpath,"$PWD/build/lib" -ldem -lcoupling -lsph -lparticle -o "$work/tables"
"$work/tables" >"$work/parameters.md"

if [ "${1:-}" != --check ]; then
  cp "$work/parameters.md" doc/parameters.md
  exit 0
fi
status=0
if ! cmp -s "$work/parameters.md" doc/parameters.md; then
  echo "not ok doc/parameters.md is out of date; run doc/parameters.sh"
  status=1
fi
for entry in $(sed -n '/^## Contact laws/q; s/^| `\([A-Za-z]*\)`.*/\1/p' "$work/parameters.md"); do
  grep -qw "$entry" README.md || { echo "not ok README.md does not mention the entry $entry"; status=1; }
done
[ $status = 0 ] && echo "ok parameters"
exit $status
