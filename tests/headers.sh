#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# Every public header compiles on its own, as C11 and as C++11, without a warning. One case per header and language.

set -u
cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit 1
bad=0
flags=(-fsyntax-only -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror)
for dir in lib*/include; do flags+=(-I"$dir"); done
for dir in $(pkg-config --cflags-only-I ompi-c hdf5-openmpi 2>/dev/null || mpicc -showme:compile); do
  case $dir in -I*) flags+=(-isystem "${dir#-I}") ;; esac
done

try() { # name compiler... : reads the program
  local name=$1 out
  shift
  if out=$("$@" 2>&1); then
    echo "ok $name"
  else
    bad=1
    echo "not ok $name $(printf '%s\n' "$out" | grep -m1 -E 'error|warning')"
  fi
}

none=1
for header in lib*/include/*/*.h; do
  [ -e "$header" ] || continue
  none=0
  path=${header#*/include/}
  try "$path-C11" gcc -std=c11 "${flags[@]}" -x c - <<<"#include \"$path\""
  try "$path-C++11" g++ -std=c++11 "${flags[@]}" -x c++ - <<<"#include \"$path\""
done
[ $none = 0 ] || echo "skip headers no public headers yet"
exit $bad
