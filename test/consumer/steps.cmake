# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# The common part of the consumers' and the release's scripts.

# Flags from the environment could be mistaken for ours.
unset(ENV{CFLAGS})

function(run_or_fail)
    execute_process(COMMAND ${ARGN} RESULT_VARIABLE status)
    if(NOT status EQUAL 0)
        string(REPLACE ";" " " command "${ARGN}")
        message(FATAL_ERROR "failed: ${command}")
    endif()
endfunction()
