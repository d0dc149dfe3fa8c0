# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# cmake -D SOURCE=… -D BUILD=… -D TOOLCHAIN=… -D BUILD_TYPE=… -D CMOCK=… -P BuildMachine.cmake
#
# Makes, or brings up to date, the build of the unit tests for another machine.

function(run_or_fail)
    execute_process(COMMAND ${ARGN} RESULT_VARIABLE status)
    if(NOT status EQUAL 0)
        string(REPLACE ";" " " command "${ARGN}")
        message(FATAL_ERROR "failed: ${command}")
    endif()
endfunction()

run_or_fail(${CMAKE_COMMAND} -S ${SOURCE} -B ${BUILD}
    -DCMAKE_TOOLCHAIN_FILE=${TOOLCHAIN} -DCMAKE_BUILD_TYPE=${BUILD_TYPE}
    -DTMINI_BUILD_EXAMPLES=OFF -DCMOCK_ROOT=${CMOCK})
run_or_fail(${CMAKE_COMMAND} --build ${BUILD} --parallel 2)
