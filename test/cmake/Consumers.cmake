# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Uses the library from another CMake project, in each way that a user can, and checks that nothing
# of ours has reached that project's own targets.

foreach(way add_subdirectory FetchContent find_package)
    add_test(NAME consumer.${way} COMMAND ${CMAKE_COMMAND}
        -D WAY=${way} -D TMINI_SOURCE=${PROJECT_SOURCE_DIR}
        -D BUILD=${CMAKE_CURRENT_BINARY_DIR}/consumer.${way}
        -D COMPILER=${CMAKE_C_COMPILER} -D GENERATOR=${CMAKE_GENERATOR}
        -P ${CMAKE_CURRENT_SOURCE_DIR}/consumer/run.cmake)
    set_tests_properties(consumer.${way} PROPERTIES LABELS consumer TIMEOUT 300)
endforeach()
