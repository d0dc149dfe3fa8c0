# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# The library and its ESP32 port as an ESP-IDF component. Included by the CMakeLists.txt at the
# root. ESP-IDF reads it twice: first as a script, only to learn the requirements.

set(tmini_root ${CMAKE_CURRENT_LIST_DIR}/../..)
file(GLOB tmini_sources ${tmini_root}/lib/src/*.c)
set(tmini_include_dirs ${tmini_root}/lib/include)
set(tmini_requires "")
set(tmini_private_requires "")

# On the `linux` target of ESP-IDF there is no UART: the library alone, for unit tests.
idf_build_get_property(tmini_target IDF_TARGET)
if(NOT tmini_target STREQUAL "linux")
    list(APPEND tmini_sources ${CMAKE_CURRENT_LIST_DIR}/tmini_esp32.c)
    list(APPEND tmini_include_dirs ${CMAKE_CURRENT_LIST_DIR})
    list(APPEND tmini_requires esp_pm)
    list(APPEND tmini_private_requires esp_timer)
    # Since ESP-IDF 5.3, each driver has its own component.
    if("${IDF_VERSION_MAJOR}.${IDF_VERSION_MINOR}" VERSION_LESS "5.3")
        list(APPEND tmini_requires driver)
    else()
        list(APPEND tmini_requires esp_driver_uart)
        list(APPEND tmini_private_requires esp_driver_gpio)
    endif()
endif()

idf_component_register(
    SRCS ${tmini_sources}
    INCLUDE_DIRS ${tmini_include_dirs}
    REQUIRES ${tmini_requires}
    PRIV_REQUIRES ${tmini_private_requires}
)
