#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Proves what proof_….c claim, with the model checker CBMC: for all values at once. Prints a table.
#
#   test/proof/run.sh [--quick] [--broken] [NAME …]
#
# NAME: a proof, or the beginning of some proofs' names. --quick: only what takes seconds, and only
# where CBMC is installed. --broken: the library is broken in a copy, in a place for each proof,
# which must then fail.
#
# Without an installed cbmc (Debian has it from trixie on) and as root, it is put into a small
# Debian of its own in build-proof/, by debootstrap, from where this machine's own packages come.

set -eu

root=$(cd "$(dirname "$0")/../.." && pwd)
jail=$root/build-proof
# shellcheck source=test/support/mirrors.sh
. "$root/test/support/mirrors.sh"

skip() {
    echo "SKIPPED: $1"
    exit 0
}

# Only what is asked for by hand is worth half a gigabyte.
make_jail() {
    case " $* " in
        *" --quick "*) skip "CBMC is not installed (package cbmc)" ;;
    esac
    command -v debootstrap >/dev/null || apt-get install -y -qq debootstrap >/dev/null
    mkdir -p "$jail"
    debootstrap --variant=minbase --include=gcc,libc6-dev,cbmc,z3 trixie "$jail" \
        "$(mirror_of debian)" >"$jail/made.log" 2>&1
}

command -v python3 >/dev/null || skip "Python 3 is not installed"
if command -v cbmc >/dev/null && command -v goto-instrument >/dev/null; then
    work=$(mktemp -d)
    trap 'rm -rf "$work"' EXIT
    python3 "$root/test/proof/prove.py" --work "$work" "$@"
else
    [ -x "$jail/usr/bin/cbmc" ] || make_jail "$@"
    python3 "$root/test/proof/prove.py" --work "$jail/tmini" --jail "$jail" "$@"
fi
