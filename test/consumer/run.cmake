# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# cmake -D WAY=… -D TMINI_SOURCE=… -D BUILD=… -D COMPILER=… -D GENERATOR=… -P run.cmake
#
# Configures, checks, builds and runs the consumer project.

function(run_or_fail)
    execute_process(COMMAND ${ARGN} RESULT_VARIABLE status)
    if(NOT status EQUAL 0)
        string(REPLACE ";" " " command "${ARGN}")
        message(FATAL_ERROR "failed: ${command}")
    endif()
endfunction()

# Installs the library into the folder PREFIX, to be found there.
function(install_library prefix)
    set(build ${BUILD}/installed-from)
    run_or_fail(${CMAKE_COMMAND} -S ${TMINI_SOURCE} -B ${build} -G ${GENERATOR}
        -DCMAKE_C_COMPILER=${COMPILER} -DCMAKE_INSTALL_PREFIX=${prefix}
        -DTMINI_BUILD_TESTS=OFF -DTMINI_BUILD_EXAMPLES=OFF)
    run_or_fail(${CMAKE_COMMAND} --build ${build} --target install)
endfunction()

# The command line that compiled main.c has our include folder, and no option of ours.
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
    install_library(${BUILD}/prefix)
endif()
# An environment's own flags would look like ours.
unset(ENV{CFLAGS})
run_or_fail(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -B ${BUILD} -G ${GENERATOR}
    -DCMAKE_C_COMPILER=${COMPILER} -DWAY=${WAY} -DTMINI_SOURCE=${TMINI_SOURCE}
    -DFETCHCONTENT_SOURCE_DIR_TMINI=${TMINI_SOURCE} -DCMAKE_PREFIX_PATH=${BUILD}/prefix)
check_command_line()
run_or_fail(${CMAKE_COMMAND} --build ${BUILD})

# In the place where the consumer expects it, not in an output folder of ours.
run_or_fail(${BUILD}/consumer)
