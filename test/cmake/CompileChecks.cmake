# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# One test for each way of compiling the library that ../compile.sh knows.

function(tmini_add_compile_checks)
    foreach(target ${ARGN})
        add_test(NAME compile.${target}
            COMMAND ${TMINI_SH} ${CMAKE_CURRENT_SOURCE_DIR}/compile.sh ${target})
        # 77: the compiler is not installed.
        set_tests_properties(compile.${target} PROPERTIES LABELS compile SKIP_RETURN_CODE 77)
    endforeach()
endfunction()

if(TMINI_SH)
    tmini_add_compile_checks(gcc clang c++ cortex-m0 avr rv32imc xtensa powerpc)
endif()
