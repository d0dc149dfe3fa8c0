#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Packs the last commit twice, from two clones, with different time zones and umasks. Both must give
# the same bytes, and archives.py must accept the archives. Packs the Python package, too, if its
# tools are in PYTHON or can be installed there.
#
#   reproducible.sh WORK PYTHON
#
# Exit status: 0 the same, 1 not, 77 this is not a Git repository.

set -eu

work=$1 python=$2
root=$(cd "$(dirname "$0")/../../.." && pwd)
if ! git -C "$root" rev-parse HEAD >/dev/null 2>&1; then
    echo "skipped: no Git repository here"
    exit 77
fi

# pack NAME ZONE UMASK: packs a new clone to $work/NAME/out.
pack() {
    export TZ="$2"
    umask "$3"
    git clone --quiet --no-hardlinks "$root" "$work/$1/tmini"
    sdist=$("$work/$1/tmini/test/python/sdist.sh" "$python" 2>/dev/null) || sdist=
    python3 -B "$work/$1/tmini/.ci/pack.py" --allow-placeholder ${sdist:+--sdist "$sdist"} \
        "$work/$1/out"
}

rm -rf "$work"
mkdir -p "$work"
(pack one Pacific/Kiritimati 022)
sleep 1
(pack "another one" America/Adak 077)
for file in "$work"/one/out/*; do
    cmp "$file" "$work/another one/out/${file##*/}"
done
exec python3 -B "$root/test/qa/release/archives.py" "$work/one/out" "$work/unpacked"
