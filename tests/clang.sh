#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# The C libraries, their tests and benchmarks build with clang without a warning.

set -u
cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit 1
if ! command -v clang >/dev/null; then
  echo "skip clang not installed (etc/bootstrap --extras)"
  exit 0
fi
for goal in all tests bench; do
  if make --no-print-directory -k -j "$(nproc)" CC=clang WERROR=1 $goal; then
    echo "ok clang-$goal"
  else
    echo "not ok clang-$goal does not build without warnings"
    bad=1
  fi
done
exit ${bad:-0}
