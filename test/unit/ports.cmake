# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Tests of the ports: each compiles the port's own source, which is no part of the library.

function(tmini_add_port_test name folder)
    tmini_add_unit_test(${name} ${ARGN})
    if(TARGET ${name})
        target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/port/${folder})
        target_compile_options(${name} PRIVATE -Wpedantic -Wconversion -Wshadow)
    endif()
endfunction()

tmini_add_port_test(test_port_template template
    SOURCES test_port_template.c ${PROJECT_SOURCE_DIR}/port/template/tmini_port_template.c)
