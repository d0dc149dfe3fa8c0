# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# cmake -D SOURCE=… -D BUILD=… -D TOOLCHAIN=… -D BUILD_TYPE=… -D CMOCK=… -P RunOnMachine.cmake
#
# Builds the unit tests for another machine, or brings that build up to date, and runs them.

function(run_or_fail)
    execute_process(COMMAND ${ARGN} RESULT_VARIABLE status)
    if(NOT status EQUAL 0)
        string(REPLACE ";" " " command "${ARGN}")
        message(FATAL_ERROR "failed: ${command}")
    endif()
endfunction()

run_or_fail(${CMAKE_COMMAND} -S ${SOURCE} -B ${BUILD}
    -DCMAKE_TOOLCHAIN_FILE=${TOOLCHAIN} -DCMAKE_BUILD_TYPE=${BUILD_TYPE}
    -DTMINI_BUILD_TESTS=ON -DTMINI_BUILD_EXAMPLES=OFF -DCMOCK_ROOT=${CMOCK})
run_or_fail(${CMAKE_COMMAND} --build ${BUILD} --target tests)
run_or_fail(${CMAKE_COMMAND} -E chdir ${BUILD}
    ${CMAKE_CTEST_COMMAND} --output-on-failure --no-tests=error)
