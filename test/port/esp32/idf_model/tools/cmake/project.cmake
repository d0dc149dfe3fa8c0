# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# A model of ESP-IDF's build, limited to the functions that this project calls. Components are the
# project's `main`, the folders in its `components`, and the folders named in EXTRA_COMPONENT_DIRS.
# Each component is compiled with the stand-in headers of the ESP-IDF components that it requires;
# `main` gets all of them.

set(IDF_VERSION_MAJOR 5)
set(IDF_VERSION_MINOR 5)
set(idf_model_interface ${CMAKE_CURRENT_LIST_DIR}/../../../esp_idf)

# The headers of some ESP-IDF components. All other headers are available to every component.
set(idf_model_esp_driver_uart driver/uart.h)
set(idf_model_esp_driver_gpio driver/gpio.h)
set(idf_model_esp_pm esp_pm.h)
set(idf_model_esp_timer esp_timer.h)

function(idf_build_get_property variable property)
    if(NOT property STREQUAL "IDF_TARGET")
        message(FATAL_ERROR "the model does not know the property ${property}")
    endif()
    set(${variable} esp32c6 PARENT_SCOPE)
endfunction()

# Copies the headers of an ESP-IDF component into a folder of its own: only components that require
# it get this include folder.
function(idf_model_ask component)
    foreach(header ${idf_model_${component}})
        configure_file(${idf_model_interface}/${header}
            ${CMAKE_BINARY_DIR}/idf/${component}/${header} COPYONLY)
    endforeach()
endfunction()

function(idf_component_register)
    cmake_parse_arguments(part "" "" "SRCS;INCLUDE_DIRS;REQUIRES;PRIV_REQUIRES" ${ARGN})
    if(part_UNPARSED_ARGUMENTS)
        message(FATAL_ERROR "the model does not know ${part_UNPARSED_ARGUMENTS}")
    endif()
    get_filename_component(name ${CMAKE_CURRENT_SOURCE_DIR} NAME)
    add_library(${name} STATIC ${part_SRCS})
    target_include_directories(${name} PUBLIC ${part_INCLUDE_DIRS} ${CMAKE_BINARY_DIR}/idf/common)
    target_compile_options(${name} PRIVATE -Wall -Wextra -Werror)
    foreach(component ${part_REQUIRES} ${part_PRIV_REQUIRES})
        if(NOT idf_model_${component})
            message(FATAL_ERROR "${name} asks for ${component}, which the model does not know")
        endif()
        idf_model_ask(${component})
    endforeach()
    list(TRANSFORM part_REQUIRES PREPEND ${CMAKE_BINARY_DIR}/idf/)
    list(TRANSFORM part_PRIV_REQUIRES PREPEND ${CMAKE_BINARY_DIR}/idf/)
    target_include_directories(${name} PUBLIC ${part_REQUIRES} PRIVATE ${part_PRIV_REQUIRES})
    set_property(GLOBAL APPEND PROPERTY idf_model_components ${name})
endfunction()

function(idf_model_add_components)
    set(ESP_PLATFORM 1)
    file(GLOB own ${CMAKE_SOURCE_DIR}/components/*)
    foreach(folder ${own} ${EXTRA_COMPONENT_DIRS})
        get_filename_component(name ${folder} NAME)
        add_subdirectory(${folder} component_${name})
    endforeach()
    get_property(components GLOBAL PROPERTY idf_model_components)
    add_subdirectory(${CMAKE_SOURCE_DIR}/main component_main)
    target_link_libraries(main PRIVATE ${components})
    foreach(component esp_driver_uart esp_driver_gpio esp_pm esp_timer)
        target_include_directories(main PRIVATE ${CMAKE_BINARY_DIR}/idf/${component})
    endforeach()
endfunction()

# ESP-IDF also replaces CMake's project() with a macro of its own.
macro(project name)
    _project(${name} LANGUAGES C)
    file(GLOB_RECURSE idf_model_headers RELATIVE ${idf_model_interface} ${idf_model_interface}/*.h)
    foreach(header ${idf_model_headers})
        if(NOT header MATCHES "^(driver/.*|esp_pm.h|esp_timer.h)$")
            configure_file(${idf_model_interface}/${header}
                ${CMAKE_BINARY_DIR}/idf/common/${header} COPYONLY)
        endif()
    endforeach()
    idf_model_add_components()
endmacro()
