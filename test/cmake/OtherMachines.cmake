# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Runs the library's unit tests on other, emulated machines. A port's tests also run on a machine
# whose toolchain file names the port in TMINI_TEST_PORTS. Each machine is one test, which builds
# this project for that machine in a separate folder and runs the tests of that build. The test is
# skipped if the machine's compiler or emulator is missing.
#
# To do the same by hand:
#   cmake -B build-avr -DTMINI_BUILD_TESTS=ON \
#       -DCMAKE_TOOLCHAIN_FILE=test/cmake/toolchains/avr-atmega2560.cmake
#   cmake --build build-avr && ctest --test-dir build-avr

# tmini_add_machine(MACHINE TOOLCHAIN BUILD_TYPE PROGRAM …). A program may be a list of alternatives
# separated by "|". A high COST makes ctest start these long tests first.
function(tmini_add_machine machine toolchain build_type)
    tmini_need_programs(${machine} ${machine} ${ARGN})
    tmini_add_check(${machine} ${machine} ALL TIMEOUT 1800
        COMMAND ${CMAKE_CTEST_COMMAND} --build-and-test
            ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_BINARY_DIR}/${machine}
            --build-generator ${CMAKE_GENERATOR} --build-noclean --build-target tests
            --build-options -DTMINI_BUILD_TESTS=ON -DTMINI_BUILD_EXAMPLES=OFF
            -DCMAKE_TOOLCHAIN_FILE=${PROJECT_SOURCE_DIR}/test/cmake/toolchains/${toolchain}.cmake
            -DCMAKE_BUILD_TYPE=${build_type} -DCMOCK_ROOT=${TMINI_CMOCK_DIR}
            --test-command ${CMAKE_CTEST_COMMAND} --output-on-failure --no-tests=error
        PROPERTIES COST 100)
endfunction()

tmini_add_machine(bigendian powerpc-linux RelWithDebInfo
    powerpc-linux-gnu-gcc qemu-ppc|qemu-ppc-static)
tmini_add_machine(int16 avr-atmega2560 MinSizeRel avr-gcc simavr)
tmini_add_machine(cortex-m4 cortex-m4 MinSizeRel arm-none-eabi-gcc qemu-system-arm)
tmini_add_machine(cortex-m0 cortex-m0 MinSizeRel arm-none-eabi-gcc qemu-system-arm)
tmini_add_machine(rv32imc rv32imc MinSizeRel riscv64-unknown-elf-gcc qemu-system-riscv32)
