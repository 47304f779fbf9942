#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# timeout: 1200
#
# The C tests again, built with the address and undefined-behaviour sanitizers. One case per program and rank count.

set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit 1
make --no-print-directory check SAN=address,undefined OPT=-O1 |
  awk '
    { print "# " $0 }
    /^make check: there are no tests/ { print "skip sanitizers no C tests yet" }
    /^(ok|FAIL) +[^ ]+\/test_/ {
      name = $2 ($3 == "-np" ? "-np" $4 : "")
      print ($1 == "ok" ? "ok " : "not ok ") name ($1 == "ok" ? "" : " see the lines below, and build/gcc-address-undefined/test-logs")
    }'
