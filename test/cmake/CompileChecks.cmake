# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# One test for each way of compiling the library that ../compile.sh knows, and which file calls
# which.

if(NOT TMINI_SH)
    return()
endif()
foreach(target gcc clang c++ cortex-m0 avr rv32imc xtensa powerpc)
    tmini_add_check(compile.${target} compile ALL
        COMMAND ${TMINI_SH} ${CMAKE_CURRENT_SOURCE_DIR}/compile.sh ${target})
endforeach()
tmini_add_check(layers compile NEEDS tmini
    COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/layers.sh $<TARGET_FILE:tmini>)
