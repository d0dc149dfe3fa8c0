# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# cmake -D WAY=… -D TMINI_SOURCE=… -D BUILD=… -D COMPILER=… -D GENERATOR=… -P run.cmake
#
# Configures, checks, builds and runs the consumer project. For FetchContent, TMINI_SOURCE may be
# the archive of a release.

include(${CMAKE_CURRENT_LIST_DIR}/steps.cmake)

# Fails if the command line that compiles main.c contains compiler options of ours.
function(check_command_line)
    file(READ ${BUILD}/compile_commands.json commands)
    string(REGEX MATCH "\"command\": \"[^\n]*main\\.c[^\n]*" command "${commands}")
    if(NOT command)
        message(FATAL_ERROR "no command line for main.c in:\n${commands}")
    endif()
    string(REGEX MATCH " -(W|O|f|D|std|pedantic|g)[^ ]*" option "${command}")
    if(option)
        message(FATAL_ERROR "the option${option} has reached the consumer:\n${command}")
    endif()
endfunction()

file(REMOVE_RECURSE ${BUILD})
if(WAY STREQUAL "find_package")
    install_project(${BUILD}/installed-from ${BUILD}/prefix OFF)
endif()
set(fetched ${TMINI_SOURCE})
if(NOT IS_DIRECTORY ${TMINI_SOURCE})
    set(fetched "")
endif()
run_or_fail(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -B ${BUILD} -G ${GENERATOR}
    -DCMAKE_C_COMPILER=${COMPILER} -DWAY=${WAY} -DTMINI_SOURCE=${TMINI_SOURCE}
    -DFETCHCONTENT_SOURCE_DIR_TMINI=${fetched} -DCMAKE_PREFIX_PATH=${BUILD}/prefix)
check_command_line()
run_or_fail(${CMAKE_COMMAND} --build ${BUILD})

# The program is where the consumer expects it, not in an output folder of ours.
run_or_fail(${BUILD}/consumer)
if(EXISTS ${BUILD}/with_port)
    run_or_fail(${BUILD}/with_port)
endif()
