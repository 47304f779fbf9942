# SPDX-License-Identifier: GPL-3.0-or-later
#
# For the Allrun of a case (bash, "set -eu", current directory the case):
#
#   source ../../tools/functions.sh
#   caseOptions "$@"              -parallel N, -noPlot, -sph (where the case has a fluid for it), -h (prints the comment at the top of Allrun)
#   copyCase runs/a               a fresh copy of the case, without results; goes there
#   setEntry FILE ENTRY VALUE     of a dictionary
#   runStage blockMesh            a command; output in log.<command>; stops with the end of the log if it fails
#   runSolver cfdDemFoam          the same on $RANKS ranks, with decomposePar, reconstructPar and progress lines
#   runSph [END]                  the case with its fluid as particles, sphDemFoam in runs/sph until END (s), and ./plotSph
#   runPlot                       ./plot with $PYTHON
#   runRender                     ./render with $PYTHON, where there is a display, real or virtual

TUTORIALS=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
source "$TUTORIALS/../etc/bashrc"

RANKS=1 PLOT=1 SPH=0 SOLVER_PID=
trap '[ -z "$SOLVER_PID" ] || kill "$SOLVER_PID" 2>/dev/null || true' EXIT
trap 'exit 130' INT TERM

fail() { # message
  echo "$(caseName): $*" >&2
  exit 1
}

caseName() { # a copy in runs/ has the name of its case before its own
  case $PWD in
    */runs/*) basename "${PWD%/runs/*}" | tr '\n' ' '; basename "$PWD" ;;
    *) basename "$PWD" ;;
  esac
}

caseOptions() {
  while [ $# -gt 0 ]; do
    case $1 in
      -parallel)
        RANKS=${2:-}
        case $RANKS in '' | *[!0-9]* | 0) fail "-parallel needs a number of ranks, not '$RANKS'" ;; esac
        shift 2 ;;
      -noPlot) PLOT=0; shift ;;
      -sph)
        [ -f constant/sphProperties ] || fail "-sph: the case has no constant/sphProperties"
        SPH=1; shift ;;
      -h | -help | --help) sed -n '/^#!/d;/^#/!q;/SPDX/d;/^#$/d;s/^# //p' "$0"; exit 0 ;;
      *) fail "unknown option '$1'; valid: -parallel N, -noPlot, -sph (with constant/sphProperties), -h" ;;
    esac
  done
}

copyCase() { # folder
  rm -rf "$1"
  mkdir -p "$1"
  [ ! -d 0.orig ] || cp -r 0.orig "$1/0"
  cp -r constant system "$1/"
  cd "$1"
  rm -rf constant/polyMesh
}

setEntry() { # file entry value
  foamDictionary "$1" -entry "$2" -set "$3" >>log.foamDictionary 2>&1 || fail "foamDictionary failed: $1 $2"
}

runStage() { # command...
  local log=log.$1
  "$@" >"$log" 2>&1 && return 0
  echo "$(caseName): '$*' failed; the end of $PWD/$log:" >&2
  tail -n 25 "$log" >&2
  exit 1
}

# One line whenever another tenth is done.
_progress() { # log
  local line percent
  line=$(tail -n 200 "$1" 2>/dev/null | grep '^Progress:' | tail -n 1) || return 0
  percent=${line#Progress: } percent=${percent%% *} percent=${percent%%.*}
  case $percent in '' | *[!0-9]*) return 0 ;; esac
  [ $((percent / 10)) -gt $((_last / 10)) ] || return 0
  _last=$percent
  printf '  %-25s %3d %%   time left %s\n' "$(caseName)" "$percent" "${line##*time left }"
}

runSolver() { # solver [options]
  local log=log.$1 status=0 _last=0
  command -v "$1" >/dev/null || fail "$1 is not built: run ./Allwmake in the root first"
  if [ "$RANKS" -gt 1 ]; then
    sed "s/^\(numberOfSubdomains \).*/\1$RANKS;/;s/^\( *n  *\)(.*/\1($RANKS 1 1);/" system/decomposeParDict >system/decomposeParDict.ranks
    set -- "$@" -decomposeParDict system/decomposeParDict.ranks
    runStage decomposePar -force -decomposeParDict system/decomposeParDict.ranks
    set -- mpirun -np "$RANKS" "$@" -parallel
  fi
  "$@" >"$log" 2>&1 </dev/null &
  SOLVER_PID=$!
  while kill -0 "$SOLVER_PID" 2>/dev/null; do
    sleep 0.5
    _progress "$log"
  done
  wait "$SOLVER_PID" || status=$?
  SOLVER_PID=
  if [ $status != 0 ]; then
    echo "$(caseName): '$*' failed ($status); the end of $PWD/$log:" >&2
    tail -n 25 "$log" >&2
    exit 1
  fi
  # Without fields there is nothing that reconstructPar (which wants fvSchemes) is needed for: particles/ is whole
  if [ "$RANKS" -gt 1 ] && [ -f system/fvSchemes ]; then runStage reconstructPar; fi
}

runSph() {
  local here=$PWD
  copyCase runs/sph
  [ $# = 0 ] || setEntry system/controlDict endTime "$1"
  runStage blockMesh
  runSolver sphDemFoam
  cd "$here"
  [ "$PLOT" = 0 ] || "$PYTHON" ./plotSph
}

runPlot() {
  [ "$PLOT" = 1 ] || return 0
  "$PYTHON" ./plot
}

runRender() {
  [ "$PLOT" = 1 ] || return 0
  if [ -z "${DISPLAY:-}" ] && ! command -v Xvfb >/dev/null; then
    echo "$(caseName): no picture of the particles, because there is neither a display nor Xvfb"
    return 0
  fi
  "$TUTORIALS/../etc/withDisplay" "$PYTHON" ./render
}
