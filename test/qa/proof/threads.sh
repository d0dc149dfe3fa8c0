#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# The ring between two threads under ThreadSanitizer:
#
#   test/qa/proof/threads.sh [MILLIONS]      of bytes; 100 unless given
#
# First with one order taken out, which ThreadSanitizer must find, or it would see nothing at all
# (as that of GCC 12 does not: so by Clang).

set -eu

root=$(cd "$(dirname "$0")/../../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# build NAME FLAG…
build() {
    name=$1
    shift
    clang -std=gnu99 -O2 -g -fsanitize=thread -pthread "$@" -I"$work/$name" -I"$root/lib/include" \
        "$root/test/qa/proof/threads.c" "$root/lib/src/tmini_ring.c" -o "$work/threads_$name"
}

command -v clang >/dev/null || { echo "SKIPPED: clang is not installed"; exit 0; }
mkdir "$work/broken"
cp -R "$root/lib/include/tmini" "$work/broken"
sed 's/__ATOMIC_RELEASE/__ATOMIC_RELAXED/' "$root/lib/include/tmini/tmini_atomic.h" \
    >"$work/broken/tmini/tmini_atomic.h"
build broken
if "$work/threads_broken" 1 >"$work/log" 2>&1; then
    echo "ThreadSanitizer has not found the race that was made"
    exit 1
fi
build right
"$work/threads_right" "${1:-100}"
