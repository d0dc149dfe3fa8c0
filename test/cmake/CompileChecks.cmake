# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Adds one test for each target of ../compile.sh. ../barriers.sh looks for the memory barriers in
# the machine code, and ../layers.py checks which source file may call which.

if(NOT TMINI_SH)
    return()
endif()
foreach(target gcc clang c++ cortex-m0 avr rv32imc xtensa powerpc
        clang-cortex-m0 clang-cortex-m0plus clang-rv32imc)
    tmini_add_check(compile.${target} compile ALL
        COMMAND ${TMINI_SH} ${CMAKE_CURRENT_SOURCE_DIR}/compile.sh ${target})
endforeach()
foreach(target esp32-c3 rp2040 cortex-m4)
    tmini_add_check(barriers.${target} compile
        COMMAND ${TMINI_SH} ${CMAKE_CURRENT_SOURCE_DIR}/barriers.sh ${target})
endforeach()
tmini_add_check(layers compile NEEDS tmini COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/layers.py)
