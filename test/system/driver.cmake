# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# The library against the simulated lidar, over a line on which everything goes wrong.
add_library(tmini_world STATIC world.c truth.c)
target_include_directories(tmini_world PUBLIC ${CMAKE_CURRENT_SOURCE_DIR})
target_link_libraries(tmini_world PUBLIC tmini_simulator tmini::tmini)
set_target_properties(tmini_world PROPERTIES C_STANDARD 99 C_EXTENSIONS OFF)

# build/test/bin/soak HOURS [SEED]; docs/soak.md has the result of a whole day.
add_executable(soak soak.c)
target_link_libraries(soak PRIVATE tmini_world)
set_target_properties(soak PROPERTIES C_STANDARD 99 C_EXTENSIONS OFF)
add_test(NAME soak COMMAND soak 0.5 2)
set_tests_properties(soak PROPERTIES LABELS system TIMEOUT 300)
