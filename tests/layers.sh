#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# Dependencies point down only:
#     applications/{solvers,utilities} -> foamBridge -> libcoupling, libdem, libsph -> libparticle
# libcoupling, libdem and libsph do not know each other; no library knows OpenFOAM, and none reaches into tests.
# Looks at every #include of the tracked kinds of file, by folder. One case per folder.

set -u
cd "${1:-$(dirname "${BASH_SOURCE[0]}")/..}" || exit 1
bad=0 cases=0

includes() { # folder -> "file:line: included path"
  grep -rnE '^[[:space:]]*#[[:space:]]*include[[:space:]]*["<]' --include='*.[chCH]' --include='*.def' --include='*.inc' \
    --include='*.hpp' --include='*.cpp' --exclude-dir=lnInclude "$1" |
    sed -E 's/^([^:]*:[0-9]+):[^"<]*["<]([^">]*)[">].*/\1: \2/'
}

check() { # folder, what must not be included (extended regular expression on the included path), why
  [ -d "$1" ] || return 0
  [ -n "$(find "$1" -type f -name '*.[chCH]' -print -quit)" ] || return 0
  cases=$((cases + 1))
  local found
  found=$(includes "$1" | grep -E ": ($2)" || true)
  if [ -n "$found" ]; then
    bad=1
    echo "not ok $1 $3:"
    printf '%s\n' "$found" | sed 's/^/    /'
  else
    echo "ok $1"
  fi
}

# A path that names a library's folder, whether through its include folder or by a relative path.
up() { local IFS='|'; echo "(\.\./)*(lib($*)|$*)/"; }
foam='[^"]*\.[CH]$|(.*/)?(foamBridge|applications)/|\.\./.*tests/|(tests|naive)/'

check libparticle "$(up dem coupling sph)|$foam" "must not know the physics libraries, OpenFOAM or tests"
check libdem "$(up coupling sph)|$foam" "may use libparticle only"
check libcoupling "$(up dem sph)|$foam" "may use libparticle only"
check libsph "$(up dem coupling)|$foam" "may use libparticle only"
check applications/foamBridge '(.*/)?(solvers|utilities)/' "must not know solvers"
for dir in applications/solvers/* applications/utilities/*; do
  # A solver is built on its own: nothing from a neighbour.
  check "$dir" '\.\./.*(Foam|utilities)/' "must not include from another application"
done

[ $cases -gt 0 ] || echo "skip layers no sources yet"
exit $bad
