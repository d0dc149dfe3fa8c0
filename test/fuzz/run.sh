#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Fuzzes the parser and the driver with libFuzzer under the address and undefined-behaviour
# sanitizers:
#
#   test/fuzz/run.sh [SECONDS]      for each target; 60 unless given
#
# What it finds lies in build-fuzz/; give that file to build-fuzz/fuzz_… to see it again. The inputs
# that it collected stay in build-fuzz/corpus_… and are where the next run goes on.

set -eu

root=$(cd "$(dirname "$0")/../.." && pwd)
seconds=${1:-60}
support=$root/test/support
build=$root/build-fuzz
compiler=${TMINI_FUZZ_CC:-clang}

if ! echo 'int LLVMFuzzerTestOneInput(void) { return 0; }' |
    "$compiler" -x c -fsanitize=fuzzer,address - -o /dev/null 2>/dev/null; then
    echo "SKIPPED: $compiler cannot build fuzzers (packages clang, libclang-rt-…-dev)"
    exit 0
fi

# fuzz TARGET SOURCE…
fuzz() {
    target=$1
    shift
    "$compiler" -std=c99 -g -O1 -Wall -Wextra -fsanitize=fuzzer,address,undefined \
        -fno-sanitize-recover=all -I"$root/lib/include" -I"$root/lib/src" -I"$support" \
        "$root/test/fuzz/$target.c" "$support/invariants.c" "$support/encoder.c" \
        "$support/reference_decoder.c" "$@" "$root"/lib/src/*.c -o "$build/$target"
    mkdir -p "$build/corpus_$target"
    status=0
    (cd "$build" && exec "./$target" -max_total_time="$seconds" -max_len=4096 \
        -print_final_stats=1 -verbosity=0 "corpus_$target") >"$build/$target.log" 2>&1 || status=$?
    grep -E 'stat::number_of_executed|ERROR|SUMMARY|Test unit' "$build/$target.log"
    [ "$status" -eq 0 ] || { echo "$target: found something, see $build/$target.log"; exit 1; }
}

mkdir -p "$build"
fuzz fuzz_parser "$support/reference_scans.c" "$support/random.c"
fuzz fuzz_driver "$root/test/fuzz/turning_lidar.c"
echo "nothing found"
