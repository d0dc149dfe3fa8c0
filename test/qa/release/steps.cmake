# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# The common part of the release tests, which are called with VERSION, ARCHIVES, ROOT, WORK, PYTHON,
# COMPILER, LAUNCHER and GENERATOR.

include(${CMAKE_CURRENT_LIST_DIR}/../../consumer/steps.cmake)

# Empties WORK and unpacks the archive with this ending there.
function(unpack ending)
    file(REMOVE_RECURSE ${WORK})
    file(MAKE_DIRECTORY ${WORK})
    # By a relative path: in the locale C, CMake 3.31 unpacks nothing, without an error, if an
    # archive's path has accents.
    file(RELATIVE_PATH archive ${WORK} ${ARCHIVES}/tmini-${VERSION}${ending})
    execute_process(COMMAND ${CMAKE_COMMAND} -E tar xf ${archive}
        WORKING_DIRECTORY ${WORK} RESULT_VARIABLE status)
    if(NOT status EQUAL 0)
        message(FATAL_ERROR "tmini-${VERSION}${ending} cannot be unpacked")
    endif()
endfunction()

# configure(SOURCE OPTION…): for a build in WORK/build. Fails if a source is missing.
function(configure source)
    run_or_fail(${CMAKE_COMMAND} -S ${source} -B ${WORK}/build -G ${GENERATOR}
        -DCMAKE_C_COMPILER=${COMPILER} -DCMAKE_C_COMPILER_LAUNCHER=${LAUNCHER} ${ARGN})
endfunction()

# The driver with the simulated lidar, and the decoder beside the reference.
function(test_driver_and_decoder)
    foreach(test test_programs test_differential)
        run_or_fail(${CMAKE_COMMAND} --build ${WORK}/build --parallel 2 --target ${test})
        run_or_fail(${WORK}/build/test/bin/${test})
    endforeach()
endfunction()
