#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Proves what proof_….c claim, with the model checker CBMC: for all values at once. Prints a table.
#
#   test/qa/proof/run.sh [--quick] [--broken] [NAME …]
#   test/qa/proof/run.sh --fetch
#
# NAME: a proof, or the beginning of some proofs' names. --quick: only what takes seconds. --broken:
# the library is broken in a copy, in a place for each proof, which must then fail.
#
# CBMC is a package from Debian 13 and Ubuntu 24.04 on. Debian 12 can run that of Debian 13, with
# that one's C library beside it: --fetch puts both into build-proof/, and nothing else happens to
# the machine.

set -eu

root=$(cd "$(dirname "$0")/../../.." && pwd)
fetched=$root/build-proof

skip() {
    echo "SKIPPED: $1"
    exit 0
}

# A program that was fetched runs by its own loader. goto-cc knows by its name what it is to do.
wrap() {
    printf '#!/bin/sh\nexec "%s" --library-path "%s" "%s" "$@"\n' \
        "$loader" "$libraries:$fetched/usr/lib" "$fetched/usr/bin/$1" >"$fetched/bin/$1"
    chmod +x "$fetched/bin/$1"
}

fetch() {
    # shellcheck source=test/support/trixie.sh
    . "$root/test/support/trixie.sh"
    [ ! -x "$fetched/bin/goto-instrument" ] || return 0
    [ "$(system_name)" = "debian bookworm" ] || skip "please install the package cbmc"
    rm -rf "$fetched"
    download_from_trixie "$fetched/packages" cbmc minisat libc6 libgcc-s1 libstdc++6
    for package in "$fetched"/packages/*.deb; do
        dpkg-deb -x "$package" "$fetched"
    done
    loader=$(find "$fetched/usr" -name 'ld-linux*.so.2' | head -n 1)
    libraries=$(dirname "$(find "$fetched/usr" -name libc.so.6 | head -n 1)")
    mkdir "$fetched/bin"
    wrap cbmc
    wrap goto-cc
    wrap goto-instrument
    rm -rf "$fetched/packages"
}

[ "${1:-}" != --fetch ] || { fetch; exit 0; }
PATH=$fetched/bin:$PATH
command -v python3 >/dev/null || skip "Python 3 is not installed"
if ! command -v cbmc >/dev/null || ! command -v goto-instrument >/dev/null; then
    skip "CBMC is not installed (package cbmc); on Debian 12, test/qa/proof/run.sh --fetch gets it"
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 "$root/test/qa/proof/prove.py" --work "$work" "$@"
