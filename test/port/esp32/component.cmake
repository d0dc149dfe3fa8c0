# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Unpacks a release's ESP-IDF component, and builds the example with a model of ESP-IDF's build: in
# the repository, and as a copy with the component, as a user gets it from the component registry.
# If the environment variable IDF_PATH names an ESP-IDF, the copy is also configured by ESP-IDF
# itself, for its target `linux`.
#
#   cmake -D ROOT=DIR -D WORK=DIR -D ARCHIVE=FILE -P component.cmake

cmake_minimum_required(VERSION 3.16)

function(run name)
    execute_process(COMMAND ${ARGN} RESULT_VARIABLE status
        OUTPUT_VARIABLE output ERROR_VARIABLE output)
    if(NOT status EQUAL 0)
        message(FATAL_ERROR "${name}:\n${output}")
    endif()
endfunction()

function(build name source)
    set(ENV{IDF_PATH} ${CMAKE_CURRENT_LIST_DIR}/idf_model)
    run("${name}, configuring" ${CMAKE_COMMAND} -S ${source} -B ${WORK}/build-${name})
    run("${name}, building" ${CMAKE_COMMAND} --build ${WORK}/build-${name})
    message("${name}: configured and built by the model")
endfunction()

# Configuring `source` must fail, and its message must contain `reason`.
function(refuse name source reason)
    set(ENV{IDF_PATH} ${CMAKE_CURRENT_LIST_DIR}/idf_model)
    execute_process(COMMAND ${CMAKE_COMMAND} -S ${source} -B ${WORK}/build-${name}
        RESULT_VARIABLE status OUTPUT_QUIET ERROR_VARIABLE errors)
    if(status EQUAL 0 OR NOT errors MATCHES "${reason}")
        message(FATAL_ERROR "${name}: not refused with \"${reason}\":\n${errors}")
    endif()
    message("${name}: refused")
endfunction()

# The registry treats each folder in `examples` as an example.
function(check_pack)
    file(GLOB examples RELATIVE ${WORK}/packed/tmini/examples ${WORK}/packed/tmini/examples/*)
    if(NOT examples STREQUAL "esp32_idf")
        message(FATAL_ERROR "packed as examples: ${examples}")
    endif()
    file(GLOB_RECURSE files RELATIVE ${WORK}/packed/tmini ${WORK}/packed/tmini/*)
    foreach(file ${files})
        if(NOT file MATCHES "^(lib|port/esp32|examples/esp32_idf)/|^[^/]*$")
            message(FATAL_ERROR "packed, but nothing for ESP-IDF: ${file}")
        endif()
    endforeach()
endfunction()

function(configure_for_real idf source)
    if(NOT EXISTS ${idf}/tools/cmake/project.cmake)
        message("without ESP-IDF itself: IDF_PATH does not name one")
        return()
    endif()
    set(python python3)
    if(DEFINED ENV{IDF_PYTHON_ENV_PATH})
        set(python $ENV{IDF_PYTHON_ENV_PATH}/bin/python)
    endif()
    set(ENV{IDF_PATH} ${idf})
    run("ESP-IDF itself" ${CMAKE_COMMAND} -S ${source} -B ${WORK}/build-idf -G Ninja
        -D IDF_TARGET=linux -D PYTHON=${python} -D PYTHON_DEPS_CHECKED=1
        -D SDKCONFIG=${WORK}/build-idf/sdkconfig
        "-DCOMPONENTS=main\\;tmini")
    message("${source}: configured by ${idf}")
endfunction()

set(real_idf "$ENV{IDF_PATH}")
file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK}/packed)
# In the locale C, CMake 3.31 cannot unpack an archive whose path has accents.
file(RELATIVE_PATH archive ${WORK}/packed ${ARCHIVE})
run("unpacking" ${CMAKE_COMMAND} -E chdir ${WORK}/packed ${CMAKE_COMMAND} -E tar xf ${archive})
check_pack()

# ESP-IDF names the component after its folder: do not depend on the name of the repository's.
file(MAKE_DIRECTORY ${WORK}/named)
file(CREATE_LINK ${ROOT} ${WORK}/named/tmini SYMBOLIC)
file(CREATE_LINK ${ROOT} ${WORK}/named/main SYMBOLIC)
build(in_the_repository ${WORK}/named/tmini/examples/esp32_idf)
refuse(in_a_folder_called_main ${WORK}/named/main/examples/esp32_idf "please rename")
file(REMOVE_RECURSE ${WORK}/named) # Searching the build folder would follow the links in a circle.

file(COPY ${WORK}/packed/tmini/examples/esp32_idf DESTINATION ${WORK})
file(COPY ${WORK}/packed/tmini DESTINATION ${WORK}/esp32_idf/components)
build(copied_out ${WORK}/esp32_idf)
configure_for_real("${real_idf}" ${WORK}/esp32_idf)

run("the example's obstacle.c is that of obstacle_stop" ${CMAKE_COMMAND} -E compare_files
    ${ROOT}/examples/esp32_idf/main/obstacle.c ${ROOT}/examples/obstacle_stop/obstacle.c)
run("the example's obstacle.h is that of obstacle_stop" ${CMAKE_COMMAND} -E compare_files
    ${ROOT}/examples/esp32_idf/main/obstacle.h ${ROOT}/examples/obstacle_stop/obstacle.h)
