# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Packs the library as the Arduino IDE wants it (all sources under src/):
#
#   cmake -P port/arduino/pack.cmake              makes tmini-arduino.zip in the current folder
#   cmake -D OUT=DIR -P port/arduino/pack.cmake   makes the folder DIR instead of an archive
#
# In the IDE: Sketch > Include Library > Add .ZIP Library.

cmake_minimum_required(VERSION 3.16)

get_filename_component(root ${CMAKE_CURRENT_LIST_DIR}/../.. ABSOLUTE)
if(OUT)
    get_filename_component(folder ${OUT} ABSOLUTE)
else()
    set(folder ${CMAKE_CURRENT_BINARY_DIR}/tmini)
endif()

if(EXISTS ${folder})
    message(FATAL_ERROR "${folder} is in the way")
endif()

file(GLOB sources ${root}/lib/src/*.c ${root}/lib/src/*.h)
file(GLOB sketches ${root}/examples/esp32_arduino/*/*.ino)
file(COPY ${sources} ${CMAKE_CURRENT_LIST_DIR}/TMiniLidar.cpp ${CMAKE_CURRENT_LIST_DIR}/TMiniLidar.h
    ${CMAKE_CURRENT_LIST_DIR}/tmini.h
    DESTINATION ${folder}/src)
file(COPY ${root}/lib/include/tmini DESTINATION ${folder}/src)
file(COPY ${CMAKE_CURRENT_LIST_DIR}/library.properties ${CMAKE_CURRENT_LIST_DIR}/keywords.txt
    ${CMAKE_CURRENT_LIST_DIR}/README.md
    ${root}/LICENSE DESTINATION ${folder})
foreach(sketch ${sketches})
    get_filename_component(name ${sketch} NAME_WE)
    file(COPY ${sketch} DESTINATION ${folder}/examples/${name})
endforeach()

if(NOT OUT)
    execute_process(
        COMMAND ${CMAKE_COMMAND} -E tar cf tmini-arduino.zip --format=zip tmini
        WORKING_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR} RESULT_VARIABLE status)
    file(REMOVE_RECURSE ${folder})
    if(NOT status EQUAL 0)
        message(FATAL_ERROR "the archive could not be written")
    endif()
    message("tmini-arduino.zip is ready")
endif()
