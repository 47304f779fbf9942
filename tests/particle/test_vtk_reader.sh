#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# Files that libparticle writes, opened by VTK's own VTKHDF reader (the one ParaView uses) and by h5py.
# Needs a build (make tests) and a Python with numpy, h5py and vtk: PYTHON=/usr/bin/python3
# timeout: 120

set -u
cd "$(dirname "${BASH_SOURCE[0]}")/../.." || exit 1
PYTHON=${PYTHON:-/usr/bin/python3}
build=${CFDDEM_BUILD:-build}
writer=$build/tests/particle/test_vtkhdf

if [ ! -x "$writer" ]; then
  echo "not ok vtkReader $writer is not built (make tests)"
  exit 1
fi
if ! "$PYTHON" -c 'import numpy, h5py, vtk' 2> /dev/null; then
  echo "skip vtkReader $PYTHON has no numpy, h5py and vtk"
  exit 0
fi

folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1
export PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe OMPI_MCA_btl_vader_single_copy_mechanism=none

failed=0
check() { # name ranks particles-per-rank
  local file=$folder/$1.vtkhdf
  if [ "$2" = 1 ]; then "$writer" --write "$3" "$file"; else mpirun -np "$2" "$writer" --write "$3" "$file"; fi \
    > "$folder/log" 2>&1 || { echo "not ok vtkReader.$1 cannot write: $(tail -n 1 "$folder/log")"; failed=1; return; }
  if why=$("$PYTHON" tests/particle/vtk_reader.py "$file" "$2" "$3" 2>&1); then
    echo "ok vtkReader.$1"
  else
    echo "not ok vtkReader.$1 $(tail -n 1 <<< "$why")"
    failed=1
  fi
}
check serial 1 40
check threeRanks 3 40
check nobody 1 0
check nobodyOnTwoRanks 2 0
exit $failed
