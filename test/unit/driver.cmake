# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# The driver, on a mocked port.
foreach(test test_tmini test_command test_states test_watch test_blocking)
    tmini_add_unit_test(${test}
        SOURCES ${test}.c ../support/rig.c
        MOCKS ../support/port_functions.h
        LIBRARIES tmini_test_support
        )
endforeach()
