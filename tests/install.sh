#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# make install into a temporary folder; the C example of tutorials/libdem, copied out of the tree, builds against what is
# there alone, with the shared and with the static libraries, and prints the right number.

set -u
cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit 1
tree=$PWD bad=0
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

report() { # name, status, why
  if [ "$2" = 0 ]; then echo "ok $1"; else echo "not ok $1 $3"; bad=1; fi
}

make --no-print-directory -s install PREFIX="$work/at" >"$work/log" 2>&1
report install $? "$(tail -n 3 "$work/log")"
cp -R tutorials/libdem/bouncingSphere "$work/example"
cd "$work/example" || exit 1
export PKG_CONFIG_PATH=$work/at/lib/pkgconfig
export LD_LIBRARY_PATH=$work/at/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH} # etc/bashrc names build/lib, which would win over rpath

# Rebound over e^2 times the drop: 1 but for the weight during the contact (3e-4 of the speed before it) and for the step
# (tc/50; the bar for the restitution is 1e-3).
number() { # program -> status
  "$1" >"$work/out" 2>&1 || return 1
  awk '{ x = $NF } END { exit !(NR == 1 && x > 0.999 && x < 1.001) }' "$work/out"
}

make -s -B CFLAGS='-O2 -std=c11 -Wall -Wextra -Wpedantic -Werror' bouncingSphere >"$work/log" 2>&1
report example-builds $? "$(tail -n 3 "$work/log")"
number ./bouncingSphere
report example-runs $? "$(head -n 3 "$work/out")"
[ "$(ldd ./bouncingSphere | grep -E 'libdem|libparticle' | grep -c "=> $work/at/lib/")" = 2 ]
report example-uses-what-is-installed $? "$(ldd ./bouncingSphere | grep -E 'libdem|libparticle' | tr '\n' ' ')"
# shellcheck disable=SC2046
! cc -M $(pkg-config --cflags libdem) main.c | grep -q -F "$tree/"
report example-headers $? "a header comes from the source tree"

# shellcheck disable=SC2046
{ rm -f "$work"/at/lib/*.so && cc -std=c11 $(pkg-config --cflags libdem) main.c $(pkg-config --static --libs libdem) -o static; } >"$work/log" 2>&1
report static-builds $? "$(tail -n 3 "$work/log")"
number ./static
report static-runs $? "$(head -n 3 "$work/out")"
for library in "$tree"/lib*/; do
  library=$(basename "$library")
  [ -e "$tree/$library/src" ] || continue
  pkg-config --exists --print-errors "$library" >"$work/log" 2>&1
  report "pkg-config-$library" $? "$(head -n 1 "$work/log")"
done
exit $bad
