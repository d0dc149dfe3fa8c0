# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# The driver, an unkind lidar, and a watch over the line with all kinds of faults.
add_library(tmini_bed STATIC EXCLUDE_FROM_ALL bed.c watch.c ../support/invariants.c)
target_include_directories(tmini_bed PUBLIC ${CMAKE_CURRENT_SOURCE_DIR})
target_include_directories(tmini_bed PRIVATE ../support ${PROJECT_SOURCE_DIR}/lib/src)
target_link_libraries(tmini_bed PUBLIC tmini_simulator tmini::tmini)
target_compile_options(tmini_bed PRIVATE -O2 -Wall -Wextra $<$<BOOL:${TMINI_WERROR}>:-Werror>)
set_target_properties(tmini_bed PROPERTIES C_STANDARD 99 C_EXTENSIONS OFF)

tmini_add_unit_test(test_stamps LIBRARIES tmini_bed)

# Programs as users write them, at every moment at which power may come or fail.
tmini_add_unit_test(test_programs LIBRARIES tmini_test_rows tmini_bed)

# explore: at every event on the wire every trouble, and every pair of them (triples by hand).
# stories: random.
foreach(program explore stories)
    add_executable(${program} EXCLUDE_FROM_ALL ${program}.c)
    target_link_libraries(${program} PRIVATE tmini_bed)
    target_compile_options(${program} PRIVATE -O2 -Wall -Wextra $<$<BOOL:${TMINI_WERROR}>:-Werror>)
    set_target_properties(${program} PROPERTIES C_STANDARD 99 C_EXTENSIONS OFF)
endforeach()
tmini_add_check(stories system NEEDS stories COMMAND stories 3000)
tmini_add_check(stories.all system ALL NEEDS stories COMMAND stories 20000)
tmini_add_check(explore system NEEDS explore COMMAND explore --depth 1)
foreach(story 10hz 6.1hz no-wish stop change stop-set-start ask)
    tmini_add_check(explore.${story} system ALL TIMEOUT 900 NEEDS explore COMMAND explore ${story})
endforeach()
