#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Compiles every source and every public header of the library for one target:
#
#   test/compile.sh gcc|clang|c++|cortex-m0|avr|rv32imc|xtensa|powerpc
#   test/compile.sh clang-cortex-m0|clang-cortex-m0plus|clang-rv32imc
#
# as freestanding C99 with strict warnings as errors; `c++` compiles the headers as C++11 and C++17.
# clang-… also links a program that uses everything: with the C library and GCC's, nothing else.
# Exit status: 0 clean, 1 not clean, 2 wrong usage, 77 the compiler is not installed.

set -eu

lib=$(cd "$(dirname "$0")/../lib" && pwd)
# shellcheck source=test/support/compilers.sh
. "$lib/../test/support/compilers.sh"
warnings="-pedantic -Wall -Wextra -Wconversion -Wsign-conversion -Wshadow -Wundef -Werror"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# compile LANGUAGE FILE COMPILER FLAG…
compile() {
    language=$1 file=$2
    shift 2
    # shellcheck disable=SC2086 # the warnings are several words
    "$@" $warnings -ffreestanding -I "$lib/include" -x "$language" -c "$file" -o "$work/out.o"
}

# check_sources COMPILER FLAG…
check_sources() {
    for source in "$lib"/src/*.c; do
        compile c "$source" "$@"
    done
}

# check_headers LANGUAGE COMPILER FLAG…: each one alone, and twice, which shows missing guards. In
# C++ the user's namespace may have the library's name.
check_headers() {
    language=$1 rest='extern int not_empty;'
    shift
    [ "$language" = c ] || rest='namespace tmini { extern int not_empty; }'
    for header in "$lib"/include/tmini/*.h "$lib"/include/tmini/parts/*.h; do
        include="#include \"${header#"$lib"/include/}\""
        printf '%s\n%s\n%s\n' "$include" "$include" "$rest" >"$work/includer"
        compile "$language" "$work/includer" "$@"
    done
}

# check_c COMPILER FLAG…
check_c() {
    need_compiler "$@"
    check_sources "$@" -std=c99
    check_headers c "$@" -std=c99
}

# check_clang "GCC FLAG…" CLANG_FLAG…: the C library and the linker are GCC's.
check_clang() {
    gcc=$1
    shift
    # shellcheck disable=SC2086 # a command of several words
    need_compiler $gcc
    # shellcheck disable=SC2086
    set -- clang "$@" -Os -isystem "$(headers_of $gcc)"
    check_c "$@"
    bench=$lib/../test/qa/bench
    for source in "$lib"/src/*.c "$bench/emulated/main.c"; do
        "$@" -std=c99 -I "$lib/include" -c "$source" -o "$work/$(basename "$source").o"
    done
    # shellcheck disable=SC2086
    $gcc -nostartfiles -Wl,--entry=0 -T "$bench/program.ld" "$work"/*.c.o -o "$work/program"
}

check_cxx() {
    need_compiler g++ -x c++
    check_headers c++ g++ -std=c++11
    check_headers c++ g++ -std=c++17
}

case ${1:-} in
    gcc) check_c gcc ;;
    clang) check_c clang ;;
    c++) check_cxx ;;
    cortex-m0) check_c arm-none-eabi-gcc -mcpu=cortex-m0 -mthumb -Os ;;
    clang-cortex-m0 | clang-cortex-m0plus)
        cpu=${1#clang-}
        check_clang "arm-none-eabi-gcc --specs=nano.specs -mthumb -mcpu=$cpu" \
            --target=armv6m-none-eabi "-mcpu=$cpu"
        ;;
    clang-rv32imc)
        check_clang "riscv64-unknown-elf-gcc --specs=picolibc.specs -march=rv32imc -mabi=ilp32" \
            --target=riscv32-unknown-elf -march=rv32imc -mabi=ilp32
        ;;
    avr) check_c avr-gcc -mmcu=atmega2560 -Os ;;
    rv32imc)
        check_c riscv64-unknown-elf-gcc --specs=picolibc.specs -march=rv32imc -mabi=ilp32 -Os
        ;;
    xtensa)
        # Debian's folders of this C library's headers, where the compiler does not look by itself.
        check_c xtensa-lx106-elf-gcc -mlongcalls -isystem /usr/lib/xtensa-lx106-elf/include \
            -isystem /usr/lib/picolibc/xtensa-lx106-elf/include -Os
        ;;
    powerpc) check_c powerpc-linux-gnu-gcc -O2 ;;
    *)
        sed -n '5,12s/^# \{0,1\}//p' "$0" >&2
        exit 2
        ;;
esac
echo "compiled clean: $1"
