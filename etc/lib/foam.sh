# SPDX-License-Identifier: GPL-3.0-or-later
#
# Shared by etc/bootstrap and etc/bashrc (bash): which OpenFOAM is used, and where ours lives.

cfddem_cache() {
  echo "${XDG_CACHE_HOME:-${HOME:-$(getent passwd "$(id -u)" | cut -d: -f6)}/.cache}/cfddem"
}

# Folder of the headers and wmake that belong to Debian's openfoam of this source version.
cfddem_foam_dir() { # version
  echo "$(cfddem_cache)/OpenFOAM-$1"
}

# True if the user has sourced an OpenFOAM of their own that can compile.
cfddem_foam_is_users() {
  [ -n "${WM_PROJECT_DIR:-}" ] || return 1
  case $WM_PROJECT_DIR in "$(cfddem_cache)"/*) return 1 ;; esac
  [ -d "$WM_PROJECT_DIR/src/OpenFOAM/lnInclude" ] && [ -x "$WM_PROJECT_DIR/wmake/wmake" ]
}

# A Python that has numpy: $PYTHON if set, else Debian's, else the first in PATH.
cfddem_python() {
  if [ -n "${PYTHON:-}" ]; then
    echo "$PYTHON"
  elif [ -x /usr/bin/python3 ]; then
    echo /usr/bin/python3
  else
    command -v python3 || echo python3
  fi
}
