# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Finds the programs that tests need, and declares tests: those that run a command, and those that
# are skipped because a program is missing.

find_program(TMINI_SH sh)
mark_as_advanced(TMINI_SH)

# Some containers have no pseudo-terminals: try to open one.
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

# A target `tests-LABEL` builds what the tests of that label need; `tests` builds what the short run
# needs, and `tests-all` everything.
add_custom_target(tests)
add_custom_target(tests-all)
add_dependencies(tests-all tests)

# tmini_label_needs(LABEL TIER TARGET …), TIER being `tests` or `tests-all`.
function(tmini_label_needs label tier)
    if(NOT TARGET tests-${label})
        add_custom_target(tests-${label})
    endif()
    if(ARGN)
        add_dependencies(tests-${label} ${ARGN})
        add_dependencies(${tier} ${ARGN})
    endif()
endfunction()

# tmini_add_check(NAME LABEL
#     COMMAND program argument …
#     [ALL]               only in the long run, `ctest -C All`
#     [NEEDS target …]    to be built before
#     [TIMEOUT seconds]   300 unless given
#     [PROPERTIES name value …]
# )
#
# Adds a ctest. Its command reports with exit status 77, or with a line that begins with SKIPPED,
# that something is not installed.
function(tmini_add_check name label)
    cmake_parse_arguments(arg "ALL" "TIMEOUT" "COMMAND;NEEDS;PROPERTIES" ${ARGN})
    if(arg_UNPARSED_ARGUMENTS OR NOT arg_COMMAND)
        message(FATAL_ERROR "tmini_add_check(${name}): needs COMMAND; "
            "not understood: ${arg_UNPARSED_ARGUMENTS}")
    endif()
    if(NOT arg_TIMEOUT)
        set(arg_TIMEOUT 300)
    endif()
    set(tier tests)
    set(configurations "")
    if(arg_ALL)
        set(tier tests-all)
        set(configurations CONFIGURATIONS All)
    endif()
    add_test(NAME ${name} COMMAND ${arg_COMMAND} ${configurations})
    set_tests_properties(${name} PROPERTIES LABELS ${label} TIMEOUT ${arg_TIMEOUT}
        SKIP_RETURN_CODE 77 SKIP_REGULAR_EXPRESSION "^SKIPPED" ${arg_PROPERTIES})
    tmini_label_needs(${label} ${tier} ${arg_NEEDS})
endfunction()

# tmini_add_skipped_test(NAME LABEL REASON [ALL]): adds a test that only reports why it is skipped.
function(tmini_add_skipped_test name label reason)
    message(STATUS "Not tested: ${name}: ${reason}")
    tmini_add_check(${name} ${label} ${ARGN} COMMAND ${CMAKE_COMMAND} -E echo "SKIPPED: ${reason}")
endfunction()

# If one of the programs is not installed, the test NAME of the long run is skipped, and the calling
# function or file ends.
macro(tmini_need_programs name label)
    tmini_missing_programs(missing ${ARGN})
    if(missing)
        tmini_add_skipped_test(${name} ${label} "not installed: ${missing}" ALL)
        return()
    endif()
endmacro()

# Sets the cache variable to a Python that has these modules. `python3` may be one of the user's own
# without them, beside the system's. If there is none, VARIABLE_MISSING says so.
function(tmini_find_python variable modules)
    set(${variable}_MISSING "" PARENT_SCOPE)
    foreach(candidate ${${variable}} /usr/bin/python3 python3)
        execute_process(COMMAND ${candidate} -c "import ${modules}"
            RESULT_VARIABLE status OUTPUT_QUIET ERROR_QUIET)
        if(status EQUAL 0)
            set(${variable} ${candidate} CACHE STRING "A Python with ${modules}" FORCE)
            return()
        endif()
    endforeach()
    set(${variable}_MISSING "no Python with ${modules} is installed" PARENT_SCOPE)
endfunction()

tmini_find_python(TMINI_PYTEST "pytest, pexpect, pyte")

# tmini_add_pytest(NAME LABEL FILE
#     [ALL] [TIMEOUT seconds] [NEEDS target …]     as for tmini_add_check()
#     [ENVIRONMENT name=value …]
# )
#
# Adds a file of tests in Python. Each leaves its files in the folder NAME.work.
function(tmini_add_pytest name label file)
    cmake_parse_arguments(arg "ALL" "TIMEOUT" "NEEDS;ENVIRONMENT" ${ARGN})
    set(all "")
    if(arg_ALL)
        set(all ALL)
    endif()
    if(TMINI_PYTEST_MISSING)
        tmini_add_skipped_test(${name} ${label} ${TMINI_PYTEST_MISSING} ${all})
        return()
    endif()
    tmini_add_check(${name} ${label} ${all} TIMEOUT "${arg_TIMEOUT}" NEEDS ${arg_NEEDS}
        COMMAND ${TMINI_PYTEST} -B -m pytest -q -p no:cacheprovider
            --basetemp=${CMAKE_CURRENT_BINARY_DIR}/${name}.work ${CMAKE_CURRENT_SOURCE_DIR}/${file})
    set_tests_properties(${name} PROPERTIES ENVIRONMENT "${arg_ENVIRONMENT}")
endfunction()
