#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Compiles the ports with the stand-ins for their platforms:
#
#   compile.sh headers                   each header alone, as C99 and as C++11, by GCC and Clang
#   compile.sh sketches                  each Arduino sketch, as on several boards
#   compile.sh esp32-xtensa|esp32-riscv|esp32-clang|cortex-m4-clang
#
# Xtensa by Debian's compiler for the ESP8266, the nearest one available.
# Exit status: 0 clean, 1 not clean, 2 wrong usage, 77 the compiler is not installed.

set -eu

here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
# shellcheck source=test/support/compilers.sh
. "$root/test/support/compilers.sh"
warnings="-Wall -Wextra -Wconversion -Wsign-conversion -Wshadow -Werror"

# stand_in PORT: prints the options with which the port finds its platform.
stand_in() {
    case $1 in
        esp32) echo "-isystem $here/esp32/esp_idf" ;;
        freertos) echo "-isystem $here/freertos/kernel_stub" ;;
        pico) echo "-isystem $here/pico/sdk_stub -D_DEFAULT_SOURCE" ;;
        posix) echo "-D_DEFAULT_SOURCE" ;;
        stm32) echo "-isystem $here/stm32/stm32_model -isystem $root/test/support" ;;
        zephyr) echo "-isystem $here/zephyr/zephyr_stub -DZEPHYR_ASYNC" ;;
    esac
}

# check_header HEADER COMPILER…: tmini_stm32_usart_common.h is a part of two sources, and
# tmini_atomic_cortex_m.h needs the intrinsics of the compilers that it is for.
check_header() {
    header=$1 port=$(basename "$(dirname "$1")")
    shift
    case $header in
        */arduino/* | *_usart_common.h | *_atomic_cortex_m.h) return ;;
    esac
    # shellcheck disable=SC2046 # several options
    printf '#include "%s"\n#include "%s"\nextern int not_empty;\n' "$header" "$header" |
        "$@" -pedantic -Wall -Wextra -Werror -fsyntax-only -I "$root/lib/include" \
            $(stand_in "$port") -I "$(dirname "$header")" -
}

# What can fail says so: port/README.md.
check_results() {
    ! grep -nE '^void tmini_[a-z0-9_]+_(init|start|start_[a-z]+)\(' "$root"/port/*/*.h |
        grep -v tmini_posix_init
}

check_headers() {
    check_results
    need_compiler cc
    need_compiler c++ -x c++
    for header in "$root"/port/*/*.h; do
        check_header "$header" cc -std=c99 -x c
        check_header "$header" c++ -std=c++11 -x c++
        if command -v clang++ >/dev/null; then
            check_header "$header" clang -std=c99 -x c
            check_header "$header" clang++ -std=c++11 -x c++
        fi
    done
}

# check_sketch SKETCH NAME=VALUE…
check_sketch() {
    sketch=$1
    shift
    echo "$sketch $*"
    # shellcheck disable=SC2046 # one option for each name
    printf '#include <Arduino.h>\n#include "%s"\n' "$sketch" |
        c++ -std=c++11 -Wall -Wextra -Werror -fsyntax-only -I "$root/lib/include" \
            -I "$root/port/arduino" -I "$here/arduino/arduino_stub" \
            $(printf -- '-D%s ' ARDUINO=10819 "$@") -x c++ -
}

check_sketches() {
    need_compiler c++ -x c++
    for sketch in "$root"/examples/esp32_arduino/*/*.ino; do
        check_sketch "$sketch"
        check_sketch "$sketch" ARDUINO_ARCH_RP2040
        check_sketch "$sketch" CORE_TEENSY __IMXRT1062__
        for chip in ESP32 ESP32S3 ESP32C3; do
            # A C3 has no third serial port.
            case $sketch$chip in *TwoLidars.inoESP32C3) continue ;; esac
            check_sketch "$sketch" ESP32 "CONFIG_IDF_TARGET_$chip=1"
        done
    done
}

# check_ports "PORT…" COMPILER…
check_ports() {
    ports=$1
    shift
    need_compiler "$@"
    for port in $ports; do
        for source in "$root/port/$port"/*.c; do
            # shellcheck disable=SC2046,SC2086 # several options
            "$@" -Os $warnings -I "$root/lib/include" -I "$root/port/$port" $(stand_in "$port") \
                -c "$source" -o /dev/null
        done
    done
}

picolibc="riscv64-unknown-elf-gcc --specs=picolibc.specs"
case ${1:-} in
    headers) check_headers ;;
    sketches) check_sketches ;;
    esp32-xtensa)
        # The compiler does not search Debian's folders of the C library's headers by default.
        check_ports esp32 xtensa-lx106-elf-gcc -mlongcalls -std=gnu17 -DMODEL_ESP32 \
            -isystem /usr/lib/xtensa-lx106-elf/include \
            -isystem /usr/lib/picolibc/xtensa-lx106-elf/include
        ;;
    esp32-riscv)
        # shellcheck disable=SC2086
        check_ports esp32 $picolibc -march=rv32imac -mabi=ilp32 -std=gnu17
        ;;
    esp32-clang)
        # shellcheck disable=SC2086
        check_ports esp32 clang --target=riscv32-unknown-elf -march=rv32imc -mabi=ilp32 -std=gnu17 \
            -isystem "$(headers_of $picolibc)"
        ;;
    cortex-m4-clang)
        check_ports "freertos pico stm32 template zephyr" clang --target=thumbv7em-none-eabi \
            -mcpu=cortex-m4 -std=c99 -isystem "$(headers_of arm-none-eabi-gcc -mcpu=cortex-m4)"
        ;;
    *)
        sed -n '5,13s/^# \{0,1\}//p' "$0" >&2
        exit 2
        ;;
esac
echo "compiled clean: $1"
