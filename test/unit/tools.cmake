# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# The tests' own tools, which the others rely on.
tmini_add_unit_test(test_random SOURCES test_random.c LIBRARIES tmini_test_support NOT_ON int16)
tmini_add_unit_test(test_encoder SOURCES test_encoder.c LIBRARIES tmini_test_support NOT_ON int16)
tmini_add_unit_test(test_reference_decoder SOURCES test_reference_decoder.c LIBRARIES tmini_test_support NOT_ON int16)
# The simulated lidar serves tests on this computer, and takes long on an emulated controller.
foreach(test test_simulator test_link)
    tmini_add_unit_test(${test} SOURCES ${test}.c LIBRARIES tmini_simulator
        NOT_ON int16 cortex-m0 cortex-m4)
endforeach()
if(TARGET tmini-sim AND TMINI_HAS_PTY AND NOT CMAKE_CROSSCOMPILING)
    tmini_add_unit_test(test_tmini_sim SOURCES test_tmini_sim.c NOT_ON others)
    target_compile_definitions(test_tmini_sim PRIVATE TMINI_SIM="$<TARGET_FILE:tmini-sim>")
    add_dependencies(test_tmini_sim tmini-sim)
endif()
