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
# shellcheck source=test/support/python.sh
. "$root/test/support/python.sh"

# Clang's fuzzing runtime is in a package that is named for Clang's version.
wish_for_fuzzer() {
    version=$(apt-cache depends clang 2>/dev/null | sed -n 's/.*Depends: clang-\([0-9]*\)$/\1/p')
    [ -z "$version" ] || wish "/usr/share/doc/libclang-rt-$version-dev" "libclang-rt-$version-dev"
}

# The model checker is not in all systems' packages; that for Debian 12 is fetched below.
wish_for_checker() {
    ! apt-cache show --no-all-versions cbmc >/dev/null 2>&1 || wish cbmc cbmc
}

fetch_checker() {
    is_present cbmc || "$root/test/proof/run.sh" --fetch ||
        echo "CBMC could not be fetched (why: above): its proofs are skipped."
}

# The viewer is compiled by Clang, linked by lld, and tried out in a browser.
wish_for_browser() {
    wish wasm-ld lld
    is_present google-chrome || wish chromium chromium
    wish chromedriver chromium-driver
}

# Compilers and emulators for the checks labelled compile, and for the tests on other machines.
wish_for_machines() {
    wish clang clang
    wish_for_fuzzer
    wish_for_checker
    wish_for_browser
    wish g++ g++
    wish arm-none-eabi-gcc gcc-arm-none-eabi
    wish qemu-system-arm qemu-system-arm
    wish /usr/lib/arm-none-eabi/newlib libnewlib-arm-none-eabi
    wish riscv64-unknown-elf-gcc gcc-riscv64-unknown-elf
    wish /usr/lib/picolibc/riscv64-unknown-elf picolibc-riscv64-unknown-elf
    wish xtensa-lx106-elf-gcc gcc-xtensa-lx106
    wish /usr/share/doc/picolibc-xtensa-lx106-elf picolibc-xtensa-lx106-elf
    [ -n "${PICO_SDK_PATH:-}" ] || wish /usr/src/pico-sdk/pico_sdk_init.cmake pico-sdk-source
    wish avr-gcc gcc-avr
    wish /usr/lib/avr/include/avr/io.h avr-libc
    wish simavr simavr
    wish /usr/share/arduino/hardware/arduino/avr arduino-core-avr
    wish arduino-builder arduino-builder
    wish arduino-ctags arduino-ctags
    wish powerpc-linux-gnu-gcc gcc-powerpc-linux-gnu
    wish /usr/powerpc-linux-gnu/include/stdio.h libc6-dev-powerpc-cross
    wish qemu-system-riscv32 qemu-system-misc
    wish_for_python
    is_present qemu-ppc-static || wish qemu-ppc qemu-user
    wish valgrind valgrind
}

# What the documents are checked with.
wish_for_documents() {
    wish doxygen doxygen
    wish shellcheck shellcheck
    wish dtc device-tree-compiler
    wish hunspell hunspell
    wish /usr/share/hunspell/en_GB.dic hunspell-en-gb
    wish codespell codespell
}

prepare_python_tools() {
    # shellcheck disable=SC2086 # the packages are several words
    prepare_python_packages "$root/build/labwired" $labwired_packages
    # shellcheck disable=SC2086
    prepare_python_packages "$root/build/platformio" $platformio_packages
    # shellcheck disable=SC2086
    prepare_python_packages "$root/build/esp-idf-packer" $component_packages
}

need_test_tools
need_drawing
[ "${TMINI_OPTIONAL:-yes}" = no ] || wish_for_machines
[ "${TMINI_OPTIONAL:-yes}" = no ] || wish_for_documents
install_tools
[ "${TMINI_OPTIONAL:-yes}" = no ] || prepare_python_tools
[ "${TMINI_OPTIONAL:-yes}" = no ] || fetch_checker

# What goes well before the tests is not worth reading.
echo "Building in $root/build"
quietly cmake -S "$root" -B "$root/build" -DTMINI_BUILD_TESTS=ON \
    -DTMINI_BUILD_EXAMPLES=ON -DTMINI_WERROR=ON -DCMAKE_EXPORT_COMPILE_COMMANDS=ON
quietly cmake --build "$root/build" --parallel "$(job_count)"

cd "$root/build"
exec ctest --output-on-failure --no-tests=error --parallel "$(job_count)" "$@"
