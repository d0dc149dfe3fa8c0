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

set(stm32 ${PROJECT_SOURCE_DIR}/port/stm32)
set(stm32_hal ${PROJECT_SOURCE_DIR}/test/support/stm32_stub/stm32_stub_hal.h)

# An STM32 has 32 bits: these do not run on the 8-bit machine.
tmini_add_port_test(test_port_stm32_hal stm32 NOT_ON int16
    SOURCES test_port_stm32_hal.c ${stm32}/tmini_stm32_hal.c MOCKS ${stm32_hal})
tmini_add_port_test(test_port_stm32_hal_cache stm32 NOT_ON int16
    SOURCES test_port_stm32_hal_cache.c ${stm32}/tmini_stm32_hal.c MOCKS ${stm32_hal})
tmini_add_port_test(test_port_stm32_usart_dr stm32 NOT_ON int16
    SOURCES test_port_stm32_usart.c ${stm32}/tmini_stm32_usart_dr.c)
tmini_add_port_test(test_port_stm32_usart_rdr stm32 NOT_ON int16
    SOURCES test_port_stm32_usart.c ${stm32}/tmini_stm32_usart_rdr.c)

# Another processor, another DMA controller, another USART.
if(TARGET test_port_stm32_hal_cache)
    target_compile_definitions(test_port_stm32_hal_cache PRIVATE
        STM32_STUB_DCACHE STM32_STUB_LINKED_LISTS)
    target_compile_definitions(test_port_stm32_usart_rdr PRIVATE USART_HAS_RDR)
endif()

# The examples for STM32: what makes the robot stop.
set(obstacle_stop ${PROJECT_SOURCE_DIR}/examples/obstacle_stop)
set(stm32_cube ${PROJECT_SOURCE_DIR}/examples/stm32_cube)
tmini_add_port_test(test_example_stm32_cube stm32 NOT_ON int16
    SOURCES test_example_stm32_cube.c ${stm32_cube}/lidar.c ${stm32}/tmini_stm32_hal.c
        ${obstacle_stop}/obstacle.c
    MOCKS ${stm32_hal} LIBRARIES tmini_test_support)
if(TARGET test_example_stm32_cube)
    target_include_directories(test_example_stm32_cube PRIVATE ${stm32_cube} ${obstacle_stop})
endif()

# What the PC's and the firmware's obstacle stop have in common.
tmini_add_unit_test(test_obstacle SOURCES test_obstacle.c ${obstacle_stop}/obstacle.c)
target_include_directories(test_obstacle PRIVATE ${obstacle_stop})
target_compile_options(test_obstacle PRIVATE -Wpedantic -Wconversion -Wshadow)
