#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# doc/parameters.md and the README hold every entry of the dictionaries, as the code reads them; links lead somewhere.
set -u
cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit 1
bad=0
doc/parameters.sh --check || { echo "not ok parameters doc/parameters.sh --check failed"; bad=1; }

missing=
for page in README.md CONTRIBUTING.md doc/*.md tutorials/*.md tutorials/*/*/README.md; do
  [ -f "$page" ] || continue
  for link in $(grep -oE '\]\([^)# ]+' "$page" | cut -c3- | grep -vE '^[a-z]+:'); do
    [ -e "$(dirname "$page")/$link" ] || missing="$missing $page:$link"
  done
done
if [ -z "$missing" ]; then echo "ok links"; else echo "not ok links$missing"; bad=1; fi
exit $bad
