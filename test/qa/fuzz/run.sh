#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Fuzzes parser, driver and scans with libFuzzer under the address and undefined-behaviour
# sanitizers:
#
#   test/qa/fuzz/run.sh [SECONDS]      runs each target for this time (60 by default)
#   test/qa/fuzz/run.sh --keep         writes the collected inputs, minimised, to corpus_….txt
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
action=${1:-60}

if ! echo 'int LLVMFuzzerTestOneInput(void) { return 0; }' |
    clang -x c -fsanitize=fuzzer,address - -o /dev/null 2>/dev/null; then
    echo "SKIPPED: clang cannot build fuzzers (packages clang, libclang-rt-…-dev)"
    exit 0
fi

# compile TARGET: to $build/TARGET.
compile() {
    target=$1
    case $target in
        fuzz_parser) set -- -DUNITY_INCLUDE_CONFIG_H -I"$unity" "$unity/unity.c" \
            "$support/receiver.c" "$support/reference_scans.c" ;;
        fuzz_scans) set -- '-DTMINI_ATOMIC_HEADER="interrupting_atomic.h"' "$system/bed.c" \
            "$system/watch.c" "$simulator"/sim*.c "$simulator/scene.c" "$simulator/link.c" ;;
        *) set -- ;;
    esac
    clang -std=c99 -g -O1 -Wall -Wextra -Werror -fsanitize=fuzzer,address,undefined \
        -fno-sanitize-recover=all -I"$root/lib/include" -I"$root/lib/src" -I"$support" \
        -I"$simulator" -I"$system" "$@" "$root/test/qa/fuzz/$target.c" "$root"/lib/src/*.c \
        "$support/invariants.c" "$support/encoder.c" "$support/reference_decoder.c" \
        "$support/random.c" -o "$build/$target"
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
    compile "$1"
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

mkdir -p "$build"
each=fuzz
[ "$action" != --keep ] || each=keep
for one in fuzz_parser fuzz_driver fuzz_scans; do
    "$each" "$one"
done
