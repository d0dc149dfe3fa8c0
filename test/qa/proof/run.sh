#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Proves the claims in proof_….c for all values, with the model checker CBMC. Prints a table.
#
#   test/qa/proof/run.sh [--quick] [--broken] [NAME …]
#   test/qa/proof/run.sh --fetch
#
# NAME is a proof, or the beginning of the names of some proofs. --quick runs only proofs that take
# at most ten seconds. With --broken, a copy of the library is broken in one place for each proof,
# which must then fail.
#
# Debian 13, Ubuntu 24.04 and later have a package of CBMC. Debian 12 can run the CBMC of Debian 13
# with Debian 13's C library: --fetch downloads both to build-proof/, and changes nothing else.

set -eu

root=$(cd "$(dirname "$0")/../../.." && pwd)
fetched=$root/build-proof

skip() {
    echo "SKIPPED: $1"
    exit 0
}

# wrap NAME: a fetched program needs its own loader. Its name must be kept: goto-cc depends on it.
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
