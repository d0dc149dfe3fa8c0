#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Runs threads.c under ThreadSanitizer with the library's own barriers for several cores; then with
# one barrier removed, which must be detected. Needs Clang: the sanitizer of GCC 12 detects less.
# Exit status 77: Clang's sanitizer is not available.
#
#   test/system/threads.sh [TURNS]     of the recording: 6 unless given

set -eu

root=$(cd "$(dirname "$0")/../.." && pwd)
turns=${1:-6}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# build NAME INCLUDE_FOLDER
build() {
    clang -std=gnu99 -O1 -g -fsanitize=thread -pthread -DTMINI_SINGLE_CORE=0 -I"$2" \
        "$root/test/system/threads.c" "$root"/lib/src/*.c -o "$work/$1"
}

# run NAME: fails if a race is seen.
run() {
    TSAN_OPTIONS="halt_on_error=1 exitcode=66" \
        "$work/$1" "$root/test/recordings/sim-6hz.bin" "$turns" >"$work/$1.log" 2>&1
}

if ! echo 'int main(void) { return 0; }' |
    clang -x c -fsanitize=thread - -o "$work/trial" 2>/dev/null || ! "$work/trial"; then
    echo "skipped: no Clang with ThreadSanitizer (packages clang, libclang-rt-…-dev)"
    exit 77
fi
build right "$root/lib/include"
run right || { cat "$work/right.log"; exit 1; }
cat "$work/right.log"
cp -R "$root/lib/include" "$work/broken_include"
sed -i 's/__ATOMIC_RELEASE/__ATOMIC_RELAXED/' "$work/broken_include/tmini/tmini_atomic.h"
build broken "$work/broken_include"
if run broken; then
    echo "without the release of what was stored, no race has been seen"
    exit 1
fi
