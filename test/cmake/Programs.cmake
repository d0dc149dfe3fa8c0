# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# What tests need of this machine, and how a test says that it is not there.

find_program(TMINI_SH sh)
mark_as_advanced(TMINI_SH)

# Some containers have no pseudo-terminals: whether one can be opened shows by opening one.
if(UNIX AND NOT CMAKE_CROSSCOMPILING)
    include(CheckCSourceRuns)
    check_c_source_runs([[
        #define _XOPEN_SOURCE 700
        #include <fcntl.h>
        #include <stdlib.h>
        int main(void)
        {
            const int fd = posix_openpt(O_RDWR | O_NOCTTY);
            if (fd < 0 || grantpt(fd) != 0 || unlockpt(fd) != 0) {
                return 1;
            }
            return open(ptsname(fd), O_RDWR | O_NOCTTY) < 0;
        }
    ]] TMINI_HAS_PTY)
endif()

# Sets OUT to those of the given programs that are not installed.
function(tmini_missing_programs out)
    set(missing "")
    foreach(program ${ARGN})
        string(REPLACE "|" ";" names ${program})
        string(MAKE_C_IDENTIFIER "TMINI_PROGRAM_${program}" variable)
        find_program(${variable} NAMES ${names})
        mark_as_advanced(${variable})
        if(NOT ${variable})
            list(GET names 0 name)
            list(APPEND missing ${name})
        endif()
    endforeach()
    string(REPLACE ";" ", " missing "${missing}")
    set(${out} "${missing}" PARENT_SCOPE)
endfunction()

# A test that only tells why it does nothing.
function(tmini_add_skipped_test label reason)
    message(STATUS "Tests `${label}` are skipped: ${reason}")
    add_test(NAME ${label} COMMAND ${CMAKE_COMMAND} -E echo "SKIPPED: ${reason}")
    set_tests_properties(${label} PROPERTIES LABELS ${label} SKIP_REGULAR_EXPRESSION "^SKIPPED")
endfunction()
