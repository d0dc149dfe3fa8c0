# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# The common part of the consumers' scripts, which define TMINI_SOURCE, COMPILER and GENERATOR.

# Flags from the environment could be mistaken for ours.
unset(ENV{CFLAGS})

function(run_or_fail)
    execute_process(COMMAND ${ARGN} RESULT_VARIABLE status)
    if(NOT status EQUAL 0)
        string(REPLACE ";" " " command "${ARGN}")
        message(FATAL_ERROR "failed: ${command}")
    endif()
endfunction()

# install_project(BUILD PREFIX TOOL OPTION…): builds the library in BUILD, also the programs if TOOL
# is ON, and installs them in PREFIX.
function(install_project build prefix tool)
    run_or_fail(${CMAKE_COMMAND} -S ${TMINI_SOURCE} -B ${build} -G ${GENERATOR}
        -DCMAKE_C_COMPILER=${COMPILER} -DCMAKE_INSTALL_LIBDIR=lib
        -DTMINI_BUILD_TESTS=OFF -DTMINI_BUILD_EXAMPLES=${tool}
        -DTMINI_INSTALL_UDEV_RULE=${tool} ${ARGN})
    run_or_fail(${CMAKE_COMMAND} --build ${build} --parallel 2)
    run_or_fail(${CMAKE_COMMAND} --install ${build} --prefix ${prefix})
endfunction()
