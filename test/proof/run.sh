#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Proves what proof_….c claim, with the model checker CBMC: for all values at once. About a minute.
#
# Without an installed cbmc (Debian has it from trixie on) and as root, it is put into a small
# Debian of its own in build-proof/, by debootstrap, from where this machine's own packages come.

set -eu

root=$(cd "$(dirname "$0")/../.." && pwd)
jail=$root/build-proof
# shellcheck source=test/support/mirrors.sh
. "$root/test/support/mirrors.sh"

make_jail() {
    command -v debootstrap >/dev/null || apt-get install -y -qq debootstrap >/dev/null
    debootstrap --variant=minbase --include=gcc,libc6-dev,cbmc trixie "$jail" \
        "$(mirror_of debian)" >"$jail.log" 2>&1
}

if command -v cbmc >/dev/null; then
    run_cbmc() { cbmc "$@"; }
    sources=$root
else
    [ -x "$jail/usr/bin/cbmc" ] || make_jail
    rm -rf "$jail/tmini"
    mkdir -p "$jail/tmini/test"
    cp -r "$root/lib" "$jail/tmini"
    cp -r "$root/test/proof" "$jail/tmini/test"
    run_cbmc() { chroot "$jail" cbmc "$@"; }
    sources=/tmini
fi

# prove NAME UNWIND LIBRARY-SOURCE…
prove() {
    name=$1 unwind=$2
    shift 2
    for source in "$@"; do
        set -- "$@" "$sources/lib/src/$source"
        shift
    done
    echo "$name:"
    run_cbmc -I "$sources/lib/include" -I "$sources/test/proof" --unwind "$unwind" \
        --unwinding-assertions --bounds-check --pointer-check --signed-overflow-check \
        --undefined-shift-check --div-by-zero-check \
        "$sources/test/proof/$name.c" "$sources/test/proof/any_ring.c" "$@" |
        grep -E 'FAILURE|^VERIFICATION|^\*\*'
}

prove proof_ring 37 tmini_ring.c
