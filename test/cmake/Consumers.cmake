# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Uses the library from another CMake project, in each way that a user can, and checks that none of
# our compile options reaches that project's own targets.

set(ways add_subdirectory FetchContent)
if(TARGET tmini_tool)
    list(APPEND ways find_package)
endif()
find_program(TMINI_PKG_CONFIG pkg-config)
mark_as_advanced(TMINI_PKG_CONFIG)
foreach(way ${ways})
    tmini_add_check(consumer.${way} consumer COMMAND ${CMAKE_COMMAND}
        -D WAY=${way} -D TMINI_SOURCE=${PROJECT_SOURCE_DIR}
        -D BUILD=${CMAKE_CURRENT_BINARY_DIR}/consumer.${way}
        -D COMPILER=${CMAKE_C_COMPILER} -D GENERATOR=${CMAKE_GENERATOR}
        -D PKG_CONFIG=${TMINI_PKG_CONFIG} -P ${CMAKE_CURRENT_SOURCE_DIR}/consumer/run.cmake)
endforeach()

# Compares the facts that the manifests of several ecosystems repeat.
tmini_missing_programs(missing python3)
if(missing)
    tmini_add_skipped_test(manifests consumer "${missing} is not installed")
else()
    tmini_add_check(manifests consumer
        COMMAND ${TMINI_PROGRAM_python3} ${CMAKE_CURRENT_SOURCE_DIR}/consumer/manifests.py)
    tmini_add_check(version consumer
        COMMAND ${TMINI_PROGRAM_python3} ${PROJECT_SOURCE_DIR}/.ci/version.py)
endif()
