# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Runs the unit tests on other, emulated machines. Each machine has a build of this same project,
# with a toolchain file, in a folder of its own inside the build folder. A test makes that build,
# the tests that need it follow. A machine whose compiler or emulator is missing is one skipped
# test.
#
# The same by hand:
#   cmake -B build-avr -DCMAKE_TOOLCHAIN_FILE=test/cmake/toolchains/avr-atmega2560.cmake
#   cmake --build build-avr && ctest --test-dir build-avr

# Adds the tests MACHINE.build and MACHINE.test_…; PROGRAMS are alternatives separated by "|".
function(tmini_add_machine machine)
    cmake_parse_arguments(arg "" "TOOLCHAIN;BUILD_TYPE" "PROGRAMS" ${ARGN})
    tmini_missing_programs(missing ${arg_PROGRAMS})
    if(missing)
        tmini_add_skipped_test(${machine} "not installed: ${missing}")
        return()
    endif()

    set(dir ${CMAKE_CURRENT_BINARY_DIR}/${machine})
    set(toolchain ${CMAKE_CURRENT_SOURCE_DIR}/cmake/toolchains/${arg_TOOLCHAIN})
    add_test(NAME ${machine}.build COMMAND ${CMAKE_COMMAND}
        -D SOURCE=${PROJECT_SOURCE_DIR} -D BUILD=${dir} -D TOOLCHAIN=${toolchain}
        -D BUILD_TYPE=${arg_BUILD_TYPE} -D CMOCK=${TMINI_CMOCK_DIR}
        -P ${CMAKE_CURRENT_SOURCE_DIR}/cmake/BuildMachine.cmake)
    set_tests_properties(${machine}.build PROPERTIES
        LABELS ${machine} FIXTURES_SETUP ${machine} TIMEOUT 1800)

    get_property(tests GLOBAL PROPERTY TMINI_UNIT_TESTS)
    foreach(test ${tests})
        tmini_add_test_on_machine(${test} ${machine} ${dir})
    endforeach()
endfunction()

# The other build's own ctest knows how to run its test, and when it has passed.
function(tmini_add_test_on_machine test machine dir)
    get_property(not_on GLOBAL PROPERTY TMINI_${test}_NOT_ON)
    if(machine IN_LIST not_on OR others IN_LIST not_on)
        return()
    endif()
    add_test(NAME ${machine}.${test} COMMAND ${CMAKE_COMMAND} -E chdir ${dir}
        ${CMAKE_CTEST_COMMAND} -R "^${test}$" --output-on-failure --no-tests=error)
    set_tests_properties(${machine}.${test} PROPERTIES
        LABELS ${machine} FIXTURES_REQUIRED ${machine} TIMEOUT 1800)
endfunction()

if(TMINI_TEST_MACHINES)
    tmini_add_machine(bigendian
        TOOLCHAIN powerpc-linux.cmake BUILD_TYPE RelWithDebInfo
        PROGRAMS powerpc-linux-gnu-gcc qemu-ppc|qemu-ppc-static)
    tmini_add_machine(int16
        TOOLCHAIN avr-atmega2560.cmake BUILD_TYPE MinSizeRel
        PROGRAMS avr-gcc simavr)
    foreach(processor cortex-m0 cortex-m4)
        tmini_add_machine(${processor}
            TOOLCHAIN ${processor}.cmake BUILD_TYPE MinSizeRel
            PROGRAMS arm-none-eabi-gcc qemu-system-arm)
    endforeach()
    tmini_add_machine(rv32imc
        TOOLCHAIN rv32imc.cmake BUILD_TYPE MinSizeRel
        PROGRAMS riscv64-unknown-elf-gcc qemu-system-riscv32)
endif()
