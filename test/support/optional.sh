# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors
# shellcheck shell=sh
# shellcheck disable=SC2154 # $root is the sourcing script's

# Optional tools for the long run of the tests: compilers, emulators, a browser, a model checker.
# To be sourced after environment.sh.

# shellcheck source=test/support/python.sh
. "$root/test/support/python.sh"

# Clang's fuzzing runtime is in a package that is named for Clang's version.
wish_for_fuzzer() {
    version=$(apt-cache depends clang 2>/dev/null | sed -n 's/.*Depends: clang-\([0-9]*\)$/\1/p')
    [ -z "$version" ] || wish "/usr/share/doc/libclang-rt-$version-dev" "libclang-rt-$version-dev"
}

# Not every system has a package of the model checker; the one for Debian 12 is fetched below.
wish_for_checker() {
    ! apt-cache show --no-all-versions cbmc >/dev/null 2>&1 || wish cbmc cbmc
}

fetch_checker() {
    is_present cbmc || "$root/test/qa/proof/run.sh" --fetch ||
        echo "CBMC could not be fetched (why: above): its proofs are skipped."
}

# The viewer is compiled by Clang, linked by lld, and tested in a browser.
wish_for_browser() {
    wish wasm-ld lld
    is_present google-chrome || wish chromium chromium
    wish chromedriver chromium-driver
    wish /usr/lib/python3/dist-packages/selenium python3-selenium
}

wish_for_machines() {
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
    wish /usr/include/simavr/sim_avr.h libsimavr-dev
    wish /usr/share/arduino/hardware/arduino/avr arduino-core-avr
    wish arduino-builder arduino-builder
    wish arduino-ctags arduino-ctags
    wish powerpc-linux-gnu-gcc gcc-powerpc-linux-gnu
    wish /usr/powerpc-linux-gnu/include/stdio.h libc6-dev-powerpc-cross
    wish qemu-system-riscv32 qemu-system-misc
    is_present qemu-ppc-static || wish qemu-ppc qemu-user
    wish valgrind valgrind
}

wish_for_documents() {
    wish doxygen doxygen
    wish shellcheck shellcheck
    wish dtc device-tree-compiler
    wish hunspell hunspell
    wish /usr/share/hunspell/en_GB.dic hunspell-en-gb
    wish codespell codespell
}

wish_for_everything() {
    because "to fuzz, to prove and to look for races"
    wish clang clang
    wish_for_fuzzer
    wish_for_checker
    finders="$finders wish_for_fuzzer wish_for_checker"
    because "to test the viewer in a browser"
    wish_for_browser
    because "to compile for other machines, and to emulate them"
    wish_for_machines
    because "for the checks that are written in Python"
    wish_for_python
    because "to check the documents"
    wish_for_documents
}

# Tools that are not packages of the system.
prepare_everything() {
    prepare_python_packages "$root/build/labwired" "$root/test/target/esp32c3/requirements.txt"
    prepare_python_packages "$root/build/platformio" \
        "$root/test/consumer/platformio/requirements.txt"
    prepare_python_packages "$root/build/esp-idf-packer" "$root/test/qa/release/requirements.txt"
    prepare_python_packages "$root/build/axe" "$root/test/web/requirements.txt"
    prepare_python_packages "$root/build/pymavlink" "$root/test/mavlink/requirements.txt"
    fetch_checker
}
