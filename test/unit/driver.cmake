# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# tmini_add_driver_tests(TEST … [NOT_ON MACHINE …]): the driver, told in words.
function(tmini_add_driver_tests)
    cmake_parse_arguments(PARSE_ARGV 0 arg "" "" "NOT_ON")
    foreach(test ${arg_UNPARSED_ARGUMENTS})
        tmini_add_unit_test(${test} LIBRARIES tmini_test_tale NOT_ON ${arg_NOT_ON})
        if(TARGET ${test})
            target_include_directories(${test} PRIVATE ${PROJECT_SOURCE_DIR}/lib/src)
        endif()
    endforeach()
endfunction()

tmini_add_driver_tests(test_tmini test_command test_blocking test_poll test_recovery test_wish)
# Tests with large rings; and one of many turns, which take half a minute there.
tmini_add_driver_tests(test_effort test_pauses test_monitor NOT_ON int16)

# What the driver asks of its port, in which order; the port is mocked.
tmini_add_unit_test(test_port_calls MOCKS ../support/port_functions.h)

# One module of the driver.
tmini_add_unit_test(test_line LIBRARIES tmini_test_rows NOT_ON int16)
if(TARGET test_line)
    target_include_directories(test_line PRIVATE ${PROJECT_SOURCE_DIR}/lib/src)
endif()

# tmini_add_driver_again(TEST DEFINITION …): the library is compiled again for it, with these.
file(GLOB library_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/lib/src/*.c)
function(tmini_add_driver_again test)
    tmini_add_unit_test(${test}
        SOURCES ${test}.c ../support/tale.c ../support/rig.c ../support/invariants.c
            ${library_sources}
        LIBRARIES tmini_test_rows tmini_test_receiver)
    if(TARGET ${test})
        target_compile_definitions(${test} PRIVATE ${ARGN})
        target_include_directories(${test} PRIVATE ../support ${PROJECT_SOURCE_DIR}/lib/src)
    endif()
endfunction()

# With an atomic header that calls the test at each access of an index.
set(interrupting TMINI_ATOMIC_HEADER="interrupting_atomic.h")
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    list(APPEND interrupting TMINI_WORD_ALIGNMENT=4u)
endif()
tmini_add_driver_again(test_interrupts ${interrupting})
tmini_add_driver_again(test_no_ct TMINI_NO_CT)
# With the effort of Arduino's AVR.
tmini_add_driver_again(test_small_effort ARDUINO_ARCH_AVR)
