#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# timeout: 60
#
# etc/bootstrap for a user who is not root, with one package missing: it goes through sudo, and says what to do when
# sudo is absent or refuses. Nothing is installed: id, dpkg-query and sudo are stand-ins in front of PATH.

set -u
cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit 1
version=$(dpkg-query -W -f '${source:Version}' openfoam 2>/dev/null) || { echo "skip bootstrap Debian's openfoam is not in use"; exit 0; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
bad=0
verdict() { # name status why
  if [ "$2" = 0 ]; then echo "ok $1"; else echo "not ok $1 $3"; bad=1; fi
}
stand_in() { # name, script
  printf '#!/bin/sh\n%s\n' "$2" >"$work/bin/$1"
  chmod +x "$work/bin/$1"
}
bootstrap() { # options; sets said, status
  said=$(env -u WM_PROJECT_DIR HOME="$work" XDG_CACHE_HOME="$work/cache" PATH="$work/bin:$system" etc/bootstrap "$@" 2>&1)
  status=$?
}

# PATH without a real sudo: links to what else is in /usr/bin and /bin
mkdir -p "$work/bin" "$work/system" "$work/cache/cfddem/OpenFOAM-$version"
ln -s /usr/bin/* "$work/system/" && rm -f "$work/system/sudo"
system=$work/system
touch "$work/cache/cfddem/OpenFOAM-$version/.complete"
stand_in id 'echo 1000'
stand_in dpkg-query 'exec /usr/bin/dpkg-query "$@" | grep -v libcmocka-dev'

bootstrap --check
[ $status = 1 ] && [[ $said == *"missing packages: libcmocka-dev"* ]]
verdict check_names_what_is_missing $? "status $status: $said"
bootstrap
[ $status = 1 ] && [[ $said == *"not root and no sudo; ask for: apt-get install"*libcmocka-dev* ]]
verdict without_sudo $? "status $status: $said"

stand_in sudo "echo \"\$*\" >>$work/asked"
bootstrap
asked=$(cat "$work/asked" 2>/dev/null)
[ $status = 0 ] && [[ $asked == "apt-get update"*"apt-get install -y --no-install-recommends"*" libcmocka-dev" ]]
verdict with_sudo $? "status $status: $said; sudo was asked: $asked"
stand_in sudo 'echo "sudo: a password is required" >&2; exit 1'
bootstrap
[ $status = 1 ] && [[ $said == *"a password is required"*"apt-get install failed"* ]]
verdict sudo_refuses $? "status $status: $said"

stand_in dpkg-query 'exec /usr/bin/dpkg-query "$@"'
rm "$work/bin/sudo"
missing=$(etc/bootstrap --check 2>&1) # on a machine that lacks something the next would need sudo
if [ -z "$missing" ]; then
  bootstrap
  [ $status = 0 ] && [ -z "$said" ]
  verdict nothing_missing_nothing_done $? "status $status: $said"
fi
exit $bad
