# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# cmake -D TMINI_SOURCE=… -D BUILD=… -D COMPILER=… -D GENERATOR=… -P without_cairo.cmake
#
# Builds the host tool without cairo: `plot` reports what is missing, the rest works.

function(run_or_fail)
    execute_process(COMMAND ${ARGN} RESULT_VARIABLE status
        OUTPUT_VARIABLE output ERROR_VARIABLE output)
    if(NOT status EQUAL 0)
        string(REPLACE ";" " " command "${ARGN}")
        message(FATAL_ERROR "failed: ${command}\n${output}")
    endif()
endfunction()

file(REMOVE_RECURSE ${BUILD})
run_or_fail(${CMAKE_COMMAND} -S ${TMINI_SOURCE} -B ${BUILD} -G ${GENERATOR}
    -DCMAKE_C_COMPILER=${COMPILER} -DCMAKE_BUILD_TYPE=Debug
    -DTMINI_BUILD_TESTS=OFF -DTMINI_TOOL_PLOT=OFF)
run_or_fail(${CMAKE_COMMAND} --build ${BUILD} --target tmini_tool)

set(recording ${TMINI_SOURCE}/test/recordings/sim-6hz.bin)
run_or_fail(${BUILD}/bin/tmini decode ${recording})
execute_process(COMMAND ${BUILD}/bin/tmini plot ${recording} -o ${BUILD}/room.png
    RESULT_VARIABLE status ERROR_VARIABLE errors)
if(NOT status EQUAL 1 OR NOT errors MATCHES "built without cairo.*libcairo2-dev")
    message(FATAL_ERROR "plot ended with ${status} and said: ${errors}")
endif()
