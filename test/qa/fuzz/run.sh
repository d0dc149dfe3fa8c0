#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Fuzzes the parser and the driver with libFuzzer under the address and undefined-behaviour
# sanitizers:
#
#   test/qa/fuzz/run.sh [SECONDS]      runs each target for this time (60 by default)
#   test/qa/fuzz/run.sh --keep         writes the collected inputs, minimised, to corpus_….txt
#   test/qa/fuzz/run.sh --coverage     prints how much of lib/ the inputs in corpus_….txt reach
#
# An input that fails is a file in build-fuzz/: give it to build-fuzz/fuzz_… to reproduce the
# failure. Collected inputs stay in build-fuzz/corpus_…, where the next run continues. The first run
# begins with those in corpus_….txt, one input per line, in base64.

set -eu

root=$(cd "$(dirname "$0")/../../.." && pwd)
support=$root/test/support
simulator=$root/test/simulator
build=$root/build-fuzz
compiler=${TMINI_FUZZ_CC:-clang}
action=${1:-60}

if ! echo 'int LLVMFuzzerTestOneInput(void) { return 0; }' |
    "$compiler" -x c -fsanitize=fuzzer,address - -o /dev/null 2>/dev/null; then
    echo "SKIPPED: $compiler cannot build fuzzers (packages clang, libclang-rt-…-dev)"
    exit 0
fi

# sources TARGET: prints its source files, one per line.
sources() {
    printf '%s\n' "$root/test/qa/fuzz/$1.c" "$support/invariants.c" "$support/encoder.c" \
        "$support/reference_decoder.c" "$root"/lib/src/*.c
    case $1 in
        fuzz_parser) printf '%s\n' "$support/reference_scans.c" "$support/random.c" ;;
        *) printf '%s\n' "$root/test/qa/fuzz/turning_lidar.c" "$support/random.c" \
            "$simulator"/sim*.c "$simulator/scene.c" ;;
    esac
}

# compile PROGRAM TARGET FLAG…: compiles the target to $build/PROGRAM.
compile() {
    program=$1
    target=$2
    shift 2
    sources "$target" | tr '\n' '\0' | xargs -0 "$compiler" -std=c99 -g -O1 -Wall -Wextra -Werror \
        "$@" -I"$root/lib/include" -I"$root/lib/src" -I"$support" \
        -I"$simulator" -o "$build/$program"
}

# unpack TARGET: writes the inputs in corpus_TARGET.txt to its corpus folder.
unpack() {
    mkdir -p "$build/corpus_$1"
    count=0
    while read -r line; do
        count=$((count + 1))
        echo "$line" | base64 -d >"$build/corpus_$1/kept_$count"
    done <"$root/test/qa/fuzz/corpus_$1.txt"
}

fuzz() {
    compile "$1" "$1" -fsanitize=fuzzer,address,undefined -fno-sanitize-recover=all
    unpack "$1"
    status=0
    (cd "$build" && exec "./$1" -max_total_time="$action" -max_len=4096 \
        -print_final_stats=1 -verbosity=0 "corpus_$1") >"$build/$1.log" 2>&1 || status=$?
    grep -E 'stat::number_of_executed|ERROR|SUMMARY|Test unit' "$build/$1.log"
    [ "$status" -eq 0 ] || { echo "$1: found something, see $build/$1.log"; exit 1; }
}

# keep TARGET: keeps the fewest inputs that reach all edges of the program that any reaches.
keep() {
    rm -rf "$build/kept"
    mkdir -p "$build/kept"
    (cd "$build" && "./$1" -set_cover_merge=1 -use_counters=0 -max_len=4096 kept "corpus_$1") \
        >"$build/$1.log" 2>&1 || { tail "$build/$1.log"; exit 1; }
    for input in "$build"/kept/*; do
        base64 -w 0 "$input"
        echo
    done >"$root/test/qa/fuzz/corpus_$1.txt"
    wc -lc "$root/test/qa/fuzz/corpus_$1.txt"
}

# cover TARGET: runs the kept inputs in a program with coverage counters, without sanitizers.
cover() {
    compile "cover_$1" "$1" -fsanitize=fuzzer -fprofile-instr-generate -fcoverage-mapping
    rm -rf "$build/corpus_$1"
    unpack "$1"
    LLVM_PROFILE_FILE=$build/$1.profraw "$build/cover_$1" "$build/corpus_$1"/* >"$build/$1.log" 2>&1
}

mkdir -p "$build"
case $action in
    --keep)
        keep fuzz_parser
        keep fuzz_driver
        ;;
    --coverage)
        cover fuzz_parser
        cover fuzz_driver
        llvm-profdata merge -o "$build/profile" "$build"/fuzz_*.profraw
        llvm-cov report "$build/cover_fuzz_driver" -object "$build/cover_fuzz_parser" \
            -instr-profile="$build/profile" "$root"/lib
        ;;
    *)
        fuzz fuzz_parser
        fuzz fuzz_driver
        echo "nothing found"
        ;;
esac
