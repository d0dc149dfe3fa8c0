# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# The driver against the simulated lidar, over a line with all kinds of faults.
add_library(tmini_world STATIC EXCLUDE_FROM_ALL world.c truth.c ../support/invariants.c)
target_include_directories(tmini_world PUBLIC ${CMAKE_CURRENT_SOURCE_DIR})
target_include_directories(tmini_world PRIVATE ../support ${PROJECT_SOURCE_DIR}/lib/src)
target_link_libraries(tmini_world PUBLIC tmini_simulator tmini::tmini)
target_compile_options(tmini_world PRIVATE -O2 -Wall -Wextra $<$<BOOL:${TMINI_WERROR}>:-Werror>)
set_target_properties(tmini_world PROPERTIES C_STANDARD 99 C_EXTENSIONS OFF)

tmini_add_unit_test(test_wishes
    SOURCES test_wishes.c
    LIBRARIES tmini_world)
tmini_add_unit_test(test_stamps
    SOURCES test_stamps.c
    LIBRARIES tmini_test_support)
tmini_add_unit_test(test_intact
    SOURCES test_intact.c ../support/turns.c
    LIBRARIES tmini_test_support)
tmini_add_unit_test(test_driver
    SOURCES test_driver.c
    LIBRARIES tmini_world)
