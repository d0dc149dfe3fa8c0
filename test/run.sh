#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Installs what the tests need, builds in build/ and runs all tests:
#
#   test/run.sh [ctest's options …]        for example: test/run.sh -L unit
#
# Emulated machines and their compilers are installed where the system has them; what is missing is
# skipped and said. TMINI_OPTIONAL=no installs none of them.

set -eu

root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=test/support/environment.sh
. "$root/test/support/environment.sh"
# shellcheck source=test/support/labwired.sh
. "$root/test/support/labwired.sh"

# Clang's fuzzing runtime is in a package that is named for Clang's version.
wish_for_fuzzer() {
    version=$(apt-cache depends clang 2>/dev/null | sed -n 's/.*Depends: clang-\([0-9]*\)$/\1/p')
    [ -z "$version" ] || wish "/usr/share/doc/libclang-rt-$version-dev" "libclang-rt-$version-dev"
}

# Compilers and emulators for the checks labelled compile, and for the tests on other machines.
wish_for_machines() {
    wish clang clang
    wish_for_fuzzer
    wish g++ g++
    wish arm-none-eabi-gcc gcc-arm-none-eabi
    wish qemu-system-arm qemu-system-arm
    wish python3 python3
    wish /usr/lib/arm-none-eabi/newlib libnewlib-arm-none-eabi
    wish riscv64-unknown-elf-gcc gcc-riscv64-unknown-elf
    wish /usr/lib/picolibc/riscv64-unknown-elf picolibc-riscv64-unknown-elf
    wish avr-gcc gcc-avr
    wish /usr/lib/avr/include/avr/io.h avr-libc
    wish simavr simavr
    wish /usr/share/arduino/hardware/arduino/avr arduino-core-avr
    wish powerpc-linux-gnu-gcc gcc-powerpc-linux-gnu
    wish /usr/powerpc-linux-gnu/include/stdio.h libc6-dev-powerpc-cross
    wish qemu-system-riscv32 qemu-system-misc
    wish_for_labwired
    is_present qemu-ppc-static || wish qemu-ppc qemu-user
    wish valgrind valgrind
    python3 -c 'import ensurepip' 2>/dev/null || wish python3-venv python3-venv
}

need_test_tools
[ "${TMINI_OPTIONAL:-yes}" = no ] || wish_for_machines
install_tools
[ "${TMINI_OPTIONAL:-yes}" = no ] || prepare_labwired "$root/build/labwired"

# What goes well before the tests is not worth reading.
echo "Building in $root/build"
quietly cmake -S "$root" -B "$root/build" -DTMINI_BUILD_TESTS=ON -DTMINI_BUILD_EXAMPLES=ON
quietly cmake --build "$root/build" --parallel "$(job_count)"

cd "$root/build"
exec ctest --output-on-failure --no-tests=error --parallel "$(job_count)" "$@"
