# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# tmini_add_driver_tests(TEST … [NOT_ON MACHINE …]): the driver, told in words.
function(tmini_add_driver_tests)
    cmake_parse_arguments(PARSE_ARGV 0 arg "" "" "NOT_ON")
    foreach(test ${arg_UNPARSED_ARGUMENTS})
        tmini_add_unit_test(${test} SOURCES ${test}.c LIBRARIES tmini_test_tale
            NOT_ON ${arg_NOT_ON})
        if(TARGET ${test})
            target_include_directories(${test} PRIVATE ${PROJECT_SOURCE_DIR}/lib/src)
        endif()
    endforeach()
endfunction()

tmini_add_driver_tests(test_tmini test_command test_blocking test_poll test_recovery test_wish)
# Tests with large rings; and one of many turns, which take half a minute there.
tmini_add_driver_tests(test_effort test_pauses test_monitor NOT_ON int16)

# What the driver asks of its port, in which order; the port is mocked.
tmini_add_unit_test(test_port_calls SOURCES test_port_calls.c MOCKS ../support/port_functions.h)

# One module of the driver.
tmini_add_unit_test(test_line SOURCES test_line.c LIBRARIES tmini_test_rows NOT_ON int16)
if(TARGET test_line)
    target_include_directories(test_line PRIVATE ${PROJECT_SOURCE_DIR}/lib/src)
endif()

# The library is compiled again here, with an atomic header that calls the test at each access of an
# index.
file(GLOB library_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/lib/src/*.c)
tmini_add_unit_test(test_interrupts
    SOURCES test_interrupts.c ../support/tale.c ../support/rig.c ../support/invariants.c
        ${library_sources}
    LIBRARIES tmini_test_rows tmini_test_receiver)
if(TARGET test_interrupts)
    if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
        target_compile_definitions(test_interrupts PRIVATE TMINI_WORD_ALIGNMENT=4u)
    endif()
    target_compile_definitions(test_interrupts
        PRIVATE TMINI_ATOMIC_HEADER="interrupting_atomic.h")
    target_include_directories(test_interrupts PRIVATE ../support ${PROJECT_SOURCE_DIR}/lib/src)
endif()

# The library is compiled again without CT information.
tmini_add_unit_test(test_no_ct
    SOURCES test_no_ct.c ../support/tale.c ../support/rig.c ../support/invariants.c
        ${library_sources}
    LIBRARIES tmini_test_rows tmini_test_support NOT_ON int16)
if(TARGET test_no_ct)
    target_compile_definitions(test_no_ct PRIVATE TMINI_NO_CT)
    target_include_directories(test_no_ct PRIVATE ${PROJECT_SOURCE_DIR}/lib/src)
endif()

# The library is compiled again with the effort of Arduino's AVR.
tmini_add_unit_test(test_small_effort
    SOURCES test_small_effort.c ../support/tale.c ../support/rig.c ../support/invariants.c
        ${library_sources}
    LIBRARIES tmini_test_rows tmini_test_support NOT_ON int16)
if(TARGET test_small_effort)
    target_compile_definitions(test_small_effort PRIVATE ARDUINO_ARCH_AVR)
    target_include_directories(test_small_effort PRIVATE ${PROJECT_SOURCE_DIR}/lib/src)
endif()
