# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# tmini, its port and the obstacle stop for a CMake project made by CubeMX. Add at the end of the
# project's CMakeLists.txt:
#
#   include(/path/to/tmini/examples/stm32_cube/tmini.cmake)
#   target_sources(${CMAKE_PROJECT_NAME} PRIVATE Core/Src/lidar.c)

add_subdirectory(${CMAKE_CURRENT_LIST_DIR}/../.. tmini)

target_sources(${CMAKE_PROJECT_NAME} PRIVATE
    ${CMAKE_CURRENT_LIST_DIR}/../../port/stm32/tmini_stm32_hal.c
    ${CMAKE_CURRENT_LIST_DIR}/../obstacle_stop/obstacle.c)
target_include_directories(${CMAKE_PROJECT_NAME} PRIVATE
    ${CMAKE_CURRENT_LIST_DIR}/../../port/stm32
    ${CMAKE_CURRENT_LIST_DIR}/../obstacle_stop)
# Without PRIVATE, like the generated call: CMake does not allow both kinds for one target.
target_link_libraries(${CMAKE_PROJECT_NAME} tmini::tmini)
