#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Fuzzes parser, driver and scans with libFuzzer under the address and undefined-behaviour
# sanitizers:
#
#   test/qa/fuzz/run.sh [SECONDS]      runs each target for this time (60 by default)
#   test/qa/fuzz/run.sh --keep         writes the collected inputs, minimised, to corpus_….txt
#   test/qa/fuzz/run.sh --coverage     prints how much of lib/ the inputs in corpus_….txt reach
#
# An input that fails is a file in build-fuzz/: give it to build-fuzz/fuzz_… to reproduce the
# failure. Collected inputs stay in build-fuzz/corpus_…, where the next run continues. The first run
# begins with those in corpus_….txt, each a word in base64.

set -eu

root=$(cd "$(dirname "$0")/../../.." && pwd)
support=$root/test/support
simulator=$root/test/simulator
system=$root/test/system
unity=${TMINI_UNITY_DIR:-/usr/share/cmock/vendor/unity}/src
build=$root/build-fuzz
compiler=${TMINI_FUZZ_CC:-clang}
action=${1:-60}

if ! echo 'int LLVMFuzzerTestOneInput(void) { return 0; }' |
    "$compiler" -x c -fsanitize=fuzzer,address - -o /dev/null 2>/dev/null; then
    echo "SKIPPED: $compiler cannot build fuzzers (packages clang, libclang-rt-…-dev)"
    exit 0
fi

targets="fuzz_parser fuzz_driver fuzz_scans"

# sources TARGET: prints its source files, one per line.
sources() {
    printf '%s\n' "$root/test/qa/fuzz/$1.c" "$support/invariants.c" "$support/encoder.c" \
        "$support/reference_decoder.c" "$support/random.c" "$root"/lib/src/*.c
    case $1 in
        fuzz_parser) printf '%s\n' "$support/receiver.c" "$support/reference_scans.c" \
            "$unity/unity.c" ;;
        fuzz_scans) printf '%s\n' "$system/bed.c" "$system/watch.c" "$simulator"/sim*.c \
            "$simulator/scene.c" "$simulator/link.c" ;;
    esac
}

# compile PROGRAM TARGET FLAG…: compiles the target to $build/PROGRAM.
compile() {
    program=$1
    target=$2
    shift 2
    case $target in
        fuzz_parser) set -- -DUNITY_INCLUDE_CONFIG_H -I"$unity" "$@" ;;
        fuzz_scans) set -- '-DTMINI_ATOMIC_HEADER="interrupting_atomic.h"' "$@" ;;
    esac
    sources "$target" | tr '\n' '\0' | xargs -0 "$compiler" -std=c99 -g -O1 -Wall -Wextra -Werror \
        "$@" -I"$root/lib/include" -I"$root/lib/src" -I"$support" -I"$simulator" -I"$system" \
        -o "$build/$program"
}

# unpack TARGET: writes the inputs in corpus_TARGET.txt to its corpus folder.
unpack() {
    mkdir -p "$build/corpus_$1"
    count=0
    # shellcheck disable=SC2013 # words, not lines
    for word in $(cat "$root/test/qa/fuzz/corpus_$1.txt"); do
        count=$((count + 1))
        echo "$word" | base64 -d >"$build/corpus_$1/kept_$count"
    done
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
    done | fmt -w 100 >"$root/test/qa/fuzz/corpus_$1.txt"
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
    --keep) each=keep ;;
    --coverage) each=cover ;;
    *) each=fuzz ;;
esac
for target in $targets; do
    "$each" "$target"
done
if [ "$each" = cover ]; then
    llvm-profdata merge -o "$build/profile" "$build"/fuzz_*.profraw
    llvm-cov report "$build/cover_fuzz_driver" -object "$build/cover_fuzz_parser" \
        -object "$build/cover_fuzz_scans" -instr-profile="$build/profile" "$root"/lib
fi
